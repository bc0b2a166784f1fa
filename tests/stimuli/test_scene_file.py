from pathlib import Path

import pytest

from gloss_stimuli.scene import Scene, read_scene
from gloss_stimuli.scene_file import read_any_scene
from gloss_stimuli.user_scene import UserScene, read_user_scene
from glossspace.errors import GlossError

MESH = Path(__file__).parent / "data" / "mesh_scene" / "scene.toml"
SHIPPED = Path(__file__).parents[2] / "stimuli" / "scenes" / "checkerboard_box.toml"


@pytest.mark.parametrize("source", [None, "checkerboard_box", SHIPPED, str(SHIPPED)])
def test_a_box_is_read_by_name_or_file(source: str | Path | None) -> None:
    scene = read_any_scene(source)
    assert isinstance(scene, Scene)
    assert scene == read_scene()


@pytest.mark.parametrize("source", [MESH, str(MESH)])
def test_a_mitsuba_scene_is_told_by_the_format_that_it_states(source: str | Path) -> None:
    scene = read_any_scene(source)
    assert isinstance(scene, UserScene)
    assert scene == read_user_scene(MESH)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"format = ", "not valid TOML"),
        (b"\xff\xfe", "is not in UTF-8"),
        (b'format = "glossspace/stimulus-list"', "not valid at 'format'"),
        (b'format = "glossspace/mitsuba-scene"', "not valid at 'version'"),
        (b"", "not valid at 'format'"),
    ],
)
def test_what_is_wrong_with_a_file_is_said_by_its_own_reader(tmp_path: Path, content: bytes, message: str) -> None:
    path = tmp_path / "scene.toml"
    path.write_bytes(content)
    with pytest.raises(GlossError, match=message) as caught:
        read_any_scene(path)
    assert str(path) in str(caught.value)


def test_a_scene_that_is_not_there_is_told_with_those_that_are() -> None:
    with pytest.raises(GlossError, match="No scene 'kitchen'.*Shipped scenes: checkerboard_box"):
        read_any_scene("kitchen")


def test_a_folder_is_no_scene(tmp_path: Path) -> None:
    with pytest.raises(GlossError, match="No scene"):
        read_any_scene(tmp_path)
