"""Starting configurations: stress has many local minima, so every solution is the best of many starts."""

from collections.abc import Iterator

import numpy as np
from scipy.spatial.distance import squareform
from scipy.stats import rankdata

from gloss_analysis.dissimilarity import Dissimilarities

__all__ = ["interchanged", "random_start", "torgerson_configuration", "torgerson_projections"]

# Sums that one sweep of `interchanged` may add up: a second or two. Enough for all moves of 100 points.
_MAX_WORK = 3e8


def torgerson_configuration(data: Dissimilarities, n_dims: int) -> np.ndarray:
    """Classical scaling (Torgerson 1952) of the mean ranks of the dissimilarities, shape (n, n_dims).

    Ranks within each participant make it independent of how each used the scale. A pair that nobody judged counts as
    the mean, and dimensions that classical scaling cannot fill are zero.
    """
    n = len(data.stimuli)
    ranks = np.full(data.values.shape, np.nan)
    for row, values in zip(ranks, data.values, strict=True):
        judged = ~np.isnan(values)
        if judged.any():
            row[judged] = rankdata(values[judged]) / judged.sum()
    counts = (~np.isnan(ranks)).sum(axis=0)
    mean = np.divide(np.nansum(ranks, axis=0), counts, out=np.full(len(counts), np.nan), where=counts > 0)
    mean = np.where(np.isnan(mean), np.nanmean(mean), mean)
    square = np.zeros((n, n))
    square[data.pairs] = mean**2
    square += square.T
    centring = np.eye(n) - 1 / n
    values, vectors = np.linalg.eigh(-0.5 * centring @ square @ centring)
    configuration = np.zeros((n, n_dims))
    kept = min(n_dims, n)
    configuration[:, :kept] = vectors[:, ::-1][:, :kept] * np.sqrt(np.maximum(values[::-1][:kept], 0))
    return configuration


def torgerson_projections(data: Dissimilarities, n: int) -> list[np.ndarray]:
    """Give `n` one-dimensional starts: the plane of classical scaling seen from `n` directions.

    In one dimension points cannot pass each other without stress rising, so the order that a start has is nearly the
    order it keeps; orders that come from the data are worth more than random ones.
    """
    plane = torgerson_configuration(data, 2)
    angles = np.pi * np.arange(n) / n
    return [(plane @ np.array([np.cos(angle), np.sin(angle)]))[:, np.newaxis] for angle in angles]


def interchanged(line: np.ndarray, disparities: np.ndarray) -> list[np.ndarray]:
    """Points of a line in every order that one move makes: one point carried elsewhere, or two exchanged.

    With disparities D held fixed, the best points in a given order are t_i = (sum of D_ij over the j before i, less
    that over the j after i) / n, and the stress falls as sum_i t_i^2 rises (Defays 1978).

    Parameters
    ----------
    line : ndarray, shape (n, 1)
    disparities : ndarray, shape (n (n - 1) / 2,)

    Returns
    -------
    list of ndarray, shape (n, 1)
        The best points of each new order, the most promising first. Beyond `_MAX_WORK` only moves over a few points
        are made, and none at all where even those would be too many.
    """
    order = np.argsort(line[:, 0], kind="stable")
    n = len(order)
    square = squareform(disparities)
    side = np.tri(n, k=-1) - np.tri(n, k=-1).T  # +1 for the points before, -1 for those after
    promises, lines = [], []
    for new in _one_move_away(order, reach=min(n - 1, int(_MAX_WORK / (3 * n**3)))):
        points = np.empty_like(line)
        points[new, 0] = np.sum(square[np.ix_(new, new)] * side, axis=1) / n
        promises.append(np.sum(points**2))
        lines.append(points)
    return [lines[index] for index in np.argsort(-np.array(promises), kind="stable")]


def _one_move_away(order: np.ndarray, reach: int) -> Iterator[np.ndarray]:
    n = len(order)
    for place in range(n):
        for target in range(max(place - reach, 0), min(place + reach, n - 1) + 1):
            if target not in (place, place - 1):  # a step back is the neighbour's step forward
                yield np.insert(np.delete(order, place), target, order[place])
            if target > place + 1:
                exchanged = order.copy()
                exchanged[[place, target]] = order[[target, place]]
                yield exchanged


def random_start(n_stimuli: int, n_dims: int, rng: np.random.Generator) -> np.ndarray:
    """Points drawn from a normal distribution, shape (n_stimuli, n_dims)."""
    return rng.standard_normal((n_stimuli, n_dims))
