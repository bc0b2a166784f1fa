"""How sure regressions of ratings are."""

import numpy as np
import pandas as pd
import pytest
from scipy.stats import t

from gloss_analysis.ratings.rating_uncertainty import line_band, r_squared_interval
from glossspace.errors import GlossError


def test_the_band_is_that_of_the_covariance_matrix():
    """Independent route: variance of a'beta with beta's covariance from the normal equations; t(8) = 2.306004."""
    rng = np.random.default_rng(1)
    x = rng.uniform(0, 1, 10)
    y = 3 + 40 * x + rng.standard_normal(10)
    design = np.column_stack([np.ones(10), x])
    beta, rest, *_ = np.linalg.lstsq(design, y, rcond=None)
    covariance = np.linalg.inv(design.T @ design) * rest[0] / 8
    at = np.array([0.0, 0.4, 2.0])
    points = np.column_stack([np.ones(3), at])
    half = 2.306004135204166 * np.sqrt(np.einsum("ij,jk,ik->i", points, covariance, points))
    low, high = line_band(x, y, at)
    # Both are exact but for rounding of numbers up to a hundred.
    assert low == pytest.approx(points @ beta - half, abs=1e-9)
    assert high == pytest.approx(points @ beta + half, abs=1e-9)


def test_the_band_covers_what_it_states():
    rng = np.random.default_rng(2)
    x = np.linspace(0, 1, 11)
    hits = 0
    for _ in range(2000):
        low, high = line_band(x, 5 + 2 * x + rng.standard_normal(11), [0.3])
        hits += bool(low[0] < 5.6 < high[0])
    # 95 % of 2,000 with four binomial standard errors, of .0049 each.
    assert abs(hits / 2000 - 0.95) < 0.0195


@pytest.mark.parametrize(("x", "y"), [([1, 2], [1, 2]), ([1, 1, 1], [1, 2, 3])])
def test_too_few_positions_for_a_band(x, y):
    with pytest.raises(GlossError, match="three stimuli at different positions"):
        line_band(x, y, [1])


def ratings(rows):
    return pd.DataFrame(
        [(str(k), f"s{i}", value) for k, own in enumerate(rows) for i, value in enumerate(own)],
        columns=["participant_id", "stimulus", "rating"],
    )


def place(n):
    return pd.Series(np.linspace(0, 1, n), index=[f"s{i}" for i in range(n)])


def test_r_squared_is_surer_with_more_participants():
    rng = np.random.default_rng(3)
    rows = 60 * np.linspace(0, 1, 10) + 20 + 8 * rng.standard_normal((24, 10))
    few, many = r_squared_interval(ratings(rows[:6]), place(10)), r_squared_interval(ratings(rows), place(10))
    assert many[1] - many[0] < few[1] - few[0]
    for rows_used, (low, high) in ((rows[:6], few), (rows, many)):
        stretched = (rows_used - rows_used.mean(1, keepdims=True)) / rows_used.std(1, keepdims=True)
        r = np.corrcoef(np.linspace(0, 1, 10), stretched.mean(axis=0))[0, 1]
        assert 0 <= low < r**2 < high <= 1


def test_the_interval_of_r_squared_is_the_jackknifes():
    """Efron and Tibshirani (1993), eq. 11.5, of Fisher's z, from the ratings themselves."""
    rows = 60 * np.linspace(0, 1, 10) + 20 + 8 * np.random.default_rng(5).standard_normal((6, 10))

    def fisher_z(some):
        stretched = (some - some.mean(1, keepdims=True)) / some.std(1, keepdims=True)
        return np.arctanh(np.corrcoef(np.linspace(0, 1, 10), stretched.mean(axis=0))[0, 1])

    without = [fisher_z(np.delete(rows, k, axis=0)) for k in range(6)]
    error = np.sqrt(5 * np.var(without))  # (m - 1) / m times the sum of squares
    expected = np.tanh(t.interval(0.95, 5, loc=fisher_z(rows), scale=error)) ** 2
    assert r_squared_interval(ratings(rows), place(10)) == pytest.approx(expected, rel=1e-9)  # rounding


def test_participants_who_agree_perfectly_leave_no_doubt():
    low, high = r_squared_interval(ratings([[1, 2, 4, 5]] * 3), place(4))
    assert high - low < 1e-9  # rounding of equal numbers


def test_falling_ratings_are_as_sure_as_rising_ones():
    rng = np.random.default_rng(4)
    rows = 50 * np.linspace(0, 1, 8) + 5 * rng.standard_normal((5, 8))
    rising, falling = r_squared_interval(ratings(rows), place(8)), r_squared_interval(ratings(100 - rows), place(8))
    assert rising == pytest.approx(falling, rel=1e-9)  # the same but for rounding


@pytest.mark.parametrize("rows", [[[1, 2, 3]], [[1, 2, 3], [1, 3, 3]], [[5, 5, 5], [5, 5, 5], [1, 2, 3]]])
def test_where_nothing_can_be_said(rows):
    assert r_squared_interval(ratings(rows), place(3)) is None
