import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from gloss_experiments.design import Trial
from gloss_experiments.session.state import Answer, Trace
from gloss_experiments.session.summary import summarise, summary_lines


def answer(stimuli, rating, time_s=None, *, role="judged", number=1, **more):
    return Answer(Trial(number, 1, 1, stimuli, role), rating, time_s, **more)


def test_the_numbers_by_hand():
    summary = summarise(
        [
            answer(("a", "b"), 90, 0.1, role="practice"),
            answer(("a", "b"), 40, 4.0),
            answer(("a", "a"), 10, 0.4),
            answer(("b", "a"), 46, 1.0, role="catch"),
            answer(("c", "b"), 80, 6.0),
            answer(("c", "c"), 0, 2.0),
            answer(("b", "b"), 7, 1.0, role="catch"),
            answer(("c", "a"), None, 9.0, timed_out=True, trace=Trace()),
            answer(("b", "d"), None, 9.0, timed_out=True, trace=Trace(n_changes=1, lowest=3, highest=3)),
        ]
    )
    assert (summary.n_judged, summary.n_practice, summary.n_catch) == (6, 1, 2)
    assert summary.median_time_s == 5.0, "of 4, .4, 6, 2, 9 and 9; practice and catch trials are left out"
    assert summary.share_fast == pytest.approx(1 / 6)
    assert (summary.identical_mean, summary.different_mean) == (5.0, 60.0)
    assert (summary.n_retests, summary.retest_r) == (1, None), "a correlation of one pair says nothing"
    assert (summary.catch_difference, summary.catch_identical_mean) == (6.0, 7.0)
    assert (summary.n_timed_out, summary.n_without_response, summary.n_distinct) == (2, 1, 4)
    assert summary_lines(summary) == [
        "Judged trials: 6 (and 1 practice, 2 catch)",
        "Time per trial: median 5.0 s; under 0.5 s in 17%",
        "Mean rating of identical pairs: 5.0; of different pairs 60.0",
        "Test–retest of 1 answers: r = –",
        "Catch trials: repeated ones differ by 6.0 on average",
        "Catch trials: mean rating of identical pairs 7.0",
        "Time limit passed in 2, in 1 without a response",
    ]


@given(st.lists(st.tuples(*[st.integers(0, 100)] * 3), min_size=3, max_size=12))
def test_retest_is_pearson_s_correlation_of_each_showing_with_the_one_before(ratings):
    names = [f"s{i}" for i in range(len(ratings))]
    blocks = [[answer((name,), row[k]) for name, row in zip(names, ratings, strict=True)] for k in range(3)]
    summary = summarise([one for block in blocks for one in block])
    before, after = (np.array([row[k] for k in ks for row in ratings]) for ks in ((0, 1), (1, 2)))
    assert summary.n_retests == 2 * len(ratings)
    if np.ptp(before) == 0 or np.ptp(after) == 0:
        assert summary.retest_r is None, "no correlation with a constant"
    else:
        # Two ways of summing some 24 whole numbers to 100: rounding alone, and far below a printed digit.
        assert summary.retest_r == pytest.approx(stats.pearsonr(before, after).statistic, abs=1e-9)


@given(st.permutations("abcdef"), st.permutations("abcdef"))
def test_retest_of_rankings_is_spearman_s_correlation(first, second):
    trial = Trial(1, 1, 1, ("reference", *"abcdef"))
    summary = summarise([Answer(trial, None, order=tuple(order)) for order in (first, second)])
    ranks = [[order.index(item) for item in "abcdef"] for order in (first, second)]
    # Six ranks: rounding alone.
    assert summary.retest_r == pytest.approx(stats.spearmanr(*ranks).statistic, abs=1e-9)
    assert summary.n_distinct is None


def test_identical_pairs_do_not_lend_a_retest_their_zeros():
    answers = [answer(pair, rating) for rating in (0, 1) for pair in (("a", "a"), ("b", "b"), ("c", "c"))]
    assert summarise(answers).n_retests == 0


def test_an_observer_who_leaves_the_slider_alone_is_told_of():
    lines = summary_lines(summarise([answer((name,), 50, 1.0) for name in "abc"]))
    assert "All ratings are the same: was the slider used?" in lines


def test_nothing_answered_yet():
    summary = summarise([])
    assert (summary.n_judged, summary.median_time_s, summary.retest_r) == (0, None, None)
    assert summary_lines(summary) == ["Judged trials: 0"]
