"""gloss confirm: how much given axes weigh."""

import os
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import pandas as pd

from gloss_analysis.commands.observers import note_simulated, simulated_of
from gloss_analysis.commands.waiting import FITTING
from glossspace.console import (
    JsonFlag,
    NumberOfJobs,
    Seed,
    WholeNumber,
    note,
    noted_if_slow,
    print_json,
    print_table,
    print_text,
    progress_bar,
)
from glossspace.errors import GlossError
from glossspace.user_table import read_user_table

if TYPE_CHECKING:
    from gloss_analysis.confirmatory.indscal import ConfirmatoryIndscal
    from gloss_analysis.confirmatory.orthogonality import Orthogonality
    from gloss_analysis.confirmatory.task_identity import TaskIdentity

__all__ = ["confirm"]

# Permutations: more would not end.
_MOST = 1_000_000
# Squares of larger coordinates, and of smaller than their inverse, come near what a number can hold.
_LARGEST = 1e100


def confirm(
    table: Path,
    /,
    *,
    coordinates: Path,
    level: Literal["ratio", "interval", "spline", "ordinal"] = "ordinal",
    ties: Literal["primary", "secondary"] = "primary",
    interval: Literal["t", "bootstrap"] = "t",
    orthogonality: WholeNumber = 0,
    indscal: WholeNumber = 0,
    unconditional: bool = False,
    magnitudes: Path | None = None,
    seed: Seed = 1,
    jobs: NumberOfJobs = 1,
    backend: Literal["threads", "dask"] = "threads",
    scheduler: str | None = None,
    json: JsonFlag = False,
) -> None:
    """Estimate how much given axes weigh in judged dissimilarities (confirmatory MDS).

    The ratio is the weight of the last axis over that of the first: for c and d,
    the gloss paper's 1.78. The population's ratio is the geometric mean over
    participants, with a 95 % interval. The shared ratio is descriptive: it is
    biased upwards where participants differ (simulated: +4 to +12 %). INDSCAL
    sets own weights beside shared ones.

    Examples:

        gloss confirm study/dataset --coordinates coordinates.csv

        gloss confirm pairs.csv --coordinates axes.csv --level ratio --json

        gloss confirm pairs.csv --coordinates axes.csv --orthogonality 199

        gloss confirm pairs.csv --coordinates axes.csv --indscal 199

        gloss confirm study/dataset --coordinates c-d.csv --magnitudes study/dataset

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
    interval
        Of the population's ratio, on logarithms: t is Student's; bootstrap is a studentised bootstrap of 2,000
        resamples of the participants. A percentile bootstrap of nine would cover only 90 %.
    orthogonality
        With two axes: also test whether they are independent, by so many permutations of residuals. 199 is a good
        number.
    indscal
        Also test whether participants weigh the axes differently, by so many permutations of residuals. 199 is a good
        number.
    unconditional
        In the INDSCAL part alone: all participants share one transformation and one scale.
    magnitudes
        Also compare the axes with ratings of single images, on the stimuli of both tasks: a CSV file with the columns
        participant_id, stimulus, rating and, where the stimuli do not tell the axis of the study, axis; or a dataset
        folder.
    seed
        Of everything random.
    jobs
        Threads, 0 for one a core; the result does not depend on it.
    backend
        dask: the cluster at --scheduler permutes for --orthogonality and --indscal in place of this machine's threads.
    scheduler
        Address of a Dask scheduler, such as tcp://host:8786.
    """
    from gloss_analysis.cluster import check_backend, workers
    from gloss_analysis.confirmatory.indscal import confirm_indscal
    from gloss_analysis.confirmatory.orthogonality import check_orthogonality
    from gloss_analysis.confirmatory.scaling import confirm_axes
    from gloss_analysis.confirmatory.task_identity import compare_tasks
    from gloss_analysis.judgements.judgement_table import read_judgements
    from gloss_analysis.judgements.participant_remarks import judgement_remarks, rating_remarks
    from gloss_analysis.ratings.axis_ratings import read_axis_ratings

    for option, number in (("--orthogonality", orthogonality), ("--indscal", indscal)):
        if not 0 <= number <= _MOST:
            raise GlossError(f"Invalid {option} {number}. Allowed: 0 to {_MOST:,}.")
    if indscal and unconditional:
        raise GlossError("--indscal tests conditional fits. Leave it out, or --unconditional.")
    check_backend(backend, scheduler)
    data, judgements = read_judgements(table)
    remarks = judgement_remarks(data, judgements)
    simulated = simulated_of(table, data.participants)
    axes, values = _coordinates(coordinates, data.stimuli)
    with noted_if_slow(FITTING):
        fitted = confirm_axes(data, values, axes=axes, level=level, ties=ties, interval=interval, seed=seed)
    n_jobs = min(jobs or _MOST, os.cpu_count() or 1)
    tasks: tuple[TaskIdentity, ...] | None = None
    if magnitudes is not None:
        ratings = read_axis_ratings(magnitudes, data.stimuli, values, axes=axes)
        remarks += rating_remarks(ratings)
        tasks = compare_tasks(data, values, ratings, axes=axes, level=level, ties=ties, seed=seed, n_jobs=n_jobs)
    fit_own = partial(
        confirm_indscal, data, values, axes=axes, level=level, ties=ties, conditional=not unconditional, seed=seed,
        n_jobs=n_jobs,
    )  # fmt: skip
    if indscal:
        with workers(backend, scheduler), progress_bar() as progress:
            step = progress.add_task("Permutations of weights", total=indscal)
            own = fit_own(
                n_permutations=indscal,
                on_step=lambda done, total: progress.update(step, completed=done, total=total),
            )
    else:
        own = fit_own()
    tested: Orthogonality | None = None
    if orthogonality:
        with workers(backend, scheduler), progress_bar() as progress:
            task = progress.add_task("Permutations", total=orthogonality)
            tested = check_orthogonality(
                data, values, axes=axes, level=level, ties=ties, n_permutations=orthogonality, seed=seed,
                n_jobs=n_jobs,
                on_step=lambda done, total: progress.update(task, completed=done, total=total),
            )  # fmt: skip
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
                "warnings": (*fitted.warnings, *remarks),
                "interval": fitted.interval,
                "orthogonality": None if tested is None else _orthogonality_document(tested),
                "indscal": _indscal_document(own),
                "tasks": None if tasks is None else [asdict(one) | {"sentences": one.sentences} for one in tasks],
            }
        )
        return
    rows = [(name, one.ratio, one.stress1) for name, one in zip(fitted.participants, fitted.individual, strict=True)]
    print_table(pd.DataFrame(rows, columns=["participant", f"{axes[-1]} over {axes[0]}", "Stress-1"]))
    between = "" if fitted.population_ci95 is None else " (95 % {:.4g} to {:.4g})".format(*fitted.population_ci95)
    print(f"Population: {fitted.population_ratio:.4g}{between}. Shared: {fitted.shared.ratio:.4g}.")
    print_text(*own.sentences)
    if tested is not None:
        print_text(*tested.sentences)
    for one_task in tasks or ():
        print_text(*one_task.sentences)
    for warning in (*fitted.warnings, *remarks):
        note(warning)


def _orthogonality_document(tested: "Orthogonality") -> dict[str, Any]:
    document = asdict(tested)
    del document["null_rotated"], document["null_correlated"]
    return document | {"n_permutations": len(tested.null_rotated), "sentences": tested.sentences}


def _indscal_document(own: "ConfirmatoryIndscal") -> dict[str, Any]:
    document = asdict(own)
    del document["null"], document["axes"]
    return document | {"n_permutations": len(own.null), "sentences": own.sentences}


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
    extent = np.ptp(values / 2, axis=0) * 2
    for name, size in zip(axes, extent, strict=True):
        if size and not 1 / _LARGEST <= size <= _LARGEST:
            raise GlossError(
                f"'{path}': the coordinates on the axis {name!r} differ by {size:g}. Allowed: {1 / _LARGEST:g} to "
                f"{_LARGEST:g}. Choose another unit, which changes nothing else."
            )
    return axes, values[[table["stimulus"].tolist().index(name) for name in stimuli]]
