"""Writing one finished session into the dataset: a new file, never an old one changed."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path

from glossspace.dataset.description import update_description
from glossspace.dataset.lock import locked
from glossspace.dataset.schema import COLUMNS, PILOT_COLUMN, PROCESS_COLUMNS, TaskKind, data_path
from glossspace.errors import GlossError
from glossspace.files import write_text

__all__ = ["Row", "session_csv", "write_session_data"]

Row = dict[str, str | int | float | None]


def write_session_data(
    folder: str | Path,
    rows: Sequence[Row],
    *,
    kind: TaskKind,
    participant: str,
    session: str,
    task: str,
    observer: str,
    pilot: bool = False,
) -> Path:
    """Write the data file of one session, and bring the dataset's description up to date.

    Parameters
    ----------
    folder
        The dataset; made if absent.
    rows
        One a trial: ``block``, ``trial``, ``repeat``, ``response_time_s`` (None if unknown), either
        ``stimulus_left``, ``stimulus_right``, ``dissimilarity`` or ``stimulus``, ``rating``, and those of
        `schema.PROCESS_COLUMNS` that are known. A ranking has one row a stimulus, with ``reference``, ``stimulus``,
        ``start_place`` and ``rank``. The other columns are filled in.
    kind
        ``"pairwise"``, ``"magnitude"`` or ``"ranking"``.
    participant, session, task
        Letters and digits.
    observer
        ``"human"`` or ``"simulated"``.
    pilot
        Whether it was a trial run; its rows then say so in a column of their own.

    Raises
    ------
    GlossError
        The data file exists already: data are never overwritten.
    """
    path = data_path(folder, participant=participant, session=session, task=task)
    with locked(Path(folder) / ".dataset.lock"):
        if path.exists():
            raise GlossError(
                f"The data file '{path}' exists and is never overwritten. Give the participant another session number."
            )
        content = session_csv(
            rows, kind=kind, participant=participant, session=session, task=task, observer=observer, pilot=pilot
        )
        write_text(path, content)
    update_description(folder)
    return path


def session_csv(
    rows: Sequence[Row],
    *,
    kind: TaskKind,
    participant: str,
    session: str,
    task: str,
    observer: str,
    pilot: bool = False,
) -> str:
    """Text of the data file that `write_session_data` writes; the parameters are the same.

    Examples
    --------
    >>> row = {"block": 1, "trial": 1, "repeat": 1, "stimulus": "a", "rating": 40, "response_time_s": None}
    >>> who = {"participant": "01", "session": "1", "task": "doi", "observer": "simulated"}
    >>> print(session_csv([row], kind="magnitude", **who).splitlines()[1])
    01-1-doi-0001,01,1,doi,1,1,1,a,40,,simulated
    """
    marked: Row = {PILOT_COLUMN: "yes"} if pilot else {}
    known = [name for name in PROCESS_COLUMNS if any(name in row for row in rows)]
    stream = io.StringIO()
    writer = csv.DictWriter(stream, (*COLUMNS[kind], *known, *marked), lineterminator="\n")
    writer.writeheader()
    for row in rows:
        place = f"-{row['start_place']:02d}" if kind == "ranking" else ""
        filled: Row = {
            "row_id": f"{participant}-{session}-{task}-{row['trial']:04d}{place}",
            "participant_id": participant,
            "session": session,
            "task": task,
            "observer": observer,
        }
        writer.writerow(filled | row | marked)
    return stream.getvalue()
