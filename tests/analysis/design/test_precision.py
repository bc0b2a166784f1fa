"""Widths, bias and coverage of simulated studies, against the sampling theory of Student's interval."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2, linregress, norm, sem
from scipy.stats import t as student_t

from gloss_analysis.design.population import Population
from gloss_analysis.design.precision import _summary, check_width, remarks, simulate_designs, smallest_design
from gloss_analysis.design.simulation import EXPERIMENT_1, drawn_ratios, on_the_slider, simulated_study, wished_answers
from glossspace.errors import GlossError
from tests.analysis.studies import axis_values

EVERY = np.ones(351, dtype=bool)
QUIET = Population(noise_sd=0.0)


@pytest.fixture(scope="module")
def quiet():
    return simulate_designs(EXPERIMENT_1, QUIET, observers=[5, 12], pair_sets=[EVERY], n_studies=300, n_jobs=2)


def test_widths_as_theory_says_where_only_observers_differ(quiet):
    """Without noise an observer's ratio is known to a slider step, and logs are normal with the stated spread."""
    for one in quiet:
        m = one.n_observers
        for width, quantile in ((one.width_median, 0.5), (one.width_p90, 0.9)):
            spread = 0.15 * np.sqrt(chi2.ppf(quantile, m - 1) / (m - 1))
            expected = 2 * student_t.ppf(0.975, m - 1) * spread / np.sqrt(m)
            # Quantiles of 300 widths have standard errors of 3 to 5 %.
            assert np.log(width) == pytest.approx(expected, rel=0.15)
        # 3 binomial standard errors of 300 studies.
        assert one.coverage == pytest.approx(0.95, abs=3 * np.sqrt(0.95 * 0.05 / 300))
        assert one.coverage_ci95[0] < one.coverage < one.coverage_ci95[1]
        assert abs(one.bias) < 4 * one.bias_error + 0.002  # slider steps round by .2 %
        assert one.bias_error == pytest.approx(0.15 / np.sqrt(m * 300), rel=0.2)  # of 300 means: known to 4 %
        assert one.follows == pytest.approx(1, abs=0.01)
        assert one.n_judgements == 351 * m
        assert remarks(one) == ()


def test_any_number_of_processes_gives_the_same():
    one, two, other = (
        simulate_designs(EXPERIMENT_1, QUIET, observers=[3], pair_sets=[EVERY], n_studies=10, n_jobs=jobs, seed=seed)
        for jobs, seed in ((1, 1), (2, 1), (1, 2))
    )
    assert one == two
    assert one != other


def test_repeats_lower_the_error_of_an_observer():
    once, four = simulate_designs(
        EXPERIMENT_1, Population(noise_sd=5.0), observers=[9], pair_sets=[EVERY], repeats=(1, 4), n_studies=20
    )
    # By the square root of the repeats, 2; 180 observers know each standard deviation to 5 %, and an average of four
    # whole numbers is also finer.
    assert once.observer_error / four.observer_error == pytest.approx(2, rel=0.3)
    assert (four.n_judgements, four.n_repeats) == (4 * once.n_judgements, 4)


def test_other_pairs_in_each_study():
    rng = np.random.default_rng(0)
    sets = np.array([rng.permutation(351) < 120 for _ in range(10)])
    found = simulate_designs(EXPERIMENT_1, Population(), observers=[4], pair_sets=[sets], n_studies=10)
    assert found[0].n_pairs == 120


def test_noise_that_moves_the_weight_is_said():
    found = simulate_designs(EXPERIMENT_1, Population(noise_sd=15.0), observers=[12], pair_sets=[EVERY], n_studies=30)
    told = " ".join(remarks(found[0]))
    assert "They are narrow, but not right" in told
    assert "noise moves the weight by +" in told
    assert "look more alike than they are" in told


def test_a_population_without_spread_has_nothing_to_follow():
    found = simulate_designs(
        EXPERIMENT_1, Population(sd_log_ratio=0.0), observers=[4], pair_sets=[EVERY], n_studies=10
    )  # fmt: skip
    assert np.isnan(found[0].follows)
    assert found[0].width_median > 1


def test_the_smallest_design(quiet):
    five, twelve = quiet
    cheap = replace(twelve, n_pairs=50, width_p90=five.width_p90)
    assert smallest_design([five, twelve], twelve.width_p90) == twelve
    assert smallest_design([five, twelve, cheap], five.width_p90) == cheap
    assert smallest_design([five, twelve], five.width_median, assured=False) == five
    assert smallest_design([five, twelve], 1.0001) is None
    # Of equally many judgements, fewer observers.
    same = replace(five, n_observers=10, n_repeats=1, n_pairs=five.n_judgements // 10)
    assert same.n_judgements == five.n_judgements - five.n_judgements % 10
    assert smallest_design([replace(five, n_pairs=350), replace(same, n_pairs=175)], 10.0).n_observers == 5


@pytest.mark.parametrize("width", [1.0, 0.5, np.nan, np.inf])
def test_widths_that_cannot_be(width):
    with pytest.raises(GlossError, match="Allowed: above 1"):
        check_width(width)


@pytest.mark.parametrize(
    ("given", "why"),
    [
        ({"observers": [1]}, "numbers of observers: [1]"),
        ({"observers": []}, "numbers of observers: []"),
        ({"repeats": [0]}, "numbers of repeats: [0]"),
        ({"n_studies": 9}, "number of studies = 9"),
        ({"pair_sets": [EVERY[:300]]}, "do not fit 27 stimuli: 351 pairs"),
        ({"pair_sets": [np.arange(351) < 5]}, "No judged pair links"),
    ],
)
def test_mistakes(given, why):
    assumed = {"observers": [3], "pair_sets": [EVERY], "n_studies": 10}
    with pytest.raises(GlossError, match=why.replace("[", r"\[").replace("]", r"\]")):
        simulate_designs(EXPERIMENT_1, Population(), **assumed | given)


def test_experiment_1():
    np.testing.assert_array_equal(EXPERIMENT_1, axis_values())


def test_simulated_answers_follow_the_metric():
    rng = np.random.default_rng(0)
    ratios = np.array([1.0, 2.0])
    found = wished_answers(EXPERIMENT_1, ratios, Population(exponent=0.5, noise_sd=0.0), n_repeats=2, rng=rng)
    assert found.shape == (2, 2, 351)
    first, second = np.triu_indices(27, 1)
    dc, dd = (EXPERIMENT_1[first] - EXPERIMENT_1[second]).T
    for row, ratio in zip(found[1], ratios, strict=True):
        distance = np.sqrt(dc**2 + (ratio * dd) ** 2)
        np.testing.assert_allclose(row, 100 * np.sqrt(distance / distance.max()), rtol=1e-12)  # rounding


def test_fewer_pairs_leave_the_answers_to_others_as_they_are():
    ratios = drawn_ratios(Population(), 3, np.random.default_rng(1))
    kept = np.arange(351) % 3 == 0
    whole, part = (
        simulated_study(EXPERIMENT_1, ratios, Population(), kept=some, rng=np.random.default_rng(2)).values
        for some in (None, kept)
    )
    np.testing.assert_array_equal(whole[:, kept], part[:, kept])
    assert np.isnan(part[:, ~kept]).all()


def test_the_slider_has_ends_and_steps():
    np.testing.assert_array_equal(on_the_slider(np.array([-9.0, 7.4, 7.6, 130.0]), 5), [0, 5, 10, 100])


def test_the_summary_of_studies_by_hand():
    """Ten studies with an interval and two without; four logarithms a study, true beside found."""
    rng = np.random.default_rng(4)
    mean, half = 0.6 + 0.05 * rng.standard_normal(10), 0.05 + 0.01 * np.arange(10)
    half[mean > 0.6] = 0.02
    intervals = np.vstack([np.column_stack([mean, mean - half, mean + half]), np.full((2, 3), np.nan)])
    true = 0.55 + 0.2 * rng.standard_normal(48)
    given = np.column_stack([true, 0.1 + 0.7 * true + 0.1 * rng.standard_normal(48)])
    given[5, 1] = np.nan  # one who could not be fitted
    found = _summary(intervals, given, 0.55, 4, 351, 2)
    assert (found.n_studies, found.n_without, found.n_judgements) == (12, 2, 4 * 351 * 2)
    assert found.width_median == pytest.approx(np.exp(2 * np.median(half)))
    assert found.width_p90 == pytest.approx(np.exp(2 * np.quantile(half, 0.9)))
    assert 1 + found.bias == pytest.approx(np.exp(np.mean(mean) - 0.55))
    assert found.bias_error == pytest.approx((1 + found.bias) * sem(mean))  # d exp(x) = exp(x) dx
    covered = sum(abs(mean - 0.55) <= half)
    assert 0 < covered < 10
    assert found.coverage == covered / 10
    # Wilson (1927): centre and half width for z = 1.959964
    z, p = norm.ppf(0.975), covered / 10
    root = z * np.sqrt(p * (1 - p) / 10 + z**2 / 400)
    assert found.coverage_ci95 == pytest.approx((p + z**2 / 20 + np.array([-root, root])) / (1 + z**2 / 10))
    line = linregress(*np.delete(given, 5, axis=0).T)
    left = np.delete(given[:, 1] - line.intercept - line.slope * given[:, 0], 5)
    assert (found.follows, found.observer_error) == pytest.approx((line.slope, np.sqrt(left @ left / (47 - 2))))
