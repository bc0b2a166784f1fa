"""What data can be scaled, and what speaks against reading a solution at face value: said in words."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds.disparities import Level, SourceOrder, Ties, disparities
from gloss_analysis.mds.problem import Problem
from glossspace.errors import GlossError

__all__ = [
    "all_flat",
    "check_scalable",
    "data_warnings",
    "distinguishes",
    "informs",
    "position_warnings",
    "solution_warnings",
]

_ALMOST_NO_STRESS = 1e-3
_FEW_CLUSTERS = 3
# Disparities that differ by less than this part of the largest are called equal.
_FLAT = 0.05
# Beyond so many, the rank of their derivatives takes longer than the scaling.
_MOST_COORDINATES = 400


def check_scalable(data: Dissimilarities, *, level: Level, ties: Ties) -> None:
    """Refuse data that cannot determine one configuration.

    Raises
    ------
    GlossError
        A dissimilarity or a weight is negative or infinite; nothing was judged; nobody's judgements say anything about
        distances; or no judged pair links two groups of stimuli.
    """
    _check_weights(data)
    judged = data.judged & (data.source_weights_or_ones > 0)[:, np.newaxis]
    impossible = judged & ~((data.values >= 0) & np.isfinite(data.values))
    if impossible.any():
        k, pair = np.argwhere(impossible)[0]
        raise GlossError(
            f"Dissimilarity {data.values[k, pair]} of participant {data.participants[k]} is not allowed. "
            "Allowed: a finite number >= 0, or NaN for a pair that was not judged."
        )
    if not judged.any():
        raise GlossError("No pair was judged. Scaling needs dissimilarities.")
    if not any(informs(row[seen], level=level, ties=ties) for row, seen in zip(data.values, judged, strict=True)):
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


def _check_weights(data: Dissimilarities) -> None:
    m, n_pairs = data.values.shape
    for weights, shape, what in (
        (data.pair_weights, (m, n_pairs), "of a pair"),
        (data.source_weights, (m,), "of a participant"),
    ):
        if weights is None:
            continue
        if weights.shape != shape:
            raise GlossError(f"Weights {what} of shape {weights.shape} do not fit the data. Allowed: {shape}.")
        impossible = ~(np.isfinite(weights) & (weights >= 0))
        if impossible.any():
            raise GlossError(f"Weight {what} {weights[impossible][0]} is not allowed. Allowed: a finite number >= 0.")
    if data.source_weights is not None and not (data.source_weights * data.judged.any(axis=1)).any():
        raise GlossError("No participant with a weight above 0 judged anything. Scaling needs one.")


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
    return ties == "secondary" if level == "ordinal" else level != "ratio" or bool(judged[0] > 0)


def distinguishes(values: np.ndarray) -> bool:
    """Whether one participant judged any two pairs differently."""
    judged = values[~np.isnan(values)]
    return judged.size > 0 and bool(np.ptp(judged) > 0)


def data_warnings(data: Dissimilarities, *, level: Level, ties: Ties) -> tuple[str, ...]:
    """Remarks on the data: participants who add nothing or only equal judgements, pairs that nobody judged."""
    remarks = []
    judged = data.judged & (data.source_weights_or_ones > 0)[:, np.newaxis]
    rows = dict(zip(data.participants, np.where(judged, data.values, np.nan), strict=True))
    silent = [name for name, row in rows.items() if np.isnan(row).all()]
    constant = [name for name, row in rows.items() if name not in silent and not distinguishes(row)]
    idle = [name for name in constant if not informs(rows[name], level=level, ties=ties)]
    equal = [name for name in constant if name not in idle]
    if silent:
        remarks.append(f"These participants judged no pair and are not counted: {_short(silent)}.")
    if idle:
        why = (
            "judged all pairs 0, which no distances fit at ratio level, and are not counted"
            if level == "ratio"
            else "distinguished no pairs and add nothing but a stress of 0, since any configuration fits them"
        )
        remarks.append(f"These participants {why}: {_short(idle)}.")
    if equal:
        remarks.append(
            f"These participants distinguished no pairs: {_short(equal)}. Taken at their word, they draw the "
            "configuration towards equal distances. Leave them out if they did not attend."
        )
    unjudged = int((~judged).all(axis=0).sum())
    if unjudged:
        remarks.append(f"{unjudged} of {data.values.shape[1]} pairs were judged by nobody.")
    return tuple(remarks)


def position_warnings(data: Dissimilarities, n_dims: int) -> tuple[str, ...]:
    """Remark on pairs too few or too ill placed to hold the stimuli in `n_dims` dimensions.

    A framework of points and judged distances is generically rigid when the derivatives of the distances by the
    coordinates, at points in no special position, leave nothing free but a motion of the whole.
    """
    seen = (data.judged & (data.source_weights_or_ones > 0)[:, np.newaxis]).any(axis=0)
    n = len(data.stimuli)
    if seen.all() or n * n_dims > _MOST_COORDINATES:
        return ()
    first, second = (index[seen] for index in data.pairs)
    points = np.random.default_rng(0).standard_normal((n, n_dims))
    row, apart = np.arange(len(first)), points[first] - points[second]
    derivative = np.zeros((len(first), n, n_dims))
    derivative[row, first], derivative[row, second] = apart, -apart
    held = np.linalg.matrix_rank(derivative.reshape(len(first), -1))
    if held >= min(n * n_dims - n_dims * (n_dims + 1) // 2, n * (n - 1) // 2):
        return ()
    return (
        f"The judged pairs leave positions open: in {n_dims} dimensions some stimuli can move without a change of any "
        "judged distance, so that the configuration is one of many. Judge more pairs, or use fewer dimensions.",
    )


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
    if problem.level == "ordinal" and n_dims >= n - 2:
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
    first, second = problem.data.pairs
    graph = coo_array((close[close], (first[close], second[close])), shape=(n, n))
    return int(connected_components(graph, directed=False)[0])


def all_flat(problem: Problem, distances: np.ndarray) -> bool:
    """Whether everybody who distinguished pairs is shown as if they had not."""
    rows = distances if problem.conditional else distances.reshape(1, -1)
    for row, order in zip(rows, problem.orders, strict=True):
        if _distinct(order) > 1:
            fitted = disparities(row[order.judged], order, level=problem.level, ties=problem.ties)
            if np.ptp(fitted) > _FLAT * fitted.max():
                return False
    return True


def _most_values(problem: Problem) -> int:
    return max(_distinct(order) for order in problem.orders)


def _distinct(order: SourceOrder) -> int:
    return int(order.block.max(initial=-1)) + 1


def _short(names: list[str]) -> str:
    return ", ".join(names[:4]) + (f" and {len(names) - 4} more" if len(names) > 4 else "")
