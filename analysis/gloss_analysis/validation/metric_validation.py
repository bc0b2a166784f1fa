"""How well a gloss metric predicts judged differences: STRESS of García et al. (2007), and the F test of two metrics.

STRESS is that of `stress_index`, a colour-difference index in per cent at the level of ratios; it is not Kruskal's.
"""

from dataclasses import dataclass

import numpy as np
from scipy.stats import f as f_distribution

from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds.diagnostics import distinguishes
from gloss_analysis.validation.stress_index import as_differences, common_judgement, stress_index
from glossspace.errors import GlossError

__all__ = ["MetricComparison", "MetricValidation", "compare_metrics", "validate_metric"]

_ROUNDING = 1e-6
"""STRESS, in per cent, below which predictions are as good as proportional: what is left is rounding."""


@dataclass(frozen=True)
class MetricValidation:
    """How well a metric predicts judged differences.

    Attributes
    ----------
    participants : tuple of str, length m
    stress : ndarray, shape (m,)
        STRESS of each participant in per cent; NaN for those whose judgements tell no pairs apart.
    mean_stress : float
        Their mean: how well a single observer is predicted. To be held against `ceiling`.
    pooled_stress : float
        STRESS of the mean judgement of all participants, each brought to a common scale first: how well the average
        observer is predicted. What García et al. compare metrics by.
    inter_observer : ndarray, shape (m,)
        STRESS of each participant against the mean judgement of the others; NaN where it is not defined.
    ceiling : float or None
        Its mean: how far observers agree, and so about the best that a metric can do. Few others make a noisy mean, so
        that a good metric may come out below. None where no two participants judged the same pairs.
    n_pairs : int
        Pairs behind `pooled_stress`.
    predicted, judged : ndarray, shape (n (n - 1) / 2,)
        Predicted differences, and the mean judgement in the common scale; NaN for a pair that does not enter.
    scale : float
        The factor by which predicted ~ scale * judged.
    warnings : tuple of str
        What was left out, and why.
    """

    participants: tuple[str, ...]
    stress: np.ndarray
    mean_stress: float
    pooled_stress: float
    inter_observer: np.ndarray
    ceiling: float | None
    n_pairs: int
    predicted: np.ndarray
    judged: np.ndarray
    scale: float
    warnings: tuple[str, ...]


@dataclass(frozen=True)
class MetricComparison:
    """Two metrics, on the pairs that both predict.

    Attributes
    ----------
    first, second : MetricValidation
    f_ratio : float
        (pooled STRESS of the first / that of the second)^2, infinite where the second predicts perfectly.
    f_interval : tuple of float
        Where F lies with the given confidence if the metrics are equally good.
    p_value : float
        Two-sided.
    better : {"first", "second"} or None
        The metric of lower STRESS if F lies outside the interval.
    n_favouring_first, n_favouring_second : int
        Participants whom this metric predicts better, which assumes no distribution.
    """

    first: MetricValidation
    second: MetricValidation
    f_ratio: float
    f_interval: tuple[float, float]
    p_value: float
    better: str | None
    n_favouring_first: int
    n_favouring_second: int


def validate_metric(pairs: Dissimilarities, predicted: np.ndarray) -> MetricValidation:
    """Hold predicted differences against judged ones.

    Parameters
    ----------
    pairs : Dissimilarities
        n stimuli, m participants; missing pairs are allowed. Every judged pair counts alike, however often it was
        judged.
    predicted : ndarray, shape (n (n - 1) / 2,)
        What the metric says of each pair, >= 0, in any unit; NaN where it says nothing: this pair does not enter.

    Returns
    -------
    MetricValidation

    Raises
    ------
    GlossError
        The shape is wrong, a difference is negative or infinite, all predictions are 0 or NaN, or no participant tells
        pairs apart.

    Examples
    --------
    >>> pairs = Dissimilarities(("a", "b", "c"), ("1", "2"), np.array([[1.0, 2.0, 3.0], [20.0, 40.0, 60.0]]))
    >>> round(validate_metric(pairs, np.array([0.1, 0.2, 0.3])).mean_stress, 6)
    0.0
    """
    metric = as_differences(predicted, "predicted")
    n_pairs = pairs.values.shape[1]
    if metric.shape != (n_pairs,):
        raise GlossError(
            f"Predicted differences have the shape {metric.shape}. Allowed: ({n_pairs},), one for each pair of "
            f"{len(pairs.stimuli)} stimuli, in the order of the upper triangle."
        )
    remarks = []
    if np.isnan(metric).any():
        remarks.append(f"{np.isnan(metric).sum()} of {n_pairs} pairs have no prediction and are left out.")
    values = as_differences(np.where(pairs.judged & ~np.isnan(metric), pairs.values, np.nan), "judged")
    usable = np.array([_usable(row, metric) for row in values], dtype=bool)
    silent = [name for name, use in zip(pairs.participants, usable, strict=True) if not use]
    if silent:
        remarks.append(f"Judged all pairs alike, or none that is predicted to differ; left out: {', '.join(silent)}.")
    if not usable.any():
        raise GlossError(" ".join(["No participant's judgements can be compared with the predictions.", *remarks]))
    stress = np.full(len(values), np.nan)
    stress[usable] = [stress_index(metric, row) for row in values[usable]]
    inter_observer = _inter_observer(values, usable)
    if not np.isfinite(inter_observer).any():
        reason = "a single participant" if usable.sum() == 1 else "no pair that two participants judged"
        remarks.append(f"There is no agreement of observers to compare with: {reason}.")
    judged = common_judgement(values[usable])
    return MetricValidation(
        participants=pairs.participants,
        stress=stress,
        mean_stress=float(np.mean(stress[usable])),
        pooled_stress=stress_index(metric, judged),
        inter_observer=inter_observer,
        ceiling=float(np.nanmean(inter_observer)) if np.isfinite(inter_observer).any() else None,
        n_pairs=int(np.count_nonzero(~np.isnan(judged))),
        predicted=np.where(np.isnan(judged), np.nan, metric),
        judged=judged,
        scale=_scale(metric, judged),
        warnings=tuple(remarks),
    )


def compare_metrics(
    pairs: Dissimilarities, first: np.ndarray, second: np.ndarray, *, confidence: float = 0.95
) -> MetricComparison:
    """Test whether one of two metrics predicts the mean judgement better: the F test of García et al. (2007).

    Parameters
    ----------
    pairs : Dissimilarities
    first, second : ndarray, shape (n (n - 1) / 2,)
        As in `validate_metric`. Pairs that one of them does not predict enter neither.
    confidence : float
        Above 0, below 1.

    Returns
    -------
    MetricComparison

    Raises
    ------
    GlossError
        The confidence is not allowed, or see `validate_metric`.

    Notes
    -----
    F has n - 1 degrees of freedom above and below, n the number of pairs. The test takes residuals of the two metrics
    as independent and normal. Here they share the judgements, so that it rather misses a difference between metrics
    that are alike, and pairs share stimuli, so that n - 1 is too many: read it beside the number of participants whom
    each metric predicts better.

    Examples
    --------
    >>> pairs = Dissimilarities(("a", "b", "c"), ("1",), np.array([[1.0, 2.0, 3.0]]))
    >>> compare_metrics(pairs, np.array([1.0, 1.0, 2.0]), np.array([1.0, 1.0, 2.0])).f_ratio
    1.0
    """
    if not 0 < confidence < 1:
        raise GlossError(f"Invalid confidence = {confidence!r}. Allowed: above 0 and below 1, such as 0.95.")
    one, two = as_differences(first, "predicted"), as_differences(second, "predicted")
    if one.shape != two.shape:
        raise GlossError(f"Two metrics predict {one.shape} and {two.shape} differences. Give both for the same pairs.")
    unknown = np.isnan(one) | np.isnan(two)
    a, b = (validate_metric(pairs, np.where(unknown, np.nan, metric)) for metric in (one, two))
    degrees = a.n_pairs - 1
    high = float(f_distribution.ppf((1 + confidence) / 2, degrees, degrees))
    f_ratio, p_value = _f_test(a.pooled_stress, b.pooled_stress, degrees)
    apart = a.stress - b.stress
    differs = 0 if 1 / high <= f_ratio <= high else f_ratio - 1
    return MetricComparison(
        first=a,
        second=b,
        f_ratio=f_ratio,
        f_interval=(1 / high, high),
        p_value=p_value,
        better=None if differs == 0 else "first" if differs < 0 else "second",
        n_favouring_first=int(np.sum(apart < -_ROUNDING)),
        n_favouring_second=int(np.sum(apart > _ROUNDING)),
    )


def _f_test(first: float, second: float, degrees: int) -> tuple[float, float]:
    if max(first, second) < _ROUNDING:
        return 1.0, 1.0  # both are perfect: a ratio of roundings would say anything
    f_ratio = np.inf if second < _ROUNDING else (first / second) ** 2
    tail = min(f_distribution.cdf(f_ratio, degrees, degrees), f_distribution.sf(f_ratio, degrees, degrees))
    return float(f_ratio), float(min(2 * tail, 1))


def _inter_observer(values: np.ndarray, usable: np.ndarray) -> np.ndarray:
    found = np.full(len(values), np.nan)
    for k in np.flatnonzero(usable):
        others = usable & (np.arange(len(values)) != k)
        if others.any():
            mean = common_judgement(values[others])
            if _usable(values[k], mean):
                found[k] = stress_index(mean, values[k])
    return found


def _usable(judged: np.ndarray, metric: np.ndarray) -> bool:
    """Whether a participant tells pairs apart, of which some differ by the metric."""
    known = ~np.isnan(judged) & ~np.isnan(metric)
    return bool(known.any() and distinguishes(judged[known]) and np.any(metric[known] > 0))


def _scale(metric: np.ndarray, judged: np.ndarray) -> float:
    """Factor F1 of García et al."""
    known = ~np.isnan(metric) & ~np.isnan(judged)
    unit = metric[known] / metric[known].max()
    shared = unit @ judged[known]
    return float(metric[known].max() * (unit @ unit) / shared) if shared > 0 else float("nan")
