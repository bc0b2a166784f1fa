"""The sub-command ``gloss render``."""

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from glossspace.console import FiniteNumber, JsonFlag, Seed, WholeNumber, print_json

__all__ = ["render"]


def render(
    *,
    stimulus_set: Annotated[str, Parameter(name="--set")],
    out: Path,
    size: str | None = None,
    quality: Literal["draft", "exact"] = "exact",
    max_code_error: FiniteNumber | None = None,
    fraction: FiniteNumber | None = None,
    method: Literal["auto", "exact", "coefficients", "path"] = "auto",
    spp: WholeNumber | None = None,
    seed: Seed = 1,
    scene: str | None = None,
    cache: Path | None = None,
    json: JsonFlag = False,
) -> None:
    """Render a stimulus set: one painted sphere a stimulus, in a checkerboard box under an area light.

    Writes 8-bit PNG for the screen, linear OpenEXR in cd/m², a composite, measurements of
    the reflected checks, and manifest.json: all that is needed to reproduce them, the
    error reached, the hash of every file. Interrupted or repeated, it makes only what is
    missing.

    Examples:

        gloss render --set experiment1 --out stimuli/experiment1

        gloss render --set doi --size 768 --max-code-error .25 --seed 7 --out stimuli/doi

        gloss render --set my-paints.csv --scene my-box.toml --out mine --json

        gloss render --set my-paints.csv --scene teapot.toml --spp 1024 --out teapots

    Parameters
    ----------
    stimulus_set
        A shipped set (experiment1, contrast, contrast30, doi), or a CSV or TOML file of paints: columns rho_d, rho_s,
        alpha, or lightness, c, d.
    out
        Folder for the images and the manifest.
    size
        Width and height of the images in pixels, such as 512 or 640x480; even numbers. Default: the scene's film.
    quality
        Name of an error target: exact is half a code value on 99.9 % of the pixels of every image, draft two on 99 %.
    max_code_error
        Another target: error in 8-bit code values.
    fraction
        Another target: share of the pixels of every image within that error, below 1.
    method
        auto takes the exact renderer wherever the scene allows it. path is Mitsuba's stock path tracer, coefficients
        our own for boxes beyond the exact one.
    spp
        Samples per pixel for the method path, instead of an error target.
    seed
        Seed of the sampling. The same seed gives the same files.
    scene
        A scene file in TOML, or the name of a shipped scene. Default: checkerboard_box.
    cache
        Folder of intermediate results that sets share. Default: your cache folder, or that of GLOSSSPACE_CACHE.
    """
    from gloss_stimuli.render import render_set

    rendered = render_set(
        stimulus_set, out, size=size, quality=quality, max_code_error=max_code_error, fraction=fraction, method=method,
        samples_per_pixel=spp, seed=seed, cache=cache, scene=scene,
    )  # fmt: skip
    errors = [entry["error_estimate"] for entry in rendered.manifest["stimuli"]]
    summary = {
        "set": rendered.name,
        "folder": str(rendered.folder),
        "manifest": str(rendered.folder / "manifest.json"),
        "stimuli": [stimulus.name for stimulus in rendered.stimuli],
        "method": rendered.manifest["rendering"]["method"],
        "target": rendered.manifest["rendering"]["target"],
        "worst_code_error_99_9": max(error["percentile_99_9"] for error in errors),
        "reached_target": all(error["reached_target"] for error in errors),
        "clipped_pixels": sum(entry["clipped_pixels"] for entry in rendered.manifest["stimuli"]),
    }
    if json:
        print_json(summary)
    else:
        print(f"{len(rendered.stimuli)} stimuli of {rendered.name} in {rendered.folder}")
