"""What a ranking study says, in words."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from gloss_analysis.ranking.contour_ranks import Contours, Direction
    from gloss_analysis.ranking.rank_agreement import ParticipantRanking
    from gloss_analysis.ranking.ranking_study import RankingStudy

__all__ = ["ranking_remarks", "ranking_sentences"]

_SURE = 0.05


def ranking_sentences(study: "RankingStudy", *, n_complete: int) -> tuple[str, ...]:
    """Findings of a ranking study; `n_complete` participants ranked every stimulus."""
    m, n = len(study.participants), len(study.stimuli)
    counted = "1 participant" if m == 1 else f"{m} participants"
    if not np.isfinite(study.mean_tau_b):
        verdict = "nobody ranked stimuli of different predicted distances."
    elif study.mean_tau_b_p >= _SURE:
        verdict = "no agreement with the predicted order can be shown."
    elif study.mean_tau_b > 0:
        verdict = "the ranks follow the predicted order."
    else:
        verdict = "the ranks run against the predicted order. Does rank 1 stand for the most gloss?"
    said = [
        f"{counted} ranked {n} stimuli. Mean Kendall tau-b with the predicted order: {study.mean_tau_b:.2f} "
        f"(p = {study.mean_tau_b_p:.2g}): {verdict}"
    ]
    if m > 1:
        alone = sum(one.tau_b > 0 and one.tau_b_p < _SURE for one in study.participants)
        said.append(f"Taken singly, {alone} of {m} participants follow it with p < {_SURE}.")
    if study.ceiling is not None:
        said.append(
            f"The mean rank of the others predicts a participant with a mean tau-b of {study.ceiling:.2f}: about the "
            "best that a prediction can do."
        )
    if study.concordance is not None and study.concordance_p is not None:
        finding = "they agree" if study.concordance_p < _SURE else "no agreement can be shown"
        said.append(
            f"Concordance of {n_complete} participants: Kendall's W = {study.concordance:.2f} "
            f"(p = {study.concordance_p:.2g}): {finding}."
        )
    return (*said, *_of_contours(study.contours, study.stimuli["distance"].to_numpy()))


def _of_contours(contours: "Contours | None", distances: np.ndarray) -> tuple[str, ...]:
    if contours is None:
        nearest = float(np.diff(np.sort(distances)).min())
        return (
            "No two stimuli lie on one isogloss contour, or all do: ranks along a contour cannot be compared. The "
            f"nearest two differ by {nearest:.2g} in their distance; a larger tolerance takes such for one contour.",
        )
    counted = "1 pair" if contours.n_pairs == 1 else f"{contours.n_pairs} pairs"
    finding = "got similar ranks" if contours.p_value < _SURE else "did not demonstrably get more similar ranks"
    similar = (
        f"Stimuli on one isogloss contour ({counted} within {contours.tolerance:g}) {finding}: they differ by "
        f"{contours.within:.1f} in the mean, others by {contours.between:.1f} (p = {contours.p_value:.2g})."
    )
    return (similar,) if contours.direction is None else (similar, _of_direction(contours.direction))


def _of_direction(direction: "Direction") -> str:
    place = (
        f"{abs(direction.lead):.1f} ranks {'ahead' if direction.lead > 0 else 'behind'} (p = {direction.p_value:.2g})"
    )
    start = f"Along contours, stimuli that differ in distinctness rather than in contrast are {place}: "
    if direction.p_value >= _SURE:
        return start + "the way in which they differ cannot be shown to matter, as the space predicts."
    more = "more" if direction.lead > 0 else "less"
    return start + f"in these rankings d counts {more} beside c than in the space."


def ranking_remarks(
    agreement: Sequence["ParticipantRanking"],
    *,
    silent: Sequence[str],
    left_out: Sequence[str],
    unranked: Sequence[str],
    n_stimuli: int,
) -> tuple[str, ...]:
    """What does not enter a ranking study, and whose rankings look odd."""
    remarks = []
    if silent:
        remarks.append(
            "Without a prediction, since they are not glossier than the reference in both dimensions, and left out: "
            f"{', '.join(silent)}."
        )
    if left_out:
        remarks.append(
            f"Ranked all stimuli equal, or fewer than three of those with a prediction; left out: "
            f"{', '.join(left_out)}."
        )
    if unranked:
        remarks.append(f"Ranked by nobody else, and left out: {', '.join(unranked)}.")
    reversed_ = [one.participant_id for one in agreement if one.tau_b < 0 and one.tau_b_p < _SURE]
    if reversed_:
        remarks.append(
            f"Ranked against the predicted order, perhaps with the scale reversed: {', '.join(reversed_)}. They stay "
            "in: ask them, and turn their ranks in the table if it was a mistake."
        )
    partial = [one.participant_id for one in agreement if one.n_stimuli < n_stimuli]
    if partial:
        remarks.append(
            f"Ranked only some of the stimuli: {', '.join(partial)}. The others are taken as missing at random; "
            "Kendall's W leaves these participants out."
        )
    return tuple(remarks)
