"""Frames, the trial's clock, the slider's path and the board of a ranking: arithmetic with clocks passed in."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gloss_experiments.window.frames import FrameRecorder
from gloss_experiments.window.ranking_board import RankingBoard
from gloss_experiments.window.rating_screen import rating_by_key
from gloss_experiments.window.slider_path import n_changes, n_reversals
from gloss_experiments.window.trial_clock import TrialClock


def record(recorder, flips):
    for called_s, returned_s in flips:
        recorder.flipped(called_s=called_s, returned_s=returned_s)


def test_work_is_counted_between_a_flip_and_the_next_and_frames_from_flip_to_flip():
    """Frames of 10, 16 and 10 ms at 100 Hz, after 2, 9 and 1 ms of work: only more than 15 ms is a missed refresh."""
    recorder = FrameRecorder(0.010)
    record(recorder, [(0.000, 0.010), (0.012, 0.020), (0.029, 0.036), (0.037, 0.046)])
    report = recorder.trial()
    assert (report.n_frames, report.n_dropped) == (4, 1)
    assert report.median_work_ms == pytest.approx(2)
    assert report.longest_work_ms == pytest.approx(9)
    assert report.longest_frame_ms == pytest.approx(16)


def test_what_lies_between_trials_and_in_interruptions_is_in_no_frame():
    recorder = FrameRecorder(0.010)
    record(recorder, [(0.001, 0.010), (0.011, 0.020)])
    recorder.begin_trial()
    record(recorder, [(5.001, 5.010), (5.012, 5.020)])
    recorder.interrupt()
    record(recorder, [(9.001, 9.010)])
    assert recorder.trial().n_frames == 3
    assert recorder.trial().longest_frame_ms == pytest.approx(10)
    assert recorder.session().n_frames == 5
    assert recorder.session().longest_work_ms == pytest.approx(2)
    assert recorder.session().n_dropped == 0


def test_a_virtual_display_has_no_frames_to_miss():
    recorder = FrameRecorder(None)
    record(recorder, [(0.0, 0.1), (0.9, 1.0)])
    report = recorder.trial().to_dict()
    assert report["n_dropped"] is report["longest_frame_ms"] is None
    assert report["longest_work_ms"] == pytest.approx(800)
    assert FrameRecorder(0.01).session().to_dict()["median_work_ms"] is None, "no frame, no time"


def test_the_clock_stands_still_in_pauses_also_where_one_ends_with_an_error():
    times = iter([0.0, 4.0, 10.0, 11.0])
    clock = TrialClock(lambda: next(times))
    clock.start()
    with pytest.raises(KeyError), clock.paused():
        raise KeyError
    assert clock.elapsed_s() == 5.0


@given(st.lists(st.integers(0, 100)))
def test_the_path_of_the_slider_by_counting(path):
    """By a second method: turns are the local extremes of the path without standstills."""
    moves = [value for i, value in enumerate(path) if i == 0 or value != path[i - 1]]
    extremes = sum((moves[i] > moves[i - 1]) == (moves[i] > moves[i + 1]) for i in range(1, len(moves) - 1))
    assert n_reversals(path) == extremes
    assert n_changes(path) == len(moves)


def test_typing_and_moving_a_rating():
    def after(*keys, rating=None):
        typed = ""
        for key in keys:
            rating, typed = rating_by_key(key, rating=rating, typed=typed)
        return rating

    assert after("1", "0", "0") == 100
    assert after("1", "0", "1") == 1, "101 is no rating, so a new number begins"
    assert after("0", "7") == 7
    assert after("4", "2", "backspace") == 4
    assert after("4", "backspace") == 4, "a response cannot be unmade"
    assert after("4", "right", "2") == 2, "a number after an arrow is a new one"
    assert after("left", "pageup", "shift+right") is None, "no marker to move before the first response"
    assert after("left", rating=0) == 0
    assert after("pageup", rating=95) == 100
    assert after("x", "return", rating=50) == 50


@given(st.data())
def test_a_board_stays_an_order_of_its_items_whatever_is_done(data):
    items = tuple("abcde")
    board = RankingBoard(items)
    for _ in range(data.draw(st.integers(0, 12))):
        item = data.draw(st.sampled_from(items))
        match data.draw(st.sampled_from(["place", "take back", "move"])):
            case "place":
                index = data.draw(st.integers(0, 6))
                n_others = len([name for name in board.placed if name != item])
                board = board.place(item, index)
                assert board.placed.index(item) == min(index, n_others)
            case "take back":
                board = board.take_back(item)
                assert item in board.waiting
            case "move":
                before = board.placed
                board = board.move(item, data.draw(st.integers(-2, 2)))
                others = tuple(name for name in before if name != item)
                assert tuple(name for name in board.placed if name != item) == others, "the others keep their order"
        assert sorted(board.placed + board.waiting) == sorted(items)
        assert board.complete == (len(board.placed) == 5)
