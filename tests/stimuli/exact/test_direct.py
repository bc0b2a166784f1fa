"""Irradiance from the light: against Lambert's polygons, closed fluxes, and the light cut into a million pieces."""

from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gloss_stimuli.exact.direct import light_on_sphere, light_on_walls
from gloss_stimuli.exact.levels import LEVELS
from gloss_stimuli.exact.nodes import gauss_legendre, make_nodes
from gloss_stimuli.exact.room import Room, build_room
from gloss_stimuli.scene import Scene
from tests.stimuli.exact.rooms import (
    CEILING,
    Enclosure,
    inward,
    light_rectangle,
    polygon_irradiance,
    scene_of,
    sphere_quadrature,
    wall_normals,
)

SHIPPED = scene_of()
UMBRA = scene_of(  # a sphere wider than the light: its shadow has a core
    sphere={"center": [0.2, 0.0, 0.6], "radius": 0.7}, light={"center_xz": [0.1, 0.7], "size_xz": [0.5, 0.3]}
)
BESIDE = scene_of(  # the shadow falls on a side wall
    sphere={"center": [0.5, -0.25, 0.75]}, light={"center_xz": [0.0, 0.75], "size_xz": [1.2, 1.2]}
)
LUMINANCE = 1000.0


def room_of(scene: Scene) -> Room:
    return build_room(scene, width_over_gap=1.4)


def points_on_walls(scene: Scene, count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Random points of the walls but the ceiling, `count` on each."""
    enclosure = Enclosure(scene)
    walls = np.repeat([0, 1, 2, 4, 5], count)
    points = np.random.default_rng(seed).uniform(enclosure.low, enclosure.high, (len(walls), 3))
    points[np.arange(len(walls)), walls // 2] = [(enclosure.low, enclosure.high)[w % 2][w // 2] for w in walls]
    return points, walls


def by_pieces(scene: Scene, point: np.ndarray, normal: np.ndarray, side: int, *, shadow: bool = True) -> float:
    """Irradiance from side² pieces of the light, each as a point that the sphere hides or does not."""
    (x, z), (width, depth) = scene.light.center_xz, scene.light.size_xz
    place = (np.arange(side) + 0.5) / side - 0.5
    light = np.full((side, side, 3), scene.box.maximum[1])
    light[..., 0], light[..., 2] = x + width * place[:, None], z + depth * place
    way = light.reshape(-1, 3) - point
    r2 = (way**2).sum(1)
    seen = np.maximum(way @ normal, 0) * way[:, 1] / r2**2
    if shadow:
        seen[Enclosure(scene).meets_sphere(np.broadcast_to(point, way.shape), way)[0]] = 0
    return scene.light.luminance_cd_m2 * seen.sum() * width * depth / side**2


# --- walls without the sphere --------------------------------------------------------------------------------------


@pytest.mark.parametrize("scene", [SHIPPED, UMBRA], ids=["shipped", "small light aside"])
def test_without_the_sphere_every_wall_sees_lamberts_rectangle(scene: Scene) -> None:
    points, walls = points_on_walls(scene, 40, 0)
    found = light_on_walls(room_of(scene), points, walls, lines=90, shadow=False)
    corners = light_rectangle(scene)
    expected = [LUMINANCE * polygon_irradiance(corners, p, inward(w)) for p, w in zip(points, walls, strict=True)]
    # 90 Gauss points along z. The integrand's poles lie off the light by a point's distance from the plane through a
    # line of the light, at least .15 here, so Gauss's rule is exact; Lambert's sum cancels to 1e-12.
    assert found == pytest.approx(expected, rel=1e-9)


def test_the_ceiling_sees_none_of_its_light() -> None:
    points, _ = points_on_walls(SHIPPED, 4, 1)
    points[:, 1] = SHIPPED.box.maximum[1]
    walls = np.full(len(points), CEILING)
    assert (light_on_walls(room_of(SHIPPED), points, walls, lines=20) == 0).all()
    # … and where another wall meets the ceiling its light grazes.
    walls = np.array([4] * len(points))
    points[:, 2] = SHIPPED.box.minimum[2]
    assert (light_on_walls(room_of(SHIPPED), points, walls, lines=20) == 0).all()


@pytest.mark.parametrize("scene", [SHIPPED, UMBRA], ids=["shipped", "small light aside"])
def test_walls_without_the_sphere_take_all_the_light(scene: Scene) -> None:
    nodes = make_nodes(room_of(scene), 6)
    irradiance = light_on_walls(room_of(scene), nodes.points, nodes.wall, lines=90, shadow=False)
    flux = np.pi * LUMINANCE * np.prod(scene.light.size_xz)  # π L A
    # 6 × 6 points a cell of an irradiance that is smooth on the scale of the light's distance from the walls
    assert nodes.weights @ irradiance == pytest.approx(flux, rel=1e-7)


# --- the sphere ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("scene", [SHIPPED, UMBRA, BESIDE], ids=["shipped", "umbra", "beside"])
def test_flux_on_the_sphere_is_that_of_the_cones_it_fills(scene: Scene) -> None:
    # Every point of the light sees the whole sphere, whose view factor is r² cosθ / d².
    normals, weights = sphere_quadrature(120)
    flux = weights @ light_on_sphere(room_of(scene), normals) * scene.sphere.radius**2
    x, w = gauss_legendre(40)
    (cx, cz), (width, depth) = scene.light.center_xz, scene.light.size_xz
    light = np.stack(
        [*np.meshgrid(cx + width * (x - 0.5), cz + depth * (x - 0.5), indexing="ij")], axis=-1
    )  # fmt: skip
    away = np.stack(
        [light[..., 0], np.full((40, 40), scene.box.maximum[1]), light[..., 1]], axis=-1
    ) - np.array(scene.sphere.center)  # fmt: skip
    factor = scene.sphere.radius**2 * away[..., 1] / np.linalg.norm(away, axis=-1) ** 3
    expected = np.pi * LUMINANCE * width * depth * (w @ factor @ w)
    # The sphere's irradiance has a kink in its second derivative where the light's edges set: order 120^-3
    assert flux == pytest.approx(expected, rel=2e-6)


@given(theta=st.floats(0, np.pi), phi=st.floats(0, 2 * np.pi))
@settings(max_examples=40, deadline=None)  # the first example compiles
def test_sphere_sees_the_part_of_the_light_above_its_horizon(theta: float, phi: float) -> None:
    normal = np.array([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)])
    point = np.array(SHIPPED.sphere.center) + SHIPPED.sphere.radius * normal
    found = light_on_sphere(room_of(SHIPPED), normal[None])[0]
    # The horizon runs through some of 300 × 300 pieces, where the cosine is 0: an error of order 1/300² of the light.
    expected = by_pieces(SHIPPED, point, normal, 300, shadow=False)
    assert found == pytest.approx(expected, abs=1e-4 * LUMINANCE * np.pi)


def test_sphere_sees_all_of_the_light_or_nothing() -> None:
    room, (x, y, z), radius = room_of(SHIPPED), SHIPPED.sphere.center, SHIPPED.sphere.radius
    top = light_on_sphere(room, np.array([[0.0, 1.0, 0.0]]))[0]
    corners = light_rectangle(SHIPPED)
    up = np.array([0.0, 1.0, 0.0])
    # rounding of Lambert's sum
    assert top == pytest.approx(LUMINANCE * polygon_irradiance(corners, np.array([x, y + radius, z]), up), rel=1e-12)
    below = np.array([[0.0, -1.0, 0.0], [0.0, -0.6, -0.8]])
    assert (light_on_sphere(room, below) == 0).all()


def test_sphere_and_walls_take_all_the_light() -> None:
    # Shadow's edges make the walls' integral converge slowly: 14 × 14 points a cell, over 305 cells.
    for scene in (SHIPPED, UMBRA, BESIDE):
        room = room_of(scene)
        nodes = make_nodes(room, 14)
        on_walls = nodes.weights @ light_on_walls(room, nodes.points, nodes.wall, lines=60)
        normals, weights = sphere_quadrature(60)
        on_sphere = weights @ light_on_sphere(room, normals) * scene.sphere.radius**2
        flux = np.pi * LUMINANCE * np.prod(scene.light.size_xz)
        assert on_walls + on_sphere == pytest.approx(flux, rel=2e-5)
        assert on_sphere > 0.02 * flux


# --- its shadow ----------------------------------------------------------------------------------------------------


class Shadowed(NamedTuple):
    """Points of one scene in every kind of shadow, their irradiance by pieces, and that without the sphere."""

    room: Room
    points: np.ndarray
    walls: np.ndarray
    lit: np.ndarray
    bare: np.ndarray
    many_lines: np.ndarray

    def found(self, lines: int) -> np.ndarray:
        """Part of the light that arrives, as the renderer has it."""
        return light_on_walls(self.room, self.points, self.walls, lines=lines) / self.bare


@cache
def shadowed() -> list[Shadowed]:
    """Some points in the core of the shadow, more at its rim, some in the light."""
    found = []
    for scene, seed in ((SHIPPED, 2), (UMBRA, 3), (BESIDE, 4)):
        points, walls = points_on_walls(scene, 60, seed)
        normals = wall_normals(walls)
        at = list(zip(points, normals, strict=True))
        bare = np.array([LUMINANCE * polygon_irradiance(light_rectangle(scene), p, n) for p, n in at])
        coarse = np.array([by_pieces(scene, p, n, 12) / by_pieces(scene, p, n, 12, shadow=False) for p, n in at])
        kinds = [np.flatnonzero(coarse == 0), np.flatnonzero((coarse > 0) & (coarse < 1)), np.flatnonzero(coarse == 1)]
        chosen = np.concatenate([kind[:count] for kind, count in zip(kinds, (3, 8, 2), strict=True)])
        lit, bare = np.array([by_pieces(scene, *at[i], 250) for i in chosen]), bare[chosen]
        shadow = Shadowed(room_of(scene), points[chosen], walls[chosen], lit, bare, bare)
        # 800 lines err by 800^-1.5 = 4e-5 of the light at most
        found.append(shadow._replace(many_lines=shadow.found(800)))
    return found


def test_shadow_is_where_the_sphere_hides_pieces_of_the_light() -> None:
    for shadow in shadowed():
        # Pieces at the shadow's edge are taken whole: some 250 of 250² lie there, in or out at random, so 250^-1.5 =
        # 2.5e-4 of the light, and so are the 250 lines at most. Measured: 2e-4.
        assert shadow.found(250) == pytest.approx(shadow.lit / shadow.bare, abs=5e-4)
    parts = np.concatenate([shadow.lit / shadow.bare for shadow in shadowed()])
    assert (parts == 0).sum() >= 3
    assert (parts > 1 - 1e-5).sum() >= 5
    assert ((parts > 0.02) & (parts < 0.98)).sum() >= 12


@pytest.mark.parametrize(("level", "error"), [(0, 1e-3), (2, 4e-4), (4, 1.5e-4)])
def test_penumbra_at_each_level(level: int, error: float) -> None:
    # The shadow begins and ends within the light as a square root does, so n lines err by n^-3/2 at most of the light.
    for shadow in shadowed():
        assert shadow.found(LEVELS[level].light_lines) == pytest.approx(shadow.many_lines, abs=error)


def test_lines_converge_as_fast_as_a_square_root_lets_them() -> None:
    def rms(lines: int) -> float:
        errors = [shadow.found(lines) - shadow.many_lines for shadow in shadowed()]
        return float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))

    # 8 times the lines: 8^1.5 = 23 in the mean; a factor of 2 for the luck of where lines fall
    assert rms(20) / rms(160) > 11


ALONG_THE_CONE = np.array([1.25, -0.75, 0.75])  # a point of the wall x = 1.25


@cache
def by_pieces_along_the_cone() -> float:
    return by_pieces(BESIDE, ALONG_THE_CONE, inward(1), 250)


@pytest.mark.parametrize("offset", [0.0, 1e-15, -1e-15, 1e-12, -1e-12, 1e-9])
def test_shadow_where_a_line_of_the_light_runs_along_the_cone(offset: float) -> None:
    # Here my² + mz² = r²: the shadow on a line along x is half a line, the border between an interval and two rays.
    expected = by_pieces_along_the_cone()
    found = light_on_walls(room_of(BESIDE), ALONG_THE_CONE + np.array([[0, offset, 0]]), np.array([1]), lines=250)[0]
    assert found == pytest.approx(expected, rel=2e-3)  # as above, with a quarter of the light seen
