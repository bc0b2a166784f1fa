"""The camera against textbook projection: film → ray → place on the sphere → point → film."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from gloss_stimuli.exact.camera import (
    LARGEST_INCIDENCE,
    build_camera,
    camera_ray,
    outline_radius_pixels,
    seen_on_sphere,
    sphere_point,
)
from gloss_stimuli.scene import Scene
from tests.stimuli.exact.rooms import scene_of

ASIDE = {"position": [0.7, 0.6, 2.1], "target": [0.1, -0.5, -0.2], "field_of_view_deg": 50.0}
CLOSE = {"position": [0.15, -0.2, 0.62], "target": [0.1, -0.1, 0.0], "field_of_view_deg": 120.0}
FILM = {"width": 48, "height": 20}


def place_of(scene: Scene, point: np.ndarray) -> tuple[float, float]:
    """Column and row where a pinhole shows a point: similar triangles, the film one unit before the eye."""
    look = np.subtract(scene.camera.target, scene.camera.position)
    look = look / np.linalg.norm(look)
    right = np.cross(look, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    up = np.cross(right, look)
    ray = point - np.array(scene.camera.position)
    pixel = 2 * math.tan(math.radians(scene.camera.field_of_view_deg / 2)) / scene.film.width
    depth = ray @ look
    return (
        scene.film.width / 2 + ray @ right / depth / pixel,
        scene.film.height / 2 - ray @ up / depth / pixel,
    )


@pytest.mark.parametrize("film", [FILM, {"width": 20, "height": 48}, {"width": 2, "height": 2}])
@pytest.mark.parametrize("field_of_view", [1.0, 28.0, 90.0, 169.0])
def test_field_of_view_spans_the_width_of_any_film(scene_with, film: dict, field_of_view: float) -> None:
    scene = scene_with(camera={**ASIDE, "field_of_view_deg": field_of_view}, film=film)
    camera = build_camera(scene)
    width, height = film["width"], film["height"]
    left, right = (np.array(camera_ray(camera, column, height / 2)) for column in (0, width))
    assert math.degrees(math.acos(left @ right)) == pytest.approx(field_of_view, rel=1e-9)  # float64, arccos near 1
    top, bottom = (np.array(camera_ray(camera, width / 2, row)) for row in (0, height))
    expected = 2 * math.atan(math.tan(math.radians(field_of_view / 2)) * height / width)  # pixels are square
    assert math.acos(top @ bottom) == pytest.approx(expected, rel=1e-9)
    assert top[1] > bottom[1]  # rows run downwards
    look = np.subtract(ASIDE["target"], ASIDE["position"])
    middle = np.array(camera_ray(camera, width / 2, height / 2))
    np.testing.assert_allclose(middle, look / np.linalg.norm(look), atol=1e-15)
    assert np.cross(look, [0, 1, 0]) @ (right - left) > 0  # columns run to the right of one who looks


@pytest.mark.parametrize("camera_of", [ASIDE, CLOSE])
@given(column=st.floats(0, 48), row=st.floats(0, 20))
@settings(max_examples=60, deadline=None)
def test_film_place_to_the_sphere_and_back(camera_of: dict, column: float, row: float) -> None:
    scene = scene_of(camera=camera_of, film=FILM)
    camera = build_camera(scene)
    ray = np.array(camera_ray(camera, column, row))
    assert np.linalg.norm(ray) == pytest.approx(1, abs=1e-14)
    sine, cosine_azimuth, sine_azimuth = seen_on_sphere(camera, *ray)
    # The ray meets the sphere where |eye + t ray - center| = radius, nearest first.
    eye, center, radius = (np.array(x) for x in (scene.camera.position, scene.sphere.center, scene.sphere.radius))
    along = ray @ (center - eye)
    discriminant = along**2 - (center - eye) @ (center - eye) + radius**2
    assume(abs(sine - 1) > 1e-9)
    assert (sine < 1) == (along > 0 and discriminant > 0)
    if sine >= 1:
        return
    hit = eye + (along - math.sqrt(discriminant)) * ray
    normal = (hit - center) / radius
    assert math.sqrt(1 - min(1.0, sine) ** 2) == pytest.approx(-ray @ normal, abs=1e-7)  # √ of rounding at grazing
    assume(math.asin(sine) < LARGEST_INCIDENCE)
    incidence = math.asin(sine)
    seen = np.array(sphere_point(camera, incidence * cosine_azimuth, incidence * sine_azimuth)).reshape(3, 3)
    # 1e-10: at an incidence of π/2 - .002 the arc sine magnifies rounding 500 times, and so does the way to the point.
    np.testing.assert_allclose(seen[0], hit, atol=1e-10)
    np.testing.assert_allclose(seen[1], normal, atol=1e-10)
    np.testing.assert_allclose(seen[2], -ray, atol=1e-10)
    assert place_of(scene, seen[0]) == pytest.approx((column, row), abs=1e-7)  # pixels, some 100 to a unit of length


@given(incidence=st.floats(0, LARGEST_INCIDENCE), azimuth=st.floats(0, 2 * math.pi))
@settings(max_examples=60, deadline=None)
def test_incidence_and_azimuth_are_what_their_names_say(incidence: float, azimuth: float) -> None:
    scene = scene_of(camera=ASIDE, film=FILM)
    camera = build_camera(scene)
    x, y = incidence * math.cos(azimuth), incidence * math.sin(azimuth)
    point, normal, to_eye = np.array(sphere_point(camera, x, y)).reshape(3, 3)
    assert math.acos(np.clip(normal @ to_eye, -1, 1)) == pytest.approx(incidence, abs=1e-7)  # arccos near 1
    assert normal @ to_eye >= math.cos(LARGEST_INCIDENCE) - 1e-12  # what is seen faces the eye
    np.testing.assert_allclose(point - normal * scene.sphere.radius, scene.sphere.center, atol=1e-14)
    if incidence > 1e-3:
        line = np.subtract(scene.camera.position, scene.sphere.center)
        line /= np.linalg.norm(line)
        across = normal - (normal @ line) * line
        across /= np.linalg.norm(across)
        start = np.array(sphere_point(camera, 0.5, 0.0)[3:6])
        start = start - (start @ line) * line
        start /= np.linalg.norm(start)
        turned = math.atan2(np.cross(start, across) @ line, start @ across)
        # Azimuth runs one way round; a table does not mind which.
        assert abs(turned) == pytest.approx(min(azimuth, 2 * math.pi - azimuth), abs=1e-7)


def test_place_of_the_sphere_is_one_to_one_along_a_meridian(scene_with) -> None:
    """Normals turn monotonically from the eye's line to the outline, where the tangent ray touches."""
    scene = scene_with(camera=CLOSE)
    camera = build_camera(scene)
    line = np.subtract(scene.camera.position, scene.sphere.center)
    distance = float(np.linalg.norm(line))
    turns = [
        math.acos(np.clip(np.dot(sphere_point(camera, x, 0.0)[3:6], line / distance), -1, 1))
        for x in np.linspace(0, LARGEST_INCIDENCE, 50)
    ]
    assert np.all(np.diff(turns) > 0)
    # The tangent point lies acos(r / D) from the line; .002 of incidence short of it, the triangle gives .002 less.
    assert turns[-1] == pytest.approx(math.acos(scene.sphere.radius / distance), abs=2.1e-3)


@pytest.mark.parametrize("x", [math.pi / 2, 1.8, 3.0])
def test_beyond_the_outline_the_last_point_inside_serves(scene_with, x: float) -> None:
    camera = build_camera(scene_with(camera=ASIDE))
    inside = np.array(sphere_point(camera, LARGEST_INCIDENCE, 0.0))
    np.testing.assert_allclose(sphere_point(camera, x, 0.0), inside, atol=1e-12)
    assert inside[3:6] @ inside[6:9] == pytest.approx(2e-3, rel=1e-3)  # cosine at .002 from grazing


@pytest.mark.parametrize("camera_of", [ASIDE, CLOSE])
def test_rays_away_from_the_sphere_miss_it(scene_with, camera_of: dict) -> None:
    """Behind the eye lies a mirror image of the sphere's cone: a ray into it has a small sine too."""
    camera = build_camera(scene_with(camera=camera_of))
    towards = -np.array(camera.axis)
    assert seen_on_sphere(camera, *towards)[0] < 1e-6
    for ray in (-towards, np.array(camera.across), np.array(camera.along)):
        assert seen_on_sphere(camera, *ray)[0] > 1


@pytest.mark.parametrize("distance", [0.55, 1.0, 2.9])
@pytest.mark.parametrize("film", [FILM, {"width": 20, "height": 48}])
def test_outline_radius_is_where_a_centered_sphere_ends(scene_with, film: dict, distance: float) -> None:
    scene = scene_with(
        camera={"position": [0.0, -0.25, distance], "target": [0.0, -0.25, 0.0], "field_of_view_deg": 100.0}, film=film
    )
    camera = build_camera(scene)
    radius = outline_radius_pixels(camera)
    for turn in (0.0, 1.0, 2.0):
        place = film["width"] / 2 + radius * math.cos(turn), film["height"] / 2 + radius * math.sin(turn)
        assert seen_on_sphere(camera, *camera_ray(camera, *place))[0] == pytest.approx(1, abs=1e-12)
