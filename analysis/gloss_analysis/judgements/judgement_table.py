"""Tables of single judgements: a dataset, or a CSV file of any other study."""

from pathlib import Path

import numpy as np
import pandas as pd

from gloss_analysis.judgements.dissimilarity import COLUMNS, REPEATS, Dissimilarities, Repeats, Trials
from gloss_analysis.judgements.square_matrix import check_enough, from_square_table
from glossspace.dataset import read_dissimilarities
from glossspace.errors import GlossError
from glossspace.user_table import read_user_table

__all__ = ["from_table", "read_judgements", "read_table"]


def from_table(table: pd.DataFrame, *, source: str = "the table", repeats: Repeats = "weighted") -> Dissimilarities:
    """Arrange a long table as condensed triangles.

    Parameters
    ----------
    table : DataFrame
        Columns `participant_id`, `stimulus_a`, `stimulus_b`, `dissimilarity`. A pair that was not judged is absent or
        NaN. (a, b) and (b, a) are repeats of one pair; identical pairs (a, a) are left out, since a distance to oneself
        is 0 in every configuration (`reliability` uses both). An optional column `weight`, > 0, says how much each
        judgement counts.
    source : str
        What to call the table in an error message.
    repeats : {"weighted", "mean", "median"}
        How repeats of a pair enter: by their mean, weighted by their number; by their mean; by their median.

    Returns
    -------
    Dissimilarities
        Stimuli and participants in the order of their first appearance.

    Raises
    ------
    GlossError
        A column is missing, a value is negative, infinite or not a number, or fewer than three stimuli were judged.
    """
    if repeats not in REPEATS:
        raise GlossError(f"Invalid repeats = {repeats!r}. Allowed: {', '.join(map(repr, REPEATS))}.")
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
            f"{source}, {_place(table, row)}: dissimilarity {str(table['dissimilarity'].iloc[row])!r} is not allowed. "
            "Allowed: a finite number >= 0, or an empty cell for a pair that was not judged."
        )
    labels = table[["participant_id", "stimulus_a", "stimulus_b"]]
    if labels.isna().any(axis=None):
        row = int(np.argmax(labels.isna().any(axis=1)))
        raise GlossError(f"{source}, {_place(table, row)}: a participant or stimulus has no name. Fill the cell.")

    tidy = labels.astype(str).assign(dissimilarity=values)
    participants = tuple(dict.fromkeys(tidy["participant_id"]))
    stimuli = tuple(dict.fromkeys(tidy[["stimulus_a", "stimulus_b"]].to_numpy().ravel()))
    n, m = check_enough(stimuli, source), len(participants)
    place = {name: index for index, name in enumerate(stimuli)}
    first, second = (tidy[column].map(place).to_numpy(dtype=int) for column in ("stimulus_a", "stimulus_b"))
    low, high = np.minimum(first, second), np.maximum(first, second)
    counted = (low != high) & values.notna().to_numpy()
    trials = Trials(
        tidy["participant_id"].map({name: k for k, name in enumerate(participants)}).to_numpy(dtype=int)[counted],
        (low * n - low * (low + 1) // 2 + high - low - 1)[counted],
        values.to_numpy(dtype=float)[counted],
        _weights(table, source)[counted],
    )
    condensed, weights = trials.summarised(m, n * (n - 1) // 2, repeats)
    repeated = len(trials.value) > np.count_nonzero(~np.isnan(condensed))
    alike = len(np.unique(weights[weights > 0])) <= 1
    return Dissimilarities(
        stimuli, participants, condensed, None if alike else weights, trials=trials if repeated else None
    )


def read_table(path: str | Path, *, repeats: Repeats = "weighted") -> Dissimilarities:
    """Read dissimilarities from a dataset folder, a long CSV file of any other study, or a square matrix in a CSV file.

    A square matrix has the names of the stimuli in its first line and, if it wants, in its first column too; it is that
    of one participant. Empty cells were not judged; one triangle is enough.

    Raises
    ------
    GlossError
        The path does not exist, is not readable, or its content is wrong (see `from_table`).
    """
    return read_judgements(path, repeats=repeats)[0]


def read_judgements(path: str | Path, *, repeats: Repeats = "weighted") -> tuple[Dissimilarities, pd.DataFrame | None]:
    """Read dissimilarities as `read_table` does, and the table of single judgements; None of a matrix, which has none.

    The file is read once, so that it may be a pipe.
    """
    path = Path(path)
    if path.is_dir():
        table = read_dissimilarities(path)
        return from_table(table, source=f"The dataset '{path}'", repeats=repeats), table
    table = read_user_table(path, what="dissimilarity table", columns=(), nameless_first=True)
    if "" in table.columns or not set(COLUMNS) & set(table.columns):
        return from_square_table(table, f"'{path}'"), None
    return from_table(table, source=f"'{path}'", repeats=repeats), table


def _weights(table: pd.DataFrame, source: str) -> np.ndarray:
    if "weight" not in table.columns:
        return np.ones(len(table))
    weights = pd.to_numeric(table["weight"], errors="coerce").to_numpy(dtype=float)
    impossible = ~(np.isfinite(weights) & (weights > 0))
    if impossible.any():
        row = int(np.argmax(impossible))
        raise GlossError(
            f"{source}, {_place(table, row)}: weight {str(table['weight'].iloc[row])!r} is not allowed. Allowed: a "
            "finite number > 0; leave the cell of the dissimilarity empty for a judgement that should not count."
        )
    return weights


def _place(table: pd.DataFrame, row: int) -> str:
    return f"line {table.index[row]}" if table.index.name == "line" else f"row {row + 1}"
