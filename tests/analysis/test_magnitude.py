"""Magnitude estimates and their regression."""

import statistics

import numpy as np
import pandas as pd
import pytest

from gloss_analysis.magnitude import mean_ratings, regress_ratings
from glossspace.errors import GlossError


def ratings(table):
    rows = [
        (participant, stimulus, repeat, rating)
        for participant, columns in table.items()
        for stimulus, values in columns.items()
        for repeat, rating in enumerate(values, start=1)
    ]
    return pd.DataFrame(rows, columns=["participant_id", "stimulus", "repeat", "rating"])


def test_ranges_are_equalised_before_averaging():
    # By hand: means over repeats are (0, 20) and (40, 80); both get mean 35 and standard deviation 15.
    found = mean_ratings(ratings({"1": {"a": [0, 0], "b": [10, 30]}, "2": {"a": [40, 40], "b": [80, 80]}}))
    assert found["stimulus"].tolist() == ["a", "b"]
    assert found["rating"].tolist() == pytest.approx([20, 50], rel=1e-12)
    assert found["standard_error"].tolist() == pytest.approx([0, 0], abs=1e-12)


def test_a_constant_participant_is_moved_and_nothing_is_divided_by_zero():
    found = mean_ratings(ratings({"1": {"a": [0], "b": [40]}, "2": {"a": [50], "b": [50]}}))
    assert np.all(np.isfinite(found["rating"]))


def test_one_participant_has_no_standard_error():
    assert mean_ratings(ratings({"1": {"a": [3], "b": [4]}}))["standard_error"].isna().all()


def test_an_unfinished_participant_is_named():
    with pytest.raises(GlossError, match="Participant 2 has no rating of the stimulus b"):
        mean_ratings(ratings({"1": {"a": [1], "b": [2]}, "2": {"a": [1]}}))


def test_line_and_r_squared_agree_with_the_standard_library():
    rng = np.random.default_rng(0)
    x = np.linspace(0, 1, 11)
    y = 20 + 60 * x + 4 * rng.standard_normal(11)
    fit = regress_ratings(x, y)
    expected = statistics.linear_regression(x.tolist(), y.tolist())
    assert (fit.slope, fit.intercept) == pytest.approx((expected.slope, expected.intercept), rel=1e-10)
    assert fit.r_squared == pytest.approx(statistics.correlation(x.tolist(), y.tolist()) ** 2, rel=1e-10)
    assert fit.slope_ci95[0] < fit.slope < fit.slope_ci95[1]


def test_polynomials_find_curvature_where_there_is_some():
    x = np.linspace(0, 1, 11)
    curved = regress_ratings(x, x**2)
    assert curved.polynomial_r_squared == pytest.approx((1, 1), abs=1e-12)
    assert curved.r_squared < 0.95
    straight = regress_ratings(x, 3 * x)
    assert max(straight.polynomial_r_squared) - straight.r_squared < 1e-12


@pytest.mark.parametrize(
    ("x", "message"),
    [([1, 1, 2, 2], "3 different positions along the axis, but got 2"), ([1, 2, np.nan, 4], "needs finite")],
)
def test_what_cannot_be_regressed_is_refused(x, message):
    with pytest.raises(GlossError, match=message):
        regress_ratings(np.array(x), np.arange(4.0))
