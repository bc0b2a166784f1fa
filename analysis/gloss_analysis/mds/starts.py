"""Starting configurations: stress has many local minima, so every solution is the best of many starts."""

import numpy as np
from scipy.stats import rankdata

from gloss_analysis.judgements.dissimilarity import Dissimilarities

__all__ = ["random_start", "torgerson_configuration", "torgerson_projections"]


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


def random_start(n_stimuli: int, n_dims: int, rng: np.random.Generator) -> np.ndarray:
    """Points drawn from a normal distribution, shape (n_stimuli, n_dims)."""
    return rng.standard_normal((n_stimuli, n_dims))
