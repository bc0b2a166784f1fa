"""The one objective of every scaling here: mean over sources of Stress-1 squared.

For source k with distances d_k and the projection P_k onto its admissible transformations (`disparities`), Kruskal's
Stress-1 squared at the best scale is 1 - |P_k d_k|^2 / |d_k|^2. The mean over sources, weighted if they are, is

    f = mean_k [1 - |P_k d_k|^2 / |d_k|^2],

in which every source has a scale of its own and no constraint is needed to keep the configuration from shrinking. Norms
are weighted by the weights of the pairs. Where all sources share one transformation (unconditional), there is one term
for all their pairs together. This module evaluates it; `kernels` has its gradient and its minimisation.
"""

import numpy as np

from gloss_analysis.mds.disparities import disparities
from gloss_analysis.mds.kernels import loss_of_groups, own_pairs
from gloss_analysis.mds.problem import Problem

__all__ = [
    "fitted_disparities", "group_stress", "mean_square_stress", "source_distances", "source_spaces",
    "stress_of_sources",
]  # fmt: skip


def source_spaces(coordinates: np.ndarray, transforms: np.ndarray) -> np.ndarray:
    """Each source's own space Y_k = Z C_k, shape (m, n, p).

    Parameters
    ----------
    coordinates : ndarray, shape (n, p)
    transforms : ndarray, shape (m, p) or (m, p, p)
        Dimension weights, or matrices C_k.
    """
    if transforms.ndim == 2:
        return coordinates[np.newaxis] * transforms[:, np.newaxis]
    return np.einsum("nc,mcr->mnr", coordinates, transforms)


def source_distances(coordinates: np.ndarray, transforms: np.ndarray) -> np.ndarray:
    """Distances in each source's own space, condensed: shape (m, n (n - 1) / 2). Parameters as of `source_spaces`."""
    first, second = np.triu_indices(len(coordinates), 1)
    spaces = source_spaces(coordinates, transforms)
    return np.array([np.linalg.norm(space[first] - space[second], axis=1) for space in spaces])


def group_stress(problem: Problem, coordinates: np.ndarray, transforms: np.ndarray) -> np.ndarray:
    """Stress-1 of each group of pairs that has a transformation of its own, shape (n_groups,).

    A group whose judged distances are all zero has no shape to judge and counts as Stress 1; one that judged nothing
    has nothing to contradict and Stress 0.
    """
    spaces = np.ascontiguousarray(source_spaces(coordinates, transforms).reshape(-1, coordinates.shape[1]), dtype=float)
    loss = np.empty(len(problem.orders))
    loss_of_groups(own_pairs(problem.pairs), spaces, np.empty((5, len(problem.pairs.first))), loss)
    return np.sqrt(loss)


def mean_square_stress(problem: Problem, coordinates: np.ndarray, transforms: np.ndarray) -> float:
    """Objective f; parameters as of `source_spaces`."""
    return float(problem.pairs.share @ group_stress(problem, coordinates, transforms) ** 2)


def stress_of_sources(problem: Problem, coordinates: np.ndarray, transforms: np.ndarray) -> np.ndarray:
    """Kruskal's Stress-1 of each source, shape (m,): at its own scale or, unconditional, that of the shared fit."""
    if problem.conditional:
        return group_stress(problem, coordinates, transforms)
    distances = source_distances(coordinates, transforms)
    residual = np.where(problem.data.judged, distances - fitted_disparities(problem, distances), 0.0)
    total = np.sum(problem.data.weights * np.where(problem.data.judged, distances, 0.0) ** 2, axis=1)
    share = np.sum(problem.data.weights * residual**2, axis=1)
    return np.sqrt(np.divide(share, total, out=np.zeros_like(total), where=total > 0))


def fitted_disparities(problem: Problem, distances: np.ndarray) -> np.ndarray:
    """Disparities of each source's `distances`, shape (m, n (n - 1) / 2); NaN where a pair was not judged."""
    fitted = np.full(distances.shape, np.nan)
    rows = [(fitted[k], distances[k]) for k in range(len(distances))]
    if not problem.conditional:
        rows = [(fitted.reshape(-1), distances.reshape(-1))]
    for (into, d), order in zip(rows, problem.orders, strict=True):
        into[order.judged] = disparities(d[order.judged], order, level=problem.level, ties=problem.ties)
    return fitted
