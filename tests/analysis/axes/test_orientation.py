"""What the dimensions of a solution mean."""

import numpy as np
import pandas as pd
import pytest
from scipy.linalg import orthogonal_procrustes
from scipy.spatial.distance import pdist
from scipy.stats import linregress, ortho_group

from gloss_analysis.axes.orientation import (
    is_rotatable,
    matched_dimensions,
    oriented,
    rotated_to,
    rotation_cost,
    turned_along,
)
from gloss_analysis.axes.property_fitting import property_vector, property_vectors
from gloss_analysis.mds import scale
from gloss_analysis.mds.objective import source_distances
from glossspace.errors import GlossError
from tests.analysis.solutions import solution_of
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


def test_several_properties_are_fitted_at_once_in_three_dimensions():
    points = np.random.default_rng(5).standard_normal((30, 3))
    directions = np.array([[1.0, 0.0, 0.0], [0.5, np.sqrt(0.75), 0.0], [-1.0, 0.0, 0.0]])
    table = property_vectors(points, pd.DataFrame(points @ directions.T + 3, columns=["c", "d", "dullness"]))
    assert list(table.index) == ["c", "d", "dullness"]
    # 1e-9: least squares of well-conditioned points loses a few digits of sixteen; angles by arc cosine, half of them.
    found = table[["direction_1", "direction_2", "direction_3"]].to_numpy()
    assert found == pytest.approx(directions, abs=1e-9)
    assert table["r_squared"].to_numpy() == pytest.approx(np.ones(3), abs=1e-9)
    assert table.loc["d", ["angle_1_deg", "angle_2_deg", "angle_3_deg"]].tolist() == pytest.approx(
        [60, 30, 90], abs=1e-5
    )
    between = table[["angle_to_c_deg", "angle_to_d_deg", "angle_to_dullness_deg"]].to_numpy()
    assert between == pytest.approx(np.array([[0, 60, 180], [60, 0, 120], [180, 120, 0]]), abs=1e-5)


def test_the_p_value_of_a_property_is_that_of_regression():
    rng = np.random.default_rng(6)
    position, values = rng.standard_normal(12), rng.standard_normal(12)
    table = property_vectors(position[:, np.newaxis], pd.DataFrame({"c": values}))
    expected = linregress(position, values)  # its t test is the F test of one predictor
    assert table.loc["c", "r_squared"] == pytest.approx(expected.rvalue**2, abs=1e-12)
    assert table.loc["c", "p_value"] == pytest.approx(expected.pvalue, rel=1e-9)  # two ways through the beta function


def test_properties_that_any_configuration_would_fit_have_no_p_value():
    points = np.random.default_rng(7).standard_normal((4, 3))
    table = property_vectors(points, pd.DataFrame({"c": [1.0, 5.0, 2.0, 2.5]}))
    assert table.loc["c", "r_squared"] == pytest.approx(1, abs=1e-10)  # 3 dimensions for 4 numbers; rounding only
    assert np.isnan(table.loc["c", "p_value"])


@pytest.mark.parametrize(
    ("properties", "message"),
    [
        (pd.DataFrame([[1.0, 2.0]] * 4, columns=["c", "c"]), "names that differ"),
        (pd.DataFrame(index=range(4)), "names that differ"),
        (pd.DataFrame({"gloss": ["matt", "semi", "high", "high"]}), "'gloss' holds something else than numbers"),
        (pd.DataFrame({"c": [1.0, 2.0, 3.0, np.nan]}), "Property 'c': .* finite"),
        (pd.DataFrame({"c": [1.0, 2.0, 3.0]}), r"Property 'c': .*shape \(3,\) does not fit 4 stimuli"),
    ],
)
def test_unusable_properties_are_named(properties, message):
    with pytest.raises(GlossError, match=message):
        property_vectors(np.array([[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.5]]), properties)


def test_property_fitting_does_not_depend_on_units():
    rng = np.random.default_rng(8)
    points, values = rng.standard_normal((20, 2)), rng.standard_normal(20)
    small, large = property_vector(points, 1e-200 * values), property_vector(points, 1e200 * values)
    assert small.direction == pytest.approx(large.direction, abs=1e-12)  # the same regression, rounding only
    assert small.r_squared == pytest.approx(large.r_squared, abs=1e-12)


def test_fewer_properties_than_dimensions_are_matched():
    points = np.random.default_rng(9).standard_normal((20, 3))
    order, sign = matched_dimensions(points, -points[:, [2]])
    assert (order.tolist(), sign.tolist()) == ([2], [-1.0])
    with pytest.raises(GlossError, match="no more properties than dimensions"):
        matched_dimensions(points[:, :1], points)


def test_rotation_to_a_target_is_orthogonal_procrustes():
    rng = np.random.default_rng(10)
    points, target = rng.standard_normal((2, 12, 3))
    points, target = points - points.mean(axis=0), target - target.mean(axis=0)
    rotation, _ = orthogonal_procrustes(points, target)
    assert rotated_to(points, target) == pytest.approx(points @ rotation, abs=1e-12)  # one formula, rounding only


def test_a_target_of_fewer_dimensions_turns_the_first_ones():
    rng = np.random.default_rng(11)
    basis, _ = np.linalg.qr(np.column_stack([np.ones(20), rng.standard_normal((20, 4))]))
    known = basis[:, 1:] * [3.0, 2.0, 0.5, 1.0]  # centred, uncorrelated
    points = known @ ortho_group.rvs(4, random_state=3)
    turned = rotated_to(points, 7 * known[:, :2] + 1)
    assert turned[:, :2] == pytest.approx(known[:, :2], abs=1e-12)  # orthogonal matrices only: rounding
    rest = turned[:, 2:] * np.sign(np.sum(turned[:, 2:] * known[:, [3, 2]], axis=0))
    assert rest == pytest.approx(known[:, [3, 2]], abs=1e-12)  # principal axes, the larger one first
    assert pdist(turned) == pytest.approx(pdist(points), abs=1e-12)


@pytest.mark.parametrize(
    ("target", "message"),
    [
        (np.zeros((5, 2)), "all stimuli in one place"),
        (np.ones((4, 2)), r"shape \(4, 2\) does not fit a configuration of shape \(5, 2\)"),
        (np.ones((5, 3)), "1 to 2 dimensions"),
        (np.full((5, 2), np.nan), "target must be a finite table"),
        (np.ones(5), "target must be a finite table"),
    ],
)
def test_unusable_targets_are_refused(target, message):
    with pytest.raises(GlossError, match=message):
        rotated_to(np.random.default_rng(12).standard_normal((5, 2)), target)


def test_turning_along_properties_in_three_dimensions():
    rng = np.random.default_rng(13)
    points = rng.standard_normal((25, 3))
    first, second = points @ [1.0, 2.0, -1.0], points @ [0.0, 1.0, 1.0]
    turned = turned_along(points, first, second)
    assert pdist(turned) == pytest.approx(pdist(points), abs=1e-12)  # rounding only
    assert property_vector(turned, first).direction == pytest.approx([1, 0, 0], abs=1e-9)  # least squares, well posed
    rises = property_vector(turned, second).direction
    assert rises[1] > 0
    assert rises[2] == pytest.approx(0, abs=1e-9)
    # A property along the first settles nothing: the result is that of the first alone.
    assert turned_along(points, first, 3 * first) == pytest.approx(turned_along(points, first), abs=1e-9)


@pytest.mark.parametrize("model", ["identity", "generalised"])
def test_a_whole_solution_is_turned_without_changing_distances(model):
    rng = np.random.default_rng(14)
    points, target = rng.standard_normal((2, 9, 2))
    transforms = np.array([[[1.0, 0.3], [0.3, 0.6]], [[0.7, -0.2], [-0.2, 1.2]]])
    solution = solution_of(points, np.eye(2)[np.newaxis] if model == "identity" else transforms, model=model)
    turned = oriented(solution, target=target)
    assert turned.coordinates == pytest.approx(rotated_to(points, target), abs=1e-12)  # rounding only
    assert source_distances(turned.coordinates, turned.transforms) == pytest.approx(solution.distances, abs=1e-12)
    assert turned.dimension_weights == pytest.approx(np.linalg.norm(turned.transforms, axis=2), abs=1e-12)
    along = oriented(solution, properties=[points @ [1.0, 1.0]])
    assert property_vector(along.coordinates, points @ [1.0, 1.0]).direction == pytest.approx([1, 0], abs=1e-9)


def test_a_weighted_solution_is_turned_only_where_weights_are_alike():
    points = np.random.default_rng(15).standard_normal((8, 2))
    fixed = solution_of(points, np.array([[1.0, 0.5], [0.5, 1.0]]))
    assert not is_rotatable(fixed)
    with pytest.raises(GlossError, match="weighted solution in 2 dimensions are fixed up to order and sign"):
        oriented(fixed, target=points)
    alike = solution_of(points, np.ones((2, 2)))
    assert is_rotatable(alike)
    assert oriented(alike, target=points).coordinates == pytest.approx(points - points.mean(axis=0), abs=1e-12)
    with pytest.raises(GlossError, match="either a target or properties"):
        oriented(alike)


def test_rotation_cost_needs_the_data_of_the_solution():
    points = np.random.default_rng(16).standard_normal((5, 2))
    solution = solution_of(points, np.array([[1.0, 0.5]]))
    with pytest.raises(GlossError, match="other stimuli or participants than the data"):
        rotation_cost(named(np.arange(6), 4), solution, np.zeros(1))
