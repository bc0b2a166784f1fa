import csv
import json
import multiprocessing

import numpy as np
import pytest

from glossspace.dataset import (
    data_path,
    dataset_problems,
    locked,
    read_dissimilarities,
    read_magnitudes,
    read_simulated_observers,
    read_stimuli,
    record_simulated_observer,
    record_stimuli,
    tasks_of,
    update_description,
    validate_dataset,
    write_session_data,
)
from glossspace.dataset.schema import file_name_labels
from glossspace.errors import GlossError
from glossspace.stimulus_set import Stimulus

PAIRS = [("b", "a", 40), ("a", "a", 0), ("b", "b", 3)]
PARAMETERS = {"weight_c": 1.0, "weight_d": 1.7, "exponent": 0.8, "noise_sd": 4.0, "ratio": 1.7}


def write_pairs(folder, *, participant="01", session="1", pairs=PAIRS, observer="simulated"):
    rows = [
        {
            "block": 1,
            "trial": i,
            "repeat": 1,
            "stimulus_left": left,
            "stimulus_right": right,
            "dissimilarity": rating,
            "response_time_s": None,
        }
        for i, (left, right, rating) in enumerate(pairs, start=1)
    ]
    who = {"participant": participant, "session": session, "task": "pairwise"}
    return write_session_data(folder, rows, kind="pairwise", observer=observer, **who)


def write_ratings(folder, *, participant="01", session="1", task="doi", ratings=((1, "a", 20), (2, "a", 24))):
    rows = [
        {"block": repeat, "trial": i, "repeat": repeat, "stimulus": name, "rating": rating, "response_time_s": 1.25}
        for i, (repeat, name, rating) in enumerate(ratings, start=1)
    ]
    who = {"participant": participant, "session": session, "task": task}
    return write_session_data(folder, rows, kind="magnitude", observer="simulated", **who)


@pytest.fixture
def study(tmp_path):
    """A whole dataset of one simulated participant in two tasks."""
    write_pairs(tmp_path)
    write_ratings(tmp_path)
    return tmp_path


def pairwise_file(study):
    return data_path(study, participant="01", session="1", task="pairwise")


def edit(path, old, new):
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")


def description(study):
    return json.loads((study / "dataset_description.json").read_text(encoding="utf-8"))


def test_the_folder_keeps_the_rules_of_psych_ds(study):
    """Psych-DS 1.5: file names, variableMeasured equal to the union of headers, row_id unique, UTF-8 without a mark."""
    headers, row_ids = set(), []
    for path in sorted((study / "data").rglob("*.csv")):
        content = path.read_bytes()
        assert not content.startswith(b"\xef\xbb\xbf")
        with path.open(encoding="utf-8", newline="") as stream:
            rows = list(csv.DictReader(stream))
        headers |= set(rows[0])
        row_ids += [row["row_id"] for row in rows]
    assert sorted(path.name for path in (study / "data").rglob("*.csv")) == [
        "subject-01_session-1_task-doi_data.csv",
        "subject-01_session-1_task-pairwise_data.csv",
    ]
    document = description(study)
    assert document["@context"] == "https://schema.org/"
    assert document["@type"] == "Dataset"
    assert document["name"]
    assert {variable["name"] for variable in document["variableMeasured"]} == headers
    assert all(variable["description"] for variable in document["variableMeasured"])
    assert len(set(row_ids)) == len(row_ids) == 5
    validate_dataset(study)


@pytest.mark.parametrize(
    "name",
    [
        "data.csv",
        "subject-01_data.txt",
        "subject-0_1_session-1_data.csv",
        "Subject-01_data.csv",
        "subject-01.csv",
        "subject-01_Data.csv",
    ],
)
def test_file_names_that_break_the_rule(name):
    assert file_name_labels(name) is None


def test_dissimilarities(study):
    write_pairs(study, participant="1")
    table = read_dissimilarities(study)
    assert table.to_numpy().tolist() == [
        ["01", "a", "a", 0.0],
        ["01", "a", "b", 40.0],
        ["01", "b", "b", 3.0],
        ["1", "a", "a", 0.0],
        ["1", "a", "b", 40.0],
        ["1", "b", "b", 3.0],
    ]
    assert table.columns.tolist() == ["participant_id", "stimulus_a", "stimulus_b", "dissimilarity"]


def test_a_pair_judged_twice_has_the_mean(study):
    write_pairs(study, session="2", pairs=[("a", "b", 50)])
    table = read_dissimilarities(study).set_index(["stimulus_a", "stimulus_b"])
    assert table.loc[("a", "b"), "dissimilarity"] == 45


def test_what_was_not_judged_is_absent(study):
    edit(pairwise_file(study), ",a,a,0,", ",a,a,,")
    assert len(read_dissimilarities(study)) == 2


def test_magnitudes(study):
    table = read_magnitudes(study, "doi")
    assert table.to_numpy().tolist() == [["01", "a", 1, 20.0], ["01", "a", 2, 24.0]]
    write_ratings(study, session="2")
    assert read_magnitudes(study, "doi")["repeat"].tolist() == [1, 2, 3, 4]
    write_ratings(study, session="10", ratings=((1, "a", 30),))
    assert read_magnitudes(study, "doi")["rating"].tolist() == [20, 24, 20, 24, 30], "session 10 comes after session 2"


def test_an_unknown_task_lists_the_known_ones(study):
    with pytest.raises(GlossError, match="no rating of the task 'contrast'; its magnitude tasks are: doi"):
        read_magnitudes(study, "contrast")


def test_the_tasks_and_their_kinds(study):
    assert tasks_of(study) == {"doi": "magnitude", "pairwise": "pairwise"}


def test_a_dataset_without_pairs(tmp_path):
    write_ratings(tmp_path)
    with pytest.raises(GlossError, match="holds no judged pair; run 'gloss session pairwise' into it"):
        read_dissimilarities(tmp_path)


def test_data_are_never_overwritten(study):
    before = pairwise_file(study).read_bytes()
    with pytest.raises(GlossError, match="exists and is never overwritten"):
        write_pairs(study, pairs=[("a", "b", 1)])
    assert pairwise_file(study).read_bytes() == before


def test_the_description_says_who_is_simulated(study):
    write_pairs(study, participant="07", observer="human")
    for key in ("description", "measurementTechnique"):
        assert "no person took part): participants 01." in description(study)[key]
        assert "Human observers: participants 07." in description(study)[key]


def test_what_a_lab_adds_to_the_description_stays(study):
    document = description(study)
    document["description"] = "Our study."
    document["author"] = [{"@type": "Person", "name": "A. Observer"}]
    document["variableMeasured"][0] = {"@type": "PropertyValue", "name": "row_id", "description": "Our words."}
    (study / "dataset_description.json").write_text(json.dumps(document), encoding="utf-8")
    write_pairs(study, participant="02")
    after = description(study)
    assert after["description"] == "Our study."
    assert after["author"] == document["author"]
    assert after["variableMeasured"][0]["description"] == "Our words."
    assert "participants 01, 02." in after["measurementTechnique"]


def test_names_alone_may_stand_in_variable_measured(study):
    document = description(study)
    document["variableMeasured"] = [variable["name"] for variable in document["variableMeasured"]]
    (study / "dataset_description.json").write_text(json.dumps(document), encoding="utf-8")
    validate_dataset(study)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (",b,a,40,", ",b,a,140,", r"pairwise_data\.csv', line 2: dissimilarity '140' is not a number from 0 to 100"),
        (",b,a,40,", ",b,a,-1,", "line 2: dissimilarity '-1' is not a number from 0 to 100"),
        (",b,a,40,", ",b,a,nan,", "line 2: dissimilarity 'nan' is not a number from 0 to 100"),
        (",b,a,40,", ",b,a,4_0,", "line 2: dissimilarity '4_0' is not a number from 0 to 100"),
        (",b,a,40,", ",b,a,٤٠,", "line 2: dissimilarity '٤٠' is not a number from 0 to 100"),
        (",b,a,40,", ",b,a,many,", "line 2: dissimilarity 'many' is not a number from 0 to 100"),
        (",a,a,0,", ",a,b,0,", r"line 3: the trial a with b is already in '.*', line 2; remove one row"),
        ("-0002,", "-0001,", "line 3: row_id '01-1-pairwise-0001' is already used in .*, line 2"),
        ("-0002,01,", "-0002,02,", "line 3: participant_id '02', but the file's name says '01'"),
        ("-0002,01,1,pairwise", "-0002,01,1,other", "line 3: task 'other', but the file's name says 'pairwise'"),
        ("pairwise,1,2,1,", "pairwise,1,2,0,", "line 3: repeat '0' is not a whole number from 1"),
        ("pairwise,1,2,1,", "pairwise,1,2.5,1,", "line 3: trial '2.5' is not a whole number from 1"),
        ("3,,simulated", "3,,robot", "line 4: observer 'robot'; allowed are 'human' and 'simulated'"),
        ("3,,simulated", "3,,human", "line 4: participant '01' is human here and simulated elsewhere"),
        ("3,,simulated", "3,simulated", "line 4: 11 fields, but the header names 12 columns"),
        (",a,a,0,", ",a,,0,", "line 3: no stimulus is named"),
        (",a,a,0,", ',"a,a,0,', "is no CSV file: line 4: unexpected end of data"),
        ("dissimilarity", "difference", "has no column 'dissimilarity'; a pairwise file has row_id, participant_id"),
        ("stimulus_left", "stimulus_right", "has the column 'stimulus_right' twice"),
        ("row_id", "\ufeffrow_id", "begins with a byte order mark; save it as plain UTF-8"),
    ],
)
def test_a_broken_file_is_told_where(study, old, new, message):
    edit(pairwise_file(study), old, new)
    with pytest.raises(GlossError, match=message) as error:
        validate_dataset(study)
    assert "\n" not in str(error.value)
    with pytest.raises(GlossError, match=message):
        read_dissimilarities(study)
    with pytest.raises(GlossError, match=message):
        read_magnitudes(study, "doi")


def test_headers_and_description_agree_both_ways(study):
    path = study / "dataset_description.json"
    whole = description(study)
    missing = {**whole, "variableMeasured": whole["variableMeasured"][1:]}
    path.write_text(json.dumps(missing), encoding="utf-8")
    with pytest.raises(GlossError, match=r"Column 'row_id' of .* is not in variableMeasured"):
        validate_dataset(study)
    extra = {**whole, "variableMeasured": [*whole["variableMeasured"], "pupil_mm"]}
    path.write_text(json.dumps(extra), encoding="utf-8")
    with pytest.raises(GlossError, match="names 'pupil_mm', but no data file has that column"):
        validate_dataset(study)


@pytest.mark.parametrize("key", ["@context", "@type", "name", "description", "variableMeasured"])
def test_the_description_is_complete(study, key):
    document = description(study)
    del document[key]
    (study / "dataset_description.json").write_text(json.dumps(document), encoding="utf-8")
    with pytest.raises(GlossError, match=f"has no '{key}'; Psych-DS asks for it"):
        validate_dataset(study)


def test_missing_things(tmp_path):
    with pytest.raises(GlossError, match=r"No dataset folder at '.*nowhere'\. Check the path"):
        validate_dataset(tmp_path / "nowhere")
    with pytest.raises(GlossError, match=r"is no dataset: it holds no dataset_description\.json"):
        validate_dataset(tmp_path)
    update_description(tmp_path)
    with pytest.raises(GlossError, match="holds no data file under 'data'"):
        validate_dataset(tmp_path)


def test_a_file_of_another_name(study):
    (study / "data" / "notes.csv").write_text("a,b\n1,2\n", encoding="utf-8")
    with pytest.raises(GlossError, match=r"notes\.csv' is not named as a data file: name it like 'subject-01"):
        validate_dataset(study)


def test_a_file_of_another_encoding(study):
    pairwise_file(study).write_bytes(pairwise_file(study).read_bytes().replace(b",b,a,", b",\xe4,a,"))
    with pytest.raises(GlossError, match="is not UTF-8"):
        validate_dataset(study)


def test_a_link_to_nothing_is_no_absent_participant(study):
    path = pairwise_file(study)
    path.unlink()
    path.symlink_to("not-fetched")
    with pytest.raises(GlossError, match=r"Cannot read the data file '.*pairwise_data\.csv': No such file"):
        validate_dataset(study)


def test_blank_lines_at_the_end_do_not_count(study):
    path = pairwise_file(study)
    path.write_text(path.read_text("utf-8") + "\n\n", "utf-8")
    validate_dataset(study)
    assert len(read_dissimilarities(study)) == 3


def test_the_folder_round_a_dataset_is_told_apart(study):
    folder = study.parent / "round"
    folder.mkdir()
    study.rename(folder / "dataset")
    with pytest.raises(GlossError, match=r"is no dataset: .*Did you mean '.*round.dataset'\?"):
        validate_dataset(folder)


def test_hidden_files_are_not_data(study):
    (study / "data" / ".DS_Store").write_bytes(b"\x00")
    validate_dataset(study)


def test_lines_may_end_as_on_windows(study):
    path = pairwise_file(study)
    path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))
    assert len(read_dissimilarities(study)) == 3


def test_all_problems_are_counted(study):
    edit(pairwise_file(study), ",b,a,40,", ",b,a,140,")
    edit(pairwise_file(study), ",a,a,0,", ",a,a,-1,")
    assert len(dataset_problems(study)) == 2
    with pytest.raises(GlossError, match=r"1 more problem in this dataset"):
        validate_dataset(study)


def test_simulated_observers(study):
    assert read_simulated_observers(study) is None
    record_simulated_observer(study, "02", PARAMETERS)
    record_simulated_observer(study, "01", PARAMETERS)
    record_simulated_observer(study, "01", PARAMETERS)
    table = read_simulated_observers(study)
    assert table["participant_id"].tolist() == ["01", "02"]
    assert np.all(table["ratio"] == 1.7)
    with pytest.raises(GlossError, match=r"Participant '01' .* already simulated with other parameters .weight_c 1,"):
        record_simulated_observer(study, "01", {**PARAMETERS, "weight_d": 2.0})
    looking = {"weight_contrast": 1.0, "weight_sharpness": 0.9, "exponent": 0.8, "noise_sd": 4.0, "sees": "images"}
    record_simulated_observer(study, "03", looking)
    table = read_simulated_observers(study).set_index("participant_id")
    assert np.isnan(table.loc["03", ["weight_c", "weight_d", "ratio"]].astype(float)).all(), "it saw no c and d"
    assert table.loc["03", "sees"] == "images"
    with pytest.raises(GlossError, match=r"already simulated with other parameters .*sees images"):
        record_simulated_observer(study, "03", PARAMETERS)
    edit(study / "simulated_observers.json", '"version": 1', '"version": 2')
    with pytest.raises(GlossError, match=r"version 2; this version reads .* version 1"):
        read_simulated_observers(study)


@pytest.mark.parametrize(
    "observers", [["01"], {"01": 1.7}, {"01": {"ratio": 1.7}}, {"01": PARAMETERS | {"ratio": "x"}}]
)
def test_a_damaged_list_of_simulated_observers(tmp_path, observers):
    document = {"format": "gloss-simulated-observers", "version": 1, "observers": observers}
    (tmp_path / "simulated_observers.json").write_text(json.dumps(document))
    with pytest.raises(GlossError, match=r"is damaged: each of its observers must have the numbers exponent, noise_sd"):
        read_simulated_observers(tmp_path)


def _record_many(folder, first):
    for i in range(first, first + 10):
        record_simulated_observer(folder, f"{i:02d}", PARAMETERS)
        write_pairs(folder, participant=f"{i:02d}")


def test_processes_may_write_into_one_dataset_at_once(tmp_path):
    context = multiprocessing.get_context("spawn")
    workers = [context.Process(target=_record_many, args=(tmp_path, first)) for first in (10, 30)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert [worker.exitcode for worker in workers] == [0, 0]
    assert len(read_simulated_observers(tmp_path)) == 20
    assert read_dissimilarities(tmp_path)["participant_id"].nunique() == 20


def test_a_held_lock_is_waited_for_and_then_told(tmp_path):
    with (
        locked(tmp_path / ".lock"),
        pytest.raises(GlossError, match=r"Another process has held '.*' for 0\.1 s"),
        locked(tmp_path / ".lock", timeout_s=0.1),
    ):
        pass
    with locked(tmp_path / ".lock", timeout_s=0.1):
        pass


def test_stimuli_of_another_set_join_those_that_are_known(tmp_path):
    first, second = (Stimulus(name, 0.1, 0.05, alpha) for name, alpha in (("a", 0.04), ("b", 0.07)))
    record_stimuli(tmp_path, [first], source="one")
    record_stimuli(tmp_path, [second], source="another")
    assert read_stimuli(tmp_path).to_numpy().tolist() == [["a", 0.1, 0.05, 0.04], ["b", 0.1, 0.05, 0.07]]
    with pytest.raises(GlossError, match=r"'a' has alpha 0\.07 in 'third' but 0\.04 in"):
        record_stimuli(tmp_path, [Stimulus("a", 0.1, 0.05, 0.07)], source="third")
