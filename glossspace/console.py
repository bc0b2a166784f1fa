"""What every sub-command shares: results on stdout, progress on stderr, and the ``--json`` flag."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated, Any

from cyclopts import Parameter
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

__all__ = ["JsonFlag", "note", "print_json", "progress_bar"]

JsonFlag = Annotated[bool, Parameter(name="--json", negative="", help="Print one JSON document and nothing else.")]


def print_json(document: Any) -> None:
    """Print `document` as the one JSON document on stdout. NaN and infinity become null."""
    print(json.dumps(_finite(document), indent=2, ensure_ascii=False, allow_nan=False))


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    if isinstance(value, float) and value - value != 0:
        return None
    return value


def note(message: str) -> None:
    """Print a remark for the person at the terminal: on stderr, so that stdout stays the result."""
    Console(stderr=True, highlight=False, soft_wrap=True).print(message, markup=False)


@contextmanager
def progress_bar() -> Iterator[Progress]:
    """Give a rich progress display on stderr. On anything but a terminal it prints its last state only."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True)) as progress:
        yield progress
