"""Whole sessions of designs with practice, catch trials, rankings, pilots and several days."""

from dataclasses import replace

import pytest

from gloss_experiments import SimulatedObserver, run_session
from gloss_experiments.session.journal import Journal
from gloss_experiments.session.plan import plan_session
from glossspace.dataset import read_dissimilarities, read_magnitudes, read_rankings, read_simulated_observers
from glossspace.errors import GlossError
from glossspace.stimulus_set import read_stimulus_set
from tests.experiments.session_files import data_of, lines_of, rows_of, with_design


def test_practice_and_catch_trials_are_in_the_journal_alone(experiment1, tmp_path):
    told = []
    protocol = with_design("pairwise", practice=5, catch_trials=8)
    result = run_session(
        protocol, stimuli=experiment1, dataset=tmp_path, participant="01", on_trial=lambda *counts: told.append(counts)
    )
    assert (result.n_trials, result.n_answered) == (386, 386), "practice does not count"
    assert told == [(0, 386)] * 5 + [(i, 386) for i in range(1, 387)]
    roles = [line["role"] for line in lines_of(result.journal_path) if line["type"] == "trial"]
    assert [roles.count(role) for role in ("practice", "judged", "catch")] == [5, 378, 8]
    assert roles[:5] == ["practice"] * 5
    rows = rows_of(result.data_path)
    assert len(rows) == 378
    assert len(read_dissimilarities(tmp_path)) == 378
    plain = run_session(
        with_design("pairwise", practice=0), stimuli=experiment1, dataset=tmp_path / "b", participant="01"
    )
    sides = ("stimulus_left", "stimulus_right")
    assert [[row[side] for side in sides] for row in rows] == [
        [row[side] for side in sides] for row in rows_of(plain.data_path)
    ], "the order of the judged trials is the same"
    assert (result.summary.n_practice, result.summary.n_catch, result.summary.n_retests) == (5, 8, 4)


def test_a_session_is_resumed_in_the_middle_of_its_practice(experiment1, tmp_path):
    def interrupt(done, total):
        calls.append(done)
        if len(calls) == 2:
            raise KeyboardInterrupt

    calls = []
    with pytest.raises(KeyboardInterrupt):
        run_session("doi", stimuli=experiment1, dataset=tmp_path / "a", participant="01", on_trial=interrupt)
    assert run_session("doi", stimuli=experiment1, dataset=tmp_path / "a", participant="01").n_before == 0
    run_session("doi", stimuli=experiment1, dataset=tmp_path / "b", participant="01")
    assert data_of(tmp_path / "a") == data_of(tmp_path / "b")


def test_a_ranking_is_read_as_ranks(experiment1, tmp_path):
    """A noiseless observer ranks by eq. 5 of the gloss paper: worked out here for each stimulus."""
    observer = SimulatedObserver(weight_c=1.0, weight_d=1.78, exponent=1.0, noise_sd=0.0)
    result = run_session("ranking", stimuli=experiment1, dataset=tmp_path, participant="01", observer=observer)
    assert (result.n_trials, len(rows_of(result.data_path))) == (2, 12)
    ranks = read_rankings(tmp_path, "ranking")
    assert ranks.columns.tolist() == ["participant_id", "stimulus", "rank", "repeat", "reference"]
    table = read_stimulus_set(experiment1).table().set_index("stimulus")
    reference = table.loc["d0.767_s0.033_a0.1"]
    distance = ((table["c"] - reference["c"]) ** 2 + (1.78 * (table["d"] - reference["d"])) ** 2) ** 0.5
    for _, one in ranks.groupby("repeat"):
        assert one.sort_values("rank")["stimulus"].tolist() == distance[one["stimulus"]].sort_values().index.tolist()
        assert sorted(one["rank"]) == [1, 2, 3, 4, 5, 6]
    assert result.summary.retest_r == pytest.approx(1.0)
    with pytest.raises(GlossError, match="holds no rank of the task 'doi'; its ranking tasks are: ranking"):
        read_rankings(tmp_path, "doi")


def test_a_pilot_is_kept_apart_from_the_data(experiment1, tmp_path):
    pilot = run_session("doi", stimuli=experiment1, dataset=tmp_path, participant="01", pilot=True)
    assert pilot.pilot
    assert pilot.data_path.is_relative_to(tmp_path / "pilots")
    assert lines_of(pilot.journal_path)[0]["pilot"] is True
    assert {row["pilot"] for row in rows_of(pilot.data_path)} == {"yes"}
    with pytest.raises(GlossError, match="is no dataset"):
        read_magnitudes(tmp_path, "doi")
    real = run_session("doi", stimuli=experiment1, dataset=tmp_path, participant="01")
    assert real.n_before == 0, "a session does not go on where its pilot was"
    assert len(read_magnitudes(tmp_path, "doi")) == 81
    assert "pilot" not in rows_of(real.data_path)[0]
    # Moved among the data, it is still not taken for one.
    pilot.data_path.rename(real.data_path.with_name("subject-01_session-2_task-doi_data.csv"))
    with pytest.raises(GlossError, match="pilot"):
        read_magnitudes(tmp_path, "doi")


def test_a_design_split_over_days(experiment1, small_set, tmp_path):
    protocol = with_design("pairwise", sessions=3)
    words = {"stimuli": experiment1, "dataset": tmp_path, "participant": "01"}
    first = run_session(protocol, session=1, seed=7, **words)
    second = run_session(protocol, session=2, **words)
    assert (first.n_trials, second.n_trials, second.seed) == (126, 126, 7), "the seed that the first began with"
    with pytest.raises(GlossError, match=r"Session 1 of participant '01' .* had another seed"):
        run_session(protocol, session=3, seed=8, **words)
    with pytest.raises(GlossError, match="had another protocol_sha256"):
        run_session(with_design("pairwise", sessions=4), session=3, **words)
    with pytest.raises(GlossError, match="had another stimuli_sha256"):
        run_session(protocol, session=3, **(words | {"stimuli": small_set}))
    same = read_stimulus_set(experiment1)
    turned = replace(same, stimuli=same.stimuli[::-1])  # the very same images
    with pytest.raises(GlossError, match="had the stimuli of the set in another order"):
        run_session(protocol, session=3, **(words | {"stimuli": turned}))
    with pytest.raises(GlossError, match="a number from 1 to 3, not '4'"):
        run_session(protocol, session=4, **words)
    assert not list(tmp_path.rglob("*session-[34]*"))
    run_session(protocol, session=3, **words)
    pairs = read_dissimilarities(tmp_path)
    assert len(pairs) == 378, "together the whole design"
    assert not pairs.duplicated(["stimulus_a", "stimulus_b"]).any()


def test_no_simulated_answer_is_without_its_name(small_set, tmp_path, monkeypatch):
    """A kill before the header is written leaves the observer noted, so that its answers never pass for a person's."""

    def killed(journal, header):
        raise KeyboardInterrupt

    monkeypatch.setattr(Journal, "begin", killed)
    with pytest.raises(KeyboardInterrupt):
        run_session("doi", stimuli=small_set, dataset=tmp_path, participant="01")
    assert read_simulated_observers(tmp_path)["participant_id"].tolist() == ["01"]


def test_no_two_sessions_share_their_simulated_errors(small_set, tmp_path):
    words = {"stimuli": small_set, "dataset": tmp_path, "mode": "headless", "observer": None, "pilot": False}
    sessions = [(*who, seed) for who in (("01", "1"), ("01", "2"), ("02", "1")) for seed in (0, 1)]
    seeds = {
        plan_session(task, participant=name, session=session, seed=seed, **words).judge_seed
        for task in ("doi", "pairwise")
        for name, session, seed in sessions
    }
    assert len(seeds) == 12
