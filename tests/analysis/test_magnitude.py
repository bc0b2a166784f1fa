"""Magnitude estimates and their regression."""

import statistics

import numpy as np
import pandas as pd
import pytest
from scipy.stats import median_abs_deviation

from gloss_analysis.ratings.magnitude import mean_ratings, rater_consistency, regress_ratings
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


def test_interval_is_students_over_participants():
    # By hand: 3 participants of equal mean 10 and equal spread, so that equalisation leaves them alone. "a" is 5, 15
    # and 5: mean 25/3, standard deviation 10 / sqrt(3), standard error 10 / 3; t(.975, 2) = 4.302653 from tables.
    table = {"1": {"a": [5], "b": [15]}, "2": {"a": [15], "b": [5]}, "3": {"a": [5], "b": [15]}}
    found = mean_ratings(ratings(table)).iloc[0]
    assert found["standard_error"] == pytest.approx(10 / 3, rel=1e-12)
    half = 4.302653 * 10 / 3
    assert [found["ci_low"], found["ci_high"]] == pytest.approx([25 / 3 - half, 25 / 3 + half], rel=1e-6)  # 7 digits


def test_geometric_equalisation_takes_out_each_observers_unit():
    # Units 1, 3 and 10 of the same judgements: their geometric mean, and no error left.
    judged = np.array([2.0, 5.0, 9.0])
    table = {str(unit): {"a": [2 * unit], "b": [5 * unit], "c": [9 * unit]} for unit in (1, 3, 10)}
    found = mean_ratings(ratings(table), equalise="geometric")
    assert found["rating"].to_numpy() == pytest.approx(30 ** (1 / 3) * judged, rel=1e-12)
    for column in ("ci_low", "ci_high"):
        assert found[column].to_numpy() == pytest.approx(found["rating"].to_numpy(), rel=1e-12)
    # Linear stretching of the same takes out the unit too, for it is a special case of moving and stretching.
    assert mean_ratings(ratings(table))["standard_error"].max() < 1e-12 * 90


def test_geometric_interval_is_that_of_the_logarithms():
    table = {"1": {"a": [1, 4], "b": [8]}, "2": {"a": [1], "b": [1]}}
    found = mean_ratings(ratings(table), equalise="geometric").iloc[0]
    # By hand, in powers of 2: observer 1 has a = 1 (mean of 0 and 2), b = 3; observer 2 has 0, 0. Grand mean 1. Moved,
    # "a" is 0 and 1: mean .5, standard error .5; t(.975, 1) = 12.706205 from tables.
    assert found["rating"] == pytest.approx(2**0.5, rel=1e-12)
    assert found["standard_error"] == pytest.approx(2**0.5 * 0.5 * np.log(2), rel=1e-12)
    expected = [2 ** (0.5 - 12.706205 * 0.5), 2 ** (0.5 + 12.706205 * 0.5)]
    assert [found["ci_low"], found["ci_high"]] == pytest.approx(expected, rel=1e-6)  # eight digits of t


def test_a_geometric_mean_of_zero_and_an_unknown_equalisation_are_refused():
    table = ratings({"1": {"a": [3], "b": [0]}, "2": {"a": [1], "b": [0]}})
    with pytest.raises(GlossError, match=r"Participant 1 rated the stimulus b 0 \(2 such\).*Use the linear"):
        mean_ratings(table, equalise="geometric")
    with pytest.raises(GlossError, match="no equalisation 'modulus'. Use one of: linear, geometric"):
        mean_ratings(table, equalise="modulus")


def raters(answers, *, n=12, seed=0, noise_sd=4.0):
    """Three repeats of 12 stimuli by each function of the true value, 10 to 90."""
    rng = np.random.default_rng(seed)
    truth = np.linspace(10, 90, n)
    return ratings(
        {
            str(k): {f"s{i}": answer(truth[i]) + noise_sd * rng.standard_normal(3) for i in range(n)}
            for k, answer in enumerate(answers)
        }
    )


def good(x):
    return x


def test_consistency_agrees_with_its_definition():
    table = raters([good, lambda x: 20 + x / 2, good], noise_sd=8.0)
    found = rater_consistency(table)
    wide = table.pivot_table(index=["participant_id", "repeat"], columns="stimulus", values="rating", sort=False)
    for one in found:
        own = wide.loc[one.participant_id].to_numpy()
        pairs = [statistics.correlation(own[a].tolist(), own[b].tolist()) for a, b in ((0, 1), (0, 2), (1, 2))]
        assert one.retest_correlation == pytest.approx(statistics.mean(pairs), rel=1e-9)  # rounding
        assert one.repeat_sd == pytest.approx(np.sqrt(own.var(axis=0, ddof=1).mean()), rel=1e-12)
        others = mean_ratings(table[table["participant_id"] != one.participant_id])["rating"]
        assert one.agreement == pytest.approx(statistics.correlation(own.mean(axis=0).tolist(), others.tolist()))
        assert one.flags == ()
    assert rater_consistency(table.sample(frac=1, random_state=1).sort_values("participant_id"))[0].repeat_sd > 0


def test_constant_reversed_and_outlying_raters_are_flagged_and_kept():
    rng = np.random.default_rng(5)
    table = raters([good, good, good, good, lambda x: 100 - x, lambda x: 50 + 30 * rng.standard_normal()])
    constant = table[table["participant_id"] == "0"].assign(participant_id="6", rating=33.3)
    found = rater_consistency(pd.concat([table, constant], ignore_index=True))
    assert [one.participant_id for one in found] == list("0123456")
    assert [bool(one.flags) for one in found] == [False] * 4 + [True] * 3
    assert found[4].flags[0].startswith("reversed: correlation -0.9")
    assert found[5].flags[0].startswith("low agreement: correlation 0.")
    assert found[6].flags == ("constant: every rating is 33.3",)
    assert np.isnan(found[6].retest_correlation)
    assert found[6].repeat_sd == pytest.approx(0, abs=1e-12)  # rounding of 33.3


def test_a_noisy_rater_is_an_outlier_though_positive():
    table = raters([good, good, good, good, lambda x: 45 + (x - 10) % 47])
    low = rater_consistency(table)[4]
    assert 0 < low.agreement < 0.6
    assert low.flags[0].startswith("low agreement: correlation 0.")


@pytest.mark.parametrize(("noise_sd", "seed"), [(0.3, 10), (1.0, 1)])
def test_the_lowest_usual_agreement_is_iglewicz_and_hoaglins(noise_sd, seed):
    """3.5 robust standard deviations below the median, or the sampling error of Fisher's z; the median of |z| by scipy.

    Of alike raters the sampling error is the larger of the two, of others the spread.
    """
    rated = 10 + np.arange(9) + noise_sd * np.random.default_rng(seed).standard_normal((7, 9))
    rated[-1] = [14, 11, 16, 12, 15, 13, 17, 10, 18]
    found = rater_consistency(ratings({f"{k}": {f"{s}": [one] for s, one in enumerate(rated[k])} for k in range(7)}))
    z = np.arctanh([one.agreement for one in found])
    spread, sampling = 3.5 * median_abs_deviation(z) / 0.6745, 1.96 / np.sqrt(9 - 3)
    assert (spread > sampling) == (noise_sd == 1)
    lowest = np.tanh(np.median(z) - max(spread, sampling))
    assert f"where {lowest:.2f} is the lowest" in found[-1].flags[0]


def test_among_three_only_the_reversed_one_is_flagged_and_of_two_neither_is_blamed():
    three = rater_consistency(raters([good, lambda x: 100 - x, good]))
    assert [bool(one.flags) for one in three] == [False, True, False]
    two = rater_consistency(raters([good, lambda x: 100 - x]))
    assert all("the only other participant: one of the two" in one.flags[0] for one in two)


def test_one_rater_with_one_repeat_has_nothing_to_compare():
    (alone,) = rater_consistency(ratings({"1": {"a": [1], "b": [2], "c": [5]}}))
    assert np.isnan([alone.retest_correlation, alone.agreement, alone.repeat_sd]).all()
    assert alone.flags == ()


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
    assert [fit.order for fit in curved.polynomials] == [1, 2, 3]
    assert curved.polynomials[0].r_squared == pytest.approx(curved.r_squared, rel=1e-12)
    straight = regress_ratings(x, 3 * x)
    assert max(straight.polynomial_r_squared) - straight.r_squared < 1e-12


@pytest.mark.parametrize(
    ("x", "message"),
    [
        ([1, 1, 2, 2], "3 different positions along the axis, but got 2"),
        ([1, 2, np.nan, 4], "needs finite"),
        ([1e-310, 2e-310, 3e-310, 4e-310], "differ by 3e-310"),
    ],
)
def test_what_cannot_be_regressed_is_refused(x, message):
    with pytest.raises(GlossError, match=message):
        regress_ratings(np.array(x), np.arange(4.0))


def test_equal_ratings_are_refused():
    with pytest.raises(GlossError, match="All ratings are 100: there is no relation"):
        regress_ratings(np.arange(4.0), np.full(4, 100.0))
