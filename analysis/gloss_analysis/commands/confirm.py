"""gloss confirm: how much given axes weigh."""

from pathlib import Path
from typing import Literal

import numpy as np
import pandas as pd

from gloss_analysis.commands.observers import note_simulated, simulated_of
from glossspace.console import JsonFlag, note, print_json, print_table
from glossspace.errors import GlossError
from glossspace.user_table import read_user_table

__all__ = ["confirm"]


def confirm(
    table: Path,
    /,
    *,
    coordinates: Path,
    level: Literal["ratio", "interval", "spline", "ordinal"] = "ordinal",
    ties: Literal["primary", "secondary"] = "primary",
    json: JsonFlag = False,
) -> None:
    """Estimate how much given axes weigh in judged dissimilarities (confirmatory MDS).

    The ratio is the weight of the last axis over that of the first: for c and d,
    the gloss paper's 1.78. The population's ratio is the geometric mean over
    participants, with a 95 % t interval; the shared ratio is descriptive.

    Examples:

        gloss confirm study/dataset --coordinates coordinates.csv

        gloss confirm pairs.csv --coordinates axes.csv --level ratio --json

    Parameters
    ----------
    table
        A dataset folder, or a CSV file with the columns participant_id, stimulus_a, stimulus_b, dissimilarity.
    coordinates
        A CSV file with the column stimulus and one column for each axis.
    level
        What of the judgements is trusted: their order, their intervals, their ratios.
    ties
        Ordinal only: primary lets equal judgements differ in distance, secondary does not.
    """
    from gloss_analysis.confirmatory import confirm_axes
    from gloss_analysis.judgement_table import read_table

    data = read_table(table)
    simulated = simulated_of(table, data.participants)
    axes, values = _coordinates(coordinates, data.stimuli)
    fitted = confirm_axes(data, values, axes=axes, level=level, ties=ties)
    note_simulated(simulated, data.participants)
    if json:
        print_json(
            {
                "axes": fitted.axes,
                "population": {"ratio": fitted.population_ratio, "ci95": fitted.population_ci95},
                "shared": {
                    "weights": fitted.shared.weights,
                    "ratio": fitted.shared.ratio,
                    "stress1": fitted.shared.stress1,
                },
                "participants": [
                    {"participant_id": name, "weights": one.weights, "ratio": one.ratio, "stress1": one.stress1}
                    for name, one in zip(fitted.participants, fitted.individual, strict=True)
                ],
                "simulated": simulated,
                "warnings": fitted.warnings,
            }
        )
        return
    rows = [(name, one.ratio, one.stress1) for name, one in zip(fitted.participants, fitted.individual, strict=True)]
    print_table(pd.DataFrame(rows, columns=["participant", f"{axes[-1]} over {axes[0]}", "Stress-1"]))
    interval = "" if fitted.population_ci95 is None else " (95 % {:.4g} to {:.4g})".format(*fitted.population_ci95)
    print(f"Population: {fitted.population_ratio:.4g}{interval}. Shared: {fitted.shared.ratio:.4g}.")
    for warning in fitted.warnings:
        note(warning)


def _coordinates(path: Path, stimuli: tuple[str, ...]) -> tuple[tuple[str, ...], np.ndarray]:
    table = read_user_table(path, what="coordinate table", columns=["stimulus"])
    axes = tuple(column for column in table.columns if column != "stimulus")
    if not axes:
        raise GlossError(f"'{path}' has the column stimulus alone. Add one column of coordinates for each axis.")
    table = table[table["stimulus"].isin(stimuli)]
    if table["stimulus"].duplicated().any():
        raise GlossError(
            f"'{path}' lists the stimulus {table['stimulus'][table['stimulus'].duplicated()].iloc[0]!r} twice."
        )
    missing = [name for name in stimuli if name not in set(table["stimulus"])]
    if missing:
        raise GlossError(
            f"'{path}' lacks coordinates of the stimulus {missing[0]!r} ({len(missing)} such). Add a row for each."
        )
    values = table[list(axes)].apply(pd.to_numeric, errors="coerce").to_numpy(dtype=float)
    unusable = np.argwhere(~np.isfinite(values))
    if len(unusable):
        row, column = unusable[0]
        found = table[axes[column]].fillna("").iloc[row]
        raise GlossError(
            f"'{path}', line {table.index[row]}: the coordinate {axes[column]} of {table['stimulus'].iloc[row]!r} is "
            f"{found!r}. Allowed: a finite number; remove columns that are no axes."
        )
    return axes, values[[table["stimulus"].tolist().index(name) for name in stimuli]]
