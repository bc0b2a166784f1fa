"""Objective and gradient, against finite differences and closed forms."""

import numpy as np
import pytest
from scipy.optimize import approx_fprime
from sklearn.isotonic import IsotonicRegression

from gloss_analysis.objective import (
    make_problem,
    mean_square_stress,
    source_distances,
    stress_and_gradient,
    stress_of_sources,
)
from tests.analysis.studies import judged_by, named


@pytest.mark.parametrize("level", ["ratio", "interval", "ordinal"])
@pytest.mark.parametrize("ties", ["primary", "secondary"])
def test_gradient_equals_finite_differences(level, ties):
    rng = np.random.default_rng(3)
    values = rng.integers(0, 9, size=(3, 15)).astype(float)
    values[1, [2, 7]] = np.nan  # pairs that were not judged
    values = np.vstack([values, np.full(15, np.nan)])  # a source that judged nothing does not count
    problem = make_problem(named(values, 6), level=level, ties=ties)
    z, w = rng.standard_normal((6, 2)), rng.uniform(0.5, 1.5, (4, 2))

    def value(theta):
        return mean_square_stress(
            problem, source_distances(problem, theta[:12].reshape(6, 2), theta[12:].reshape(4, 2))
        )

    _, by_coordinates, by_weights = stress_and_gradient(problem, z, w)
    numeric = approx_fprime(np.concatenate([z.ravel(), w.ravel()]), value, 1e-7)
    # Forward differences of step 1e-7 err by about 1e-7 times the curvature, which is of order one here.
    assert np.concatenate([by_coordinates.ravel(), by_weights.ravel()]) == pytest.approx(numeric, abs=2e-6)


def test_stress_of_an_equilateral_triangle_seen_as_a_line():
    # delta = (1, 1, 1) at ratio level, points at 0, 1, 2 on a line: d = (1, 2, 1), best multiple 4/3,
    # Stress-1^2 = 1 - (sum d)^2 / (3 sum d^2) = 1 - 16/18.
    problem = make_problem(named([1, 1, 1], 3), level="ratio")
    distances = source_distances(problem, np.array([[0.0], [1.0], [2.0]]), np.ones((1, 1)))
    assert stress_of_sources(problem, distances)[0] ** 2 == pytest.approx(1 / 9, rel=1e-12)


def test_the_objective_is_the_mean_of_squared_source_stress_and_free_of_each_sources_scale():
    data = judged_by([1.0, 2.0], noise_sd=8, seed=1)
    problem = make_problem(data)
    rng = np.random.default_rng(0)
    z, w = rng.standard_normal((27, 2)), rng.uniform(0.5, 2, (2, 2))
    distances = source_distances(problem, z, w)
    stress = stress_of_sources(problem, distances)
    # 1 - |P d|^2 / |d|^2 as the definition has it, with P d by scikit-learn.
    for k, d in enumerate(distances):
        sequence = np.lexsort((d, data.values[k]))
        projected = IsotonicRegression().fit_transform(np.arange(len(d)), d[sequence])
        assert stress[k] ** 2 == pytest.approx(1 - projected @ projected / (d @ d), abs=1e-12)
    assert mean_square_stress(problem, distances) == pytest.approx(np.mean(stress**2), rel=1e-12)
    assert stress_and_gradient(problem, z, w)[0] == pytest.approx(np.mean(stress**2), rel=1e-12)
    rescaled = w * [[10.0], [0.01]]
    assert stress_and_gradient(problem, z, rescaled)[0] == pytest.approx(np.mean(stress**2), rel=1e-9)


def test_coincident_points_leave_everything_finite():
    problem = make_problem(named([1, 2, 3, 4, 5, 6], 4))
    z = np.array([[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [1.0, 0.0]])
    for part in stress_and_gradient(problem, z, np.ones((1, 2))):
        assert np.all(np.isfinite(part))
    value, by_coordinates, _ = stress_and_gradient(problem, np.zeros((4, 2)), np.ones((1, 2)))
    assert value == 1
    assert not by_coordinates.any()
