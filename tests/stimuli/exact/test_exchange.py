"""Light from wall to wall: against Lambert's formula for polygons, closed forms, and graded quadrature."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import dblquad

from gloss_stimuli.exact.compiled import thread_count
from gloss_stimuli.exact.exchange import (
    apply_matrix,
    edge_rule,
    edge_weights,
    exchange_matrix,
    from_edge_cells,
    point_weights,
    relative_distance,
)
from gloss_stimuli.exact.levels import LEVELS
from gloss_stimuli.exact.nodes import make_nodes
from gloss_stimuli.exact.room import build_room
from tests.stimuli.exact.rooms import (
    by_graded_quadrature,
    corners_of,
    furnace,
    inward,
    kernel,
    plane,
    polygon_irradiance,
    rectangle,
    scene_of,
    wall_normals,
)

SCENE = scene_of()
ROOM = build_room(SCENE, width_over_gap=1.4)
NODES = make_nodes(ROOM, 3)
FINE = edge_rule(24)

NARROW = scene_of(  # opposite walls 1.5 checks apart: the least that the renderer takes
    box={"minimum": [-0.375, -1.0, -1.5], "maximum": [0.375, 1.5, 3.0]},
    sphere={"center": [0.0, -0.25, 0.0], "radius": 0.25},
    light={"center_xz": [0.0, 0.75], "size_xz": [0.4, 1.2]},
)
WHOLE_WALLS = scene_of(box={"minimum": [-1, -1, -1], "maximum": [1, 1, 1], "check_size": 1.25}, **{
    "sphere": {"center": [0.0, 0.0, 0.0], "radius": 0.3},
    "light": {"center_xz": [0.0, 0.0], "size_xz": [1.0, 1.0]},
    "camera": {"position": [0.0, 0.2, 0.9]},
})  # fmt: skip

PERPENDICULAR = [(wall, other) for wall in range(6) for other in range(6) if wall // 2 != other // 2]


def weights_of(room, nodes, rule, point: np.ndarray, wall: int, cell: int) -> np.ndarray:
    """Product-integration weights of one cell."""
    n, out = nodes.order, np.empty(nodes.order**2)
    ends = (*room.cell_low[cell], *room.cell_high[cell])
    edge_weights(
        room.box, *point, wall, int(room.cell_wall[cell]), *ends, nodes.powers, *rule, np.empty(n), np.empty(n), out
    )
    return out


def beside_the_edge(room, wall: int, other: int, gap: float, fraction: float) -> tuple[np.ndarray, int]:
    """A point of `wall` at a distance from the plane of `other`, and the cell of `other` straight across the edge."""
    point = np.array(room.box.low) + fraction * np.subtract(room.box.high, room.box.low)
    point[wall // 2] = plane(room, wall)
    point[other // 2] = plane(room, other) + gap * (1 - 2 * (other % 2))
    for cell in np.flatnonzero(room.cell_wall == other):
        corners = corners_of(room, cell)
        lowest, highest = corners.min(0), corners.max(0)
        along = 3 - wall // 2 - other // 2
        touches = np.abs(corners[:, wall // 2] - plane(room, wall)).min() < 1e-12
        if touches and lowest[along] <= point[along] < highest[along]:
            return point, int(cell)
    raise AssertionError("no cell there")


# --- product integration -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(("wall", "other"), PERPENDICULAR)
@pytest.mark.parametrize("gap", [0.3, 0.01, 0.001])
def test_a_polynomial_near_an_edge_is_integrated_in_every_orientation(wall: int, other: int, gap: float) -> None:
    # A quadratic that is different in either direction and from either end, so that no mirroring goes unseen.
    def radiosity(u, v):
        return 1 + 2 * u - 1.5 * v + u * v + 3 * v * v - 0.7 * u * u

    point, cell = beside_the_edge(ROOM, wall, other, gap, 0.37)
    u = NODES.abscissae
    values = radiosity(u, u[:, None]).ravel()
    expected = by_graded_quadrature(ROOM, point, wall, cell, radiosity)
    # 24 points; the integrand's poles lie π/2 off an interval of asinh(.5 / .001) = 7 at most: errors of 5e-9. Graded
    # quadrature itself is good to 1e-12.
    assert weights_of(ROOM, NODES, FINE, point, wall, cell) @ values == pytest.approx(expected, rel=2e-8)


@pytest.mark.parametrize(("level", "error"), [(0, 1.2e-4), (1, 1e-4), (2, 8e-6), (3, 4e-6), (4, 6e-7)])
def test_product_integration_at_each_level(level: int, error: float) -> None:
    # Errors of Gauss's rule with so many points on the interval of the substitution, at the first node and the first
    # texel of a cell, which are the nearest to an edge that are asked for. Measured: about half of these bounds.
    chosen = LEVELS[level]
    nodes, rule = make_nodes(ROOM, chosen.nodes), edge_rule(chosen.edge_points)
    texel = (1 - np.cos(np.pi / 2 / chosen.texels)) / 2
    for gap in (0.5 * nodes.abscissae[0], 0.5 * texel):
        for fraction in (0.11, 0.37, 0.5, 0.79):
            point, cell = beside_the_edge(ROOM, 0, 2, gap, fraction)
            expected = polygon_irradiance(corners_of(ROOM, cell), point, inward(0)) / np.pi
            found = weights_of(ROOM, nodes, rule, point, 0, cell).sum()
            assert found == pytest.approx(expected, abs=error), (gap, fraction, found - expected)


@given(gap=st.floats(2e-4, 0.6), fraction=st.floats(0.05, 0.95), pair=st.sampled_from(PERPENDICULAR))
@settings(max_examples=60, deadline=None)  # the first example compiles
def test_form_factors_are_lamberts(gap: float, fraction: float, pair: tuple[int, int]) -> None:
    wall, other = pair
    point, cell = beside_the_edge(ROOM, wall, other, gap, fraction)
    expected = polygon_irradiance(corners_of(ROOM, cell), point, inward(wall)) / np.pi
    # As above; and Lambert's sum of edges cancels to 1e-9 where the point is close to the edge's own line.
    assert weights_of(ROOM, NODES, FINE, point, wall, cell).sum() == pytest.approx(expected, abs=2e-8)


def test_dblquad_agrees() -> None:
    # A third opinion, far enough from the edge for adaptive quadrature.
    point, cell = beside_the_edge(ROOM, 4, 3, 0.05, 0.4)
    (low_z, low_x), (high_z, high_x) = ROOM.cell_low[cell], ROOM.cell_high[cell]

    def integrand(z: float, x: float) -> float:
        source = np.array([x, plane(ROOM, 3), z])
        return float(kernel(point, 4, source, 3)) * (1 + x * z)

    expected, _ = dblquad(integrand, low_x, high_x, low_z, high_z, epsabs=1e-9)
    nodes = NODES.points[NODES.cell == cell]
    values = 1 + nodes[:, 0] * nodes[:, 2]
    assert weights_of(ROOM, NODES, FINE, point, 4, cell) @ values == pytest.approx(expected, abs=1e-8)  # dblquad's


@pytest.mark.parametrize(("wall", "other"), [(0, 2), (3, 1), (5, 2), (2, 5)])
def test_half_of_the_view_is_filled_by_the_wall_at_the_edge(wall: int, other: int) -> None:
    # The whole row of cells of `other` that touch `wall`, from ever closer: 1/2 (1 - gap / √(gap² + depth²)) for an
    # endless strip. The ends of the room, l = 1.25 or more away, cut off gap depth² / (3π l³) = .014 gap of it.
    for gap in (1e-2, 1e-3, 2e-4):
        point, cell = beside_the_edge(ROOM, wall, other, gap, 0.5)
        strip = [
            c for c in np.flatnonzero(ROOM.cell_wall == other)
            if np.abs(corners_of(ROOM, c)[:, wall // 2] - plane(ROOM, wall)).min() < 1e-12
        ]  # fmt: skip
        total = sum(weights_of(ROOM, NODES, FINE, point, wall, c).sum() for c in strip)
        depth = np.ptp(corners_of(ROOM, cell)[:, wall // 2])
        assert total == pytest.approx((1 - gap / np.hypot(gap, depth)) / 2, abs=0.02 * gap + 1e-7)
    # Closer than 2e-4 of a cell the point is taken there: half, less a depth in 5,000.
    point[other // 2] = plane(ROOM, other)
    total = sum(weights_of(ROOM, NODES, FINE, point, wall, c).sum() for c in strip)
    assert total == pytest.approx(0.5, abs=1.1e-4)


# --- plain Gauss points ------------------------------------------------------------------------------------------


def test_far_cells_are_summed_as_points() -> None:
    rng, out = np.random.default_rng(3), np.empty(9)
    for _ in range(40):
        i, cell = rng.integers(len(NODES.points)), rng.integers(len(ROOM.cell_wall))
        wall, other = int(NODES.wall[i]), int(ROOM.cell_wall[cell])
        if wall == other:
            continue
        at = NODES.cell == cell
        point_weights(*NODES.points[i], wall, other, cell, NODES.points, NODES.weights, 3, out)
        expected = NODES.weights[at] * kernel(NODES.points[i], wall, NODES.points[at], other)
        assert out == pytest.approx(expected, rel=1e-12)  # rounding


def test_relative_distance_is_the_way_to_the_nearest_point_of_the_cell() -> None:
    rng = np.random.default_rng(4)
    for _ in range(60):
        cell = rng.integers(len(ROOM.cell_wall))
        point = rng.uniform(ROOM.box.low, ROOM.box.high)
        corners = corners_of(ROOM, cell)
        nearest = np.clip(point, corners.min(0), corners.max(0))
        expected = np.linalg.norm(point - nearest) / np.ptp(corners, axis=0).max()
        ends = (*ROOM.cell_low[cell], *ROOM.cell_high[cell])
        found = relative_distance(ROOM.box, *point, int(ROOM.cell_wall[cell]), *ends)
        assert found == pytest.approx(expected, rel=1e-12)  # rounding


# --- the matrix ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("scene", "level", "error"),
    [
        # Measured 3.3e-5 and 5.1e-7 for the shipped scene; the first is product integration with 8 points, the second
        # float32. Where walls are 1.5 checks apart, points on the opposite wall add their error: 4.6e-5 and 1.5e-6.
        (SCENE, 0, 6e-5), (SCENE, 2, 1e-6), (NARROW, 0, 8e-5), (NARROW, 2, 3e-6), (WHOLE_WALLS, 2, 3e-6),
    ],
)  # fmt: skip
def test_view_factors_of_a_closed_room_sum_to_one(scene, level: int, error: float) -> None:
    chosen = LEVELS[level]
    room = furnace(build_room(scene, width_over_gap=chosen.width_over_gap), 1.0)
    nodes = make_nodes(room, chosen.nodes)
    matrix = exchange_matrix(room, nodes, edge_rule(chosen.edge_points))
    assert np.abs(matrix.sum(1, dtype=np.float64) - 1).max() < error


def test_walls_see_each_other_as_lambert_says() -> None:
    # Row sums alone would not notice two walls exchanged.
    room = furnace(ROOM, 1.0)
    matrix = exchange_matrix(room, NODES, edge_rule(13)).astype(float)
    low, high = np.array(ROOM.box.low), np.array(ROOM.box.high)
    rng = np.random.default_rng(0)
    for i in rng.integers(0, len(NODES.points), 40):
        for other in range(6):
            a, b = (other // 2 + 1) % 3, (other // 2 + 2) % 3
            whole = rectangle(other, plane(ROOM, other), low[[a, b]], high[[a, b]])
            seen = 0.0 if other == NODES.wall[i] else polygon_irradiance(
                whole, NODES.points[i], inward(int(NODES.wall[i]))
            ) / np.pi  # fmt: skip
            # 3 × 3 points for a cell 1.25 widths away: 3e-5
            assert matrix[i, NODES.wall == other].sum() == pytest.approx(seen, abs=5e-5)


def test_the_light_and_the_points_own_wall_give_nothing() -> None:
    matrix = exchange_matrix(ROOM, NODES, edge_rule(8))
    assert (matrix[:, ROOM.is_light[NODES.cell]] == 0).all()
    assert (matrix[NODES.wall[:, None] == NODES.wall] == 0).all()
    elsewhere = (NODES.wall[:, None] != NODES.wall) & ~ROOM.is_light[NODES.cell]
    # Product integration's weights of single nodes may fall below zero, but no node of a cell far away does.
    assert (matrix[elsewhere] != 0).all()


def test_exchange_is_reciprocal() -> None:
    # Area-weighted, the exact kernel is symmetric; product integration moves weight among the nodes of one cell only.
    # So the flux between whole cells is: to 3 × 3 points' accuracy of the outer integral, whose slope is infinite where
    # cells share an edge. Measured: .9 % there.
    room = furnace(ROOM, 1.0)
    matrix = exchange_matrix(room, NODES, edge_rule(13)).astype(float)
    flux = (NODES.weights[:, None] * matrix).reshape(len(room.cell_wall), 9, -1, 9).sum((1, 3))
    assert np.abs(flux - flux.T).max() < 0.02 * flux.max()
    near = np.array([
        [np.linalg.norm(np.maximum(np.maximum(p.min(0) - q.max(0), q.min(0) - p.max(0)), 0)) for q in CORNERS]
        for p in CORNERS
    ])  # fmt: skip
    far = near > 1.0  # beyond NEAR_WIDTHS: plain points both ways, so symmetric to float32
    assert np.abs(flux - flux.T)[far].max() < 1e-6 * flux[far].max()


CORNERS = [corners_of(ROOM, cell) for cell in range(len(ROOM.cell_wall))]


# --- cells across an edge -----------------------------------------------------------------------------------------


def test_edge_cells_give_what_lambert_says() -> None:
    rng = np.random.default_rng(6)
    walls = np.repeat(np.arange(6), 8)
    points = rng.uniform(ROOM.box.low, ROOM.box.high, (48, 3))
    points[np.arange(48), walls // 2] = [plane(ROOM, wall) for wall in walls]
    radiosity = np.stack([np.ones(len(NODES.points)), np.arange(305).repeat(9)], axis=1)
    found = from_edge_cells(ROOM, NODES, FINE, points, walls, radiosity)
    for point, wall, values in zip(points, walls, found, strict=True):
        cells = [c for c in ROOM.edge_cells[wall] if c >= 0 and not ROOM.is_light[c]]
        seen = np.array([polygon_irradiance(CORNERS[c], point, inward(wall)) / np.pi for c in cells])
        assert values[0] == pytest.approx(seen.sum(), abs=3e-5)  # 3 × 3 points for cells 1.25 widths away
        assert values[1] == pytest.approx(seen @ cells, abs=300 * 3e-5)  # a different number for each cell


def test_edge_cells_are_the_same_in_the_matrix() -> None:
    rule = edge_rule(8)
    matrix = exchange_matrix(ROOM, NODES, rule)
    radiosity = np.random.default_rng(1).random((len(NODES.points), 2))
    found = from_edge_cells(ROOM, NODES, rule, NODES.points, NODES.wall, radiosity)
    for wall in range(6):
        cells = ROOM.edge_cells[wall]
        columns = np.isin(NODES.cell, cells[cells >= 0])
        rows = NODES.wall == wall
        expected = matrix[np.ix_(rows, columns)].astype(float) @ radiosity[columns]
        assert found[rows] == pytest.approx(expected, abs=1e-6)  # float32, some 500 terms below .1


# --- the product --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", [(1, 1), (7, 7), (123, 123)])
def test_product_is_numpys(shape: tuple[int, int]) -> None:
    rng = np.random.default_rng(0)
    matrix = rng.standard_normal(shape).astype(np.float32)
    vectors = rng.standard_normal((shape[1], 3))
    assert apply_matrix(matrix, vectors) == pytest.approx(matrix.astype(float) @ vectors, abs=1e-12)  # rounding


def test_any_number_of_threads_gives_the_same_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(0)
    vectors = rng.standard_normal((len(NODES.points), 2))
    results = []
    for threads in ("1", "2", "3"):
        monkeypatch.setenv("NUMBA_NUM_THREADS", threads)
        assert thread_count() == int(threads)
        matrix = exchange_matrix(ROOM, NODES, edge_rule(8))
        results.append((matrix.tobytes(), apply_matrix(matrix, vectors).tobytes()))
    assert results[0] == results[1] == results[2]


def test_normals_of_the_helpers_point_into_the_room() -> None:
    middle = np.mean([ROOM.box.low, ROOM.box.high], axis=0)
    walls = np.arange(6)
    planes = np.array([plane(ROOM, wall) for wall in walls])
    inside = middle @ np.abs(wall_normals(walls)).T
    assert (np.sign(inside - planes) == wall_normals(walls).sum(1)).all()
