"""Where two gloss spaces differ by more than their uncertainty."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from glossspace.errors import GlossError
from glossspace.metric.axes import Paint, contrast_gloss, distinctness
from glossspace.metric.space import AxisFunction, GlossSpace
from glossspace.metric.validity import conserves_energy

__all__ = ["DistanceDifference", "Estimate", "RangeOverlap", "SpaceComparison", "compare_spaces"]

_NORMAL_95 = 1.959963984540054
_PARAMETERS = ("rho_d", "rho_s", "alpha")
# The gloss paper's Experiment 1 (section 3.2.3.1): where two spaces are compared that tell no range.
_USUAL = {"rho_d": (0.03, 0.767), "rho_s": (0.033, 0.099), "alpha": (0.04, 0.1)}
_SAME = 1e-9
_NOTHING = 1e-100


@dataclass(frozen=True)
class Estimate:
    """One positive quantity in two spaces, compared as a ratio.

    Attributes
    ----------
    a, b : float
        The quantity in each; NaN where it is not defined.
    ratio, log_ratio : float
        b / a, and its natural logarithm.
    ratio_ci95 : tuple of float or None
        95 % interval of the ratio; None where neither space tells how sure its value is.
    differs : bool or None
        Whether the interval excludes 1.
    """

    a: float
    b: float
    ratio: float
    log_ratio: float
    ratio_ci95: tuple[float, float] | None
    differs: bool | None


@dataclass(frozen=True)
class RangeOverlap:
    """One parameter of the paints that were judged.

    Attributes
    ----------
    parameter : str
    a, b : (low, high) or None
        None where the space does not tell.
    common : (low, high) or None
        What both cover, or the one that tells; None where they have nothing in common, or neither tells.
    share : float or None
        Length of the common part over that of both together; None unless both tell.
    """

    parameter: str
    a: tuple[float, float] | None
    b: tuple[float, float] | None
    common: tuple[float, float] | None
    share: float | None


@dataclass(frozen=True)
class DistanceDifference:
    """The pair of paints about which two spaces disagree most, each space at a scale of its own.

    Attributes
    ----------
    paint_1, paint_2 : Paint
        Of pairs that tie, the furthest apart.
    ratio, relative_difference : float
        Distance in b over that in a, with the root mean square over all pairs of the grid made equal; ratio - 1.
    median_factor : float
        Median over pairs of the ratio or its inverse, whichever is above 1.
    n_paints : int
        Paints of the grid; those that would reflect more than they receive are not in it.
    """

    paint_1: Paint
    paint_2: Paint
    ratio: float
    relative_difference: float
    median_factor: float
    n_paints: int


@dataclass(frozen=True)
class SpaceComparison:
    """Two gloss spaces side by side; the remarks tell what is not known, and what was assumed instead.

    Attributes
    ----------
    weight : Estimate
        Of weight_d / weight_c.
    slopes : mapping of axis to Estimate
        Relative slopes of the ratings, for each axis rated in both: slope over the rating in the middle of the common
        range, so that the unit of the ratings drops out.
    r_squared : mapping of axis to (a, b)
    ranges : tuple of RangeOverlap
        Of rho_d, rho_s, alpha.
    distances : DistanceDifference or None
        None where no two paints of different gloss are common to both.
    remarks : tuple of str
    """

    weight: Estimate
    slopes: Mapping[str, Estimate]
    r_squared: Mapping[str, tuple[float, float]]
    ranges: tuple[RangeOverlap, ...]
    distances: DistanceDifference | None
    remarks: tuple[str, ...]


def compare_spaces(a: GlossSpace, b: GlossSpace, *, n: int = 5) -> SpaceComparison:
    """Compare two gloss spaces: weights, axis functions, ranges of stimuli, distances.

    Parameters
    ----------
    a, b : GlossSpace
    n : int
        Values of each parameter in the grid of paints, 2 to 12.

    Returns
    -------
    SpaceComparison

    Raises
    ------
    GlossError
        n is not allowed.

    Notes
    -----
    The interval of a ratio takes the two values' logarithms as normal and independent. Half the width of each 95 %
    interval counts as 1.96 standard errors; those of t are wider, so that with few observers a difference is rather
    missed than invented. The standard error of a slope's logarithm is sqrt((1 - r^2) / (r^2 (n - 2))); the error of the
    rating in the middle, which is much smaller, is left out.

    Examples
    --------
    >>> one, other = GlossSpace(weight_d_ci95=(1.6, 1.98)), GlossSpace(weight_d=3.0, weight_d_ci95=(2.5, 3.6))
    >>> compare_spaces(one, other).weight.differs
    True
    """
    if isinstance(n, bool) or not isinstance(n, int) or not 2 <= n <= 12:
        raise GlossError(f"Invalid n = {n!r} values of each parameter in the grid. Allowed: a whole number, 2 to 12.")
    remarks: list[str] = []
    ranges = tuple(_overlap(name, a, b) for name in _PARAMETERS)
    grid = _grid_ranges(ranges, remarks)
    weight = _weight(a, b, remarks)
    slopes, r_squared = {}, {}
    for axis in ("c", "d"):
        ours, theirs = a.axis_functions.get(axis), b.axis_functions.get(axis)
        if ours is None or theirs is None:
            who = " and ".join(name for name, one in (("a", ours), ("b", theirs)) if one is None)
            remarks.append(f"No ratings along {axis} in {who}: its axis functions cannot be compared.")
            continue
        r_squared[axis] = (ours.r_squared, theirs.r_squared)
        if grid is not None:
            slopes[axis] = _slopes(axis, ours, theirs, _middle(axis, grid), remarks)
    distances = None if grid is None else _distances(a, b, grid, n)
    if grid is not None and distances is None:
        remarks.append("The common range holds no two paints that differ in gloss: distances are not compared.")
    return SpaceComparison(weight, slopes, r_squared, ranges, distances, tuple(remarks))


def _weight(a: GlossSpace, b: GlossSpace, remarks: list[str]) -> Estimate:
    errors: list[float | None] = []
    for name, space in (("a", a), ("b", b)):
        ci95 = space.weight_d_ci95
        if ci95 is None:
            remarks.append(f"The weight of d in {name} has no interval: it is taken as exact.")
            errors.append(None)
        elif ci95[0] <= 0:
            remarks.append(
                f"The interval of the weight of d in {name}, {ci95[0]:g} to {ci95[1]:g}, does not lie above 0 and has "
                "no logarithm: the weight is taken as exact."
            )
            errors.append(None)
        else:
            errors.append((math.log(ci95[1]) - math.log(ci95[0])) / 2 / _NORMAL_95)
    return _estimate(a.weight_d / a.weight_c, b.weight_d / b.weight_c, errors)


def _slopes(axis: str, a: AxisFunction, b: AxisFunction, middle: float, remarks: list[str]) -> Estimate:
    values, errors = [], []
    for name, one in (("a", a), ("b", b)):
        rating = one.intercept + one.slope * middle
        possible = one.slope > 0 and rating > 0
        if not possible:
            remarks.append(
                f"Ratings along {axis} in {name} have the slope {one.slope:g} and are {rating:g} in the middle of the "
                "common range; both must be above 0 to be compared as ratios."
            )
        values.append(one.slope / rating if possible else math.nan)
        known = possible and one.n_stimuli > 2 and 0 < one.r_squared <= 1
        errors.append(math.sqrt((1 - one.r_squared) / one.r_squared / (one.n_stimuli - 2)) if known else None)
        if possible and not known:
            remarks.append(f"How sure the slope along {axis} in {name} is cannot be told: it is taken as exact.")
    return _estimate(values[0], values[1], errors)


def _estimate(a: float, b: float, errors: list[float | None]) -> Estimate:
    with np.errstate(all="ignore"):  # weights of any size are allowed; what no float holds becomes infinite
        log_ratio = float(np.log(b) - np.log(a))
    interval, differs = None, None
    if math.isfinite(log_ratio) and any(error is not None for error in errors):
        half = _NORMAL_95 * math.hypot(*(error or 0.0 for error in errors))
        interval = (_exp(log_ratio - half), _exp(log_ratio + half))
        differs = abs(log_ratio) > half
    return Estimate(a, b, _exp(log_ratio), log_ratio, interval, differs)


def _exp(value: float) -> float:
    with np.errstate(all="ignore"):
        return float(np.exp(value))


def _overlap(parameter: str, a: GlossSpace, b: GlossSpace) -> RangeOverlap:
    ours, theirs = a.stimulus_range.get(parameter), b.stimulus_range.get(parameter)
    if ours is None or theirs is None:
        return RangeOverlap(parameter, ours, theirs, ours or theirs, None)
    low, high = max(ours[0], theirs[0]), min(ours[1], theirs[1])
    if low > high:
        return RangeOverlap(parameter, ours, theirs, None, 0.0)
    whole = max(ours[1], theirs[1]) - min(ours[0], theirs[0])
    return RangeOverlap(parameter, ours, theirs, (low, high), (high - low) / whole if whole > 0 else 1.0)


def _grid_ranges(ranges: tuple[RangeOverlap, ...], remarks: list[str]) -> dict[str, tuple[float, float]] | None:
    apart = [one.parameter for one in ranges if one.share is not None and one.common is None]
    if apart:
        remarks.append(
            f"The judged paints have no {' and no '.join(apart)} in common: neither distances nor slopes are compared."
        )
        return None
    for name, of in (("a", [one.a for one in ranges]), ("b", [one.b for one in ranges])):
        if None in of:
            unknown = ", ".join(one.parameter for one, span in zip(ranges, of, strict=True) if span is None)
            remarks.append(f"The range of judged paints in {name} is not known ({unknown}).")
    assumed = [one.parameter for one in ranges if one.common is None]
    if assumed:
        remarks.append(f"Of {', '.join(assumed)} neither range is known: that of the gloss paper's stimuli is taken.")
    grid = {one.parameter: one.common or _USUAL[one.parameter] for one in ranges}
    if not len(_reflectances(grid, 2)[0]):
        remarks.append("The common range holds no possible paint (rho_d + rho_s > 1): only the weights are compared.")
        return None
    return grid


def _middle(axis: str, grid: Mapping[str, tuple[float, float]]) -> float:
    if axis == "d":
        return float(distinctness(sum(grid["alpha"]) / 2))
    return float(np.mean(contrast_gloss(*_reflectances(grid, 2))))


def _reflectances(grid: Mapping[str, tuple[float, float]], n: int) -> tuple[np.ndarray, np.ndarray]:
    """All possible combinations of n values of rho_d and of rho_s."""
    rho_d, rho_s = (one.ravel() for one in np.meshgrid(*(_values(grid[name], n) for name in ("rho_d", "rho_s"))))
    possible = conserves_energy(rho_d, rho_s)
    return rho_d[possible], rho_s[possible]


def _values(span: tuple[float, float], n: int) -> np.ndarray:
    return np.unique(np.linspace(*span, n))


def _distances(
    a: GlossSpace, b: GlossSpace, grid: Mapping[str, tuple[float, float]], n: int
) -> DistanceDifference | None:
    rho_d, rho_s = _reflectances(grid, n)
    alphas = _values(grid["alpha"], n)
    paints = np.column_stack([np.tile(rho_d, len(alphas)), np.tile(rho_s, len(alphas)), np.repeat(alphas, len(rho_d))])
    first, second = np.triu_indices(len(paints), 1)
    one, other = Paint(*paints[first].T), Paint(*paints[second].T)
    ours, theirs = np.atleast_1d(a.distance(one, other)), np.atleast_1d(b.distance(one, other))
    largest = [float(np.max(distance, initial=0.0)) for distance in (ours, theirs)]
    if not all(0 < value < math.inf for value in largest):
        return None
    ours, theirs = ours / largest[0], theirs / largest[1]
    apart = np.flatnonzero((ours > _NOTHING) & (theirs > _NOTHING))
    if len(apart) == 0:
        return None
    ours, theirs = (distance[apart] / np.sqrt(np.mean(distance[apart] ** 2)) for distance in (ours, theirs))
    logs = np.log(theirs) - np.log(ours)
    size = np.abs(logs)
    ties = np.flatnonzero(size >= size.max() - _SAME)
    worst = ties[np.argmax(ours[ties])]
    here, there = (Paint(*map(float, paints[index[apart[worst]]])) for index in (first, second))
    ratio = _exp(float(logs[worst]))
    return DistanceDifference(here, there, ratio, ratio - 1, _exp(float(np.median(size))), len(paints))
