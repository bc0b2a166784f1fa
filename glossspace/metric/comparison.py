"""Where two gloss spaces differ by more than their uncertainty."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from glossspace.errors import GlossError
from glossspace.metric.axes import Paint
from glossspace.metric.common_paints import PARAMETERS, RangeOverlap, Spans, common_spans, overlap, paints, reflectances
from glossspace.metric.space import AxisFunction, GlossSpace

__all__ = ["DistanceDifference", "Estimate", "RangeOverlap", "SpaceComparison", "compare_spaces"]

_NORMAL_95 = 1.959963984540054
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
        Of weight_d / weight_c; where the axis functions of the two have other forms, and so other units, in the unit
        that gives c and d of the common paints the extents that they have in a.
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
    missed than invented. The standard error of a slope's logarithm is that of its interval over participants, or,
    without one, sqrt((1 - r^2) / (r^2 (n - 2))); the error of the rating in the middle, much smaller, is left out.

    Examples
    --------
    >>> one, other = GlossSpace(weight_d_ci95=(1.6, 1.98)), GlossSpace(weight_d=3.0, weight_d_ci95=(2.5, 3.6))
    >>> compare_spaces(one, other).weight.differs
    True
    """
    if isinstance(n, bool) or not isinstance(n, int) or not 2 <= n <= 12:
        raise GlossError(f"Invalid n = {n!r} values of each parameter in the grid. Allowed: a whole number, 2 to 12.")
    remarks: list[str] = []
    ranges = tuple(overlap(name, a, b) for name in PARAMETERS)
    grid = common_spans(ranges, remarks)
    units = _units(a, b, grid, n, remarks)
    weight = _weight(a, b, units["d"] / units["c"], remarks)
    slopes, r_squared = {}, {}
    for axis in ("c", "d"):
        ours, theirs = a.axis_functions.get(axis), b.axis_functions.get(axis)
        if ours is None or theirs is None:
            who = " and ".join(name for name, one in (("a", ours), ("b", theirs)) if one is None)
            remarks.append(f"No ratings along {axis} in {who}: its axis functions cannot be compared.")
            continue
        r_squared[axis] = (ours.r_squared, theirs.r_squared)
        if grid is not None:
            middles = (_middle(axis, grid, a), _middle(axis, grid, b))
            slopes[axis] = _slopes(axis, (ours, theirs), middles, units[axis], remarks)
    distances = None if grid is None else _distances(a, b, grid, n)
    if grid is not None and distances is None:
        remarks.append("The common range holds no two paints that differ in gloss: distances are not compared.")
    return SpaceComparison(weight, slopes, r_squared, ranges, distances, tuple(remarks))


def _units(a: GlossSpace, b: GlossSpace, grid: Spans | None, n: int, remarks: list[str]) -> Mapping[str, float]:
    """Extent of c and of d in b over that in a, along the common paints: 1 for equal forms, NaN where it is unknown."""
    if a.contrast_form == b.contrast_form and a.distinctness_form == b.distinctness_form:
        return {"c": 1.0, "d": 1.0}
    forms = f"c = {a.contrast_form.text} and {b.contrast_form.text}, d = {a.distinctness_form.text} and "
    remarks.append(f"The axis functions have other forms ({forms}{b.distinctness_form.text}).")
    if grid is not None:
        paint = Paint(*paints(grid, n).T)
        extents = [np.ptp(np.asarray(space.coordinates(paint)), axis=1) for space in (a, b)]
        if np.all(np.asarray(extents) > 0):
            return dict(zip("cd", map(float, extents[1] / extents[0]), strict=True))
    remarks.append("No common paints that differ along both axes make their units equal: weights are not compared.")
    return {"c": math.nan, "d": math.nan}


def _weight(a: GlossSpace, b: GlossSpace, factor: float, remarks: list[str]) -> Estimate:
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
    return _estimate(a.weight_d / a.weight_c, factor * b.weight_d / b.weight_c, errors)


def _slopes(
    axis: str,
    functions: tuple[AxisFunction, AxisFunction],
    middles: tuple[float, float],
    unit: float,
    remarks: list[str],
) -> Estimate:
    values, errors = [], []
    for name, one, middle in zip("ab", functions, middles, strict=True):
        rating = one.intercept + one.slope * middle
        possible = one.slope > 0 and rating > 0
        if not possible:
            remarks.append(
                f"Ratings along {axis} in {name} have the slope {one.slope:g} and are {rating:g} in the middle of the "
                "common range; both must be above 0 to be compared as ratios."
            )
        values.append(one.slope / rating if possible else math.nan)
        errors.append(_slope_error(one) if possible else None)
        known = errors[-1] is not None
        if possible and not known:
            remarks.append(f"How sure the slope along {axis} in {name} is cannot be told: it is taken as exact.")
    return _estimate(values[0], unit * values[1], errors)


def _slope_error(line: AxisFunction) -> float | None:
    """Standard error of the logarithm of a slope, or None."""
    if line.slope_ci95 is not None and line.slope_ci95[0] > 0:
        return (math.log(line.slope_ci95[1]) - math.log(line.slope_ci95[0])) / 2 / _NORMAL_95
    if line.n_stimuli > 2 and 0 < line.r_squared <= 1:
        return math.sqrt((1 - line.r_squared) / line.r_squared / (line.n_stimuli - 2))
    return None


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


def _middle(axis: str, grid: Spans, space: GlossSpace) -> float:
    if axis == "d":
        return float(space.distinctness_form.value(sum(grid["alpha"]) / 2))
    return float(np.mean(space.contrast_form.value(*reflectances(grid, 2))))


def _distances(a: GlossSpace, b: GlossSpace, grid: Spans, n: int) -> DistanceDifference | None:
    grid_paints = paints(grid, n)
    first, second = np.triu_indices(len(grid_paints), 1)
    one, other = Paint(*grid_paints[first].T), Paint(*grid_paints[second].T)
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
    here, there = (Paint(*map(float, grid_paints[index[apart[worst]]])) for index in (first, second))
    ratio = _exp(float(logs[worst]))
    return DistanceDifference(here, there, ratio, ratio - 1, _exp(float(np.median(size))), len(grid_paints))
