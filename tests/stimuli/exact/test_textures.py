"""Fields as they are seen: against furnaces, and the integral equation itself by rays in plain numpy."""

from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.interpolate import RegularGridInterpolator

from gloss_stimuli.exact import textures
from gloss_stimuli.exact.direct import light_on_sphere, light_on_walls
from gloss_stimuli.exact.fields import FieldSolver
from gloss_stimuli.exact.levels import LEVELS, Level
from gloss_stimuli.exact.nodes import gauss_legendre, make_nodes, wall_points
from gloss_stimuli.exact.room import Room, build_room
from gloss_stimuli.exact.sphere import sphere_grid, walls_to_sphere
from gloss_stimuli.exact.textures import (
    add_radiance,
    patch_texture,
    refined,
    sphere_texture,
    texel_abscissae,
    texel_at,
    wall_texture,
)
from gloss_stimuli.scene import Scene
from tests.stimuli.exact.rooms import (
    Enclosure,
    by_graded_quadrature,
    corners_of,
    cosine_directions,
    furnace,
    inward,
    irradiance_by_rays,
    scene_of,
    wall_texture_reader,
)

SHIPPED = scene_of()
CUT = scene_of(  # checks cut by walls to a tenth, and by the light to a fifth
    box={"minimum": [-1.25, -1.0, -1.5], "maximum": [1.25, 1.5, 2.96], "check_size": 0.49},
    light={"center_xz": [0.1, 0.7], "size_xz": [1.3, 1.1]},
)
SCENES = {"shipped": SHIPPED, "cut checks": CUT}


class Solved(NamedTuple):
    scene: Scene
    level: Level
    room: Room
    solver: FieldSolver
    texture: np.ndarray


@cache
def solved(name: str, number: int) -> Solved:
    """A scene at a level, with more rays through the sphere's cone: chance is not the point here."""
    scene = SCENES[name]
    level = replace(LEVELS[number], cone_rays=2**15)
    room = build_room(scene, width_over_gap=level.width_over_gap)
    solver = FieldSolver(room, level, np.random.SeedSequence(0), "ward")
    texture = wall_texture(room, solver.nodes, level, solver.diffuse.walls, solver.light_at_nodes)
    return Solved(scene, level, room, solver, texture)


# --- texels --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [2, 12, 15, 30])
def test_texels_are_looked_up_where_they_lie(count: int) -> None:
    places = texel_abscissae(count)
    assert (np.diff(places) > 0).all()
    assert places + places[::-1] == pytest.approx(np.ones(count), abs=1e-15)  # rounding
    for number, place in enumerate(places):
        index, fraction = texel_at(place, count)
        assert index + fraction == pytest.approx(number, abs=1e-12)  # rounding of an angle, times 30
        assert 0 <= index <= count - 2


@given(u=st.floats(0, 1), count=st.integers(2, 40))
@settings(max_examples=120, deadline=None)  # the first example compiles
def test_look_up_is_linear_in_the_angle_and_constant_beyond_the_last_texel(u: float, count: int) -> None:
    index, fraction = texel_at(u, count)
    assert 0 <= index <= count - 2
    assert 0 <= fraction <= 1
    angles = np.arccos(1 - 2 * texel_abscissae(count))
    expected = np.interp(np.arccos(1 - 2 * u), angles, np.arange(count))
    assert index + fraction == pytest.approx(expected, abs=1e-6)  # acos has lost half of its digits at 0 and 1


# --- walls ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "number", "largest", "typical"),
    # Measured: 8.7e-3 and 1.6e-3, 3.1e-3 and 4.8e-4, 8.7e-3 and 8.7e-4; at level 2, 8e-4 and 1.2e-4. The largest are
    # where three walls meet.
    [("shipped", 0, 1.5e-2, 3e-3), ("shipped", 1, 6e-3, 1e-3), ("cut checks", 0, 1.5e-2, 2e-3)],
)
def test_a_uniform_field_gives_uniform_textures_up_to_the_edges(
    name: str, number: int, largest: float, typical: float
) -> None:
    # At an edge half of the field comes from across, which is integrated there, and the rest is splined.
    level = LEVELS[number]
    room = furnace(build_room(SCENES[name], width_over_gap=level.width_over_gap), 0.9)
    nodes = make_nodes(room, level.nodes)
    texture = wall_texture(room, nodes, level, np.ones((len(nodes.points), 2)) * [1, 5], None)
    assert texture.shape == (len(room.cell_wall), level.texels, level.texels, 2)
    error = texture[..., 0] - 1
    assert np.abs(error).max() < largest
    assert np.sqrt(np.mean(error**2)) < typical
    assert texture[..., 1] == pytest.approx(5 * texture[..., 0], rel=1e-12)  # rounding


def test_a_smooth_field_of_a_black_room_is_splined() -> None:
    # With nothing across the edges a cubic of the place is reproduced: not-a-knot splines through 5 and more nodes are
    # exact for cubics. Each wall with its own directions.
    room = furnace(build_room(CUT, width_over_gap=1.4), 0.0)
    nodes = make_nodes(room, 3)

    def cubic(points: np.ndarray) -> np.ndarray:
        x, y, z = np.moveaxis(points, -1, 0)
        return np.stack([1 + x - 2 * y + z**3 + x * x * y - y * z * z + x * y * z, y**3 - x**3], axis=-1)

    texture = wall_texture(room, nodes, LEVELS[0], cubic(nodes.points), None)
    points, _ = wall_points(room, texel_abscissae(LEVELS[0].texels))
    assert texture == pytest.approx(cubic(points), abs=1e-9)  # rounding, times the thinnest cell's steep splines


def test_the_light_is_added_exactly_and_to_the_first_field_alone() -> None:
    scene = scene_of(box={"dark_reflectance": 0.0, "light_reflectance": 0.0})
    room = build_room(scene, width_over_gap=1.4)
    solver = FieldSolver(room, LEVELS[0], np.random.SeedSequence(0), "ward")
    texture = wall_texture(room, solver.nodes, LEVELS[0], solver.diffuse.walls, solver.light_at_nodes)
    points, _ = wall_points(room, texel_abscissae(LEVELS[0].texels))
    walls = room.cell_wall.repeat(LEVELS[0].texels ** 2)
    light = light_on_walls(room, points.reshape(-1, 3), walls, lines=LEVELS[0].light_lines)
    # In a black room the light is all of E00, also where the shadow's edge is sharper than any polynomial.
    assert texture[..., 0].ravel() == pytest.approx(light, abs=1e-9 * light.max())  # rounding
    without = wall_texture(room, solver.nodes, LEVELS[0], solver.diffuse.walls, None)
    assert (without[..., 1:] == texture[..., 1:]).all()
    assert np.abs(without[..., 0] - texture[..., 0]).max() > 0.01 * light.max()


def test_what_the_polynomials_miss_is_added_from_the_cells_across_the_edge() -> None:
    # A deviation that differs between cells and along either side of them; 60 texels make it all but smooth.
    room, count = build_room(SHIPPED, width_over_gap=1.4), 60

    def deviation(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return 1 + 2 * u * u - 1.5 * v + u * v**3

    u = texel_abscissae(count)
    brightness = 1 + 0.01 * np.arange(len(room.cell_wall))
    missed = (brightness[:, None, None] * deviation(u, u[:, None]))[..., None] * [1.0, -2.0]
    points, walls = points_near_edges(SHIPPED, [0.3, 0.05, 0.01] * 3, seed=9)
    out = np.zeros((len(points), 2))
    textures._edge_pass(0, len(points), room, points, walls, *gauss_legendre(40), missed, out)
    for point, wall, found in zip(points, walls, out, strict=True):
        expected = 0.0
        for cell in np.flatnonzero(room.cell_wall // 2 != wall // 2):
            corners = corners_of(room, cell)
            way = point - np.clip(point, corners.min(0), corners.max(0))
            if np.linalg.norm(way) <= 0.5 * np.ptp(corners, axis=0).max() and room.reflectance[cell] > 0:
                received = by_graded_quadrature(room, point, int(wall), cell, deviation)
                expected += room.reflectance[cell] * brightness[cell] * received
        # Linear between 60 texels: (π / 60)² / 8 = 3e-4 of what varies; 40 points across its kinks
        assert found == pytest.approx([expected, -2 * expected], rel=2e-3, abs=2e-4)
    assert np.abs(out).max() > 0.5


def points_near_edges(scene: Scene, gaps: list[float], seed: int) -> tuple[np.ndarray, np.ndarray]:
    """For each wall a random point at each of these distances (in checks) from a random edge."""
    enclosure, rng = Enclosure(scene), np.random.default_rng(seed)
    points, walls = [], []
    for wall in range(6):
        for gap in gaps:
            point = rng.uniform(enclosure.low, enclosure.high)
            point[wall // 2] = (enclosure.low, enclosure.high)[wall % 2][wall // 2]
            axis = (wall // 2 + 1 + rng.integers(2)) % 3
            ends = enclosure.low[axis] + gap * scene.box.check_size, enclosure.high[axis] - gap * scene.box.check_size
            point[axis] = ends[rng.integers(2)]
            points.append(point)
            walls.append(wall)
    return np.array(points), np.array(walls)


@pytest.mark.parametrize(
    ("name", "number", "far", "near"),
    # Typical relative residual half a check and more from an edge, and within a tenth of a check of it. Measured with
    # eight times as many rays: 3e-4 (.15 % at most) and 2.5e-3 (.7 %) for the first.
    [("shipped", 1, 1e-3, 4e-3), ("cut checks", 0, 2e-3, 1e-2)],
)
def test_textures_solve_the_integral_equation(name: str, number: int, far: float, near: float) -> None:
    # Irradiance = light + what rays in every direction find on the textures themselves. The error of a solution is its
    # residual and what reflections keep of that, two fifths each time, so 1.7 times as much at most.
    found = solved(name, number)
    enclosure, read = Enclosure(found.scene), wall_texture_reader(found.room, found.texture)
    for gaps, error in (([0.6, 1.3], far), ([0.1, 0.03, 0.01], near)):
        points, walls = points_near_edges(found.scene, gaps, seed=7)
        light = light_on_walls(found.room, points, walls, lines=400)
        seen = read(walls, points)[:, 0]
        # 2^16 Sobol' directions err by 5e-4 where rays meet edges of checks.
        indirect = [
            irradiance_by_rays(enclosure, p, inward(w), read, power=16, seed=3)[0]
            for p, w in zip(points, walls, strict=True)
        ]
        residual = (light + indirect) / seen - 1
        assert np.sqrt(np.mean(residual**2)) < error, residual.round(5)
        assert np.abs(residual).max() < 4 * error, residual.round(5)
        assert abs(np.mean(residual)) < 0.7 * error, residual.round(5)


# --- patches -------------------------------------------------------------------------------------------------------


def test_patches_are_radiance_at_even_vertices() -> None:
    # Splines through the texels are exact for cubics, also beyond the last texel, at the cell's own edge.
    room = build_room(SHIPPED, width_over_gap=1.4)

    def cubic(b: np.ndarray, a: np.ndarray) -> np.ndarray:
        return 2 + a - 3 * b + a * b + a**3 - 2 * b**3 + a * a * b

    u = texel_abscissae(12)
    cells = 1 + 0.1 * np.arange(len(room.cell_wall))
    texture = cells[:, None, None, None] * np.stack([cubic(u[:, None], u), cubic(u, u[:, None])], axis=-1)
    patches = patch_texture(room, texture, 7)
    v = np.arange(8) / 7
    expected = np.stack([cubic(v[:, None], v), cubic(v, v[:, None])], axis=-1)
    radiance = (room.reflectance * cells / np.pi)[:, None, None, None] * expected
    assert patches.shape == (len(cells), 8, 8, 2)
    assert patches.flags.c_contiguous
    assert patches == pytest.approx(radiance, abs=1e-10 * cells.max())  # rounding of 30 × 8


@given(
    place=st.tuples(st.floats(0, 1), st.floats(0, 1), st.floats(0, 1)),
    way=st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(-1, 1)),
)
@settings(max_examples=120, deadline=None)  # the first example compiles
def test_a_ray_finds_the_patch_behind_its_end(place: tuple, way: tuple) -> None:
    direction = np.array(way)
    direction[np.abs(direction) < 1e-6] = 0
    if not direction.any():
        direction = np.array([0.3, -1.0, 0.2])
    direction /= np.linalg.norm(direction)
    origin = np.array(SHIPPED.sphere.center) + SHIPPED.sphere.radius * (np.array(place) - 0.5)
    enclosure = Enclosure(SHIPPED)
    wall, end = enclosure.leave(origin, direction[None])
    at_planes = np.minimum(np.abs(end[0] - enclosure.low), np.abs(end[0] - enclosure.high)) < 1e-9
    assume(at_planes.sum() == 1)  # a ray through an edge of the box may end on either wall
    total = np.array([10.0, 20.0])
    cell = add_radiance(
        PATCHED.box, PATCHED.grid, PATCHED.is_light, PATCHES, *origin, *direction, 0.5, total
    )  # fmt: skip
    along = end[0, [(wall[0] // 2 + 1) % 3, (wall[0] // 2 + 2) % 3]]
    # the cell, or its neighbour where two meet
    assert (PATCHED.cell_low[cell] - 1e-9 <= along).all()
    assert (along <= PATCHED.cell_high[cell] + 1e-9).all()
    if PATCHED.is_light[cell]:
        assert (total == [10, 20]).all()
        return
    assert PATCHED.cell_wall[cell] == wall[0]
    u = (along - PATCHED.cell_low[cell]) / (PATCHED.cell_high[cell] - PATCHED.cell_low[cell])
    even = np.arange(PATCHES.shape[1]) / (PATCHES.shape[1] - 1)
    expected = RegularGridInterpolator((even, even), PATCHES[cell].astype(float))(np.clip(u[::-1], 0, 1))[0]
    assert total == pytest.approx([10, 20] + 0.5 * expected, abs=1e-9)  # rounding, over the thinnest cell


PATCHED = build_room(SHIPPED, width_over_gap=1.4)
PATCHES = np.random.default_rng(0).random((len(PATCHED.cell_wall), 6, 6, 2)).astype(np.float32)


# --- the sphere ----------------------------------------------------------------------------------------------------


def test_sphere_texture_is_the_irradiance_of_its_own_normals() -> None:
    found = solved("shipped", 0)
    nodes, fields = found.solver.nodes, found.solver.diffuse.walls
    texture = sphere_texture(found.room, nodes, found.level, fields, with_light=True)
    rows = found.level.sphere_texture_rows
    assert texture.shape == (rows, 2 * rows, 4)
    grid = sphere_grid(rows)
    # Both poles, both sides of the seam in azimuth, and some in between
    picked = [0, 1, 2, 5, 40, 79, 80, 120, rows - 3, rows - 2, rows - 1], [0, 1, 3, 77, 160, 241, 2 * rows - 2, -1]
    normals = grid[np.ix_(*picked)]
    lit = fields * nodes.reflectance[:, None]
    expected = walls_to_sphere(found.room, normals.reshape(-1, 3), nodes, lit).reshape(*normals.shape[:2], 4)
    light = light_on_sphere(found.room, normals.reshape(-1, 3)).reshape(normals.shape[:2])
    there = texture[np.ix_(*picked)]
    # Splines of 40 rows. What is splined has kinks where the horizon crosses cells, which they do not follow.
    error = there - expected
    error[..., 0] -= light
    assert np.abs(error / expected).max() < 5e-3
    assert np.sqrt(np.mean((error / expected) ** 2)) < 1.5e-3  # measured: 7e-4 on the whole sphere, 1.1e-3 here
    bare = sphere_texture(found.room, nodes, found.level, fields, with_light=False)
    assert there[..., 0] - bare[np.ix_(*picked)][..., 0] == pytest.approx(light, abs=1e-9 * light.max())  # rounding
    assert (bare[..., 1:] == texture[..., 1:]).all()


def test_sphere_in_a_uniform_room_is_uniform() -> None:
    level = LEVELS[1]
    room = furnace(build_room(SHIPPED, width_over_gap=level.width_over_gap), 0.5)
    nodes = make_nodes(room, level.nodes)
    texture = sphere_texture(room, nodes, level, np.ones((len(nodes.points), 1)), with_light=False)
    # cells that the horizon runs through: 6e-4 at the most, 1.3e-4 rms in `test_sphere`, and splines overshoot
    assert texture == pytest.approx(np.full(texture.shape, 0.5), abs=0.5 * 2e-3)


def test_sphere_sees_the_walls_textures() -> None:
    # Rays from the sphere, in plain numpy, to what `wall_texture` says: polynomials through the nodes must not differ.
    found = solved("shipped", 1)
    texture = sphere_texture(found.room, found.solver.nodes, found.level, found.solver.diffuse.walls, with_light=False)
    read, enclosure = wall_texture_reader(found.room, found.texture), Enclosure(SHIPPED)
    rows, rng = found.level.sphere_texture_rows, np.random.default_rng(1)
    for row, column in zip(rng.integers(0, rows, 8), rng.integers(0, 2 * rows, 8), strict=True):
        normal = sphere_grid(rows)[row, column]
        origin = np.array(SHIPPED.sphere.center) + SHIPPED.sphere.radius * normal
        directions = cosine_directions(normal, 17, seed=5)
        wall, points = enclosure.leave(origin, directions)
        expected = (enclosure.reflectance(wall, points)[:, None] * read(wall, points)).mean(0)
        # 2^17 directions err by 1e-3 at most, as another seed tells; cells at the horizon by 6e-4 at most.
        assert texture[row, column] == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("factor", [1, 3])
def test_a_refined_texture_is_the_field_between_the_texels(factor: int) -> None:
    count, u = 15, texel_abscissae(15 * factor)

    def field(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return 1 + u - 2 * v**2 + u * v + np.exp(v)

    coarse = texel_abscissae(count)
    texture = field(coarse, coarse[:, None])[None, ..., None] * [1.0, -3.0]
    found = refined(texture, factor)
    assert found.shape == (1, count * factor, count * factor, 2)
    # A cubic spline at a spacing of h = π / 15 errs by 5 h⁴ / 384 = 3e-5 of the fourth derivative in θ, about one here.
    assert found[0, ..., 0] == pytest.approx(field(u, u[:, None]), abs=1e-4)
    assert found[..., 1] == pytest.approx(-3 * found[..., 0], rel=1e-12)  # rounding
    # Linear look-up of the texels themselves would err by h² / 8 = 5e-3.
    if factor == 1:
        assert found == pytest.approx(texture, abs=1e-12)
