"""Objective and gradient, against finite differences, closed forms and the readable twin."""

import itertools

import numpy as np
import pytest
from scipy.optimize import approx_fprime
from sklearn.isotonic import IsotonicRegression

from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds.disparities import disparities
from gloss_analysis.mds.kernels import DIAGONAL, FIXED, FULL, Form, own_pairs, value_and_gradient
from gloss_analysis.mds.objective import (
    fitted_disparities,
    group_stress,
    mean_square_stress,
    source_distances,
    stress_of_sources,
)
from gloss_analysis.mds.problem import make_problem
from tests.analysis.studies import judged_by, named

LEVELS = [("ratio", "primary"), ("interval", "primary"), ("spline", "primary")]
LEVELS += [("ordinal", "primary"), ("ordinal", "secondary")]


def awkward_data() -> Dissimilarities:
    """Ties, gaps, weights over six decades, and a source that judged nothing and does not count."""
    rng = np.random.default_rng(3)
    values = rng.integers(0, 9, size=(3, 15)).astype(float)
    values[1, [2, 7]] = np.nan
    values = np.vstack([values, np.full(15, np.nan)])
    weights = 10 ** rng.uniform(-3, 3, size=values.shape)
    return Dissimilarities(
        tuple("abcdef"), ("1", "2", "3", "4"), values, pair_weights=weights, source_weights=np.array([1.0, 3.0, 0.5, 2])
    )


def evaluated(problem, form, theta):
    n, p = form.base.shape
    m = len(form.transforms)
    gradient = np.empty_like(theta)
    work = np.empty((5, len(problem.pairs.first)))
    spaces = np.empty((2, m * n, p))
    value = value_and_gradient(
        own_pairs(problem.pairs), form, theta, np.empty((n, p)), spaces[0], work, spaces[1], gradient
    )
    return value, gradient


@pytest.mark.parametrize("model", [FIXED, DIAGONAL, FULL])
@pytest.mark.parametrize(("level", "ties"), LEVELS)
@pytest.mark.parametrize("conditional", [True, False])
def test_gradient_equals_finite_differences(model, level, ties, conditional):
    rng = np.random.default_rng(4)
    problem = make_problem(awkward_data(), level=level, ties=ties, conditional=conditional)
    n, m, p = 6, 4, 2
    design = np.empty((0, 0)) if conditional else rng.standard_normal((n, 3))
    base = np.zeros((n, p)) if conditional else rng.standard_normal((n, p))
    n_free = n * p if conditional else 3 * p
    given = np.eye(p) + 0.2 * rng.standard_normal((m, p, p))
    extra = {FIXED: [], DIAGONAL: rng.uniform(0.5, 1.5, m * p), FULL: given.ravel()}[model]
    theta = np.concatenate([rng.standard_normal(n_free), extra])
    form = Form(model, given, base, design)
    value, gradient = evaluated(problem, form, theta)
    assert 0 < value < 1
    numeric = approx_fprime(theta, lambda x: evaluated(problem, form, x)[0], 1e-7)
    # Forward differences of step 1e-7 err by about 1e-7 times the curvature, which is of order one to ten here.
    assert gradient == pytest.approx(numeric, abs=3e-6)


@pytest.mark.parametrize(("level", "ties"), LEVELS)
@pytest.mark.parametrize("conditional", [True, False])
def test_kernels_and_readable_functions_agree(level, ties, conditional):
    data = awkward_data()
    problem = make_problem(data, level=level, ties=ties, conditional=conditional)
    rng = np.random.default_rng(5)
    z, c = rng.standard_normal((6, 3)), rng.standard_normal((4, 3, 3))
    distances = source_distances(z, c)
    assert distances[2, 0] == pytest.approx(np.linalg.norm((z[0] - z[1]) @ c[2]), rel=1e-12)
    fitted = fitted_disparities(problem, distances)
    weights = data.weights if conditional else data.weights * data.source_weights[:, np.newaxis]
    residual = np.nansum(weights * (distances - fitted) ** 2, axis=1)
    total = np.sum(np.where(data.judged, weights * distances**2, 0), axis=1)
    if conditional:
        expected = np.sqrt(np.divide(residual, total, out=np.zeros(4), where=total > 0))
    else:
        expected = np.sqrt([residual.sum() / total.sum()])
    # Sums of squares in another order: a few units in the last place of sums over weights of six decades.
    assert group_stress(problem, z, c) == pytest.approx(expected, rel=1e-9)
    shares = np.array([1.0, 3.0, 0.5, 0.0]) / 4.5
    mean = shares @ expected**2 if conditional else expected[0] ** 2
    assert mean_square_stress(problem, z, c) == pytest.approx(mean, rel=1e-9)
    assert stress_of_sources(problem, z, c).shape == (4,)


def test_the_projection_of_a_spline_is_a_least_squares_fit():
    # No admissible direction lowers the distance: the residual is orthogonal to the fit and has no positive product
    # with any column (the conditions of Karush, Kuhn and Tucker).
    rng = np.random.default_rng(0)
    problem = make_problem(named(rng.uniform(0, 5, 45), 10), level="spline")
    distance = rng.uniform(0, 3, 45)
    fitted = disparities(distance, problem.orders[0], level="spline", ties="primary")
    residual = distance - fitted
    assert residual @ fitted == pytest.approx(0, abs=1e-9)
    sequence = np.argsort(problem.orders[0].values)
    assert np.all(problem.pairs.basis.T @ residual[sequence] < 1e-9)
    assert np.all(np.diff(fitted[sequence]) >= -1e-12)


def test_nested_levels_fit_no_worse():
    rng = np.random.default_rng(1)
    data = named(rng.integers(1, 9, size=(2, 28)), 8)
    z, w = rng.standard_normal((8, 2)), rng.uniform(0.5, 2, (2, 2))
    stress = [mean_square_stress(make_problem(data, level=level, ties=ties), z, w) for level, ties in LEVELS]
    ratio, interval, spline, primary, secondary = stress
    assert primary <= secondary <= spline <= interval <= ratio


def test_stress_of_an_equilateral_triangle_seen_as_a_line():
    # delta = (1, 1, 1) at ratio level, points at 0, 1, 2 on a line: d = (1, 2, 1), best multiple 4/3,
    # Stress-1^2 = 1 - (sum d)^2 / (3 sum d^2) = 1 - 16/18.
    problem = make_problem(named([1, 1, 1], 3), level="ratio")
    stress = stress_of_sources(problem, np.array([[0.0], [1.0], [2.0]]), np.ones((1, 1)))
    assert stress[0] ** 2 == pytest.approx(1 / 9, rel=1e-12)


def test_the_objective_is_the_mean_of_squared_source_stress_and_free_of_each_sources_scale():
    data = judged_by([1.0, 2.0], noise_sd=8, seed=1)
    problem = make_problem(data)
    rng = np.random.default_rng(0)
    z, w = rng.standard_normal((27, 2)), rng.uniform(0.5, 2, (2, 2))
    stress = stress_of_sources(problem, z, w)
    # 1 - |P d|^2 / |d|^2 as the definition has it, with P d by scikit-learn.
    for k, d in enumerate(source_distances(z, w)):
        sequence = np.lexsort((d, data.values[k]))
        projected = IsotonicRegression().fit_transform(np.arange(len(d)), d[sequence])
        assert stress[k] ** 2 == pytest.approx(1 - projected @ projected / (d @ d), abs=1e-12)
    assert mean_square_stress(problem, z, w) == pytest.approx(np.mean(stress**2), rel=1e-12)
    rescaled = w * [[10.0], [0.01]]
    assert mean_square_stress(problem, z, rescaled) == pytest.approx(np.mean(stress**2), rel=1e-9)


@pytest.mark.parametrize(("level", "ties"), LEVELS)
def test_coincident_points_leave_everything_finite(level, ties):
    problem = make_problem(named([1, 2, 2, 4, 5, 6], 4), level=level, ties=ties)
    form = Form(DIAGONAL, np.eye(2)[np.newaxis], np.zeros((4, 2)), np.empty((0, 0)))
    for z in (np.array([[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [1.0, 0.0]]), np.zeros((4, 2))):
        value, gradient = evaluated(problem, form, np.concatenate([z.ravel(), [1.0, 1.0]]))
        assert np.isfinite(value)
        assert np.all(np.isfinite(gradient))
    assert value == 1
    assert not gradient.any()


def test_large_blocks_of_ties_are_sorted_whatever_their_order():
    # Two values for 190 pairs: blocks that insertion alone would take long for, in rising, falling and random order.
    rng = np.random.default_rng(2)
    values = rng.integers(0, 2, 190).astype(float)
    problem = make_problem(named(values, 20))
    for line in (np.arange(20.0), np.arange(20.0)[::-1], rng.standard_normal(20)):
        z = line[:, np.newaxis]
        (d,) = source_distances(z, np.ones((1, 1)))
        fitted = disparities(d, problem.orders[0], level="ordinal", ties="primary")
        expected = np.sqrt(np.sum((d - fitted) ** 2) / np.sum(d**2))
        assert stress_of_sources(problem, z, np.ones((1, 1)))[0] == pytest.approx(expected, rel=1e-12)


def test_weights_repeat_pairs():
    # A pair of weight 2 counts like the same pair judged twice: twice its square in numerator and denominator.
    rng = np.random.default_rng(6)
    values, weights = rng.uniform(1, 5, 6), np.array([1.0, 2, 1, 3, 1, 1])
    data = Dissimilarities(tuple("abcd"), ("1",), values[np.newaxis], pair_weights=weights[np.newaxis])
    z = rng.standard_normal((4, 2))
    (d,) = source_distances(z, np.ones((1, 2)))
    repeated = np.repeat(np.arange(6), weights.astype(int))
    slope = (values[repeated] @ d[repeated]) / (values[repeated] @ values[repeated])
    expected = np.sum((d - slope * values)[repeated] ** 2) / np.sum(d[repeated] ** 2)
    found = mean_square_stress(make_problem(data, level="ratio"), z, np.ones((1, 2)))
    assert found == pytest.approx(expected, rel=1e-12)


def test_unknown_levels_and_ties_are_refused():
    for options, message in itertools.product([{"level": "nominal"}], ["Invalid level = 'nominal'"]):
        with pytest.raises(ValueError, match=message):
            make_problem(named([1, 2, 3], 3), **options)
    with pytest.raises(ValueError, match="Invalid ties = 'tertiary'"):
        make_problem(named([1, 2, 3], 3), ties="tertiary")
