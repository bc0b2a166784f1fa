"""Conventions of weighted solutions: what each normalises, and that nobody's ratios of distances change."""

import numpy as np
import pytest
from scipy.spatial.distance import pdist

import gloss_analysis
from gloss_analysis.axes.indscal_conventions import CONVENTIONS, converted
from gloss_analysis.judgements.judgement_table import read_table
from gloss_analysis.mds import scale
from glossspace.errors import GlossError
from glossspace.files import shipped_folder

# Conversions multiply and divide by sizes near 1: what is left is rounding.
ROUNDING = 1e-12


@pytest.fixture
def solution():
    rng = np.random.default_rng(0)
    return rng.standard_normal((9, 3)) + 2, rng.uniform(0.2, 2, (4, 3))


def distances_of(coordinates, weights):
    return np.array([pdist(coordinates * one) for one in weights])


@pytest.mark.parametrize("to", CONVENTIONS)
def test_distances_change_by_the_stated_factor_only(solution, to):
    coordinates, weights = solution
    written = converted(coordinates, weights, to=to)
    expected = distances_of(coordinates, weights) * written.source_scale[:, np.newaxis]
    assert distances_of(written.coordinates, written.weights) == pytest.approx(expected, rel=ROUNDING)
    assert np.array([pdist(space) for space in written.spaces]) == pytest.approx(expected, rel=ROUNDING)
    assert written.coordinates.mean(axis=0) == pytest.approx(np.zeros(3), abs=ROUNDING)


@pytest.mark.parametrize("to", CONVENTIONS)
def test_every_convention_leads_back(solution, to):
    group = converted(*solution, to="group")
    away = converted(group.coordinates, group.weights, to=to)
    back = converted(away.coordinates, away.weights, to="group")
    assert back.coordinates == pytest.approx(group.coordinates, abs=ROUNDING)
    assert back.weights == pytest.approx(group.weights, abs=ROUNDING)
    assert back.source_scale * away.source_scale == pytest.approx(np.ones(4), abs=ROUNDING)


def test_group_is_the_convention_of_the_engine():
    data = read_table(shipped_folder(gloss_analysis.__file__, "data") / "helm1959.csv")
    found = scale(data, n_dims=2, n_starts=4)
    written = converted(found.coordinates, found.dimension_weights, to="group")
    assert written.coordinates == pytest.approx(found.coordinates, abs=ROUNDING)
    assert written.weights == pytest.approx(found.dimension_weights, abs=ROUNDING)


def test_group_normalises_own_spaces_and_the_average_weight(solution):
    written = converted(*solution, to="group")
    assert np.mean(written.spaces**2, axis=1).sum(axis=1) == pytest.approx(np.ones(4), abs=ROUNDING)
    assert np.mean(written.weights**2, axis=0) == pytest.approx(np.ones(3), abs=ROUNDING)


def test_unit_columns_leaves_distances_and_puts_sizes_into_weights(solution):
    written = converted(*solution, to="unit_columns")
    assert written.source_scale.tolist() == [1.0] * 4
    assert np.mean(written.coordinates**2, axis=0) == pytest.approx(np.ones(3), abs=ROUNDING)
    ours = converted(*solution, to="group")
    parts = converted(ours.coordinates, ours.weights, to="unit_columns").squared_weights
    assert parts.sum(axis=1) == pytest.approx(np.ones(4), abs=ROUNDING)
    assert parts == pytest.approx(np.mean(ours.spaces**2, axis=1), abs=ROUNDING)


def test_squared_weights_are_those_of_indscal(solution):
    written = converted(*solution, to="unit_sum_of_squares")
    x = written.coordinates
    assert np.sum(x**2, axis=0) == pytest.approx(np.ones(3), abs=ROUNDING)
    first, second = np.triu_indices(len(x), 1)
    squared = written.squared_weights @ ((x[first] - x[second]) ** 2).T  # Carroll & Chang's model
    assert np.sqrt(squared) == pytest.approx(distances_of(x, written.weights), rel=ROUNDING)
    products = [x @ np.diag(one) @ x.T for one in written.squared_weights]  # B_k = X W_k X'
    assert [np.sum(one**2) for one in products] == pytest.approx(np.ones(4), abs=ROUNDING)


def test_squared_weights_of_uncorrelated_dimensions_have_unit_length():
    square = np.array([[1.0, 2.0], [1.0, -2.0], [-1.0, 2.0], [-1.0, -2.0]])
    written = converted(square, np.array([[3.0, 1.0], [1.0, 1.0]]), to="unit_sum_of_squares")
    # Own spaces have columns of 3 and 2 (then 1 and 2), so squared weights as 9 : 4 (1 : 4), of unit length.
    expected = np.array([[9, 4] / np.hypot(9, 4), [1, 4] / np.hypot(1, 4)])
    assert written.squared_weights == pytest.approx(expected, abs=ROUNDING)


def test_proc_mds_and_proxscal_normalise_each_participant(solution):
    sas = converted(*solution, to="proc_mds")
    assert np.mean(sas.coordinates**2, axis=0) == pytest.approx(np.ones(3), abs=ROUNDING)
    assert np.mean(sas.weights**2, axis=1) == pytest.approx(np.ones(4), abs=ROUNDING)
    proxscal = converted(*solution, to="proxscal")
    mean_squares = np.mean(distances_of(proxscal.coordinates, proxscal.weights) ** 2, axis=1)
    assert mean_squares == pytest.approx(np.ones(4), abs=ROUNDING)


@pytest.mark.parametrize(
    ("coordinates", "weights", "to", "message"),
    [
        (np.eye(3), np.ones((2, 3)), "indscal", "Invalid convention 'indscal'. Allowed: 'group'"),
        (np.eye(3), np.ones((2, 2)), "group", r"shape \(3, 3\) and weights of shape \(2, 2\) do not fit"),
        (np.full((3, 2), np.nan), np.ones((2, 2)), "group", "finite numbers"),
        (np.eye(2), np.array([[1.0, -0.5]]), "group", "participant 1 in dimension 2 is -0.5"),
        (np.array([[1.0, 1.0], [2.0, 1.0]]), np.ones((1, 2)), "group", "Dimension 2 has no extent"),
        (np.eye(2), np.array([[1.0, 0.0], [2.0, 0.0]]), "group", "Dimension 2 has no extent"),
        (np.eye(2), np.array([[1.0, 2.0], [0.0, 0.0]]), "group", "participant 2 are 0"),
    ],
)
def test_what_cannot_be_normalised_is_refused(coordinates, weights, to, message):
    with pytest.raises(GlossError, match=message):
        converted(coordinates, weights, to=to)
