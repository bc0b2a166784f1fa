"""How well solutions predict judgements that they have not seen: worse again where dimensions follow noise."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import rankdata

from gloss_analysis.dimensionality.quick_scaling import QuickFit, possible_dims, quick_curve
from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds import Level, Model, Ties
from gloss_analysis.mds.diagnostics import check_scalable
from gloss_analysis.replicates import OnStep, in_parallel, no_step, whole_number
from glossspace.errors import GlossError

__all__ = ["HeldOut", "cross_validated_stress"]

# Folds that leave some stimuli without a link are bad luck a few times, and sparse data after that.
_DEALS = 20


@dataclass(frozen=True)
class HeldOut:
    """How well solutions of part of the judgements predict the rest.

    Attributes
    ----------
    dims : tuple of int
    stress1 : ndarray, shape (n_folds, n_dimensionalities)
        Stress-1 of the judgements left out, root mean square over participants; NaN where a fold could not be fitted.
    rank_correlation : ndarray, shape (n_folds, n_dimensionalities)
        Spearman's, of the judgements left out with the distances predicted for them, mean over participants; NaN where
        a fold could not be fitted or nobody's judgements left out differ.
    warnings : tuple of str
        Why folds could not be fitted.
    """

    dims: tuple[int, ...]
    stress1: np.ndarray
    rank_correlation: np.ndarray
    warnings: tuple[str, ...]

    @property
    def mean_stress1(self) -> np.ndarray:
        """Mean over the folds that could be fitted, shape (n_dimensionalities,)."""
        return _mean(self.stress1)

    @property
    def stress1_error(self) -> np.ndarray:
        """Standard error of `mean_stress1`, shape (n_dimensionalities,); NaN with fewer than two fitted folds."""
        return _standard_error(self.stress1)

    @property
    def mean_rank_correlation(self) -> np.ndarray:
        """Mean over the folds that could be fitted, shape (n_dimensionalities,)."""
        return _mean(self.rank_correlation)

    @property
    def rank_correlation_error(self) -> np.ndarray:
        """Standard error of `mean_rank_correlation`; NaN with fewer than two fitted folds."""
        return _standard_error(self.rank_correlation)


def cross_validated_stress(
    data: Dissimilarities,
    *,
    dims: Iterable[int] = range(1, 6),
    model: Model = "weighted",
    level: Level = "ordinal",
    ties: Ties = "primary",
    conditional: bool = True,
    n_folds: int = 5,
    n_starts: int = 5,
    seed: int = 1,
    n_jobs: int = 1,
    on_step: OnStep = no_step,
) -> HeldOut:
    """Leave out part of every participant's judgements, fit the others, and see how well those left out follow.

    Parameters
    ----------
    data, dims, model, level, ties, conditional
        See `gloss_analysis.dimensionality.stress_curve.stress_curve`.
    n_folds : int
        2 or more; every judgement is left out once. Each participant's pairs are dealt out so that every stimulus loses
        about as many of its pairs to every fold.
    n_starts : int
        Starts of each fit; in one dimension always 40, without the search over orders of `scale`.
    seed : int
        Fixes folds and starts; the result does not depend on `n_jobs`.
    n_jobs : int
        Threads (joblib), -1 for one a core.
    on_step : callable
        Called with the number of folds done and of all, to show progress.

    Returns
    -------
    HeldOut

    Raises
    ------
    GlossError
        Fewer than two folds, or data or a parameter that `scale` refuses.

    Notes
    -----
    The fitted judgements' transformation gives those left out their disparities: the monotone regression, with the mean
    of each block of ties, is interpolated and stays level beyond its ends, as does the spline; a straight line goes on.

    Stress is no fair judge between numbers of dimensions: distances grow alike as dimensions are added, so that that of
    judgements left out falls even where the judgements are noise. The rank correlation does not profit from that.

    Examples
    --------
    >>> points = np.random.default_rng(0).uniform(size=(12, 2))
    >>> first, second = np.triu_indices(12, 1)
    >>> exact = np.linalg.norm(points[first] - points[second], axis=1)
    >>> data = Dissimilarities(tuple("abcdefghijkl"), ("1",), exact[np.newaxis])
    >>> found = cross_validated_stress(data, dims=(1, 2), model="identity", level="ratio")
    >>> bool(found.mean_stress1[0] > 0.1), bool(found.mean_stress1[1] < 1e-4)
    (True, True)
    """
    if n_folds < 2:
        raise GlossError(f"Invalid number of folds = {n_folds}. Allowed: 2 or more.")
    check_scalable(data, level=level, ties=ties)
    wanted = possible_dims(data, tuple(dims))
    deal_seed, *seeds = np.random.SeedSequence(seed).spawn(n_folds + 1)
    folds = _linking_folds(data, n_folds, np.random.default_rng(deal_seed), level, ties)

    def one(fold: int) -> tuple[np.ndarray, str]:
        held = folds == fold
        training = _without(data, held)
        try:
            check_scalable(training, level=level, ties=ties)
        except GlossError as error:
            return np.full((len(wanted), 2), np.nan), f"Fold {fold + 1} of {n_folds} could not be fitted: {error}"
        curve = quick_curve(
            training,
            wanted,
            model=model,
            level=level,
            ties=ties,
            conditional=conditional,
            n_starts=n_starts,
            seed=whole_number(seeds[fold]),
        )
        straight = level in ("ratio", "interval")
        return np.array([_prediction(data, held, fit, conditional=conditional, straight=straight) for fit in curve]), ""

    results = list(in_parallel(one, range(n_folds), n_jobs, on_step))
    stress, correlation = np.moveaxis(np.array([values for values, _ in results]), 2, 0)
    return HeldOut(wanted, stress, correlation, tuple(remark for _, remark in results if remark))


def _without(data: Dissimilarities, held: np.ndarray) -> Dissimilarities:
    return replace(data, values=np.where(held, np.nan, data.values), trials=None)


def _linking_folds(
    data: Dissimilarities, n_folds: int, rng: np.random.Generator, level: Level, ties: Ties
) -> np.ndarray:
    """Fold of every judgement, -1 where there is none, shape (m, n (n - 1) / 2); of several deals the one most fit."""
    best, most = np.empty(0), -1
    for _ in range(_DEALS):
        folds = _dealt(data, n_folds, rng)
        fit = sum(_is_scalable(_without(data, folds == fold), level, ties) for fold in range(n_folds))
        if fit > most:
            best, most = folds, fit
        if fit == n_folds:
            break
    return best


def _is_scalable(data: Dissimilarities, level: Level, ties: Ties) -> bool:
    try:
        check_scalable(data, level=level, ties=ties)
    except GlossError:
        return False
    return True


def _dealt(data: Dissimilarities, n_folds: int, rng: np.random.Generator) -> np.ndarray:
    first, second = data.pairs
    folds = np.full(data.values.shape, -1)
    for row, judged in zip(folds, data.judged, strict=True):
        lost = np.zeros((n_folds, len(data.stimuli)), dtype=int)
        size = np.zeros(n_folds, dtype=int)
        for pair in rng.permutation(np.flatnonzero(judged)):
            i, j = first[pair], second[pair]
            fold = np.lexsort((rng.random(n_folds), size, lost[:, i] + lost[:, j]))[0]
            row[pair] = fold
            lost[fold, [i, j]] += 1
            size[fold] += 1
    return folds


def _prediction(
    data: Dissimilarities, held: np.ndarray, solution: QuickFit, *, conditional: bool, straight: bool
) -> tuple[float, float]:
    """Stress-1 and rank correlation of the judgements left out."""
    rows = range(len(data.participants))
    curves = [_curve(data.values[k], data.weights[k], solution.disparities[k]) for k in rows]
    if not conditional:
        pooled = _curve(data.values.ravel(), data.weights.ravel(), solution.disparities.ravel())
        curves = [pooled for _ in rows]
    stress, correlation = np.full((2, len(rows)), np.nan)
    for k, (known, fitted) in enumerate(curves):
        out = held[k]
        if not out.any() or not len(known):
            continue
        weights, distances = data.weights[k, out], solution.distances[k, out]
        expected = _continued(data.values[k, out], known, fitted, straight=straight)
        total = np.sum(weights * distances**2)
        # A configuration that puts all these pairs on one point has no shape to judge.
        stress[k] = np.sum(weights * (distances - expected) ** 2) / total if total > 0 else 1.0
        correlation[k] = _spearman(data.values[k, out], distances)
    shares = data.source_weights_or_ones
    return float(np.sqrt(_weighted_mean(stress, shares))), _weighted_mean(correlation, shares)


def _curve(values: np.ndarray, weights: np.ndarray, disparities: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distinct fitted judgements, rising, and the mean disparity of each."""
    fitted = ~np.isnan(disparities)
    known, block = np.unique(values[fitted], return_inverse=True)
    mass = np.bincount(block, weights=weights[fitted])
    return known, np.bincount(block, weights=weights[fitted] * disparities[fitted]) / mass


def _continued(values: np.ndarray, known: np.ndarray, fitted: np.ndarray, *, straight: bool) -> np.ndarray:
    if straight and len(known) > 1:
        slope = (fitted[-1] - fitted[0]) / (known[-1] - known[0])
        return np.maximum(fitted[0] + slope * (values - known[0]), 0.0)
    return np.interp(values, known, fitted)


def _spearman(a: np.ndarray, b: np.ndarray) -> float:
    if np.ptp(a) == 0 or np.ptp(b) == 0:
        return np.nan
    return float(np.corrcoef(rankdata(a), rankdata(b))[0, 1])


def _weighted_mean(values: np.ndarray, weights: np.ndarray) -> float:
    counted = ~np.isnan(values) & (weights > 0)
    return float(np.average(values[counted], weights=weights[counted])) if counted.any() else np.nan


def _fitted(values: np.ndarray) -> np.ndarray:
    return values[~np.isnan(values).any(axis=1)]


def _mean(values: np.ndarray) -> np.ndarray:
    rows = _fitted(values)
    return rows.mean(axis=0) if len(rows) else np.full(values.shape[1], np.nan)


def _standard_error(values: np.ndarray) -> np.ndarray:
    rows = _fitted(values)
    return rows.std(axis=0, ddof=1) / np.sqrt(len(rows)) if len(rows) > 1 else np.full(values.shape[1], np.nan)
