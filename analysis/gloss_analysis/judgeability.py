"""What data can be scaled, and what speaks against reading a solution at face value: said in words."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from gloss_analysis.disparities import Level, Ties
from gloss_analysis.dissimilarity import Dissimilarities
from gloss_analysis.objective import Problem
from glossspace.errors import GlossError

__all__ = ["check_scalable", "data_warnings", "informs", "solution_warnings"]

_ALMOST_NO_STRESS = 1e-3
_FEW_CLUSTERS = 3


def check_scalable(data: Dissimilarities, *, level: Level, ties: Ties) -> None:
    """Refuse data that cannot determine one configuration.

    Raises
    ------
    GlossError
        Nothing was judged; nobody distinguished any pairs; or no judged pair links two groups of stimuli.
    """
    judged = ~np.isnan(data.values)
    if not judged.any():
        raise GlossError("No pair was judged. Scaling needs dissimilarities.")
    if not any(informs(row, level=level, ties=ties) for row in data.values):
        raise GlossError("Every participant gave all pairs the same dissimilarity: there is no structure to scale.")
    first, second = data.pairs
    linked = judged.any(axis=0)
    n = len(data.stimuli)
    graph = coo_array((np.ones(linked.sum()), (first[linked], second[linked])), shape=(n, n))
    count, group = connected_components(graph, directed=False)
    if count > 1:
        names = [[s for s, g in zip(data.stimuli, group, strict=True) if g == k] for k in range(2)]
        raise GlossError(
            f"No judged pair links the stimuli {_short(names[0])} with {_short(names[1])}: their relative position "
            "cannot be known. Judge pairs across, or scale the groups apart."
        )


def informs(values: np.ndarray, *, level: Level, ties: Ties) -> bool:
    """Whether one participant's dissimilarities say anything about distances.

    Equal values do, unless ties may be untied: then any configuration fits them. Zeros alone never do.
    """
    judged = values[~np.isnan(values)]
    if not judged.any():
        return False
    return np.ptp(judged) > 0 or not (level == "ordinal" and ties == "primary")


def data_warnings(data: Dissimilarities, *, level: Level, ties: Ties) -> tuple[str, ...]:
    """Remarks on the data: participants who add nothing, pairs that nobody judged."""
    remarks = []
    constant = [
        name
        for name, row in zip(data.participants, data.values, strict=True)
        if not informs(row, level=level, ties=ties)
    ]
    if constant:
        remarks.append(f"These participants distinguished no pairs and add nothing: {_short(constant)}.")
    unjudged = int(np.isnan(data.values).all(axis=0).sum())
    if unjudged:
        remarks.append(
            f"{unjudged} of {data.values.shape[1]} pairs were judged by nobody; their distances follow from the rest."
        )
    return tuple(remarks)


def solution_warnings(problem: Problem, distances: np.ndarray, stress1: float) -> tuple[str, ...]:
    """Remarks on a solution: a stress that is low because the solution is degenerate.

    An ordinal analysis may reach stress 0 by collapsing the stimuli into a few points, with all disparities but a few
    equal (Borg and Groenen 2005, section 13.3); such a picture says little about the stimuli.
    """
    remarks = []
    if problem.level == "ordinal" and stress1 < _ALMOST_NO_STRESS:
        pooled = np.sqrt(np.mean(distances**2, axis=0))
        close = pooled < 0.02 * pooled.max()
        n = problem.n_stimuli
        graph = coo_array((close[close], (problem.first[close], problem.second[close])), shape=(n, n))
        clusters = connected_components(graph, directed=False)[0]
        if clusters <= min(_FEW_CLUSTERS, n - 1):
            remarks.append(
                f"Degenerate: the {n} stimuli fall on {clusters} points; a stress of {stress1:.2g} says only that. Use "
                "a stricter level (interval), secondary ties, or finer judgements."
            )
        elif max((len(order.block_size) for order in problem.orders), default=0) <= 2:
            remarks.append(
                "The judgements have two distinct values only, so a stress near 0 is no evidence for a good fit. "
                "Use secondary ties, or finer judgements."
            )
    return tuple(remarks)


def _short(names: list[str]) -> str:
    return ", ".join(names[:4]) + (f" and {len(names) - 4} more" if len(names) > 4 else "")
