"""How many dimensions the judgements have: recommended with reasons, never from the elbow of a curve alone.

Stress always falls as dimensions are added, and depends on the design. So it is set beside that of judgements without
structure, in the same design, and beside what the solutions say about judgements that they have not seen (`held_out`).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import t as student_t

from gloss_analysis.dimensionality.held_out import HeldOut, cross_validated_stress
from gloss_analysis.dimensionality.null_stress import NULL_STARTS, permuted_stress, random_stress
from gloss_analysis.dimensionality.quick_scaling import possible_dims, quick_curve
from gloss_analysis.dimensionality.stress_curve import stress_curve
from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds import Level, MdsSolution, Model, Ties
from gloss_analysis.replicates import OnStep, no_step, whole_number
from glossspace.errors import GlossError

__all__ = ["DimensionalityStudy", "Recommendation", "recommend_dimensions", "study_dimensionality"]

_LEVEL_OF_TEST = 0.05
# With fewer, no value can be among the lowest 5 %: the rank test's smallest p is 1 / (n + 1).
_FEWEST_REPLICATES = 19
# Stress that two minimisations cannot be told apart by; near 0, stress is the root of a rounding error.
_SAME_STRESS = 1e-4


@dataclass(frozen=True)
class Recommendation:
    """A number of dimensions with its reasons.

    Attributes
    ----------
    n_dims : int or None
        None where the judgements cannot be told from permuted ones.
    reasons : tuple of str
        What each criterion says, in sentences.
    agreed : bool
        Whether one number meets all criteria.
    p_overall : float
        Part of permuted judgements, the data counted among them, whose stress over all numbers of dimensions (mean of
        the logarithms) is as low as that of the data.
    p_structure : ndarray, shape (n_dimensionalities,)
        The same for each number of dimensions.
    p_drop : ndarray, shape (n_dimensionalities - 1,)
        The same for the fall of stress from each number of dimensions to the next.
    """

    n_dims: int | None
    reasons: tuple[str, ...]
    agreed: bool
    p_overall: float
    p_structure: np.ndarray
    p_drop: np.ndarray


@dataclass(frozen=True)
class DimensionalityStudy:
    """All that speaks for a number of dimensions.

    Attributes
    ----------
    curve : tuple of MdsSolution
        The data, in every number of dimensions.
    comparable_stress1 : ndarray, shape (n_dimensionalities,)
        Stress-1 of the data found by the same quick search as that of random and permuted judgements, for the tests.
    random, permuted : ndarray, shape (n_replicates, n_dimensionalities)
        Stress-1 of random and of permuted judgements in the same design.
    held_out : HeldOut
    recommendation : Recommendation
    """

    curve: tuple[MdsSolution, ...]
    comparable_stress1: np.ndarray
    random: np.ndarray
    permuted: np.ndarray
    held_out: HeldOut
    recommendation: Recommendation

    @property
    def dims(self) -> tuple[int, ...]:
        """Numbers of dimensions tried."""
        return tuple(solution.n_dims for solution in self.curve)

    @property
    def stress1(self) -> np.ndarray:
        """Stress-1 of the data, shape (n_dimensionalities,)."""
        return np.array([solution.stress1 for solution in self.curve])


def study_dimensionality(
    data: Dissimilarities,
    *,
    dims: Iterable[int] = range(1, 6),
    model: Model = "weighted",
    level: Level = "ordinal",
    ties: Ties = "primary",
    conditional: bool = True,
    n_starts: int = 30,
    n_replicates: int = 20,
    n_folds: int = 5,
    seed: int = 1,
    n_jobs: int = 1,
    on_step: OnStep = no_step,
) -> DimensionalityStudy:
    """Scale in several numbers of dimensions, and say how many the judgements support.

    Parameters
    ----------
    data, model, level, ties, conditional
        See `gloss_analysis.mds.scale`.
    dims : iterable of int
        Numbers of dimensions to try; those above n - 1 are left out. Give consecutive ones.
    n_starts : int
        Starts of the solutions of the data themselves.
    n_replicates : int
        19 or more random, and as many permuted, sets of judgements.
    n_folds : int
        Parts, each predicted from the others.
    seed : int
        Fixes everything drawn; the result does not depend on `n_jobs`.
    n_jobs : int
        Threads (joblib), -1 for one a core.
    on_step : callable
        Called with the number of steps done and of all steps, to show progress.

    Returns
    -------
    DimensionalityStudy

    Raises
    ------
    GlossError
        Too few replicates or folds, no number of dimensions that the data have room for, or data or a parameter that
        `scale` refuses.

    Examples
    --------
    >>> points = np.random.default_rng(0).uniform(size=(12, 2))
    >>> first, second = np.triu_indices(12, 1)
    >>> exact = np.linalg.norm(points[first] - points[second], axis=1)
    >>> data = Dissimilarities(tuple("abcdefghijkl"), ("1",), exact[np.newaxis])
    >>> study_dimensionality(data, dims=(1, 2, 3), model="identity").recommendation.n_dims
    2
    """
    _check_replicates(n_replicates)
    wanted = possible_dims(data, tuple(dims))
    total = len(wanted) + 1 + 2 * n_replicates + n_folds
    done = 0

    def step(*_: object) -> None:
        nonlocal done
        done += 1
        on_step(done, total)

    assumed: dict[str, Any] = {"model": model, "level": level, "ties": ties, "conditional": conditional}
    # Children of one seed, so that no two parts share their draws.
    seeds = [whole_number(child) for child in np.random.SeedSequence(seed).spawn(4)]
    curve = stress_curve(data, dims=wanted, n_starts=n_starts, seed=seed, n_jobs=n_jobs, on_solution=step, **assumed)
    quick = quick_curve(data, wanted, n_starts=NULL_STARTS, seed=seeds[3], **assumed)
    comparable = np.array([fit.stress1 for fit in quick])
    step()
    assumed |= {"dims": wanted, "n_jobs": n_jobs, "on_step": step}
    held_out = cross_validated_stress(data, n_folds=n_folds, seed=seeds[0], **assumed)
    permuted = permuted_stress(data, n_replicates=n_replicates, seed=seeds[1], **assumed)
    random = random_stress(data, n_replicates=n_replicates, seed=seeds[2], **assumed)
    recommended = recommend_dimensions(wanted, comparable, permuted, held_out)
    return DimensionalityStudy(curve, comparable, random, permuted, held_out, recommended)


def recommend_dimensions(
    dims: Sequence[int], stress1: np.ndarray, permuted: np.ndarray, held_out: HeldOut
) -> Recommendation:
    """Recommend the fewest dimensions that meet three criteria, and say where these disagree.

    1. Structure: stress is among the lowest 5 % of that of permuted judgements, there and over all numbers together,
       and judgements left out are predicted better than by chance (t test at 5 % of the rank correlation, over folds).
    2. Prediction: the rank correlation of judgements left out with predicted distances is within one standard error of
       the highest.
    3. No loss: no further dimension lowers stress by more than it does for 95 % of permuted judgements.

    Where no number meets all, the recommendation is that of prediction. Where none meets the first, it is none.

    Parameters
    ----------
    dims : sequence of int
        Numbers of dimensions, rising.
    stress1 : ndarray, shape (n_dimensionalities,)
        Of the data, found by the same search as that of permuted judgements: otherwise the test is no test.
    permuted : ndarray, shape (n_replicates, n_dimensionalities)
        From `permuted_stress`, for the same dimensions; 19 replicates or more.
    held_out : HeldOut
        From `cross_validated_stress`, for the same dimensions.

    Returns
    -------
    Recommendation

    Raises
    ------
    GlossError
        Too few replicates, or the parts are not of the same dimensions.

    Notes
    -----
    Stress of judgements left out is reported but decides nothing: see `cross_validated_stress`. The first and third are
    rank tests, (1 + number of replicates as low) / (1 + number of replicates). The third is slow to see a dimension in
    noisy judgements, whose stress falls less than that of permuted ones even where the dimension is real.
    """
    dims, stress, permuted = tuple(dims), np.asarray(stress1, dtype=float), np.asarray(permuted, dtype=float)
    if not dims or stress.shape != (len(dims),) or permuted.shape[1:] != stress.shape or held_out.dims != dims:
        raise GlossError(
            f"Numbers of dimensions {dims}, stress of shape {stress.shape}, permuted stress of shape {permuted.shape} "
            f"and judgements left out in {held_out.dims} do not belong together. Compute all for the same dimensions."
        )
    _check_replicates(len(permuted))
    p_structure = _rank_p(permuted <= stress + _SAME_STRESS)
    # One test of all, for one of several tests would find structure in noise too often.
    means = np.log(np.maximum([stress, *permuted], _SAME_STRESS)).mean(axis=1)
    p_overall = float(_rank_p(means[1:] <= means[0] + 1e-12))
    p_drop = _rank_p(-np.diff(permuted, axis=1) >= -np.diff(stress) - _SAME_STRESS)
    predictive, predicted, above_chance = _predictive(held_out)
    low = p_structure <= _LEVEL_OF_TEST
    structured = low & above_chance
    lossless = np.array([not np.any(p_drop[k:] <= _LEVEL_OF_TEST) for k in range(len(dims))])
    reasons = [_structure(dims, stress, permuted, low), predicted, _drops(dims, lossless)]
    if p_overall > _LEVEL_OF_TEST or not structured.any():
        why = (
            "the judgements cannot be told from permuted ones"
            if p_overall > _LEVEL_OF_TEST
            else "judgements left out are not predicted better than by chance where stress is low"
        )
        said = f"No number of dimensions is recommended: {why} (p of structure = {p_overall:.2g})."
        return Recommendation(None, (said, *reasons), False, p_overall, p_structure, p_drop)
    meets = structured & predictive & lossless
    agreed = bool(meets.any())
    if agreed:
        best = dims[int(np.argmax(meets))]
        said = f"{_dimensions(best)} recommended: the fewest that meet all criteria."
        asked = [dims[int(np.argmax(ok))] for ok in (predictive, lossless)]
        if asked[0] != asked[1]:
            reasons.append(f"The criteria differ: prediction asks for {asked[0]}, the fall of stress for {asked[1]}.")
    else:
        either = structured & predictive if (structured & predictive).any() else structured
        best = dims[int(np.argmax(either))]
        said = f"{_dimensions(best)} recommended, but no number meets all criteria; look at more than one solution."
    return Recommendation(best, (said, *reasons), agreed, p_overall, p_structure, p_drop)


def _check_replicates(n_replicates: int) -> None:
    if n_replicates < _FEWEST_REPLICATES:
        why = "with fewer, nothing can be among the lowest 5 %"
        raise GlossError(f"Invalid n_replicates = {n_replicates}. Allowed: {_FEWEST_REPLICATES} or more; {why}.")


def _rank_p(as_extreme: np.ndarray) -> np.ndarray:
    return (1 + as_extreme.sum(axis=0)) / (1 + len(as_extreme))


def _predictive(held_out: HeldOut) -> tuple[np.ndarray, str, np.ndarray]:
    """Which numbers predict as well as the best, what to say of it, and which predict better than chance."""
    mean, error = held_out.mean_rank_correlation, held_out.rank_correlation_error
    if not np.all(np.isfinite(error)):
        said = "Prediction decides nothing: fewer than two parts of the judgements could be left out."
        return np.ones(len(mean), dtype=bool), " ".join([said, *held_out.warnings]), np.ones(len(mean), dtype=bool)
    top = int(np.argmax(mean))
    within = mean >= mean[top] - error[top]
    fewest = int(np.argmax(within))
    where, best = _dimensions(held_out.dims[top]), f"rank correlation {mean[top]:.3f}, standard error {error[top]:.3f}"
    said = f"Judgements left out are predicted best in {where} ({best})"
    if fewest != top:
        said += f", and as well within one standard error in {held_out.dims[fewest]} ({mean[fewest]:.3f})"
    folds = np.count_nonzero(~np.isnan(held_out.rank_correlation).any(axis=1))
    above_chance = mean > student_t.ppf(1 - _LEVEL_OF_TEST, folds - 1) * error
    said += "." if above_chance.any() else ", no better than by chance."
    return within, " ".join([said, *held_out.warnings]), above_chance


def _structure(dims: tuple[int, ...], stress: np.ndarray, permuted: np.ndarray, structured: np.ndarray) -> str:
    k = int(np.argmax(structured))
    numbers = f"{stress[k]:.3f} in {_dimensions(dims[k])}, that of permuted ones {permuted[:, k].min():.3f} or more"
    if not structured.any():
        return f"Stress is not below that of permuted judgements: {numbers}."
    where = ", ".join(str(p) for p, ok in zip(dims, structured, strict=True) if ok)
    return f"Stress is below that of permuted judgements (number of dimensions: {where}): {numbers}."


def _drops(dims: tuple[int, ...], lossless: np.ndarray) -> str:
    if lossless[0]:
        return f"No dimension beyond {dims[0]} lowers stress by more than it does for permuted judgements."
    k = int(np.argmax(lossless))
    beyond = "and by no more beyond" if k < len(dims) - 1 else "which is the most tried: try more"
    return f"Stress falls by more than for permuted judgements up to {_dimensions(dims[k])}, {beyond}."


def _dimensions(count: int) -> str:
    return f"{count} dimension" if count == 1 else f"{count} dimensions"
