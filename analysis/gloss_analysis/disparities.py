"""Optimal transformations: what a distance should have been, given only what the level of measurement trusts.

Each is the projection of a source's distances onto a cone, the set of all admissible transformations of its
dissimilarities: multiples (ratio), straight lines (interval), monotone sequences (ordinal). Projections onto cones are
what makes the objective in `objective` free of scale.
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from scipy.optimize import isotonic_regression

from glossspace.errors import GlossError

__all__ = ["LEVELS", "TIES", "Level", "SourceOrder", "Ties", "disparities", "source_order"]

Level: TypeAlias = Literal["ratio", "interval", "ordinal"]
Ties: TypeAlias = Literal["primary", "secondary"]
LEVELS: tuple[Level, ...] = ("ratio", "interval", "ordinal")
TIES: tuple[Ties, ...] = ("primary", "secondary")


@dataclass(frozen=True)
class SourceOrder:
    """What one source's dissimilarities say, prepared once: which pairs were judged, their values and their ranks.

    Attributes
    ----------
    judged : ndarray of int, shape (q,)
        Indices of the judged pairs.
    values : ndarray, shape (q,)
        Their dissimilarities over the largest of them: no level of measurement trusts the unit.
    block : ndarray of int, shape (q,)
        Dense rank of each: pairs of equal dissimilarity share a block.
    block_size : ndarray of int
        How many pairs each block has.
    """

    judged: np.ndarray
    values: np.ndarray
    block: np.ndarray
    block_size: np.ndarray


def source_order(dissimilarities: np.ndarray) -> SourceOrder:
    """Prepare one source's condensed dissimilarities, NaN where a pair was not judged."""
    judged = np.flatnonzero(~np.isnan(dissimilarities))
    values = dissimilarities[judged]
    _, block, size = np.unique(values, return_inverse=True, return_counts=True)
    # Without the unit, squares of very large or very small dissimilarities neither overflow nor vanish.
    largest = values.max(initial=0.0)
    return SourceOrder(judged, values / largest if largest > 0 else values, block, size)


def disparities(distances: np.ndarray, order: SourceOrder, *, level: Level, ties: Ties) -> np.ndarray:
    """Admissible transformation of one source's dissimilarities that is nearest to `distances`.

    Parameters
    ----------
    distances : ndarray, shape (q,)
        Distances of the judged pairs, >= 0.
    order : SourceOrder
        The dissimilarities of those pairs.
    level : {"ratio", "interval", "ordinal"}
        Disparities are b * delta; a + b * delta with both >= 0 from the smallest delta up; any non-decreasing function.
    ties : {"primary", "secondary"}
        Ordinal only. Primary lets pairs of equal dissimilarity have different disparities; secondary keeps them tied.

    Returns
    -------
    ndarray, shape (q,)
        The least-squares projection: the difference to `distances` is orthogonal to it.

    Raises
    ------
    GlossError
        Unknown level or ties.

    Notes
    -----
    Kruskal (1964) describes the two treatments of ties. The monotone regression is scipy's pool-adjacent-violators.

    Examples
    --------
    >>> order = source_order(np.array([1.0, 2.0, 2.0, 3.0]))
    >>> disparities(np.array([1.0, 4.0, 2.0, 3.0]), order, level="ordinal", ties="primary")
    array([1. , 3.5, 2. , 3.5])
    >>> disparities(np.array([1.0, 4.0, 2.0, 3.0]), order, level="ordinal", ties="secondary")
    array([1., 3., 3., 3.])
    """
    if distances.size == 0:
        return distances.copy()
    if level == "ordinal":
        if ties == "primary":
            sequence = np.lexsort((distances, order.block))
            fitted = np.empty_like(distances)
            fitted[sequence] = isotonic_regression(distances[sequence]).x
            return fitted
        if ties == "secondary":
            means = np.bincount(order.block, weights=distances) / order.block_size
            return isotonic_regression(means, weights=order.block_size).x[order.block]
        raise GlossError(f"Invalid ties = {ties!r}. Allowed: {', '.join(map(repr, TIES))}.")
    if level == "ratio":
        return _onto_ray(distances, order.values)
    if level == "interval":
        return _onto_line(distances, order.values)
    raise GlossError(f"Invalid level = {level!r}. Allowed: {', '.join(map(repr, LEVELS))}.")


def _onto_ray(distances: np.ndarray, values: np.ndarray) -> np.ndarray:
    length = values @ values
    return values * ((values @ distances) / length) if length > 0 else np.zeros_like(distances)


def _onto_line(distances: np.ndarray, values: np.ndarray) -> np.ndarray:
    rise = values - values.min()
    centred = rise - rise.mean()
    spread = centred @ centred
    if spread == 0:
        return np.full_like(distances, distances.mean())
    slope = max((centred @ distances) / spread, 0.0)
    intercept = distances.mean() - slope * rise.mean()
    # A negative disparity would be no distance: the nearest admissible line then starts at zero.
    return intercept + slope * rise if intercept >= 0 else _onto_ray(distances, rise)
