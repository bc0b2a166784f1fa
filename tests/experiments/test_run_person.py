"""A person's session: the check of the screen, how answers came about, and what is asked at a terminal."""

import contextlib
import io
import json
import sys

import pytest

import gloss_experiments.preflight.preflight
import gloss_experiments.session.run
import gloss_experiments.window.dialog
from gloss_experiments import run_session
from gloss_experiments.commands.session import session as session_command
from gloss_experiments.preflight.preflight import Preflight, Row
from gloss_experiments.session.state import Confirmed, Continued, Phase, RatingChosen, TimedOut, Trace
from glossspace.dataset import read_magnitudes, validate_dataset
from glossspace.errors import GlossError
from tests.experiments.session_files import lines_of, rows_of


def test_a_person_may_leave_an_interrupted_session_as_it_is(experiment1, tmp_path):
    def interrupt(done, total):
        if done == 9:
            raise KeyboardInterrupt

    def no(done, total):
        asked.append((done, total))
        return False

    asked = []
    words = {"stimuli": experiment1, "dataset": tmp_path, "participant": "01"}
    with pytest.raises(KeyboardInterrupt):
        run_session("doi", on_trial=interrupt, on_resume=no, **words)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*.jsonl")}
    result = run_session("doi", on_resume=no, **words)
    assert (result.n_answered, result.data_path, asked) == (9, None, [(9, 81)])
    assert {path: path.read_bytes() for path in tmp_path.rglob("*.jsonl")} == before
    assert run_session("doi", on_resume=lambda done, total: True, **words).n_answered == 81


class Person:
    """Stands in for the window and the person before it: rates 40 in two seconds, and lets every tenth trial pass."""

    window = None
    refresh_s = None

    def __init__(self, stop_after=1000):
        self.stop_after = stop_after
        self.thanked_with, self.data_before_thanks = None, None
        self.dataset = None

    def next_event(self, state):
        if state.n_answered == self.stop_after:
            return None
        if state.phase is not Phase.RATING:
            return Continued()
        if state.trial.number % 10 == 0:
            return TimedOut(6.0, Trace(n_frames=360, n_dropped=1))
        if state.rating is None:
            return RatingChosen(40)
        return Confirmed(2.0, Trace(0.8, n_changes=2, n_reversals=1, lowest=30, highest=40, n_frames=120, n_dropped=0))

    def finish(self, state, summary=()):
        self.thanked_with = summary
        self.data_before_thanks = [path.name for path in self.dataset.rglob("*_data.csv")]

    def frame_report(self):
        return None


@pytest.fixture
def person(monkeypatch, tmp_path):
    """A person at a screen in whose check one thing is off."""
    person = Person()
    person.dataset = tmp_path
    off = Row(name="frame rate", found="59 Hz", expected="75 Hz", verdict="refused")

    def check_screen(window, protocol, stimulus_set, *, refresh_s, calibration=None, override=None):
        return Preflight(rows=(off,), override=override)

    monkeypatch.setattr(gloss_experiments.preflight.preflight, "check_screen", check_screen)
    monkeypatch.setattr(
        gloss_experiments.session.run, "open_presenter", lambda *given, **named: contextlib.nullcontext(person)
    )
    return person


def test_a_screen_that_is_off_is_refused_unless_a_reason_is_given(experiment1, tmp_path, person):
    words = {"stimuli": experiment1, "dataset": tmp_path / "a", "participant": "01", "mode": "screen"}
    shown = []
    with pytest.raises(GlossError, match="The screen is not as it must be .*59 Hz.* --override"):
        run_session("doi", on_preflight=shown.append, **words)
    assert "REFUSED" in shown[0].table()
    assert not (tmp_path / "a").exists(), "a session that could not begin leaves nothing behind"
    person.stop_after = 20
    run_session("doi", override="our screen has no other", **words)
    person.stop_after = 1000
    result = run_session("doi", override="nor today", **words)
    header, *lines = lines_of(result.journal_path)
    resumed = next(line for line in lines if line["type"] == "resumed")
    assert header["preflight"]["override"] == "our screen has no other"
    assert (header["preflight"]["refused"], resumed["preflight"]["override"]) == (["frame rate"], "nor today")


def test_how_a_person_answered_is_in_the_data(experiment1, tmp_path, person):
    words = {"stimuli": experiment1, "dataset": tmp_path, "participant": "01", "mode": "screen"}
    result = run_session("doi", override="a test", **words)
    rows = rows_of(result.data_path)
    assert len(rows) == 81
    passed = [row for row in rows if row["timed_out"] == "yes"]
    assert [row["trial"] for row in passed] == ["10", "20", "30", "40", "50", "60", "70", "80"]
    assert {(row["rating"], row["response_time_s"], row["dropped_frames"]) for row in passed} == {("", "6.0", "1")}
    process = (
        "rating",
        "response_time_s",
        "first_response_s",
        "n_changes",
        "n_reversals",
        "dropped_frames",
        "observer",
    )
    assert {tuple(row[name] for name in process) for row in rows if row["timed_out"] == "no"} == {
        ("40", "2.0", "0.8", "2", "1", "0", "human")
    }
    assert len(read_magnitudes(tmp_path, "doi")) == 73, "what was not judged is no judgement"
    validate_dataset(tmp_path)
    trial = next(line for line in lines_of(result.journal_path) if line["type"] == "trial" and line["role"] == "judged")
    assert trial["trace"] == {
        **{"first_response_s": 0.8, "n_changes": 2, "n_reversals": 1, "lowest": 30, "highest": 40},
        **{"n_frames": 120, "n_dropped": 0, "longest_frame_ms": None},
    }
    header = lines_of(result.journal_path)[0]
    manifest = json.loads((experiment1 / "manifest.json").read_text(encoding="utf-8"))
    assert header["stimulus_sha256"] == {one["name"]: one["sha256"]["image"] for one in manifest["stimuli"]}
    assert (result.summary.n_timed_out, result.summary.median_time_s) == (8, 2.0)
    assert person.data_before_thanks == ["subject-01_session-1_task-doi_data.csv"]
    assert person.thanked_with[0] == "Judged trials: 81 (and 4 practice)"


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.mark.parametrize(("typed", "n_answered"), [("n\n", 16), ("\n", 81), ("y\n", 81), ("", 81)])
def test_a_person_at_a_terminal_is_asked_before_a_session_goes_on(
    experiment1, tmp_path, person, monkeypatch, capsys, typed, n_answered
):
    words = {"stimuli": experiment1, "dataset": tmp_path, "participant": "01", "override": "a test"}
    person.stop_after = 20  # 4 of them practice
    session_command("doi", **words)
    person.stop_after = 1000
    capsys.readouterr()
    monkeypatch.setattr(sys, "stdin", Terminal(typed))
    # Without a terminal for the question, there is none; with one, it is put there.
    monkeypatch.setattr(sys, "stderr", terminal := Terminal())
    session_command("doi", json=True, **words)
    assert "Go on after 16 of 81 trials? [Y/n]" in terminal.getvalue()
    document = json.loads(capsys.readouterr().out)
    assert (document["judged"], document["finished"]) == (n_answered, n_answered == 81)


def test_without_a_terminal_nobody_is_asked(experiment1, tmp_path, person, capsys):
    words = {"stimuli": experiment1, "dataset": tmp_path, "participant": "01", "override": "a test"}
    person.stop_after = 20
    session_command("doi", **words)
    person.stop_after = 1000
    session_command("doi", **words)
    written = capsys.readouterr()
    assert "Go on" not in written.err
    assert "81 of 81 trials" in written.out


def test_a_dialog_asks_a_person_for_what_is_missing(experiment1, tmp_path, person, monkeypatch, capsys):
    filled_in = {"stimuli": str(experiment1), "dataset": str(tmp_path), "participant": "07", "session": "2"}
    asked = []

    def ask_details(known):
        asked.append(dict(known))
        return answer

    monkeypatch.setattr(gloss_experiments.window.dialog, "ask_details", ask_details)
    monkeypatch.setattr(sys, "stdin", Terminal())
    monkeypatch.setattr(sys, "stderr", Terminal())
    answer = filled_in
    session_command("doi", stimuli=experiment1, override="a test", json=True)
    assert asked == [{"stimuli": str(experiment1), "dataset": None, "participant": None, "session": None}]
    document = json.loads(capsys.readouterr().out)
    assert (document["participant_id"], document["session"], document["simulated"]) == ("07", "2", False)
    answer = None
    with pytest.raises(GlossError, match="The dialog was cancelled; no session was begun"):
        session_command("doi", stimuli=experiment1)
