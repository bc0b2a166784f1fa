import math
from pathlib import Path

import pytest

from gloss_stimuli.scene import read_scene
from glossspace.errors import GlossError
from glossspace.files import shipped_folder

SHIPPED = (shipped_folder(__import__("gloss_stimuli").__file__, "scenes") / "checkerboard_box.toml").read_text("utf-8")


def test_default_scene_holds_what_the_paper_states() -> None:
    scene = read_scene()
    # Gloss paper 3.2.3.2: monitor of 0.7 to 108 cd/m2 with gamma 2.35, 60 inches away, images 3.2 degrees wide.
    assert (scene.display.black_cd_m2, scene.display.white_cd_m2, scene.display.gamma) == (0.7, 108.0, 2.35)
    assert scene.viewing.distance_cm == pytest.approx(60 * 2.54, abs=1e-12)
    assert scene.viewing.image_width_cm == pytest.approx(8.514, abs=5e-4)  # printed to three decimals
    assert (scene.box.dark_reflectance, scene.box.light_reflectance) == (0.03, 0.767)
    assert scene.sphere.lobe == "ward"


def test_camera_axes_are_an_upright_orthonormal_frame(scene_with) -> None:
    right, up, forward = scene_with(camera={"position": [0.3, 0.4, 2.0], "target": [0.1, -0.2, 0.0]}).camera.axes()
    for a, b, product in [(right, right, 1), (up, up, 1), (forward, forward, 1), (right, up, 0), (up, forward, 0)]:
        assert sum(x * y for x, y in zip(a, b, strict=True)) == pytest.approx(product, abs=1e-14)  # double rounding
    assert right[1] == 0
    assert up[1] > 0


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("check_size = 0.5", "check_size = 0.0", r"box\.check_size.*greater than 0"),
        ("check_size = 0.5", "", r"box\.check_size.*required"),
        ("check_size = 0.5", "check_size = 0.5\ncheck_sise = 1.0", r"box\.check_sise.*not permitted"),
        ("radius = 0.5", "radius = 1.5", "must lie wholly inside the box"),
        ("radius = 0.5", "radius = nan", r"sphere\.radius"),
        ('lobe = "ward"', 'lobe = "phong"', r"sphere\.lobe.*ward"),
        ("position = [0.0, 0.2, 2.9]", "position = [0.0, -0.2, 0.1]", "inside the sphere"),
        ("position = [0.0, 0.2, 2.9]", "position = [0.0, 0.2, 9.0]", "inside the box"),
        ("position = [0.0, 0.2, 2.9]", "position = [0.0, 1.2, 0.0]", "straight above"),
        ("size_xz = [1.2, 1.2]", "size_xz = [9.0, 1.2]", "leave.* the ceiling"),
        ("adapting_luminance_cd_m2 = 10.0", "adapting_luminance_cd_m2 = 900.0", "must lie between"),
        ("white_cd_m2 = 108.0", "white_cd_m2 = 0.5", "white_cd_m2 must exceed"),
        ("version = 1", "version = 2", "version"),
        ("[box]", "[box", "not valid TOML"),
    ],
)
def test_a_wrong_value_is_named_on_one_line(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in SHIPPED
    path = tmp_path / "mine.toml"
    path.write_text(SHIPPED.replace(old, new), encoding="utf-8")
    with pytest.raises(GlossError, match=message) as caught:
        read_scene(path)
    assert "\n" not in str(caught.value)
    assert "mine.toml" in str(caught.value)


def test_an_unknown_scene_lists_those_that_exist() -> None:
    with pytest.raises(GlossError, match="No scene 'kitchen'.*checkerboard_box"):
        read_scene("kitchen")


def test_geometry_leaves_out_what_does_not_change_luminance(scene_with) -> None:
    assert scene_with(tone={"slope": 0.9}).geometry() == read_scene().geometry()
    assert scene_with(light={"luminance_cd_m2": 10.0}).geometry() != read_scene().geometry()
    assert math.isfinite(read_scene().geometry()["light"]["luminance_cd_m2"])
