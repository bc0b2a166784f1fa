"""Which renderer a scene gets; nothing is rendered here."""

from pathlib import Path

import pytest

from gloss_stimuli.coefficient_renderer import CoefficientRenderer
from gloss_stimuli.exact_renderer import ExactRenderer
from gloss_stimuli.method import METHODS, choose_renderer
from gloss_stimuli.path_renderer import PathRenderer
from gloss_stimuli.render import tone_curve
from gloss_stimuli.renderer import Renderer
from gloss_stimuli.scene import Scene, read_scene
from gloss_stimuli.target import find_target
from gloss_stimuli.user_scene import UserScene, read_user_scene
from glossspace.errors import GlossError

MESH = Path(__file__).parent / "data" / "mesh_scene" / "scene.toml"
# A sphere of radius .5 that floats .04 above the floor: its shadow there is too sharp for the exact renderer's grids.
NEAR_THE_FLOOR = {"sphere": {"center": [0.0, -0.46, 0.0]}}


def choose(scene: Scene | UserScene, tmp_path: Path, **options) -> tuple[Renderer, str]:
    options = {"method": "auto", "seed": 3, **options}
    return choose_renderer(
        scene,
        target=find_target("draft"),
        tone=tone_curve(scene),
        display=scene.display.model(),
        cache=tmp_path,
        **options,
    )


@pytest.mark.parametrize(
    ("method", "kind"), [("exact", ExactRenderer), ("coefficients", CoefficientRenderer), ("path", PathRenderer)]
)
def test_whoever_asks_for_a_method_gets_it(tmp_path: Path, method: str, kind: type) -> None:
    renderer, reason = choose(read_scene(), tmp_path, method=method)
    assert isinstance(renderer, kind)
    assert reason == "asked for"


def test_the_renderer_gets_what_it_was_chosen_with(tmp_path: Path) -> None:
    renderer, _ = choose(read_scene(), tmp_path)
    assert isinstance(renderer, ExactRenderer)
    assert (renderer.scene, renderer.seed, renderer.cache) == (read_scene(), 3, tmp_path)
    assert renderer.target == find_target("draft")
    assert (renderer.tone, renderer.display) == (tone_curve(read_scene()), read_scene().display.model())


def test_the_shipped_scene_is_rendered_exactly(tmp_path: Path) -> None:
    renderer, reason = choose(read_scene(), tmp_path)
    assert (renderer.method, reason) == ("exact", "a box within its scope")


def test_a_sphere_near_a_wall_is_traced_and_the_reason_is_its_distance(tmp_path: Path, scene_with) -> None:
    renderer, reason = choose(scene_with(**NEAR_THE_FLOOR), tmp_path)
    assert isinstance(renderer, CoefficientRenderer)
    assert reason == "the sphere is 0.04 from a wall, nearer than 0.1 of its radius"


def test_a_mitsuba_scene_is_path_traced(tmp_path: Path) -> None:
    renderer, reason = choose(read_user_scene(MESH), tmp_path)
    assert isinstance(renderer, PathRenderer)
    assert reason == "it is a Mitsuba scene"


@pytest.mark.parametrize("method", ["auto", "path"])
def test_samples_are_for_path_tracing(tmp_path: Path, method: str) -> None:
    renderer, _ = choose(read_user_scene(MESH), tmp_path, method=method, samples_per_pixel=32)
    assert isinstance(renderer, PathRenderer)
    assert renderer.samples_per_pixel == 32


@pytest.mark.parametrize("method", ["auto", "exact", "coefficients"])
def test_samples_are_refused_where_the_error_decides(tmp_path: Path, method: str) -> None:
    chosen = "exact" if method == "auto" else method
    message = rf"\(--spp\) is for --method path alone; the method here is '{chosen}'.*give --max-code-error"
    with pytest.raises(GlossError, match=message):
        choose(read_scene(), tmp_path, method=method, samples_per_pixel=32)


def test_a_scene_beyond_the_method_asked_for_is_refused_with_the_reason(tmp_path: Path, scene_with) -> None:
    with pytest.raises(
        GlossError, match="does not hold for the scene 'checkerboard_box': the sphere is 0.04.*Use --method auto"
    ):
        choose(scene_with(**NEAR_THE_FLOOR), tmp_path, method="exact")
    with pytest.raises(GlossError, match="does not hold for the scene 'icosahedron': it is a Mitsuba scene"):
        choose(read_user_scene(MESH), tmp_path, method="exact")
    with pytest.raises(GlossError, match="renders boxes only, but 'icosahedron' is a Mitsuba scene. Use --method path"):
        choose(read_user_scene(MESH), tmp_path, method="coefficients")


def test_an_unknown_method_is_told_with_those_that_are(tmp_path: Path) -> None:
    with pytest.raises(GlossError, match="Unknown method 'radiosity'. Allowed are auto, exact, coefficients, path"):
        choose(read_scene(), tmp_path, method="radiosity")
    assert METHODS == ("auto", "exact", "coefficients", "path")


def test_every_renderer_describes_itself_for_the_manifest(tmp_path: Path) -> None:
    for method in ("exact", "coefficients", "path"):
        renderer, _ = choose(read_scene(), tmp_path, method=method)
        described = renderer.describe()
        assert described["seed"] == 3
        assert all(described["software"].values())
