"""The rules of BIDS for behavioural data without recordings, and the standard's own validator.

Rules are from the specification, version 1.10 ("Behavioral experiments (with no neural recordings)", "Tabular files",
"Participants file") and its machine-readable schema (rules/files/raw/beh.yaml: ``sub-<label>[_ses-<label>]_task-<label>
_beh.tsv`` and ``.json`` in the folder ``beh``).
"""

import csv
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from glossspace.dataset import update_description, write_session_data
from glossspace.dataset.bids import TaskTexts, export_bids
from glossspace.errors import GlossError
from glossspace.files import write_text

NAME = re.compile(
    r"sub-(?P<s>[0-9a-zA-Z]+)/ses-(?P<e>[0-9a-zA-Z]+)/beh/sub-(?P=s)_ses-(?P=e)_task-[0-9a-zA-Z]+_beh\.(tsv|json)"
)
TEXTS = {"pairwise": TaskTexts(description="How different?", instructions="Look at both.\n")}


def write(folder, rows, *, kind, participant="01", session="1", task, observer="human", pilot=False):
    common = {"block": 1, "repeat": 1}
    numbered = [common | {"trial": i} | row for i, row in enumerate(rows, start=1)]
    who = {"participant": participant, "session": session, "task": task, "observer": observer}
    return write_session_data(folder, numbered, kind=kind, pilot=pilot, **who)


@pytest.fixture
def study(tmp_path):
    """Pairs of a person on two days, and ratings of a program; one trial has no answer, and a pilot stands apart."""
    folder = tmp_path / "study"
    pairs = [
        {"stimulus_left": "b", "stimulus_right": "a", "dissimilarity": 40, "response_time_s": 1.25, "timed_out": "no"},
        {"stimulus_left": "a", "stimulus_right": "a", "dissimilarity": None, "response_time_s": 9, "timed_out": "yes"},
    ]
    write(folder, pairs, kind="pairwise", task="pairwise")
    write(folder, pairs[:1], kind="pairwise", task="pairwise", session="2")
    rated = [{"stimulus": "a", "rating": 7, "response_time_s": None}]
    write(folder, rated, kind="magnitude", task="doi", participant="x2", observer="simulated")
    write(folder / "pilots", rated, kind="magnitude", task="doi", participant="p9", pilot=True)
    write_text(folder / "stimuli.csv", "stimulus,rho_d,rho_s,alpha\na,0.03,0.033,0.04\nb,0.193,0.066,0.07\n")
    return folder


def table(path):
    with path.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream, delimiter="\t"))


def files_of(folder):
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())


def test_files_are_named_by_the_rules(study, tmp_path):
    exported = export_bids(study, tmp_path / "bids", texts=TEXTS)
    assert exported.participants == ("01", "x2")
    files = files_of(tmp_path / "bids")
    assert len(files) == exported.n_files
    top = [
        *("README.md", "dataset_description.json", "participants.json", "participants.tsv"),
        *("stimuli/stimuli.json", "stimuli/stimuli.tsv"),
    ]
    assert [name for name in files if not NAME.fullmatch(name)] == top
    tables = [name for name in files if name.endswith("_beh.tsv")]
    assert tables == [
        "sub-01/ses-1/beh/sub-01_ses-1_task-pairwise_beh.tsv",
        "sub-01/ses-2/beh/sub-01_ses-2_task-pairwise_beh.tsv",
        "sub-x2/ses-1/beh/sub-x2_ses-1_task-doi_beh.tsv",
    ]
    assert all(name.replace(".tsv", ".json") in files for name in tables)


def test_the_description_has_what_is_required(study, tmp_path):
    path = study / "dataset_description.json"
    document = json.loads(path.read_text("utf-8"))
    people = [{"@type": "Person", "name": "A. Observer"}, "B. Writer"]
    path.write_text(json.dumps(document | {"name": "Our gloss", "author": people, "license": "CC0"}), "utf-8")
    export_bids(study, tmp_path / "bids")
    made = json.loads((tmp_path / "bids" / "dataset_description.json").read_text("utf-8"))
    assert (made["Name"], made["BIDSVersion"], made["DatasetType"]) == ("Our gloss", "1.10.0", "raw")
    assert (made["Authors"], made["License"]) == (["A. Observer", "B. Writer"], "CC0")
    assert made["GeneratedBy"][0]["Name"] == "glossspace"
    assert "no person took part): participants x2." in (tmp_path / "bids" / "README.md").read_text("utf-8")


def test_participants_are_those_of_the_folders(study, tmp_path):
    """The first column is participant_id, its values are the names of the folders (PARTICIPANT_ID_MISMATCH)."""
    export_bids(study, tmp_path / "bids")
    rows = table(tmp_path / "bids" / "participants.tsv")
    assert [list(row.items()) for row in rows] == [
        [("participant_id", "sub-01"), ("observer", "human")],
        [("participant_id", "sub-x2"), ("observer", "simulated")],
    ]
    assert [row["participant_id"] for row in rows] == sorted(path.name for path in (tmp_path / "bids").glob("sub-*"))


def test_tables_hold_the_data_and_their_columns_are_described(study, tmp_path):
    export_bids(study, tmp_path / "bids", texts=TEXTS)
    path = tmp_path / "bids" / "sub-01" / "ses-1" / "beh" / "sub-01_ses-1_task-pairwise_beh.tsv"
    content = path.read_bytes()
    assert not content.startswith(b"\xef\xbb\xbf")
    assert b"\r" not in content
    first, second = table(path)
    assert (first["stimulus_left"], first["stimulus_right"], first["dissimilarity"]) == ("b", "a", "40")
    assert (second["dissimilarity"], second["timed_out"]) == ("n/a", "yes")
    assert first["response_time"] == "1.25", "seconds, under the name that BIDS defines"
    assert not {"participant_id", "session", "task"} & set(first), "the file's name says so"
    sidecar = json.loads(path.with_suffix(".json").read_text("utf-8"))
    assert set(first) <= set(sidecar)
    assert all(sidecar[name]["Description"] for name in first)
    assert sidecar["response_time"]["Units"] == "s"
    assert (sidecar["dissimilarity"]["Minimum"], sidecar["dissimilarity"]["Maximum"]) == (0, 100)
    assert "n/a where it was not judged" in sidecar["dissimilarity"]["Description"]
    assert set(sidecar["timed_out"]["Levels"]) == {"yes", "no"}
    assert (sidecar["TaskName"], sidecar["Instructions"]) == ("pairwise", "Look at both.")
    assert sidecar["TaskDescription"].endswith("The question was: How different?")


def test_stimuli(study, tmp_path):
    export_bids(study, tmp_path / "bids")
    rows = table(tmp_path / "bids" / "stimuli" / "stimuli.tsv")
    assert rows[1] == {"stimulus_id": "b", "rho_d": "0.193", "rho_s": "0.066", "alpha": "0.07"}
    described = json.loads((tmp_path / "bids" / "stimuli" / "stimuli.json").read_text("utf-8"))
    assert set(described) == set(rows[0])


def test_pilots_stay_behind(study, tmp_path):
    export_bids(study, tmp_path / "bids")
    assert not [name for name in files_of(tmp_path / "bids") if "p9" in name]


def test_an_empty_folder_may_be_given_and_a_full_one_not(study, tmp_path):
    (tmp_path / "bids").mkdir()
    export_bids(study, tmp_path / "bids")
    before = files_of(tmp_path / "bids")
    with pytest.raises(GlossError, match="something is there already. Give a new folder"):
        export_bids(study, tmp_path / "bids")
    assert files_of(tmp_path / "bids") == before
    (tmp_path / "file").write_text("a note")
    for out in (tmp_path / "file", tmp_path / "file" / "bids"):
        with pytest.raises(GlossError, match="Cannot (export to|write) "):
            export_bids(study, out)


def test_whole_or_not_at_all(study, tmp_path, monkeypatch):
    def full(*_):
        raise GlossError("Cannot write: No space left on device.")

    monkeypatch.setattr("glossspace.dataset.bids._write_participants", full)
    with pytest.raises(GlossError, match="No space left"):
        export_bids(study, tmp_path / "bids")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["study"]


def test_a_broken_dataset_is_not_exported(study, tmp_path):
    (study / "data" / "notes.csv").write_text("a\n1\n")
    update_description(study)
    with pytest.raises(GlossError, match="is not named as a data file"):
        export_bids(study, tmp_path / "bids")
    assert not (tmp_path / "bids").exists()


def test_the_validator_of_the_standard_finds_no_error(study, tmp_path):
    export_bids(study, tmp_path / "bids", texts=TEXTS)
    validator = Path(sys.executable).with_name("bids-validator-deno")
    command = [str(validator), str(tmp_path / "bids"), "--format", "json", "--max-rows=-1"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    issues = json.loads(done.stdout)["issues"]["issues"]
    assert [issue for issue in issues if issue["severity"] == "error"] == []
    # What is only recommended and cannot be known: institution, ontology terms, license, authors.
    missing = {"SIDECAR_KEY_RECOMMENDED", "JSON_KEY_RECOMMENDED", "NO_AUTHORS", "TOO_FEW_AUTHORS"}
    assert {issue["code"] for issue in issues} <= missing


def test_two_files_of_one_session_do_not_take_each_others_place(study, tmp_path):
    """Psych-DS allows more labels in a name, such as the run; both files are data, and an export holds one a task."""
    first = study / "data" / "subject-01" / "subject-01_session-1_task-pairwise_data.csv"
    second = first.with_name("subject-01_session-1_task-pairwise_run-2_data.csv")
    changed = first.read_text(encoding="utf-8").replace("pairwise-000", "pairwise-100")
    rows = [line.split(",") for line in changed.splitlines()]
    repeat = rows[0].index("repeat")
    again = [rows[0], *([*row[:repeat], "2", *row[repeat + 1 :]] for row in rows[1:])]
    second.write_text("".join(",".join(row) + "\n" for row in again), encoding="utf-8")
    with pytest.raises(GlossError, match=r"run-2_data\.csv' beside '.*task-pairwise_data\.csv'"):
        export_bids(study, tmp_path / "bids")
    assert not (tmp_path / "bids").exists()


def test_no_column_is_lost(study, tmp_path):
    export_bids(study, tmp_path / "bids")
    ours = study / "data" / "subject-01" / "subject-01_session-1_task-pairwise_data.csv"
    theirs = tmp_path / "bids" / "sub-01" / "ses-1" / "beh" / "sub-01_ses-1_task-pairwise_beh.tsv"
    columns = ours.read_text(encoding="utf-8").splitlines()[0].replace("response_time_s", "response_time").split(",")
    kept = [name for name in columns if name not in ("participant_id", "session", "task")]
    assert theirs.read_text(encoding="utf-8").splitlines()[0].split("\t") == kept
