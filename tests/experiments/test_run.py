import json
import subprocess
import sys

import pytest

from gloss_experiments import SimulatedObserver, run_session, simulated_observers
from glossspace.dataset import (
    read_dissimilarities,
    read_magnitudes,
    read_simulated_observers,
    read_stimuli,
    validate_dataset,
)
from glossspace.errors import GlossError
from glossspace.stimulus_set import read_stimulus_set
from tests.experiments.session_files import data_of, lines_of


def test_experiment_1_and_2_make_a_whole_dataset(experiment1, tmp_path):
    observers = simulated_observers(2, seed=1)
    for participant, observer in zip(("01", "02"), observers, strict=True):
        for task, n_trials in (("pairwise", 378), ("contrast", 81), ("doi", 81)):
            result = run_session(
                task, stimuli=experiment1, dataset=tmp_path, participant=participant, observer=observer
            )
            assert (result.n_trials, result.n_answered, result.simulated) == (n_trials, n_trials, True)
    validate_dataset(tmp_path)

    pairs = read_dissimilarities(tmp_path)
    assert pairs.columns.tolist() == ["participant_id", "stimulus_a", "stimulus_b", "dissimilarity"]
    assert pairs.groupby("participant_id").size().to_dict() == {"01": 378, "02": 378}
    assert (pairs["stimulus_a"] <= pairs["stimulus_b"]).all()
    assert (pairs["stimulus_a"] == pairs["stimulus_b"]).sum() == 2 * 27
    assert (pairs["dissimilarity"] == 0).any(), "zero is data"

    ratings = read_magnitudes(tmp_path, "doi")
    assert ratings.columns.tolist() == ["participant_id", "stimulus", "repeat", "rating"]
    assert len(ratings) == 2 * 81
    assert set(ratings["repeat"]) == {1, 2, 3}

    truth = read_simulated_observers(tmp_path).set_index("participant_id")
    for participant, observer in zip(("01", "02"), observers, strict=True):
        assert truth.loc[participant].to_dict() == observer.parameters()
    stimuli = read_stimulus_set(experiment1).table()[["stimulus", "rho_d", "rho_s", "alpha"]]
    assert read_stimuli(tmp_path).equals(stimuli), "the dataset can be analysed without its images"
    description = (tmp_path / "dataset_description.json").read_text(encoding="utf-8")
    assert "Simulated observers (answers computed by a program, no person took part)" in description


def test_the_answers_are_the_observer_s(experiment1, tmp_path):
    """Without noise or compression a rating is eq. 5 of the gloss paper, as a fraction of the set's largest."""
    observer = SimulatedObserver(weight_c=1.0, weight_d=1.78, exponent=1.0, noise_sd=0.0)
    run_session("pairwise", stimuli=experiment1, dataset=tmp_path, participant="01", observer=observer)
    table = read_stimulus_set(experiment1).table().set_index("stimulus")
    pairs = read_dissimilarities(tmp_path)
    a, b = table.loc[pairs["stimulus_a"]].reset_index(), table.loc[pairs["stimulus_b"]].reset_index()
    distance = ((a["c"] - b["c"]) ** 2 + (1.78 * (a["d"] - b["d"])) ** 2) ** 0.5
    assert (pairs["dissimilarity"] - 100 * distance / distance.max()).abs().max() <= 0.5  # rounded to whole numbers


def test_the_same_seed_gives_the_same_data(experiment1, tmp_path):
    results = {}
    for name, seed in (("a", 1), ("b", 1), ("c", 2), ("d", None), ("e", 0)):
        run_session("doi", stimuli=experiment1, dataset=tmp_path / name, participant="01", seed=seed)
        results[name] = data_of(tmp_path / name)
    assert results["a"] == results["b"]
    assert results["a"] != results["c"]
    assert results["d"] == results["e"], "0 is the default"


def test_a_finished_session_is_left_alone(experiment1, tmp_path):
    first = run_session("doi", stimuli=experiment1, dataset=tmp_path, participant="01")
    files = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*_data.csv")}
    journal = first.journal_path.read_bytes()
    again = run_session("doi", stimuli=experiment1, dataset=tmp_path, participant="01")
    assert (first.already_finished, again.already_finished) == (False, True)
    assert again.data_path == first.data_path
    assert {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*_data.csv")} == files
    assert first.journal_path.read_bytes() == journal
    with pytest.raises(GlossError, match="was begun with seed 0, but 5 is asked for"):
        run_session("doi", stimuli=experiment1, dataset=tmp_path, participant="01", seed=5)


def test_data_without_their_journal_are_never_overwritten(experiment1, tmp_path):
    result = run_session("doi", stimuli=experiment1, dataset=tmp_path, participant="01")
    result.journal_path.unlink()
    before = data_of(tmp_path)
    with pytest.raises(GlossError, match="exists without its journal: the session is finished and is never run again"):
        run_session("doi", stimuli=experiment1, dataset=tmp_path, participant="01")
    assert data_of(tmp_path) == before


def test_data_are_made_again_from_the_journal(experiment1, tmp_path):
    result = run_session("doi", stimuli=experiment1, dataset=tmp_path, participant="01")
    before = data_of(tmp_path)
    result.data_path.unlink()
    assert run_session("doi", stimuli=experiment1, dataset=tmp_path, participant="01").n_before == 81
    assert data_of(tmp_path) == before


@pytest.mark.parametrize("n", [1, 27, 80])
def test_an_interrupted_session_goes_on_where_it_was(experiment1, tmp_path, n):
    def interrupt(done, total):
        if done == n:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_session("doi", stimuli=experiment1, dataset=tmp_path / "a", participant="01", seed=3, on_trial=interrupt)
    assert data_of(tmp_path / "a") == {}
    (journal,) = (tmp_path / "a").rglob("*.jsonl")
    with journal.open("ab") as stream:
        stream.write(b'{"type": "trial", "tri')
    result = run_session("doi", stimuli=experiment1, dataset=tmp_path / "a", participant="01")  # with its own seed
    assert (result.n_before, result.seed, result.torn) == (n, 3, True)
    (resumed,) = (line for line in lines_of(journal) if line["type"] == "resumed")
    assert resumed["torn"] is True
    run_session("doi", stimuli=experiment1, dataset=tmp_path / "b", participant="01", seed=3)
    assert data_of(tmp_path / "a") == data_of(tmp_path / "b")


def test_a_session_in_another_order_than_is_drawn_now_does_not_go_on(experiment1, tmp_path):
    """Another version drew it: what follows would repeat some trials and leave others out."""

    def interrupt(done, total):
        if done == 5:
            raise KeyboardInterrupt

    words = {"stimuli": experiment1, "dataset": tmp_path, "participant": "01"}
    with pytest.raises(KeyboardInterrupt):
        run_session("doi", on_trial=interrupt, **words)
    (journal,) = tmp_path.rglob("*.jsonl")
    lines = lines_of(journal)
    lines[2]["stimuli"], lines[4]["stimuli"] = lines[4]["stimuli"], lines[2]["stimuli"]
    text = "".join(json.dumps(line) + "\n" for line in lines)
    journal.write_text(text, encoding="utf-8")
    with pytest.raises(GlossError, match="not in the order that this version draws from their seed"):
        run_session("doi", **words)
    assert journal.read_text(encoding="utf-8") == text


def test_killed_between_the_data_and_their_description(experiment1, tmp_path):
    run_session("doi", stimuli=experiment1, dataset=tmp_path, participant="01")
    (tmp_path / "dataset_description.json").unlink()
    with pytest.raises(GlossError, match="holds no dataset_description.json"):
        validate_dataset(tmp_path)
    run_session("doi", stimuli=experiment1, dataset=tmp_path, participant="01")
    validate_dataset(tmp_path)


def test_changed_images_are_refused(experiment1, small_set, tmp_path):
    run_session("doi", stimuli=experiment1, dataset=tmp_path, participant="01")
    with pytest.raises(GlossError, match=r"stimuli_sha256 .* the images were changed"):
        run_session("doi", stimuli=small_set, dataset=tmp_path, participant="01")


def test_a_stimulus_cannot_change_within_a_dataset(experiment1, small_set, tmp_path):
    run_session("doi", stimuli=small_set, dataset=tmp_path, participant="01")
    assert len(read_stimuli(tmp_path)) == 3
    run_session("doi", stimuli=experiment1, dataset=tmp_path, participant="02")
    assert len(read_stimuli(tmp_path)) == 27, "a further set adds its stimuli"
    file = tmp_path / "stimuli.csv"
    file.write_text(file.read_text(encoding="utf-8").replace("a0.04,0.03,0.033,0.04", "a0.04,0.03,0.033,0.05"))
    with pytest.raises(GlossError, match=r"The stimulus 'd0.03_s0.033_a0.04' has alpha 0.04 in .* but 0.05 in"):
        run_session("doi", stimuli=experiment1, dataset=tmp_path, participant="03")
    assert not list(tmp_path.rglob("subject-03*")), "nothing is written half"


@pytest.mark.parametrize("seed", [None, -1, 1.5, True, "1"])
def test_a_journal_without_a_seed_is_refused(experiment1, tmp_path, seed):
    result = run_session("doi", stimuli=experiment1, dataset=tmp_path, participant="01")
    header, *rest = lines_of(result.journal_path)
    lines = (header | {"seed": seed}, *rest)
    result.journal_path.write_text("".join(json.dumps(line) + "\n" for line in lines), encoding="utf-8")
    with pytest.raises(GlossError, match="has no valid 'seed'"):
        run_session("doi", stimuli=experiment1, dataset=tmp_path, participant="01")


def test_a_lock_file_that_cannot_be_opened(experiment1, tmp_path):
    """As where another member of the lab made it, and nobody else may write to it."""
    (tmp_path / ".dataset.lock").mkdir()
    with pytest.raises(GlossError, match="Cannot open the lock file"):
        run_session("doi", stimuli=experiment1, dataset=tmp_path, participant="01")
    assert not list(tmp_path.rglob("*.jsonl")), "nothing is written half"


def test_a_person_and_a_program_never_share_a_name(experiment1, tmp_path):
    run_session("doi", stimuli=experiment1, dataset=tmp_path, participant="01")
    with pytest.raises(GlossError, match=r"Participant '01' .* is simulated; give a person another identifier"):
        run_session("contrast", stimuli=experiment1, dataset=tmp_path, participant="01", mode="screen")
    other = simulated_observers(1, seed=9)[0]
    with pytest.raises(GlossError, match="already simulated with other parameters"):
        run_session("contrast", stimuli=experiment1, dataset=tmp_path, participant="01", observer=other)
    human = {"type": "header", "format": "gloss-journal", "version": 1}
    (tmp_path / "journals" / "subject-02_session-1_task-doi.jsonl").write_text(json.dumps(human) + "\n")
    with pytest.raises(GlossError, match=r"Participant '02' .* is a person"):
        run_session("contrast", stimuli=experiment1, dataset=tmp_path, participant="02")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"mode": "pilot"}, "Unknown mode 'pilot'; allowed are headless, simulate, screen"),
        ({"seed": -1}, "The seed -1 is not allowed"),
        ({"participant": "a_1"}, "The participant 'a_1' cannot stand in a file name"),
        ({"participant": "a" * 300}, "cannot stand in a file name of the dataset: .* at most 60"),
        ({"session": "1/2"}, "The session '1/2' cannot stand in a file name"),
        ({"protocol": "pairs"}, "No protocol 'pairs'"),
        ({"stimuli": "nowhere"}, "No stimulus set at 'nowhere'"),
        ({"mode": "screen", "observer": SimulatedObserver(1, 1, 1, 1)}, "mode 'screen' is for a person"),
        ({"observer": ""}, "No simulated observer of the kind ''"),
        ({"override": "a dark room"}, "are for the check of a person's screen"),
    ],
)
def test_mistakes_are_told_and_leave_nothing_behind(experiment1, tmp_path, change, message):
    given = {"protocol": "doi", "stimuli": experiment1, "dataset": tmp_path / "a", "participant": "01", **change}
    with pytest.raises(GlossError, match=message) as error:
        run_session(given.pop("protocol"), **given)
    assert "\n" not in str(error.value)
    assert not (tmp_path / "a").exists()


def test_a_dataset_that_is_a_file(experiment1, tmp_path):
    (tmp_path / "a").write_text("a note")
    with pytest.raises(GlossError, match="is a file; give a folder"):
        run_session("doi", stimuli=experiment1, dataset=tmp_path / "a", participant="01")


def test_a_dataset_that_cannot_be_written(experiment1, tmp_path):
    (tmp_path / "a").write_text("a note")
    with pytest.raises(GlossError, match=r"Cannot open the journal .*: Not a directory. Give a dataset folder"):
        run_session("doi", stimuli=experiment1, dataset=tmp_path / "a" / "b", participant="01")


def test_a_data_file_that_cannot_be_written_loses_nothing(experiment1, tmp_path):
    (tmp_path / "data").write_text("a note", encoding="utf-8")
    words = {"stimuli": experiment1, "dataset": tmp_path, "participant": "01"}
    with pytest.raises(
        GlossError, match=r"The 85 answers are safe in the journal .* same command writes the data file"
    ):
        run_session("doi", **words)
    (tmp_path / "data").unlink()
    assert run_session("doi", **words).n_before == 81
    assert len(read_magnitudes(tmp_path, "doi")) == 81


def test_a_missing_option_is_named_where_nobody_can_be_asked(experiment1, tmp_path):
    for words, name in (((), "stimuli"), (("--stimuli", experiment1, "--participant", "01"), "dataset")):
        refused = gloss("doi", *words)
        assert refused.returncode == 2
        assert f"The option --{name} is missing" in refused.stderr
    refused = gloss("doi", "--headless", "--stimuli", experiment1, "--dataset", tmp_path)
    assert "The option --participant is missing" in refused.stderr


def gloss(*words, **environment):
    command = [sys.executable, "-c", "from glossspace.cli import main; main()", "session", *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, check=False, **environment)


def test_the_command(experiment1, tmp_path):
    words = ("doi", "--stimuli", experiment1, "--dataset", tmp_path, "--participant", "01", "--headless")
    first, again = gloss(*words, "--json"), gloss(*words)
    document = json.loads(first.stdout)
    assert (document["participant_id"], document["session"], document["task"]) == ("01", "1", "doi")
    assert (document["trials"], document["simulated"], document["finished"]) == (81, True, True)
    assert document["data"].endswith("subject-01_session-1_task-doi_data.csv")
    assert "finished already" in again.stderr
    assert again.stdout.splitlines()[0] == (
        "Participant 01 (simulated observer), session 1, task doi: 81 of 81 trials."
    )
    assert "Judged trials: 81 (and 4 practice)" in again.stdout
    assert document["summary"]["n_retests"] == 54, "three sequences of 27: each with the one before"
    refused = gloss(*words, "--simulate")
    assert refused.returncode == 2
    assert "not both" in refused.stderr


def test_without_a_display_one_line_says_what_to_do(experiment1, tmp_path):
    words = ("doi", "--stimuli", experiment1, "--dataset", tmp_path / "a", "--participant", "01", "--simulate")
    refused = gloss(*words, env={"PATH": "/usr/bin:/bin"})
    assert refused.returncode == 2
    assert "No display for the session's window" in refused.stderr
    assert "xvfb" in refused.stderr
    assert "Traceback" not in refused.stderr
    assert not (tmp_path / "a").exists()


def test_a_broken_display_is_no_traceback(experiment1, tmp_path):
    words = ("doi", "--stimuli", experiment1, "--dataset", tmp_path / "a", "--participant", "01", "--simulate")
    refused = gloss(*words, env={"PATH": "/usr/bin:/bin", "DISPLAY": ":7654", "HOME": str(tmp_path)})
    assert refused.returncode == 2
    assert "window cannot be opened" in refused.stderr
    assert "Traceback" not in refused.stderr
    assert not (tmp_path / "a").exists()
