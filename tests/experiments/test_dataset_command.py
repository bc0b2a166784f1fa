import json
import shutil

import pytest

from gloss_experiments import run_session
from glossspace import cli


@pytest.fixture
def gloss(capsys):
    """Run the command in this process: give its exit code, stdout and stderr."""

    def run(*words):
        code = 0
        try:
            cli.main([str(word) for word in words])
        except SystemExit as stop:
            code = stop.code
        return code, *capsys.readouterr()

    return run


@pytest.fixture
def study(small_set, tmp_path):
    """A dataset of one finished session and one that is not."""

    def interrupt(done, total):
        if done == 3:
            raise KeyboardInterrupt

    run_session("doi", stimuli=small_set, dataset=tmp_path / "study", participant="01")
    with pytest.raises(KeyboardInterrupt):
        run_session("doi", stimuli=small_set, dataset=tmp_path / "study", participant="02", on_trial=interrupt)
    return tmp_path / "study"


def data_file(study):
    return study / "data" / "subject-01" / "subject-01_session-1_task-doi_data.csv"


def test_check(gloss, study, small_set):
    code, out, err = gloss("dataset", "check", study, "--stimuli", small_set)
    assert code == 0
    assert out == f"'{study}' is whole: 1 data files, 2 journals, 0 pilots.\n"
    assert "Not finished: participant 02, session 1, task doi" in err


def test_check_tells_each_problem_on_one_line_and_exits_with_2(gloss, study):
    path = data_file(study)
    path.write_text(path.read_text("utf-8").replace("simulated", "robot"), "utf-8")
    code, out, err = gloss("dataset", "check", study)
    problems = out.splitlines()
    assert code == 2
    assert len(problems) == 10, "one a row, and that the file is not its journal's"
    assert "line 2: observer 'robot'; allowed are 'human' and 'simulated'" in problems[0]
    assert "observer is 'robot', but 'simulated' in the journal" in problems[-1]
    assert "gloss: 10 problems in the dataset" in err
    assert "Traceback" not in err
    code, out, _ = gloss("dataset", "check", study, "--json")
    document = json.loads(out)
    assert code == 2
    assert (document["whole"], document["problems"]) == (False, problems)


def test_check_as_json(gloss, study):
    code, out, _ = gloss("dataset", "check", study, "--json")
    document = json.loads(out)
    assert code == 0
    assert (document["whole"], document["n_journals"], document["n_pilots"]) == (True, 2, 0)
    assert len(document["remarks"]) == 1


def test_rebuild(gloss, study):
    before = data_file(study).read_bytes()
    data_file(study).unlink()
    code, out, _ = gloss("dataset", "rebuild", study)
    lines = out.splitlines()
    assert code == 0
    assert lines[0] == "participant 01, session 1, task doi: made."
    assert lines[1].startswith("participant 02, session 1, task doi: not finished, 7 of 13 trials: no data file")
    assert data_file(study).read_bytes() == before
    code, out, _ = gloss("dataset", "rebuild", study, "--json")
    assert [one["outcome"] for one in json.loads(out)["sessions"]] == ["same", "incomplete"]


def test_rebuild_says_what_differs_and_exits_with_2(gloss, study):
    data_file(study).write_text(data_file(study).read_text("utf-8").replace(",simulated", ",human"), "utf-8")
    before = data_file(study).read_bytes()
    code, out, err = gloss("dataset", "rebuild", study)
    assert code == 2
    assert "task doi: DIFFERS from its journal and was left as it is." in out
    assert "1 data file differs from the journal, first" in err
    assert data_file(study).read_bytes() == before


def test_rebuild_lists_a_journal_that_it_cannot_read_and_exits_with_2(gloss, study):
    broken = study / "journals" / "subject-00_session-1_task-doi.jsonl"
    broken.write_text("{}\n", "utf-8")
    before = data_file(study).read_bytes()
    data_file(study).unlink()
    code, out, err = gloss("dataset", "rebuild", study)
    assert code == 2
    assert out.splitlines()[0].startswith("subject-00_session-1_task-doi: NOT READ. ")
    assert out.splitlines()[1] == "participant 01, session 1, task doi: made."
    assert "1 of 3 journals cannot be read" in err
    assert data_file(study).read_bytes() == before


def test_a_dataset_without_a_finished_session_is_whole(gloss, study, small_set, tmp_path):
    (study / "journals" / "subject-01_session-1_task-doi.jsonl").unlink()
    for name in ("data", "dataset_description.json"):
        path = study / name
        shutil.rmtree(path) if path.is_dir() else path.unlink()
    code, out, err = gloss("dataset", "check", study)
    assert (code, out) == (0, f"'{study}' is whole: 0 data files, 1 journals, 0 pilots.\n")
    assert "Not finished: participant 02" in err
    assert "holds no data yet" in err
    run_session("doi", stimuli=small_set, dataset=tmp_path / "pilots alone", participant="01", pilot=True)
    code, out, _ = gloss("dataset", "check", tmp_path / "pilots alone")
    assert (code, out) == (0, f"'{tmp_path / 'pilots alone'}' is whole: 0 data files, 0 journals, 1 pilots.\n")


def test_export_bids(gloss, study, tmp_path):
    code, out, _ = gloss("dataset", "export-bids", study, "--out", tmp_path / "bids")
    assert code == 0
    assert "8 files of 1 participants in" in out
    sidecar = tmp_path / "bids" / "sub-01" / "ses-1" / "beh" / "sub-01_ses-1_task-doi_beh.json"
    document = json.loads(sidecar.read_text("utf-8"))
    assert "How glossy is the object?" in document["TaskDescription"]
    assert "Move the slider" in document["Instructions"]
    code, _, err = gloss("dataset", "export-bids", study, "--out", tmp_path / "bids")
    assert code == 2
    assert "something is there already" in err


@pytest.mark.parametrize("words", [("check",), ("rebuild",), ("export-bids", "--out", "bids")])
def test_no_dataset(gloss, tmp_path, monkeypatch, words):
    monkeypatch.chdir(tmp_path)
    code, out, err = gloss("dataset", words[0], "nowhere", *words[1:])
    assert (code, out) == (2, "")
    assert "No dataset folder at 'nowhere'. Check the path." in err
    assert list(tmp_path.iterdir()) == []


def test_help_has_examples(gloss):
    code, out, _ = gloss("dataset", "--help")
    assert code == 0
    assert "gloss dataset export-bids study/dataset --out study/bids" in out
    for name in ("check", "rebuild", "export-bids"):
        assert f"gloss dataset {name} study/dataset" in gloss("dataset", name, "--help")[1]
