import json
import shutil

import pytest

from gloss_experiments import run_session
from gloss_experiments.datasets.dataset_check import check_dataset
from glossspace.errors import GlossError
from glossspace.stimulus_set import read_stimulus_set
from tests.experiments.session_files import lines_of, with_design


@pytest.fixture(scope="module")
def made(small_set, tmp_path_factory):
    """Three sessions of two simulated observers: with practice, catch trials and breaks, and split over two days."""
    folder = tmp_path_factory.mktemp("made") / "study"
    rich = with_design("pairwise", repeats=2, practice=2, catch_trials=2, break_every=4)
    split = with_design("doi", sessions=2)
    run_session(rich, stimuli=small_set, dataset=folder, participant="01", seed=4)
    run_session(split, stimuli=small_set, dataset=folder, participant="02", session="1", seed=4)
    run_session(split, stimuli=small_set, dataset=folder, participant="02", session="2", seed=4)
    return folder


@pytest.fixture
def study(made, tmp_path):
    """A copy of it to spoil."""
    return shutil.copytree(made, tmp_path / "study")


def pairwise_journal(study):
    return study / "journals" / "subject-01_session-1_task-pairwise.jsonl"


def pairwise_data(study):
    return study / "data" / "subject-01" / "subject-01_session-1_task-pairwise_data.csv"


def rewrite(path, lines):
    path.write_text("".join(json.dumps(line, ensure_ascii=False) + "\n" for line in lines), "utf-8")


def the_problem(study, **options):
    problems = check_dataset(study, **options).problems
    assert len(problems) == 1, problems
    assert "\n" not in problems[0]
    return problems[0]


def test_a_whole_dataset(made, small_set):
    before = {path: path.read_bytes() for path in made.rglob("*") if path.is_file()}
    found = check_dataset(made, stimuli=read_stimulus_set(small_set))
    assert found.problems == ()
    assert (found.n_data_files, found.n_journals, found.n_pilots) == (3, 3, 0)
    assert {path: path.read_bytes() for path in made.rglob("*") if path.is_file()} == before


def test_two_trials_that_changed_places(study):
    """The journal and its data agree, but no seed draws that order: both were made by hand."""
    journal, data = pairwise_journal(study), pairwise_data(study)
    lines = lines_of(journal)
    judged = [i for i, line in enumerate(lines) if line.get("role") == "judged"]
    i, j = judged[0], judged[1]
    for key in ("stimuli", "rating"):
        lines[i][key], lines[j][key] = lines[j][key], lines[i][key]
    rewrite(journal, lines)
    data.unlink()
    data_lines = check_dataset(study).problems
    assert any("is complete, but there is no data file" in line for line in data_lines)
    (order,) = (line for line in data_lines if "the order drawn from seed 4" in line)
    assert f"trial {lines[i]['trial']} (judged) shows {' with '.join(lines[i]['stimuli'])}" in order
    assert "another version drew it: python" in order


def test_a_left_out_trial(study):
    journal = pairwise_journal(study)
    lines = lines_of(journal)
    del lines[-2]
    rewrite(journal, lines)
    found = check_dataset(study)
    assert any("15 of 16 trials only; restore the journal" in problem for problem in found.problems)
    assert any(remark.startswith("Not finished: participant 01, session 1") for remark in found.remarks)


def test_a_person_who_is_listed_as_simulated(study):
    header, *lines = lines_of(pairwise_journal(study))
    rewrite(pairwise_journal(study), [header | {"observer": {"kind": "human"}}, *lines])
    who = [
        problem for problem in check_dataset(study).problems if problem.startswith("Participant '01' is a person in ")
    ]
    assert len(who) == 1


def test_a_judged_trial_that_is_called_a_catch_trial(study):
    """It is the right pair at its place, but its row would be left out of the data."""
    lines = lines_of(pairwise_journal(study))
    line = next(line for line in lines if line.get("role") == "judged")
    line["role"] = "catch"
    rewrite(pairwise_journal(study), lines)
    pairwise_data(study).unlink()
    (problem,) = (line for line in check_dataset(study).problems if "the order drawn from seed 4" in line)
    pair = " with ".join(line["stimuli"])
    assert f"shows {pair} as catch trial {line['trial']} of block 1, repeat 1, but" in problem
    assert f"has {pair} as judged trial {line['trial']} of block 1, repeat 1 there" in problem


def test_a_trial_too_many(study):
    """A catch trial gives no row, so that the data file does not tell."""
    lines = lines_of(pairwise_journal(study))
    last = next(i for i in reversed(range(len(lines))) if lines[i]["type"] == "trial")
    extra = lines[last] | {"trial": lines[last]["trial"] + 1, "role": "catch"}
    rewrite(pairwise_journal(study), [*lines[: last + 1], extra, *lines[last + 1 :]])
    assert "has 17 trials, 1 more than its protocol makes" in the_problem(study)


def test_a_changed_rating(study):
    data = pairwise_data(study)
    lines = data.read_text("utf-8").splitlines()
    cells = lines[3].split(",")
    column = lines[0].split(",").index("dissimilarity")
    right, cells[column] = cells[column], str((int(cells[column]) + 7) % 101)
    lines[3] = ",".join(cells)
    data.write_text("\n".join([*lines, ""]), "utf-8")
    assert f"line 4: dissimilarity is '{cells[column]}', but '{right}' in the journal" in the_problem(study)


def test_a_row_too_few(study):
    data = pairwise_data(study)
    data.write_text("".join(data.read_text("utf-8").splitlines(keepends=True)[:-1]), "utf-8")
    assert "has 11 rows, but its journal makes 12" in the_problem(study)


def test_a_lab_may_add_columns_and_end_lines_as_it_likes(study):
    for data in (study / "data").rglob("*.csv"):
        header, *rows = data.read_text("utf-8").splitlines()
        text = "\r\n".join([f"{header},pupil_mm", *(f"{row},3.1" for row in rows), ""])
        data.write_bytes(text.encode("utf-8"))
    path = study / "dataset_description.json"
    document = json.loads(path.read_text("utf-8"))
    document["variableMeasured"].append("pupil_mm")
    path.write_text(json.dumps(document), "utf-8")
    assert check_dataset(study).problems == ()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"seed": 5}, "the order drawn from seed 5"),
        ({"n_trials": 13, "n_practice": 3}, "says 16 trials, but its protocol makes"),
        ({"protocol_sha256": "0" * 64}, "the protocol in its header has another hash"),
        ({"stimuli_sha256": "0" * 64}, "the image hashes in its header are not those"),
        ({"participant": "03"}, "is that of participant 03, session 1, task pairwise; name it 'subject-03"),
        ({"pilot": True}, "is a pilot; move it and its data file to '"),
    ],
)
def test_a_changed_header(study, change, message):
    journal = pairwise_journal(study)
    header, *rest = lines_of(journal)
    if "n_trials" in change:  # as many trials in all, so that the session still counts as complete
        change = {"n_trials": header["n_trials"] + 1, "n_practice": header["n_practice"]}
        message = f"says {header['n_trials'] + header['n_practice'] + 1} trials, but its protocol makes"
    rewrite(journal, [header | change, *rest])
    assert any(message in problem for problem in check_dataset(study).problems)


def test_a_protocol_that_was_changed_draws_another_design(study):
    journal = pairwise_journal(study)
    header, *rest = lines_of(journal)
    header["protocol"]["design"]["repeats"] = 1
    rewrite(journal, [header, *rest])
    problems = check_dataset(study).problems
    assert any("has another hash than the session began with" in problem for problem in problems)
    assert any("trials, but its protocol makes 10" in problem for problem in problems), problems


def test_images_that_changed_between_sessions(study, small_set, experiment1):
    """The names are the same, the pictures are not."""
    journal = study / "journals" / "subject-02_session-2_task-doi.jsonl"
    header, *rest = lines_of(journal)
    other = read_stimulus_set(experiment1)
    hashes = {
        entry["name"]: entry["sha256"]["image"]
        for entry in other.manifest["stimuli"]
        if entry["name"] in header["stimulus_sha256"]
    }
    rewrite(journal, [header | {"stimulus_sha256": hashes}, *rest])
    problems = check_dataset(study).problems
    assert any("is another than in" in problem and "session-1" in problem for problem in problems)
    assert any("The image of" in problem for problem in check_dataset(study, stimuli=other).problems)


def test_data_without_their_journal(study):
    pairwise_journal(study).unlink()
    assert "pairwise_data.csv' has no journal; restore '" in the_problem(study)


def test_data_of_another_program_have_no_journals(study):
    shutil.rmtree(study / "journals")
    found = check_dataset(study)
    assert found.problems == ()
    assert any("holds no journals: its data were compared with no record" in remark for remark in found.remarks)


def test_a_pilot_in_the_wrong_place(study, small_set):
    run_session("contrast", stimuli=small_set, dataset=study, participant="01", pilot=True)
    assert check_dataset(study).problems == ()
    assert check_dataset(study).n_pilots == 1
    for folder in ("journals", "data/subject-01"):
        (path,) = (study / "pilots" / folder).glob("*contrast*")
        shutil.move(path, study / folder / path.name)
    problems = check_dataset(study).problems
    assert any("is a pilot; move it and its data file to" in problem for problem in problems)
    assert any("this is a pilot, which is no data of the study" in problem for problem in problems)


def test_no_pilot_among_the_pilots(study, small_set):
    run_session("contrast", stimuli=small_set, dataset=study, participant="01", pilot=True)
    journal = study / "pilots" / "journals" / "subject-01_session-1_task-contrast.jsonl"
    header, *rest = lines_of(journal)
    rewrite(journal, [header | {"pilot": False}, *rest])
    assert any("is no pilot; move it and its data file to" in problem for problem in check_dataset(study).problems)


def test_a_study_may_be_called_pilots(small_set, tmp_path):
    run_session("doi", stimuli=small_set, dataset=tmp_path / "pilots", participant="01")
    assert check_dataset(tmp_path / "pilots").problems == ()


def test_an_unlisted_simulated_observer(study):
    (study / "simulated_observers.json").unlink()
    problems = check_dataset(study).problems
    assert [problem.split(" is simulated")[0] for problem in problems] == ["Participant '01'", "Participant '02'"]


def test_a_person_of_the_same_name(study):
    journal = study / "journals" / "subject-02_session-2_task-doi.jsonl"
    header, *rest = lines_of(journal)
    rewrite(journal, [header | {"observer": {"kind": "human"}}, *rest])
    problems = check_dataset(study).problems
    assert any("Participant '02' is a person in" in problem for problem in problems)


def test_a_stimulus_that_is_not_described(study):
    path = study / "stimuli.csv"
    lines = path.read_text("utf-8").splitlines(keepends=True)
    path.write_text("".join(lines[:-1]), "utf-8")
    name = lines[-1].split(",")[0]
    assert f"shows the stimulus '{name}', which stimuli.csv of" in the_problem(study)


def test_a_damaged_journal_is_one_problem(study):
    journal = pairwise_journal(study)
    lines = journal.read_text("utf-8").splitlines()
    lines[4] = "not json"
    journal.write_text("\n".join([*lines, ""]), "utf-8")
    assert "line 5 cannot be read" in the_problem(study)


def test_a_torn_line_and_a_short_file_are_remarks(study, small_set):
    with pytest.raises(KeyboardInterrupt):
        run_session("contrast", stimuli=small_set, dataset=study, participant="03", on_trial=interrupt_at(5))
    journal = study / "journals" / "subject-03_session-1_task-contrast.jsonl"
    journal.write_bytes(journal.read_bytes() + b'{"type": "tri')
    found = check_dataset(study)
    assert found.problems == ()
    assert any("Not finished: participant 03, session 1, task contrast, 9 of 13 trials" in one for one in found.remarks)
    assert any("is torn, as a kill leaves it" in one for one in found.remarks)


def interrupt_at(n):
    def interrupt(done, total):
        if done == n:
            raise KeyboardInterrupt

    return interrupt


def test_no_dataset(tmp_path):
    with pytest.raises(GlossError, match="No dataset folder at 'nowhere'"):
        check_dataset("nowhere")
    assert "is no dataset: it holds no dataset_description.json" in check_dataset(tmp_path).problems[0]
