"""Magnitude estimates: ratings of single images, averaged over observers, against a gloss axis.

Figures 7 and 8 of the gloss paper.
"""

from dataclasses import dataclass
from itertools import combinations
from typing import Literal, TypeAlias

import numpy as np
import pandas as pd
from scipy.stats import t as student_t

from gloss_analysis.ratings.polynomials import AxisRegression, regress_ratings
from glossspace.errors import GlossError

__all__ = [
    "EQUALISATIONS",
    "AxisRegression",
    "Equalisation",
    "RaterConsistency",
    "mean_ratings",
    "rater_consistency",
    "regress_ratings",
]

Equalisation: TypeAlias = Literal["linear", "geometric"]
EQUALISATIONS: tuple[Equalisation, ...] = ("linear", "geometric")
"""Ways to bring observers' scales together."""

# Iglewicz and Hoaglin (1993): an outlier is 3.5 robust standard deviations from the median, MAD / .6745 each.
_OUTLYING, _MAD_OF_SD = 3.5, 0.6745
# Two-sided 95 % point of the normal distribution, for Fisher's z, whose standard error is 1 / sqrt(n - 3).
_NORMAL_95 = 1.96
# A correlation of 1 has no finite Fisher's z.
_NEARLY_ONE = 1 - 1e-9
# Rounding makes the range of equal ratings a little more than 0, relative to the ratings themselves.
_SAME = 1e-9


@dataclass(frozen=True)
class RaterConsistency:
    """How consistent one participant's ratings are, with themselves and with those of the others.

    Attributes
    ----------
    participant_id : str
    retest_correlation : float
        Mean over all pairs of repeats of their product-moment correlation over stimuli; NaN where it is not defined.
    agreement : float
        Correlation of the participant's mean ratings with the mean of the others'; NaN where it is not defined.
    repeat_sd : float
        Standard deviation of one rating about the mean of its repeats, pooled over stimuli; NaN without repeats.
    flags : tuple of str
        What is unusual, in words. A flag is a remark: nobody is left out.
    """

    participant_id: str
    retest_correlation: float
    agreement: float
    repeat_sd: float
    flags: tuple[str, ...]


def mean_ratings(table: pd.DataFrame, *, equalise: Equalisation = "linear") -> pd.DataFrame:
    """Average ratings over repeats, then over participants with their scales equalised.

    Parameters
    ----------
    table : DataFrame
        Columns `participant_id`, `stimulus`, `rating`. Every participant rated every stimulus.
    equalise : {"linear", "geometric"}
        "linear": each participant's mean over repeats is moved and stretched so that all participants have the same
        mean and standard deviation, the averages of the group's; it suits a bounded slider with zeros. A participant
        with one rating for everything has no range to stretch or to average, and is only moved. "geometric": each
        participant's mean logarithm is moved to the group's, and averages are geometric; it suits numbers that
        participants chose in proportion, each with a unit of their own.

    Returns
    -------
    DataFrame
        `stimulus`, `rating`, `standard_error`, `ci_low`, `ci_high`, one row a stimulus in order of appearance. The
        interval is Student's, 95 %, over participants; standard error and interval are NaN with one participant. Under
        "geometric" the interval is that of the logarithms, and the standard error holds to first order.

    Raises
    ------
    GlossError
        A participant did not rate some stimulus; a rating that has no logarithm; an unknown equalisation.

    Notes
    -----
    Equalisation takes out the differences between participants in level, so that the interval is about the differences
    between stimuli, not about the level of all.

    Examples
    --------
    >>> rows = [("1", "a", 1), ("1", "b", 4), ("2", "a", 10), ("2", "b", 40)]
    >>> found = mean_ratings(pd.DataFrame(rows, columns=["participant_id", "stimulus", "rating"]), equalise="geometric")
    >>> found["rating"].round(3).tolist()
    [3.162, 12.649]
    """
    if equalise not in EQUALISATIONS:
        raise GlossError(f"There is no equalisation {equalise!r}. Use one of: {', '.join(EQUALISATIONS)}.")
    if equalise == "linear":
        means = _means(table)
        mean, error, half = _over_participants(_stretched(means.to_numpy()))
        low, high = mean - half, mean + half
    else:
        _refuse_without_logarithm(table)
        means = _means(table.assign(rating=np.log(table["rating"].astype(float))))
        logs = means.to_numpy()
        log_mean, log_error, half = _over_participants(logs - logs.mean(axis=1, keepdims=True) + logs.mean())
        mean, low, high = np.exp(log_mean), np.exp(log_mean - half), np.exp(log_mean + half)
        error = mean * log_error
    return pd.DataFrame(
        {"stimulus": means.columns, "rating": mean, "standard_error": error, "ci_low": low, "ci_high": high}
    )


def rater_consistency(table: pd.DataFrame) -> tuple[RaterConsistency, ...]:
    """Say how consistent each participant is, and flag the unusual.

    Parameters
    ----------
    table : DataFrame
        Columns `participant_id`, `stimulus`, `rating`, and `repeat` unless the rows are in the order of the trials.
        Every participant rated every stimulus.

    Returns
    -------
    tuple of RaterConsistency
        In the order of the participants' first appearance.

    Raises
    ------
    GlossError
        A participant did not rate some stimulus.

    Notes
    -----
    Flags. *Constant*: all ratings are the same. *Reversed*: agreement is negative, and so is the correlation with more
    than half of the other participants singly, for one reversed rater makes the mean of few others meaningless. *Low
    agreement*: Fisher's z of the agreement is below the median of those not reversed by more than 3.5 robust standard
    deviations (median absolute deviation / .6745) and by more than 1.96 / sqrt(n stimuli - 3), its sampling error; only
    with three such participants or more.

    Examples
    --------
    >>> rows = [(who, stimulus, rating) for who in "12" for stimulus, rating in zip("abcd", [10, 30, 20, 40])]
    >>> rows += [("3", stimulus, rating) for stimulus, rating in zip("abcd", [90, 70, 80, 60])]
    >>> found = rater_consistency(pd.DataFrame(rows, columns=["participant_id", "stimulus", "rating"]))
    >>> [bool(one.flags) for one in found]
    [False, False, True]
    """
    means = _means(table)
    values = means.to_numpy()
    stretched = _stretched(values)
    m, n = values.shape
    agreement = np.array(
        [_correlation(values[k], np.delete(stretched, k, axis=0).mean(axis=0)) if m > 1 else np.nan for k in range(m)]
    )
    singly = np.array([[_correlation(one, other) for other in values] for one in values])
    turned = np.array([agreement[k] < 0 and np.mean(np.delete(singly[k], k) < 0) > 0.5 for k in range(m)])
    threshold = _lowest_usual(agreement[~turned], n)
    found = []
    for k, name in enumerate(means.index):
        ratings = table.loc[table["participant_id"] == name, "rating"].to_numpy(dtype=float)
        retest, repeat_sd = _repeats(table[table["participant_id"] == name])
        flags = []
        if _is_constant(ratings):
            flags.append(f"constant: every rating is {ratings[0]:g}")
        if turned[k]:
            who = "the only other participant: one of the two" if m == 2 else "the others: this participant"
            flags.append(f"reversed: correlation {agreement[k]:.2f} with {who} may have turned the scale round")
        elif agreement[k] < threshold:
            flags.append(
                f"low agreement: correlation {agreement[k]:.2f} with the others, where {threshold:.2f} is the lowest "
                "usual in this group"
            )
        found.append(RaterConsistency(str(name), retest, float(agreement[k]), repeat_sd, tuple(flags)))
    return tuple(found)


def _means(table: pd.DataFrame) -> pd.DataFrame:
    """Mean over repeats, one row a participant and one column a stimulus, in order of appearance."""
    means = table.pivot_table(index="participant_id", columns="stimulus", values="rating", aggfunc="mean", sort=False)
    if means.isna().to_numpy().any():
        participant = means.index[means.isna().any(axis=1)][0]
        stimulus = means.columns[means.loc[participant].isna()][0]
        raise GlossError(
            f"Participant {participant} has no rating of the stimulus {stimulus}. Finish the session, or "
            "leave the participant or the stimulus out."
        )
    return means


def _stretched(values: np.ndarray) -> np.ndarray:
    """Participants' ratings, shape (m, n), moved and stretched to the group's mean and standard deviation."""
    level, spread = values.mean(axis=1, keepdims=True), values.std(axis=1, keepdims=True)
    # Stretching would blow up the spread that rounding gives to equal ratings.
    varied = np.ptp(values, axis=1, keepdims=True) > _SAME * np.abs(values).max()
    stretch = np.divide(
        spread.mean(where=varied) if varied.any() else 1.0, spread, out=np.ones_like(spread), where=varied
    )
    return np.asarray((values - level) * stretch + level.mean())


def _over_participants(values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mean, its standard error, and half the 95 % interval, each of shape (n,)."""
    m, n = values.shape
    if m == 1:
        return values[0], np.full(n, np.nan), np.full(n, np.nan)
    error = values.std(axis=0, ddof=1) / np.sqrt(m)
    return values.mean(axis=0), error, student_t.ppf(0.975, m - 1) * error


def _refuse_without_logarithm(table: pd.DataFrame) -> None:
    impossible = table[table["rating"] <= 0]
    if len(impossible):
        first = impossible.iloc[0]
        raise GlossError(
            f"Participant {first['participant_id']} rated the stimulus {first['stimulus']} {first['rating']:g} "
            f"({len(impossible)} such); a geometric mean needs ratings above 0. Use the linear equalisation."
        )


def _repeats(rows: pd.DataFrame) -> tuple[float, float]:
    """Mean correlation between repeats, and pooled standard deviation within stimuli, of one participant."""
    ordered = rows.sort_values("repeat", kind="stable") if "repeat" in rows else rows
    ordered = ordered.dropna(subset=["rating"])
    wide = ordered.assign(turn=ordered.groupby("stimulus").cumcount()).pivot_table(
        index="stimulus", columns="turn", values="rating", aggfunc="mean"
    )
    values = wide.to_numpy()
    pairs = [_correlation(values[:, a], values[:, b]) for a, b in combinations(range(values.shape[1]), 2)]
    defined = [value for value in pairs if not np.isnan(value)]
    freedom = int(np.sum(~np.isnan(values))) - len(values)
    squares = np.nansum((values - np.nanmean(values, axis=1, keepdims=True)) ** 2)
    return float(np.mean(defined)) if defined else np.nan, float(np.sqrt(squares / freedom)) if freedom else np.nan


def _is_constant(values: np.ndarray) -> bool:
    return bool(np.ptp(values) <= _SAME * np.abs(values).max())


def _correlation(a: np.ndarray, b: np.ndarray) -> float:
    both = ~(np.isnan(a) | np.isnan(b))
    a, b = a[both], b[both]
    if len(a) < 3 or _is_constant(a) or _is_constant(b):
        return np.nan
    return float(np.corrcoef(a, b)[0, 1])


def _lowest_usual(agreement: np.ndarray, n_stimuli: int) -> float:
    """Agreement below which a participant is an outlier, by the rule of `rater_consistency`; -inf without a rule."""
    known = agreement[~np.isnan(agreement)]
    if len(known) < 3 or n_stimuli <= 3:
        return -np.inf
    z = np.arctanh(np.clip(known, -_NEARLY_ONE, _NEARLY_ONE))
    median = np.median(z)
    robust = _OUTLYING * np.median(np.abs(z - median)) / _MAD_OF_SD
    return float(np.tanh(median - max(robust, _NORMAL_95 / np.sqrt(n_stimuli - 3))))
