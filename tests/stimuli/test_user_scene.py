"""Scenes that a Mitsuba user brings: read, checked, hashed, and loaded with our film."""

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from gloss_stimuli.mitsuba_scene import load_scene
from gloss_stimuli.scene import Film
from gloss_stimuli.user_scene import UserScene, read_user_scene
from glossspace.errors import GlossError
from glossspace.metric import AxisFunction, GlossSpace
from glossspace.stimulus_set import Stimulus

EXAMPLE = Path(__file__).parent / "data" / "mesh_scene"
GRAY = Stimulus.of(0.193, 0.066, 0.07)


@pytest.fixture
def scene_with(tmp_path: Path) -> Callable[..., Path]:
    """Copy the example and replace text in its files: ``scene_with(xml=[(old, new)], toml=[(old, new)])``."""

    def make(**replacements: list[tuple[str, str]]) -> Path:
        folder = tmp_path / "mine"
        shutil.copytree(EXAMPLE, folder)
        for ending, changes in replacements.items():
            path = folder / f"scene.{ending}"
            text = path.read_text("utf-8")
            for old, new in changes:
                assert old in text
                text = text.replace(old, new)
            path.write_text(text, "utf-8")
        return folder / "scene.toml"

    return make


def perceptual(*extra: str) -> list[tuple[str, str]]:
    """Replacements that give the example's mesh a ``gloss_ward``."""
    return [
        ('type="ward"', 'type="gloss_ward"'),
        ('<float name="rho_d" value="$rho_d"/>', '<float name="lightness" value="$lightness"/>' + "".join(extra)),
        ('<float name="rho_s" value="$rho_s"/>', '<float name="c" value="$c"/>'),
        ('<float name="alpha" value="$alpha"/>', '<float name="d" value="$d"/>'),
    ]


def test_the_example_is_read() -> None:
    scene = read_user_scene(EXAMPLE / "scene.toml")
    assert (scene.name, scene.film, scene.path) == ("icosahedron", Film(width=32, height=24), EXAMPLE / "scene.xml")
    expected = {"rho_d": "0.193", "rho_s": "0.066", "alpha": "0.07", "width": "32", "height": "24"}
    assert scene.parameters(GRAY) == expected
    assert scene.with_film(Film(width=64, height=48)).parameters(GRAY)["height"] == "48"
    assert set(scene.content()) == {"scene.xml", "sky.exr", "icosahedron.ply"}


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("version = 1", "version = 2", "'version'"),
        ('name = "icosahedron"', 'name = "two words"', "'name'"),
        ("width = 32", "width = 31", r"film\.width.*even number"),
        ("[film]", "[screen]", "'screen'.*not permitted"),
        ("slope = 1.0", "", r"tone\.slope.*required"),
        ("adapting_luminance_cd_m2 = 20.0", "adapting_luminance_cd_m2 = 900.0", "must lie between"),
        ("[tone]", "[tone", "not valid TOML"),
        ('file = "scene.xml"', 'file = "room.xml"', "names the Mitsuba scene 'room.xml', but there is no file"),
        ('file = "scene.xml"', 'file = "."', "there is no file"),
    ],
)
def test_a_wrong_value_in_the_toml_is_named(scene_with, old: str, new: str, message: str) -> None:
    with pytest.raises(GlossError, match=message) as caught:
        read_user_scene(scene_with(toml=[(old, new)]))
    assert "\n" not in str(caught.value)


def test_a_missing_toml_is_named(tmp_path: Path) -> None:
    with pytest.raises(GlossError, match="No scene at '.*nowhere.toml'. Check the path"):
        read_user_scene(tmp_path / "nowhere.toml")
    with pytest.raises(GlossError, match="Cannot read the scene"):
        read_user_scene(tmp_path)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("</sensor>", "", "is not valid XML: mismatched tag"),
        ("scene version", "shape version", "is not valid XML"),
        (
            'value="$alpha"',
            'value="0.1"',
            r"leaves no paint open.*\$rho_d, \$rho_s and \$alpha.*It uses \$height, \$rho_d",
        ),
        ('value="$alpha"', 'value="$roughness"', r"uses the parameter '\$roughness', which nothing sets.*<default>"),
        ("icosahedron.ply", "teapot.ply", "refers to 'teapot.ply', but there is no such file beside it"),
        ("sky.exr", "sky.hdr", "refers to 'sky.hdr'"),
        ("<emitter", '<include filename="more.xml"/><emitter', "refers to 'more.xml'"),
    ],
)
def test_what_is_wrong_in_the_xml_is_told_before_mitsuba_runs(scene_with, old: str, new: str, message: str) -> None:
    with pytest.raises(GlossError, match=message) as caught:
        read_user_scene(scene_with(xml=[(old, new)]))
    assert "\n" not in str(caught.value)


def test_a_file_that_is_no_scene_is_refused(scene_with) -> None:
    path = scene_with()
    (path.parent / "scene.xml").write_text("<svg/>")
    with pytest.raises(GlossError, match="is no Mitsuba scene: its outermost element is <svg>"):
        read_user_scene(path)


def test_a_space_wants_ratings_which_a_stimulus_does_not_have(scene_with) -> None:
    path = scene_with(xml=perceptual('<string name="space" value="gloss-space.json"/>'))
    GlossSpace(axis_functions={axis: AxisFunction(300.0, 0.0, 0.9, 9) for axis in "cd"}).save(
        path.parent / "gloss-space.json"
    )
    with pytest.raises(GlossError, match=r"gives \$c or \$d to a gloss_ward with a `space`, which wants ratings"):
        read_user_scene(path)


def changed(scene_with, file: str, change: Callable[[Path], None]) -> tuple[dict, dict]:
    """Content of the example before and after one of its files is changed."""
    path = scene_with()
    before = read_user_scene(path).content()
    change(path.parent / file)
    return before, read_user_scene(path).content()


@pytest.mark.parametrize("file", ["scene.xml", "sky.exr", "icosahedron.ply"])
def test_the_content_changes_with_every_file(scene_with, file: str) -> None:
    before, after = changed(scene_with, file, lambda path: path.write_bytes(path.read_bytes() + b"\n"))
    assert {name for name in before if before[name] != after[name]} == {file}


def test_the_content_leaves_out_what_the_xml_does_not_name(scene_with) -> None:
    before, after = changed(scene_with, "notes.txt", lambda path: path.write_text("try a bluer sky"))
    assert before == after


@pytest.fixture
def with_include(scene_with) -> Path:
    """The example with another mesh from an included file, whose name a default parameter holds a part of."""
    path = scene_with(
        xml=[("<emitter", '<default name="kind" value="gem"/><include filename="parts/$kind.xml"/><emitter')]
    )
    parts = path.parent / "parts"
    parts.mkdir()
    (parts / "gem.xml").write_text(
        '<scene version="3.0.0"><shape type="ply"><string name="filename" value="gem.ply"/></shape></scene>'
    )
    shutil.copy(path.parent / "icosahedron.ply", parts / "gem.ply")
    return path


def test_included_files_and_theirs_belong_to_the_content(with_include: Path) -> None:
    assert {"parts/gem.xml", "parts/gem.ply"} <= set(read_user_scene(with_include).content())


# ---- in Mitsuba ----


def load(path: Path, **film: int):
    from gloss_stimuli.gloss_ward_bsdf import register_plugins

    register_plugins()
    scene = read_user_scene(path)
    return load_scene(scene.with_film(Film(**film)) if film else scene, GRAY, subpixels=2)


def image_of(loaded) -> np.ndarray:
    import mitsuba as mi

    return np.array(mi.render(loaded, integrator=mi.load_dict({"type": "path"}), spp=4, seed=1))[..., 0]


@pytest.mark.usefixtures("llvm")
def test_our_film_and_sampler_take_the_place_of_the_scenes(scene_with) -> None:
    loaded = load(scene_with())
    film = loaded.sensors()[0].film()
    assert tuple(film.size()) == (64, 48)
    assert film.rfilter().is_box_filter()
    assert "IndependentSampler" in str(loaded.sensors()[0].sampler())
    assert "Ward[rho_d=[0.193], rho_s=[0.066], alpha=[0.07]" in str(loaded)
    assert image_of(loaded).shape == (48, 64)


@pytest.mark.usefixtures("llvm")
def test_a_perceptual_paint_gives_the_same_picture(scene_with, tmp_path: Path) -> None:
    reference = image_of(load(EXAMPLE / "scene.toml"))
    # 1e-4: the parameters may differ in their last float32 digit; a sample may then fall on the other side of a choice.
    np.testing.assert_allclose(image_of(load(scene_with(xml=perceptual()))).mean(), reference.mean(), rtol=1e-4)


@pytest.fixture
def elsewhere(tmp_path: Path):
    """Another folder, which Mitsuba looks in first as it does in the one where Python was started."""
    import mitsuba as mi

    folder = tmp_path / "elsewhere"
    (folder / "parts").mkdir(parents=True)
    before, other = mi.file_resolver(), mi.FileResolver(mi.file_resolver())
    other.prepend(str(folder))
    mi.set_file_resolver(other)
    yield folder
    mi.set_file_resolver(before)


@pytest.mark.usefixtures("llvm")
def test_files_are_found_beside_the_scene_whatever_the_current_folder_holds(
    with_include: Path, elsewhere: Path
) -> None:
    import mitsuba as mi

    for name in ("icosahedron.ply", "parts/gem.xml", "gem.ply"):
        (elsewhere / name).write_text("not what the scene means")
    before = list(mi.file_resolver())
    loaded = load(with_include)
    assert [shape.primitive_count() for shape in loaded.shapes()] == [20, 20]
    assert list(mi.file_resolver()) == before


@pytest.mark.usefixtures("llvm")
def test_a_scene_may_give_numbers_where_they_agree(scene_with) -> None:
    path = scene_with(xml=[("$width", "32"), ("$height", "24")])
    assert tuple(load(path).sensors()[0].film().size()) == (64, 48)
    with pytest.raises(GlossError, match=r"has width 32, height 24, but \[film\] asks for width 40, height 30"):
        load(path, width=40, height=30)


@pytest.mark.usefixtures("llvm")
@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("$width", "640", r"has width 640, height 24, but \[film\] asks for width 32, height 24.*\$width and \$height"),
        (
            'value="$height"/>',
            'value="$height"/><integer name="crop_width" value="8"/>',
            "has .*crop_width 8.*without a crop",
        ),
        ("</scene>", '<sensor type="perspective"/></scene>', "must have one <sensor>, but has 2"),
        (
            "</scene>",
            '<integrator type="volpath"/></scene>',
            "asks for the integrator 'volpath'.*Remove its <integrator>",
        ),
        (
            "</scene>",
            '<integrator type="path"><boolean name="hide_emitters" value="true"/></integrator></scene>',
            "hides what emits light.*Remove its hide_emitters",
        ),
        ('type="ply"', 'type="gltf2"', "cannot load the scene '.*scene.xml' in the variant llvm_ad_mono.*gltf2"),
        ('value="$rho_s"', 'value="0.9"/><float name="unused" value="$rho_s"', "rho_d . rho_s = 1.093"),
        (
            '<emitter type="envmap">\n        <string name="filename" value="sky.exr"/>\n    </emitter>',
            '<emitter type="sunsky"/>',
            "cannot load .*in the variant llvm_ad_mono, which has luminance as its one channel.*sunsky",
        ),
        (
            '<emitter type="envmap">\n        <string name="filename" value="sky.exr"/>\n    </emitter>',
            "",
            "has no light, so every image would be black",
        ),
    ],
)
def test_what_mitsuba_cannot_render_is_told_on_one_line(scene_with, old: str, new: str, message: str) -> None:
    path = scene_with(xml=[(old, new)])
    with pytest.raises(GlossError, match=message) as caught:
        load(path)
    assert "\n" not in str(caught.value)


@pytest.mark.usefixtures("llvm")
def test_a_path_integrator_of_the_scene_gives_way(scene_with) -> None:
    path = scene_with(
        xml=[("</scene>", '<integrator type="path"><integer name="max_depth" value="2"/></integrator></scene>')]
    )
    np.testing.assert_array_equal(image_of(load(path)), image_of(load(EXAMPLE / "scene.toml")))


def test_a_scene_is_frozen() -> None:
    scene = read_user_scene(EXAMPLE / "scene.toml")
    assert isinstance(scene, UserScene)
    with pytest.raises(ValueError, match="frozen"):
        scene.name = "other"  # type: ignore[misc]
    assert scene == read_user_scene(EXAMPLE / "scene.toml")
