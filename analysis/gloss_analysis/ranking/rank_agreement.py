"""How rankings agree with a predicted order, and among themselves."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.stats import kendalltau, rankdata, spearmanr
from scipy.stats import t as t_distribution

from gloss_analysis.ranking.rank_permutation import Orders, orders_of, products_under, sums_under
from gloss_analysis.replicates import OnStep, no_step

__all__ = [
    "ParticipantRanking",
    "agreement_of_participants",
    "joint_test",
    "mean_ranks",
    "ranks_of_stimuli",
]

# Mean ranks are fractions, whose sums round differently: to so many digits equal ones are ties. Those of several
# participants are made of rounded ones, and equal to fewer digits.
_OF_ONE, _OF_SEVERAL = 12, 9


@dataclass(frozen=True)
class ParticipantRanking:
    """How one participant's ranks agree with the prediction and with the other participants.

    Attributes
    ----------
    participant_id : str
    n_stimuli : int
    tau_b, spearman : float
        With the predicted distances.
    tau_b_p, spearman_p : float
        Two-sided, by permutation.
    tau_b_others : float
        With the mean rank of the other participants; NaN without them.
    """

    participant_id: str
    n_stimuli: int
    tau_b: float
    tau_b_p: float
    spearman: float
    spearman_p: float
    tau_b_others: float


def mean_ranks(written: np.ndarray) -> np.ndarray:
    """Ranks from 1 to n of each participant, ties shared, repeats averaged, partial rankings stretched.

    Parameters
    ----------
    written : ndarray, shape (m, r, n)
        As of `Rankings`; NaN where a stimulus was not ranked.

    Returns
    -------
    ndarray, shape (m, n)

    Examples
    --------
    >>> mean_ranks(np.array([[[10.0, 30.0, 30.0, np.nan]]])).round(3).tolist()
    [[1.167, 3.167, 3.167, nan]]
    """
    n = written.shape[-1]
    own = rankdata(written, axis=-1, nan_policy="omit")
    counted = np.isfinite(own)
    # The k-th of n_k ranks covers the share (k - 1) / n_k to k / n_k; its middle keeps its place among n.
    stretched = (own - 0.5) / np.maximum(counted.sum(axis=-1, keepdims=True), 1) * n + 0.5
    times = counted.sum(axis=1)
    return np.round(np.where(times > 0, np.nansum(stretched, axis=1) / np.maximum(times, 1), np.nan), _OF_ONE)


def agreement_of_participants(
    names: Sequence[str],
    ranks: np.ndarray,
    levels: np.ndarray,
    n_permutations: int,
    seed: np.random.SeedSequence,
    on_step: OnStep = no_step,
) -> tuple[ParticipantRanking, ...]:
    """Kendall's tau-b and Spearman's rho of each participant with a predicted order, and with the other participants.

    Parameters
    ----------
    names : sequence of str, length m
    ranks : ndarray, shape (m, n)
        NaN where a stimulus was not ranked; three or more of each participant, not all equal.
    levels : ndarray of int, shape (n,)
        The predicted order, with ties.
    n_permutations : int
    seed : SeedSequence
    on_step : callable
        Called with the number of participants done and of all.

    Returns
    -------
    tuple of ParticipantRanking
        NaN where the stimuli that a participant ranked are all of one level.
    """
    p_values = np.full((len(names), 2), np.nan)
    groups, done = list(_by_stimuli(ranks)), 0
    for (ranked, members), own_seed in zip(groups, seed.spawn(len(groups)), strict=True):
        orders = orders_of(int(ranked.sum()), n_permutations, own_seed)
        own = ranks[np.ix_(members, ranked)]
        matrix, others = _signs(levels[ranked]), _signs(own)
        x = rankdata(levels[ranked])
        y = rankdata(own, axis=1)
        tau_null = np.abs(products_under(orders, matrix, others))
        rho_null = np.abs(sums_under(orders, x - x.mean(), y - y.mean(axis=1, keepdims=True)))
        for column, member in enumerate(members):
            observed = abs(float((matrix * others[column]).sum())), abs(float((x - x.mean()) @ y[column]))
            p_values[member] = (
                orders.p_value(tau_null[:, column], observed[0]),
                orders.p_value(rho_null[:, column], observed[1]),
            )
        done += len(members)
        on_step(done, len(names))
    found = []
    for k, (name, row) in enumerate(zip(names, ranks, strict=True)):
        ranked = np.isfinite(row)
        ordered = len(set(levels[ranked])) > 1
        found.append(
            ParticipantRanking(
                participant_id=name,
                n_stimuli=int(ranked.sum()),
                tau_b=_tau(levels, row),
                tau_b_p=float(p_values[k, 0]) if ordered else float("nan"),
                spearman=float(spearmanr(levels[ranked], row[ranked]).statistic) if ordered else float("nan"),
                spearman_p=float(p_values[k, 1]) if ordered else float("nan"),
                tau_b_others=_tau(np.round(_mean_of(np.delete(ranks, k, axis=0)), _OF_SEVERAL), row),
            )
        )
    return tuple(found)


def joint_test(
    agreement: Sequence[ParticipantRanking], ranks: np.ndarray, levels: np.ndarray, orders: Orders
) -> tuple[float, float]:
    """Mean tau-b of the participants and its two-sided p, against stimuli that change places for all at once.

    Participants share the stimuli, so that their tau are not independent: what they have in common may be another
    property than gloss. Orders of the stimuli are the null hypothesis that holds this apart.
    """
    taus = np.array([one.tau_b for one in agreement])
    counted = np.isfinite(taus)
    if not counted.any():
        return float("nan"), float("nan")
    signs = _signs(ranks[counted])
    matrix = _signs(levels)
    # Each participant's concordances, divided by what tau-b divides them by.
    observed = (matrix * signs).sum(axis=(1, 2))
    norm = np.array(
        [
            np.sqrt(np.abs(one).sum() * np.abs(matrix[np.ix_(ranked, ranked)]).sum())
            for one, ranked in zip(signs, np.isfinite(ranks[counted]), strict=True)
        ]
    )
    weights = (1 / norm / counted.sum())[:, None, None]
    null = products_under(orders, matrix, (signs * weights).sum(axis=0)[None])[:, 0]
    return float(taus[counted].mean()), orders.p_value(np.abs(null), abs(float((observed * weights[:, 0, 0]).sum())))


def ranks_of_stimuli(names: Sequence[str], distances: np.ndarray, ranks: np.ndarray) -> pd.DataFrame:
    """Mean rank of each stimulus with its 95 % t interval over participants; see `RankingStudy.stimuli`."""
    counts = np.isfinite(ranks).sum(axis=0)
    mean = _mean_of(ranks)
    squares = np.nansum(np.square(ranks - mean), axis=0)
    several = counts > 1
    freedom = np.where(several, counts - 1, 1)
    standard_error = np.sqrt(squares / freedom / np.maximum(counts, 1))
    half = np.where(several, t_distribution.ppf(0.975, freedom) * standard_error, np.nan)
    columns = {"distance": distances, "mean_rank": mean, "low": mean - half, "high": mean + half}
    return pd.DataFrame({"stimulus": list(names), **columns, "n_participants": counts})


def _by_stimuli(ranks: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Participants who ranked the same stimuli: which stimuli, and who."""
    patterns, group = np.unique(np.isfinite(ranks), axis=0, return_inverse=True)
    for index, ranked in enumerate(patterns):
        yield ranked, np.flatnonzero(group.reshape(-1) == index)


def _signs(values: np.ndarray) -> np.ndarray:
    """Sign of every difference along the last axis; 0 where a value is missing."""
    return np.nan_to_num(np.sign(values[..., :, None] - values[..., None, :])).astype(float)


def _mean_of(ranks: np.ndarray) -> np.ndarray:
    counts = np.isfinite(ranks).sum(axis=0)
    return np.where(counts > 0, np.nansum(ranks, axis=0) / np.maximum(counts, 1), np.nan)


def _tau(order: np.ndarray, ranks: np.ndarray) -> float:
    known = np.isfinite(order) & np.isfinite(ranks)
    if known.sum() < 3 or np.ptp(order[known]) == 0 or np.ptp(ranks[known]) == 0:
        return float("nan")
    return float(kendalltau(order[known], ranks[known]).statistic)
