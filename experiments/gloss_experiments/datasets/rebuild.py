"""The data files of a dataset made anew from its journals: the journals are the record, and data follow from them."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from gloss_experiments.datasets.journalled_session import JournalledSession, read_session
from glossspace.dataset import locked, record_simulated_observer, record_stimuli, update_description
from glossspace.dataset.schema import PILOTS_FOLDER
from glossspace.dataset.table import data_files
from glossspace.errors import GlossError
from glossspace.files import write_text

__all__ = ["RebuiltSession", "dataset_folders", "journal_files", "rebuild_dataset"]

Outcome = Literal["made", "same", "differs", "incomplete", "unreadable"]


@dataclass(frozen=True)
class RebuiltSession:
    """What became of one session's data file.

    Attributes
    ----------
    outcome
        ``"made"``: it was absent and is there now. ``"same"``: it was there, with just this content. ``"differs"``: it
        is there with other content and was left as it is. ``"incomplete"``: the session is not finished.
        ``"unreadable"``: its journal cannot be read, so that nothing of it was made.
    data
        Path of the data file; None where the journal is unreadable.
    n_answered, n_trials
        Trials answered, and trials of the session; those of practice included.
    problem
        Why the journal is unreadable; else None.
    """

    name: str
    journal: Path
    outcome: Outcome
    pilot: bool
    data: Path | None = None
    n_answered: int = 0
    n_trials: int = 0
    problem: str | None = None


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

    A data file that is there already is never changed: it is compared. The description is written anew, and stimuli and
    simulated observers that ``stimuli.csv`` and ``simulated_observers.json`` lack are noted. Journals of the first
    version do not tell what the stimuli were. A journal that cannot be read is told of, and the others go on.

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
        The folder has no journal, or one of the dataset's own files cannot be read or written.

    Examples
    --------
    >>> [session.outcome for session in rebuild_dataset("study")]  # doctest: +SKIP
    ['same', 'made', 'incomplete']
    """
    folders = dataset_folders(Path(folder))
    journals = [(place, path) for place in folders for path in journal_files(place)]
    if not journals:
        raise GlossError(f"'{folder}' holds no journal under 'journals', so nothing can be made from it.")
    rebuilt = []
    for i, (place, path) in enumerate(journals, start=1):
        try:
            session = read_session(path)
        except GlossError as error:
            pilot = place != folders[0]
            rebuilt.append(RebuiltSession(path.stem, path, "unreadable", pilot, problem=str(error)))
        else:
            rebuilt.append(_rebuilt(place, session))
        if on_session is not None:
            on_session(i, len(journals))
    for place in dict.fromkeys(place for place, _ in journals):
        if data_files(place):  # a dataset whose sessions are all unfinished has no description yet
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
    if session.paints:
        record_stimuli(folder, session.paints, source=str(session.journal))
    return RebuiltSession(
        name=session.name,
        journal=session.journal,
        data=path,
        outcome=outcome,
        n_answered=len(session.content.answers),
        n_trials=session.n_wanted,
        pilot=session.pilot,
    )
