"""Scaling: known configurations, known weights, real data with a known answer, and an independent solver."""

import itertools
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import procrustes
from scipy.spatial.distance import pdist, squareform
from sklearn.manifold import MDS

from gloss_analysis.dimensionality.stress_curve import stress_curve
from gloss_analysis.judgements.judgement_table import read_table
from gloss_analysis.mds import scale
from gloss_analysis.mds.objective import mean_square_stress
from gloss_analysis.mds.problem import make_problem
from gloss_analysis.mds.smacof import smacof
from gloss_analysis.mds.start_sets import given_start
from gloss_analysis.mds.starts import random_start
from glossspace.errors import GlossError
from tests.analysis.studies import axis_values, judged_by, named

REFERENCE = Path(__file__).parents[2] / "reference"
HELM = Path(__file__).parents[3] / "analysis" / "data" / "helm1959.csv"


def test_points_on_a_line_are_found_at_ratio_level():
    line = np.array([0.0, 1.0, 3.0, 4.5, 9.0])[:, np.newaxis]
    solution = scale(named(pdist(line), 5), n_dims=1, model="identity", level="ratio")
    assert solution.stress1 < 1e-6  # an exact fit exists; the solver stops at a squared stress of about 1e-12
    assert abs(np.corrcoef(solution.coordinates[:, 0], line[:, 0])[0, 1]) == pytest.approx(1, abs=1e-9)


@pytest.mark.parametrize("n", [5, 6, 9])
def test_a_regular_polygon_is_found_at_ratio_level(n):
    angle = 2 * np.pi * np.arange(n) / n
    polygon = np.column_stack([np.cos(angle), np.sin(angle)])
    solution = scale(named(pdist(polygon), n), n_dims=2, model="identity", level="ratio")
    assert solution.stress1 < 1e-5
    assert procrustes(polygon, solution.coordinates)[2] < 1e-9


def test_an_equilateral_triangle_on_a_line_has_the_closed_form_stress():
    # Three equal dissimilarities in one dimension: the best are equally spaced points, Stress-1^2 = 1/9 (see
    # test_objective), and no order of the points does better.
    solution = scale(named([1, 1, 1], 3), n_dims=1, model="identity", level="ratio")
    assert solution.stress1 == pytest.approx(1 / 3, rel=1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_one_dimension_is_exact_for_seven_stimuli(seed):
    # At ratio level the best points in a given order have a closed form (Defays 1978): t_i = (sum of delta_ij over the
    # j before i, less that over those after) / n, and Stress-1^2 = 1 - n sum t^2 / sum delta^2. So all 7! orders can be
    # tried. None of these random judgements has a clear order, and local search alone misses the best of most.
    delta = np.random.default_rng(seed).uniform(1, 9, 21)
    square = squareform(delta)
    orders = np.array(list(itertools.permutations(range(7))))
    side = np.tri(7, k=-1) - np.tri(7, k=-1).T
    points = np.sum(square[orders[:, :, np.newaxis], orders[:, np.newaxis, :]] * side, axis=2) / 7
    best = np.sqrt(1 - 7 * np.max(np.sum(points**2, axis=1)) / np.sum(delta**2))
    solution = scale(named(delta, 7), n_dims=1, model="identity", level="ratio", n_starts=8)
    assert solution.stress1 == pytest.approx(best, abs=1e-9)


def test_one_dimension_of_real_data_is_no_worse_than_thousands_of_starts():
    # The lowest of 18,000 (Ekman) and 2,250 (Helm) random starts of another L-BFGS, over a compiled objective, to six
    # digits. Without interchange, 30 starts end at 0.256614 and 0.316427.
    ekman = named(np.loadtxt(REFERENCE / "ekman.csv", delimiter=",", ndmin=2), 14)
    assert scale(ekman, n_dims=1).stress1 <= 0.256382
    assert scale(read_table(HELM), n_dims=1).stress1 <= 0.309245


def test_weights_and_configuration_of_noise_free_observers_come_back():
    ratios = [0.9, 1.5, 1.78, 2.4, 3.5]
    solution = scale(judged_by(ratios), n_dims=2)
    assert solution.stress1 < 2e-3  # order alone leaves points a little play
    c, d = axis_values().T
    correlation = np.abs(np.corrcoef(np.column_stack([c, d, solution.coordinates]).T)[:2, 2:])
    c_dimension = int(np.argmax(correlation[0]))
    assert correlation[0, c_dimension] > 0.999
    assert correlation[1, 1 - c_dimension] > 0.999
    recovered = solution.dimension_weights[:, 1 - c_dimension] / solution.dimension_weights[:, c_dimension]
    # Known up to one common factor, the scale of the group space.
    factor = recovered / np.array(ratios)
    assert np.ptp(np.log(factor)) < 0.03  # ordinal data fix the weights to a few per cent


def test_conventions_of_a_weighted_solution():
    solution = scale(judged_by([1.0, 2.0, 3.0], noise_sd=4), n_dims=2)
    z, w = solution.coordinates, solution.dimension_weights
    assert z.mean(axis=0) == pytest.approx([0, 0], abs=1e-12)
    assert np.sqrt(np.mean(w**2, axis=0)) == pytest.approx([1, 1], rel=1e-9)
    assert np.sum(w**2 * np.mean(z**2, axis=0), axis=1) == pytest.approx(np.ones(3), rel=1e-9)
    assert np.mean(z[:, 0] ** 2) >= np.mean(z[:, 1] ** 2)
    assert solution.stress1**2 == pytest.approx(np.mean(solution.source_stress1**2), rel=1e-12)
    assert solution.normalized_raw_stress == pytest.approx(solution.stress1**2, rel=1e-12)


@pytest.mark.parametrize("model", ["identity", "weighted"])
@pytest.mark.parametrize("ties", ["primary", "secondary"])
def test_majorization_ends_at_the_same_stress(model, ties):
    data = judged_by([1.0, 1.8, 2.6], noise_sd=6, integers=True, seed=2)
    best = scale(data, n_dims=2, model=model, ties=ties, n_starts=10)
    rng = np.random.default_rng(5)
    found = [
        smacof(
            data, start=random_start(27, 2, rng), model=model, ties=ties, max_steps=3000, tolerance=1e-9
        ).stress1_by_step
        for _ in range(4)
    ]
    lowest = min(steps[-1] for steps in found)
    assert best.stress1 <= lowest + 1e-6
    # Majorization creeps: at a step of 1e-9 in squared stress it is within a few 1e-5 of its minimum.
    assert lowest == pytest.approx(best.stress1, abs=2e-4)
    for steps in found:
        assert np.all(np.diff(steps) <= 1e-12)  # never uphill: the defining property of majorization


def test_metric_scaling_is_no_worse_than_scikit_learns():
    rng = np.random.default_rng(8)
    data = named(rng.uniform(1, 3, size=45), 10)
    square = np.zeros((10, 10))
    square[data.pairs] = data.values[0]
    square += square.T
    peer = MDS(
        n_components=2, metric="precomputed", metric_mds=True, n_init=20, max_iter=3000, eps=1e-12, random_state=0,
        init="random", normalized_stress=False,
    ).fit(square)  # fmt: skip
    # At the optimal scale, raw stress over the sum of squared dissimilarities is Stress-1 squared.
    theirs = np.sqrt(peer.stress_ / np.sum(data.values**2))
    ours = scale(data, n_dims=2, model="identity", level="ratio", n_starts=30).stress1
    assert ours <= theirs + 1e-6
    assert ours == pytest.approx(theirs, abs=0.01)  # both search the same landscape, with other random starts


def test_stress_does_not_rise_with_dimensions():
    curve = stress_curve(judged_by([1.0, 2.0], noise_sd=6, integers=True), dims=[4, 1, 2, 3], n_starts=1)
    assert [solution.n_dims for solution in curve] == [1, 2, 3, 4]
    stress = [solution.stress1 for solution in curve]
    assert np.all(np.diff(stress) < 1e-6)  # the solver's tolerance
    assert stress[0] > 2 * stress[1]  # two dimensions made the data


def test_a_solution_as_start_brings_its_weights():
    data = judged_by([0.5, 1.0, 4.0], noise_sd=6)
    good = scale(data, n_dims=2, n_starts=8)
    coordinates, transforms = given_start(good, data, 3)
    stress = mean_square_stress(make_problem(data), coordinates, transforms)
    # An empty dimension would add no distance; it is spread by a thousandth of the others, so that it has a gradient.
    assert np.sqrt(stress) == pytest.approx(good.stress1, rel=1e-4)
    with pytest.raises(GlossError, match="a starting solution must be one of the same data"):
        scale(data.of(("p0",)), n_dims=2, initial=[good])


def test_missing_pairs_and_missing_stimuli_are_bridged():
    data = judged_by([1.5, 1.78, 2.2, 1.6])
    values = data.values.copy()
    rng = np.random.default_rng(1)
    values[rng.uniform(size=values.shape) < 0.3] = np.nan
    first, second = data.pairs
    values[0, (first == 4) | (second == 4)] = np.nan  # one participant never saw one stimulus
    solution = scale(named(values, 27), n_dims=2, n_starts=8)
    complete = scale(data, n_dims=2, n_starts=8)
    # Two thirds of noise-free pairs still fix the configuration: nine tenths of a per cent of its variance at most.
    assert procrustes(complete.coordinates, solution.coordinates)[2] < 0.009


@settings(max_examples=10, deadline=None)
@given(st.sampled_from([np.sqrt, np.log1p, np.exp, lambda x: 1e12 * x, lambda x: 1e-12 * x]), st.integers(0, 100))
def test_ordinal_stress_is_invariant_to_monotone_rescaling(function, seed):
    values = np.random.default_rng(seed).integers(1, 30, size=(2, 15)).astype(float)
    plain = scale(named(values, 6), n_dims=2, n_starts=2)
    rescaled = scale(named(function(values), 6), n_dims=2, n_starts=2)
    assert rescaled.stress1 == plain.stress1
    assert np.array_equal(rescaled.coordinates, plain.coordinates)


def test_the_result_does_not_depend_on_the_number_of_processes():
    data = named(judged_by([1.0, 2.0], noise_sd=5).values[:, :15], 6)
    for n_dims in (1, 2):
        alone, together = (scale(data, n_dims=n_dims, n_starts=6, n_jobs=jobs) for jobs in (1, 2))
        assert np.array_equal(alone.coordinates, together.coordinates)
        assert np.array_equal(alone.start_stress1, together.start_stress1)


def test_a_constant_participant_adds_nothing_and_is_named():
    data = judged_by([1.5, 2.0], noise_sd=3)
    with_constant = named(np.vstack([data.values, np.full((1, 351), 50.0)]), 27)
    solution = scale(with_constant, n_dims=2, n_starts=4)
    assert any("p2" in warning for warning in solution.warnings)
    assert np.all(np.isfinite(solution.dimension_weights))


@pytest.mark.parametrize("n_dims", [1, 2, 3])
@pytest.mark.parametrize("level", ["ratio", "interval", "ordinal"])
def test_a_participant_who_judged_nothing_changes_nothing_and_is_named(n_dims, level):
    values = np.random.default_rng(0).integers(1, 9, size=(2, 10)).astype(float)
    without = scale(named(values, 5), n_dims=n_dims, level=level, n_starts=3)
    beside = scale(named(np.vstack([values, np.full((1, 10), np.nan)]), 5), n_dims=n_dims, level=level, n_starts=3)
    assert beside.stress1 == pytest.approx(without.stress1, abs=1e-6)  # the solver's tolerance
    assert beside.source_stress1[2] == 0
    assert any("judged no pair and are not counted: p2" in warning for warning in beside.warnings)


@pytest.mark.parametrize("factor", [1e200, 1e-200])
@pytest.mark.parametrize("level", ["ratio", "interval"])
def test_metric_scaling_does_not_depend_on_the_unit(factor, level):
    # The squares of such values are beyond what a float can hold.
    values = np.random.default_rng(2).uniform(1, 9, size=(2, 10))
    plain, rescaled = (scale(named(v, 5), n_dims=2, level=level, n_starts=3) for v in (values, factor * values))
    assert rescaled.stress1 == pytest.approx(plain.stress1, rel=1e-6)  # the solver's tolerance, after rounding


def test_a_collapse_into_clusters_is_called_degenerate():
    # All differences within a group are smaller than all between groups, so ordinal stress is 0 with two points
    # (Borg and Groenen 2005, section 13.3).
    rng = np.random.default_rng(0)
    values = [[(1 if (i < 4) == (j < 4) else 9) + rng.uniform() for i in range(8) for j in range(i + 1, 8)]]
    solution = scale(named(values, 8), n_dims=2, model="identity")
    assert solution.stress1 < 1e-3
    assert "Degenerate: the 8 stimuli fall on 2 points" in " ".join(solution.warnings)


def test_equal_disparities_are_called_degenerate():
    # Four participants whose orders contradict each other agree on a simplex alone, which fits each by a flat line.
    values = np.random.default_rng(1).integers(1, 30, size=(4, 10)).astype(float)
    for level in ("interval", "ordinal"):
        solution = scale(named(values, 5), n_dims=4, model="identity", level=level, n_starts=4)
        assert "Degenerate: the disparities are all but equal" in " ".join(solution.warnings)
    solution = scale(named(values, 5), n_dims=2, model="identity", level="interval", n_starts=4)
    assert solution.warnings == ()


def test_a_space_that_can_follow_any_order_is_called_so():
    solution = scale(named([3, 1, 4, 1.5, 9, 2.6], 4), n_dims=2, model="identity")
    assert solution.stress1 < 1e-3
    assert "2 dimensions can follow any order of the pairs of 4 stimuli" in " ".join(solution.warnings)


def test_three_stimuli_and_many_dimensions_are_refused_beyond_what_points_allow():
    assert scale(named([3, 4, 5], 3), n_dims=2, model="identity", level="ratio").stress1 < 1e-6
    with pytest.raises(GlossError, match=r"Invalid number of dimensions = 3\. Allowed: 1 to 2 for 3 stimuli"):
        scale(named([3, 4, 5], 3), n_dims=3)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ([[7.0] * 6], "Every participant gave all pairs the same dissimilarity"),
        ([[np.nan] * 6], "No pair was judged"),
        ([[1, 2, 3, -4, 5, 6]], r"Dissimilarity -4\.0 of participant p0 is not allowed"),
        ([[1, 2, 3, 4, 5, np.inf]], "Dissimilarity inf of participant p0 is not allowed"),
        ([[1, np.nan, np.nan, np.nan, np.nan, 2]], "No judged pair links the stimuli s0, s1 with s2, s3"),
    ],
)
def test_data_that_fix_no_configuration_are_refused(values, message):
    with pytest.raises(GlossError, match=message):
        scale(named(values, 4), n_dims=2)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"model": "replicated"}, "Invalid model = 'replicated'. Allowed: 'identity', 'weighted'"),
        ({"n_starts": 0}, "Invalid number of starts = 0"),
        ({"seed": -1}, "Invalid seed = -1"),
        ({"n_jobs": 0}, "Invalid n_jobs = 0"),
        ({"initial": [np.zeros((3, 2))]}, r"must be finite and of shape \(4, 2\), not \(3, 2\)"),
    ],
)
def test_impossible_requests_are_refused(options, message):
    with pytest.raises(GlossError, match=message):
        scale(named([1, 2, 3, 4, 5, 6], 4), n_dims=2, **options)
