"""A ranking study: do stimuli ranked by gloss follow the order that a gloss space predicts (section 5.1)?

The gloss paper ranked Experiment 1's stimuli and found that those on one isogloss contour round a low-gloss reference
got similar ranks.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np
import pandas as pd

from gloss_analysis.ranking.contour_ranks import Contours, contour_test, levels_of
from gloss_analysis.ranking.rank_agreement import (
    ParticipantRanking,
    agreement_of_participants,
    joint_test,
    mean_ranks,
    ranks_of_stimuli,
)
from gloss_analysis.ranking.rank_permutation import concordance, orders_of
from gloss_analysis.ranking.rank_table import Rankings
from gloss_analysis.ranking.ranking_words import ranking_remarks, ranking_sentences
from gloss_analysis.replicates import OnStep, no_step
from glossspace.errors import GlossError
from glossspace.metric import PAPER_SPACE, GlossSpace, Paint

__all__ = ["RankedBy", "RankingStudy", "predicted_order", "study_ranking"]

RankedBy: TypeAlias = Literal["gloss", "difference"]

# Gloss distances that differ by less are the same: stimuli of computed paints are rounded, and nobody sees a 400th of
# the paper's .04.
_SAME = 1e-4


@dataclass(frozen=True)
class RankingStudy:
    """What rankings say of a predicted order.

    Attributes
    ----------
    stimuli : DataFrame
        `stimulus`, `distance`, `mean_rank`, `low`, `high` (95 % t interval over participants; NaN for fewer than two),
        `n_participants`; nearest first. Ranks are from 1 for the nearest to n.
    participants : tuple of ParticipantRanking
        Whose ranks could be used.
    mean_tau_b, mean_tau_b_p : float
        Over participants; two-sided, against stimuli that change places for all participants at once.
    ceiling : float or None
        Mean of `tau_b_others`: about the best that a prediction can do. None for a single participant.
    concordance, concordance_p : float or None
        Kendall's W of those who ranked every stimulus, corrected for ties; None for fewer than two.
    contours : Contours or None
        None where no two stimuli lie on one contour, or all do.
    sentences, warnings : tuple of str
        The same in words; what was left out and what looks odd.
    """

    stimuli: pd.DataFrame
    participants: tuple[ParticipantRanking, ...]
    mean_tau_b: float
    mean_tau_b_p: float
    ceiling: float | None
    concordance: float | None
    concordance_p: float | None
    contours: Contours | None
    sentences: tuple[str, ...]
    warnings: tuple[str, ...]


def predicted_order(
    paints: Mapping[str, Paint], *, reference: str, space: GlossSpace = PAPER_SPACE, ranked_by: RankedBy = "gloss"
) -> pd.DataFrame:
    """Predict the order of stimuli: their gloss distances from a reference.

    Parameters
    ----------
    paints : mapping of str to Paint
        All stimuli, the reference among them.
    reference : str
        A stimulus of low gloss, if stimuli were ranked by gloss.
    space : GlossSpace
    ranked_by : {"gloss", "difference"}
        What was ranked: how glossy stimuli look, or how different from the reference.

    Returns
    -------
    DataFrame
        By stimulus: `distance`, and `angle_deg`, whether it is a difference in c (0) or in d (90), NaN where there is
        none. For "gloss" the distance is NaN where a stimulus has less of one dimension than the reference, or of both:
        the distance does not say then whether it is glossier.

    Raises
    ------
    GlossError
        The reference is not among the stimuli, or a paint is impossible.

    Examples
    --------
    >>> paints = {"dull": Paint(0.193, 0.033, 0.1), "sharp": Paint(0.193, 0.033, 0.04)}
    >>> predicted_order(paints, reference="dull").loc["sharp"].round(4).tolist()
    [0.1068, 90.0]
    """
    if reference not in paints:
        known = ", ".join(list(paints)[:3])
        raise GlossError(f"The reference {reference!r} is not among the stimuli, such as {known}. Give one of them.")
    c, d = space.coordinates(Paint(*np.array(list(paints.values()), dtype=float).T))
    own = list(paints).index(reference)
    distance = np.asarray(space.distance_between(c[own], d[own], c, d))
    delta_c, delta_d = space.weight_c * (c - c[own]), space.weight_d * (d - d[own])
    angle_deg = np.where(distance > _SAME, np.degrees(np.arctan2(np.abs(delta_d), np.abs(delta_c))), np.nan)
    if ranked_by == "gloss":
        distance = np.where((delta_c < -_SAME) | (delta_d < -_SAME), np.nan, distance)
    return pd.DataFrame({"distance": distance, "angle_deg": angle_deg}, index=list(paints))


def study_ranking(
    rankings: Rankings,
    order: pd.DataFrame,
    *,
    tolerance: float = 0.004,
    n_permutations: int = 9999,
    seed: int = 1,
    on_step: OnStep = no_step,
) -> RankingStudy:
    """Hold rankings against a predicted order.

    Parameters
    ----------
    rankings : Rankings
        Rank 1 is the nearest to the reference, or the least glossy.
    order : DataFrame
        From `predicted_order`; a stimulus whose distance is NaN does not enter.
    tolerance : float
        Stimuli whose distances differ by no more lie on one isogloss contour; > 0. The default is a tenth of the step
        between the contours of the paper's figure 11.
    n_permutations : int
        For p values, 99 or more; all orders where they are no more.
    seed : int
        Of the permutations.
    on_step : callable
        Called with the number of participants done and of all, to show progress.

    Returns
    -------
    RankingStudy

    Raises
    ------
    GlossError
        A ranked stimulus is unknown, fewer than three have a prediction, they are all at one distance, an option is not
        allowed, or nobody's ranks tell stimuli apart.

    Notes
    -----
    Repeats of a participant are ranked each for itself and averaged. A partial ranking is stretched to the range of all
    stimuli, as if those left out were missing at random.

    Examples
    --------
    Of the 24 orders of four stimuli, 8 agree with the prediction, or with its reverse, in five pairs or more.

    >>> rankings = Rankings(("01",), ("a", "b", "c", "d"), np.array([[[1.0, 2.0, 4.0, 3.0]]]))
    >>> order = pd.DataFrame({"distance": [0.0, 0.1, 0.2, 0.3], "angle_deg": 45.0}, index=list("abcd"))
    >>> study_ranking(rankings, order).participants[0].tau_b_p
    0.3333333333333333
    """
    if not (np.isfinite(tolerance) and tolerance > 0):
        raise GlossError(f"Invalid tolerance = {tolerance!r}. Allowed: a gloss distance > 0, such as 0.004.")
    if not 99 <= n_permutations <= 1_000_000:
        raise GlossError(f"Invalid number of permutations {n_permutations}. Allowed: 99 to 1,000,000.")
    predicted, silent = _predicted(rankings, order)
    every = _ranks(rankings, list(predicted.index))
    usable = np.array([np.isfinite(row).sum() >= 3 and np.nanmax(row) > np.nanmin(row) for row in every], dtype=bool)
    if not usable.any():
        raise GlossError(
            "Nobody ranked three of the stimuli that have a prediction and told them apart: there is nothing to "
            "compare."
        )
    kept, left_out = (
        tuple(name for name, use in zip(rankings.participants, usable, strict=True) if use == wanted)
        for wanted in (True, False)
    )
    # What only those ranked who are left out has no mean rank, and no place among the others.
    ranked = np.isfinite(every[usable]).any(axis=0)
    unranked, predicted = list(predicted.index[~ranked]), predicted[ranked]
    names, distance = list(predicted.index), predicted["distance"].to_numpy()
    _refuse_one_distance(distance)
    ranks = _ranks(rankings, names)[usable]
    seeds = np.random.SeedSequence(seed).spawn(4)
    levels = levels_of(distance, _SAME)
    agreement = agreement_of_participants(kept, ranks, levels, n_permutations, seeds[0], on_step)
    joint = orders_of(len(names), n_permutations, seeds[1])
    mean_tau, mean_p = joint_test(agreement, ranks, levels, joint)
    complete = ranks[np.isfinite(ranks).all(axis=1)]
    w, w_p = concordance(complete, n_permutations, seeds[2]) if len(complete) > 1 else (None, None)
    others = np.array([one.tau_b_others for one in agreement])
    table = ranks_of_stimuli(names, distance, ranks)
    contours = contour_test(
        distance, predicted["angle_deg"].to_numpy(), table["mean_rank"].to_numpy(), tolerance=tolerance, orders=joint,
        seed=seeds[3],
    )  # fmt: skip
    study = RankingStudy(
        stimuli=table,
        participants=agreement,
        mean_tau_b=mean_tau,
        mean_tau_b_p=mean_p,
        ceiling=float(np.nanmean(others)) if np.isfinite(others).any() else None,
        concordance=w,
        concordance_p=w_p,
        contours=contours,
        sentences=(),
        warnings=ranking_remarks(agreement, silent=silent, left_out=left_out, unranked=unranked, n_stimuli=len(names)),
    )
    return replace(study, sentences=ranking_sentences(study, n_complete=len(complete)))


def _predicted(rankings: Rankings, order: pd.DataFrame) -> tuple[pd.DataFrame, list[str]]:
    """Ranked stimuli with a prediction, nearest first, and the names of those without."""
    unknown = [name for name in rankings.stimuli if name not in order.index]
    if unknown:
        raise GlossError(
            f"The ranked stimulus {unknown[0]!r} is not among the known stimuli ({len(unknown)} such). Add its row to "
            "the stimulus table."
        )
    ranked = order.loc[list(rankings.stimuli)]
    silent = list(ranked.index[ranked["distance"].isna()])
    predicted = ranked.dropna(subset="distance").sort_values("distance", kind="stable")
    if len(predicted) < 3:
        hint = ""
        if silent:
            hint = (
                f" {len(silent)} stimuli have less of a dimension than the reference, such as {silent[0]!r}: choose "
                "the least glossy stimulus as the reference, or compare rankings by difference from it."
            )
        raise GlossError(f"A ranking needs three stimuli with a prediction, but {len(predicted)} were ranked.{hint}")
    _refuse_one_distance(predicted["distance"].to_numpy())
    return predicted, silent


def _refuse_one_distance(distances: np.ndarray) -> None:
    if levels_of(distances, _SAME)[-1] == 0:
        raise GlossError(
            f"All {len(distances)} ranked stimuli lie at gloss distance {distances[0]:.4g} from the reference, so that "
            "no order is predicted. Rank stimuli at several distances."
        )


def _ranks(rankings: Rankings, names: list[str]) -> np.ndarray:
    """Ranks of the named stimuli among themselves, shape (m, n)."""
    return mean_ranks(rankings.ranks[:, :, [rankings.stimuli.index(name) for name in names]])
