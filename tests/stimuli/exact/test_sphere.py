"""The sphere among the walls: against the view factor r² cosθ / d² of a whole sphere, Lambert's polygons, and rays."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gloss_stimuli.exact.levels import LEVELS
from gloss_stimuli.exact.nodes import Nodes, make_nodes
from gloss_stimuli.exact.room import Room, build_room
from gloss_stimuli.exact.sphere import (
    FEWEST_RAYS,
    cone,
    cone_ray,
    hide_walls,
    rays_of_cone,
    sphere_grid,
    sphere_texels,
    sphere_to_walls,
    to_sphere,
    walls_to_sphere,
)
from gloss_stimuli.scene import Scene
from tests.stimuli.exact.rooms import (
    Enclosure,
    cosine_directions,
    furnace,
    inward,
    polygon_irradiance,
    rectangle,
    scene_of,
    view_factor,
    wall_normals,
)

SCENE = scene_of()
ASIDE = scene_of(sphere={"center": [0.6, -0.2, 0.9], "radius": 0.45})
ROOMS = {"shipped": SCENE, "aside": ASIDE}


def room_and_nodes(scene: Scene, order: int = 2) -> tuple[Room, Nodes]:
    room = build_room(scene, width_over_gap=1.4)
    return room, make_nodes(room, order)


def hidden_matrix(room: Room, nodes: Nodes, rays: int, seed: int = 0) -> np.ndarray:
    """What the sphere hides, alone."""
    matrix = np.zeros((len(nodes.points),) * 2, np.float32)
    hide_walls(room, nodes, np.random.default_rng(seed).random((len(nodes.points), 2)), rays, matrix)
    return -matrix.astype(float)


def returned(room: Room, nodes: Nodes, rays: int, texture: np.ndarray, seed: int = 0) -> np.ndarray:
    shifts = np.random.default_rng(seed).random((len(nodes.points), 2))
    return sphere_to_walls(room, nodes, shifts, rays, texture)


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


# --- the cone of the sphere ------------------------------------------------------------------------------------------


@given(
    st.tuples(st.floats(0, 1), st.floats(0, 1), st.floats(0, 1)), st.integers(0, 5), st.floats(0, 1), st.floats(0, 6)
)
@settings(max_examples=80, deadline=None)  # the first example compiles
def test_rays_of_the_cone_are_those_that_meet_the_sphere(place: tuple, wall: int, part: float, turn: float) -> None:
    enclosure, room = Enclosure(ASIDE), build_room(ASIDE, width_over_gap=np.inf)
    point = enclosure.low + np.array(place) * (enclosure.high - enclosure.low)
    point[wall // 2] = (enclosure.low, enclosure.high)[wall % 2][wall // 2]
    seen, distance, spread = cone(room.box, *point)
    axis = np.array(seen[:3])
    assert distance == pytest.approx(np.linalg.norm(enclosure.center - point), rel=1e-14)  # rounding, here and below
    assert axis * distance == pytest.approx(enclosure.center - point, abs=1e-14)
    assert 1 - spread == pytest.approx(np.sqrt(1 - (ASIDE.sphere.radius / distance) ** 2), rel=1e-13)

    def met(u: float) -> tuple[bool, float, float]:
        *direction, cosine = cone_ray(seen, u, turn)
        assert np.linalg.norm(direction) == pytest.approx(1, abs=1e-14)
        assert axis @ direction == pytest.approx(cosine, abs=1e-14)
        assert 1 - cosine == pytest.approx(u * spread, rel=1e-9, abs=1e-15)  # even over solid angle
        hit, way = enclosure.meets_sphere(point[None], np.array([direction]))
        return bool(hit[0]), float(way[0]), cosine

    hit, way, cosine = met(part * (1 - 1e-9))
    assert hit
    # at the rim the way is a root of 1e-9 d²: rounding of d² = 20 there is 4e-15 / 2e-4
    assert to_sphere(distance, cosine, ASIDE.sphere.radius) == pytest.approx(way, abs=1e-9)
    assert not met(1 + 1e-9)[0]


def test_rays_of_the_cone_turn_once_about_its_axis() -> None:
    room = build_room(ASIDE, width_over_gap=np.inf)
    seen, _, spread = cone(room.box, 0.2, -1.0, 2.5)
    directions = np.array([cone_ray(seen, 0.7, turn)[:3] for turn in np.arange(12) / 12])
    # Twelve even turns: neighbours lie at equal angles and the mean is along the axis, shorter by the cosine.
    assert directions.mean(0) == pytest.approx((1 - 0.7 * spread) * np.array(seen[:3]), abs=1e-14)
    beside = (directions * np.roll(directions, 1, axis=0)).sum(1)
    assert np.ptp(beside) < 1e-14
    assert cone_ray(seen, 0.7, 1.25) == pytest.approx(cone_ray(seen, 0.7, 0.25), abs=1e-13)


def test_narrow_cones_get_fewer_rays_but_never_few() -> None:
    # "Rays that give every cone the same error": n rays of a cone that fills a share F of the view err by F n^-3/4, so
    # n goes as F^(4/3).
    for spread in (1.0, 0.3, 0.05):
        share = spread * (2 - spread)
        n = rays_of_cone(100_000, spread)
        assert share * n**-0.75 == pytest.approx(100_000**-0.75, rel=1e-3)  # n is a whole number, 450 at least
    assert rays_of_cone(1000, 1e-6) == FEWEST_RAYS


# --- hidden and returned ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ROOMS)
def test_sphere_hides_its_view_factor_and_returns_it(name: str) -> None:
    # Every node sees the whole sphere above its horizon, also in corners.
    room, nodes = room_and_nodes(ROOMS[name])
    expected = view_factor(ROOMS[name], nodes.points, wall_normals(nodes.wall))
    assert expected.min() > 1e-4
    rays = 16384
    hidden = hidden_matrix(room, nodes, rays).sum(1)
    back = returned(room, nodes, rays, np.ones((16, 32, 1)))[:, 0]
    # Rays hide and return the same to rounding (hidden: of float32), …
    assert hidden == pytest.approx(back, abs=1e-6)
    # … which is the closed form to the error that `rays_of_cone` states, n^-3/4, of a cone that fills the view.
    assert hidden == pytest.approx(expected, abs=3 * rays**-0.75)
    assert rms(hidden - expected) < rays**-0.75


def test_errors_fall_with_the_rays_as_stated_and_are_alike_for_all_cones() -> None:
    # Half of the sphere is lit, so the cone has a jump across. What two shifts of the lattice differ by is its error.
    room, nodes = room_and_nodes(SCENE)
    texture = np.zeros((64, 128, 1))
    texture[:, 20:84] = 1
    share = view_factor(SCENE, nodes.points, wall_normals(nodes.wall))

    def errors(rays: int) -> np.ndarray:
        return (returned(room, nodes, rays, texture, 0) - returned(room, nodes, rays, texture, 1))[:, 0] / np.sqrt(2)

    few, many = errors(8192), errors(65_536)
    # "n of them err by n^-3/4": 4.8 for 8 times as many, where random rays would give 2.8. The lattice does better.
    assert rms(few) / rms(many) > 4.8
    assert rms(few) < 8192**-0.75
    assert rms(many) < 65_536**-0.75
    # Cones of a hundredth of the view get a hundredth of the rays, yet err by no more than the widest, nor much less.
    narrow, wide = rms(few[share < 0.02]), rms(few[share > 0.03])
    assert 0.3 < narrow / wide < 1.5


def test_bright_and_dark_checks_are_hidden_where_they_lie() -> None:
    # Row sums do not know which wall is behind: here the checks of the shipped room, against rays in plain numpy.
    room, nodes = room_and_nodes(SCENE, order=3)
    enclosure = Enclosure(SCENE)
    hidden = hidden_matrix(room, nodes, 65_536) @ nodes.reflectance
    numbers = np.random.default_rng(1).integers(0, len(nodes.points), 25)
    for i in numbers:
        directions = cosine_directions(inward(int(nodes.wall[i])), 16, seed=int(i))
        origins = np.broadcast_to(nodes.points[i], directions.shape)
        met, _ = enclosure.meets_sphere(origins, directions)
        wall, points = enclosure.leave(nodes.points[i], directions[met])
        expected = enclosure.reflectance(wall, points).sum() / len(directions)
        # 2^16 Sobol' points of an integrand with jumps: some 2e-4 of the view; the lattice adds 65,536^-3/4 = 2e-4
        assert hidden[i] == pytest.approx(expected, abs=8e-4)


def test_polynomials_behind_the_sphere_are_taken_at_the_rays_end() -> None:
    # A radiosity that is a global quadratic of the place is its own interpolant, so lattice and Sobol' points agree.
    room, nodes = room_and_nodes(ASIDE, order=3)
    enclosure = Enclosure(ASIDE)

    def radiosity(points: np.ndarray) -> np.ndarray:
        x, y, z = points.T
        return 1 + 0.3 * x - 0.2 * y + 0.1 * z + 0.1 * x * y - 0.05 * z * z

    hidden = hidden_matrix(room, nodes, 65_536) @ radiosity(nodes.points)
    for i in np.random.default_rng(2).integers(0, len(nodes.points), 25):
        directions = cosine_directions(inward(int(nodes.wall[i])), 15, seed=int(i))
        met, _ = enclosure.meets_sphere(np.broadcast_to(nodes.points[i], directions.shape), directions)
        _, points = enclosure.leave(nodes.points[i], directions[met])
        assert hidden[i] == pytest.approx(radiosity(points).sum() / len(directions), abs=8e-4)  # as above


def test_returned_light_comes_from_the_side_that_faces_the_wall() -> None:
    # Radiosity 1 + n·g with g askew: the texture's normals, rows and columns, all of them are at stake.
    room, nodes = room_and_nodes(ASIDE, order=3)
    enclosure, g = Enclosure(ASIDE), np.array([0.5, -0.3, 0.2])
    texture = (1 + sphere_grid(64) @ g)[..., None]
    back = returned(room, nodes, 65_536, np.concatenate([texture, 2 * texture**2], axis=2))
    for i in np.random.default_rng(3).integers(0, len(nodes.points), 25):
        directions = cosine_directions(inward(int(nodes.wall[i])), 15, seed=int(i))
        met, way = enclosure.meets_sphere(np.broadcast_to(nodes.points[i], directions.shape), directions)
        hits = nodes.points[i] + way[met, None] * directions[met]
        values = 1 + (hits - enclosure.center) @ g / ASIDE.sphere.radius
        # as above; bilinear interpolation on 64 rows adds (π/64)²/8 = 3e-4 of what varies, times the view factor
        assert back[i, 0] == pytest.approx(values.sum() / len(directions), abs=8e-4)
        assert back[i, 1] == pytest.approx(2 * (values**2).sum() / len(directions), abs=2.5e-3)


# --- received --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    # Measured: largest 1.3e-3 and 6e-4, rms 2.3e-4 and 1.3e-4. A cell that the horizon runs through is summed as
    # points of an integrand with a kink.
    ("level", "largest", "typical"), [(0, 2.5e-3, 4e-4), (2, 1.2e-3, 2.5e-4)],
)  # fmt: skip
def test_in_a_uniform_room_the_sphere_receives_what_the_walls_give(level: int, largest: float, typical: float) -> None:
    chosen = LEVELS[level]
    room = furnace(build_room(SCENE, width_over_gap=chosen.width_over_gap), 1.0)
    nodes = make_nodes(room, chosen.nodes)
    received = walls_to_sphere(room, sphere_grid(24).reshape(-1, 3), nodes, np.ones((len(nodes.points), 1)))[:, 0]
    assert np.abs(received - 1).max() < largest
    assert rms(received - 1) < typical


@pytest.mark.parametrize("wall", range(6))
def test_one_lit_wall_is_lamberts_rectangle(wall: int) -> None:
    room, nodes = room_and_nodes(SCENE, order=5)
    normal = -inward(wall)  # of the sphere, facing the wall
    points = np.array(SCENE.sphere.center) + SCENE.sphere.radius * normal
    low, high = np.array(SCENE.box.minimum), np.array(SCENE.box.maximum)
    a, b = (wall // 2 + 1) % 3, (wall // 2 + 2) % 3
    corners = rectangle(wall, (low, high)[wall % 2][wall // 2], low[[a, b]], high[[a, b]])
    lit = (nodes.wall == wall).astype(float)
    received = walls_to_sphere(room, normal[None], nodes, np.stack([lit, 3 * lit], axis=1))[0]
    expected = polygon_irradiance(corners, points, normal) / np.pi
    assert received == pytest.approx([expected, 3 * expected], rel=1e-5)  # 5 × 5 points, 1.4 gaps apart


def test_walls_and_sphere_give_each_other_the_same() -> None:
    # Reciprocity: the flux that one lit wall sends to the sphere, and the one that a lit sphere sends to that wall.
    room, nodes = room_and_nodes(SCENE, order=3)
    back = returned(room, nodes, 65_536, np.ones((8, 16, 1)))[:, 0]
    grid = sphere_grid(48)
    edges = np.arange(49) * np.pi / 48
    solid_angles = (np.cos(edges[:-1]) - np.cos(edges[1:]))[:, None] * np.full(96, np.pi / 48)
    lit = (nodes.wall[:, None] == np.arange(6)).astype(float)
    received = walls_to_sphere(room, grid.reshape(-1, 3), nodes, lit)
    to_sphere_flux = SCENE.sphere.radius**2 * solid_angles.ravel() @ received
    to_walls_flux = (nodes.weights * back) @ lit
    # Midpoint sums over 48 rows, π²/24/48² = 2e-4, and the clipped cells above
    assert to_sphere_flux == pytest.approx(to_walls_flux, rel=6e-4)
    # The sphere gives away all that it has.
    assert to_walls_flux.sum() == pytest.approx(4 * np.pi * SCENE.sphere.radius**2, rel=1e-4)  # n^-3/4 over many nodes


# --- the grid of the sphere --------------------------------------------------------------------------------------


def test_grid_has_its_normals_at_the_middles() -> None:
    grid = sphere_grid(6)
    assert grid.shape == (6, 12, 3)
    assert np.linalg.norm(grid, axis=-1) == pytest.approx(np.ones((6, 12)), abs=1e-15)  # rounding
    assert np.degrees(np.arccos(grid[:, 0, 1])) == pytest.approx([15, 45, 75, 105, 135, 165], abs=1e-12)
    azimuth = np.degrees(np.arctan2(grid[3, :, 2], grid[3, :, 0])) % 360
    assert azimuth == pytest.approx(np.arange(15, 360, 30), abs=1e-12)


@pytest.mark.parametrize("rows", [2, 5, 16])
def test_a_texels_own_normal_looks_up_that_texel(rows: int) -> None:
    for row, line in enumerate(sphere_grid(rows)):
        for column, normal in enumerate(line):
            top, left, right, down, across = sphere_texels(*normal, rows)
            weights = np.zeros((rows, 2 * rows))
            weights[top, left] += (1 - down) * (1 - across)
            weights[top, right] += (1 - down) * across
            weights[top + 1, left] += down * (1 - across)
            weights[top + 1, right] += down * across
            weights[row, column] -= 1
            assert np.abs(weights).max() < 1e-12  # rounding of angles times 16 rows


@given(theta=st.floats(0, np.pi), phi=st.floats(-np.pi, np.pi))
@settings(max_examples=150, deadline=None)  # the first example compiles
def test_look_up_is_linear_between_texels_and_around_the_seam(theta: float, phi: float) -> None:
    rows = 12
    normal = (np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi))
    top, left, right, down, across = sphere_texels(*normal, rows)
    assert 0 <= top <= rows - 2
    assert right == (left + 1) % (2 * rows)
    assert 0 <= across <= 1
    # Rows count the polar angle; beyond the first and the last the line goes on, half a row at most. acos has lost half
    # of its digits at a pole.
    assert top + down == pytest.approx(theta * rows / np.pi - 0.5, abs=1e-6)
    assert -0.5 - 1e-6 <= down <= 1.5 + 1e-6
    if np.sin(theta) > 1e-6:
        turn = (left + across + 0.5) * np.pi / rows - phi
        assert np.cos(turn) == pytest.approx(1, abs=1e-12)
        assert np.sin(turn) == pytest.approx(0, abs=1e-9)  # rounding, over sinθ
