"""Tables that users give as CSV files: read strictly, so that nothing in them is guessed or dropped in silence."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from glossspace.errors import GlossError

__all__ = ["read_user_table"]

_SPREADSHEET_HINT = "Save it as CSV with commas, in UTF-8."


def read_user_table(
    path: str | Path, *, what: str, columns: Sequence[str], nameless_first: bool = False
) -> pd.DataFrame:
    """Read a CSV file that has at least `columns`, in any order; `what` names the kind of table in error messages.

    Spaces round a cell and blank lines do not count, and a byte order mark is skipped. The first column may be
    `nameless_first`, as the row names of a matrix are.

    Returns
    -------
    DataFrame
        Text only, so that participant 01 remains 01, and a stimulus called NA is not a missing one; NaN where a cell is
        empty. The index, called "line", holds the number of each row's line.

    Raises
    ------
    GlossError
        The file is missing, unreadable, no CSV in UTF-8 with commas, or empty; a column is missing, nameless or there
        twice; or a row has another number of cells than the header.

    Examples
    --------
    >>> read_user_table("no-such.csv", what="stimulus table", columns=["stimulus"])
    Traceback (most recent call last):
    ...
    glossspace.errors.GlossError: No stimulus table at 'no-such.csv'. Check the path.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise GlossError(f"No {what} at '{path}'. Check the path.") from None
    except IsADirectoryError:
        raise GlossError(f"The {what} '{path}' is a folder. Give a CSV file.") from None
    except OSError as error:
        raise GlossError(f"Cannot read the {what} '{path}': {error.strerror or error}.") from None
    except UnicodeDecodeError:
        raise GlossError(f"The {what} '{path}' is not text in UTF-8. {_SPREADSHEET_HINT}") from None
    if "\0" in text:
        raise GlossError(f"The {what} '{path}' is no text file. {_SPREADSHEET_HINT}")
    return _framed(_lines(text, path, what), columns, f"The {what} '{path}'", nameless_first)


def _lines(text: str, path: Path, what: str) -> list[tuple[int, list[str]]]:
    reader = csv.reader(io.StringIO(text, newline=""), skipinitialspace=True, strict=True)
    try:
        return [(reader.line_num, [cell.strip() for cell in cells]) for cells in reader if any(map(str.strip, cells))]
    except csv.Error as error:
        raise GlossError(f"The {what} '{path}', line {reader.line_num}, is no CSV: {error}.") from None


def _framed(
    lines: list[tuple[int, list[str]]], columns: Sequence[str], table: str, nameless_first: bool
) -> pd.DataFrame:
    expected = ", ".join(columns)
    if not lines:
        raise GlossError(f"{table} is empty. Its first line must name the columns{expected and f' {expected}'}.")
    (_, header), *rows = lines
    missing = [column for column in columns if column not in header]
    if missing:
        hint = f" {_SPREADSHEET_HINT}" if len(header) == 1 else ""
        raise GlossError(f"{table} lacks the column {missing[0]!r}. Expected {expected}; found {_short(header)}.{hint}")
    if "" in header[1:] or (header[0] == "" and not nameless_first):
        raise GlossError(f"{table} has a column without a name, the {header.index('') + 1}. of {len(header)}. Name it.")
    repeated = [name for name in header if header.count(name) > 1]
    if repeated:
        raise GlossError(f"{table} has the column {repeated[0]!r} twice. Remove or rename one.")
    for line, cells in rows:
        if len(cells) != len(header):
            raise GlossError(f"{table}, line {line}: {len(cells)} cells, but the header names {len(header)} columns.")
    numbers = pd.Index([line for line, _ in rows], name="line")
    content = pd.DataFrame([cells for _, cells in rows], columns=header, index=numbers, dtype=str)
    return content.mask(content == "")


def _short(names: Sequence[str]) -> str:
    text = ", ".join(names)
    return text if len(text) <= 120 else text[:119] + "…"
