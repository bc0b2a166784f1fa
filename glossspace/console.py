"""What every sub-command shares: results on stdout, progress on stderr, and the ``--json`` flag."""

import json
import math
import sys
import threading
import unicodedata
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Annotated, Any

import numpy as np
import pandas as pd
from cyclopts import Parameter, Token
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table

__all__ = [
    "FiniteNumber",
    "JsonFlag",
    "NumberOfJobs",
    "ResultConsole",
    "Seed",
    "WholeNumber",
    "note",
    "noted_if_slow",
    "print_json",
    "print_table",
    "print_text",
    "printable",
    "progress_bar",
]


def _require_finite(_: object, value: float | None) -> None:
    if value is not None and not math.isfinite(value):
        raise ValueError("Must be a finite number.")


def _whole_number(_: object, tokens: Sequence[Token]) -> int:
    try:
        return int(tokens[0].value)
    except ValueError:
        raise ValueError(f"{tokens[0].value!r} is not a whole number.") from None


def _require_not_negative(_: object, value: int | None) -> None:
    if value is not None and value < 0:
        raise ValueError("Must be 0 or more.")


# In the library NaN is a missing value; whoever types it made a mistake.
FiniteNumber = Annotated[float, Parameter(validator=_require_finite)]
# Left alone, the parser would round 2.5 to 2 in silence.
WholeNumber = Annotated[int, Parameter(converter=_whole_number, n_tokens=1)]
Seed = Annotated[int, Parameter(converter=_whole_number, validator=_require_not_negative, n_tokens=1)]
# 0 stands for one process a core.
NumberOfJobs = Annotated[int, Parameter(converter=_whole_number, validator=_require_not_negative, n_tokens=1)]

JsonFlag = Annotated[
    bool,
    Parameter(name="--json", negative="", show_default=False, help="Print one JSON document and nothing else."),
]


class ResultConsole(Console):
    """Console of stdout that leaves a closed pipe to `glossspace.cli.main`; rich would end the program with code 1."""

    def on_broken_pipe(self) -> None:
        """Pass the exception on."""
        raise BrokenPipeError


# From then on, somebody who waits wants to know what for.
_NOTICED_S = 2.0
# Lines of a table that take more than a moment to set.
_LONG_TABLE = 5000
# A pipe or a file has no width: rich would squeeze the table into 80 columns and cut numbers.
_PIPE_WIDTH = 160


def print_json(document: Any) -> None:
    """Print `document` as the one JSON document on stdout. NaN and infinity become null."""
    # In ASCII, so that a pipe of any encoding carries it.
    print(json.dumps(_plain(document), indent=2, allow_nan=False))


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def print_table(rows: pd.DataFrame, *, title: str | None = None) -> None:
    """Print a data frame as a table on stdout: numbers to six significant digits, NaN as a dash."""
    if len(rows) > _LONG_TABLE:
        note(f"Setting a table of {len(rows):,} lines, which takes a while; --json does not.")
    columns = (printable(str(column)) for column in rows.columns)
    table = Table(*columns, title=None if title is None else printable(title), title_justify="left")
    for row in rows.itertuples(index=False):
        table.add_row(*(_cell(value) for value in row))
    # Without markup and emoji: names from files may hold brackets and colons.
    width = None if sys.stdout.isatty() else _PIPE_WIDTH
    ResultConsole(highlight=False, markup=False, emoji=False, width=width).print(table)


def _cell(value: Any) -> str:
    if isinstance(value, np.ndarray):
        value = value.item()
    if isinstance(value, bool | np.bool_):
        return "yes" if value else "no"
    if isinstance(value, float | np.floating):
        return "–" if np.isnan(value) else f"{value:.6g}"
    return printable(str(value))


def printable(text: str) -> str:
    """A text without the control characters by which a name from a file could command the terminal.

    Examples
    --------
    >>> printable("a\\x1b[2Jb")
    'a�[2Jb'
    """
    return "".join("�" if unicodedata.category(sign) == "Cc" and sign not in "\n\t" else sign for sign in text)


def print_text(*lines: str) -> None:
    """Print lines on stdout in which names from files stand."""
    print(printable("\n".join(lines)))


def note(message: str) -> None:
    """Print a remark for the person at the terminal: on stderr, so that stdout stays the result."""
    Console(stderr=True, highlight=False, soft_wrap=True, markup=False, emoji=False).print(printable(message))


@contextmanager
def noted_if_slow(message: str) -> Iterator[None]:
    """Print a remark on stderr once what is done inside takes two seconds: for work of which no part can be counted.

    Examples
    --------
    >>> with noted_if_slow("Fitting, which takes a while."):
    ...     pass
    """
    timer = threading.Timer(_NOTICED_S, note, [message])
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()


@contextmanager
def progress_bar() -> Iterator[Progress]:
    """Give a rich progress display on stderr. On anything but a terminal it prints its last state only.

    An error takes it away, so that one line is left: the one that says what was wrong.
    """
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    console = Console(stderr=True)
    with Progress(*columns, console=console) as progress:
        try:
            yield progress
        except BaseException:
            progress.live.transient = True
            console.quiet = not console.is_terminal  # where there is no bar to take away, none is left
            raise
