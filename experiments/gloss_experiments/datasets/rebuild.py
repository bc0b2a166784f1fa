"""The data files of a dataset made anew from its journals: the journals are the record, and data follow from them."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

from pydantic import ValidationError

from gloss_experiments.protocol import Protocol
from gloss_experiments.session.journal_content import JournalContent, read_journal
from gloss_experiments.session.trial_rows import trial_rows
from glossspace.dataset import data_path, locked, record_simulated_observer, update_description
from glossspace.dataset.schema import PILOTS_FOLDER, checked_label
from glossspace.dataset.schema import PROCESS_COLUMNS as _LATER_COLUMNS
from glossspace.dataset.write import Row, session_csv
from glossspace.errors import GlossError
from glossspace.files import write_text

__all__ = ["JournalledSession", "RebuiltSession", "dataset_folders", "journal_files", "read_session", "rebuild_dataset"]

Outcome = Literal["made", "same", "differs", "incomplete"]

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
_LATER_HEADER = {"n_practice": int, "pilot": bool, "stimulus_sha256": dict}


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


@dataclass(frozen=True)
class RebuiltSession:
    """What became of one session's data file.

    Attributes
    ----------
    outcome
        ``"made"``: it was absent and is there now. ``"same"``: it was there, with just this content. ``"differs"``: it
        is there with other content and was left as it is. ``"incomplete"``: the session is not finished.
    n_answered, n_trials
        Trials answered, and trials of the session; those of practice included.
    """

    name: str
    journal: Path
    data: Path
    outcome: Outcome
    n_answered: int
    n_trials: int
    pilot: bool


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
    return JournalledSession(journal, content, content.header, protocol)


def journal_files(folder: Path) -> list[Path]:
    """The journals of a dataset, in a stable order."""
    return sorted((folder / "journals").glob("*.jsonl"))


def dataset_folders(folder: Path) -> list[Path]:
    """The dataset, and the one of its pilots where there are any.

    Raises
    ------
    GlossError
        There is no such folder.
    """
    if not folder.is_dir():
        raise GlossError(f"No dataset folder at '{folder}'. Check the path.")
    pilots = folder / PILOTS_FOLDER
    return [folder, pilots] if pilots.is_dir() else [folder]


def rebuild_dataset(
    folder: str | Path, *, on_session: Callable[[int, int], None] | None = None
) -> tuple[RebuiltSession, ...]:
    """Make the data files of a dataset anew from its complete journals, and bring its other files up to date.

    A data file that is there already is never changed: it is compared. The description is written anew, and simulated
    observers that ``simulated_observers.json`` lacks are noted. Nothing can tell what ``stimuli.csv`` held.

    Parameters
    ----------
    folder
        The dataset.
    on_session
        Called with the number of journals done and their total, after each.

    Returns
    -------
    tuple of RebuiltSession
        One a journal.

    Raises
    ------
    GlossError
        The folder has no journal, or one cannot be read; nothing is written then.

    Examples
    --------
    >>> [session.outcome for session in rebuild_dataset("study")]  # doctest: +SKIP
    ['same', 'made', 'incomplete']
    """
    folders = dataset_folders(Path(folder))
    sessions = [(place, read_session(path)) for place in folders for path in journal_files(place)]
    if not sessions:
        raise GlossError(f"'{folder}' holds no journal under 'journals', so nothing can be made from it.")
    rebuilt = []
    for i, (place, session) in enumerate(sessions, start=1):
        rebuilt.append(_rebuilt(place, session))
        if on_session is not None:
            on_session(i, len(sessions))
    for place in dict.fromkeys(place for place, _ in sessions):
        update_description(place)
    return tuple(rebuilt)


def _rebuilt(folder: Path, session: JournalledSession) -> RebuiltSession:
    path = session.data_path(folder)
    outcome: Outcome = "incomplete"
    if session.complete:
        with locked(folder / ".dataset.lock"):  # a session may be ending just now
            if path.exists():
                outcome = "same" if session.same_as(path.read_bytes()) else "differs"
            else:
                write_text(path, session.data_text())
                outcome = "made"
    if session.simulated:
        parameters = {name: value for name, value in session.header["observer"].items() if name != "kind"}
        record_simulated_observer(folder, session.participant, parameters)
    return RebuiltSession(
        name=session.name,
        journal=session.journal,
        data=path,
        outcome=outcome,
        n_answered=len(session.content.answers),
        n_trials=session.n_wanted,
        pilot=session.pilot,
    )
