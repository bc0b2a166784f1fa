"""Dissimilarities of pairs, judged by one or more participants: the input of every scaling."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

__all__ = ["COLUMNS", "REPEATS", "Dissimilarities", "Repeats", "Trials"]

COLUMNS = ("participant_id", "stimulus_a", "stimulus_b", "dissimilarity")
"""Of a table of single judgements."""

Repeats: TypeAlias = Literal["weighted", "mean", "median"]
REPEATS: tuple[Repeats, ...] = ("weighted", "mean", "median")


@dataclass(frozen=True)
class Dissimilarities:
    """Dissimilarities of all pairs of `n` stimuli from `m` participants ("sources" in the language of MDS).

    Attributes
    ----------
    stimuli : tuple of str, length n
    participants : tuple of str, length m
    values : ndarray, shape (m, n (n - 1) / 2)
        The upper triangle row by row, one line a participant; NaN where a pair was not judged. Zero is data.
    pair_weights : ndarray, shape (m, n (n - 1) / 2), optional
        How much each judgement counts, >= 0; all alike by default. One of weight 0 counts as not judged.
    source_weights : ndarray, shape (m,), optional
        How much each participant counts in the mean over participants, >= 0; all alike by default.
    trials : Trials, optional
        The single judgements behind the values, where they are known.
    """

    stimuli: tuple[str, ...]
    participants: tuple[str, ...]
    values: np.ndarray
    pair_weights: np.ndarray | None = None
    source_weights: np.ndarray | None = None
    trials: "Trials | None" = None

    @property
    def pairs(self) -> tuple[np.ndarray, np.ndarray]:
        """First and second stimulus of each pair, as indices into `stimuli`."""
        return np.triu_indices(len(self.stimuli), 1)

    @property
    def weights(self) -> np.ndarray:
        """Weight of every judgement, shape (m, n (n - 1) / 2)."""
        return np.ones(self.values.shape) if self.pair_weights is None else self.pair_weights

    @property
    def source_weights_or_ones(self) -> np.ndarray:
        """Weight of every participant, shape (m,)."""
        return np.ones(len(self.participants)) if self.source_weights is None else self.source_weights

    @property
    def judged(self) -> np.ndarray:
        """Which judgements count, shape (m, n (n - 1) / 2)."""
        return ~np.isnan(self.values) & (self.weights > 0)

    def of(self, participants: Sequence[str]) -> "Dissimilarities":
        """Return the judgements of some of the participants alone, in the given order."""
        return self.take([self.participants.index(name) for name in participants])

    def take(self, rows: Sequence[int] | np.ndarray, names: Sequence[str] | None = None) -> "Dissimilarities":
        """Return the participants in the given rows, which may repeat; `names` tells repeated ones apart."""
        chosen = np.asarray(rows, dtype=int)
        return Dissimilarities(
            self.stimuli,
            tuple(names) if names is not None else tuple(self.participants[k] for k in chosen),
            self.values[chosen],
            None if self.pair_weights is None else self.pair_weights[chosen],
            None if self.source_weights is None else self.source_weights[chosen],
            None if self.trials is None else self.trials.of_sources(chosen),
        )


@dataclass(frozen=True)
class Trials:
    """Single judgements, of pairs that may have been judged several times.

    Attributes
    ----------
    source, pair : ndarray of int, shape (n_trials,)
        Which participant judged which condensed pair.
    value, weight : ndarray, shape (n_trials,)
        The dissimilarity, and how much it counts, > 0.
    """

    source: np.ndarray
    pair: np.ndarray
    value: np.ndarray
    weight: np.ndarray

    def of_sources(self, rows: np.ndarray) -> "Trials":
        """Return the trials of the participants in the given rows, which may repeat, renumbered."""
        chosen = [np.flatnonzero(self.source == k) for k in rows]
        source = np.repeat(np.arange(len(rows)), [len(one) for one in chosen])
        index = np.concatenate(chosen) if chosen else np.empty(0, dtype=int)
        return Trials(source, self.pair[index], self.value[index], self.weight[index])

    def summarised(self, n_sources: int, n_pairs: int, repeats: Repeats) -> tuple[np.ndarray, np.ndarray]:
        """Value and weight of every participant and pair, both of shape (n_sources, n_pairs).

        The value is the mean, weighted if trials are, or the median; NaN where there is no trial. The weight is the sum
        over trials ("weighted") or their mean ("mean", "median"); 0 where there is no trial.
        """
        n = n_sources * n_pairs
        cell = self.source * n_pairs + self.pair
        count = np.bincount(cell, minlength=n)
        total = np.bincount(cell, weights=self.weight, minlength=n)
        values = np.full(n, np.nan)
        seen = count > 0
        if repeats == "median":
            order = np.lexsort((self.value, cell))
            last, below = np.cumsum(count[seen]), (count[seen] - 1) // 2
            middle = np.column_stack([last - count[seen] + below, last - 1 - below])
            values[seen] = np.sum(self.value[order][middle] / 2, axis=1)
        else:
            # Divided before they are added, so that even the largest numbers do not overflow.
            share = self.value * (self.weight / total[cell])
            values[seen] = np.bincount(cell, weights=share, minlength=n)[seen]
        if repeats != "weighted":
            total = np.divide(total, count, out=np.zeros(n), where=seen)
        return values.reshape(n_sources, n_pairs), total.reshape(n_sources, n_pairs)
