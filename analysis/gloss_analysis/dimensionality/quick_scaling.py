"""Scaling of drawn or reduced judgements: few starts, and on a line no search over orders, as there are many of them.

Stress found so is a little higher than that of `scale`, and may be compared only with stress found in the same way.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds import Level, MdsSolution, Model, Ties, scale
from gloss_analysis.mds.descent import descend_all
from gloss_analysis.mds.diagnostics import check_scalable
from gloss_analysis.mds.kernels import FIXED
from gloss_analysis.mds.objective import fitted_disparities, source_distances
from gloss_analysis.mds.problem import make_problem
from gloss_analysis.mds.starts import random_start, torgerson_configuration
from glossspace.errors import GlossError

__all__ = ["QuickFit", "possible_dims", "quick_curve"]

_DIRECTIONS, _RANDOM_LINES, _STEPS = 8, 32, 500


@dataclass(frozen=True)
class QuickFit:
    """What a solution says about pairs.

    Attributes
    ----------
    n_dims : int
    stress1 : float
    distances, disparities : ndarray, shape (m, n (n - 1) / 2)
    """

    n_dims: int
    stress1: float
    distances: np.ndarray
    disparities: np.ndarray


def possible_dims(data: Dissimilarities, dims: Sequence[int]) -> tuple[int, ...]:
    """Those numbers of dimensions that the stimuli have room for, rising.

    Raises
    ------
    GlossError
        There are none, or one is below 1.
    """
    room = len(data.stimuli) - 1
    wanted = tuple(sorted({p for p in dims if p <= room}))
    if not wanted or wanted[0] < 1:
        raise GlossError(f"Invalid numbers of dimensions = {tuple(dims)}. Allowed: 1 to {room} for {room + 1} stimuli.")
    return wanted


def quick_curve(
    data: Dissimilarities,
    dims: Sequence[int],
    *,
    model: Model,
    level: Level,
    ties: Ties,
    conditional: bool,
    n_starts: int,
    seed: int,
) -> tuple[QuickFit, ...]:
    """Scale in each number of dimensions; each solution is a start of the next.

    Parameters
    ----------
    data, model, level, ties, conditional, n_starts, seed
        See `gloss_analysis.mds.scale`.
    dims : sequence of int
        Rising.

    Returns
    -------
    tuple of QuickFit

    Raises
    ------
    GlossError
        Data or a parameter that `scale` refuses.
    """
    fits: list[QuickFit] = []
    last: list[MdsSolution] = []
    for n_dims in dims:
        if n_dims == 1 and conditional:
            fits.append(_line(data, level, ties, seed))
            continue
        solution = scale(
            data,
            n_dims=n_dims,
            model=model,
            level=level,
            ties=ties,
            conditional=conditional,
            n_starts=n_starts,
            seed=seed,
            initial=last,
        )
        last = [solution]
        fits.append(QuickFit(n_dims, solution.stress1, solution.distances, solution.disparities))
    return tuple(fits)


def _line(data: Dissimilarities, level: Level, ties: Ties, seed: int) -> QuickFit:
    check_scalable(data, level=level, ties=ties)
    problem = make_problem(data, level=level, ties=ties)
    plane = torgerson_configuration(data, 2)
    rng = np.random.default_rng(seed)
    # Orders that come from the data are worth more than random ones.
    angles = np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    lines = [plane @ np.array([[np.cos(angle)], [np.sin(angle)]]) for angle in angles]
    lines += [random_start(len(data.stimuli), 1, rng) for _ in range(_RANDOM_LINES)]
    alike = np.ones((len(data.participants), 1, 1))
    best = descend_all(problem, [(line, alike) for line in lines], model=FIXED, steps=_STEPS)[0]
    distances = source_distances(best.coordinates, best.transforms)
    return QuickFit(1, float(np.sqrt(max(best.value, 0.0))), distances, fitted_disparities(problem, distances))
