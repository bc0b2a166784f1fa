"""What a manifest says, for each renderer; `test_render` tests what becomes of it."""

import json
import math
from importlib.metadata import version
from pathlib import Path

import pytest

from gloss_stimuli.measurements import COLUMNS, find_patches
from gloss_stimuli.method import choose_renderer
from gloss_stimuli.render import tone_curve
from gloss_stimuli.scene import Film, Scene, read_scene
from gloss_stimuli.set_manifest import set_manifest
from gloss_stimuli.sets import StimulusList
from gloss_stimuli.target import find_target
from gloss_stimuli.user_scene import UserScene, read_user_scene
from glossspace.stimulus_set import Stimulus

MESH = Path(__file__).parent / "data" / "mesh_scene" / "scene.toml"
WANTED = StimulusList("mine", "My paints", (Stimulus.of(0.193, 0.066, 0.07),))
HASH = "0" * 64
ENTRIES = [{"name": "d0.193_s0.066_a0.07"}]


def manifest(scene: Scene | UserScene, tmp_path: Path, *, method: str = "auto", **options) -> dict:
    shared = {"target": find_target("exact"), "tone": tone_curve(scene), "display": scene.display.model()}
    renderer, reason = choose_renderer(scene, method=method, seed=5, cache=tmp_path, **shared, **options)
    patches = find_patches(scene) if isinstance(scene, Scene) else None
    return set_manifest(
        WANTED, scene, ENTRIES, renderer=renderer, reason=reason, patches=patches, measurements_sha256=HASH, **shared
    )  # fmt: skip


def test_it_holds_all_that_the_files_depend_on(tmp_path: Path) -> None:
    scene = read_scene().with_film(Film(width=640, height=480))
    document = manifest(scene, tmp_path)
    assert list(document) == [
        "name", "title", "image", "luminance", "viewing", "display", "tone_curve", "rendering", "measurements", "scene",
        "software", "stimuli",
    ]  # fmt: skip
    assert (document["name"], document["title"], document["stimuli"]) == ("mine", "My paints", ENTRIES)
    assert document["image"] == {"width": 640, "height": 480, "bits": 8, "encoding": "display code values"}
    assert Scene.model_validate(document["scene"]) == scene
    assert document["tone_curve"] == tone_curve(scene).to_dict()
    # It is written as strict JSON.
    assert json.loads(json.dumps(document, allow_nan=False)) == document


def test_it_says_how_it_was_rendered_why_so_and_what_was_aimed_at(tmp_path: Path) -> None:
    document = manifest(read_scene(), tmp_path)
    assert document["rendering"] == {
        "method": "exact",
        "reason": "a box within its scope",
        "target": {"max_code_error": 0.5, "fraction": 0.999},
        "error_unit": "8-bit code values before rounding, estimated from independent randomisations",
        "seed": 5,
    }


@pytest.mark.parametrize(
    ("method", "packages"),
    [
        ("exact", ["numba", "llvmlite", "numpy", "scipy"]),
        ("coefficients", ["mitsuba", "drjit", "numpy"]),
        ("path", ["mitsuba", "drjit"]),
    ],
)
def test_software_is_what_this_method_used(tmp_path: Path, method: str, packages: list[str]) -> None:
    document = manifest(read_scene(), tmp_path, method=method)
    assert document["software"] == {name: version(name) for name in ["glossspace", "OpenEXR", "pillow", *packages]}
    assert "software" not in document["rendering"]


def test_display_and_viewing_are_told_with_what_rounding_and_the_pixel_size_do(tmp_path: Path, scene_with) -> None:
    scene = scene_with(display={"bits": 16}, viewing={"pixel_pitch_mm": 0.25}, film={"width": 320, "height": 200})
    document = manifest(scene, tmp_path)
    # The images for every screen have 8 bits, whatever this display has.
    assert (document["image"]["bits"], document["display"]["bits"]) == (8, 16)
    assert document["display"]["quantisation_error"]["bits"] == 8
    # 85.138 mm at 152.4 cm are 3.2 degrees; 340.6 pixels of .25 mm.
    assert document["viewing"]["native_width_px"] == 340
    angle = 2 * math.degrees(math.atan(40 / 1524))  # 320 of them are 80 mm
    assert document["viewing"]["rendered_width_deg"] == pytest.approx(angle, rel=1e-12)


def test_measurements_are_explained(tmp_path: Path) -> None:
    measurements = manifest(read_scene(), tmp_path)["measurements"]
    assert (measurements["file"], measurements["sha256"]) == ("measurements.csv", HASH)
    assert measurements["columns"] == COLUMNS
    assert measurements["patches"]["wall"] == "x minimum"


def test_a_mitsuba_scene_is_kept_with_the_hash_of_every_file(tmp_path: Path) -> None:
    document = manifest(read_user_scene(MESH), tmp_path, samples_per_pixel=64)
    rendering = document["rendering"]
    assert (rendering["method"], rendering["reason"]) == ("path", "it is a Mitsuba scene")
    assert set(rendering["scene_files"]) == {"scene.xml", "sky.exr", "icosahedron.ply"}
    assert rendering["samples_per_pixel_asked_for"] == 64
    assert document["measurements"]["patches"] is None
    assert document["scene"]["file"] == "scene.xml"
