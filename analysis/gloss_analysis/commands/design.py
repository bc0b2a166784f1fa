"""gloss design: how many observers, pairs and repeats give an interval of a wanted width."""

import os
from dataclasses import asdict
from typing import TYPE_CHECKING, Literal

import numpy as np
import pandas as pd

from gloss_analysis.commands.planned_study import (
    PlannedStudy,
    StudyOptions,
    interval_columns,
    number_of_pairs,
    numbers,
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

if TYPE_CHECKING:
    from gloss_analysis.design.precision import DesignPrecision

__all__ = ["design"]

# Simulated studies, and observers of one: more would not end.
_MOST_STUDIES, _MOST_OBSERVERS = 100_000, 500


def design(
    *,
    width: FiniteNumber = 1.25,
    observers: str = "6:30",
    pairs: str | None = None,
    repeats: str = "1",
    study: StudyOptions | None = None,
    studies: WholeNumber = 400,
    seed: Seed = 1,
    jobs: NumberOfJobs = 1,
    backend: Literal["threads", "dask"] = "threads",
    scheduler: str | None = None,
    json: JsonFlag = False,
) -> None:
    """How many observers, pairs and repeats a wanted precision needs.

    It is that of the weight of d. Studies are simulated: observers drawn from
    a population judge pairs, and ordinal confirmatory MDS gives the 95 %
    interval, as in gloss confirm. Its width is the upper bound over the lower one. The smallest design is
    that of fewest judgements. gloss design-pairs says which pairs to judge.

    Examples:

        gloss design --width 1.25

        gloss design --observers 6:20 --pairs 351,120,60 --repeats 1,2 --jobs 0

        gloss design --like study/dataset --observers 8,10,12:20 --json

    Parameters
    ----------
    width
        Wanted, above 1: 1.25 is an upper bound 25 % above the lower one.
    observers
        Numbers of observers to try.
    pairs
        Numbers of pairs to try, by default all; with fewer, those that gloss design-pairs chooses.
    repeats
        How often each pair is judged, numbers to try.
    studies
        Simulated studies of each combination of pairs and repeats.
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
    from gloss_analysis.design.pair_choice import choose_pairs
    from gloss_analysis.design.precision import FEWEST_STUDIES, check_width, remarks, simulate_designs, smallest_design

    check_width(width)
    tried = numbers(observers, option="--observers", least=2)
    times = numbers(repeats, option="--repeats", least=1)
    if tried[-1] > _MOST_OBSERVERS:
        raise GlossError(f"Invalid --observers {observers!r}. Allowed: up to {_MOST_OBSERVERS}.")
    if not FEWEST_STUDIES <= studies <= _MOST_STUDIES:
        raise GlossError(f"Invalid --studies {studies}. Allowed: {FEWEST_STUDIES} to {_MOST_STUDIES:,}.")
    planned = planned_study(study or StudyOptions())
    every = number_of_pairs(planned)
    counts = [every] if pairs is None else numbers(pairs, option="--pairs", least=1)[::-1]
    cores = os.cpu_count() or 1
    with workers(backend, scheduler), progress_bar() as progress:
        choosing = progress.add_task("Choosing pairs", total=len(counts))
        sets = []
        for count in counts:
            whole = np.ones(every, dtype=bool)
            if count != every:
                whole = choose_pairs(planned.coordinates, count, planned.population, seed=seed).kept
            sets.append(whole)
            progress.advance(choosing)
        task = progress.add_task("Simulated studies", total=None)
        found = simulate_designs(
            planned.coordinates, planned.population, observers=tried, pair_sets=sets, repeats=times,
            n_studies=studies, seed=seed, n_jobs=min(jobs or cores, cores),
            on_step=lambda done, total: progress.update(task, completed=done, total=total),
        )  # fmt: skip
    assured, expected = (smallest_design(found, width, assured=sure) for sure in (True, False))
    meant = [one for one in (assured, expected) if one is not None] or [found[-1]]
    warnings = list(dict.fromkeys(remark for one in meant for remark in remarks(one)))
    if json:
        print_json(
            planned.document()
            | {
                "width": width,
                "n_studies": studies,
                "seed": seed,
                "designs": [_document(one) for one in found],
                "smallest": None if assured is None else _document(assured),
                "smallest_expected": None if expected is None else _document(expected),
                "warnings": warnings,
            }
        )
        return
    _print(planned, found, width, assured, expected)
    for warning in warnings:
        note(warning)


def _document(one: "DesignPrecision") -> dict[str, object]:
    return asdict(one) | {"n_judgements": one.n_judgements}


def _print(
    planned: PlannedStudy,
    found: "tuple[DesignPrecision, ...]",
    width: float,
    assured: "DesignPrecision | None",
    expected: "DesignPrecision | None",
) -> None:
    print_population(planned)
    columns = {
        "observers": [one.n_observers for one in found],
        "pairs": [one.n_pairs for one in found],
        "repeats": [one.n_repeats for one in found],
        "judgements": [one.n_judgements for one in found],
    }
    print_table(
        pd.DataFrame(columns | interval_columns(found)),
        title=f"95 % intervals of {found[0].n_studies} simulated studies",
    )
    narrowest = (min(one.width_p90 for one in found), min(one.width_median for one in found))
    for what, smallest, least in (("9 of 10", assured, narrowest[0]), ("half of the", expected, narrowest[1])):
        if smallest is None:
            print(
                f"No design has intervals up to {width:g} wide in {what} studies; the narrowest reaches "
                f"{least:.3g}. Try more observers: their spread, not noise, may set the limit."
            )
        else:
            print(
                f"Up to {width:g} wide in {what} studies: {smallest.n_observers} observers, {smallest.n_pairs} pairs, "
                f"{_times(smallest.n_repeats)}, {smallest.n_judgements:,} judgements in all."
            )


def _times(n_repeats: int) -> str:
    return "once each" if n_repeats == 1 else f"{n_repeats} times each"
