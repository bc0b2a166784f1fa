"""Incomplete designs of pairs that hang together: what is required of them, and thinning that keeps to it."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from glossspace.errors import GlossError

__all__ = ["Requirement", "check_requirement", "thinned"]


@dataclass(frozen=True)
class Requirement:
    """A connected design of n stimuli, each of them in `degree` pairs or more."""

    n_stimuli: int
    degree: int

    @cached_property
    def pairs(self) -> tuple[np.ndarray, np.ndarray]:
        """First and second stimulus of all pairs."""
        return np.triu_indices(self.n_stimuli, 1)

    @property
    def fewest(self) -> int:
        """Pairs of the smallest such design.

        Examples
        --------
        >>> Requirement(27, 1).fewest, Requirement(27, 3).fewest
        (26, 41)
        """
        return max(self.n_stimuli - 1, (self.n_stimuli * self.degree + 1) // 2)

    def degrees(self, kept: np.ndarray) -> np.ndarray:
        """In how many of the pairs kept each stimulus is, shape (n,)."""
        ends = np.concatenate([index[kept] for index in self.pairs])
        return np.bincount(ends, minlength=self.n_stimuli)

    def met_by(self, kept: np.ndarray) -> bool:
        """Whether the pairs kept, shape (n (n - 1) / 2,), are such a design."""
        if self.degrees(kept).min() < self.degree:
            return False
        first, second = (index[kept] for index in self.pairs)
        graph = coo_array((np.ones(len(first)), (first, second)), shape=(self.n_stimuli, self.n_stimuli))
        return int(connected_components(graph, directed=False, return_labels=False)) == 1


def check_requirement(required: Requirement, n_pairs: int) -> None:
    """Refuse what no design of so many pairs can meet.

    Raises
    ------
    GlossError
        Fewer than three stimuli, a degree outside 1 to n - 1, or a number of pairs too small for it or above all.
    """
    n, degree = required.n_stimuli, required.degree
    if n < 3:
        raise GlossError(f"A design needs three stimuli or more, not {n}.")
    if not 1 <= degree <= n - 1:
        raise GlossError(f"Invalid degree = {degree} of {n} stimuli. Allowed: 1 to {n - 1}, the pairs each can be in.")
    every = len(required.pairs[0])
    if not required.fewest <= n_pairs <= every:
        raise GlossError(
            f"Invalid number of pairs = {n_pairs}. {n} stimuli have {every} pairs, and a connected design with each in "
            f"{degree} pairs needs {required.fewest}. Allowed: {required.fewest} to {every}; a smaller degree needs "
            "fewer."
        )


def thinned(
    required: Requirement, n_pairs: int, loss: Callable[[np.ndarray], np.ndarray], *, order: np.ndarray
) -> np.ndarray:
    """Drop pairs one after the other, each time the one of least loss whose absence the requirement bears.

    Parameters
    ----------
    required : Requirement
    n_pairs : int
        To keep; see `check_requirement`.
    loss : callable
        Gives, of the pairs kept, shape (q,), what the loss of each costs, shape (q,).
    order : ndarray of int, shape (n,)
        Of the stimuli in a Harary graph (1962), the smallest design of the degree; its pairs stay where thinning
        without it comes to an end too early.

    Returns
    -------
    ndarray of bool, shape (q,)
    """
    kept = _thinned(required, n_pairs, loss, np.zeros(len(required.pairs[0]), dtype=bool))
    return _thinned(required, n_pairs, loss, _harary(required, order)) if kept.sum() > n_pairs else kept


def _thinned(
    required: Requirement, n_pairs: int, loss: Callable[[np.ndarray], np.ndarray], fixed: np.ndarray
) -> np.ndarray:
    kept = np.ones(len(fixed), dtype=bool)
    while kept.sum() > n_pairs:
        costs = np.where(kept & ~fixed, loss(kept), np.inf)
        for pair in np.argsort(costs, kind="stable"):
            if not kept[pair] or fixed[pair]:
                continue
            kept[pair] = False
            if required.met_by(kept):
                break
            kept[pair] = True
        else:
            return kept
    return kept


def _harary(required: Requirement, order: np.ndarray) -> np.ndarray:
    """Pairs of the Harary graph on the stimuli in a ring of that order; a chain for degree 1."""
    n, degree = required.n_stimuli, required.degree
    steps = np.arange(n)
    if degree == 1:
        joined = [(steps[:-1], steps[1:])]
    else:
        joined = [(steps, steps + apart) for apart in range(1, degree // 2 + 1)]
        if degree % 2:
            across = steps[: (n + 1) // 2]
            joined.append((across, across + n // 2))
    ends = np.hstack([np.stack(one) for one in joined]) % n
    a, b = np.sort(order[ends], axis=0)
    chosen = np.zeros(len(required.pairs[0]), dtype=bool)
    chosen[a * n - a * (a + 1) // 2 + b - a - 1] = True
    return chosen
