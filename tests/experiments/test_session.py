import pytest
from hypothesis import given
from hypothesis import strategies as st

from gloss_experiments.design import Trial
from gloss_experiments.session import (
    Answer,
    Confirmed,
    Continued,
    Phase,
    RatingChosen,
    advance,
    checked_rating,
    start_session,
)
from glossspace.errors import GlossError

TRIALS = (Trial(1, 1, 1, ("a", "b")), Trial(2, 1, 1, ("b", "b")), Trial(3, 2, 2, ("b", "a")))

events = st.one_of(
    st.builds(RatingChosen, st.integers(0, 100)),
    st.builds(Confirmed, st.none() | st.floats(0, 100)),
    st.just(Continued()),
)


def run(state, *sequence):
    for event in sequence:
        state = advance(state, event)
    return state


def test_a_session_from_start_to_end():
    state = start_session(TRIALS)
    assert state.phase is Phase.READY
    state = run(state, Continued(), RatingChosen(10), RatingChosen(30), Confirmed(1.5))
    assert (state.phase, state.trial, state.rating) == (Phase.RATING, TRIALS[1], None)
    assert state.last_answer == Answer(TRIALS[0], rating=30, response_time_s=1.5)
    state = run(state, RatingChosen(0), Confirmed())
    assert (state.phase, state.n_answered) == (Phase.PAUSE, 2), "a pause comes between two blocks"
    state = run(state, Continued(), RatingChosen(100), Confirmed())
    assert (state.phase, state.trial, state.n_answered) == (Phase.DONE, None, 3)


def test_nothing_is_confirmed_before_a_response():
    state = run(start_session(TRIALS), Continued())
    assert run(state, Confirmed(), Continued()) == state


def test_a_rating_before_the_trial_is_shown_means_nothing():
    state = start_session(TRIALS)
    assert run(state, RatingChosen(50), Confirmed()) == state


def test_a_resumed_session_begins_with_the_instructions():
    state = start_session(TRIALS, n_answered=2)
    assert (state.phase, state.trial) == (Phase.READY, TRIALS[2])
    assert start_session(TRIALS, n_answered=3).phase is Phase.DONE


@pytest.mark.parametrize(("trials", "n_answered"), [((), 0), (TRIALS, 4), (TRIALS, -1)])
def test_impossible_starts(trials, n_answered):
    with pytest.raises(ValueError, match="n_answered from 0 to"):
        start_session(trials, n_answered=n_answered)


@given(st.lists(events, max_size=40))
def test_whatever_comes_trials_are_answered_in_order_once(sequence):
    state, answers = start_session(TRIALS), []
    for event in sequence:
        after = advance(state, event)
        assert after.n_answered - state.n_answered in (0, 1)
        if after.n_answered > state.n_answered:
            assert isinstance(event, Confirmed)
            assert after.last_answer.rating == state.rating
            answers.append(after.last_answer)
        assert (after.phase is Phase.DONE) == (after.n_answered == len(TRIALS))
        assert after.rating is None or after.phase is Phase.RATING
        state = after
    assert [answer.trial for answer in answers] == list(TRIALS[: len(answers)])


@given(st.lists(events, max_size=20), events)
def test_advance_is_a_function(sequence, event):
    state = run(start_session(TRIALS), *sequence)
    assert advance(state, event) == advance(state, event)


@given(st.integers(0, 100))
def test_every_whole_number_of_the_slider_is_a_rating(value):
    assert checked_rating(value) == value


@given(
    st.integers(max_value=-1)
    | st.integers(min_value=101)
    | st.floats()
    | st.text(max_size=5)
    | st.none()
    | st.booleans()
)
def test_nothing_else_is(value):
    with pytest.raises(GlossError, match="is not allowed; it is a whole number from 0 to 100"):
        checked_rating(value)
    with pytest.raises(GlossError, match="whole number from 0 to 100"):
        run(start_session(TRIALS), Continued(), RatingChosen(value))
