"""The sub-command `gloss reproduce`."""

import os
from pathlib import Path
from typing import Literal

from glossspace.console import JsonFlag, NumberOfJobs, Seed, WholeNumber, note, print_json

__all__ = ["reproduce"]


def reproduce(
    *,
    out: Path,
    quality: Literal["draft", "exact"] = "exact",
    size: WholeNumber = 512,
    seed: Seed = 1,
    jobs: NumberOfJobs = 0,
    json: JsonFlag = False,
) -> None:
    """Run the gloss paper's study: stimuli, simulated observers, scaling, gloss space, report.

    Interrupted, it goes on where it was when it is run again with the same
    settings.

    Examples:

        gloss reproduce --out study

        gloss reproduce --out study-2 --quality draft --size 256 --seed 2 --json

    Parameters
    ----------
    out
        The folder to fill.
    quality
        Of the images: exact is half a code value on 99.9 % of the pixels of every image, draft two on 99 %.
    size
        Width and height of the images in pixels; an even number.
    seed
        The same seed gives the same study.
    jobs
        Processes of the analysis, 0 for one a core; the result does not depend on it.
    """
    from gloss_pipeline.reproduce import reproduce_study

    made = reproduce_study(out, quality=quality, size=size, seed=seed, n_jobs=jobs or os.cpu_count() or 1, on_step=note)
    if json:
        space = made.analysis.fit.space
        print_json(
            {
                "report": str(made.report),
                "gloss_space": str(made.gloss_space),
                "dataset": str(made.dataset),
                "weight_d": space.weight_d,
                "weight_d_ci95": space.weight_d_ci95,
                "stress1": [solution.stress1 for solution in made.analysis.dimensionality.curve],
                "observers": "simulated",
            }
        )
    else:
        print(f"Report: {made.report.resolve()}")
        print(f"Gloss space (of simulated observers): {made.gloss_space.resolve()}")
