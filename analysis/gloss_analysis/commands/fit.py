"""gloss fit: a gloss space from judgements."""

from pathlib import Path

import pandas as pd

from gloss_analysis.commands.observers import note_simulated, simulated_of
from glossspace.console import JsonFlag, note, print_json, print_table
from glossspace.files import check_file_target

__all__ = ["fit"]


def fit(dataset: Path, /, *, out: Path, stimuli: Path | None = None, json: JsonFlag = False) -> None:
    """Fit a gloss space to a dataset with judged pairs and, where they were rated, magnitude estimates.

    Examples:

        gloss fit study/dataset --out gloss-space.json

        gloss fit study/dataset --stimuli stimuli.csv --out gloss-space.json --json

    Parameters
    ----------
    dataset
        The dataset folder.
    out
        The file to write; `gloss distance --space` reads it.
    stimuli
        A CSV file with the columns stimulus, rho_d, rho_s, alpha. By default what the dataset itself recorded.
    """
    from gloss_analysis.fit import fit_gloss_space, labelled_observers
    from gloss_analysis.judgement_table import from_table
    from glossspace.dataset import (
        read_dissimilarities,
        read_magnitudes,
        read_stimuli,
        read_stimulus_table,
        tasks_of,
    )

    check_file_target(out)
    pairs = from_table(read_dissimilarities(dataset), source=f"The dataset '{dataset}'")
    known = read_stimuli(dataset) if stimuli is None else read_stimulus_table(stimuli)
    rated = [task for task, kind in tasks_of(dataset).items() if kind == "magnitude"]
    studies = {axis: task for axis, task in (("c", "contrast"), ("d", "doi")) if task in rated}
    ratings = {axis: read_magnitudes(dataset, task) for axis, task in studies.items()}
    simulated = simulated_of(dataset, pairs.participants)
    fitted = fit_gloss_space(
        known,
        pairs,
        ratings,
        name=f"fitted to {dataset.resolve().name}",
        provenance={"observers": labelled_observers(pairs.participants, simulated)},
    )
    note_simulated(simulated, pairs.participants)
    fitted.space.save(out)
    space = fitted.space
    if json:
        print_json(
            {
                "space": str(out),
                "weight_c": space.weight_c,
                "weight_d": space.weight_d,
                "weight_d_ci95": space.weight_d_ci95,
                "r_squared": {axis: one.r_squared for axis, one in fitted.regressions.items()},
                "simulated": simulated,
                "warnings": fitted.confirmatory.warnings,
            }
        )
        return
    rows = [("weight of d over that of c", space.weight_d)]
    if space.weight_d_ci95 is not None:
        rows += zip(("95 % from", "95 % to"), space.weight_d_ci95, strict=True)
    rows += [(f"r² of the ratings along {axis}", one.r_squared) for axis, one in fitted.regressions.items()]
    print_table(pd.DataFrame(rows, columns=["quantity", "value"]))
    print(f"Gloss space: {out}")
    for warning in fitted.confirmatory.warnings:
        note(warning)
