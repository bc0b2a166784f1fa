"""What is odd in a participant's answers, in words: for every command that reads them. Nobody is left out for it."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
from scipy.stats import rankdata

from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.judgements.reliability import reliability
from gloss_analysis.ratings.magnitude import rater_consistency
from glossspace.errors import GlossError

__all__ = ["judgement_remarks", "rating_remarks"]

# Judged fewer than this part of what half of the participants judged: worth a remark.
_FEW = 0.9
# Identical pairs above this part of a participant's mean judgement of different ones are not near 0. A slider with
# noise that cannot go below 0 leaves them at a few hundredths.
_NOT_NEAR_ZERO = 0.25
# Pairs in common from which a correlation of ranks says anything.
_FEWEST_COMMON = 6
# A correlation of 0 may come out slightly below it.
_ROUNDING = 1e-12


def judgement_remarks(data: Dissimilarities, judgements: pd.DataFrame | None = None) -> tuple[str, ...]:
    """Remarks on judged pairs: who judged few of them, turned the scale round, or does not give identical pairs 0.

    Parameters
    ----------
    data : Dissimilarities
        m participants.
    judgements : DataFrame, optional
        The single judgements with identical pairs, which `data` is without: columns `participant_id`, `stimulus_a`,
        `stimulus_b`, `dissimilarity`.

    Returns
    -------
    tuple of str

    Notes
    -----
    *Few*: fewer than .9 of the median number of pairs of those who judged any. *Reversed*: the rank correlation with
    the mean rank that the others give the same pairs is negative, and so is that with more than half of the others
    singly. *Identical pairs*: on average above a quarter of the participant's mean judgement of different pairs, where
    these are not all the same.

    Examples
    --------
    >>> judged = np.array([[1.0, 2, 3, 4, 5, 6], [1, 3, 2, 4, 6, 5], [6, 5, 4, 3, 2, 1]])
    >>> print(*judgement_remarks(Dissimilarities(tuple("abcd"), ("1", "2", "3"), judged)))
    Judged pairs in the opposite order to the others: 3 (rank correlation -0.97). Was the scale reversed?
    """
    return (*_few(data), *_reversed(data), *_identical(judgements))


def rating_remarks(ratings: Mapping[str, pd.DataFrame]) -> tuple[str, ...]:
    """Remarks on ratings of single images along each axis: the flags of `rater_consistency`.

    Parameters
    ----------
    ratings : mapping of str to DataFrame
        For each axis `participant_id`, `stimulus`, `rating`, of participants who rated all its stimuli.

    Returns
    -------
    tuple of str

    Raises
    ------
    GlossError
        A participant did not rate some stimulus.

    Examples
    --------
    >>> rows = [(who, stimulus, rating) for who in "12" for stimulus, rating in zip("abcd", [10, 30, 20, 40])]
    >>> rows += [("3", stimulus, 50) for stimulus in "abcd"]
    >>> print(*rating_remarks({"c": pd.DataFrame(rows, columns=["participant_id", "stimulus", "rating"])}))
    Ratings along c, participant 3: constant: every rating is 50.
    """
    remarks = []
    for axis, table in ratings.items():
        try:
            found = rater_consistency(table)
        except GlossError as error:
            raise GlossError(f"Ratings along {axis}: {error}") from None
        remarks += [
            f"Ratings along {axis}, participant {one.participant_id}: {flag}." for one in found for flag in one.flags
        ]
    return tuple(remarks)


def _few(data: Dissimilarities) -> list[str]:
    counts = data.judged.sum(axis=1)
    if not counts.any():
        return []
    usual = np.median(counts[counts > 0])
    few = [
        f"{name} ({count})" for name, count in zip(data.participants, counts, strict=True) if 0 < count < _FEW * usual
    ]
    if not few:
        return []
    return [
        f"Judged fewer pairs than the others, whose median is {usual:g} of {data.values.shape[1]}: {', '.join(few)}. "
        "What they say rests on less."
    ]


def _reversed(data: Dissimilarities) -> list[str]:
    judged = np.where(data.judged, data.values, np.nan)
    ranks = rankdata(judged, axis=1, nan_policy="omit")
    ranks /= np.maximum(data.judged.sum(axis=1, keepdims=True), 1)
    # Compiled, since there is one for any two participants.
    singly = pd.DataFrame(ranks.T).corr(min_periods=_FEWEST_COMMON).to_numpy()
    found = []
    for k, name in enumerate(data.participants):
        others = np.delete(ranks, k, axis=0)
        count = np.count_nonzero(~np.isnan(others), axis=0)
        mean = np.divide(np.nansum(others, axis=0), count, out=np.full(len(count), np.nan), where=count > 0)
        agreement, single = _correlation(ranks[k], mean), np.delete(singly[k], k)
        if agreement < -_ROUNDING and np.mean(single[~np.isnan(single)] < -_ROUNDING) > 0.5:
            found.append(f"{name} (rank correlation {agreement:.2f})")
    if not found:
        return []
    if len(data.participants) == 2:
        return [f"The two participants judged pairs in opposite orders: {', '.join(found)}. Was one scale reversed?"]
    return [f"Judged pairs in the opposite order to the others: {', '.join(found)}. Was the scale reversed?"]


def _identical(judgements: pd.DataFrame | None) -> list[str]:
    if judgements is None:
        return []
    # In units of the largest, so that no sum overflows whatever the scale.
    values = pd.to_numeric(judgements["dissimilarity"], errors="coerce")
    unit = values.max() if values.max() > 0 else 1.0
    judgements = judgements.assign(dissimilarity=values / unit)
    different = judgements[judgements["stimulus_a"].astype(str) != judgements["stimulus_b"].astype(str)]
    values = different["dissimilarity"]
    own = values.groupby(different["participant_id"].astype(str))
    means, varied = own.mean(), own.max() > own.min()
    high: list[str] = []
    turned: list[str] = []
    for one in reliability(judgements):
        usual = float(means.get(one.participant_id, np.nan))
        # Who gave everything the same judgement is remarked on by the scaling itself.
        if one.n_identical and varied.get(one.participant_id, False) and one.identical_mean > _NOT_NEAR_ZERO * usual:
            said = f"{one.participant_id} ({one.identical_mean * unit:.3g}, different ones {usual * unit:.3g})"
            (turned if one.identical_mean > usual else high).append(said)
    remarks = []
    if high:
        remarks.append(
            f"Identical pairs are not judged near 0, on average: {', '.join(high)}. Was it clear that the lower "
            "end of the scale means no difference?"
        )
    if turned:
        remarks.append(
            f"Identical pairs are judged more different than different ones, on average: {', '.join(turned)}. Was the "
            "scale reversed?"
        )
    return remarks


def _correlation(a: np.ndarray, b: np.ndarray) -> float:
    both = ~(np.isnan(a) | np.isnan(b))
    a, b = a[both], b[both]
    if len(a) < _FEWEST_COMMON or np.ptp(a) == 0 or np.ptp(b) == 0:
        return np.nan
    return float(np.corrcoef(a, b)[0, 1])
