"""Confirmatory MDS: the coordinates are given functions of the stimuli, and only the weights of the axes are estimated.

This is how the gloss paper finds that distinctness of image weighs 1.78 times contrast gloss. The objective is the one
of every scaling here (`objective`), so any level and tie rule can be used; ordinal is the default, because a slider
that compresses large differences biases a ratio-level fit upward.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize, minimize_scalar
from scipy.stats import qmc
from scipy.stats import t as student_t

from gloss_analysis.dissimilarity import Dissimilarities
from gloss_analysis.mds.diagnostics import all_flat, check_scalable, data_warnings, distinguishes
from gloss_analysis.mds.disparities import Level, Ties
from gloss_analysis.mds.objective import mean_square_stress, source_distances
from gloss_analysis.mds.problem import Problem, make_problem
from glossspace.errors import GlossError

__all__ = ["AxisWeights", "ConfirmatoryFit", "confirm_axes"]

# Axis ratios from 1/100 to 100, relative to axes of equal spread: beyond, one axis contributes nothing visible.
_LOG_RANGE = np.log(100.0)
# Axes whose spread across each other is less than this part of that along them are one axis but for rounding.
_SAME_DIRECTION = 1e-9
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


@dataclass(frozen=True)
class ConfirmatoryFit:
    """Axis weights of every participant, of the population they stand for, and of one shared fit.

    Attributes
    ----------
    axes, participants : tuple of str
    individual : tuple of AxisWeights
        One a participant who could be fitted; `participants` names them, and `warnings` the others.
    population_ratio : float
        Geometric mean of the participants' ratios, those at the limit of the search included.
    population_ci95 : tuple of float, or None
        95 % t interval of it, on the logarithms; None with fewer than two participants.
    shared : AxisWeights
        One set of weights for all, each participant at a scale of its own. Descriptive: biased where participants
        differ.
    warnings : tuple of str
    """

    axes: tuple[str, ...]
    participants: tuple[str, ...]
    individual: tuple[AxisWeights, ...]
    population_ratio: float
    population_ci95: tuple[float, float] | None
    shared: AxisWeights
    warnings: tuple[str, ...]


def confirm_axes(
    data: Dissimilarities,
    coordinates: np.ndarray,
    *,
    axes: tuple[str, ...],
    level: Level = "ordinal",
    ties: Ties = "primary",
) -> ConfirmatoryFit:
    """Estimate how much each given axis weighs in the judged dissimilarities.

    Parameters
    ----------
    data : Dissimilarities
        m participants, n stimuli.
    coordinates : ndarray, shape (n, n_axes)
        Position of each stimulus along each axis, in the order of `data.stimuli`.
    axes : tuple of str
        Names of the axes.
    level, ties
        See `gloss_analysis.mds.scale`.

    Returns
    -------
    ConfirmatoryFit

    Raises
    ------
    GlossError
        Coordinates do not fit the data, are not finite, are the same for all stimuli on an axis, or do not tell the
        axes apart; or no participant's judgements can be fitted.

    Notes
    -----
    With two axes the weights have one free number, the ratio; it is found on a grid over four decades, then refined.
    Where order alone leaves a range of ratios equally good, its middle is taken. With more axes, by Nelder and Mead's
    search on log weights from the best of many points in that range.
    """
    coordinates = np.asarray(coordinates, dtype=float)
    if coordinates.shape != (len(data.stimuli), len(axes)):
        raise GlossError(
            f"Coordinates of shape {coordinates.shape} do not fit {len(data.stimuli)} stimuli and {len(axes)} axes."
        )
    if not np.all(np.isfinite(coordinates)):
        raise GlossError("Coordinates must be finite numbers.")
    # Halved, so that coordinates at both ends of the floating-point range do not overflow.
    half = np.ptp(coordinates / 2, axis=0)
    # Not by the standard deviation: that of equal numbers may be a rounding error above 0.
    flat = [name for name, extent in zip(axes, half, strict=True) if extent == 0]
    if flat:
        raise GlossError(f"All stimuli have the same coordinate on the axis {flat[0]!r}: its weight cannot be known.")
    # In units of its extent, so that squares neither overflow nor vanish whatever the unit of an axis.
    unit = (coordinates / 2 - (coordinates / 2).min(axis=0)) / half
    singular = np.linalg.svd(unit - unit.mean(axis=0), compute_uv=False)
    if len(singular) < len(axes) or singular[-1] < _SAME_DIRECTION * singular[0]:
        raise GlossError(
            f"The axes {', '.join(axes)} are multiples or sums of each other on these stimuli, so that their weights "
            "cannot be told apart. Leave one out."
        )
    check_scalable(data, level=level, ties=ties)

    remarks = list(data_warnings(data, level=level, ties=ties))
    participants, individual, unseen, unrelated = [], [], [], []
    first, second = data.pairs
    apart = unit[first] != unit[second]
    for name, row in zip(data.participants, data.values, strict=True):
        if not distinguishes(row):
            continue  # data_warnings names this participant
        if not apart[~np.isnan(row)].any(axis=0).all():
            unseen.append(name)
            continue
        one = make_problem(data.of((name,)), level=level, ties=ties)
        participants.append(name)
        individual.append(_fit_weights(one, unit, half))
        if all_flat(one, source_distances(unit, individual[-1].weights[np.newaxis] * half / half[0])):
            unrelated.append(name)
    if unseen:
        remarks.append(
            f"Judged no pair that differs along some axis, so that its weight is not known: {_list(unseen)}."
        )
    if unrelated:
        remarks.append(
            "Judgements do not rise with the distances that the axes make, so that the ratio tells nothing, for: "
            f"{_list(unrelated)}. Was the scale reversed?"
        )
    if not individual:
        raise GlossError(" ".join(["No participant's axis weights can be fitted.", *remarks]))
    bound = [name for name, fit in zip(participants, individual, strict=True) if fit.at_bound]
    if bound:
        remarks.append(
            f"Judgements follow one axis alone, so that the ratio is only a limit, for: {_list(bound)}. The "
            "population's ratio and interval move with that limit; leave these participants out to see how far."
        )

    logs = np.log([fit.ratio for fit in individual])
    shared = _fit_weights(make_problem(data, level=level, ties=ties), unit, half)
    return ConfirmatoryFit(
        axes=axes,
        participants=tuple(participants),
        individual=tuple(individual),
        population_ratio=float(np.exp(logs.mean())),
        population_ci95=_t_interval(logs),
        shared=shared,
        warnings=tuple(remarks),
    )


def _list(names: list[str]) -> str:
    return ", ".join(names)


def _t_interval(logs: np.ndarray) -> tuple[float, float] | None:
    if len(logs) < 2:
        return None
    half = student_t.ppf(0.975, len(logs) - 1) * logs.std(ddof=1) / np.sqrt(len(logs))
    return float(np.exp(logs.mean() - half)), float(np.exp(logs.mean() + half))


def _fit_weights(problem: Problem, unit: np.ndarray, extent: np.ndarray) -> AxisWeights:
    """Fit the weights of axes given in units of their `extent`; the result is in their own units."""
    n_axes = unit.shape[1]
    spread = unit.std(axis=0)
    equal_spread = np.log(spread[0] / spread)  # log weights, the first 0

    def loss(log_weights: np.ndarray) -> float:
        weights = np.broadcast_to(np.exp(log_weights), (problem.n_sources, n_axes))
        return mean_square_stress(problem, unit, weights)

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
