"""Dissimilarities of pairs, judged by one or more participants: the input of every scaling."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from glossspace.dataset import read_dissimilarities
from glossspace.errors import GlossError
from glossspace.user_table import read_user_table

__all__ = ["COLUMNS", "Dissimilarities", "from_table", "read_table"]

COLUMNS = ("participant_id", "stimulus_a", "stimulus_b", "dissimilarity")


@dataclass(frozen=True)
class Dissimilarities:
    """Dissimilarities of all pairs of `n` stimuli from `m` participants ("sources" in the language of MDS).

    Attributes
    ----------
    stimuli : tuple of str, length n
    participants : tuple of str, length m
    values : ndarray, shape (m, n (n - 1) / 2)
        The upper triangle row by row, one line a participant; NaN where a pair was not judged. Zero is data.
    """

    stimuli: tuple[str, ...]
    participants: tuple[str, ...]
    values: np.ndarray

    @property
    def pairs(self) -> tuple[np.ndarray, np.ndarray]:
        """First and second stimulus of each pair, as indices into `stimuli`."""
        return np.triu_indices(len(self.stimuli), 1)

    def of(self, participants: tuple[str, ...]) -> "Dissimilarities":
        """Return the judgements of some of the participants alone."""
        rows = [self.participants.index(name) for name in participants]
        return Dissimilarities(self.stimuli, participants, self.values[rows])


def from_table(table: pd.DataFrame, *, source: str = "the table") -> Dissimilarities:
    """Arrange a long table as condensed triangles.

    Parameters
    ----------
    table : DataFrame
        Columns `participant_id`, `stimulus_a`, `stimulus_b`, `dissimilarity`. A pair that was not judged is absent or
        NaN. (a, b) and (b, a) are repeats of one pair and enter by their mean; identical pairs (a, a) are left out,
        since a distance to oneself is 0 in every configuration.
    source : str
        What to call the table in an error message.

    Returns
    -------
    Dissimilarities
        Stimuli and participants in the order of their first appearance.

    Raises
    ------
    GlossError
        A column is missing, a value is negative, infinite or not a number, or fewer than three stimuli were judged.
    """
    missing = [column for column in COLUMNS if column not in table.columns]
    if missing:
        raise GlossError(
            f"{source} lacks the column {missing[0]!r}. Expected the columns {', '.join(COLUMNS)}; "
            f"found {', '.join(map(str, table.columns))}."
        )
    values = pd.to_numeric(table["dissimilarity"], errors="coerce")
    unreadable = values.isna() & table["dissimilarity"].notna() & (table["dissimilarity"].astype(str).str.strip() != "")
    impossible = unreadable | ((values < 0) | np.isinf(values))
    if impossible.any():
        row = int(np.argmax(impossible))
        raise GlossError(
            f"{source}, {_place(table, row)}: dissimilarity {table['dissimilarity'].iloc[row]!r} is not allowed. "
            "Allowed: a finite number >= 0, or an empty cell for a pair that was not judged."
        )
    labels = table[["participant_id", "stimulus_a", "stimulus_b"]]
    if labels.isna().any(axis=None):
        row = int(np.argmax(labels.isna().any(axis=1)))
        raise GlossError(f"{source}, {_place(table, row)}: a participant or stimulus has no name. Fill the cell.")

    tidy = labels.astype(str).assign(dissimilarity=values)
    participants = tuple(dict.fromkeys(tidy["participant_id"]))
    stimuli = tuple(dict.fromkeys(tidy[["stimulus_a", "stimulus_b"]].to_numpy().ravel()))
    n = len(stimuli)
    if n < 3:
        count = {0: "no stimuli", 1: "1 stimulus"}.get(n, f"{n} stimuli")
        raise GlossError(f"{source} holds {count}. Scaling needs at least 3.")
    first = tidy["stimulus_a"].map({name: index for index, name in enumerate(stimuli)}).to_numpy(dtype=int)
    second = tidy["stimulus_b"].map({name: index for index, name in enumerate(stimuli)}).to_numpy(dtype=int)
    low, high = np.minimum(first, second), np.maximum(first, second)
    judged = tidy.assign(pair=low * n - low * (low + 1) // 2 + high - low - 1)[low != high]
    means = judged.pivot_table(index="participant_id", columns="pair", values="dissimilarity", aggfunc="mean")
    condensed = means.reindex(index=list(participants), columns=range(n * (n - 1) // 2))
    return Dissimilarities(stimuli, participants, condensed.to_numpy(dtype=float))


def read_table(path: str | Path) -> Dissimilarities:
    """Read dissimilarities from a dataset folder or from a long CSV file of any other study.

    Raises
    ------
    GlossError
        The path does not exist, is not readable, or its content is wrong (see `from_table`).
    """
    path = Path(path)
    if path.is_dir():
        return from_table(read_dissimilarities(path), source=f"The dataset '{path}'")
    return from_table(read_user_table(path, what="dissimilarity table", columns=COLUMNS), source=f"'{path}'")


def _place(table: pd.DataFrame, row: int) -> str:
    return f"line {table.index[row]}" if table.index.name == "line" else f"row {row + 1}"
