import math
from pathlib import Path

import pytest

from gloss_stimuli.scene import Film, Scene, read_scene
from glossspace.display import DisplayModel
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
        (
            "center = [0.0, -0.25, 0.0]",
            "center = [0.0, -0.5, 0.0]",
            "must lie wholly inside the box",
        ),  # touches the floor
        ("center = [0.0, -0.25, 0.0]", "center = [1.0, -0.25, 0.0]", "must lie wholly inside the box"),
        (
            "luminance_cd_m2 = 1000.0",
            "luminance_cd_m2 = 0",
            "must be above 0, but is 0: without light every image is bl",
        ),
        ("luminance_cd_m2 = 1000.0", "luminance_cd_m2 = -1.0", "must be above 0, but is -1: without light"),
        ("luminance_cd_m2 = 1000.0", "luminance_cd_m2 = nan", r"light\.luminance_cd_m2.*finite"),
        ("luminance_cd_m2 = 1000.0", "luminance_cd_m2 = inf", r"light\.luminance_cd_m2.*finite"),
        ("size_xz = [1.2, 1.2]", "size_xz = [0.0, 1.2]", r"light\.size_xz.*greater than 0"),
        ("center_xz = [0.0, 0.75]", "center_xz = [0.7, 0.75]", "leave.* the ceiling"),
        ("radius = 0.5", "radius = nan", r"sphere\.radius"),
        ('lobe = "ward"', 'lobe = "phong"', r"sphere\.lobe.*ward"),
        ("position = [0.0, 0.2, 2.9]", "position = [0.0, -0.2, 0.1]", "inside the sphere"),
        ("position = [0.0, 0.2, 2.9]", "position = [0.0, 0.2, 9.0]", "inside the box"),
        ("position = [0.0, 0.2, 2.9]", "position = [0.0, 1.2, 0.0]", "straight above"),
        ("size_xz = [1.2, 1.2]", "size_xz = [9.0, 1.2]", "leave.* the ceiling"),
        ("adapting_luminance_cd_m2 = 10.0", "adapting_luminance_cd_m2 = 900.0", "must lie between"),
        ("white_cd_m2 = 108.0", "white_cd_m2 = 0.5", "white_cd_m2 that exceeds black_cd_m2.*0.7 and white 0.5"),
        ("black_cd_m2 = 0.7", "black_cd_m2 = 0.0", "black_cd_m2 must be above 0: no tone curve spans"),
        ("gamma = 2.35", "", r"'display': gamma is missing. State .* or \[display.measured\]"),
        ("bits = 8", "bits = 10", r"display\.bits"),
        (
            "gamma = 2.35",
            "measured = {codes = [0, 255], gray_cd_m2 = [0.7, 108]}",
            "black_cd_m2 stands beside a measured",
        ),
        ("width = 512", "width = 511", r"film\.width.*even number from 2 to 4096, but is 511"),
        ("width = 512", "width = 0", r"film\.width.*even number from 2 to 4096, but is 0"),
        ("width = 512", "width = 1", r"film\.width.*even number from 2 to 4096, but is 1"),
        ("height = 512", "height = 4098", r"film\.height.*even number from 2 to 4096, but is 4098"),
        ("height = 512", "height = 512.0", r"film\.height.*even number from 2 to 4096, but is 512.0"),
        ("height = 512", "", r"film\.height.*required"),
        (
            "distance_cm = 152.4",
            "distance_cm = 152.4\npixel_pitch_mm = 0.0",
            r"viewing\.pixel_pitch_mm.*greater than 0",
        ),
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


def changed(tmp_path: Path, old: str, new: str) -> Scene:
    assert old in SHIPPED
    path = tmp_path / "mine.toml"
    path.write_text(SHIPPED.replace(old, new), encoding="utf-8")
    return read_scene(path)


def test_a_scene_of_before_there_were_films_still_opens(tmp_path: Path) -> None:
    start, end = SHIPPED.index("[film]"), SHIPPED.index("[tone]")
    old = changed(tmp_path, SHIPPED[start:end], "")
    assert old.film == Film(width=512, height=512)
    assert old == read_scene()


def test_the_film_is_part_of_what_is_traced() -> None:
    scene = read_scene()
    wide = scene.with_film(Film(width=640, height=480))
    assert wide.geometry() != scene.geometry()
    assert wide.geometry()["film"] == {"width": 640, "height": 480}
    assert wide.with_film(scene.film) == scene


def test_a_scene_comes_back_from_json(scene_with) -> None:
    for scene in (read_scene(), scene_with(film={"height": 480}), scene_with(display={"bits": 16})):
        assert Scene.model_validate(scene.model_dump(mode="json")) == scene


@pytest.mark.parametrize(
    ("text", "size"), [("512", (512, 512)), (64, (64, 64)), ("640x480", (640, 480)), (" 2 X 4096 ", (2, 4096))]
)
def test_a_size_is_read_from_the_command_line(text: str | int, size: tuple[int, int]) -> None:
    film = Film.parse(text)
    assert (film.width, film.height) == size


@pytest.mark.parametrize(
    "text", ["511", "0", "1", "4098", "640x481", "640x", "x480", "1e3", "-2", "big", "", "9" * 4000, "٢"]
)
def test_a_size_that_no_film_has_is_refused(text: str) -> None:
    with pytest.raises(GlossError, match="The size must be an even number from 2 to 4096, but is .*as in 640x480"):
        Film.parse(text)


def test_the_section_describes_the_display(tmp_path: Path) -> None:
    assert read_scene().display.model() == DisplayModel()
    assert changed(tmp_path, "bits = 8", "bits = 16").display.model() == DisplayModel(bits=16)


def test_a_measured_display_takes_the_place_of_black_white_and_gamma(tmp_path: Path) -> None:
    stated = (
        "black_cd_m2 = 0.7                   # above 0: no tone curve spans an infinite contrast\nwhite_cd_m2 = 108.0\n"
    )
    channels = "codes = [0, 128, 255]\nred_cd_m2 = [0.5, 5.5, 20.5]\ngreen_cd_m2 = [0.5, 17.5, 70.5]\n"
    measured = f"[display.measured]\n{channels}blue_cd_m2 = [0.5, 2.5, 10.5]\n"
    scene = changed(tmp_path, f"{stated}gamma = 2.35\nbits = 8 ", f"{measured}#")
    display = scene.display.model()
    # The channels' light is 100 in all, on a black of .5.
    assert (display.black_cd_m2, display.white_cd_m2, display.gamma, display.bits) == (0.5, 100.5, None, 8)
    assert Scene.model_validate(scene.model_dump(mode="json")) == scene


def test_a_row_that_does_not_rise_is_named(tmp_path: Path) -> None:
    start, end = SHIPPED.index("[display]"), SHIPPED.index("[viewing]")
    table = "[display.measured]\ncodes = [0, 128, 255]\ngray_cd_m2 = [0.7, 30.0, 29.0]\n"
    with pytest.raises(GlossError, match=r"mine\.toml' is not valid at 'display': Row 3 .*gray_cd_m2 is 29"):
        changed(tmp_path, SHIPPED[start:end], table)


def test_viewing_knows_pixels_where_their_pitch_is_stated(tmp_path: Path) -> None:
    scene = changed(tmp_path, "# pixel_pitch_mm = 0.2695", "pixel_pitch_mm = 0.2695")
    assert scene.viewing.geometry().native_width_px == 316  # 85.138 mm / .2695 mm = 315.9
    assert read_scene().viewing.geometry().native_width_px is None
