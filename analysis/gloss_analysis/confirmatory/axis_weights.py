"""Weights of given axes that fit judgements best: the search behind `scaling`."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize, minimize_scalar
from scipy.stats import qmc

from gloss_analysis.mds.kernels import loss_of_groups, own_pairs
from gloss_analysis.mds.problem import Problem

__all__ = ["AxisWeights", "fit_axis_weights"]

# Axis ratios from 1/100 to 100, relative to axes of equal spread: beyond, one axis contributes nothing visible.
_LOG_RANGE = np.log(100.0)
_COARSE, _FINE = 81, 41
# With three axes or more: points at which the search looks first, and how many of these it starts from.
_LOOKED_AT, _STARTED_FROM = 64, 4
# Stress-1 squared that rounding cannot tell apart.
_SAME_LOSS = 1e-14


@dataclass(frozen=True)
class AxisWeights:
    """Weights of the axes for one participant, or shared by all; they multiply the coordinates.

    Attributes
    ----------
    weights : ndarray, shape (n_axes,)
        The first axis has weight 1.
    ratio : float
        Weight of the last axis over that of the first: the gloss paper's 1.78.
    stress1 : float
        Stress-1 with these weights.
    at_bound : bool
        Whether the search ended at its limit: the judgements follow one of the axes alone.
    """

    weights: np.ndarray
    ratio: float
    stress1: float
    at_bound: bool


def fit_axis_weights(problem: Problem, unit: np.ndarray, extent: np.ndarray) -> AxisWeights:
    """Fit the weights of axes given in units of their `extent`, one set for all sources of the problem.

    Parameters
    ----------
    problem : Problem
    unit : ndarray, shape (n, n_axes)
        Coordinates in units of their extent.
    extent : ndarray, shape (n_axes,)
        In any common unit.

    Returns
    -------
    AxisWeights
        Of the coordinates in their own units, `unit` times `extent`.
    """
    n_axes = unit.shape[1]
    spread = unit.std(axis=0)
    equal_spread = np.log(spread[0] / spread)  # log weights, the first 0

    # Hundreds of evaluations follow one another: work space is made, and pairs whose ties are sorted in place are
    # copied, once.
    pairs, work = own_pairs(problem.pairs), np.empty((5, len(problem.pairs.first)))
    spaces, groups = np.empty((problem.n_sources, *unit.shape)), np.empty(len(problem.orders))
    stacked = spaces.reshape(-1, n_axes)

    def loss(log_weights: np.ndarray) -> float:
        spaces[:] = unit * np.exp(log_weights)
        loss_of_groups(pairs, stacked, work, groups)
        return float(pairs.share @ groups)

    if n_axes == 1:
        log_weights = np.zeros(1)
    elif n_axes == 2:
        log_ratio = _lowest(lambda x: loss(np.array([0.0, x])), float(equal_spread[1]))
        log_weights = np.array([0.0, log_ratio])
    else:
        free = _lowest_in_box(lambda x: loss(np.concatenate([[0.0], x])), equal_spread[1:])
        log_weights = np.concatenate([[0.0], free])
    weights = np.exp(log_weights) * (extent[0] / extent)
    return AxisWeights(
        weights=weights,
        ratio=float(weights[-1]),
        stress1=float(np.sqrt(loss(log_weights))),
        at_bound=bool(np.any(np.abs(log_weights - equal_spread) > 0.999 * _LOG_RANGE)),
    )


def _lowest(function: Callable[[float], float], centre: float) -> float:
    """Where a function of one variable is lowest within _LOG_RANGE of `centre`: grid, finer grid, then golden section.

    Monotone regression makes small dents in the curve, which a search from one point would fall into, and flat
    bottoms, of which the middle is taken.
    """
    low, high = centre - _LOG_RANGE, centre + _LOG_RANGE
    for points in (_COARSE, _FINE):
        grid = np.linspace(low, high, points)
        losses = np.array([function(x) for x in grid])
        bottom = _bottom(losses)
        low, high = grid[max(bottom[0] - 1, 0)], grid[min(bottom[-1] + 1, points - 1)]
    middle = float((grid[bottom[0]] + grid[bottom[-1]]) / 2)
    found = minimize_scalar(function, bounds=(low, high), method="bounded", options={"xatol": 1e-9})
    return float(found.x) if found.fun < function(middle) - _SAME_LOSS else middle


def _bottom(losses: np.ndarray) -> np.ndarray:
    """Indices of the unbroken run of lowest losses round the first lowest one."""
    lowest = int(np.argmin(losses))
    higher = np.flatnonzero(losses > losses[lowest] + _SAME_LOSS)
    before, after = higher[higher < lowest], higher[higher > lowest]
    return np.arange(before.max(initial=-1) + 1, after.min(initial=len(losses)))


def _lowest_in_box(function: Callable[[np.ndarray], float], centre: np.ndarray) -> np.ndarray:
    """Where a function is lowest within _LOG_RANGE of `centre`, by Nelder and Mead from the best of many points."""
    box = [(c - _LOG_RANGE, c + _LOG_RANGE) for c in centre]
    spread_out = qmc.Sobol(len(centre), scramble=False).random(_LOOKED_AT)
    looked_at = [centre, *(centre + _LOG_RANGE * (2 * spread_out - 1))]
    starts = sorted(looked_at, key=function)[:_STARTED_FROM]
    options = {"xatol": 1e-6, "fatol": 1e-12, "maxiter": 4000}
    found = [minimize(function, start, method="Nelder-Mead", bounds=box, options=options) for start in starts]
    return np.asarray(min(found, key=lambda one: one.fun).x)
