"""gloss design-pairs: which pairs to judge when time is short."""

import os
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
import pandas as pd

from gloss_analysis.commands.planned_study import (
    StudyOptions,
    interval_columns,
    number_of_pairs,
    planned_study,
    print_population,
)
from glossspace.console import (
    FiniteNumber,
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
from glossspace.files import check_replaceable, write_text
from glossspace.user_table import read_user_table

if TYPE_CHECKING:
    from gloss_analysis.design.precision import DesignPrecision

__all__ = ["design_pairs"]

_MOST_STUDIES, _MOST_OBSERVERS = 100_000, 500
_COLUMNS = ["stimulus_a", "stimulus_b"]


def design_pairs(
    *,
    keep: WholeNumber | None = None,
    share: FiniteNumber | None = None,
    degree: WholeNumber = 3,
    identical: bool = False,
    out: Path | None = None,
    study: StudyOptions | None = None,
    observers: WholeNumber = 9,
    studies: WholeNumber = 200,
    seed: Seed = 1,
    jobs: NumberOfJobs = 1,
    backend: Literal["threads", "dask"] = "threads",
    scheduler: str | None = None,
    json: JsonFlag = False,
) -> None:
    """Which pairs to judge when time is short, so that least is lost about the weight of d.

    Pairs are dropped and exchanged by what they tell about the weight
    (c-optimal design of the metric model); the rest hangs together. Simulated
    studies compare them with all pairs and with as many chosen at random.

    Examples:

        gloss design-pairs --keep 120 --out pairs.csv

        gloss design-pairs --share .25 --degree 4 --identical --jobs 0 --json

        gloss design-pairs --keep 60 --like study/dataset --studies 0

    Parameters
    ----------
    keep
        How many pairs of different stimuli to keep.
    share
        Or what part of them, 0 to 1.
    degree
        In how many pairs every stimulus must be.
    identical
        Add the pair of each stimulus with itself. They tell nothing about the weight, but are good practice and show
        whether an observer attends.
    out
        A CSV file for the pairs, with the columns stimulus_a and stimulus_b.
    observers
        Simulated observers of each study that compares designs.
    studies
        Simulated studies of each design; 0 for none.
    seed
        Of everything random.
    jobs
        Processes, 0 for one a core; the result does not depend on it.
    backend
        dask: the cluster at --scheduler does the work in place of this machine.
    scheduler
        Address of a Dask scheduler, such as tcp://host:8786.
    """
    from gloss_analysis.cluster import workers
    from gloss_analysis.design.pair_choice import choose_pairs, thinned_at_random
    from gloss_analysis.design.precision import FEWEST_STUDIES, remarks, simulate_designs

    if studies and not FEWEST_STUDIES <= studies <= _MOST_STUDIES:
        raise GlossError(f"Invalid --studies {studies}. Allowed: 0, or {FEWEST_STUDIES} to {_MOST_STUDIES:,}.")
    if not 2 <= observers <= _MOST_OBSERVERS:
        raise GlossError(f"Invalid --observers {observers}. Allowed: 2 to {_MOST_OBSERVERS}.")
    if out is not None:
        check_replaceable(out, _read_pairs, what="list of pairs")
    planned = planned_study(study or StudyOptions())
    n = len(planned.names)
    every = number_of_pairs(planned)
    count = _count(keep, share, every)
    found: tuple[DesignPrecision, ...] = ()
    cores = os.cpu_count() or 1
    with workers(backend, scheduler), progress_bar() as progress:
        choosing = progress.add_task("Choosing pairs", total=None)
        choice = choose_pairs(
            planned.coordinates, count, planned.population, degree=degree, seed=seed,
            on_step=lambda done, total: progress.update(choosing, completed=done, total=total),
        )  # fmt: skip
        if studies:
            children = np.random.SeedSequence(seed).spawn(studies)
            at_random = np.array([thinned_at_random(n, count, degree=degree, seed=child) for child in children])
            task = progress.add_task("Simulated studies", total=3 * studies)
            found = simulate_designs(
                planned.coordinates, planned.population, observers=[observers],
                pair_sets=[choice.kept, at_random, np.ones(every, dtype=bool)], n_studies=studies, seed=seed,
                n_jobs=min(jobs or cores, cores),
                on_step=lambda done, total: progress.update(task, completed=done, total=total),
            )  # fmt: skip
    first, second = (np.array(planned.names)[index[choice.kept]] for index in np.triu_indices(n, 1))
    pairs = [*zip(first.tolist(), second.tolist(), strict=True)] + (
        [(a, a) for a in planned.names] if identical else []
    )
    if out is not None:
        write_text(out, pd.DataFrame(pairs, columns=_COLUMNS).to_csv(index=False, lineterminator="\n"))
        note(f"Pairs: {out}")
    warnings = (*_untold(choice.relative_error), *(remarks(found[0]) if found else ()))
    named = dict(zip(("chosen", "random", "all"), found, strict=False))
    if json:
        print_json(
            planned.document()
            | {
                "n_pairs": count,
                "n_identical": n if identical else 0,
                "degree": degree,
                "seed": seed,
                "relative_error": choice.relative_error,
                "pairs": pairs,
                "designs": {name: asdict(one) for name, one in named.items()},
                "warnings": warnings,
            }
        )
        return
    print_population(planned)
    known = (
        f" One observer's own weight is known {choice.relative_error:.2f} times less precisely than from all pairs "
        "(local information)."
    )
    print(
        f"{count} of {every} pairs{f' and {n} identical ones' if identical else ''}."
        f"{known if np.isfinite(choice.relative_error) else ''}"
    )
    if named:
        _print(named)
    for warning in warnings:
        note(warning)
    if out is None:
        note("Give --out FILE.csv to keep the pairs.")


def _count(keep: int | None, share: float | None, every: int) -> int:
    if (keep is None) == (share is None):
        raise GlossError("Give how many pairs to keep, either --keep 120 or --share .25.")
    if keep is not None:
        return keep
    assert share is not None
    if not 0 < share <= 1:
        raise GlossError(f"Invalid --share {share:g}. Allowed: above 0, up to 1.")
    return round(share * every)


def _untold(relative_error: float) -> list[str]:
    """What to say where local information does not tell pairs apart."""
    if np.isfinite(relative_error):
        return []
    which = "not even all pairs tell" if np.isnan(relative_error) else "these pairs do not tell"
    return [
        f"By local information {which} the weight: they have few different distances, as those of a regular grid do, "
        "and an unknown response of the slider explains whatever changes with the distance alone. The choice may be no "
        "better than one at random; the simulated studies show it. Stimuli off a grid help."
    ]


def _print(named: "dict[str, DesignPrecision]") -> None:
    found = list(named.values())
    columns = {
        "pairs": list(named),
        "number": [one.n_pairs for one in found],
        "error of one observer, %": [f"{100 * one.observer_error:.1f}" for one in found],
    }
    print_table(
        pd.DataFrame(columns | interval_columns(found)),
        title=f"95 % intervals of {found[0].n_studies} simulated studies of {found[0].n_observers} observers",
    )


def _read_pairs(path: Path) -> pd.DataFrame:
    table = read_user_table(path, what="list of pairs", columns=_COLUMNS)
    if list(table.columns) != _COLUMNS:
        raise GlossError(f"'{path}' has other columns beside {' and '.join(_COLUMNS)}.")
    return table
