"""Export to BIDS, the Brain Imaging Data Structure: behavioural data without recordings (``beh``).

Layout of an export::

    dataset_description.json                                       name, version of BIDS, where the data come from
    README.md                                                      what was judged, and by whom
    participants.tsv, .json                                        who took part: a person, or a simulated observer
    sub-01/ses-1/beh/sub-01_ses-1_task-pairwise_beh.tsv, .json     one table a session and task, and its columns
    stimuli/stimuli.tsv, .json                                     what the stimuli were

What a column means is said in the table's own JSON file, so that each session stands by itself. In the tables a value
that is not there is ``n/a``, and what the file's name tells (participant, session, task) is not repeated.
"""

import csv
import io
import shutil
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from glossspace.dataset.schema import DESCRIPTION_FILE, TaskKind, file_name_labels, property_value
from glossspace.dataset.stimuli import STIMULI_FILE, read_stimuli
from glossspace.dataset.table import DataFile
from glossspace.dataset.validate import checked_tables
from glossspace.errors import GlossError
from glossspace.files import check_folder_target, read_json, write_json, write_text

__all__ = ["BIDS_VERSION", "BidsExport", "TaskTexts", "export_bids"]

BIDS_VERSION = "1.10.0"

_IN_FILE_NAME = ("participant_id", "session", "task")
# BIDS has names of its own for some columns.
_BIDS_NAMES = {"response_time_s": "response_time"}
_KINDS: dict[TaskKind, str] = {
    "pairwise": "Two painted spheres side by side; their apparent difference in gloss is set on a slider, 0 to 100.",
    "magnitude": "One painted sphere; its apparent glossiness is set on a slider, 0 to 100.",
    "ranking": "A set of painted spheres is put in order round a reference.",
}
_LEVELS = {
    "observer": {"human": "A person answered.", "simulated": "A program computed the answers; no person took part."},
    "timed_out": {"yes": "The time limit passed before an answer.", "no": "The observer answered, or was not timed."},
}
_STIMULUS_COLUMNS = {
    "stimulus_id": "Name of the stimulus, as in the tables of the sessions.",
    "rho_d": "Diffuse reflectance of the paint.",
    "rho_s": "Specular reflectance of the paint.",
    "alpha": "Roughness of the paint, the parameter of Ward's lobe.",
}


@dataclass(frozen=True)
class TaskTexts:
    """What observers read in a task: the question of each trial, and the instructions before the first."""

    description: str
    instructions: str


@dataclass(frozen=True)
class BidsExport:
    """What was exported: the folder, its participants, and how many files it has."""

    folder: Path
    participants: tuple[str, ...]
    n_files: int
    bids_version: str = BIDS_VERSION


def export_bids(folder: str | Path, out: str | Path, *, texts: Mapping[str, TaskTexts] | None = None) -> BidsExport:
    """Write the data of a whole dataset as a BIDS dataset, whole or not at all.

    Parameters
    ----------
    folder
        The dataset. It is validated first; its pilots are left out.
    out
        Folder to make. It must not exist or be empty.
    texts
        What observers read, by the name of the task; it goes beside the columns of each session.

    Raises
    ------
    GlossError
        The dataset is not whole, two of its files would have one name, or `out` holds something or cannot be written
        to.

    Examples
    --------
    >>> export_bids("study/dataset", "study/bids").participants  # doctest: +SKIP
    ('01', '02')
    """
    folder, out = Path(folder), Path(out)
    tables = checked_tables(folder)
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise GlossError(f"Cannot export to '{out}': something is there already. Give a new folder.")
    check_folder_target(out)
    _refuse_shared_names(tables)
    try:
        out.absolute().parent.mkdir(parents=True, exist_ok=True)
        part = Path(tempfile.mkdtemp(dir=out.absolute().parent, prefix=f".{out.name}-", suffix=".part"))
    except OSError as error:
        raise GlossError(f"Cannot export to '{out}': {error.strerror or error}. Choose another place.") from None
    try:
        for table, kind in tables:
            _write_session(part, table, kind, (texts or {}).get(_labels(table)["task"]))
        observers = {row["participant_id"]: row["observer"] for table, _ in tables for _, row in table.rows}
        _write_participants(part, observers)
        if (folder / STIMULI_FILE).exists():
            _write_stimuli(part, folder)
        _write_description(part, folder)
        n_files = sum(path.is_file() for path in part.rglob("*"))
        part.chmod(0o755)  # mkdtemp makes folders that only their owner reads
        if out.exists():
            out.rmdir()
        part.replace(out)
    except BaseException:
        shutil.rmtree(part, ignore_errors=True)
        raise
    return BidsExport(out, tuple(sorted(observers)), n_files)


def _labels(table: DataFile) -> dict[str, str]:
    labels = file_name_labels(table.path.name)
    assert labels is not None  # its table was checked
    return labels


def _refuse_shared_names(tables: Iterable[tuple[DataFile, TaskKind]]) -> None:
    """Psych-DS allows further labels in a file's name, which an export leaves out."""
    named: dict[tuple[str, str, str], Path] = {}
    for table, _ in tables:
        labels = _labels(table)
        first = named.setdefault((labels["subject"], labels["session"], labels["task"]), table.path)
        if first != table.path:
            raise GlossError(
                f"Cannot export '{table.path}' beside '{first}': participant, session and task are the same, so the "
                "one would take the other's place. Give one of them another session, or make them one file."
            )


def _write_session(root: Path, table: DataFile, kind: TaskKind, texts: TaskTexts | None) -> None:
    labels = _labels(table)
    subject, session, task = f"sub-{labels['subject']}", f"ses-{labels['session']}", labels["task"]
    columns = [name for name in table.header if name not in _IN_FILE_NAME]
    stem = root / subject / session / "beh" / f"{subject}_{session}_task-{task}_beh"
    header = [_BIDS_NAMES.get(name, name) for name in columns]
    write_text(Path(f"{stem}.tsv"), _tsv(header, ([row[name] for name in columns] for _, row in table.rows)))
    read: dict[str, Any] = {} if texts is None else {"Instructions": texts.instructions.strip()}
    description = _KINDS[kind] if texts is None else f"{_KINDS[kind]} The question was: {texts.description.strip()}"
    sidecar = {"TaskName": task, "TaskDescription": description, **read}
    write_json(Path(f"{stem}.json"), sidecar | {_BIDS_NAMES.get(name, name): _column(name) for name in columns})


def _column(name: str) -> dict[str, Any]:
    described = property_value(name)
    # A value that is not there is an empty cell in Psych-DS, and n/a in BIDS.
    document: dict[str, Any] = {"Description": described["description"].replace("; empty ", "; n/a ")}
    for key, ours in (("Units", "unitText"), ("Minimum", "minValue"), ("Maximum", "maxValue")):
        if ours in described:
            document[key] = described[ours]
    return document | ({"Levels": _LEVELS[name]} if name in _LEVELS else {})


def _write_participants(root: Path, observers: Mapping[str, str]) -> None:
    rows = [[f"sub-{name}", kind] for name, kind in sorted(observers.items())]
    write_text(root / "participants.tsv", _tsv(["participant_id", "observer"], rows))
    columns = {
        "participant_id": {"Description": "Identifier of the participant."},
        "observer": {"Description": "Who answered.", "Levels": _LEVELS["observer"]},
    }
    write_json(root / "participants.json", columns)


def _write_stimuli(root: Path, folder: Path) -> None:
    rows = read_stimuli(folder).itertuples(index=False)
    write_text(root / "stimuli" / "stimuli.tsv", _tsv(list(_STIMULUS_COLUMNS), ([str(v) for v in row] for row in rows)))
    columns = {name: {"Description": meaning} for name, meaning in _STIMULUS_COLUMNS.items()}
    write_json(root / "stimuli" / "stimuli.json", columns)


def _write_description(root: Path, folder: Path) -> None:
    ours = read_json(folder / DESCRIPTION_FILE, what="dataset description")
    document: dict[str, Any] = {
        "Name": str(ours["name"]),
        "BIDSVersion": BIDS_VERSION,
        "DatasetType": "raw",
        "GeneratedBy": [{"Name": "glossspace", "Version": version("glossspace")}],
    }
    authors = _authors(ours.get("author", ours.get("creator")))
    if authors:
        document["Authors"] = authors
    for key, theirs in (("license", "License"), ("funding", "Funding"), ("citation", "HowToAcknowledge")):
        if isinstance(ours.get(key), str):
            document[theirs] = [ours[key]] if theirs == "Funding" else ours[key]
    write_json(root / "dataset_description.json", document)
    who = ours.get("measurementTechnique")
    paragraphs = [f"# {ours['name']}", str(ours["description"])]
    if isinstance(who, str) and who not in paragraphs[1]:
        paragraphs.append(who)
    paragraphs.append("Exported from a Psych-DS dataset by glossspace (`gloss dataset export-bids`).")
    write_text(root / "README.md", "\n\n".join(paragraphs) + "\n")


def _authors(given: Any) -> list[str]:
    """Names from what schema.org allows as an author: a name, a person, or a list of them."""
    people = given if isinstance(given, list) else [given]
    names = [one.get("name") if isinstance(one, dict) else one for one in people]
    return [name for name in names if isinstance(name, str) and name]


def _tsv(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    stream = io.StringIO()
    writer = csv.writer(stream, delimiter="\t", lineterminator="\n")
    writer.writerow(header)
    writer.writerows([value if value != "" else "n/a" for value in row] for row in rows)
    return stream.getvalue()
