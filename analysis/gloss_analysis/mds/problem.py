"""Dissimilarities prepared for the solvers: what does not change during a minimisation is computed once."""

from dataclasses import dataclass

import numpy as np

from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds.disparities import Level, SourceOrder, Ties, check_level, level_basis, source_order
from gloss_analysis.mds.kernels import Pairs
from gloss_analysis.mds.projection import METRIC, PRIMARY, SECONDARY, UNTIED

__all__ = ["Problem", "make_problem"]


@dataclass(frozen=True)
class Problem:
    """Dissimilarities with the measurement assumptions, for readers and for kernels.

    Attributes
    ----------
    data : Dissimilarities
    level, ties
        See `disparities`.
    conditional : bool
        Whether each source has a transformation of its own (matrix-conditional), or all share one.
    orders : tuple of SourceOrder
        One a group: one a source, or a single one of all sources' pairs, one source after the other.
    pairs : Pairs
        The same for the kernels.
    """

    data: Dissimilarities
    level: Level
    ties: Ties
    conditional: bool
    orders: tuple[SourceOrder, ...]
    pairs: Pairs

    @property
    def n_stimuli(self) -> int:
        """Number of stimuli."""
        return len(self.data.stimuli)

    @property
    def n_sources(self) -> int:
        """Number of sources (participants)."""
        return len(self.data.participants)

    @property
    def source_shares(self) -> np.ndarray:
        """Part of each source in the mean over sources, shape (m,): they add up to 1.

        It is 0 for those that judged nothing, or nothing but zeros at ratio level, where no distances fit them. Under a
        shared transformation the objective is no mean over sources; these shares then serve to report one.
        """
        if self.conditional:
            return self.pairs.share
        return _shares(self.data.source_weights_or_ones, np.any(self.data.judged, axis=1))


def make_problem(
    data: Dissimilarities, *, level: Level = "ordinal", ties: Ties = "primary", conditional: bool = True
) -> Problem:
    """Prepare `data` for the solvers.

    Raises
    ------
    GlossError
        Unknown level or ties.
    """
    check_level(level, ties)
    n, (first, second) = len(data.stimuli), data.pairs
    n_pairs = data.values.shape[1]
    if conditional:
        orders = tuple(source_order(row, weights) for row, weights in zip(data.values, data.weights, strict=True))
        usable = [order.judged.size > 0 and (level != "ratio" or order.values.max() > 0) for order in orders]
        shares = _shares(data.source_weights_or_ones, np.array(usable))
    else:
        weights = _around_one(data.weights) * _around_one(data.source_weights_or_ones)[:, np.newaxis]
        orders = (source_order(data.values.ravel(), weights.ravel()),)
        shares = np.ones(1)
    parts: dict[str, list[np.ndarray]] = {key: [] for key in ("first", "second", "weight", "block", "basis", "gram")}
    for k, order in enumerate(orders):
        sequence = np.argsort(order.block, kind="stable")
        # Of one group: the pairs of source k; of all: pair numbers run on from source to source.
        source, pair = np.divmod(order.judged[sequence] + k * n_pairs, n_pairs)
        parts["first"].append(source * n + first[pair])
        parts["second"].append(source * n + second[pair])
        weight = _around_one(order.weights[sequence])
        basis = level_basis(order.values[sequence], level)
        parts["weight"].append(weight)
        parts["block"].append(order.block[sequence])
        parts["basis"].append(basis)
        parts["gram"].append((weight[:, np.newaxis] * basis).T @ basis)
    # A source of equal values has fewer columns than others: empty ones are never used.
    columns = max(basis.shape[1] for basis in parts["basis"])
    parts["basis"] = [np.pad(b, ((0, 0), (0, columns - b.shape[1]))) for b in parts["basis"]]
    parts["gram"] = [np.pad(g, (0, columns - len(g))) for g in parts["gram"]]
    kind = METRIC if level != "ordinal" else PRIMARY if ties == "primary" else SECONDARY
    if kind != METRIC and all(len(np.unique(order.block)) == len(order.block) for order in orders):
        kind = UNTIED
    pairs = Pairs(
        kind=kind,
        share=shares,
        start=np.cumsum([0, *(len(order.judged) for order in orders)]),
        first=np.concatenate(parts["first"]).astype(np.uint32),
        second=np.concatenate(parts["second"]).astype(np.uint32),
        weight=np.concatenate(parts["weight"]),
        block=np.concatenate(parts["block"]).astype(np.int32),
        basis=np.concatenate(parts["basis"]),
        gram=np.array(parts["gram"]),
    )
    return Problem(data, level, ties, conditional, orders, pairs)


def _shares(weights: np.ndarray, usable: np.ndarray) -> np.ndarray:
    shares = np.where(usable, _around_one(weights), 0.0)
    total = shares.sum()
    return shares / total if total > 0 else shares


def _around_one(weights: np.ndarray) -> np.ndarray:
    """Only ratios of weights count. Up to 1, their sums neither overflow nor vanish, whatever their unit."""
    largest = weights.max(initial=0.0)
    return np.asarray(weights / largest) if largest > 0 else weights
