"""Where a study's numbers come from: how images were rendered, what they were shown on, sessions, software, files."""

import json
import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np

from gloss_analysis.report.numbers import fixed
from gloss_analysis.study.folder import Study, dataset_folder, stimulus_folder
from glossspace.files import sha256_of
from glossspace.stimulus_set import MANIFEST_NAME, StimulusSet

__all__ = [
    "RenderError",
    "calibration_words",
    "display_words",
    "file_hashes",
    "render_error",
    "render_words",
    "rendering_summary",
    "session_headers",
    "software_versions",
    "tone_words",
]

_PACKAGES = ("glossspace", "numpy", "scipy", "pandas", "colour-science", "matplotlib", "mitsuba", "psychopy")


@dataclass(frozen=True)
class RenderError:
    """Error of the worst image of some, in code values of the display.

    Attributes
    ----------
    median, percentile_99_9 : float
        Over its pixels.
    n_images : int
        Images whose error is known.
    n_missed : int
        Images that did not reach their target.
    """

    median: float
    percentile_99_9: float
    n_images: int
    n_missed: int


def render_error(sets: list[StimulusSet]) -> RenderError | None:
    """Largest error over the images of stimulus sets; None where no manifest tells it."""
    errors = [
        error
        for one in sets
        for entry in one.manifest["stimuli"]
        if isinstance(error := entry.get("error_estimate"), dict) and {"median", "percentile_99_9"} <= error.keys()
    ]
    if not errors:
        return None
    return RenderError(
        median=max(error["median"] for error in errors),
        percentile_99_9=max(error["percentile_99_9"] for error in errors),
        n_images=len(errors),
        n_missed=sum(error.get("reached_target") is False for error in errors),
    )


def rendering_summary(stimuli: StimulusSet) -> str:
    """How a set was rendered, with the error of its worst image."""
    # Another program may have rendered the set, and say less of how.
    rendering = stimuli.manifest.get("rendering") or {}
    parts = [f"{key} {rendering[key]}" for key in ("method", "quality") if key in rendering]
    if target := rendering.get("target"):
        share = f"{100 * target['fraction']:g} % of the pixels"
        parts.append(f"target {target['max_code_error']:g} code values on {share} of every image")
    if "seed" in rendering:
        parts.append(f"seed {rendering['seed']}")
    error = render_error([stimuli])
    if error is not None:
        parts.append(
            f"error of the worst image {error.median:.2f} code values in the median, {error.percentile_99_9:.2f} at "
            "99.9 % of its pixels"
        )
    return "; ".join(parts)


def display_words(stimuli: StimulusSet) -> str:
    """The display that a set's images were made for, in a sentence."""
    display, viewing = stimuli.manifest["display"], stimuli.manifest["viewing"]
    parts = []
    if {"black_cd_m2", "white_cd_m2"} <= display.keys():
        parts.append(f"{display['black_cd_m2']:g} to {display['white_cd_m2']:g} cd/m²")
    if display.get("gamma") is not None:
        parts.append(f"gamma {display['gamma']:g}")
    elif display.get("measured"):
        parts.append("a measured table of luminance in place of a gamma")
    if "bits" in display:
        parts.append(f"{display['bits']:g} bits")
    width, height = stimuli.image_size
    said = f"Images of {width} × {height} pixels were made for a display of {', '.join(parts) or 'unstated properties'}"
    said += f", each to subtend {stimuli.visual_angle_deg:g}° of visual angle"
    if "distance_cm" in viewing:
        said += f" from {viewing['distance_cm']:g} cm"
    error = display.get("quantisation_error")
    if isinstance(error, dict) and "largest_cd_m2" in error:
        said += f"; rounding to its code values costs up to {error['largest_cd_m2']:g} cd/m²"
    return f"{said}."


def tone_words(stimuli: StimulusSet) -> str:
    """How luminance of the scene became that of the display, in a sentence with a space behind it; or nothing."""
    curve = stimuli.manifest.get("tone_curve")
    if not isinstance(curve, dict) or "kind" not in curve:
        return ""
    adapted = curve.get("adapting_luminance_cd_m2")
    level = f", adapted to {adapted:g} cd/m²" if _number(adapted) else ""
    return f"Luminance of the scene was mapped to that of the display by a {curve['kind']}{level}. "


def calibration_words(stimuli: StimulusSet, headers: Sequence[Mapping[str, Any]] = ()) -> str:
    """Calibrations that the screens were checked against, with their residuals, or that none is recorded.

    Parameters
    ----------
    stimuli : StimulusSet
        For what its display says.
    headers : sequence of mapping
        Of the journals; see `session_headers`.
    """
    display = stimuli.manifest["display"]
    found: dict[str, str] = {}
    for header in headers:
        checked = header.get("preflight")
        known = checked.get("calibration") if isinstance(checked, dict) else None
        if isinstance(known, dict) and _number(known.get("rms_delta_l")) and _number(known.get("largest_delta_l")):
            found[str(known.get("sha256"))] = (
                f"The screen “{known.get('screen')}” was {'SIMULATED' if known.get('simulated') else 'calibrated'} on "
                f"{str(known.get('measured_at'))[:10]} ({known.get('photometer')}); on {known.get('n_verified')} "
                f"patches that were not used in the fit the residual was ΔL* {known['rms_delta_l']:.2g} (root mean "
                f"square), at most {known['largest_delta_l']:.2g}."
            )
    if found:
        return " ".join(found.values())
    table = display.get("measured")
    if isinstance(table, dict) and table.get("codes"):
        return (
            f"The luminance of the display was measured at {len(table['codes'])} code values and interpolated between "
            "them; no residual of a calibration is recorded."
        )
    return (
        "The display is a model: no measurement of a screen and no residual of a calibration is recorded with this "
        "study."
    )


def session_headers(study: Study) -> list[dict[str, Any]]:
    """What the journals say first about each session: protocol, mode, versions. Empty where there are none."""
    headers = []
    for path in sorted((dataset_folder(study.folder) / "journals").glob("*.jsonl")):
        try:
            with path.open(encoding="utf-8") as lines:
                header = json.loads(lines.readline())
        except (OSError, ValueError):
            continue  # a journal is a record of its session: the data do not depend on it
        if isinstance(header, dict) and header.get("type") == "header":
            headers.append(header)
    return headers


def software_versions() -> dict[str, str]:
    """Versions of what made the report, and the kind of system."""
    found = {"Python": platform.python_version(), "system": f"{platform.system()} {platform.machine()}"}
    for package in _PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return found


def file_hashes(study: Path) -> dict[str, str]:
    """SHA-256 of what the report was made from: the manifests, which hold the images' own, and the data files."""
    files = sorted(stimulus_folder(study, "").glob(f"*/{MANIFEST_NAME}")) + sorted(
        dataset_folder(study).glob("data/**/*.csv")
    )
    return {path.relative_to(study).as_posix(): sha256_of(path) for path in files}


def render_words(study: Study) -> str:
    """How many images there are, and the error of the worst."""
    sets = list(study.sets.values())
    n = sum(len(one.stimuli) for one in sets)
    error = render_error(sets)
    if error is None:
        return f"{n} images in {len(sets)} sets, whose error no manifest tells."
    said = f"{n} images in {len(sets)} sets; "
    if error.n_images < n:
        said += f"of the {error.n_images} whose error is known, "
    said += (
        f"the worst is wrong by {fixed(error.median, 2)} code values in the median and "
        f"{fixed(error.percentile_99_9, 2)} at 99.9 % of its pixels"
    )
    reached = "every image reached its target" if error.n_missed == 0 else f"{error.n_missed} missed their target"
    return f"{said}; {reached}."


def _number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and bool(np.isfinite(value))
