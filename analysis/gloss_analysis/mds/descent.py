"""Local minimisation of the objective from many starts, in parallel."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from joblib import Parallel, delayed

from gloss_analysis.mds.kernels import DIAGONAL, FULL, Form, descend
from gloss_analysis.mds.problem import Problem
from gloss_analysis.mds.restriction import FREE, Restriction

__all__ = ["Run", "Start", "descend_all", "jittered"]

# One call of a kernel cannot be interrupted, so it is given work for a second or two.
_PAIRS_A_CALL = 1e8
_FEWEST_STEPS_A_CALL = 40

Start = tuple[np.ndarray, np.ndarray]
"""Coordinates, shape (n, p), and matrices C_k, shape (m, p, p)."""


@dataclass(frozen=True)
class Run:
    """Where a minimisation ended.

    Attributes
    ----------
    value : float
        The objective.
    coordinates : ndarray, shape (n, p)
    transforms : ndarray, shape (m, p, p)
    steps : int
    converged : bool
        Whether it ended by itself rather than at its step limit.
    """

    value: float
    coordinates: np.ndarray
    transforms: np.ndarray
    steps: int
    converged: bool

    @property
    def start(self) -> Start:
        """The end as a start of something else."""
        return self.coordinates, self.transforms


def descend_all(
    problem: Problem,
    starts: Sequence[Start],
    *,
    model: int,
    steps: int,
    restriction: Restriction = FREE,
    relative: float = 1e-9,
    n_jobs: int = 1,
) -> list[Run]:
    """Minimise from all starts; best first, equal ones in the order of their starts.

    Parameters
    ----------
    problem : Problem
    starts : sequence of Start
    model : int
        What of the C_k is free: kernels.FIXED, DIAGONAL or FULL.
    steps : int
        Limit of the steps of each.
    restriction : Restriction
        Of the coordinates.
    relative : float
        A run ends when three steps in a row lower the objective by less than this part of it.
    n_jobs : int
        Threads (joblib); the kernels hold no lock. The result does not depend on it.

    Returns
    -------
    list of Run
    """
    run = delayed(_descend_from)
    parallel = Parallel(n_jobs=n_jobs, backend="threading")
    runs = parallel(run(problem, start, model, steps, restriction, relative) for start in starts)
    return sorted(runs, key=lambda one: one.value)


def _descend_from(
    problem: Problem, start: Start, model: int, steps: int, restriction: Restriction, relative: float
) -> Run:
    coordinates, transforms = start
    n, p = coordinates.shape
    if not restriction.has_scale:
        # Unit mean square puts all parameters on one scale, which L-BFGS needs; the objective does not change.
        centred = coordinates - coordinates.mean(axis=0)
        size = np.sqrt(np.mean(centred**2))
        coordinates = centred / size if size > 0 else centred
    base = np.zeros((n, p)) if restriction.base is None else restriction.base
    design = np.empty((0, 0)) if restriction.design is None else restriction.design
    free = coordinates if restriction.is_free else np.linalg.lstsq(design, coordinates - base)[0]
    parts = [free.ravel()]
    if model == DIAGONAL:
        parts.append(np.einsum("krr->kr", transforms).ravel())
    elif model == FULL:
        parts.append(transforms.ravel())
    theta = np.concatenate(parts)
    form = Form(model, np.ascontiguousarray(transforms), np.ascontiguousarray(base), np.ascontiguousarray(design))
    a_call = int(max(_PAIRS_A_CALL / max(len(problem.pairs.first), 1), _FEWEST_STEPS_A_CALL))
    done = 0
    converged = 0
    value = np.inf
    while done < steps and not converged:
        value, taken, converged = descend(
            problem.pairs, form, theta, min(steps - done, a_call), relative, np.finfo(float).tiny
        )
        done += max(int(taken), 1)
    used = free.size
    coordinates = theta[:used].reshape(n, p) if restriction.is_free else base + design @ theta[:used].reshape(-1, p)
    if model == DIAGONAL:
        weights = theta[used:].reshape(-1, p)
        transforms = weights[:, :, np.newaxis] * np.eye(p)
    elif model == FULL:
        transforms = theta[used:].reshape(-1, p, p)
    return Run(float(value), coordinates, transforms, done, bool(converged))


def jittered(coordinates: np.ndarray) -> np.ndarray:
    """Spread the points a little in dimensions that a start leaves empty: without a gradient they would stay so."""
    size = np.sqrt(np.mean(coordinates**2)) or 1.0
    empty = np.ptp(coordinates, axis=0) <= 1e-9 * size
    return coordinates + 1e-3 * size * np.random.default_rng(0).standard_normal(coordinates.shape) * empty
