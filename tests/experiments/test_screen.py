"""The real window on a virtual display: what it shows is read back, and a real pointer answers in it."""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

from gloss_experiments import read_protocol, run_session
from gloss_experiments.layout import arrange, checked_angle_deg, visual_angle_deg
from gloss_experiments.pointer import ScriptedPointer, slider_x
from gloss_experiments.screen import open_screen
from glossspace.errors import GlossError

PROGRAM = Path(__file__).parent / "window_program.py"
PAIRWISE, DOI = read_protocol("pairwise"), read_protocol("doi")


def on_a_virtual_display(*words):
    for tool in ("xvfb-run", "xauth", "xdotool"):
        if shutil.which(tool) is None:
            pytest.fail(f"'{tool}' is missing: apt-get install xvfb xauth xdotool ('make test' does it as root)")
    command = ["xvfb-run", "-a", "-s", "-screen 0 1280x1024x24", sys.executable, str(PROGRAM), *map(str, words)]
    result = subprocess.run(command, capture_output=True, text=True, timeout=240, check=False)
    assert result.returncode == 0, result.stderr[-3000:]
    return json.loads(result.stdout)


def test_a_scripted_mouse_goes_through_the_real_window(small_set, tmp_path):
    seen = on_a_virtual_display("scripted", small_set, tmp_path / "a")
    assert seen["trials"] == 6
    assert seen["window_size"] == [1280, 1024]
    assert seen["frames_checked"] >= 2 * 6
    assert seen["differing_pixels"] == 0, "the framebuffer holds the code values of the PNG"
    assert seen["lit_around_images"] == 0, "the surround is black"
    # The line is drawn at -0.3, code value 89, and the marker at 0.5, code value 191.
    assert seen["brightest_before_response"] <= 90, "no marker stands on the slider before the first response"
    assert seen["dimmest_marker"] >= 190
    # A budget with room for two busy cores; 5 to 9 s were measured, most of it the import of PsychoPy.
    assert seen["seconds_to_first_answer"] < 60

    run_session("pairwise", stimuli=small_set, dataset=tmp_path / "b", participant="01")
    name = "data/subject-01/subject-01_session-1_task-pairwise_data.csv"
    assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes(), "as without a window"


def test_a_real_pointer_and_keys(small_set, tmp_path):
    seen = on_a_virtual_display("pointer", small_set, tmp_path)
    assert seen["failures"] == []
    assert (seen["answered"], seen["data"], seen["simulated"]) == (2, None, False), "Escape ended it, unfinished"
    assert seen["frames_checked"] >= 3
    assert seen["differing_pixels"] == 0
    lines = [json.loads(line) for line in Path(seen["journal"]).read_text(encoding="utf-8").splitlines()]
    assert lines[0]["observer"] == {"kind": "human"}
    assert [line["rating"] for line in lines[1:]] == [30, 75], "what was judged is kept, the rest is not"
    assert all(0 < line["response_time_s"] < 60 for line in lines[1:])
    assert not (tmp_path / "data").exists()


def test_without_psychopy_one_line_says_what_to_install(small_set, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "psychopy", None)
    monkeypatch.setenv("DISPLAY", ":99")
    with pytest.raises(GlossError, match=re.escape("pip install 'glossspace[experiments]'")):
        run_session("doi", stimuli=small_set, dataset=tmp_path / "a", participant="01", mode="simulate")
    assert not (tmp_path / "a").exists()


@pytest.mark.parametrize(
    ("sizes", "mode", "message"),
    [
        ((64, 64), "I;16", "has mode 'I;16'; give an 8-bit PNG"),
        ((64, 32), "L", "must have one size, but there are 64 x 64 in .*, 32 x 32 in"),
    ],
)
def test_images_that_would_not_be_shown_exactly_are_refused(tmp_path, sizes, mode, message):
    images = {str(i): tmp_path / f"{i}.png" for i in range(2)}
    for path, size in zip(images.values(), sizes, strict=True):
        Image.new(mode, (size, size)).save(path)
    with pytest.raises(GlossError, match=message), open_screen(DOI, images):
        pass


def test_the_visual_angle_of_the_paper():
    """3.2 degrees at 60 inches are 8.514 cm: 2 · 152.4 cm · tan 1.6 degrees."""
    assert visual_angle_deg(8514, pixel_pitch_mm=0.01, distance_cm=152.4) == pytest.approx(3.2, abs=1e-4)


def test_images_of_a_wrong_angle_are_refused():
    display = PAIRWISE.display.model_copy(update={"pixel_pitch_mm": 0.2695})
    protocol = PAIRWISE.model_copy(update={"display": display})
    assert checked_angle_deg(PAIRWISE, 512) is None, "unknown without the pitch"
    assert checked_angle_deg(protocol, 316) == pytest.approx(3.2, abs=0.01)
    with pytest.raises(GlossError, match="are 5.18 degrees wide on this screen, but must be 3.2. .* --size 316"):
        checked_angle_deg(protocol, 512)


@pytest.mark.parametrize("protocol", [PAIRWISE, DOI], ids=["pairwise", "magnitude"])
@pytest.mark.parametrize("size", [64, 256, 512])
def test_the_layout_is_in_whole_pixels_and_nothing_overlaps(protocol, size):
    layout = arrange(protocol, image_size_px=(size, size), window_size_px=(1280, 1024))
    assert len(layout.images) == (2 if protocol.kind == "pairwise" else 1)
    assert sum(x for x, _ in layout.images) == 0, "symmetric about the centre"
    bottom_of_images = layout.images[0][1] - size // 2
    assert layout.question[1] > layout.images[0][1] + size // 2
    assert bottom_of_images > layout.slider[1] > layout.readout[1] > layout.button[1]
    assert layout.button[1] - layout.button_size[1] // 2 >= -512
    if protocol.kind == "pairwise":
        gap = layout.images[1][0] - layout.images[0][0] - size
        assert gap == pytest.approx(size * 0.8 / 3.2, abs=1)


@pytest.mark.parametrize(
    ("size", "window", "message"),
    [
        ((255, 256), (1280, 1024), "The images are 255 x 256 pixels; both must be even"),
        ((640, 640), (1280, 1024), "The trial needs 1440 x .* pixels, but the window has 1280 x 1024"),
    ],
)
def test_what_does_not_fit_is_refused(size, window, message):
    with pytest.raises(GlossError, match=message):
        arrange(PAIRWISE, image_size_px=size, window_size_px=window)


def test_the_scripted_pointer_presses_on_the_rating_and_on_the_button():
    layout = arrange(PAIRWISE, image_size_px=(64, 64), window_size_px=(1280, 1024))
    pointer = ScriptedPointer(layout)
    pointer.rate(25)
    pressed = []
    for _ in range(8):
        pointer.tick()
        if pointer.getPressed()[0]:
            pressed.append(pointer.getPos())
    assert pressed == [(slider_x(25, layout), layout.slider[1]), layout.button]
    assert (slider_x(0, layout), slider_x(100, layout)) == (-320, 320)
