import json
import shutil

import pytest

from gloss_experiments import run_session
from gloss_experiments.datasets.journalled_session import read_session
from gloss_experiments.datasets.rebuild import rebuild_dataset
from gloss_experiments.observers.observer import SimulatedObserver
from glossspace.dataset import read_simulated_observers, read_stimuli, validate_dataset
from glossspace.errors import GlossError
from tests.experiments.session_files import data_of, lines_of, with_design


@pytest.fixture
def study(small_set, tmp_path):
    """Pairs, ratings and a ranking of one simulated observer, one of them a pilot."""
    folder = tmp_path / "study"
    reference = "d0.03_s0.033_a0.04"
    for protocol in ("pairwise", "doi", with_design("ranking", reference=reference, stimuli=(), practice=0)):
        run_session(protocol, stimuli=small_set, dataset=folder, participant="01")
    run_session("contrast", stimuli=small_set, dataset=folder, participant="01", pilot=True)
    return folder


def journal_of(study, task):
    return study / "journals" / f"subject-01_session-1_task-{task}.jsonl"


def test_all_data_come_again_from_the_journals(study):
    """What a session writes and what is made from its journal are the same bytes, of all kinds of tasks."""
    before, pilots = data_of(study), data_of(study / "pilots")
    assert len(before) == 3
    assert len(pilots) == 1
    shutil.rmtree(study / "data")
    shutil.rmtree(study / "pilots" / "data")
    stimuli = read_stimuli(study)
    for name in ("dataset_description.json", "simulated_observers.json", "stimuli.csv"):
        (study / name).unlink()
    rebuilt = rebuild_dataset(study)
    assert {(one.outcome, one.pilot) for one in rebuilt} == {("made", False), ("made", True)}
    assert data_of(study) == before
    assert data_of(study / "pilots") == pilots
    assert read_simulated_observers(study)["participant_id"].tolist() == ["01"]
    assert read_stimuli(study).equals(stimuli)
    validate_dataset(study)
    assert {one.outcome for one in rebuild_dataset(study)} == {"same"}


def test_a_file_that_differs_is_told_of_and_left(study):
    path = next((study / "data").rglob("*doi_data.csv"))
    path.write_text(path.read_text("utf-8").replace("simulated", "human"), "utf-8")
    before = path.read_bytes()
    outcomes = {one.data.name: one.outcome for one in rebuild_dataset(study)}
    assert outcomes[path.name] == "differs"
    assert sorted(outcomes.values()) == ["differs", "same", "same", "same"]
    assert path.read_bytes() == before


def test_a_session_that_is_not_finished_is_left(study):
    journal = journal_of(study, "doi")
    lines = journal.read_bytes().splitlines(keepends=True)
    journal.write_bytes(b"".join(lines[:6]) + lines[6][:20])
    path = next((study / "data").rglob("*doi_data.csv"))
    path.unlink()
    before = journal.read_bytes()
    (one,) = (one for one in rebuild_dataset(study) if one.journal == journal)
    assert (one.outcome, one.n_answered) == ("incomplete", 5)
    assert not path.exists()
    assert journal.read_bytes() == before, "not even the torn line is touched: a session may be writing it"


def test_one_that_was_killed_before_its_end_mark_is_complete(study):
    journal = journal_of(study, "doi")
    journal.write_bytes(b"".join(journal.read_bytes().splitlines(keepends=True)[:-1]))
    next((study / "data").rglob("*doi_data.csv")).unlink()
    assert [one.outcome for one in rebuild_dataset(study) if one.journal == journal] == ["made"]


def test_data_of_the_first_version_are_the_same(study):
    """Its files had the columns up to `observer` and no more."""
    path = next((study / "data").rglob("*pairwise_data.csv"))
    lines = [line.split(",") for line in path.read_text("utf-8").splitlines()]
    first = lines[0].index("observer") + 1
    path.write_text("".join(",".join(line[:first]) + "\n" for line in lines), "utf-8")
    assert [one.outcome for one in rebuild_dataset(study) if one.data == path] == ["same"]


def test_what_a_kind_of_observer_is_survives(small_set, tmp_path):
    lapsing = SimulatedObserver(1.0, 1.5, 0.8, 4.0, lapse_rate=0.5, lapse_answer=50)
    run_session("doi", stimuli=small_set, dataset=tmp_path, participant="01", observer=lapsing)
    (tmp_path / "simulated_observers.json").unlink()
    rebuild_dataset(tmp_path)
    row = read_simulated_observers(tmp_path).iloc[0]
    assert (row["lapse_rate"], row["lapse_answer"], row["ratio"]) == (0.5, 50, 1.5)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"protocol": None}, "has no valid 'protocol'"),
        ({"n_trials": "many"}, "has no valid 'n_trials'"),
        ({"stimulus_sha256": []}, "has no valid 'stimulus_sha256'"),
        ({"participant": "a_b"}, "The participant in the header of .* 'a_b' cannot stand in a file name"),
        ({"paints": {"a": {"rho_d": 0.1}}}, "the paint of 'a' is .*, not rho_d, rho_s and alpha"),
        ({"paints": {"a": {"rho_d": 0.9, "rho_s": 0.9, "alpha": 0.1}}}, "must be at most 1"),
        ({"protocol": {"format": 1}}, r"The protocol in the header of the journal .* cannot be read \(name: Field"),
    ],
)
def test_a_header_that_cannot_be(study, change, message):
    journal = journal_of(study, "doi")
    header, *rest = lines_of(journal)
    journal.write_text("".join(json.dumps(line) + "\n" for line in (header | change, *rest)), "utf-8")
    with pytest.raises(GlossError, match=message):
        read_session(journal)


def test_a_journal_that_cannot_be_read_does_not_hold_up_the_others(study):
    before = data_of(study)
    shutil.rmtree(study / "data")
    journal = journal_of(study, "doi")
    journal.write_bytes(b"{}\n" + journal.read_bytes())
    outcomes = {one.journal.name: one for one in rebuild_dataset(study) if not one.pilot}
    broken = outcomes.pop(journal.name)
    assert (broken.outcome, broken.data) == ("unreadable", None)
    assert "line 1 cannot be read" in broken.problem
    assert [one.outcome for one in outcomes.values()] == ["made", "made"]
    assert data_of(study) == {name: content for name, content in before.items() if "task-doi" not in name}


def test_a_trial_of_another_kind_than_the_protocol_s(study):
    journal = journal_of(study, "doi")
    header, first, *rest = lines_of(journal)
    pair = first | {"stimuli": first["stimuli"] * 2}
    journal.write_text("".join(json.dumps(line) + "\n" for line in (header, pair, *rest)), "utf-8")
    with pytest.raises(GlossError, match="practice trial 1 shows 2 stimuli, which no magnitude trial does"):
        read_session(journal)


def test_an_empty_journal_and_none(study, tmp_path):
    journal = journal_of(study, "doi")
    journal.write_bytes(b'{"type": "hea')
    with pytest.raises(GlossError, match="has no header: the session never began"):
        read_session(journal)
    (tmp_path / "other").mkdir()
    with pytest.raises(GlossError, match="holds no journal under 'journals'"):
        rebuild_dataset(tmp_path / "other")
    with pytest.raises(GlossError, match="No dataset folder at 'nowhere'"):
        rebuild_dataset("nowhere")
