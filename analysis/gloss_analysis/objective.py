"""The one objective of every scaling here: mean over sources of Stress-1 squared, and its gradient.

For source k with distances d_k and the projection P_k onto its admissible transformations (`disparities`), Kruskal's
Stress-1 squared at the best scale is 1 - |P_k d_k|^2 / |d_k|^2. The mean over sources is

    f = mean_k [1 - |P_k d_k|^2 / |d_k|^2],

in which every source has a scale of its own and no constraint is needed to keep the configuration from shrinking. As
P_k is a projection onto a cone, the derivative of |P d|^2 / 2 is P d itself (the envelope theorem), so the gradient
costs no more than the value.
"""

from dataclasses import dataclass

import numpy as np

from gloss_analysis.disparities import Level, SourceOrder, Ties, disparities, source_order
from gloss_analysis.dissimilarity import Dissimilarities

__all__ = [
    "Problem",
    "make_problem",
    "mean_square_stress",
    "source_distances",
    "stress_and_gradient",
    "stress_of_sources",
]

# Pairs closer than this part of the root mean square distance count as coincident: the direction between them is noise.
_COINCIDENT = 1e-12


@dataclass(frozen=True)
class Problem:
    """Dissimilarities prepared for the solvers, with the measurement assumptions.

    Attributes
    ----------
    first, second : ndarray of int, shape (n_pairs,)
    incidence : ndarray, shape (n, n_pairs)
        +1 at the first and -1 at the second stimulus of each pair: sums pair-wise forces into points.
    orders : tuple of SourceOrder
        One a source.
    level, ties
        See `disparities`.
    """

    n_stimuli: int
    first: np.ndarray
    second: np.ndarray
    incidence: np.ndarray
    orders: tuple[SourceOrder, ...]
    level: Level
    ties: Ties

    @property
    def n_sources(self) -> int:
        """Number of sources (participants)."""
        return len(self.orders)

    @property
    def n_judging(self) -> int:
        """Number of sources that judged any pair: those that the objective averages over."""
        return sum(order.judged.size > 0 for order in self.orders)


def make_problem(data: Dissimilarities, *, level: Level = "ordinal", ties: Ties = "primary") -> Problem:
    """Prepare `data` for the solvers."""
    first, second = data.pairs
    incidence = np.zeros((len(data.stimuli), len(first)))
    incidence[first, np.arange(len(first))] = 1
    incidence[second, np.arange(len(first))] = -1
    return Problem(
        n_stimuli=len(data.stimuli),
        first=first,
        second=second,
        incidence=incidence,
        orders=tuple(source_order(row) for row in data.values),
        level=level,
        ties=ties,
    )


def source_distances(problem: Problem, coordinates: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Distances d_kij = sqrt(sum_r (w_kr (z_ir - z_jr))^2): shape (n_sources, n_pairs)."""
    differences = coordinates[problem.first] - coordinates[problem.second]
    return np.sqrt(weights**2 @ (differences**2).T)


def stress_of_sources(problem: Problem, distances: np.ndarray) -> np.ndarray:
    """Kruskal's Stress-1 of each source, shape (n_sources,), each at its own best scale.

    A source whose judged distances are all zero has no shape to judge and counts as Stress 1; one that judged nothing
    has nothing to contradict and Stress 0.
    """
    stress = np.zeros(problem.n_sources)
    for k, order in enumerate(problem.orders):
        d = distances[k, order.judged]
        total = d @ d
        if total == 0:
            stress[k] = order.judged.size > 0
        else:
            fitted = disparities(d, order, level=problem.level, ties=problem.ties)
            # As a sum of squared residuals: 1 - |Pd|^2/|d|^2 would lose the digits of a small stress.
            stress[k] = np.sqrt(max((d - fitted) @ (d - fitted), 0.0) / total)
    return stress


def mean_square_stress(problem: Problem, distances: np.ndarray) -> float:
    """Objective f: the mean of Stress-1 squared over the sources that judged any pair."""
    return float(np.sum(stress_of_sources(problem, distances) ** 2) / problem.n_judging)


def stress_and_gradient(
    problem: Problem, coordinates: np.ndarray, weights: np.ndarray
) -> tuple[float, np.ndarray, np.ndarray]:
    """Objective f and its gradient by coordinates, shape (n, p), and by weights, shape (m, p)."""
    differences = coordinates[problem.first] - coordinates[problem.second]
    squared = differences**2
    distances = np.sqrt(weights**2 @ squared.T)
    force = np.zeros_like(distances)  # derivative of f by the distance, over the distance
    value = 0.0
    for k, order in enumerate(problem.orders):
        d = distances[k, order.judged]
        total = d @ d
        if total == 0:
            value += order.judged.size > 0
            continue
        fitted = disparities(d, order, level=problem.level, ties=problem.ties)
        residual = d - fitted
        loss = residual @ residual / total
        value += loss
        apart = d > _COINCIDENT * np.sqrt(total / len(d))
        # f_k = |d - Pd|^2 / |d|^2 has the derivative 2 (d - Pd - f_k d) / |d|^2.
        force[k, order.judged[apart]] = 2 * (residual[apart] / d[apart] - loss) / total
    m = problem.n_judging
    pull = (force.T @ weights**2) * differences
    by_coordinates = problem.incidence @ pull / m
    by_weights = weights * (force @ squared) / m
    return value / m, by_coordinates, by_weights
