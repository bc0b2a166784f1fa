"""Quadrature nodes and the polynomials through them: against closed forms and scipy's barycentric interpolation."""

from math import comb

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import BarycentricInterpolator

from gloss_stimuli.exact.nodes import gauss_legendre, lagrange, make_nodes, wall_points
from gloss_stimuli.exact.room import build_room
from tests.stimuli.exact.rooms import Enclosure, scene_of

SCENE = scene_of(box={"check_size": 0.35}, light={"center_xz": [0.1, 0.8], "size_xz": [0.9, 0.5]})
ROOM = build_room(SCENE, width_over_gap=1.4)
ORDERS = [2, 3, 4, 5, 7]


@pytest.mark.parametrize("count", [1, 2, 5, 13, 250])
def test_gauss_rule_integrates_powers_up_to_twice_its_points(count: int) -> None:
    x, w = gauss_legendre(count)
    for power in (0, 1, min(2 * count - 1, 40)):
        assert w @ x**power == pytest.approx(1 / (power + 1), rel=1e-13)  # numpy's own accuracy of the rule
    # … and not the next one: the error of x^2n is (n!)^4 / ((2n+1) ((2n)!)^2) on [0, 1] = 1 / ((2n+1) C(2n, n)^2).
    if count <= 5:
        error = 1 / ((2 * count + 1) * comb(2 * count, count) ** 2)
        assert 1 / (2 * count + 1) - w @ x ** (2 * count) == pytest.approx(error, rel=1e-8)  # 1e-7 left of 1e-15


@pytest.mark.parametrize("order", ORDERS)
def test_polynomials_through_the_nodes(order: int) -> None:
    nodes = make_nodes(ROOM, order)
    u = np.linspace(0, 1, 23)
    # Inverting a Vandermonde matrix of 7 nodes loses three digits.
    near = {"abs": 1e-12}
    assert nodes.values_at(nodes.abscissae) == pytest.approx(np.eye(order), **near)
    assert nodes.values_at(u).sum(1) == pytest.approx(np.ones(23), **near)
    expected = BarycentricInterpolator(nodes.abscissae, np.eye(order))(u)
    assert nodes.values_at(u) == pytest.approx(expected, **near)
    row = np.empty(order)
    for place, wanted in zip(u, expected, strict=True):
        lagrange(nodes.powers, place, row)
        assert row == pytest.approx(wanted, **near)


@given(coefficients=st.lists(st.floats(-1, 1), min_size=4, max_size=4), u=st.floats(0, 1))
@settings(max_examples=60, deadline=None)  # the first example compiles
def test_any_cubic_is_its_own_interpolant(coefficients: list[float], u: float) -> None:
    cubic = np.polynomial.Polynomial(coefficients)
    values = np.empty(4)
    lagrange(NODES.powers, u, values)
    assert values @ cubic(NODES.abscissae) == pytest.approx(cubic(u), abs=1e-13)  # rounding


NODES = make_nodes(ROOM, 4)


@pytest.mark.parametrize("order", ORDERS)
def test_weights_are_areas(order: int) -> None:
    nodes = make_nodes(ROOM, order)
    sides = ROOM.cell_high - ROOM.cell_low
    assert nodes.weights.reshape(-1, order**2).sum(1) == pytest.approx(sides.prod(1), rel=1e-13)  # rounding
    x, y, z = np.subtract(SCENE.box.maximum, SCENE.box.minimum)
    areas = [nodes.weights[nodes.wall == wall].sum() for wall in range(6)]
    assert areas == pytest.approx([y * z, y * z, z * x, z * x, x * y, x * y], rel=1e-12)
    assert (nodes.weights > 0).all()


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("wall", range(6))
def test_polynomials_over_a_wall_are_integrated_exactly(order: int, wall: int) -> None:
    # In the wall's own two directions, each to the highest power that Gauss's rule of n points has exact.
    nodes = make_nodes(ROOM, order)
    here = nodes.wall == wall
    axis = wall // 2
    a, b, power = (axis + 1) % 3, (axis + 2) % 3, 2 * order - 1
    low, high = np.array(SCENE.box.minimum), np.array(SCENE.box.maximum)
    moments = (high ** (power + 1) - low ** (power + 1)) / (power + 1)
    total = nodes.weights[here] @ (nodes.points[here, a] ** power * nodes.points[here, b] ** power)
    scale = nodes.weights[here] @ np.abs(nodes.points[here, a] * nodes.points[here, b]) ** power
    assert total == pytest.approx(moments[a] * moments[b], abs=1e-12 * scale)  # rounding of sums of both signs


@pytest.mark.parametrize("order", [3, 4])
def test_nodes_lie_where_their_number_says(order: int) -> None:
    nodes = make_nodes(ROOM, order)
    enclosure = Enclosure(SCENE)
    assert (nodes.cell == np.arange(len(nodes.points)) // order**2).all()
    for number in np.random.default_rng(0).integers(0, len(nodes.points), 200):
        cell, b, a = number // order**2, number // order % order, number % order
        wall = ROOM.cell_wall[cell]
        assert nodes.wall[number] == wall
        begin, end = ROOM.cell_low[cell], ROOM.cell_high[cell]
        expected = np.full(3, (enclosure.low, enclosure.high)[wall % 2][wall // 2])
        expected[(wall // 2 + 1) % 3] = begin[0] + nodes.abscissae[a] * (end[0] - begin[0])
        expected[(wall // 2 + 2) % 3] = begin[1] + nodes.abscissae[b] * (end[1] - begin[1])
        assert nodes.points[number] == pytest.approx(expected, abs=1e-15)  # rounding
    assert (nodes.reflectance == enclosure.reflectance(nodes.wall, nodes.points)).all()


def test_wall_points_are_where_a_grid_of_any_coordinates_says() -> None:
    u = np.array([0.0, 0.3, 1.0])
    points, sides = wall_points(ROOM, u)
    assert points.shape == (len(ROOM.cell_wall), 3, 3, 3)
    assert (sides == ROOM.cell_high - ROOM.cell_low).all()
    cell = int(ROOM.wall_start[5]) + 1  # on z = 3, whose a runs along x and b along y
    (low_x, low_y), (side_x, side_y) = ROOM.cell_low[cell], sides[cell]
    assert points[cell, 0, 2] == pytest.approx([low_x + side_x, low_y, 3.0], abs=1e-15)  # (b, a) = (0, 1)
    assert points[cell, 1, 0] == pytest.approx([low_x, low_y + 0.3 * side_y, 3.0], abs=1e-15)
