"""What stands in a journal, read without locking or changing the file."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import isfinite
from pathlib import Path
from typing import Any, get_args

from gloss_experiments.design import Role, Trial
from gloss_experiments.session.state import Answer, Trace, checked_order, checked_rating
from glossspace.errors import GlossError

__all__ = ["FORMAT", "VERSION", "JournalContent", "parse_journal", "read_journal"]

FORMAT = "gloss-journal"
# Version 1 had judged trials alone, and neither orders nor traces. Its journals are read, and resumed, as they are.
VERSION, READABLE = 2, (1, 2)


@dataclass
class JournalContent:
    """The lines of a journal.

    Attributes
    ----------
    header
        The first line; None where there is none yet.
    answers
        The trials answered so far, those of practice first.
    finished
        Whether the session is complete.
    torn
        Whether the last line was torn by a kill or a crash. It is not among the answers.
    n_whole_bytes
        Length of the file up to there.
    """

    header: dict[str, Any] | None = None
    answers: list[Answer] = field(default_factory=list)
    finished: bool = False
    torn: bool = False
    n_whole_bytes: int = 0


def read_journal(path: str | Path) -> JournalContent:
    """Read a journal, also one that another process is writing.

    Raises
    ------
    GlossError
        It cannot be opened, or a line cannot be read.
    """
    try:
        content = Path(path).read_bytes()
    except OSError as error:
        raise GlossError(f"Cannot read the journal '{path}': {error.strerror or error}. Check the path.") from None
    return parse_journal(content, path=path)


def parse_journal(content: bytes, *, path: str | Path) -> JournalContent:
    """The content of a journal; `path` names it in the error message.

    Raises
    ------
    GlossError
        A line cannot be read.
    """
    whole = content[: content.rfind(b"\n") + 1]
    read = JournalContent(torn=len(whole) < len(content), n_whole_bytes=len(whole))
    for number, text in enumerate(whole.splitlines(), start=1):
        try:
            _take(read, json.loads(text), number)
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise GlossError(
                f"'{path}', line {number} cannot be read ({type(error).__name__}: {error}). "
                "Restore the journal from a backup, or begin anew under another session number."
            ) from None
    return read


def _take(read: JournalContent, line: dict[str, Any], number: int) -> None:
    if number == 1:
        if line["format"] != FORMAT or line["version"] not in READABLE:
            raise ValueError(
                f"format {line['format']}, version {line['version']}; this version reads {FORMAT}, "
                f"{' and '.join(map(str, READABLE))}"
            )
        read.header = line
    elif line["type"] == "trial":
        trial = Trial(line["trial"], line["block"], line["repeat"], _stimuli_in(line), _role_in(line))
        # Practice trials have numbers of their own, and come first.
        before = sum((answer.trial.role == "practice") == (trial.role == "practice") for answer in read.answers)
        if trial.number != before + 1:
            raise ValueError(f"trial {trial.number} follows trial {before}")
        read.answers.append(_answer_in(line, trial))
    elif line["type"] == "finished":
        read.finished = True


def _stimuli_in(line: Mapping[str, Any]) -> tuple[str, ...]:
    stimuli = line["stimuli"]
    if not isinstance(stimuli, list) or not stimuli or not all(isinstance(name, str) for name in stimuli):
        raise ValueError(f"the stimuli {stimuli!r} are no list of names")
    return tuple(stimuli)


def _role_in(line: Mapping[str, Any]) -> Role:
    role: Role = line.get("role", "judged")
    if role not in get_args(Role):
        raise ValueError(f"the role '{role}' is none of {', '.join(get_args(Role))}")
    return role


def _answer_in(line: Mapping[str, Any], trial: Trial) -> Answer:
    order, trace, timed_out = line.get("order"), line.get("trace"), line.get("timed_out", False)
    if not isinstance(timed_out, bool):
        raise ValueError(f"timed_out {timed_out!r} is neither true nor false")
    without_rating = line["rating"] is None and (timed_out or order is not None)
    return Answer(
        trial,
        rating=None if without_rating else checked_rating(line["rating"]),
        response_time_s=_time_in(line),
        order=None if order is None else checked_order(order, trial),
        trace=None if trace is None else _trace_in(trace),
        timed_out=timed_out,
    )


def _time_in(line: Mapping[str, Any]) -> float | None:
    time_s: float | None = line["response_time_s"]
    if time_s is not None and not (_is_number(time_s) and time_s >= 0):
        raise ValueError(f"the response time {time_s!r} is no time from 0")
    return time_s


def _trace_in(values: Mapping[str, Any]) -> Trace:
    for name, value in values.items():
        if value is not None and not _is_number(value):
            raise ValueError(f"{name} {value!r} is no number")
    return Trace(**values)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)
