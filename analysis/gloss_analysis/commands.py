"""Sub-commands of the analysis: mds, confirm, fit, report."""

import os
import re
from pathlib import Path
from typing import Literal

import numpy as np
import pandas as pd

from glossspace.console import (
    JsonFlag,
    NumberOfJobs,
    Seed,
    WholeNumber,
    note,
    print_json,
    print_table,
    progress_bar,
)
from glossspace.errors import GlossError
from glossspace.files import check_file_target
from glossspace.user_table import read_user_table

__all__ = ["confirm", "fit", "mds", "report"]

# The science is imported inside the functions: `gloss --help` imports this module and should not wait for scikit and
# SciPy.


def mds(
    table: Path,
    /,
    *,
    dims: str = "1:5",
    model: Literal["identity", "weighted"] = "weighted",
    level: Literal["ratio", "interval", "ordinal"] = "ordinal",
    ties: Literal["primary", "secondary"] = "primary",
    starts: WholeNumber = 30,
    seed: Seed = 1,
    jobs: NumberOfJobs = 1,
    json: JsonFlag = False,
) -> None:
    """Scale judged dissimilarities: stress and configuration in one or more numbers of dimensions.

    Examples:

        gloss mds study/dataset --dims 1:5

        gloss mds colours.csv --dims 2 --model identity --level interval --json

    Parameters
    ----------
    table
        A dataset folder, or a CSV file with the columns participant_id, stimulus_a, stimulus_b, dissimilarity.
        A pair that was not judged is absent or empty; zero is data.
    dims
        One number of dimensions, or a range such as 1:5.
    model
        weighted: participants weight the dimensions of a common space. identity: all see the same space.
    level
        What of the judgements is trusted: their order, their intervals, their ratios.
    ties
        Ordinal only: primary lets equal judgements differ in distance, secondary does not.
    starts
        Starting configurations for each number of dimensions.
    seed
        Of the random starts.
    jobs
        Processes, 0 for one a core; the result does not depend on it.
    """
    from gloss_analysis.dissimilarity import read_table
    from gloss_analysis.stress_curve import stress_curve

    wanted = _dimensions(dims)
    data = read_table(table)
    simulated = _simulated(table, data.participants)
    room = len(data.stimuli) - 1
    if wanted[0] <= room < wanted[-1]:
        note(f"{len(data.stimuli)} stimuli have room for {room} dimensions at most; more of them are left out.")
        wanted = range(wanted[0], room + 1)
    with progress_bar() as progress:
        task = progress.add_task("Scaling", total=len(wanted))
        solutions = stress_curve(
            data,
            dims=wanted,
            model=model,
            level=level,
            ties=ties,
            n_starts=starts,
            seed=seed,
            n_jobs=jobs or os.cpu_count() or 1,
            on_solution=lambda _: progress.advance(task),
        )
    _note_simulated(simulated, data.participants)
    if json:
        print_json(
            {
                "stimuli": data.stimuli,
                "participants": data.participants,
                "simulated": simulated,
                "model": model,
                "level": level,
                "ties": ties,
                "seed": seed,
                "solutions": [
                    {
                        "n_dims": solution.n_dims,
                        "stress1": solution.stress1,
                        "normalized_raw_stress": solution.normalized_raw_stress,
                        "source_stress1": solution.source_stress1,
                        "coordinates": solution.coordinates,
                        "dimension_weights": solution.dimension_weights,
                        "starts": solution.starts,
                        "best_hits": solution.best_hits,
                        "converged": solution.converged,
                        "warnings": solution.warnings,
                    }
                    for solution in solutions
                ],
            }
        )
        return
    curve = [(s.n_dims, s.stress1, s.starts, s.best_hits, s.converged) for s in solutions]
    print_table(pd.DataFrame(curve, columns=["dimensions", "Stress-1", "starts", "best hits", "converged"]))
    for solution in solutions:
        names = [f"dim {index + 1}" for index in range(solution.n_dims)]
        if len(solutions) == 1:
            print_table(_named("stimulus", solution.stimuli, names, solution.coordinates), title="Configuration")
            if model == "weighted":
                weights = _named("participant", solution.participants, names, solution.dimension_weights)
                print_table(weights, title="Dimension weights")
        for warning in solution.warnings:
            note(f"{solution.n_dims} dimensions: {warning}")


def confirm(
    table: Path,
    /,
    *,
    coordinates: Path,
    level: Literal["ratio", "interval", "ordinal"] = "ordinal",
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
    from gloss_analysis.dissimilarity import read_table

    data = read_table(table)
    simulated = _simulated(table, data.participants)
    axes, values = _coordinates(coordinates, data.stimuli)
    fitted = confirm_axes(data, values, axes=axes, level=level, ties=ties)
    _note_simulated(simulated, data.participants)
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
    from gloss_analysis.dissimilarity import from_table
    from gloss_analysis.fit import fit_gloss_space, labelled_observers
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
    simulated = _simulated(dataset, pairs.participants)
    fitted = fit_gloss_space(
        known,
        pairs,
        ratings,
        name=f"fitted to {dataset.resolve().name}",
        provenance={"observers": labelled_observers(pairs.participants, simulated)},
    )
    _note_simulated(simulated, pairs.participants)
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


def report(
    study: Path, /, *, out: Path | None = None, seed: Seed = 1, jobs: NumberOfJobs = 1, json: JsonFlag = False
) -> None:
    """Analyse a study folder and write its report: one HTML file with the figures of the gloss paper.

    Examples:

        gloss report out

        gloss report out --out report.html --json

    Parameters
    ----------
    study
        A folder as `gloss reproduce` makes it: stimuli/experiment1, stimuli/contrast, stimuli/doi, and dataset.
    out
        The file to write; report.html in the study folder by default.
    seed
        Of the random starts.
    jobs
        Processes, 0 for one a core; the result does not depend on it.
    """
    from gloss_analysis.report import write_report
    from gloss_analysis.study import analyse_study, read_study, report_file

    target = report_file(study) if out is None else out
    check_file_target(target)
    analysis = analyse_study(read_study(study), seed=seed, n_jobs=jobs or os.cpu_count() or 1, on_step=note)
    write_report(analysis, target)
    if json:
        print_json({"report": str(target), "weight_d": analysis.fit.space.weight_d})
    else:
        print(target)


def _simulated(source: Path, participants: tuple[str, ...]) -> list[str]:
    """Which participants are simulated, as far as a dataset says so; a plain table does not."""
    from glossspace.dataset import simulated_participants

    known = simulated_participants(source) if source.is_dir() else ()
    return [name for name in participants if name in known]


def _note_simulated(simulated: list[str], participants: tuple[str, ...]) -> None:
    if simulated:
        note(
            f"{len(simulated)} of {len(participants)} participants are simulated. They embody an answer: recovering it "
            "tests the software, not the paper."
        )


def _dimensions(text: str) -> range:
    # A number of dimensions has few digits, whatever the study.
    written = re.fullmatch(r"([0-9]{1,6})(?::([0-9]{1,6}))?", text.strip())
    first, last = (int(written[1]), int(written[2] or written[1])) if written else (0, 0)
    if not 1 <= first <= last:
        raise GlossError(f"Invalid --dims {text!r}. Allowed: one number such as 2, or a range such as 1:5.")
    return range(first, last + 1)


def _named(label: str, names: tuple[str, ...], columns: list[str], values: np.ndarray) -> pd.DataFrame:
    return pd.DataFrame({label: names} | dict(zip(columns, values.T, strict=True)))


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
