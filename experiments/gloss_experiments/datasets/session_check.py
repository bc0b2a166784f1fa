"""One session of a dataset: its journal against the design of its protocol, its data file against its journal."""

from collections.abc import Iterator
from pathlib import Path

from gloss_experiments.datasets.journalled_session import JournalledSession
from gloss_experiments.design import session_trials
from gloss_experiments.session.journal import journal_path
from gloss_experiments.session.provenance import images_sha256
from glossspace.dataset.schema import PILOTS_FOLDER
from glossspace.dataset.table import parse_data_file, read_data_file
from glossspace.errors import GlossError

__all__ = ["place_problems", "session_problems", "session_remarks"]


def place_problems(folder: Path, session: JournalledSession, *, among_pilots: bool) -> Iterator[str]:
    """Whether the journal stands where it belongs in the dataset `folder`, and has the right name."""
    where = f"The journal '{session.journal}'"
    expected = journal_path(folder, participant=session.participant, session=session.session, task=session.task)
    if expected.name != session.journal.name:
        yield f"{where} is that of {session.name}; name it '{expected.name}', or restore it."
    if session.pilot and folder.resolve().name != PILOTS_FOLDER:
        yield f"{where} is a pilot; move it and its data file to '{folder / PILOTS_FOLDER}'."
    if among_pilots and not session.pilot:
        yield f"{where} is no pilot; move it and its data file to '{folder.parent}'."


def session_problems(folder: Path, session: JournalledSession) -> Iterator[str]:
    """What is wrong with the journal by itself, with the order of its trials, and with its data file."""
    where = f"The journal '{session.journal}'"
    header = session.header
    if session.protocol.sha256() != header["protocol_sha256"]:
        yield f"{where}: the protocol in its header has another hash than the session began with; restore it."
    hashes = header.get("stimulus_sha256")
    if hashes is not None and images_sha256(hashes) != header.get("stimuli_sha256"):
        yield f"{where}: the image hashes in its header are not those that the session began with; restore it."
    if hashes is not None:
        yield from _order_problems(session, list(hashes), where)
    yield from _data_problems(folder, session)


def _order_problems(session: JournalledSession, stimuli: list[str], where: str) -> Iterator[str]:
    """The design made anew from the seed, and what was judged against it."""
    answered = [answer.trial for answer in session.content.answers]
    try:
        wanted = session_trials(
            session.protocol,
            stimuli,
            seed=int(session.header["seed"]),
            participant=session.participant,
            session=session.session,
        )
    except GlossError as error:
        yield f"{where}: no design can be made from its header. {error}"
        return
    if session.n_wanted != len(wanted):
        yield f"{where} says {session.n_wanted} trials, but its protocol makes {len(wanted)}; restore it."
    if len(answered) > len(wanted):
        yield f"{where} has {len(answered)} trials, {len(answered) - len(wanted)} more than its protocol makes."
    pairs = list(zip(answered, wanted, strict=False))
    differing = next((i for i, (one, other) in enumerate(pairs) if one != other), None)
    if differing is not None:
        one, other = pairs[differing]
        found, expected = (" with ".join(trial.stimuli) for trial in (one, other))
        if found == expected:
            found, expected = (
                f"{shown} as {trial.role} trial {trial.number} of block {trial.block}, repeat {trial.repeat}"
                for shown, trial in ((found, one), (expected, other))
            )
        yield (
            f"{where}: trial {one.number} ({one.role}) shows {found}, but the order drawn from seed "
            f"{session.header['seed']} has {expected} there. If no line was changed by hand, another version drew it: "
            f"{_versions(session)}."
        )


def _versions(session: JournalledSession) -> str:
    versions = session.header.get("versions")
    return ", ".join(f"{name} {number}" for name, number in versions.items()) if isinstance(versions, dict) else "?"


def _data_problems(folder: Path, session: JournalledSession) -> Iterator[str]:
    path = session.data_path(folder)
    if not session.complete:
        if path.exists():
            yield (
                f"'{path}': its journal has {len(session.content.answers)} of {session.n_wanted} trials only; "
                "restore the journal, or move the data file out of 'data'."
            )
    elif not path.exists():
        yield (
            f"The session of {session.name} is complete, but there is no data file '{path}'; make it with "
            f"`gloss dataset rebuild '{folder}'`."
        )
    elif not session.same_as(path.read_bytes()):
        yield from _difference(path, session)


def _difference(path: Path, session: JournalledSession) -> Iterator[str]:
    """The first cell that differs. A lab may add columns and end lines as it likes."""
    try:
        found = read_data_file(path)
    except GlossError:
        return  # told already
    wanted = parse_data_file(path, session.data_text())
    if len(found.rows) != len(wanted.rows):
        yield f"'{path}' has {len(found.rows)} rows, but its journal makes {len(wanted.rows)}; restore it."
        return
    columns = [name for name in wanted.header if name in found.header]
    for (line, row), (_, right) in zip(found.rows, wanted.rows, strict=True):
        for name in columns:
            if row[name] != right[name]:
                yield (
                    f"'{path}', line {line}: {name} is '{row[name]}', but '{right[name]}' in the journal; restore the "
                    f"file: move it away, then `gloss dataset rebuild`."
                )
                return


def session_remarks(session: JournalledSession) -> Iterator[str]:
    """What is worth knowing of a session and no fault."""
    n_answered, n_wanted = len(session.content.answers), session.n_wanted
    if not session.complete:
        yield f"Not finished: {session.name}, {n_answered} of {n_wanted} trials; its `gloss session` goes on with it."
    if session.content.torn:
        yield f"The last line of '{session.journal}' is torn, as a kill leaves it; its trial does not count."
    timed_out = sum(answer.timed_out for answer in session.content.answers)
    if timed_out:
        yield f"{timed_out} of {n_wanted} trials timed out: {session.name}."
