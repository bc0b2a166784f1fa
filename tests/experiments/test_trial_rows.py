from gloss_experiments.design import Trial
from gloss_experiments.session.state import Answer, Trace
from gloss_experiments.session.trial_rows import trial_rows

TRACE = Trace(0.71234, n_changes=3, n_reversals=1, lowest=20, highest=60, n_frames=90, n_dropped=2)


def test_practice_and_catch_trials_are_no_data():
    roles = ("practice", "judged", "catch", "judged")
    answers = [Answer(Trial(i, 1, 1, ("a", "b"), role), 10 * i) for i, role in enumerate(roles, start=1)]
    rows = trial_rows(answers, kind="pairwise", simulated=False)
    assert [(row["trial"], row["dissimilarity"]) for row in rows] == [(2, 20), (4, 40)]


def test_how_an_answer_came_about():
    (row,) = trial_rows(
        [Answer(Trial(5, 2, 1, ("b", "a")), 40, 3.14159, trace=TRACE)], kind="pairwise", simulated=False
    )
    assert row == {
        **{"block": 2, "trial": 5, "repeat": 1, "stimulus_left": "b", "stimulus_right": "a", "dissimilarity": 40},
        **{"response_time_s": 3.142, "timed_out": "no", "first_response_s": 0.712},
        **{"n_changes": 3, "n_reversals": 1, "dropped_frames": 2},
    }


def test_no_hand_moved_the_slider_of_a_simulated_observer():
    """A scripted mouse has a path and a time too, which say nothing: rows are those of a session without a window."""
    trial = Trial(1, 1, 1, ("a",))
    with_window = trial_rows([Answer(trial, 40, 0.1, trace=TRACE)], kind="magnitude", simulated=True)
    assert with_window == trial_rows([Answer(trial, 40)], kind="magnitude", simulated=True)


def test_time_that_was_up():
    (row,) = trial_rows([Answer(Trial(1, 1, 1, ("a",)), None, 5.0, timed_out=True)], kind="magnitude", simulated=False)
    assert (row["rating"], row["timed_out"], row["response_time_s"]) == (None, "yes", 5.0)


def test_a_ranking_has_a_row_a_stimulus():
    trial = Trial(1, 1, 1, ("reference", "b", "c", "a"))
    rows = trial_rows([Answer(trial, None, order=("a", "b", "c"))], kind="ranking", simulated=False)
    assert [(row["reference"], row["stimulus"], row["start_place"], row["rank"]) for row in rows] == [
        ("reference", "b", 1, 2),
        ("reference", "c", 2, 3),
        ("reference", "a", 3, 1),
    ]
    unfinished = trial_rows([Answer(trial, None, timed_out=True)], kind="ranking", simulated=False)
    assert [row["rank"] for row in unfinished] == [None, None, None]
