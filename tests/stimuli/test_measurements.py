"""Measured on pictures whose answer is known: checks mirrored by an independent tracer, ideally or through a lobe."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import ndtri

from gloss_stimuli.measurements import COLUMNS, PatchGeometry, find_patches, measure
from gloss_stimuli.mirror import Check
from gloss_stimuli.mirrored_checks import _is_disturbed
from gloss_stimuli.scene import Film, Scene, read_scene
from gloss_stimuli.tone import solve_tone_curve
from glossspace.display import DisplayModel
from glossspace.metric import lightness
from glossspace.stimulus_set import Stimulus

DISPLAY = DisplayModel()
TONE = solve_tone_curve(adapting=10.0, minimum=0.0, maximum=250.0, slope=1.0, contrast=DISPLAY.contrast)
GLOSSY = Stimulus.of(0.03, 0.099, 0.04)
DARK, LIGHT = 0.03, 0.767  # the walls of the shipped scene

Array = NDArray[np.float64]


def reflected_rays(scene: Scene) -> tuple[Array, Array]:
    """Where each pixel's ray meets the sphere, and where it goes from there: (H, W, 3), NaN beside the sphere."""
    width, height = scene.film.width, scene.film.height
    right, up, forward = (np.array(axis) for axis in scene.camera.axes())
    half = math.tan(math.radians(scene.camera.field_of_view_deg) / 2)
    x, y = np.meshgrid((np.arange(width) + 0.5) / width * 2 - 1, 1 - (np.arange(height) + 0.5) / height * 2)
    rays = forward + half * x[..., None] * right + half * height / width * y[..., None] * up
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    from_center = np.array(scene.camera.position) - scene.sphere.center
    b = rays @ from_center
    discriminant = b**2 - (from_center @ from_center - scene.sphere.radius**2)
    distance = -b - np.sqrt(np.where(discriminant > 0, discriminant, np.nan))
    point = scene.camera.position + distance[..., None] * rays
    normal = (point - scene.sphere.center) / scene.sphere.radius
    return point, rays - 2 * (rays * normal).sum(-1, keepdims=True) * normal


def reflectance_seen(scene: Scene, point: Array, direction: Array) -> Array:
    """Reflectance of the check that each ray meets: plane by plane, dark where its two indices have an even sum."""
    low, high = np.array(scene.box.minimum), np.array(scene.box.maximum)
    nearest, found = np.full(point.shape[:-1], np.inf), np.full(point.shape[:-1], np.nan)
    for axis in range(3):
        others = [other for other in range(3) if other != axis]
        for plane in (low[axis], high[axis]):
            with np.errstate(divide="ignore", invalid="ignore"):
                distance = (plane - point[..., axis]) / direction[..., axis]
                place = (point + distance[..., None] * direction - low)[..., others] / scene.box.check_size
                is_light = np.floor(place).sum(-1) % 2 == 1
            nearer = (distance > 1e-9) & (distance < nearest)
            nearest = np.where(nearer, distance, nearest)
            found = np.where(nearer, np.where(is_light, LIGHT, DARK), found)
    return found


def blurred(scene: Scene, pixels: NDArray[np.intp], sigma_deg: float) -> Array:
    """Mean reflectance under a Gaussian lobe about the mirror direction, for some pixels."""
    point, mirrored = (rays.reshape(-1, 3)[pixels] for rays in reflected_rays(scene))
    first = np.cross(mirrored, [0.0, 1.0, 0.0])
    first /= np.linalg.norm(first, axis=-1, keepdims=True)
    second = np.cross(mirrored, first)
    steps = math.radians(sigma_deg) * ndtri((np.arange(24) + 0.5) / 24)
    # 24 steps have this variance, of that of the normal distribution.
    steps *= math.radians(sigma_deg) / steps.std()
    lobe = [mirrored + u * first + v * second for u in steps for v in steps]
    return np.mean([reflectance_seen(scene, point, direction) for direction in lobe], axis=0)


def shading(scene: Scene) -> Array:
    """A diffuse shading from above that changes as steeply as that of the shipped scene: twofold within a check."""
    rows = np.linspace(2.0, 0.2, scene.film.height)[:, None]
    return 40 * rows * np.linspace(0.9, 1.1, scene.film.width)


def picture(scene: Scene, paint: Stimulus, reflection: Array, pixels: NDArray[np.intp] | None = None) -> Array:
    """Paint of the given reflectances under `shading`, with a reflection that the shading scales too."""
    seen = np.zeros(scene.film.height * scene.film.width)
    seen[slice(None) if pixels is None else pixels] = reflection.ravel()
    factor = paint.rho_d + paint.rho_s * seen.reshape(scene.film.height, scene.film.width)
    return shading(scene) * factor


def all_pixels(patches: PatchGeometry) -> NDArray[np.intp]:
    return np.unique(np.concatenate([patches.dark, patches.light, patches.edge]))


@pytest.fixture(scope="module")
def patches() -> PatchGeometry:
    found = find_patches(read_scene())
    assert found is not None
    return found


# Where


@pytest.mark.parametrize("film", ["512", "640x480", "200x300", "128"])
def test_patches_show_one_dark_and_one_light_check(film: str) -> None:
    scene = read_scene().with_film(Film.parse(film))
    patches = find_patches(scene)
    assert patches is not None
    seen = reflectance_seen(scene, *reflected_rays(scene)).ravel()
    assert set(seen[patches.dark]) == {DARK}
    assert set(seen[patches.light]) == {LIGHT}
    assert (seen[patches.edge] == np.where(patches.profile.positions > 0, LIGHT, DARK)).all()
    # The same two checks of the same wall, whatever the film.
    assert (patches.wall, patches.checks) == ("x minimum", ((2, 4), (2, 3)))


def test_patches_are_the_central_halves_of_checks(patches: PatchGeometry) -> None:
    scene = read_scene()
    point, direction = (rays.reshape(-1, 3) for rays in reflected_rays(scene))
    wall_distance = (scene.box.minimum[0] - point[:, 0]) / direction[:, 0]
    place = (point + wall_distance[:, None] * direction - np.array(scene.box.minimum)) / 0.5
    for pixels, (first, second) in zip((patches.dark, patches.light), patches.checks, strict=True):
        # All pixels whose mirrored ray falls there, and no others.
        with np.errstate(invalid="ignore"):
            central = (np.abs(place[:, 1] - first - 0.5) <= 0.25) & (np.abs(place[:, 2] - second - 0.5) <= 0.25)
        expected = np.flatnonzero(central & (direction[:, 0] < 0) & (wall_distance > 0) & (np.abs(place[:, 0]) < 1e-9))
        assert sorted(pixels) == expected.tolist()
    # The edge lies at z = 4 checks, light towards smaller z.
    assert patches.profile.positions == pytest.approx(4 - place[patches.edge, 2], abs=1e-12)  # rounding


def test_the_angle_of_a_check_is_what_the_sphere_sees(patches: PatchGeometry) -> None:
    scene = read_scene()
    point, _ = (rays.reshape(-1, 3)[patches.edge] for rays in reflected_rays(scene))
    # From each point of the sphere, the angle between directions to both ends of a check-wide line about the edge.
    ends = []
    for z in (-1.5 + 0.5 * 3.5, -1.5 + 0.5 * 4.5):
        to_end = (
            np.column_stack([np.full(len(point), -1.25), np.full(len(point), 0.25), np.full(len(point), z)]) - point
        )
        ends.append(to_end / np.linalg.norm(to_end, axis=1, keepdims=True))
    angle = np.degrees(np.arccos((ends[0] * ends[1]).sum(1))).mean()
    # A derivative at the mirrored place stands for a chord: 27° are bent by 1/12 of their square in radians, 2 %.
    assert patches.reflected_deg_per_check == pytest.approx(angle, rel=0.03)


def test_the_visual_angle_of_a_check_is_counted_in_pixels(patches: PatchGeometry) -> None:
    # An edge window is one check long and half a check broad; its pixels over its breadth give its length.
    columns = np.array(patches.edge) % 512
    positions = patches.profile.positions
    # Here the check's images run along the rows: columns change by so many pixels from one end to the other.
    slope = np.polyfit(positions, columns, 1)[0]
    rows = np.array(patches.edge) // 512
    lift = np.polyfit(positions, rows, 1)[0]
    pixel_deg = 3.2 / 512
    # A regression over a region that is not quite a parallelogram: 5 %.
    assert patches.visual_deg_per_check == pytest.approx(math.hypot(slope, lift) * pixel_deg, rel=0.05)


def test_dark_is_the_check_of_less_reflectance(scene_with, patches: PatchGeometry) -> None:
    swapped = find_patches(scene_with(box={"dark_reflectance": 0.767, "light_reflectance": 0.03}))
    assert swapped is not None
    assert swapped.checks == patches.checks[::-1]
    assert swapped.dark.tolist() == patches.light.tolist()


@pytest.mark.parametrize(
    "change",
    [
        {"box": {"check_size": 4.0}},  # no wall holds a whole one
        {"camera": {"target": [0.0, 0.2, 3.0]}},  # looks away from the sphere
        {"film": {"width": 16, "height": 16}},  # a patch has fewer than four pixels
    ],
)
def test_where_no_pair_is_to_be_seen_there_are_no_patches(scene_with, change: dict) -> None:
    assert find_patches(scene_with(**change)) is None


@pytest.mark.parametrize(
    ("change", "wall"),
    [
        ({}, "x minimum"),
        ({"light": {"center_xz": [-0.6, 0.5]}}, "x maximum"),
        ({"light": {"center_xz": [0.0, 2.3]}}, "y minimum"),
        ({"light": {"center_xz": [0.0, -0.9]}}, "y maximum"),
        ({"box": {"check_size": 0.25}}, "x minimum"),
        ({"sphere": {"center": [0.5, 0.0, 0.5]}}, "y maximum"),
        ({"camera": {"position": [-1.0, 0.2, 2.5]}}, "x minimum"),
    ],
)
def test_the_pair_is_lit_by_the_light_and_not_by_its_reflection(scene_with, change: dict, wall: str) -> None:
    scene = scene_with(**change)
    patches = find_patches(scene)
    assert patches is not None
    assert patches.wall == wall
    # Neighbours on that wall, of unlike paint.
    (a, b), (c, d) = patches.checks
    assert abs(a - c) + abs(b - d) == 1
    seen = reflectance_seen(scene, *reflected_rays(scene)).ravel()
    assert (set(seen[patches.dark]), set(seen[patches.light])) == ({DARK}, {LIGHT})
    # What the sphere mirrors there is not the light.
    point, direction = (rays.reshape(-1, 3) for rays in reflected_rays(scene))
    pixels = all_pixels(patches)
    point, direction = point[pixels], direction[pixels]
    ceiling = point + ((scene.box.maximum[1] - point[:, 1]) / direction[:, 1])[:, None] * direction
    (x, z), (width, depth) = scene.light.center_xz, scene.light.size_xz
    in_light = (np.abs(ceiling[:, 0] - x) < width / 2) & (np.abs(ceiling[:, 2] - z) < depth / 2) & (direction[:, 1] > 0)
    assert not in_light.any()
    # The light's center irradiates both patches, by the inverse square and two cosines, within the factor of 1.5 and
    # what a patch differs from its check.
    irradiance = []
    for patch in (patches.dark, patches.light):
        place = reflected_rays(scene)[0].reshape(-1, 3)[patch]
        normal = (place - scene.sphere.center) / scene.sphere.radius
        to_light = np.array([x, scene.box.maximum[1], z]) - place
        irradiance.append(((to_light * normal).sum(1) * to_light[:, 1] / (to_light**2).sum(1) ** 2).mean())
    assert min(irradiance) > 0
    assert 1 / 1.6 < irradiance[0] / irradiance[1] < 1.6


@pytest.mark.parametrize(
    ("check", "disturbed"),
    [
        # The light covers x from -.6 to .6 and z from .15 to 1.35: on the ceiling, checks 1 (from -.75) to 3 (to .75)
        # in x, 3 (from 0) to 5 (to 1.5) in z.
        (Check(1, 1, 1, 3), True),
        (Check(1, 1, 3, 5), True),
        (Check(1, 1, 0, 4), False),
        (Check(1, 1, 2, 6), False),
        # On the floor, the sphere's shadow lies below it, not in the corner; no wall in front of it is reached.
        (Check(1, 0, 2, 2), True),
        (Check(1, 0, 0, 8), False),
        (Check(2, 1, 2, 2), False),
    ],
)
def test_checks_with_the_light_or_in_shadow_are_told(check: Check, disturbed: bool) -> None:
    assert _is_disturbed(read_scene(), check) is disturbed


def test_the_manifest_says_where_it_was_measured(patches: PatchGeometry) -> None:
    document = patches.to_dict()
    assert document["wall"] == "x minimum"
    assert document["dark_pixels"] == len(patches.dark)
    assert max(document["incidence_deg"]) < 60


# What


def test_ideally_mirrored_checks_have_their_own_luminance(patches: PatchGeometry) -> None:
    scene = read_scene()
    white = shading(scene)
    luminance = picture(scene, GLOSSY, reflectance_seen(scene, *reflected_rays(scene)))
    row = measure(patches, GLOSSY, luminance, white, tone=TONE, display=DISPLAY)
    dark, light = (0.03 + 0.099 * seen for seen in (DARK, LIGHT))
    # The picture is white times a factor for each check, so shading cancels to rounding.
    assert row["scene_luminance_ratio"] == pytest.approx(light / dark, rel=1e-12)
    assert row["scene_lightness_difference"] == pytest.approx(float(lightness(light) - lightness(dark)), rel=1e-12)
    illumination = (white.flat[patches.dark].mean() + white.flat[patches.light].mean()) / 2
    assert row["scene_dark_patch_cd_m2"] == pytest.approx(dark * illumination, rel=1e-12)
    shown = DISPLAY.white_cd_m2 * TONE(illumination * np.array([dark, light]))
    # Rounding to codes errs by 1/√12 of a step of 2.35/100 at codes of about 100 (1 %), averaged over 300 pixels of
    # many levels; that the curve bends over the shading of a patch leaves some 1 %.
    assert row["displayed_dark_patch_cd_m2"] == pytest.approx(shown[0], rel=0.01)
    assert row["displayed_light_patch_cd_m2"] == pytest.approx(shown[1], rel=0.01)
    assert row["displayed_luminance_ratio"] == pytest.approx(shown[1] / shown[0], rel=0.01)
    expected = float(np.diff(lightness(shown / DISPLAY.white_cd_m2))[0])
    assert row["displayed_lightness_difference"] == pytest.approx(expected, rel=0.02)
    # An ideal edge is no wider than a pixel: 27° over some 36 pixels a check.
    assert 0 < row["scene_edge_width_reflected_deg"] < 1.2
    assert row["stimulus"] == "d0.03_s0.099_a0.04"
    assert list(row) == list(COLUMNS)


@pytest.mark.parametrize("sigma_deg", [1.0, 2.0, 3.0])
@pytest.mark.parametrize("paint", [GLOSSY, Stimulus.of(0.767, 0.033, 0.04)])
def test_the_edge_is_as_wide_as_its_lobe(patches: PatchGeometry, sigma_deg: float, paint: Stimulus) -> None:
    scene = read_scene()
    pixels = all_pixels(patches)
    luminance = picture(scene, paint, blurred(scene, pixels, sigma_deg), pixels)
    row = measure(patches, paint, luminance, shading(scene), tone=TONE, display=DISPLAY)
    expected = math.sqrt(2 * math.pi) * sigma_deg
    # Pixels of .8° and bins of .85° add .3° to σ in squares, 5 % at 1°; the wall is seen at a slant that changes, 3 %.
    assert row["scene_edge_width_reflected_deg"] == pytest.approx(expected, rel=0.06)
    # On the display, besides, the white paint's edge is two codes high, and the tone curve bends the black one's.
    assert row["displayed_edge_width_reflected_deg"] == pytest.approx(expected, rel=0.12)
    for kind in ("scene", "displayed"):
        ratio = row[f"{kind}_edge_width_visual_deg"] / row[f"{kind}_edge_width_reflected_deg"]
        assert ratio == pytest.approx(patches.visual_deg_per_check / patches.reflected_deg_per_check, rel=1e-12)


def test_beyond_a_check_the_width_says_no_more_and_the_contrast_falls(patches: PatchGeometry) -> None:
    scene = read_scene()
    pixels = all_pixels(patches)
    rows = [
        measure(
            patches,
            GLOSSY,
            picture(scene, GLOSSY, blurred(scene, pixels, sigma), pixels),
            shading(scene),
            tone=TONE,
            display=DISPLAY,
        )
        for sigma in (6.0, 8.0, 11.0)  # Ward's alpha of .075, .1 and .14
    ]
    widths = [row["scene_edge_width_reflected_deg"] for row in rows]
    # A sine wave: its mean over the central halves is 2 · .9003 of its amplitude, its slope π of it a check.
    limit = 2 * 0.9003 / math.pi * patches.reflected_deg_per_check
    # The fitted slope of a sine is 3 % off, and the checks behind are not the same ones seen from all places.
    assert max(widths) < 1.06 * limit
    assert widths[0] > 0.75 * limit
    ratios = [row["scene_luminance_ratio"] for row in rows]
    assert ratios[0] > ratios[1] > ratios[2] > 1


def test_a_matt_paint_has_patches_of_equal_luminance_and_no_edge(patches: PatchGeometry) -> None:
    matt = Stimulus.of(0.5, 0.0, 0.04)
    white = shading(read_scene())
    row = measure(patches, matt, 0.5 * white, white, tone=TONE, display=DISPLAY)
    assert row["scene_luminance_ratio"] == pytest.approx(1, rel=1e-12)
    assert row["scene_lightness_difference"] == pytest.approx(0, abs=1e-10)  # rounding of L* of 76
    # Codes of many levels, averaged over 300 pixels.
    assert row["displayed_luminance_ratio"] == pytest.approx(1, abs=1e-3)
    assert [name for name, value in row.items() if value is None] == [name for name in COLUMNS if "edge_width" in name]
    # Even if something were left to be seen there.
    luminance = picture(read_scene(), GLOSSY, reflectance_seen(read_scene(), *reflected_rays(read_scene())))
    assert measure(patches, matt, luminance, white, tone=TONE, display=DISPLAY)["scene_edge_width_visual_deg"] is None


def test_an_edge_of_less_than_a_code_value_is_not_displayed(patches: PatchGeometry) -> None:
    scene = read_scene()
    # A step of .3 % on white paint, a third of a code.
    faint = Stimulus.of(0.767, 0.0031, 0.04)
    luminance = picture(scene, faint, reflectance_seen(scene, *reflected_rays(scene)))
    row = measure(patches, faint, luminance, shading(scene), tone=TONE, display=DISPLAY)
    assert row["scene_edge_width_visual_deg"] is not None
    assert row["displayed_edge_width_visual_deg"] is None
    fine = measure(patches, faint, luminance, shading(scene), tone=TONE, display=DisplayModel(bits=16))
    assert fine["displayed_edge_width_visual_deg"] == pytest.approx(row["scene_edge_width_visual_deg"], rel=0.1)


def test_what_reflects_nothing_has_no_ratio(patches: PatchGeometry) -> None:
    nothing = Stimulus.of(0.0, 0.0, 0.04)
    white = shading(read_scene())
    row = measure(patches, nothing, np.zeros_like(white), white, tone=TONE, display=DISPLAY)
    assert row["scene_luminance_ratio"] is None
    assert row["scene_lightness_difference"] == 0
    assert row["displayed_luminance_ratio"] == pytest.approx(1)  # the screen's own black


def test_a_reflection_brighter_than_white_has_a_lightness_above_100(patches: PatchGeometry) -> None:
    scene = read_scene()
    mirror = Stimulus.of(0.0, 1.0, 0.04)
    seen = reflectance_seen(scene, *reflected_rays(scene))
    row = measure(patches, mirror, shading(scene) * 2 * seen, shading(scene), tone=TONE, display=DISPLAY)
    # CIE 15: L* = 116 ∛(Y/Yn) - 16 goes on above Yn: at 1.534, 117.8; at .06, 29.4.
    expected = 116 * (1.534 ** (1 / 3) - 0.06 ** (1 / 3))
    assert row["scene_lightness_difference"] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("missing", ["patches", "white", "light"])
def test_where_nothing_can_be_measured_every_cell_is_none(patches: PatchGeometry, missing: str) -> None:
    white = shading(read_scene())
    row = measure(
        None if missing == "patches" else patches,
        GLOSSY,
        0.1 * white,
        {"white": None, "light": 0 * white}.get(missing, white),
        tone=TONE,
        display=DISPLAY,
    )
    assert row["stimulus"] == GLOSSY.name
    assert all(row[name] is None for name in COLUMNS if name != "stimulus")


def test_images_of_another_film_are_refused(patches: PatchGeometry) -> None:
    with pytest.raises(ValueError, match=r"found for images of \(512, 512\), but the luminance is of \(4, 4\)"):
        measure(patches, GLOSSY, np.ones((4, 4)), np.ones((512, 512)), tone=TONE, display=DISPLAY)
