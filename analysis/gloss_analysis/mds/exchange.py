"""Beyond many starts: points of good solutions exchange places, and the result settles anew.

A poor local minimum often has a few points on the wrong side of others, which no small step brings back. From the best
minima found so far, a few points trade places in a ring; what settles lower joins the best. On hard data (few stimuli,
high stress) this finds with a hundred tries what a thousand random starts miss.
"""

import numpy as np

from gloss_analysis.mds.descent import Run, descend_all
from gloss_analysis.mds.problem import Problem
from gloss_analysis.mds.restriction import Restriction

__all__ = ["distinct", "exchange_points", "exchanged"]

# Measured on published data sets: rounds without success after which nothing more was found, and minima to start from.
# With more judgements than so many the landscape is smoother, and rounds are dearer.
_PATIENCE, _MINIMA = 16, 10
_MANY_PAIRS, _PATIENCE_WITH_MANY = 1000, 4
_SETTLING_STEPS = 60
_POLISHED = 3
_MOST_IN_A_RING = 5


def exchange_points(
    problem: Problem,
    runs: list[Run],
    *,
    model: int,
    restriction: Restriction,
    tries: int,
    steps: int,
    relative: float,
    same: float,
    rng: np.random.Generator,
    n_jobs: int,
) -> Run:
    """Look for a lower minimum than the best of `runs` by exchanging points.

    Parameters
    ----------
    problem : Problem
    runs : list of Run
        Minima, best first.
    model, restriction, n_jobs
        See `descend_all`.
    tries : int
        Exchanges a round.
    steps, relative
        Limit and accuracy of the last descent.
    same : float
        Minima whose objectives agree to this part are the same one.
    rng : Generator

    Returns
    -------
    Run
        The best, which may be the first of `runs`.

    Notes
    -----
    Where half of the runs already ended at the best minimum, one round is made; else rounds go on until sixteen in
    a row have found nothing, four where there are more than a thousand judgements.
    """
    easy = sum(run.value <= runs[0].value * (1 + same) + same**2 for run in runs) >= len(runs) / 2
    many = len(problem.pairs.first) > _MANY_PAIRS
    patience = 1 if easy else _PATIENCE_WITH_MANY if many else _PATIENCE
    minima = distinct(runs, same)[:_MINIMA]
    left = patience
    while left > 0:
        chosen = [minima[index % len(minima)] for index in range(tries)]
        starts = [(exchanged(run.coordinates, rng), run.transforms) for run in chosen]
        settled = descend_all(
            problem, starts, model=model, steps=_SETTLING_STEPS, restriction=restriction, n_jobs=n_jobs
        )
        polished = descend_all(
            problem,
            [run.start for run in settled[:_POLISHED]],
            model=model,
            steps=steps,
            restriction=restriction,
            relative=relative,
            n_jobs=n_jobs,
        )
        before = minima[0].value
        minima = distinct(sorted(minima + polished, key=lambda run: run.value), same)[:_MINIMA]
        # Improvements below what tells two minima apart are the solver's last digits.
        left = patience if minima[0].value < before * (1 - same) - same**2 else left - 1
    return minima[0]


def distinct(runs: list[Run], same: float) -> list[Run]:
    """Leave out runs that ended at the minimum of the one before; `runs` are sorted, best first."""
    kept = runs[:1]
    for run in runs[1:]:
        if run.value > kept[-1].value * (1 + same) + same**2:
            kept.append(run)
    return kept


def exchanged(coordinates: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Let two to five points trade places in a ring; shape (n, p)."""
    n = len(coordinates)
    ring = rng.choice(n, min(int(rng.integers(2, _MOST_IN_A_RING + 1)), n), replace=False)
    traded = coordinates.copy()
    traded[ring] = coordinates[np.roll(ring, 1)]
    return traded
