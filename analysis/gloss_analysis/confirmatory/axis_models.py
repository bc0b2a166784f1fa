"""Metrics of two given axes: weighted alone, turned by a common angle before, or correlated (see `orthogonality`)."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from gloss_analysis.confirmatory.axis_weights import fit_axis_weights
from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds.descent import Start, descend_all
from gloss_analysis.mds.disparities import Level, Ties
from gloss_analysis.mds.kernels import DIAGONAL, FULL
from gloss_analysis.mds.objective import group_stress
from gloss_analysis.mds.problem import Problem, make_problem
from gloss_analysis.mds.restriction import Restriction

__all__ = ["AxisModels", "fit_axis_models"]

# Angles that the search for a rotation looks at first. A quarter turn swaps the axes, whose weights are free, so that
# angles from -45 to 45 degrees are all there are.
_ANGLES = np.pi / 180 * np.arange(-45.0, 45.0, 7.5)
_ANGLE_TOLERANCE = np.pi / 180 * 0.05
_STEPS = 200
# Correlations that the search for them starts from, beside none.
_CORRELATIONS = (-0.4, 0.4)
# Mean square stress that rounding cannot tell from 0.
_ROUNDING = 1e-12


@dataclass(frozen=True)
class AxisModels:
    """Mean square stress of the three models, and what they found.

    Attributes
    ----------
    independent, rotated, correlated : float
        Mean over sources of Stress-1 squared.
    weights : ndarray, shape (m, 2)
        Of the independent axes, of mean square 1.
    angle : float
        Degrees by which the axes are turned, -45 to 45.
    correlations : ndarray, shape (m,)
    """

    independent: float
    rotated: float
    correlated: float
    weights: np.ndarray
    angle: float
    correlations: np.ndarray

    def drop(self, stress: float) -> float:
        """Part of the stress of independent axes that a model of mean square `stress` takes away."""
        return (self.independent - stress) / self.independent if self.independent > _ROUNDING else 0.0


def fit_axis_models(data: Dissimilarities, position: np.ndarray, *, level: Level, ties: Ties) -> AxisModels:
    """Fit the three models.

    Parameters
    ----------
    data : Dissimilarities
        m participants, all of whom can be fitted, and n stimuli.
    position : ndarray, shape (n, 2)
        Coordinates of standard deviation 1.
    level, ties
        See `gloss_analysis.mds.scale`.

    Returns
    -------
    AxisModels
    """
    problem = make_problem(data, level=level, ties=ties)
    share, unit = problem.pairs.share, np.ones(2)
    single = [make_problem(data.take([k]), level=level, ties=ties) for k in range(problem.n_sources)]
    weights = np.array([fit_axis_weights(one, position, unit).weights for one in single])
    weights /= np.sqrt(np.mean(weights**2, axis=1, keepdims=True))
    own = weights[:, :, np.newaxis] * np.eye(2)
    least = group_stress(problem, position, own) ** 2

    equal = np.tile(np.eye(2), (len(own), 1, 1))

    def turned(angle: float) -> tuple[float, np.ndarray]:
        """Mean square stress with axes turned by an angle and every source's own best weights; transformations."""
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([[c, -s], [s, c]])
        losses, transforms = _each_best(problem, position @ turn, [own, equal], DIAGONAL)
        return float(share @ losses), turn @ transforms

    def stress_of(angle: float) -> float:
        return turned(angle)[0]

    independent = float(share @ least)
    rotated, angle, by_rotation = independent, 0.0, own
    values = np.array([stress_of(x) for x in _ANGLES])
    nearest = _ANGLES[int(np.argmin(values))]
    step = _ANGLES[1] - _ANGLES[0]
    options = {"xatol": _ANGLE_TOLERANCE}
    refined = minimize_scalar(stress_of, bounds=(nearest - step, nearest + step), method="bounded", options=options)
    for x in (nearest, refined.x):
        value, transforms = turned(x)
        if value < rotated:
            rotated, by_rotation = value, transforms
            angle = float(np.degrees((x + np.pi / 4) % (np.pi / 2) - np.pi / 4))

    # From the rotation too, which this model contains: the lowest of all is never above it. The others are Cholesky
    # factors of the metric [[1, r], [r, 1]] between the weighted axes.
    starts = [own, by_rotation]
    starts += [own @ np.array([[1.0, 0.0], [r, np.sqrt(1 - r**2)]]) for r in _CORRELATIONS]
    losses, transforms = _each_best(problem, position, starts, FULL)
    transforms = np.where((losses < least)[:, np.newaxis, np.newaxis], transforms, own)
    correlated = float(share @ np.minimum(losses, least))
    return AxisModels(independent, rotated, correlated, weights, angle, _correlations(transforms))


def _each_best(
    problem: Problem, position: np.ndarray, starts: list[np.ndarray], model: int
) -> tuple[np.ndarray, np.ndarray]:
    """Stress-1 squared and transformation of each source, the best of all starts for every source by itself.

    With the coordinates fixed the sources have nothing in common.
    """
    fixed = Restriction(position, np.empty((len(position), 0)))
    pairs: list[Start] = [(position, one) for one in starts]
    runs = descend_all(problem, pairs, model=model, steps=_STEPS, restriction=fixed, relative=1e-7)
    losses = np.array([group_stress(problem, position, run.transforms) ** 2 for run in runs])
    best = losses.argmin(axis=0)
    each = np.arange(len(best))
    return losses[best, each], np.array([runs[b].transforms[k] for k, b in enumerate(best)])


def _correlations(transforms: np.ndarray) -> np.ndarray:
    metric = transforms @ transforms.transpose(0, 2, 1)
    length = np.sqrt(metric[:, 0, 0] * metric[:, 1, 1])
    return np.divide(metric[:, 0, 1], length, out=np.zeros(len(metric)), where=length > 0)
