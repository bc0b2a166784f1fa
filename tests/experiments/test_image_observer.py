"""Patterns of known contrast and blur inside a known outline; what is expected comes from closed forms."""

import json

import numpy as np
import pytest
from PIL import Image
from scipy.special import erf

from gloss_experiments import run_session
from gloss_experiments.observers.image_observer import (
    WIDTH_STEP,
    contrast_and_sharpness,
    image_axes,
    lightness_of_luminance,
    sphere_outline,
)
from gloss_experiments.observers.observer import SimulatedObserver
from glossspace.dataset import read_dissimilarities, read_simulated_observers
from glossspace.display import DisplayModel
from glossspace.errors import GlossError
from glossspace.files import sha256_of
from glossspace.stimulus_set import Stimulus, read_stimulus_set, write_manifest

RADIUS = 200
SIZE = 2 * RADIUS + 40
SCENE = {
    "camera": {"position": [0.0, 0.0, 3.0], "target": [0.0, 0.0, 0.0], "field_of_view_deg": 30.0},
    "sphere": {"center": [0.0, 0.0, 0.0], "radius": 0.5},
}


def disc(radius=RADIUS, size=SIZE):
    x = np.arange(size) - (size - 1) / 2
    return np.hypot(*np.meshgrid(x, x)) < radius


def stripes(blur, *, amplitude=20.0, spacing=45.0, size=SIZE):
    """Lightness of stripes, each edge a step blurred by a Gaussian of standard deviation `blur` pixels."""
    x = np.arange(size) - (size - 1) / 2
    edges = np.arange(-20, 21) * spacing
    row = sum((-1) ** i * erf((x - edge) / (blur * 2**0.5)) for i, edge in enumerate(edges))
    return 50 + amplitude / 2 * np.tile(row, (size, 1))


def width_of(sharpness):
    return (1 + WIDTH_STEP) ** -sharpness


@pytest.mark.parametrize("blur", [3.0, 4.0, 6.0])
def test_the_width_of_a_blurred_step(blur):
    """The range of a step over the steepest slope of its Gaussian blur is sqrt(2 pi) sigma.

    The slope is taken with a further blur of R / 100 = 2 pixels. A tenth of the sphere reaches up to a quarter of the
    stripes' spacing from an edge on both sides, 0.75 sigma for the sharpest, where the slope is lower by 25 %: the
    median of the width is up to 10 % above that at the edge itself.
    """
    _, sharpness = contrast_and_sharpness(stripes(blur), disc())
    expected = (2 * np.pi) ** 0.5 * np.hypot(blur, 2.0) / RADIUS
    assert expected * 0.99 <= width_of(sharpness) <= expected * 1.10


def test_sharpness_is_blind_to_contrast_and_contrast_is_linear():
    weak, strong = (contrast_and_sharpness(stripes(4.0, amplitude=a), disc()) for a in (10.0, 30.0))
    assert strong[0] == pytest.approx(3 * weak[0], rel=1e-9)  # both are linear in lightness up to rounding
    # Whole columns of pixels tie in their slope, and rounding decides which of them are among the steepest tenth.
    assert strong[1] == pytest.approx(weak[1], abs=0.02)


def test_the_contrast_of_a_sine():
    """G(s) multiplies a sine of wave number k by exp(-k² s² / 2), and a sine of amplitude a has a deviation of a / √2.

    Near the rim the blur takes from one side only, within R/4 = 1 standard deviation of the coarse one; the tolerance
    of 8 % is for that.
    """
    wave_length = RADIUS / 1.5
    k = 2 * np.pi / wave_length
    x = np.arange(SIZE) - (SIZE - 1) / 2
    field = 50 + np.tile(10 * np.sin(k * x), (SIZE, 1))
    gain = np.exp(-((k * RADIUS / 8) ** 2) / 2) - np.exp(-((k * RADIUS / 4) ** 2) / 2)
    contrast, _ = contrast_and_sharpness(field, disc())
    assert contrast == pytest.approx(2 * 10 / 2**0.5 * gain, rel=0.08)


def test_a_plain_sphere_has_neither():
    contrast, sharpness = contrast_and_sharpness(np.full((SIZE, SIZE), 40.0), disc())
    assert contrast == pytest.approx(0, abs=1e-9)  # rounding of a mean
    # R comes from the area of the outline, a whole number of pixels.
    assert width_of(sharpness) == pytest.approx((2 * round(RADIUS / 6) + 1) / RADIUS, rel=1e-3)


def test_what_is_beyond_the_outline_counts_for_nothing():
    inside = disc()
    framed = np.where(inside, stripes(4.0), np.random.default_rng(1).uniform(0, 100, (SIZE, SIZE)))
    assert contrast_and_sharpness(framed, inside) == contrast_and_sharpness(stripes(4.0), inside)


def test_the_outline_itself_is_no_reflected_edge():
    """The outermost pixels of a rendered sphere are in part wall: here a bright line of three pixels."""
    inside = disc()
    rim = inside & ~disc(RADIUS - 3)
    blurred = stripes(8.0)
    _, alone = contrast_and_sharpness(blurred, inside)
    _, lined = contrast_and_sharpness(np.where(rim, 100.0, blurred), inside)
    # The line reaches the interior through the blur at R / 4 alone, which is taken off: a tenth of a step.
    assert lined == pytest.approx(alone, abs=0.1)


def test_the_size_of_the_image_counts_for_little():
    large = contrast_and_sharpness(stripes(6.0), disc())
    small = contrast_and_sharpness(stripes(3.0, spacing=22.5, size=SIZE // 2), disc(RADIUS / 2, SIZE // 2))
    # Half the pixels make the outline, the windows and the slope coarser: a hundredth of the contrast, half a step.
    assert small[0] == pytest.approx(large[0], rel=0.01)
    assert small[1] == pytest.approx(large[1], abs=0.5)


def test_a_sphere_too_small_to_see_anything_in():
    with pytest.raises(GlossError, match="The sphere is 20 pixels wide on the images; render them larger"):
        contrast_and_sharpness(np.full((64, 64), 40.0), disc(10, 64))


def test_lightness_is_that_of_cie():
    """CIE 15: 18.4187 % of the white have L* 50, and 0.8856 % have 8."""
    luminance = np.array([0.0, 0.8856, 18.4187, 100.0])
    assert lightness_of_luminance(luminance, white=100.0) == pytest.approx([0, 8, 50, 100], abs=1e-3)  # rounded there


def test_the_outline_is_a_disc_of_the_right_size():
    """Straight ahead at distance D a sphere of radius r shows as a disc of tan(asin(r / D)) on the picture plane."""
    outline = sphere_outline(SCENE, width=400, height=300)
    radius = np.tan(np.arcsin(0.5 / 3)) / np.tan(np.radians(15)) * 200
    assert outline.shape == (300, 400)
    assert outline.sum() == pytest.approx(np.pi * radius**2, rel=0.01)  # of a pixel's width at the rim, 2 / radius
    assert (outline == outline[::-1, ::-1]).all()


def test_a_sphere_below_the_axis_is_in_the_lower_half():
    low = SCENE | {"sphere": {"center": [0.3, -0.5, 0.0], "radius": 0.3}}
    rows, columns = np.nonzero(sphere_outline(low, width=100, height=100))
    assert rows.min() > 50
    assert columns.mean() > 50


DISPLAY = DisplayModel()


@pytest.fixture
def reflections(tmp_path):
    """Four images of stripes, weak or strong, sharp or blurred, under paints that have nothing to do with them."""
    entries = []
    looks = {"weak blurred": (6, 9), "weak sharp": (6, 3), "strong blurred": (24, 9), "strong sharp": (24, 3)}
    for i, (name, (amplitude, blur)) in enumerate(looks.items()):
        share = ((stripes(blur, amplitude=amplitude) + 16) / 116) ** 3
        codes = DISPLAY.codes(DISPLAY.white_cd_m2 * share)
        Image.fromarray(codes).save(tmp_path / f"{i}.png")
        (tmp_path / f"{i}.exr").write_bytes(b"not looked at")
        hashes = {kind: sha256_of(tmp_path / f"{i}.{end}") for kind, end in (("image", "png"), ("luminance", "exr"))}
        files = {"image": f"{i}.png", "luminance": f"{i}.exr", "sha256": hashes}
        entries.append({"name": name, "rho_d": 0.2, "rho_s": 0.05, "alpha": 0.05, **files})
    # The sphere fills the picture up to 20 pixels: its half angle is that of the field of view times R / (R + 20).
    reach = np.degrees(np.arctan(np.tan(np.arcsin(0.5 / 3)) * SIZE / 2 / RADIUS))
    scene = SCENE | {"camera": SCENE["camera"] | {"field_of_view_deg": float(2 * reach)}}
    manifest = {
        "name": "stripes",
        "image": {"width": SIZE, "height": SIZE},
        "viewing": {"image_width_deg": 3.2},
        "display": DISPLAY.to_dict(),
        "scene": scene,
        "stimuli": entries,
    }
    write_manifest(tmp_path, manifest)
    return tmp_path


def changed_manifest(folder, **changes):
    manifest = json.loads((folder / "manifest.json").read_text("utf-8")) | changes
    (folder / "manifest.json").write_text(json.dumps(manifest), "utf-8")
    return read_stimulus_set(folder)


def test_images_are_told_apart_by_looks_alone(reflections):
    stimulus_set = read_stimulus_set(reflections)
    names = [stimulus.name for stimulus in stimulus_set.stimuli]
    axes = image_axes(stimulus_set, names)
    contrast, sharpness = np.array([axes[name] for name in names]).T
    # Rounding to 8-bit code values costs up to 0.2 L* of an edge of 6, 3 %: a third of a step, a twentieth of contrast.
    assert sharpness[1] - sharpness[0] == pytest.approx(sharpness[3] - sharpness[2], abs=0.7)
    assert sharpness[1] - sharpness[0] > 5
    assert contrast[2] / contrast[0] == pytest.approx(4, rel=0.05)
    stimuli = [Stimulus(name, 0.03, 0.09, 0.04 + 0.01 * i) for i, name in enumerate(names)]
    repainted = changed_manifest(
        reflections,
        stimuli=[
            {**entry, "rho_d": one.rho_d, "rho_s": one.rho_s, "alpha": one.alpha}
            for entry, one in zip(stimulus_set.manifest["stimuli"], stimuli, strict=True)
        ],
    )
    assert image_axes(repainted, names) == axes


def test_a_session_of_one_who_looks(reflections, tmp_path):
    looking = SimulatedObserver(1.0, 1.0, 1.0, 0.0, sees="images")
    run_session("pairwise", stimuli=reflections, dataset=tmp_path / "data", participant="01", observer=looking)
    pairs = read_dissimilarities(tmp_path / "data").set_index(["stimulus_a", "stimulus_b"])["dissimilarity"]
    axes = image_axes(read_stimulus_set(reflections), ["weak blurred", "strong sharp", "strong blurred"])
    distance = np.hypot(*np.subtract(axes["weak blurred"], axes["strong sharp"]))
    one_way = abs(axes["strong blurred"][0] - axes["weak blurred"][0])
    assert pairs["strong sharp", "weak blurred"] == 100
    # Their sharpness differs by what rounding to codes costs; half a unit is the slider's.
    assert pairs["strong blurred", "weak blurred"] == pytest.approx(100 * one_way / distance, abs=2)
    truth = read_simulated_observers(tmp_path / "data").iloc[0]
    assert truth["sees"] == "images"
    assert np.isnan(truth["ratio"])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"display": {}}, "the manifest's display lacks 'black_cd_m2', so their luminance is not known"),
        ({"scene": None}, "holds no scene with a camera and a sphere, so where to look is not known"),
        ({"scene": {"camera": {}, "sphere": {}}}, "holds no scene with a camera and a sphere"),
        ({"image": {"width": SIZE, "height": 64}}, "has 440 x 440 pixels, but its manifest says 440 x 64"),
    ],
)
def test_sets_that_cannot_be_looked_at(reflections, changes, message):
    with pytest.raises(GlossError, match=message):
        image_axes(changed_manifest(reflections, **changes), ["weak sharp"])


def test_an_image_in_colour(reflections):
    stimulus_set = read_stimulus_set(reflections)
    Image.new("RGB", (SIZE, SIZE)).save(stimulus_set.image_path("weak sharp"))
    with pytest.raises(GlossError, match=r"is no grayscale image of 8 bits \(its mode is RGB\)"):
        image_axes(stimulus_set, ["weak sharp"])
