"""What pixels see: shares that add up, areas in closed form, and edges against plain supersampling."""

import math

import numpy as np
import pytest

from gloss_stimuli.exact.camera import build_camera
from gloss_stimuli.exact.film import FilmMap, map_film, sphere_irradiance
from gloss_stimuli.exact.nodes import wall_points
from gloss_stimuli.exact.room import build_room
from gloss_stimuli.exact.sphere import sphere_grid
from gloss_stimuli.exact.textures import texel_abscissae
from gloss_stimuli.scene import Scene
from tests.stimuli.exact.rooms import Enclosure, light_rectangle, scene_of

WIDE = {"width": 40, "height": 24}
ASIDE = {"position": [0.7, 0.6, 2.3], "target": [0.3, -0.3, -0.2], "field_of_view_deg": 45.0}
OFF_AXIS = {"position": [0.2, 0.1, 2.2], "target": [0.9, 0.2, 0.0], "field_of_view_deg": 75.0}
UPWARDS = {"position": [0.3, -0.6, 2.5], "target": [0.1, 0.75, 0.4], "field_of_view_deg": 85.0}
CLOSE = {"position": [0.1, -0.1, 0.68], "target": [0.0, -0.25, 0.0], "field_of_view_deg": 150.0}
VIEWS = {"aside": ASIDE, "off axis": OFF_AXIS, "upwards": UPWARDS, "close": CLOSE}


def axes(scene: Scene) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    forward = np.subtract(scene.camera.target, scene.camera.position)
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    return right, np.cross(right, forward), forward


def pixels_a_unit(scene: Scene) -> float:
    """Pixels that a length of one covers, one in front of the eye."""
    return scene.film.width / 2 / math.tan(math.radians(scene.camera.field_of_view_deg) / 2)


def mapped(scene: Scene, *, lines: int = 17, texels: int = 12, plain: bool = False) -> FilmMap:
    """Map of a whole film; `plain` makes walls of reflectance π, so that matrix rows hold shares."""
    room = build_room(scene, width_over_gap=1.4)
    if plain:
        room = room._replace(reflectance=np.full_like(room.reflectance, np.pi))
    pixels = np.arange(scene.film.width * scene.film.height)
    return map_film(room, build_camera(scene), pixels, texels=texels, lines=lines)


def sphere_shares(film: FilmMap, values: np.ndarray | float = 1.0) -> np.ndarray:
    """Sum of the sphere samples of each pixel, weighted by `values`."""
    pixel = np.repeat(np.arange(len(film.light)), np.diff(film.sphere_start))
    return np.bincount(pixel, film.weight * values, len(film.light))


def rays(scene: Scene, pixels: np.ndarray, side: int) -> np.ndarray:
    """Unit rays through side × side places of each pixel, shape (P, side², 3)."""
    right, up, forward = axes(scene)
    place = (np.arange(side) + 0.5) / side
    rows, columns = np.divmod(pixels, scene.film.width)
    x = (columns[:, None, None] + place[None, None, :] - scene.film.width / 2) / pixels_a_unit(scene)
    y = (scene.film.height / 2 - rows[:, None, None] - place[None, :, None]) / pixels_a_unit(scene)
    x, y = np.broadcast_arrays(x, y)
    directions = forward + x[..., None] * right + y[..., None] * up
    return (directions / np.linalg.norm(directions, axis=-1, keepdims=True)).reshape(len(pixels), -1, 3)


@pytest.mark.parametrize("size", [(2, 2), (2, 40), (40, 24), (17 * 2, 50)])
@pytest.mark.parametrize("view", VIEWS)
def test_shares_of_every_pixel_add_up_to_one(view: str, size: tuple[int, int]) -> None:
    scene = scene_of(camera=VIEWS[view], film={"width": size[0], "height": size[1]})
    film = mapped(scene, plain=True)
    total = film.walls @ np.ones(film.walls.shape[1])
    np.testing.assert_allclose(total + film.light + sphere_shares(film), 1, atol=1e-12)  # rounding of some 1,000 terms
    assert film.walls.data.min() >= 0
    assert film.weight.min() >= 0
    assert ((film.light >= 0) & (film.light <= 1)).all()


def ellipse_area(scene: Scene) -> float:
    """Area in pixels of a sphere's perspective image.

    The cone of half angle a about an axis at θ from the line of sight cuts the plane z = 1 in an ellipse of semi-axes
    sin a cos a / (cos²a - sin²θ) and sin a / sqrt(cos²a - sin²θ).
    """
    line = np.subtract(scene.sphere.center, scene.camera.position)
    sin2_a = scene.sphere.radius**2 / (line @ line)
    cos_theta = line @ axes(scene)[2] / np.linalg.norm(line)
    whole = (1 - sin2_a) - (1 - cos_theta**2)
    return math.pi * math.sqrt(1 - sin2_a) * sin2_a / whole**1.5 * pixels_a_unit(scene) ** 2


@pytest.mark.parametrize(
    ("camera", "film"),
    [
        ({}, {"width": 64, "height": 64}),
        (ASIDE, {"width": 64, "height": 40}),
        ({**OFF_AXIS, "field_of_view_deg": 100.0}, {"width": 40, "height": 64}),
        ({"position": [0.0, 0.2, 2.9], "target": [0.55, 0.1, 0.0], "field_of_view_deg": 60.0}, WIDE),
        ({"position": [0.1, -0.2, 0.9], "target": [0.1, -0.35, 0.0], "field_of_view_deg": 120.0}, WIDE),
    ],
)
@pytest.mark.parametrize("lines", [12, 24])
def test_area_of_the_sphere_is_that_of_its_perspective_image(camera: dict, film: dict, lines: int) -> None:
    # Walls of one check: where an outline crosses the edge of a check is another test's business.
    scene = scene_of(camera=camera, film=film, box={"check_size": 5.0})
    found, expected = mapped(scene, lines=lines).weight.sum(), ellipse_area(scene)
    assert expected > 30  # and all of it on the film:
    border = np.ones((film["height"], film["width"]), bool)
    border[1:-1, 1:-1] = False
    assert sphere_shares(mapped(scene))[border.ravel()].sum() == 0
    # Lines are summed by the midpoint rule. Where the outline enters or leaves a pixel across them it has a kink,
    # which costs up to 1/(8 lines²) of a pixel, at random over the 2 √(π area) pixels of the outline.
    outline = 2 * math.sqrt(math.pi * expected)
    assert found == pytest.approx(expected, abs=3 * math.sqrt(outline) / 8 / lines**2)


@pytest.mark.parametrize("size", [(16, 12), (40, 30), (100, 76)])
def test_area_of_the_light_is_that_of_its_perspective_image(size: tuple[int, int]) -> None:
    scene = scene_of(camera=UPWARDS, film={"width": size[0], "height": size[1]})
    right, up, forward = axes(scene)
    corners = light_rectangle(scene) - scene.camera.position
    x, y = (corners @ axis / (corners @ forward) * pixels_a_unit(scene) for axis in (right, up))
    assert (np.abs(x) < size[0] / 2).all()
    assert (np.abs(y) < size[1] / 2).all()
    expected = abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2  # the shoelace formula
    # Kinks where its sides enter and leave pixels, as above, and four corners.
    perimeter = np.hypot(np.diff(x, append=x[0]), np.diff(y, append=y[0])).sum()
    assert mapped(scene).light.sum() == pytest.approx(expected, abs=(3 * math.sqrt(perimeter) + 4) / 8 / 17**2)


def edge_pixels(film: FilmMap) -> np.ndarray:
    """Pixels with an edge of any kind in them: more than one wall sample, or not as many sphere samples as inside."""
    walls, spheres = np.diff(film.walls.indptr) / 4, np.diff(film.sphere_start)
    return np.flatnonzero((walls > 1) | (~np.isin(spheres, (0, 4, 64))))


def compared_with_supersampling(view: str, *, across: int = 64) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of edge pixels: sphere, light and mean paint as mapped and as supersampled, (3, P); surfaces in them, (P,)."""
    scene = scene_of(camera=VIEWS[view], film=WIDE)
    film = mapped(scene)
    pixels = edge_pixels(film)
    pixels = np.random.default_rng(3).choice(pixels, min(150, len(pixels)), replace=False)
    enclosure, eye = Enclosure(scene), np.array(scene.camera.position)
    flat = rays(scene, pixels, across).reshape(-1, 3)
    met, _ = enclosure.meets_sphere(np.broadcast_to(eye, flat.shape), flat)
    wall, points = enclosure.leave(eye, flat)
    lit = ~met & enclosure.in_light(wall, points)
    paint = np.where(met, 0, enclosure.reflectance(wall, points))
    check = np.floor((points - enclosure.low) / scene.box.check_size).astype(int)
    check[np.arange(len(wall)), wall // 2] = 0
    name = np.where(met, -1, np.where(lit, -2, wall * 1000 + check @ [1, 10, 100])).reshape(len(pixels), -1)
    surfaces = np.array([len(np.unique(row)) for row in name])
    brute = np.array([x.reshape(len(pixels), -1).mean(1) for x in (met, lit, paint)])
    mean_paint = film.walls @ np.full(film.walls.shape[1], np.pi)
    return np.array([sphere_shares(film), film.light, mean_paint])[:, pixels], brute, surfaces


@pytest.mark.parametrize("view", VIEWS)
def test_pixels_with_one_edge_agree_with_supersampling(view: str) -> None:
    found, expected, surfaces = compared_with_supersampling(view)
    one_edge = surfaces == 2
    assert one_edge.sum() > 60
    # A grid of 64² knows the share beside an edge to some 64^-1.5 = .002; the lines to 1/(8 · 17²) for each kink.
    np.testing.assert_allclose(found[:, one_edge], expected[:, one_edge], atol=0.005)
    # The views hold what they are here for.
    assert ((expected[0] > 0.02) & (expected[0] < 0.98)).sum() > 3
    if view == "upwards":
        assert ((expected[1] > 0.02) & (expected[1] < 0.98)).sum() > 5


def test_pixels_with_a_corner_agree_with_supersampling() -> None:
    """Corners of checks, and the sphere's outline across the edge of a check."""
    for view in VIEWS:
        found, expected, surfaces = compared_with_supersampling(view, across=128)
        corner = surfaces > 2
        assert corner.sum() > 10
        np.testing.assert_allclose(found[:, corner], expected[:, corner], atol=0.005, err_msg=view)  # lines, as above


@pytest.mark.parametrize("view", VIEWS)
def test_samples_of_the_sphere_lie_on_it(view: str) -> None:
    film = mapped(scene_of(camera=VIEWS[view], film=WIDE))
    # One that misses it is put on the outline itself.
    assert np.hypot(film.x, film.y).max() < math.pi / 2 - 1e-9


def test_a_corner_of_checks_in_the_middle_of_a_pixel() -> None:
    """The camera looks straight at a corner: where four pixels meet, or, half a pixel on, between two of them."""
    position, corner = np.array([0.25, 0.5, 2.5]), np.array([0.25, 0.5, -1.5])  # x = -1.25 + 3 checks, y = -1 + 3
    pixel = 4 * 2 * math.tan(math.radians(10)) / 20  # at the far wall
    sphere = {"center": [-0.7, -0.45, 0.0], "radius": 0.2}
    # Checks (3, 3) up to (4, 4): even sums are dark, and those stand left below and right above. Where the camera moves
    # to the right, the corner stands half a pixel left of the film's middle.
    for shift, expected in ((0.0, [[1, 0], [0, 1]]), (0.5, [[0.5, 0], [0.5, 1]])):
        off = np.array([shift * pixel, 0, 0])
        scene = scene_of(
            camera={"position": [*(position + off)], "target": [*(corner + off)], "field_of_view_deg": 20.0},
            film={"width": 20, "height": 20}, sphere=sphere,
            box={"dark_reflectance": 0.0, "light_reflectance": 0.5},
        )  # fmt: skip
        film = mapped(scene)
        seen = (film.walls @ np.full(film.walls.shape[1], np.pi)).reshape(20, 20)[9:11, 9:11] / 0.5
        np.testing.assert_allclose(seen, expected, atol=1e-3)  # one line in 17, of four of a corner, half cut: 1/1156


def test_texels_and_light_make_the_luminance_of_a_linear_field() -> None:
    """An irradiance that is linear in position, seen by supersampling: place, wall, and check must all be right."""
    scene = scene_of(camera=UPWARDS, film=WIDE)
    texels, slope = 48, np.array([0.3, -0.2, 0.25])
    room = build_room(scene, width_over_gap=1.4)
    film = map_film(room, build_camera(scene), np.arange(40 * 24), texels=texels, lines=17)
    points, _ = wall_points(room, texel_abscissae(texels))
    luminance = film.walls @ (2 + points.reshape(-1, 3) @ slope)
    pixels = np.random.default_rng(4).choice(40 * 24, 150, replace=False)
    enclosure = Enclosure(scene)
    flat = rays(scene, pixels, 48).reshape(-1, 3)
    eye = np.array(scene.camera.position)
    met, _ = enclosure.meets_sphere(np.broadcast_to(eye, flat.shape), flat)
    wall, places = enclosure.leave(eye, flat)
    expected = np.where(met, 0, enclosure.reflectance(wall, places) / np.pi * (2 + places @ slope))
    expected = expected.reshape(len(pixels), -1).mean(1)
    # Of a value up to .6. Texels interpolate to (π/48)²/16 of the field's change over a check, and the middle of a
    # pixel stands for its mean to .001; edges: a grid of 48² to .003; a check's corner .01.
    error = np.abs(luminance[pixels] - expected)
    assert np.quantile(error, 0.8) < 1e-3
    assert error.max() < 0.01


def test_walls_are_looked_up_between_four_texels() -> None:
    """Values that grow from texel to texel tell which four were taken, and in what parts; u = (1 - cos θ) / 2."""
    scene, texels = scene_of(camera=ASIDE, film=WIDE), 6
    room, camera = build_room(scene, width_over_gap=5.0), build_camera(scene)
    room = room._replace(reflectance=np.full_like(room.reflectance, np.pi))
    film = map_film(room, camera, np.arange(40 * 24), texels=texels, lines=4, wall_side=1)
    row, column = np.meshgrid(np.arange(texels), np.arange(texels), indexing="ij")
    values = np.arange(len(room.cell_wall))[:, None, None] * 1000.0 + 30.0 * row + column
    found = film.walls @ values.ravel()
    whole = np.flatnonzero((np.diff(film.walls.indptr) == 4) & (sphere_shares(film) == 0) & (film.light == 0))
    wall, points = Enclosure(scene).leave(np.array(scene.camera.position), rays(scene, whole, 1)[:, 0])
    for pixel, number, point in zip(whole, wall, points, strict=True):
        a, b = point[(number // 2 + 1) % 3], point[(number // 2 + 2) % 3]
        cells = np.arange(*room.wall_start[number : number + 2])
        low, high = room.cell_low[cells], room.cell_high[cells]
        cell = int(cells[((low <= [a, b]) & ([a, b] < high)).all(1)][0])
        u = ([a, b] - room.cell_low[cell]) / (room.cell_high[cell] - room.cell_low[cell])
        place = np.clip(np.arccos(1 - 2 * u) * texels / np.pi - 0.5, 0, texels - 1)
        assert found[pixel] == pytest.approx(1000 * cell + 30 * place[1] + place[0], abs=1e-6)
    assert len(whole) > 300


@pytest.mark.parametrize("view", ["aside", "close"])
def test_sphere_samples_average_what_the_pixel_sees_of_the_sphere(view: str) -> None:
    """A texture that is linear in the normal, by supersampling; edges, rim and inside of the outline."""
    scene = scene_of(camera=VIEWS[view], film=WIDE)
    camera, film = build_camera(scene), mapped(scene)
    slope = np.array([0.4, 0.3, -0.5])
    texture = 1 + sphere_grid(180) @ slope
    found = sphere_irradiance(camera, film, texture[..., None])[:, 0]
    pixels = np.flatnonzero(sphere_shares(film) > 0)
    pixels = np.random.default_rng(5).choice(pixels, min(len(pixels), 80), replace=False)
    enclosure, eye = Enclosure(scene), np.array(scene.camera.position)
    flat = rays(scene, pixels, 96).reshape(-1, 3)
    met, way = enclosure.meets_sphere(np.broadcast_to(eye, flat.shape), flat)
    normal = (eye + np.where(met, way, 0)[:, None] * flat - enclosure.center) / scene.sphere.radius
    expected = np.where(met, 1 + normal @ slope, 0).reshape(len(pixels), -1).mean(1)
    # .004 of a value up to 1.7: shares as above; four samples towards the outline know a square root to .003.
    np.testing.assert_allclose(found[pixels], expected, atol=0.007)


def test_rim_samples_follow_the_square_root_of_the_outline() -> None:
    """Mean cosine of incidence over the disc, seen from far away: ∫ sqrt(1 - s²) 2 s ds = 2/3."""
    scene = scene_of(
        box={"maximum": [1.25, 1.5, 60.0], "check_size": 2.5},
        camera={"position": [0.0, -0.25, 59.0], "target": [0.0, -0.25, 0.0], "field_of_view_deg": 1.2},
        film={"width": 40, "height": 40},
    )
    film = mapped(scene)
    cosine = np.cos(np.hypot(film.x, film.y))
    # 3e-4: the perspective from 118 radii, (r/D)² = 7e-5, and four or 64 samples a pixel of 16 to the radius.
    assert float(film.weight @ cosine / film.weight.sum()) == pytest.approx(2 / 3, abs=3e-4)


def test_pixels_may_be_mapped_in_any_bands() -> None:
    scene = scene_of(camera=ASIDE, film=WIDE)
    room, camera = build_room(scene, width_over_gap=1.4), build_camera(scene)
    whole = mapped(scene)
    pixels = np.array([403, 17, 404, 700, 18])
    some = map_film(room, camera, pixels, texels=12, lines=17)
    assert (some.walls != whole.walls[pixels]).nnz == 0
    np.testing.assert_array_equal(some.light, whole.light[pixels])
    for k, pixel in enumerate(pixels):
        ours, theirs = (
            slice(*f.sphere_start[p : p + 2]) for f, p in ((some, k), (whole, pixel))
        )  # fmt: skip
        for name in ("x", "y", "weight"):
            np.testing.assert_array_equal(getattr(some, name)[ours], getattr(whole, name)[theirs])


def test_a_film_of_four_pixels_sees_what_a_fine_film_sees() -> None:
    coarse, fine = ({"width": n, "height": n} for n in (2, 128))
    small, large = (mapped(scene_of(camera=ASIDE, film=film), lines=24) for film in (coarse, fine))
    for name, of in {
        "sphere": sphere_shares,
        "paint": lambda film: film.walls @ np.full(film.walls.shape[1], np.pi),
        "cosine": lambda film: sphere_shares(film, np.cos(np.hypot(film.x, film.y))),
    }.items():
        blocks = of(large).reshape(2, 64, 2, 64).mean((1, 3)).ravel()
        # .03: 96 lines of eight probes a pixel, between which checks of a tenth of a pixel may hide.
        np.testing.assert_allclose(of(small), blocks, atol=0.03, err_msg=name)
