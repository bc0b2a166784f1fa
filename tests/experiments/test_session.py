import pytest
from hypothesis import given
from hypothesis import strategies as st

from gloss_experiments.design import Trial
from gloss_experiments.session.state import (
    Answer,
    Confirmed,
    Continued,
    OrderChosen,
    Phase,
    RatingChosen,
    TimedOut,
    Trace,
    advance,
    checked_rating,
    start_session,
)
from glossspace.errors import GlossError

TRIALS = (Trial(1, 1, 1, ("a", "b")), Trial(2, 1, 1, ("b", "b")), Trial(3, 2, 2, ("b", "a")))

PRACTICE = Trial(1, 1, 1, ("b", "a"), "practice")
RANKING = Trial(1, 1, 1, ("reference", "a", "b", "c"))

events = st.one_of(
    st.builds(RatingChosen, st.integers(0, 100)),
    st.builds(OrderChosen, st.permutations(["a", "b"]).map(tuple)),
    st.builds(Confirmed, st.none() | st.floats(0, 100)),
    st.builds(TimedOut, st.floats(0, 100)),
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
            assert isinstance(event, Confirmed | TimedOut)
            assert after.last_answer.rating == (state.rating if isinstance(event, Confirmed) else None)
            assert after.last_answer.timed_out == isinstance(event, TimedOut)
            answers.append(after.last_answer)
        assert (after.phase is Phase.DONE) == (after.n_answered == len(TRIALS))
        assert after.rating is None or after.phase is Phase.RATING
        state = after
    assert [answer.trial for answer in answers] == list(TRIALS[: len(answers)])


def test_a_preview_comes_after_the_instructions():
    state = start_session(TRIALS, preview=True)
    phases = [state.phase]
    for _ in range(3):
        state = advance(state, Continued())
        phases.append(state.phase)
    assert phases == [Phase.READY, Phase.PREVIEW, Phase.RATING, Phase.RATING]


def test_practice_comes_first_and_does_not_count():
    state = start_session((PRACTICE, PRACTICE, *TRIALS))
    assert state.progress == (0, 3)
    rate = (RatingChosen(1), Confirmed())
    state = run(state, Continued(), *rate)
    assert (state.phase, state.progress) == (Phase.RATING, (0, 3))
    state = run(state, *rate)
    assert (state.phase, state.trial, state.progress) == (Phase.PRACTICE_DONE, TRIALS[0], (0, 3))
    state = run(state, Continued(), *rate)
    assert (state.phase, state.progress) == (Phase.RATING, (1, 3))


def test_breaks_come_every_so_many_trials_of_a_block():
    trials = [Trial(i, 1 + (i > 7), 1, ("a", "b"), "catch" if i == 2 else "judged") for i in range(1, 15)]
    state = run(start_session((PRACTICE, PRACTICE, PRACTICE, *trials), break_every=3), Continued())
    pauses = []
    while state.phase is not Phase.DONE:
        if state.phase is Phase.PAUSE:
            pauses.append(state.progress[0])
        state = run(state, Continued(), RatingChosen(5), Confirmed())
    assert pauses == [3, 6, 7, 10, 13], "7 is the end of a block, from which the count begins anew"


def test_a_ranking_is_confirmed_with_an_order():
    state = run(start_session((RANKING,)), Continued(), RatingChosen(5), Confirmed())
    assert (state.phase, state.rating, state.order) == (Phase.RATING, None, None), "a rating is none"
    state = run(state, OrderChosen(("c", "a", "b")), OrderChosen(("c", "b", "a")))
    trace = Trace(first_response_s=1.0, n_changes=3)
    done = run(state, Confirmed(9.0, trace))
    assert done.phase is Phase.DONE
    assert done.last_answer == Answer(RANKING, None, 9.0, order=("c", "b", "a"), trace=trace)
    for order in (("a", "b"), ("a", "b", "b"), ("a", "b", "c", "reference"), ("a", "b", "d")):
        with pytest.raises(GlossError, match="is not allowed; it names each of a, b, c once"):
            run(state, OrderChosen(order))


def test_time_that_is_up_leaves_no_answer():
    trace = Trace(n_changes=1, lowest=40, highest=40)
    state = run(start_session(TRIALS), Continued(), RatingChosen(40), TimedOut(5.0, trace))
    assert state.last_answer == Answer(TRIALS[0], None, 5.0, trace=trace, timed_out=True)
    assert (state.phase, state.trial, state.rating) == (Phase.RATING, TRIALS[1], None)
    assert run(start_session((RANKING,)), Continued(), TimedOut(5.0)).last_answer.order is None


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
