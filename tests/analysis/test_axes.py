"""What the dimensions of a solution mean."""

import numpy as np
import pytest

from gloss_analysis.axes import matched_dimensions, property_vector, rotated_to, rotation_cost, turned_along
from gloss_analysis.mds import scale
from glossspace.errors import GlossError
from tests.analysis.studies import judged_by, named


@pytest.mark.parametrize("angle_deg", [0.0, 30.0, 90.0])
def test_a_property_along_a_known_direction_is_found(angle_deg):
    points = np.random.default_rng(0).standard_normal((40, 2))
    direction = np.array([np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))])
    fitted = property_vector(points, 5 + 3 * points @ direction)
    assert fitted.direction == pytest.approx(direction, abs=1e-12)
    assert fitted.r_squared == pytest.approx(1, abs=1e-12)
    assert fitted.angle_deg == pytest.approx([angle_deg, 90 - angle_deg], abs=1e-6)


def test_r_squared_is_that_of_multiple_regression():
    rng = np.random.default_rng(1)
    points, noise = rng.standard_normal((60, 2)), rng.standard_normal(60)
    values = points @ [1.0, 0.5] + noise
    predicted = np.column_stack([np.ones(60), points])
    fitted = predicted @ np.linalg.solve(predicted.T @ predicted, predicted.T @ values)  # the normal equations
    expected = 1 - np.sum((values - fitted) ** 2) / np.sum((values - values.mean()) ** 2)
    assert property_vector(points, values).r_squared == pytest.approx(expected, abs=1e-10)


def test_a_property_that_does_not_differ_is_refused():
    # The mean of three times .1 is not .1 in floating point.
    with pytest.raises(GlossError, match="differs between the stimuli"):
        property_vector(np.eye(3), np.full(3, 0.1))
    with pytest.raises(GlossError, match="Matching needs finite properties and dimensions that differ"):
        matched_dimensions(np.eye(3)[:, :2], np.column_stack([np.full(3, 0.1), [1, 2, 3]]))


def test_a_property_unrelated_to_the_configuration_has_no_direction():
    square = np.array([[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]])
    with pytest.raises(GlossError, match="no direction there"):
        property_vector(square, np.array([1.0, -1.0, -1.0, 1.0]))  # saddle-shaped


def test_dimensions_are_matched_with_their_signs():
    properties = np.random.default_rng(2).standard_normal((20, 3))
    order, sign = matched_dimensions(properties[:, [2, 0, 1]] * [-1, 1, -1], properties)
    assert order.tolist() == [1, 2, 0]
    assert sign.tolist() == [1, -1, -1]


def test_rotation_towards_a_target_keeps_distances():
    target = np.random.default_rng(3).standard_normal((15, 2))
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    assert rotated_to(target @ turn + 4, target) == pytest.approx(target - target.mean(axis=0), abs=1e-12)


def test_turning_the_axes_costs_stress_only_where_participants_weigh_them_differently():
    differing = judged_by([0.6, 1.2, 2.4, 4.0])
    solution = scale(differing, n_dims=2, n_starts=6)
    cost = rotation_cost(differing, solution, np.array([-30.0, 0.0, 30.0]))
    assert cost[1] == pytest.approx(solution.stress1, abs=1e-4)  # weights fitted anew can only help a little
    assert min(cost[0], cost[2]) > cost[1] + 0.02
    alike = judged_by([1.78, 1.78])
    solution = scale(alike, n_dims=2, n_starts=6)
    cost = rotation_cost(alike, solution, np.array([-30.0, 0.0, 30.0]))
    assert np.ptp(cost) < 2e-3  # nothing but the play that order leaves


def test_rotation_cost_needs_a_weighted_plane():
    data = named([1, 2, 3, 4, 5, 6], 4)
    with pytest.raises(GlossError, match="weighted solution in two dimensions"):
        rotation_cost(data, scale(data, n_dims=2, model="identity"), np.zeros(1))


def test_property_fitting_turns_the_first_property_onto_the_first_dimension():
    # Points at (x, y); the properties x and y + x/2 rise at 0 and at atan(2) = 63.4 degrees.
    x, y = np.random.default_rng(4).standard_normal((2, 50))
    turn = np.array([[0.28, -0.96], [0.96, 0.28]]) @ np.diag([1, -1])
    seen = np.column_stack([x, y]) @ turn + 7
    turned = turned_along(seen, x, y + x / 2)
    assert turned == pytest.approx(np.column_stack([x - x.mean(), y - y.mean()]), abs=1e-12)
    lean = property_vector(turned, y + x / 2).angle_deg[1]
    assert lean == pytest.approx(90 - np.degrees(np.arctan(2)), abs=1e-9)
