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


@pytest.mark.parametrize("constant", [50, 33.3])
def test_a_constant_participant_is_only_moved(constant):
    # By hand: means 20 and `constant`, hence (20 + constant) / 2 for both; the one who varied keeps the range of 40, so
    # the mean over both has 20. Three times 33.3 has a standard deviation of 7e-15, which must not be stretched.
    table = {"1": {"a": [0], "b": [20], "c": [40]}, "2": {"a": [constant], "b": [constant] * 3, "c": [constant]}}
    level = (20 + constant) / 2
    assert mean_ratings(ratings(table))["rating"].tolist() == pytest.approx([level - 10, level, level + 10], rel=1e-12)


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
    # Student's interval written out: residual variance over 9 degrees of freedom; t(.975, 9) = 2.262157 from tables.
    residual = y - fit.intercept - fit.slope * x
    half = 2.262157 * np.sqrt(np.sum(residual**2) / 9 / np.sum((x - x.mean()) ** 2))
    assert fit.slope_ci95 == pytest.approx((fit.slope - half, fit.slope + half), rel=1e-6)  # seven digits of t


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


def test_equal_ratings_are_refused():
    with pytest.raises(GlossError, match="All ratings are 100: there is no relation"):
        regress_ratings(np.arange(4.0), np.full(4, 100.0))
