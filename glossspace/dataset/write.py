"""Writing one finished session into the dataset: a new file, never an old one changed."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path

from glossspace.dataset.description import update_description
from glossspace.dataset.lock import locked
from glossspace.dataset.schema import COLUMNS, TaskKind, data_path
from glossspace.errors import GlossError
from glossspace.files import write_text

__all__ = ["Row", "write_session_data"]

Row = dict[str, str | int | float | None]


def write_session_data(
    folder: str | Path, rows: Sequence[Row], *, kind: TaskKind, participant: str, session: str, task: str, observer: str
) -> Path:
    """Write the data file of one session, and bring the dataset's description up to date.

    Parameters
    ----------
    folder
        The dataset; made if absent.
    rows
        One a trial: ``block``, ``trial``, ``repeat``, ``response_time_s`` (None if unknown), and either
        ``stimulus_left``, ``stimulus_right``, ``dissimilarity`` or ``stimulus``, ``rating``. The other columns are
        filled in.
    kind
        ``"pairwise"`` or ``"magnitude"``.
    participant, session, task
        Letters and digits.
    observer
        ``"human"`` or ``"simulated"``.

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
        write_text(path, _csv(rows, kind, (participant, session, task, observer)))
    update_description(folder)
    return path


def _csv(rows: Sequence[Row], kind: TaskKind, labels: tuple[str, str, str, str]) -> str:
    participant, session, task, observer = labels
    stream = io.StringIO()
    writer = csv.DictWriter(stream, COLUMNS[kind], lineterminator="\n")
    writer.writeheader()
    for row in rows:
        filled: Row = {
            "row_id": f"{participant}-{session}-{task}-{row['trial']:04d}",
            "participant_id": participant,
            "session": session,
            "task": task,
            "observer": observer,
        }
        writer.writerow(filled | row)
    return stream.getvalue()
