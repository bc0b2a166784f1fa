"""Axis weights: noise-free recovery, a brute-force minimum, the bias that a compressed slider makes, and bad input."""

import itertools

import numpy as np
import pytest
from scipy.stats import t

from gloss_analysis.confirmatory.scaling import confirm_axes, population_interval
from gloss_analysis.mds.objective import stress_of_sources
from gloss_analysis.mds.problem import make_problem
from glossspace.errors import GlossError
from tests.analysis.studies import axis_values, judged_by, named

AXES = ("c", "d")


@pytest.mark.parametrize("level", ["ratio", "interval", "ordinal"])
def test_noise_free_ratios_come_back(level):
    ratios = [0.5, 1.78, 4.0]
    fit = confirm_axes(judged_by(ratios), axis_values(), axes=AXES, level=level)
    # Metric levels pin the ratio down to the search's tolerance; order alone leaves it an interval in which no two of
    # the 351 distances swap places, some parts in a thousand wide.
    tolerance = 5e-3 if level == "ordinal" else 1e-6
    assert [one.ratio for one in fit.individual] == pytest.approx(ratios, rel=tolerance)
    assert all(one.stress1 < 1e-3 for one in fit.individual)


def test_the_ratio_is_the_lowest_point_of_the_stress_curve():
    data = judged_by([1.3, 2.2], noise_sd=8, integers=True, seed=4)
    fit = confirm_axes(data, axis_values(), axes=AXES)

    def stress(problem, ratio):
        weights = np.tile([1.0, ratio], (problem.n_sources, 1))
        return np.sqrt(np.mean(stress_of_sources(problem, axis_values(), weights) ** 2))

    ratios = np.geomspace(0.1, 20, 601)
    both = make_problem(data)
    assert fit.shared.stress1 <= min(stress(both, ratio) for ratio in ratios) + 1e-9
    for name, one in zip(fit.participants, fit.individual, strict=True):
        alone = make_problem(data.of((name,)))
        assert one.stress1 <= min(stress(alone, ratio) for ratio in ratios) + 1e-9


def test_population_is_the_geometric_mean_with_a_t_interval_on_logarithms():
    fit = confirm_axes(judged_by([1.0, 2.0, 4.0], noise_sd=5), axis_values(), axes=AXES, level="ratio")
    logs = np.log([one.ratio for one in fit.individual])
    half = t.ppf(0.975, 2) * logs.std(ddof=1) / np.sqrt(3)
    assert fit.population_ratio == pytest.approx(np.exp(logs.mean()), rel=1e-12)
    assert fit.population_ci95 == pytest.approx(np.exp([logs.mean() - half, logs.mean() + half]), rel=1e-12)
    assert confirm_axes(judged_by([2.0]), axis_values(), axes=AXES).population_ci95 is None


def test_the_studentised_bootstrap_is_that_of_all_resamples():
    # Of three participants there are 27 resamples, 24 with a standard error, each of at least six kinds with a chance
    # of an eighth or more: the outermost 2.5 % are the outermost kinds, and 2,000 draws hold all kinds for certain.
    logs = np.log([1.0, 2.0, 5.0])

    def studentised(some):
        return (np.mean(some) - logs.mean()) / (np.std(some, ddof=1) / np.sqrt(3))

    found = [studentised(some) for some in itertools.product(logs, repeat=3) if np.ptp(some) > 0]
    error = logs.std(ddof=1) / np.sqrt(3)
    expected = np.exp([logs.mean() - max(found) * error, logs.mean() - min(found) * error])
    assert population_interval(logs, interval="bootstrap", seed=5) == pytest.approx(expected, rel=1e-12)


def test_the_studentised_bootstrap_of_a_large_normal_sample_is_the_t_interval():
    logs = np.random.default_rng(0).standard_normal(400) * 0.2
    plain = np.log(population_interval(logs))
    boot = np.log(population_interval(logs, interval="bootstrap"))
    # A 2.5 % quantile of 2,000 draws has a standard error of sqrt(.025 .975 / 2000) / phi(1.96) = .06 standard errors
    # of the mean, .2 / sqrt(400); four of these.
    assert boot == pytest.approx(plain, abs=4 * 0.06 * 0.01)


def test_intervals_of_few_or_equal_participants():
    assert population_interval(np.zeros(1)) is None
    assert population_interval(np.zeros(2), interval="bootstrap") is None
    for kind in ("t", "bootstrap"):
        assert population_interval(np.full(4, np.log(2)), interval=kind) == pytest.approx((2, 2))
    with pytest.raises(GlossError, match="Invalid interval = 'percentile'"):
        confirm_axes(judged_by([1.78]), axis_values(), axes=AXES, interval="percentile")


def test_a_fit_carries_the_interval_that_was_asked_for():
    data = judged_by([1.0, 2.0, 4.0], noise_sd=5)
    fit = confirm_axes(data, axis_values(), axes=AXES, level="ratio", interval="bootstrap", seed=3)
    logs = np.log([one.ratio for one in fit.individual])
    assert fit.interval == "bootstrap"
    assert fit.population_ci95 == population_interval(logs, interval="bootstrap", seed=3)


def test_the_seed_of_the_bootstrap_is_that_of_the_fit():
    # Of three participants all seeds find the same outermost resamples; of six not.
    data = judged_by([1.0, 1.3, 1.6, 2.0, 2.8, 4.0], noise_sd=5)
    fit = confirm_axes(data, axis_values(), axes=AXES, level="ratio", interval="bootstrap", seed=3)
    logs = np.log([one.ratio for one in fit.individual])
    one, three = (population_interval(logs, interval="bootstrap", seed=seed) for seed in (1, 3))
    assert fit.population_ci95 == three != one


def test_a_compressed_slider_biases_a_ratio_fit_and_not_an_ordinal_one():
    # The gloss project's science notes: ratio-level fits overestimate the weight by 10-17 % under compression.
    data = judged_by([1.78] * 3, exponent=0.7)
    ordinal = confirm_axes(data, axis_values(), axes=AXES, level="ordinal").population_ratio
    ratio = confirm_axes(data, axis_values(), axes=AXES, level="ratio").population_ratio
    assert ordinal == pytest.approx(1.78, rel=5e-3)
    assert ratio > 1.78 * 1.08


def test_three_axes_and_one():
    rng = np.random.default_rng(0)
    position = rng.standard_normal((12, 3))
    weights = np.array([1.0, 0.5, 2.5])
    first, second = np.triu_indices(12, 1)
    data = named(np.linalg.norm((position[first] - position[second]) * weights, axis=1), 12)
    fit = confirm_axes(data, position, axes=("x", "y", "z"), level="ratio")
    assert fit.shared.weights == pytest.approx(weights, rel=1e-4)  # the tolerance of Nelder and Mead's search
    assert fit.shared.ratio == pytest.approx(2.5, rel=1e-4)
    alone = confirm_axes(data, position[:, :1], axes=("x",))
    assert alone.shared.weights.tolist() == [1.0]


def test_three_axes_reach_the_lowest_point_of_a_grid():
    # Noisy judgements of few stimuli, for which a search from axes of equal spread alone ends in a dent at 0.105.
    rng = np.random.default_rng(92)
    position = rng.standard_normal((8, 3))
    first, second = np.triu_indices(8, 1)
    judged = np.linalg.norm((position[first] - position[second]) * [1.0, 0.1, 8.0], axis=1)
    data = named(np.round(judged + 2 * rng.standard_normal(28)).clip(0), 8)
    problem = make_problem(data)

    def stress(*ratios):
        return stress_of_sources(problem, position, np.array([[1.0, *ratios]]))[0]

    grid = [stress(y, z) for y in np.geomspace(0.02, 50, 40) for z in np.geomspace(0.02, 50, 40)]
    assert confirm_axes(data, position, axes=("x", "y", "z")).shared.stress1 <= min(grid) + 1e-9


def test_where_order_leaves_a_range_of_ratios_its_middle_is_taken():
    # Stimuli at (0, 0), (1, 0), (0, 1), judged b > a > c: |ab| = 1, |ac| = w, |bc| = sqrt(1 + w^2). With |ac| judged
    # larger than |ab| any w > 1 fits, up to the search's limit, 100 at equal spread: the middle on the log scale is 10.
    fit = confirm_axes(named([1, 2, 3], 3), np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), axes=AXES)
    assert fit.individual[0].stress1 == 0
    assert fit.individual[0].ratio == pytest.approx(10, rel=0.06)  # half a step of the search's grid, exp(0.115)


def test_an_observer_who_reversed_the_scale_is_reported():
    data = judged_by([1.5, 1.78])
    reversed_scale = named(np.vstack([data.values, 95 - data.values[0]]), 27)
    fit = confirm_axes(reversed_scale, axis_values(), axes=AXES)
    assert any("Was the scale reversed?" in warning and "p2" in warning for warning in fit.warnings)
    assert not confirm_axes(data, axis_values(), axes=AXES).warnings


def test_an_observer_who_judged_no_pair_along_an_axis_is_left_out_and_named():
    data = judged_by([1.5, 2.0])
    first, second = data.pairs
    values = data.values.copy()
    values[1, axis_values()[first, 1] != axis_values()[second, 1]] = np.nan
    fit = confirm_axes(named(values, 27), axis_values(), axes=AXES)
    assert fit.participants == ("p0",)
    assert any("its weight is not known: p1" in warning for warning in fit.warnings)


def test_an_observer_who_sees_one_axis_only_is_reported():
    position = axis_values()
    first, second = np.triu_indices(27, 1)
    only_c = np.abs(position[first, 0] - position[second, 0])
    fit = confirm_axes(named(only_c, 27), position, axes=AXES, level="ratio")
    assert any("one axis alone" in warning for warning in fit.warnings)


@pytest.mark.parametrize("level", ["ratio", "ordinal"])
def test_a_constant_observer_is_left_out_and_named(level):
    values = np.vstack([judged_by([1.5, 2.0]).values, np.full((1, 351), 50.0)])
    fit = confirm_axes(named(values, 27), axis_values(), axes=AXES, level=level)
    assert fit.participants == ("p0", "p1")
    assert any("p2" in warning for warning in fit.warnings)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda x: x[:-1], r"Coordinates of shape \(26, 2\) do not fit 27 stimuli and 2 axes"),
        (lambda x: np.where(np.arange(27)[:, None] == 3, np.nan, x), "Coordinates must be finite"),
        (lambda x: x * [1, 0], "All stimuli have the same coordinate on the axis 'd'"),
        # A study with one roughness: the standard deviation of 27 times .93 is a rounding error above 0.
        (lambda x: x * [1, 0] + [0, 0.93], "All stimuli have the same coordinate on the axis 'd'"),
    ],
)
def test_impossible_coordinates_are_refused(change, message):
    with pytest.raises(GlossError, match=message):
        confirm_axes(judged_by([1.78]), change(axis_values()), axes=AXES)


@pytest.mark.parametrize("unit", [1e-200, 1e200])
def test_the_unit_of_an_axis_changes_its_weight_and_nothing_else(unit):
    data = judged_by([1.3, 2.2], noise_sd=6, integers=True)
    plain = confirm_axes(data, axis_values(), axes=AXES)
    scaled = confirm_axes(data, axis_values() * [1, unit], axes=AXES)
    # Rounding of the coordinates may move where the search stops on a plateau of the ordinal loss.
    assert scaled.population_ratio * unit == pytest.approx(plain.population_ratio, rel=1e-6)
    assert scaled.shared.stress1 == pytest.approx(plain.shared.stress1, rel=1e-6)


def test_axes_that_are_multiples_of_each_other_are_refused():
    c = axis_values()[:, 0]
    with pytest.raises(GlossError, match="The axes c, d are multiples or sums of each other"):
        confirm_axes(judged_by([1.78]), np.column_stack([c, 2 * c + 1]), axes=AXES)
