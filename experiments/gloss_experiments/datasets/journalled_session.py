"""A session as its journal tells it: what its data file must be follows from that alone."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from gloss_experiments.protocol import Protocol
from gloss_experiments.session.journal_content import JournalContent, read_journal
from gloss_experiments.session.trial_rows import trial_rows
from glossspace.dataset import data_path
from glossspace.dataset.schema import PROCESS_COLUMNS as _LATER_COLUMNS
from glossspace.dataset.schema import checked_label
from glossspace.dataset.write import Row, session_csv
from glossspace.errors import GlossError
from glossspace.stimulus_set import Stimulus

__all__ = ["JournalledSession", "read_session"]

_HEADER = {
    "participant": str,
    "session": str,
    "task": str,
    "seed": int,
    "n_trials": int,
    "observer": dict,
    "protocol": dict,
    "protocol_sha256": str,
}
# Journals of the first version lack these.
_LATER_HEADER = {"n_practice": int, "pilot": bool, "stimulus_sha256": dict, "paints": dict}


@dataclass(frozen=True)
class JournalledSession:
    """A session as its journal tells it: what the data file must be follows from this alone."""

    journal: Path
    content: JournalContent
    header: dict[str, Any]
    protocol: Protocol

    @property
    def participant(self) -> str:
        """Identifier of the participant."""
        return str(self.header["participant"])

    @property
    def session(self) -> str:
        """Session of the participant."""
        return str(self.header["session"])

    @property
    def task(self) -> str:
        """Name of the protocol."""
        return str(self.header["task"])

    @property
    def simulated(self) -> bool:
        """Whether a program answered."""
        return bool(self.header["observer"].get("kind") == "simulated")

    @property
    def pilot(self) -> bool:
        """Whether it was a trial run."""
        return bool(self.header.get("pilot", False))

    @property
    def n_wanted(self) -> int:
        """How many trials the session has, those of practice included."""
        return int(self.header["n_trials"]) + int(self.header.get("n_practice", 0))

    @property
    def complete(self) -> bool:
        """Whether all its trials are answered."""
        return len(self.content.answers) >= self.n_wanted

    @property
    def paints(self) -> tuple[Stimulus, ...]:
        """What its stimuli were; empty in journals that do not tell.

        Raises
        ------
        GlossError
            A paint cannot be.
        """
        return tuple(_paint_in(name, paint) for name, paint in self.header.get("paints", {}).items())

    @cached_property
    def name(self) -> str:
        """How a message names it."""
        return f"participant {self.participant}, session {self.session}, task {self.task}"

    def data_path(self, folder: Path) -> Path:
        """Where its data file stands in the dataset `folder`."""
        return data_path(folder, participant=self.participant, session=self.session, task=self.task)

    def data_text(self) -> str:
        """Text of its data file."""
        return self._text(trial_rows(self.content.answers, kind=self.protocol.kind, simulated=self.simulated))

    def same_as(self, content: bytes) -> bool:
        """Whether a data file is the one that its session wrote, by this version or by the first one."""
        rows = trial_rows(self.content.answers, kind=self.protocol.kind, simulated=self.simulated)
        # The first version knew nothing of how an answer came about, and its data files have no columns for it.
        first = [{name: value for name, value in row.items() if name not in _LATER_COLUMNS} for row in rows]
        return content in (self._text(rows).encode("utf-8"), self._text(first).encode("utf-8"))

    def _text(self, rows: list[Row]) -> str:
        return session_csv(
            rows,
            kind=self.protocol.kind,
            participant=self.participant,
            session=self.session,
            task=self.task,
            observer="simulated" if self.simulated else "human",
            pilot=self.pilot,
        )


def read_session(journal: Path) -> JournalledSession:
    """Read the journal of a session.

    Raises
    ------
    GlossError
        It cannot be read, or its header lacks something or holds a protocol that cannot be.
    """
    content = read_journal(journal)
    if content.header is None:
        raise GlossError(f"The journal '{journal}' has no header: the session never began. Remove it.")
    for key, kind in (_HEADER | _LATER_HEADER).items():
        if not isinstance(content.header.get(key), kind) and (key in _HEADER or key in content.header):
            raise GlossError(f"The header of the journal '{journal}' has no valid '{key}'. Restore it from a backup.")
    for key in ("participant", "session", "task"):
        checked_label(content.header[key], what=f"{key} in the header of '{journal}'")
    try:
        protocol = Protocol.model_validate(content.header["protocol"])
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(map(str, first["loc"]))
        raise GlossError(
            f"The protocol in the header of the journal '{journal}' cannot be read ({key}: {first['msg']}). "
            "Use the version that wrote it, or restore it from a backup."
        ) from None
    session = JournalledSession(journal, content, content.header, protocol)
    try:
        _check_shown(session)
    except GlossError as error:
        raise GlossError(f"The journal '{journal}' cannot be: {error} Restore it from a backup.") from None
    return session


def _check_shown(session: JournalledSession) -> None:
    """Whether the stimuli can be, and each trial shows as many as its kind does."""
    _ = session.paints
    kind = session.protocol.kind
    for answer in session.content.answers:
        trial, n = answer.trial, len(answer.trial.stimuli)
        if n < 3 if kind == "ranking" else n != (2 if kind == "pairwise" else 1):
            raise GlossError(f"{trial.role} trial {trial.number} shows {n} stimuli, which no {kind} trial does.")


def _paint_in(name: str, paint: Any) -> Stimulus:
    if not isinstance(paint, dict) or set(paint) != {"rho_d", "rho_s", "alpha"}:
        raise GlossError(f"the paint of '{name}' is {paint!r}, not rho_d, rho_s and alpha.")
    return Stimulus(name, **paint)
