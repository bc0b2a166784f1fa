"""What data can be scaled, and what speaks against reading a solution at face value: said in words."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from gloss_analysis.disparities import Level, Ties, disparities
from gloss_analysis.dissimilarity import Dissimilarities
from gloss_analysis.objective import Problem
from glossspace.errors import GlossError

__all__ = ["all_flat", "check_scalable", "data_warnings", "distinguishes", "informs", "solution_warnings"]

_ALMOST_NO_STRESS = 1e-3
_FEW_CLUSTERS = 3
# Disparities that differ by less than this part of the largest are called equal.
_FLAT = 0.05


def check_scalable(data: Dissimilarities, *, level: Level, ties: Ties) -> None:
    """Refuse data that cannot determine one configuration.

    Raises
    ------
    GlossError
        A dissimilarity is negative or infinite; nothing was judged; nobody's judgements say anything about distances;
        or no judged pair links two groups of stimuli.
    """
    judged = ~np.isnan(data.values)
    impossible = judged & ~((data.values >= 0) & np.isfinite(data.values))
    if impossible.any():
        k, pair = np.argwhere(impossible)[0]
        raise GlossError(
            f"Dissimilarity {data.values[k, pair]} of participant {data.participants[k]} is not allowed. "
            "Allowed: a finite number >= 0, or NaN for a pair that was not judged."
        )
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

    Equal values do, for they ask for equal distances; but not where ties may be untied, so that any configuration fits,
    nor zeros at ratio level, which no configuration fits.
    """
    judged = values[~np.isnan(values)]
    if judged.size == 0:
        return False
    if np.ptp(judged) > 0:
        return True
    return ties == "secondary" if level == "ordinal" else level == "interval" or bool(judged[0] > 0)


def distinguishes(values: np.ndarray) -> bool:
    """Whether one participant judged any two pairs differently."""
    judged = values[~np.isnan(values)]
    return judged.size > 0 and bool(np.ptp(judged) > 0)


def data_warnings(data: Dissimilarities, *, level: Level, ties: Ties) -> tuple[str, ...]:
    """Remarks on the data: participants who add nothing or only equal judgements, pairs that nobody judged."""
    remarks = []
    rows = dict(zip(data.participants, data.values, strict=True))
    silent = [name for name, row in rows.items() if np.isnan(row).all()]
    constant = [name for name, row in rows.items() if name not in silent and not distinguishes(row)]
    idle = [name for name in constant if not informs(rows[name], level=level, ties=ties)]
    equal = [name for name in constant if name not in idle]
    if silent:
        remarks.append(f"These participants judged no pair and are not counted: {_short(silent)}.")
    if idle:
        remarks.append(f"These participants distinguished no pairs and add nothing: {_short(idle)}.")
    if equal:
        remarks.append(
            f"These participants distinguished no pairs: {_short(equal)}. Taken at their word, they draw the "
            "configuration towards equal distances. Leave them out if they did not attend."
        )
    unjudged = int(np.isnan(data.values).all(axis=0).sum())
    if unjudged:
        remarks.append(
            f"{unjudged} of {data.values.shape[1]} pairs were judged by nobody; their distances follow from the rest."
        )
    return tuple(remarks)


def solution_warnings(problem: Problem, distances: np.ndarray, n_dims: int, stress1: float) -> tuple[str, ...]:
    """Remarks on a solution: a stress that is low because the solution is degenerate, or could not be otherwise.

    An ordinal analysis may reach stress 0 by collapsing the stimuli into a few points, or with disparities all but
    equal (Borg and Groenen 2005, section 13.3), which an interval analysis can too; such a picture says little about
    the stimuli. Any strict order of the pairs of n stimuli fits in n - 2 dimensions.
    """
    if problem.level == "ratio" or stress1 >= _ALMOST_NO_STRESS:
        return ()
    n = problem.n_stimuli
    clusters = _count_clusters(problem, distances)
    if problem.level == "ordinal" and clusters <= min(_FEW_CLUSTERS, n - 1):
        return (
            f"Degenerate: the {n} stimuli fall on {clusters} points; a stress of {stress1:.2g} says only that. Use "
            "a stricter level (interval), secondary ties, or finer judgements.",
        )
    if all_flat(problem, distances):
        return (
            f"Degenerate: the disparities are all but equal, so a stress of {stress1:.2g} says only that the "
            f"{n} stimuli are equally far apart. Use fewer dimensions or a stricter level.",
        )
    if problem.level == "ordinal" and problem.ties == "primary" and _most_values(problem) <= 2:
        return (
            "The judgements have two distinct values only, so a stress near 0 is no evidence for a good fit. "
            "Use secondary ties, or finer judgements.",
        )
    if problem.level == "ordinal" and problem.n_judging == 1 and n_dims >= n - 2:
        return (
            f"{n_dims} dimensions can follow any order of the pairs of {n} stimuli, so a stress near 0 is no evidence "
            "for a good fit. Use fewer dimensions.",
        )
    return ()


def _count_clusters(problem: Problem, distances: np.ndarray) -> int:
    """How many points remain when stimuli much closer than the farthest count as one."""
    pooled = np.sqrt(np.mean(distances**2, axis=0))
    close = pooled < 0.02 * pooled.max()
    n = problem.n_stimuli
    graph = coo_array((close[close], (problem.first[close], problem.second[close])), shape=(n, n))
    return int(connected_components(graph, directed=False)[0])


def all_flat(problem: Problem, distances: np.ndarray) -> bool:
    """Whether everybody who distinguished pairs is shown as if they had not."""
    for row, order in zip(distances, problem.orders, strict=True):
        if len(order.block_size) > 1:
            fitted = disparities(row[order.judged], order, level=problem.level, ties=problem.ties)
            if np.ptp(fitted) > _FLAT * fitted.max():
                return False
    return True


def _most_values(problem: Problem) -> int:
    return max(len(order.block_size) for order in problem.orders)


def _short(names: list[str]) -> str:
    return ", ".join(names[:4]) + (f" and {len(names) - 4} more" if len(names) > 4 else "")
