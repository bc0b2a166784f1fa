"""The sub-command ``gloss render``."""

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from glossspace.console import JsonFlag, Seed, WholeNumber, print_json

__all__ = ["render"]


def render(
    *,
    stimulus_set: Annotated[str, Parameter(name="--set")],
    out: Path,
    size: WholeNumber = 512,
    quality: Literal["draft", "exact"] = "draft",
    seed: Seed = 1,
    scene: str | None = None,
    cache: Path | None = None,
    json: JsonFlag = False,
) -> None:
    """Render a stimulus set: one painted sphere a stimulus, in a checkerboard box under an area light.

    Writes 8-bit PNG for the screen, linear OpenEXR in cd/m², a composite, and
    manifest.json: all that is needed to reproduce them, the error reached, the hash
    of every file. Interrupted or repeated, it makes only what is missing.

    Examples:

        gloss render --set experiment1 --out stimuli/experiment1

        gloss render --set doi --size 768 --quality exact --seed 7 --out stimuli/doi

        gloss render --set my-paints.csv --scene my-box.toml --out mine --json

    Parameters
    ----------
    stimulus_set
        A shipped set (experiment1, contrast, doi), or a CSV or TOML file of rho_d, rho_s and alpha.
    out
        Folder for the images and the manifest.
    size
        Width and height of the images in pixels; an even number.
    quality
        draft is clean to the eye; exact takes thirty-two times the samples. Both report the error they reached.
    seed
        Seed of the sampling. The same seed gives the same files.
    scene
        A scene file in TOML, or the name of a shipped scene. Default: checkerboard_box.
    cache
        Folder of intermediate results that several sets may share.
    """
    from gloss_stimuli.render import render_set

    rendered = render_set(stimulus_set, out, size=size, quality=quality, seed=seed, cache=cache, scene=scene)
    errors = [entry["error_estimate"] for entry in rendered.manifest["stimuli"]]
    summary = {
        "set": rendered.name,
        "folder": str(rendered.folder),
        "manifest": str(rendered.folder / "manifest.json"),
        "stimuli": [stimulus.name for stimulus in rendered.stimuli],
        "quality": quality,
        "worst_code_error_99_9": max(error["percentile_99_9"] for error in errors),
        "reached_target": all(error["reached_target"] for error in errors),
        "clipped_pixels": sum(entry["clipped_pixels"] for entry in rendered.manifest["stimuli"]),
    }
    if json:
        print_json(summary)
    else:
        print(f"{len(rendered.stimuli)} stimuli of {rendered.name} in {rendered.folder}")
