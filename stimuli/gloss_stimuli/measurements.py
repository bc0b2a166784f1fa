"""What the analysis needs of each picture: the reflected dark and light patches, and the blur of the edge between them.

The gloss paper (3.3.4) compares three accounts of contrast gloss: the luminance ratio of the reflected patches, the
difference of their lightness, and eq. 4. The first two are measured here, on the luminance that the display shows
(after tone curve, black level and rounding to codes) and on that of the scene. `find_patches` says where.

**Shading.** The sphere's own shading differs between two patches by more than a weak reflection does. So every pixel is
brought to the mean illumination of the two: with w its luminance under a perfect diffuser, W the mean of w over the
patches, q the mean of luminance over w there, and T what turns scene luminance into the luminance in question::

    L' = L · T(q W) / T(q w)

T is the identity for the scene, and the tone curve with the display, but not rounded, for the displayed luminance.

**Blur.** The width of the edge is the contrast of the patches over the steepest slope of the profile across the edge::

    width = (L'light - L'dark) / max |dL'/ds|

For a Gaussian lobe of standard deviation σ, narrow against a check, it is ``√(2π) σ``, and Ward's lobe has
``σ ≈ √2 α`` in the direction of reflection, in radians and in the plane of incidence. *Limits*: an edge is never
narrower than about a pixel, and never wider than about 0.57 checks, where the checks blur into a sine wave whose width
says nothing of the lobe: with checks of 27°, as in the shipped scene, that begins at α of about 0.07; from 0.1 on the
width hardly grows, while the contrast falls. Where mirrored checks change luminance from the edge to their far side,
their contrast, and with it the width, comes out small, for all paints alike: by some 20 % in the shipped scene.
"""

import csv
import io
import math
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.edge_width import steepest_slope
from gloss_stimuli.mirrored_checks import PatchGeometry, find_patches
from gloss_stimuli.tone import ToneCurve
from glossspace.display import DisplayModel
from glossspace.files import write_text
from glossspace.metric import lightness
from glossspace.stimulus_set import Stimulus

__all__ = ["COLUMNS", "FILE_NAME", "PatchGeometry", "Row", "find_patches", "measure", "write_measurements"]

Array = NDArray[np.float64]
Row = dict[str, str | float | None]

FILE_NAME = "measurements.csv"

_QUANTITIES = {
    "dark_patch_cd_m2": "mean luminance of the patch that reflects a dark check",
    "light_patch_cd_m2": "mean luminance of the patch that reflects the light check beside it",
    "luminance_ratio": "luminance of the light over that of the dark patch",
    "lightness_difference": "CIELAB L* of the light minus that of the dark patch",
    "edge_width_reflected_deg": "width of the edge between them, in degrees of the reflected direction",
    "edge_width_visual_deg": "the same in degrees of visual angle, at the viewing distance",
}
_KINDS = {
    "displayed": "on the screen; L* relative to the display's white",
    "scene": "in the scene; L* relative to a perfect diffuser in the place of the paint",
}

COLUMNS: dict[str, str] = {"stimulus": "name of the stimulus, as in the manifest"} | {
    f"{kind}_{name}": f"{meaning}, {where}" for kind, where in _KINDS.items() for name, meaning in _QUANTITIES.items()
}
"""Columns of `measurements.csv` and what they hold. A cell is empty where a quantity does not exist."""

# An edge of less contrast, relative to its luminance, is not told from what little shading is left.
SMALLEST_CONTRAST = 1e-3


def measure(
    patches: PatchGeometry | None,
    stimulus: Stimulus,
    luminance: Array,
    white_luminance: Array | None,
    *,
    tone: ToneCurve,
    display: DisplayModel,
) -> Row:
    """Measure the reflected patches and their edge in one picture.

    Parameters
    ----------
    patches : PatchGeometry or None
        Where, as `find_patches` found it for the scene; None where it found nothing.
    stimulus : Stimulus
        Which paint it shows: without a specular term there is no reflected edge.
    luminance : array, shape (H, W)
        Scene luminance in cd/m².
    white_luminance : array, shape (H, W), or None
        Luminance of the scene with a perfect diffuser in place of the paint; None where it is not known.
    tone, display
        What turns scene luminance into what is shown.

    Returns
    -------
    dict
        A value for each of `COLUMNS`; None where it does not exist: all of them without patches or without
        `white_luminance`, the ratio on a black that is zero, the width of an edge without specular term, or of less
        contrast than 0.1 % or one code value.

    Raises
    ------
    ValueError
        The images have another size than the patches were found for.
    """
    row: Row = dict.fromkeys(COLUMNS)
    row["stimulus"] = stimulus.name
    if patches is None or white_luminance is None:
        return row
    if luminance.shape != patches.film or white_luminance.shape != patches.film:
        raise ValueError(
            f"The patches were found for images of {patches.film}, but the luminance is of {luminance.shape} and the "
            f"white of {white_luminance.shape}."
        )
    parts = [patches.dark, patches.light, patches.edge]
    scene = [luminance.flat[part] for part in parts]
    white = [white_luminance.flat[part] for part in parts]
    if min(part.min() for part in white) <= 0:
        return row  # no light falls there

    def unrounded(values: Array) -> Array:
        return display.luminance(display.exact_codes(display.white_cd_m2 * tone(values)), bits=8)

    def shown(values: Array) -> Array:
        return display.luminance(display.codes(display.white_cd_m2 * tone(values)))

    illumination = float(np.mean([white[0].mean(), white[1].mean()]))
    factor = float(np.mean([(scene[k] / white[k]).mean() for k in (0, 1)]))
    for kind, values, relation, reference in (
        ("displayed", [shown(part) for part in scene], unrounded, display.white_cd_m2),
        ("scene", scene, _identity, illumination),
    ):
        level = float(relation(np.array([factor * illumination]))[0])
        even = [
            part * level / np.maximum(relation(factor * under), np.finfo(float).tiny)
            for part, under in zip(values, white, strict=True)
        ]
        step = _code_step(display, level) if kind == "displayed" else 0.0
        measured = _measured(even, patches, reference, edge_from=max(SMALLEST_CONTRAST * level, step))
        if stimulus.rho_s == 0:
            measured["edge_width_reflected_deg"] = measured["edge_width_visual_deg"] = None
        row |= {f"{kind}_{name}": value for name, value in measured.items()}
    return row


def write_measurements(path: str | Path, rows: Iterable[Mapping[str, str | float | None]]) -> None:
    """Write measurements as CSV, whole or not at all: a line a stimulus, with the columns of `COLUMNS`.

    Raises
    ------
    ValueError
        A row lacks a column or has another one.
    FloatingPointError
        A value is not finite: what does not exist must be None, which leaves its cell empty.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for row in rows:
        if set(row) != set(COLUMNS):
            raise ValueError(f"Measurements have other columns than {', '.join(COLUMNS)}: {', '.join(row)}.")
        writer.writerow([_cell(column, row[column]) for column in COLUMNS])
    write_text(path, text.getvalue())


def _measured(
    parts: list[Array], patches: PatchGeometry, reference: float, *, edge_from: float
) -> dict[str, float | None]:
    dark, light = float(parts[0].mean()), float(parts[1].mean())
    width = None
    if light - dark > edge_from and patches.profile.is_resolved():
        slope = steepest_slope(*patches.profile.means(parts[2]))
        width = (light - dark) / slope if slope > 0 else None
    return {
        "dark_patch_cd_m2": dark,
        "light_patch_cd_m2": light,
        "luminance_ratio": light / dark if dark > 0 else None,
        "lightness_difference": _lightness(light / reference) - _lightness(dark / reference),
        "edge_width_reflected_deg": None if width is None else width * patches.reflected_deg_per_check,
        "edge_width_visual_deg": None if width is None else width * patches.visual_deg_per_check,
    }


def _lightness(relative: float) -> float:
    # A reflection may be brighter than white paint: CIE's equation goes on above 100, `lightness` ends there.
    return float(lightness(relative)) if relative <= 1 else 116 * math.cbrt(relative) - 16


def _code_step(display: DisplayModel, level: float) -> float:
    """Luminance between the code values next to this one, half of each step."""
    largest = 2**display.bits - 1
    code = float(display.exact_codes(level)) * largest / 255
    ends = np.clip([code - 0.5, code + 0.5], 0, largest)
    return float(np.diff(display.luminance(ends))[0])


def _identity(values: Array) -> Array:
    return values


def _cell(column: str, value: str | float | None) -> str:
    if value is None or isinstance(value, str):
        return value or ""
    if not math.isfinite(value):
        raise FloatingPointError(f"The measurement {column} is {value}; what does not exist must be None.")
    return f"{value:.7g}"
