"""The words of the dataset: its columns, what they mean, and how its files are named (Psych-DS 1.5)."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from glossspace.errors import GlossError

__all__ = [
    "COLUMNS",
    "DESCRIPTION_FILE",
    "OBSERVER_KINDS",
    "PILOTS_FOLDER",
    "PILOT_COLUMN",
    "PROCESS_COLUMNS",
    "RATING_COLUMN",
    "RATING_MAX",
    "RATING_MIN",
    "TaskKind",
    "checked_label",
    "data_path",
    "file_name_labels",
    "property_value",
]

TaskKind = Literal["pairwise", "magnitude", "ranking"]

DESCRIPTION_FILE = "dataset_description.json"
OBSERVER_KINDS = ("human", "simulated")
# A dataset of its own inside the study's: no analysis of the study comes across it.
PILOTS_FOLDER = "pilots"
RATING_MIN, RATING_MAX = 0, 100


@dataclass(frozen=True)
class Variable:
    """One column: its name, its meaning, and its unit and limits where it has them."""

    name: str
    description: str
    unit: str | None = None
    minimum: float | None = None
    maximum: float | None = None


_COMMON = (
    Variable("row_id", "Identifier of the row, unique in the whole dataset."),
    Variable("participant_id", "Identifier of the participant, a string: leading zeros count."),
    Variable("session", "Session of the participant."),
    Variable("task", "Name of the protocol that the session followed."),
    Variable("block", "Block of the design, from 1.", minimum=1),
    Variable(
        "trial",
        "Place of the trial in the order shown in the session, from 1; catch trials, which are no data, count too.",
        minimum=1,
    ),
    Variable("repeat", "Which showing of this pair or stimulus in the design it is, from 1.", minimum=1),
)
_PAIRWISE = (
    Variable("stimulus_left", "Stimulus shown on the left."),
    Variable("stimulus_right", "Stimulus shown on the right."),
    Variable(
        "dissimilarity",
        "Apparent difference in gloss of the pair on the slider, an integer; empty where it was not judged.",
        minimum=RATING_MIN,
        maximum=RATING_MAX,
    ),
)
_MAGNITUDE = (
    Variable("stimulus", "Stimulus shown."),
    Variable(
        "rating",
        "Apparent glossiness of the stimulus on the slider, an integer; empty where it was not judged.",
        minimum=RATING_MIN,
        maximum=RATING_MAX,
    ),
)
_RANKING = (
    Variable("reference", "Stimulus that the set was ranked round."),
    Variable("stimulus", "Stimulus shown."),
    Variable(
        "start_place", "Place of the stimulus in the random order at the start of the ranking, from 1.", minimum=1
    ),
    Variable(
        "rank",
        "Rank of the stimulus, from 1 at the end labelled low; empty where the ranking was not finished.",
        minimum=1,
    ),
)
_LAST = (
    Variable("response_time_s", "Time from the stimulus to the confirmed answer; empty for simulated observers.", "s"),
    Variable("observer", "'human', or 'simulated' for answers that a program computed and no person gave."),
)

# How an answer came about. Datasets of the first version lack them, and no analysis needs them.
_PROCESS = (
    Variable("timed_out", "'yes' where the time limit passed before an answer was confirmed, else 'no'."),
    Variable("first_response_s", "Time from the stimulus to the first response; empty for simulated observers.", "s"),
    Variable(
        "n_changes",
        "How often the slider came to rest at another value, or a stimulus at another rank, the first time included; "
        "empty for simulated observers.",
        minimum=0,
    ),
    Variable("n_reversals", "How often the slider changed its direction; empty for simulated observers.", minimum=0),
    Variable("dropped_frames", "Frames of the trial that came late; empty where no real display was used.", minimum=0),
)
_PILOT = Variable("pilot", "'yes' in every row of a pilot: a trial run, which is no data of the study.")

_VARIABLES = {
    variable.name: variable for variable in (*_COMMON, *_PAIRWISE, *_RANKING, *_MAGNITUDE, *_LAST, *_PROCESS, _PILOT)
}

COLUMNS: dict[TaskKind, tuple[str, ...]] = {
    "pairwise": tuple(variable.name for variable in (*_COMMON, *_PAIRWISE, *_LAST)),
    "magnitude": tuple(variable.name for variable in (*_COMMON, *_MAGNITUDE, *_LAST)),
    "ranking": tuple(variable.name for variable in (*_COMMON, *_RANKING, *_LAST)),
}
PROCESS_COLUMNS = tuple(variable.name for variable in _PROCESS)
PILOT_COLUMN = _PILOT.name
RATING_COLUMN: dict[TaskKind, str] = {"pairwise": "dissimilarity", "magnitude": "rating", "ranking": "rank"}


def property_value(name: str) -> dict[str, Any]:
    """The schema.org ``PropertyValue`` that describes column `name` in ``variableMeasured``."""
    variable = _VARIABLES.get(name, Variable(name, "Not described."))
    document: dict[str, Any] = {"@type": "PropertyValue", "name": name, "description": variable.description}
    if variable.unit is not None:
        document["unitText"] = variable.unit
    if variable.minimum is not None:
        document["minValue"] = variable.minimum
    if variable.maximum is not None:
        document["maxValue"] = variable.maximum
    return document


# Three such labels and their keywords must fit into a file name of 255 bytes.
_LABEL = re.compile(r"[a-zA-Z0-9]{1,60}")
_FILE_NAME = re.compile(r"([a-z]+-[a-zA-Z0-9]+)(_[a-z]+-[a-zA-Z0-9]+)*_data\.(csv|tsv)")


def checked_label(value: object, *, what: str) -> str:
    """Return `value` as a string that may stand in a Psych-DS file name.

    Raises
    ------
    GlossError
        It holds anything but the letters a–z, A–Z and digits, or more than 60 of them.
    """
    label = str(value)
    if not _LABEL.fullmatch(label):
        raise GlossError(
            f"The {what} '{label}' cannot stand in a file name of the dataset: "
            "use letters a-z, A-Z and digits only, such as '01', and at most 60 of them."
        )
    return label


def file_name_labels(name: str) -> dict[str, str] | None:
    """The ``keyword: value`` parts of a data file's name, or None where the name breaks the rule of Psych-DS.

    Examples
    --------
    >>> file_name_labels("subject-01_session-1_task-pairwise_data.csv")
    {'subject': '01', 'session': '1', 'task': 'pairwise'}
    >>> file_name_labels("results.csv") is None
    True
    """
    if not _FILE_NAME.fullmatch(name):
        return None
    parts = name.rpartition("_data.")[0].split("_")
    return dict(part.split("-", 1) for part in parts)


def data_path(folder: str | Path, *, participant: str, session: str, task: str) -> Path:
    """Path of the data file of one session of one participant in one task.

    Examples
    --------
    >>> data_path("study", participant="01", session="1", task="pairwise").as_posix()
    'study/data/subject-01/subject-01_session-1_task-pairwise_data.csv'
    """
    participant = checked_label(participant, what="participant")
    name = (
        f"subject-{participant}_session-{checked_label(session, what='session')}"
        f"_task-{checked_label(task, what='task')}_data.csv"
    )
    return Path(folder) / "data" / f"subject-{participant}" / name
