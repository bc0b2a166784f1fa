"""The sub-commands ``gloss render-ring`` and ``gloss render-matched``: section 5 of the gloss paper."""

import math
from pathlib import Path
from typing import Any, Literal

from glossspace.console import FiniteNumber, JsonFlag, Seed, WholeNumber, print_json
from glossspace.errors import GlossError
from glossspace.metric import Paint
from glossspace.named_space import named_space, note_simulated_space
from glossspace.stimulus_set import StimulusSet

__all__ = ["render_matched", "render_ring"]


def render_ring(
    *,
    out: Path,
    space: str = "paper",
    reference: str = ".193,.066,.07",
    radii: str = ".04,.08",
    n: WholeNumber = 8,
    size: str | None = None,
    quality: Literal["draft", "exact"] = "exact",
    max_code_error: FiniteNumber | None = None,
    fraction: FiniteNumber | None = None,
    seed: Seed = 1,
    scene: str | None = None,
    cache: Path | None = None,
    json: JsonFlag = False,
) -> None:
    """Render spheres at equal gloss distances from a reference (figure 11 of the gloss paper).

    Fills a folder with a stimulus set as gloss render does, with the figure
    (ring.png, ring.svg) and stimuli.csv, which says where each sphere lies in
    the gloss space. Points that no paint reaches are left out and named.

    Examples:

        gloss render-ring --space gloss-space.json --out ring

        gloss render-ring --reference .03,.033,.1 --radii .05 --n 4 --out a --json

    Parameters
    ----------
    out
        Folder for the images, the manifest and the figure.
    space
        A gloss-space.json, or the word paper for the gloss paper's space.
    reference
        The paint in the centre, as rho_d,rho_s,alpha; the spheres round it have its rho_d.
    radii
        Gloss distances of the contours.
    n
        Spheres on each contour; those mirrored at the axis of c cost little.
    size
        Width and height of the images in pixels, such as 512 or 640x480; even numbers. Default: the scene's film.
    quality
        Name of an error target: exact is half a code value on 99.9 % of the pixels of every image, draft two on 99 %.
    max_code_error
        Another target: error in 8-bit code values.
    fraction
        Another target: share of the pixels of every image within that error, below 1.
    seed
        Seed of the sampling. The same seed gives the same files.
    scene
        A scene file in TOML, or the name of a shipped scene. Default: checkerboard_box.
    cache
        Folder of intermediate results that sets share. Default: your cache folder, or that of GLOSSSPACE_CACHE.
    """
    from gloss_stimuli.apply import render_isogloss_ring

    gloss_space = named_space(space)
    paint, distances = _paint(reference), _numbers(radii, "--radii", ".04,.08")
    note_simulated_space(gloss_space)
    rendered = render_isogloss_ring(
        out, space=gloss_space, reference=paint, radii=distances, n=n, size=size, quality=quality,
        max_code_error=max_code_error, fraction=fraction, seed=seed, scene=scene, cache=cache,
    )  # fmt: skip
    _show(rendered, gloss_space.name, as_json=json)


def render_matched(
    *,
    out: Path,
    space: str = "paper",
    reference: str = ".767,.099,.04",
    rho_d: str = ".767,.193,.03",
    size: str | None = None,
    quality: Literal["draft", "exact"] = "exact",
    max_code_error: FiniteNumber | None = None,
    fraction: FiniteNumber | None = None,
    seed: Seed = 1,
    scene: str | None = None,
    cache: Path | None = None,
    json: JsonFlag = False,
) -> None:
    """Render spheres that match a reference in physical and in apparent gloss (figure 12 of the paper).

    Fills a folder with a stimulus set as gloss render does, with the figure
    (matched.png, matched.svg) and stimuli.csv, which says where each sphere lies
    in the gloss space.

    Examples:

        gloss render-matched --space gloss-space.json --out matched

        gloss render-matched --reference .42,.066,.1 --rho-d .42,.09 --out a --json

    Parameters
    ----------
    out
        Folder for the images, the manifest and the figure.
    space
        A gloss-space.json, or the word paper for the gloss paper's space.
    reference
        The paint to match, as rho_d,rho_s,alpha.
    rho_d
        Diffuse reflectances of the spheres, one a column.
    size
        Width and height of the images in pixels, such as 512 or 640x480; even numbers. Default: the scene's film.
    quality
        Name of an error target: exact is half a code value on 99.9 % of the pixels of every image, draft two on 99 %.
    max_code_error
        Another target: error in 8-bit code values.
    fraction
        Another target: share of the pixels of every image within that error, below 1.
    seed
        Seed of the sampling. The same seed gives the same files.
    scene
        A scene file in TOML, or the name of a shipped scene. Default: checkerboard_box.
    cache
        Folder of intermediate results that sets share. Default: your cache folder, or that of GLOSSSPACE_CACHE.
    """
    from gloss_stimuli.apply import render_matched_spheres

    gloss_space = named_space(space)
    paint, columns = _paint(reference), _numbers(rho_d, "--rho-d", ".767,.193,.03")
    note_simulated_space(gloss_space)
    rendered = render_matched_spheres(
        out, space=gloss_space, reference=paint, rho_ds=columns, size=size, quality=quality,
        max_code_error=max_code_error, fraction=fraction, seed=seed, scene=scene, cache=cache,
    )  # fmt: skip
    _show(rendered, gloss_space.name, as_json=json)


def _numbers(text: str, option: str, example: str) -> list[float]:
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if not values or not all(map(math.isfinite, values)):
        raise GlossError(f"Invalid {option} {text!r}. Allowed: numbers with commas between them, such as {example}.")
    return values


def _paint(text: str) -> Paint:
    values = _numbers(text, "--reference", ".193,.066,.07")
    if len(values) != 3:
        raise GlossError(f"Invalid --reference {text!r}. Allowed: three numbers rho_d,rho_s,alpha.")
    return Paint(*values)


def _show(rendered: StimulusSet, space: str, *, as_json: bool) -> None:
    if not as_json:
        print(f"{len(rendered.stimuli)} stimuli of {rendered.name} in {rendered.folder}")
        return
    errors = [entry["error_estimate"] for entry in rendered.manifest["stimuli"]]
    summary: dict[str, Any] = {
        "set": rendered.name,
        "space": space,
        "folder": str(rendered.folder),
        "manifest": str(rendered.folder / "manifest.json"),
        "table": str(rendered.folder / "stimuli.csv"),
        "figures": [str(rendered.folder / f"{rendered.name}.{kind}") for kind in ("png", "svg")],
        "stimuli": [stimulus.name for stimulus in rendered.stimuli],
        "method": rendered.manifest["rendering"]["method"],
        "target": rendered.manifest["rendering"]["target"],
        "worst_code_error_99_9": max(error["percentile_99_9"] for error in errors),
        "reached_target": all(error["reached_target"] for error in errors),
    }
    print_json(summary)
