"""Whether a dataset is what its sessions made it: the data against the journals, and the journals against the design.

`glossspace.dataset.dataset_problems` knows the rules of a dataset by itself. This adds what only the journals tell:
orders are drawn anew from the seed in each header and compared, data files are made anew and compared, and images are
compared by their hashes.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from gloss_experiments.datasets.journalled_session import JournalledSession, read_session
from gloss_experiments.datasets.rebuild import dataset_folders, journal_files
from gloss_experiments.datasets.session_check import place_problems, session_problems, session_remarks
from gloss_experiments.session.journal import journal_path
from glossspace.dataset import data_path, dataset_problems, read_simulated_observers, read_stimuli
from glossspace.dataset.schema import file_name_labels
from glossspace.dataset.table import data_files, read_data_file
from glossspace.errors import GlossError
from glossspace.files import sha256_of
from glossspace.stimulus_set import StimulusSet

__all__ = ["DatasetCheck", "check_dataset"]


@dataclass(frozen=True)
class DatasetCheck:
    """What was found in a dataset.

    Attributes
    ----------
    problems
        What makes it broken, one line each.
    remarks
        What is worth knowing and no fault, such as a session that is not finished.
    n_data_files, n_journals, n_pilots
        How many there are; `n_pilots` counts the journals of trial runs, which are not among `n_journals`.
    """

    problems: tuple[str, ...]
    remarks: tuple[str, ...]
    n_data_files: int
    n_journals: int
    n_pilots: int


def check_dataset(
    folder: str | Path,
    *,
    stimuli: StimulusSet | None = None,
    on_journal: Callable[[int, int], None] | None = None,
) -> DatasetCheck:
    """Check a dataset and its pilots. Nothing is changed.

    Parameters
    ----------
    folder
        The dataset.
    stimuli
        The stimulus set that was shown: its images must have the hashes that the journals hold.
    on_journal
        Called with the number of journals checked and their total, after each.

    Raises
    ------
    GlossError
        There is no such folder.

    Examples
    --------
    >>> check_dataset("study").problems  # doctest: +SKIP
    ()
    """
    folders = dataset_folders(Path(folder))
    journals = {place: journal_files(place) for place in folders}
    n_journals, done = sum(map(len, journals.values())), 0
    problems: list[str] = []
    remarks: list[str] = []
    for place in folders:
        # Until a session is finished there is no description, and no data that could be wrong.
        if data_files(place) or not n_journals:
            problems += dataset_problems(place)
        sessions = []
        for path in journals[place]:
            try:
                session = read_session(path)
            except GlossError as error:
                problems.append(str(error))
            else:
                sessions.append(session)
                problems += place_problems(place, session, among_pilots=place != folders[0])
                problems += session_problems(place, session)
                remarks += session_remarks(session)
            done += 1
            if on_journal is not None:
                on_journal(done, n_journals)
        problems += _observer_problems(place, sessions)
        problems += _stimulus_problems(place, sessions)
        problems += _image_problems(sessions, stimuli)
        problems += _unjournalled_problems(place)
        remarks += _version_remarks(place, sessions)
        remarks += _count_remarks(place)
    if n_journals and not data_files(folders[0]):
        remarks.append(f"'{folder}' holds no data yet: none of its sessions is finished.")
    elif not journals[folders[0]]:
        remarks.append(f"'{folder}' holds no journals: its data were compared with no record of the sessions.")
    return DatasetCheck(
        problems=tuple(problems),
        remarks=tuple(remarks),
        n_data_files=len(data_files(folders[0])),
        n_journals=len(journals[folders[0]]),
        n_pilots=n_journals - len(journals[folders[0]]),
    )


def _version_remarks(folder: Path, sessions: list[JournalledSession]) -> Iterator[str]:
    n_first = sum("stimulus_sha256" not in session.header for session in sessions)
    if n_first:
        yield (
            f"{n_first} of {len(sessions)} journals of '{folder}' are of the first version, which did not note the "
            "images and their order: the orders of their trials were not drawn anew."
        )


def _observer_problems(folder: Path, sessions: list[JournalledSession]) -> Iterator[str]:
    try:
        known = read_simulated_observers(folder)
    except GlossError as error:
        yield str(error)
        return
    listed = set() if known is None else set(known["participant_id"])
    programs = {session.participant: session for session in sessions if session.simulated}
    people = {session.participant: session for session in sessions if not session.simulated}
    for name in sorted(set(programs) - listed):
        yield (
            f"Participant '{name}' is simulated ('{programs[name].journal}'), but simulated_observers.json lacks it; "
            f"`gloss dataset rebuild '{folder}'` notes it there."
        )
    for name in sorted(set(people) & (listed | set(programs))):
        yield f"Participant '{name}' is a person in '{people[name].journal}' and simulated elsewhere."


def _stimulus_problems(folder: Path, sessions: list[JournalledSession]) -> Iterator[str]:
    if not sessions:
        return
    try:
        known = set(read_stimuli(folder)["stimulus"])
    except GlossError as error:
        yield str(error)
        return
    shown = {name: s for s in sessions for answer in s.content.answers for name in answer.trial.stimuli}
    for name in sorted(set(shown) - known):
        yield f"'{shown[name].journal}' shows the stimulus '{name}', which stimuli.csv of '{folder}' lacks."


def _image_problems(sessions: list[JournalledSession], stimuli: StimulusSet | None) -> Iterator[str]:
    """A stimulus is one image: in all sessions, and in the set that is given."""
    first: dict[str, tuple[str, str]] = {}
    if stimuli is not None:
        for one in stimuli.stimuli:
            first[one.name] = (sha256_of(stimuli.image_path(one.name)), f"the stimulus set '{stimuli.folder}'")
    for session in sessions:
        for name, digest in session.header.get("stimulus_sha256", {}).items():
            known, where = first.setdefault(name, (digest, f"'{session.journal}'"))
            if digest != known:
                yield f"The image of '{name}' in '{session.journal}' is another than in {where} (SHA-256)."
                break  # a set that was rendered anew differs in each of its images


def _unjournalled_problems(folder: Path) -> Iterator[str]:
    if not (folder / "journals").is_dir():
        return
    for path in data_files(folder):
        labels = file_name_labels(path.name) or {}
        if {"subject", "session", "task"} <= set(labels):
            who = {"participant": labels["subject"], "session": labels["session"], "task": labels["task"]}
            journal = journal_path(folder, **who)
            if data_path(folder, **who) == path and not journal.exists():
                yield f"'{path}' has no journal; restore '{journal}', or move the data file out of 'data'."


def _count_remarks(folder: Path) -> Iterator[str]:
    """Sessions of one task that hold fewer rows than the others, and trials without an answer."""
    counts: dict[str, dict[Path, int]] = {}
    for path in data_files(folder):
        try:
            table = read_data_file(path)
        except GlossError:
            continue  # told already
        counts.setdefault((file_name_labels(path.name) or {}).get("task", ""), {})[path] = len(table.rows)
    for task, files in sorted(counts.items()):
        most = max(files.values())
        fewer = [f"{path.name} {n}" for path, n in files.items() if n < most]
        if fewer:
            yield f"Task {task}: the fullest file has {most} rows, others have fewer: {', '.join(fewer)}."
