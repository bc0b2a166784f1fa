"""Which scenes are solved: every reason to refuse one, and what is promised for those that are taken."""

import tracemalloc
from collections.abc import Callable

import numpy as np
import pytest

from gloss_stimuli.exact.direct import light_on_sphere, light_on_walls
from gloss_stimuli.exact.exchange import edge_rule, exchange_matrix
from gloss_stimuli.exact.fields import FieldSolver
from gloss_stimuli.exact.levels import LEVELS
from gloss_stimuli.exact.nodes import make_nodes
from gloss_stimuli.exact.room import build_room
from gloss_stimuli.exact.scope import LARGEST_RETURN, levels_within, why_not_exact
from gloss_stimuli.exact.textures import wall_texture
from gloss_stimuli.scene import Scene, read_scene
from tests.stimuli.exact.rooms import furnace, scene_of, sphere_quadrature

SceneWith = Callable[..., Scene]


def test_the_shipped_scene_is_within() -> None:
    assert why_not_exact(read_scene()) is None
    assert levels_within(read_scene(), LEVELS) >= 3  # two to compare, and one to go on to


@pytest.mark.parametrize(
    ("inside", "outside", "reason"),
    [
        # The floor is at y = -1, so the gap of a sphere of radius .25 at y is y + .75; a tenth of it is .025.
        (
            {"sphere": {"center": [0.0, -0.7, 0.0], "radius": 0.25}},
            {"sphere": {"center": [0.0, -0.73, 0.0], "radius": 0.25}},
            "the sphere is 0.02 from a wall, nearer than 0.1 of its radius",
        ),
        # A light of 1.2 in a ceiling from -1.25 to 1.25; a fifth of a check is .1.
        (
            {"light": {"center_xz": [-0.54, 0.75]}},
            {"light": {"center_xz": [-0.56, 0.75]}},
            "the light is 0.09 from a wall, nearer than 0.2 of a check",
        ),
        (
            {"light": {"center_xz": [0.0, 2.29]}},
            {"light": {"center_xz": [0.0, 2.31]}},
            "the light is 0.09 from a wall, nearer than 0.2 of a check",
        ),
        (
            {"light": {"size_xz": [1.2, 2.6], "center_xz": [0.0, 1.59]}},
            {"light": {"size_xz": [1.2, 2.6], "center_xz": [0.0, 1.61]}},
            "the light is 0.09 from a wall, nearer than 0.2 of a check",
        ),
        # 2.5 wide: 1.5 checks of 1.667
        (
            {"box": {"check_size": 1.66}, "light": {"center_xz": [0.0, 0.9]}},
            {"box": {"check_size": 1.68}, "light": {"center_xz": [0.0, 0.9]}},
            "the box is only 1.49 checks wide, fewer than 1.5",
        ),
        (
            {"box": {"dark_reflectance": 0.9, "light_reflectance": 1.0}, "sphere": {"radius": 0.1}},
            {"box": {"dark_reflectance": 0.91, "light_reflectance": 1.0}, "sphere": {"radius": 0.1}},
            "the checks reflect 0.955 of the light on average, more than 0.95",
        ),
        # Walls of 57.5 in all see a sphere of radius r as 4πr² / 57.5: of light that leaves it, ρ 4πr² / 57.5 / (1 - ρ
        # (1 - 4πr² / 57.5)) returns, with ρ = .3985 for the shipped checks.
        (
            {"sphere": {"center": [0.0, 0.25, 0.0], "radius": 0.6}, "box": {"check_size": 0.9}},
            {"sphere": {"center": [0.0, 0.25, 0.0], "radius": 0.7}, "box": {"check_size": 0.9}},
            "the sphere is so large that about 0.07 of its light returns, more than 0.06",
        ),
        # .012 of a check of .5 is .006, and .03 is .015.
        (
            {"box": {"maximum": [1.25, 1.5, 3.015]}},
            {"box": {"maximum": [1.25, 1.5, 3.006]}},
            "a wall or the light cuts a check to 0.012 of its width, less than 0.02",
        ),
        (
            {"light": {"size_xz": [1.47, 1.2]}},
            {"light": {"size_xz": [1.4998, 1.2]}},
            "a wall or the light cuts a check to 0.0002 of its width, less than 0.02",
        ),
        (
            {"box": {"check_size": 0.5}},
            {"box": {"check_size": 0.3}},
            "its walls have more than 10000 unknowns: the checks are too small for the box",
        ),
    ],
    ids=[
        "gap", "light in x", "light in z", "long light", "narrow", "bright", "returns", "wall cuts", "light cuts",
        "unknowns",
    ],
)  # fmt: skip
def test_each_reason_on_either_side_of_its_bound(
    scene_with: SceneWith, inside: dict, outside: dict, reason: str
) -> None:
    found = why_not_exact(scene_with(**outside))
    assert found == reason
    # Near a bound another reason may apply, such as the many cells beneath a sphere that is near a wall.
    before_a_number = reason.split(" 0.")[0]
    assert before_a_number not in (why_not_exact(scene_with(**inside)) or "")


def test_a_light_along_the_edges_of_checks_is_no_sliver(scene_with: SceneWith) -> None:
    # -.75 and .75 are edges of checks, -1.25 + 1 and 1.25 - .5, up to rounding.
    assert why_not_exact(scene_with(light={"size_xz": [1.5, 1.2]})) is None
    assert why_not_exact(scene_with(light={"size_xz": [1.5 + 1e-12, 1.2]})) is None


def test_levels_within_are_those_whose_unknowns_fit(scene_with: SceneWith) -> None:
    scene = scene_with(sphere={"center": [0.0, -0.35, 0.0]})
    fitting = [
        len(make_nodes(build_room(scene, width_over_gap=level.width_over_gap), level.nodes).points) <= 10_000
        for level in LEVELS
    ]
    assert not all(fitting)  # or the scene tells nothing
    assert levels_within(scene, LEVELS) == fitting.index(False)
    assert levels_within(scene, LEVELS[:1]) == 1
    assert levels_within(scene, []) == 0


def test_tiny_checks_are_refused_without_making_them(scene_with: SceneWith) -> None:
    # 23,000 checks here; with checks of a thousandth, which a mistaken unit makes, 57 million would fill the memory.
    scene = scene_with(box={"check_size": 0.05})
    tracemalloc.start()
    try:
        assert why_not_exact(scene) is not None
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 1e6


# --- what is promised ----------------------------------------------------------------------------------------------

AT_THE_BOUNDS = {
    "gap": scene_of(sphere={"center": [0.0, -0.39, 0.0]}),  # closer, it has too many unknowns
    "light": scene_of(light={"center_xz": [-0.54, 0.75]}),
    "narrow": scene_of(box={"check_size": 1.66}, light={"center_xz": [0.0, 0.9]}),
    "returns": scene_of(sphere={"center": [0.0, 0.25, 0.0], "radius": 0.6}, box={"check_size": 0.9}),
    "thin": scene_of(box={"maximum": [1.25, 1.5, 3.012]}),
}
at_the_bounds = pytest.mark.parametrize("name", AT_THE_BOUNDS)


@at_the_bounds
def test_view_factors_and_light_hold_at_the_bounds(name: str) -> None:
    scene, level = AT_THE_BOUNDS[name], LEVELS[0]
    assert why_not_exact(scene) is None
    room = build_room(scene, width_over_gap=level.width_over_gap)
    nodes = make_nodes(room, level.nodes)
    sums = exchange_matrix(furnace(room, 1.0), nodes, edge_rule(level.edge_points)).sum(1, dtype=np.float64)
    assert sums == pytest.approx(np.ones(len(sums)), abs=1.5e-4)  # 8 points of product integration, see `test_exchange`
    fine = make_nodes(room, 6)
    normals, weights = sphere_quadrature(40)
    on_walls = fine.weights @ light_on_walls(room, fine.points, fine.wall, lines=level.light_lines)
    on_sphere = scene.sphere.radius**2 * weights @ light_on_sphere(room, normals)
    flux = np.pi * scene.light.luminance_cd_m2 * np.prod(scene.light.size_xz)
    assert on_walls + on_sphere == pytest.approx(flux, rel=3e-4)  # 6 × 6 points a cell, edges of shadows among them


def test_textures_agree_between_seeds_with_a_thin_check() -> None:
    scene, level = AT_THE_BOUNDS["thin"], LEVELS[0]
    room = build_room(scene, width_over_gap=level.width_over_gap)
    textures = []
    for seed in (0, 1):
        solver = FieldSolver(room, level, np.random.SeedSequence(seed), "ward")
        textures.append(wall_texture(room, solver.nodes, level, solver.diffuse.walls, solver.light_at_nodes))
    first, second = textures
    difference = np.abs(first - second)[..., 0]
    # The coarsest level errs by 4096^-3/4 = 2e-3 of the brightest; splines carry that on to a few times as much beside
    # thin cells and edges, and no further.
    assert difference.max() < 0.02 * first[..., 0].max()
    assert np.quantile(difference, 0.99) < 4e-3 * first[..., 0].max()
    assert first[..., 0].min() > 0


def test_the_bound_on_returns_is_about_what_returns(scene_with: SceneWith) -> None:
    # The estimate stands for uniform walls: in a furnace it is what a solution finds.
    scene = scene_with(sphere={"center": [0.0, 0.25, 0.75], "radius": 0.6}, box={"check_size": 0.9})
    mean = (scene.box.dark_reflectance + scene.box.light_reflectance) / 2
    room = furnace(build_room(scene, width_over_gap=1.4), mean)
    found = FieldSolver(room, LEVELS[0], np.random.SeedSequence(0), "ward").diffuse.returned
    share = 4 * np.pi * 0.6**2 / (2 * (2.5 * 2.5 + 2 * 2.5 * 4.5))
    estimate = mean * share / (1 - mean * (1 - share))
    assert found == pytest.approx(estimate, rel=0.4)  # nearer walls see more of it
    assert estimate < LARGEST_RETURN
