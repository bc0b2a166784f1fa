"""A solution without each participant in turn: standard errors of few participants, and who moves the solution."""

from dataclasses import dataclass

import numpy as np
from scipy.stats import t as student_t

from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds import MdsSolution
from gloss_analysis.replicates import OnStep, in_parallel, no_step
from gloss_analysis.uncertainty.alignment import procrustes_distance
from gloss_analysis.uncertainty.refitting import (
    check_confidence,
    check_fits,
    check_weights,
    geometric_mean_ratio,
    refitted,
    weight_ratio,
)
from glossspace.errors import GlossError

__all__ = ["JackknifeResult", "jackknife"]


@dataclass(frozen=True)
class JackknifeResult:
    """Solutions without one participant, aligned with that of all.

    Attributes
    ----------
    solution : MdsSolution
        Of all participants.
    participants : tuple of str, length k
        Whose leaving out left a solution.
    coordinates : ndarray, shape (k, n, p)
        Without each of them.
    dimension_weights : ndarray, shape (k, m, p)
        NaN for who was left out.
    stress1 : ndarray, shape (k,)
    influence : ndarray, shape (k,)
        Procrustes distance of the configurations with and without each, 0 to 1.
    warnings : tuple of str
    """

    solution: MdsSolution
    participants: tuple[str, ...]
    coordinates: np.ndarray
    dimension_weights: np.ndarray
    stress1: np.ndarray
    influence: np.ndarray
    warnings: tuple[str, ...]

    @property
    def standard_error(self) -> np.ndarray:
        """Of every coordinate, shape (n, p)."""
        return _standard_error(self.coordinates)

    @property
    def stress_error(self) -> float:
        """Standard error of Stress-1."""
        return float(_standard_error(self.stress1))

    def ratio_interval(self, first: int = 0, second: int = 1, *, level: float = 0.95) -> tuple[float, float]:
        """t interval, on logarithms, of the geometric mean over participants of how far two dimensions extend.

        The extent of a dimension for a participant is the weight times the root mean square of the coordinates.

        Raises
        ------
        GlossError
            The model is not weighted, or there are no such dimensions.
        """
        check_weights(self.solution, first, second)
        counted = (self.solution.source_shares > 0).astype(float)
        of_all = self.solution
        whole = geometric_mean_ratio(weight_ratio(of_all.coordinates, of_all.dimension_weights, first, second), counted)
        parts = np.log(
            geometric_mean_ratio(weight_ratio(self.coordinates, self.dimension_weights, first, second), counted)
        )
        half = student_t.ppf((1 + check_confidence(level)) / 2, len(parts) - 1) * _standard_error(parts)
        return float(whole * np.exp(-half)), float(whole * np.exp(half))


def jackknife(
    data: Dissimilarities,
    solution: MdsSolution,
    *,
    seed: int = 1,
    n_jobs: int = 1,
    on_step: OnStep = no_step,
) -> JackknifeResult:
    """Leave out each participant in turn and fit again.

    Parameters
    ----------
    data : Dissimilarities
    solution : MdsSolution
        Of the same data, without restriction of the coordinates.
    seed : int
        Fixes the starts; the result does not depend on `n_jobs`.
    n_jobs : int
        Threads (joblib), -1 for one a core.
    on_step : callable
        Called with the number of fits done and of all, to show progress.

    Returns
    -------
    JackknifeResult

    Raises
    ------
    GlossError
        The solution is not one of the data, or fewer than three participants judged anything.

    Examples
    --------
    >>> from gloss_analysis.mds import scale
    >>> points = np.random.default_rng(0).uniform(size=(8, 2))
    >>> first, second = np.triu_indices(8, 1)
    >>> rows = [np.linalg.norm((points[first] - points[second]) * [1, w], axis=1) for w in (0.5, 1.0, 2.0)]
    >>> data = Dissimilarities(tuple("abcdefgh"), ("1", "2", "3"), np.array(rows))
    >>> jackknife(data, scale(data, n_dims=2, level="ratio")).coordinates.shape
    (3, 8, 2)
    """
    check_fits(data, solution)
    counted = np.flatnonzero(solution.source_shares > 0)
    if len(counted) < 3:
        raise GlossError(f"{len(counted)} participants are too few to leave one out. Judgements of 3 are needed.")

    def one(case: tuple[int, np.random.SeedSequence]) -> "tuple[np.ndarray, np.ndarray, float] | None":
        out, child = case
        rows = counted[counted != out]
        refit = refitted(data.take(rows), np.ones(len(rows), int), solution, rows, np.random.default_rng(child))
        if refit is None:
            return None
        weights = np.full(solution.dimension_weights.shape, np.nan)
        weights[rows] = refit.dimension_weights
        return refit.coordinates, weights, refit.stress1

    cases = list(zip(counted.tolist(), np.random.SeedSequence(seed).spawn(len(counted)), strict=True))
    results = list(in_parallel(one, cases, n_jobs, on_step))
    kept = [(data.participants[k], result) for k, result in zip(counted, results, strict=True) if result is not None]
    needed = [data.participants[k] for k, result in zip(counted, results, strict=True) if result is None]
    if len(kept) < 2:
        raise GlossError("Without one participant, the judgements of the others determine no configuration.")
    remarks = []
    if needed:
        remarks.append(
            f"Without {', '.join(needed)} the judgements determine no configuration; the standard errors do not say so."
        )
    return JackknifeResult(
        solution=solution,
        participants=tuple(name for name, _ in kept),
        coordinates=np.array([result[0] for _, result in kept]),
        dimension_weights=np.array([result[1] for _, result in kept]),
        stress1=np.array([result[2] for _, result in kept]),
        influence=np.array([procrustes_distance(result[0], solution.coordinates) for _, result in kept]),
        warnings=tuple(remarks),
    )


def _standard_error(values: np.ndarray) -> np.ndarray:
    k = len(values)
    return np.asarray(np.sqrt((k - 1) / k * np.sum((values - values.mean(axis=0)) ** 2, axis=0)))
