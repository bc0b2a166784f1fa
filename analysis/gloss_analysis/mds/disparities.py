"""Optimal transformations: what a distance should have been, given only what the level of measurement trusts.

Each is the projection of a source's distances onto a cone, the set of all admissible transformations of its
dissimilarities: multiples (ratio), straight lines (interval), monotone splines, monotone sequences (ordinal).
Projections onto cones are what makes the objective in `objective` free of scale. These are the readable functions; the
solver's compiled kernels in `projection` do the same.
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from scipy.interpolate import BSpline
from scipy.optimize import isotonic_regression, nnls

from glossspace.errors import GlossError

__all__ = [
    "LEVELS", "TIES", "Level", "SourceOrder", "Ties", "check_level", "disparities", "level_basis", "source_order",
]  # fmt: skip

Level: TypeAlias = Literal["ratio", "interval", "spline", "ordinal"]
Ties: TypeAlias = Literal["primary", "secondary"]
LEVELS: tuple[Level, ...] = ("ratio", "interval", "spline", "ordinal")
TIES: tuple[Ties, ...] = ("primary", "secondary")

# Degree and number of interior knots of the monotone spline: a smooth curve with five free numbers.
_DEGREE, _INTERIOR_KNOTS = 2, 2
# Part of the range of values below which a piece of the spline is none.
_NO_EXTENT = 1e-9


@dataclass(frozen=True)
class SourceOrder:
    """What one source's dissimilarities say, prepared once: which pairs were judged, their values and their ranks.

    Attributes
    ----------
    judged : ndarray of int, shape (q,)
        Indices of the judged pairs.
    values : ndarray, shape (q,)
        Their dissimilarities over the largest of them: no level of measurement trusts the unit.
    weights : ndarray, shape (q,)
        How much each pair counts, > 0.
    block : ndarray of int, shape (q,)
        Dense rank of each: pairs of equal dissimilarity share a block.
    """

    judged: np.ndarray
    values: np.ndarray
    weights: np.ndarray
    block: np.ndarray


def source_order(dissimilarities: np.ndarray, weights: np.ndarray | None = None) -> SourceOrder:
    """Prepare one source's condensed dissimilarities, NaN where a pair was not judged.

    A pair of weight 0 counts as not judged.
    """
    counted = ~np.isnan(dissimilarities)
    if weights is not None:
        counted &= weights > 0
    judged = np.flatnonzero(counted)
    values = dissimilarities[judged]
    _, block = np.unique(values, return_inverse=True)
    # Without the unit, squares of very large or very small dissimilarities neither overflow nor vanish.
    largest = values.max(initial=0.0)
    own = np.ones(len(judged)) if weights is None else np.asarray(weights, dtype=float)[judged]
    return SourceOrder(judged, values / largest if largest > 0 else values, own, block)


def check_level(level: str, ties: str) -> None:
    """Refuse an unknown level of measurement or treatment of ties.

    Raises
    ------
    GlossError
    """
    if level not in LEVELS:
        raise GlossError(f"Invalid level = {level!r}. Allowed: {', '.join(map(repr, LEVELS))}.")
    if ties not in TIES:
        raise GlossError(f"Invalid ties = {ties!r}. Allowed: {', '.join(map(repr, TIES))}.")


def disparities(distances: np.ndarray, order: SourceOrder, *, level: Level, ties: Ties) -> np.ndarray:
    """Admissible transformation of one source's dissimilarities that is nearest to `distances`.

    Parameters
    ----------
    distances : ndarray, shape (q,)
        Distances of the judged pairs, >= 0.
    order : SourceOrder
        The dissimilarities and weights of those pairs.
    level : {"ratio", "interval", "spline", "ordinal"}
        Disparities are b * delta; a + b * delta with both >= 0 from the smallest delta up; a monotone quadratic spline
        of delta with two interior knots at the terciles of its distinct values; any non-decreasing function.
    ties : {"primary", "secondary"}
        Ordinal only. Primary lets pairs of equal dissimilarity have different disparities; secondary keeps them tied.

    Returns
    -------
    ndarray, shape (q,)
        The weighted least-squares projection: the difference to `distances` is orthogonal to it.

    Raises
    ------
    GlossError
        Unknown level or ties.

    Notes
    -----
    Kruskal (1964) describes the two treatments of ties. The monotone regression is scipy's pool-adjacent-violators.
    The spline is a non-negative sum of a constant and of integrated splines (Ramsay 1988).

    Examples
    --------
    >>> order = source_order(np.array([1.0, 2.0, 2.0, 3.0]))
    >>> disparities(np.array([1.0, 4.0, 2.0, 3.0]), order, level="ordinal", ties="primary")
    array([1. , 3.5, 2. , 3.5])
    >>> disparities(np.array([1.0, 4.0, 2.0, 3.0]), order, level="ordinal", ties="secondary")
    array([1., 3., 3., 3.])
    """
    check_level(level, ties)
    if distances.size == 0:
        return distances.copy()
    if level != "ordinal":
        root = np.sqrt(order.weights)
        basis = level_basis(order.values, level)
        coefficients, _ = nnls(root[:, np.newaxis] * basis, root * distances)
        return basis @ coefficients
    if ties == "primary":
        sequence = np.lexsort((distances, order.block))
        fitted = np.empty_like(distances)
        fitted[sequence] = isotonic_regression(distances[sequence], weights=order.weights[sequence]).x
        return fitted
    mass = np.bincount(order.block, weights=order.weights)
    means = np.bincount(order.block, weights=order.weights * distances) / mass
    return isotonic_regression(means, weights=mass).x[order.block]


def level_basis(values: np.ndarray, level: Level) -> np.ndarray:
    """Columns whose non-negative sums are the admissible transformations at a metric level.

    Parameters
    ----------
    values : ndarray, shape (q,)
        Dissimilarities, in any unit.
    level : {"ratio", "interval", "spline"}

    Returns
    -------
    ndarray, shape (q, n_columns)
        None above 1; the ordinal level has no such columns, shape (q, 0).
    """
    if level == "ordinal" or values.size == 0:
        return np.empty((values.size, 0))
    if level == "ratio":
        return (values / max(values.max(), np.finfo(float).tiny))[:, np.newaxis]
    extent = np.ptp(values)
    if extent == 0:
        return np.ones((values.size, 1))
    rise = (values - values.min()) / extent
    if level == "interval":
        return np.column_stack([np.ones(values.size), rise])
    distinct = np.unique(rise)
    quantiles = np.arange(1, _INTERIOR_KNOTS + 1) / (_INTERIOR_KNOTS + 1)
    interior = np.quantile(distinct, quantiles, method="weibull")
    # Knots at an end, as of two distinct values, would cut the curve off.
    interior = interior[(interior > _NO_EXTENT) & (interior < 1 - _NO_EXTENT)]
    if interior.size == 0:
        return np.column_stack([np.ones(values.size), rise])
    knots = np.concatenate([np.zeros(_DEGREE + 1), interior, np.ones(_DEGREE + 1)])
    splines = BSpline.design_matrix(rise, knots, _DEGREE).toarray()
    # Sums from the right: a constant, then curves that rise from 0 to 1, each over the reach of one spline.
    return splines[:, ::-1].cumsum(axis=1)[:, ::-1]
