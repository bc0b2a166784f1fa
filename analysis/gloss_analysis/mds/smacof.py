"""SMACOF, the readable twin: the same scaling by majorization, a line of algebra a step.

De Leeuw's algorithm replaces the stress by a parabola above it that touches it at the current configuration, and jumps
to the parabola's lowest point (Borg and Groenen 2005, chapters 8 and 22). Stress can only fall. It takes hundreds of
small steps where `mds` takes dozens, and is here to teach and to check: it shares the disparities with the fast solver,
but no gradient and no optimiser.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.distance import squareform

from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds.diagnostics import check_scalable, informs
from gloss_analysis.mds.disparities import Level, Ties, disparities
from gloss_analysis.mds.objective import mean_square_stress, source_distances
from gloss_analysis.mds.problem import make_problem
from gloss_analysis.mds.solution import Model
from glossspace.errors import GlossError

__all__ = ["SmacofResult", "smacof"]


@dataclass(frozen=True)
class SmacofResult:
    """Where majorization ended, and how it got there.

    Attributes
    ----------
    coordinates : ndarray, shape (n, n_dims)
    dimension_weights : ndarray, shape (m, n_dims)
        Of the identity model: each participant's scale, the same in all dimensions.
    stress1_by_step : ndarray
        Root mean Stress-1 squared before each step and after the last; it never rises.
    """

    coordinates: np.ndarray
    dimension_weights: np.ndarray
    stress1_by_step: np.ndarray


def smacof(
    data: Dissimilarities,
    *,
    start: np.ndarray,
    model: Model = "weighted",
    level: Level = "ordinal",
    ties: Ties = "primary",
    max_steps: int = 1000,
    tolerance: float = 1e-10,
) -> SmacofResult:
    """Scale complete data by majorization from one start.

    Parameters
    ----------
    data : Dissimilarities
        Every participant judged every pair.
    start : ndarray, shape (n, n_dims)
        The first configuration; its points differ in every dimension.
    model, level, ties
        See `gloss_analysis.mds.scale`; the generalised model is left to the fast solver.
    max_steps : int
    tolerance : float
        Stop when a step lowers the mean squared Stress-1 by less than this.

    Returns
    -------
    SmacofResult

    Raises
    ------
    GlossError
        A pair was not judged, a participant's judgements say nothing about distances, or the start is not usable.
    """
    if np.isnan(data.values).any() or data.pair_weights is not None or data.source_weights is not None:
        raise GlossError(
            "The majorization twin needs complete data without weights. Use gloss_analysis.mds.scale for gaps and "
            "weights."
        )
    if model == "generalised":
        raise GlossError("The majorization twin knows the models identity and weighted. Use gloss_analysis.mds.scale.")
    check_scalable(data, level=level, ties=ties)
    if level == "ratio" and not all(informs(row, level=level, ties=ties) for row in data.values):
        raise GlossError(
            "A participant judged all pairs 0, which no configuration fits at ratio level. Leave them out."
        )
    if len(start) != len(data.stimuli) or not np.all(np.isfinite(start)) or not np.all(np.ptp(start, axis=0) > 0):
        raise GlossError(f"The start must place {len(data.stimuli)} points, finite and different in every dimension.")
    problem = make_problem(data, level=level, ties=ties)
    z = np.asarray(start, dtype=float) - np.mean(start, axis=0)
    weights = np.ones((problem.n_sources, z.shape[1]))
    stress: list[float] = []
    while True:
        distances = source_distances(z, weights)
        stress.append(float(np.sqrt(mean_square_stress(problem, z, weights))))
        if len(stress) > max_steps or (len(stress) > 1 and stress[-2] ** 2 - stress[-1] ** 2 < tolerance):
            break
        targets = []
        for k, order in enumerate(problem.orders):
            fitted = disparities(distances[k], order, level=level, ties=ties)
            fitted *= np.sqrt(distances.shape[1] / (fitted @ fitted))  # every source weighs the same
            targets.append(_guttman_transform(distances[k], fitted, z * weights[k]))
        weights = _best_weights(z, targets, model)
        # Each dimension of z is a weighted mean of the participants' targets in it.
        z = sum(w * target for w, target in zip(weights, targets, strict=True)) / np.sum(weights**2, axis=0)
    return SmacofResult(z, weights, np.array(stress))


def _guttman_transform(distances: np.ndarray, fitted: np.ndarray, configuration: np.ndarray) -> np.ndarray:
    """B(X) X / n, with b_ij = -fitted / distance: where the majorizing parabola has its lowest point."""
    ratio = np.divide(fitted, distances, out=np.zeros_like(fitted), where=distances > 0)
    b = -squareform(ratio)
    b[np.diag_indices_from(b)] = -b.sum(axis=1)
    return b @ configuration / len(b)


def _best_weights(z: np.ndarray, targets: list[np.ndarray], model: Model) -> np.ndarray:
    """Weights that bring z nearest to each participant's target: one a dimension, or one scale for all."""
    if model == "weighted":
        return np.array([np.sum(z * target, axis=0) / np.sum(z**2, axis=0) for target in targets])
    return np.array([np.full(z.shape[1], np.sum(z * target) / np.sum(z**2)) for target in targets])
