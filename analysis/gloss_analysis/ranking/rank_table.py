"""Tables of rankings: who gave which stimulus which rank, read from a CSV file and checked."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from glossspace.errors import GlossError
from glossspace.user_table import read_user_table

__all__ = ["COLUMNS", "Rankings", "from_rank_table", "read_ranks"]

COLUMNS = ("participant_id", "stimulus", "rank")
"""That a table of ranks must have; `repeat` is optional."""


@dataclass(frozen=True)
class Rankings:
    """Rankings as they were written.

    Attributes
    ----------
    participants : tuple of str, length m
    stimuli : tuple of str, length n
        All that anybody ranked, in the order of the table.
    ranks : ndarray, shape (m, r, n)
        Of each participant and repeat; NaN where a stimulus was not ranked. Only their order within a row counts.
    """

    participants: tuple[str, ...]
    stimuli: tuple[str, ...]
    ranks: np.ndarray


def read_ranks(path: str | Path) -> Rankings:
    """Read rankings from a CSV file; see `from_rank_table`.

    Raises
    ------
    GlossError
        The file cannot be read (see `read_user_table`), or its content is wrong (see `from_rank_table`).

    Examples
    --------
    >>> read_ranks("no-such.csv")
    Traceback (most recent call last):
    ...
    glossspace.errors.GlossError: No rank table at 'no-such.csv'. Check the path.
    """
    return from_rank_table(read_user_table(path, what="rank table", columns=COLUMNS), source=f"'{path}'")


def from_rank_table(table: pd.DataFrame, *, source: str = "the table") -> Rankings:
    """Check rankings and arrange them.

    Parameters
    ----------
    table : DataFrame
        Columns `participant_id`, `stimulus`, `rank`. Equal ranks are ties, an empty rank is a stimulus that was not
        ranked. The optional column `repeat` tells several rankings of one participant apart.
    source : str
        What to call the table in an error message.

    Returns
    -------
    Rankings

    Raises
    ------
    GlossError
        A column is missing, a name or a repeat is empty, a rank is no finite number, a participant ranked a stimulus
        twice (in one repeat), or nothing was ranked.

    Examples
    --------
    >>> table = pd.DataFrame({"participant_id": "01", "stimulus": ["a", "b", "c"], "rank": [1, 2.5, 2.5]})
    >>> from_rank_table(table).ranks.tolist()
    [[[1.0, 2.5, 2.5]]]
    """
    missing = [column for column in COLUMNS if column not in table.columns]
    if missing:
        raise GlossError(f"{source} lacks the column {missing[0]!r}. Expected the columns {', '.join(COLUMNS)}.")
    keys = ["participant_id", *(["repeat"] if "repeat" in table.columns else []), "stimulus"]
    for column in keys:
        empty = table[column].isna().to_numpy()
        if empty.any():
            raise GlossError(f"{source}, {_place(table, empty)}: the {column} is empty. Fill the cell.")
    ranks = pd.to_numeric(table["rank"], errors="coerce").astype(float)
    written = table["rank"].notna() & (table["rank"].astype(str).str.strip() != "")
    wrong = (written & ~np.isfinite(ranks)).to_numpy()
    if wrong.any():
        raise GlossError(
            f"{source}, {_place(table, wrong)}: rank {str(table['rank'][wrong].iloc[0])!r} is not allowed. Allowed: a "
            "finite number, equal ones for ties, or an empty cell for a stimulus that was not ranked."
        )
    tidy = table[keys].astype(str).assign(rank=ranks.to_numpy())[ranks.notna().to_numpy()]
    again = tidy.duplicated(keys).to_numpy()
    if again.any():
        first = tidy[again].iloc[0]
        hint = "Remove one of the two" if "repeat" in keys else "Remove one, or add the column `repeat`"
        raise GlossError(
            f"{source}, {_place(tidy, again)}: participant {first['participant_id']} ranked {first['stimulus']!r} "
            f"already. {hint}."
        )
    if tidy.empty:
        raise GlossError(f"{source} holds no rank.")
    participants = tuple(dict.fromkeys(tidy["participant_id"]))
    stimuli = tuple(dict.fromkeys(tidy["stimulus"]))
    repeats = list(dict.fromkeys(tidy["repeat"])) if "repeat" in keys else [""]
    arranged = np.full((len(participants), len(repeats), len(stimuli)), np.nan)
    repeat = pd.Index(repeats).get_indexer(tidy["repeat"]) if "repeat" in keys else 0
    rows, columns = (
        pd.Index(names).get_indexer(tidy[key])
        for names, key in ((participants, "participant_id"), (stimuli, "stimulus"))
    )
    arranged[rows, repeat, columns] = tidy["rank"]
    return Rankings(participants, stimuli, arranged)


def _place(table: pd.DataFrame, rows: np.ndarray) -> str:
    """Where the first of the marked rows stands: its line in the file, or its number in a table from elsewhere."""
    row = int(np.argmax(rows))
    return f"line {table.index[row]}" if table.index.name == "line" else f"row {row + 1}"
