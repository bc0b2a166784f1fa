"""The real window on a virtual display: what it shows is read back, and a real pointer answers in it."""

import csv
import json
import re
import sys
import unicodedata
from pathlib import Path

import pytest
from PIL import Image

from gloss_experiments import read_protocol, run_session
from gloss_experiments.window.screen import open_screen
from glossspace.errors import GlossError
from tests.experiments.virtual_display import on_a_virtual_display
from tests.experiments.window_texts import ARABIC, HEBREW

DOI = read_protocol("doi")


def answers_in(journal):
    lines = [json.loads(line) for line in Path(journal).read_text(encoding="utf-8").splitlines()]
    return lines[0], [line for line in lines if line.get("type") == "trial"]


def test_whole_sessions_with_a_scripted_mouse(experiment1, tmp_path):
    """378 pairs, three sequences of 27 single stimuli and two rankings, each through the real window."""
    seen = on_a_virtual_display("window_program.py", "scripted", experiment1, tmp_path / "a")
    for kind, n_trials, n_frames in (("pairwise", 378, 80), ("magnitude", 81, 50), ("ranking", 2, 6)):
        found = seen[kind]
        assert found["trials"] == n_trials
        assert found["frames_checked"] >= n_frames, kind
        assert found["differing_pixels"] == 0, "the framebuffer holds the code values of the PNG"
        assert found["lit_around_images"] == 0, "the surround is black"
        assert found["window_size"] == [1280, 1024]
        assert found["phases"][:2] == ["ready", "preview"]
        assert "practice_done" in found["phases"]
        assert found["opened_in_trials"] == [], "all is loaded before the first trial"
        frames = found["frames"]
        assert frames["n_frames"] >= 5 * n_trials, "each trial takes the hand some frames"
        assert 0 < frames["median_work_ms"] <= frames["longest_work_ms"]
        assert frames["n_dropped"] is frames["longest_frame_ms"] is None, "a virtual display has none to miss"
    assert "pause" in seen["pairwise"]["phases"]
    for kind in ("pairwise", "magnitude"):
        # The line is drawn at -0.3, code value 89, and the marker at 0.5, code value 191.
        assert 80 < seen[kind]["brightest_before_response"] <= 90, "the line, and no marker, before the first response"
        assert seen[kind]["dimmest_marker"] >= 190

    for task, n_rows in (("pairwise", 378), ("doi", 81), ("ranking", 12)):
        run_session(task, stimuli=experiment1, dataset=tmp_path / "b", participant="01")
        name = f"data/subject-01/subject-01_session-1_task-{task}_data.csv"
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes(), "as without a window"
        with (tmp_path / "a" / name).open(encoding="utf-8") as stream:
            assert len(list(csv.reader(stream))) == 1 + n_rows


def test_a_real_pointer_and_keys(small_set, tmp_path):
    seen = on_a_virtual_display("window_program.py", "pointer", small_set, tmp_path)
    assert seen["failures"] == []
    assert (seen["answered"], seen["finished"], seen["simulated"]) == (4, False, False), "Escape and Stop ended it"
    assert seen["frames_checked"] >= 10
    assert seen["differing_pixels"] == 0
    assert seen["unmoved"] is None, "an arrow moves no marker that is not there"
    assert seen["after_escape"] == [2, 33, 33], "the same trial, with the slider as it was"
    assert seen["held"] is None, "a press from before the trial counts for nothing"
    header, answers = answers_in(seen["journal"])
    assert header["observer"] == {"kind": "human"}
    assert [line["rating"] for line in answers] == [30, 75, 34, 5], "what was judged is kept, the rest is not"
    assert all(0 < line["trace"]["first_response_s"] < line["response_time_s"] < 60 for line in answers)
    # Typed 4, then 42; moved to 43, to 33 and to 34: five rests, and the path turns at 43 and at 33.
    trace = answers[2]["trace"]
    assert (trace["n_changes"], trace["n_reversals"], trace["lowest"], trace["highest"]) == (5, 2, 4, 43)
    assert trace["n_dropped"] is trace["longest_frame_ms"] is None, "the display is virtual"
    assert not (tmp_path / "data").exists()


def test_a_ranking_with_real_pointer_and_keys(experiment1, tmp_path):
    seen = on_a_virtual_display("window_program.py", "ranking", experiment1, tmp_path)
    assert seen["failures"] == []
    items = seen["items"]
    assert seen["dropped_beside"] == [items[1], items[3]], "a drop beside everything changes nothing"
    assert seen["unconfirmed"] == 0, "nothing is confirmed before every item has a rank"
    assert seen["by_keys"] == [items[i] for i in (1, 0, 2, 3, 4)]
    assert (seen["marked"], seen["moved"]) == (items[4], [items[i] for i in (1, 0, 2, 4, 3)])
    assert seen["after_escape"] == seen["moved"], "Escape, and Escape again, goes on where it was"
    _, answers = answers_in(seen["journal"])
    assert [line["order"] for line in answers] == [seen["moved"]]
    # Two dragged in, one taken back, four with keys, one moved.
    assert answers[0]["trace"]["n_changes"] == 8
    assert seen["frames_checked"] >= 3
    assert seen["differing_pixels"] == 0, "reference and marked item are shown at their own size"


def test_time_limit_rest_close_button_and_summary(small_set, tmp_path):
    seen = on_a_virtual_display("window_program.py", "limits", small_set, tmp_path)
    assert seen["failures"] == []
    assert seen["waiting"] == 0, "after the limit, the message waits for the observer"
    assert seen["rested_s"] >= 2, "no rest is shorter than the protocol says"
    _, answers = answers_in(seen["journal"])
    assert [(line["rating"], line["timed_out"]) for line in answers] == [(None, True), (7, False), (9, False)]
    assert 3 <= answers[0]["response_time_s"] < seen["timed_out_after_s"]
    # The second was asked whether to stop for longer than the limit, and did not time out.
    assert seen["finished"]
    assert seen["phases"] == ["ready", "rating", "pause", "rating"]
    assert len(seen["pages"]) == 1
    assert any("7.0" in line and "9.0" in line for line in seen["pages"][0]), "of the identical and the other pair"


def test_the_preview_and_the_gamma_of_a_saved_monitor(small_set, tmp_path):
    """A gamma in PsychoPy's own folder is not applied: under this display, applying one would fail, too."""
    seen = on_a_virtual_display("window_program.py", "overview", small_set, tmp_path, home=tmp_path)
    assert seen["saved_gamma"] == pytest.approx(2.2)
    large, small = seen["1280"], seen["740"]
    assert large["picture_size"] == [256, 256]
    assert large["size_note"] == ""
    assert small["picture_size"][0] < 256
    assert small["size_note"] == f"{100 * small['picture_size'][0] / 256:.0f} %"
    for found in (large, small):
        assert found["differing_pixels"] == 0, "pictures of the preview hold the code values of the PNG, or their means"
        assert found["gamma"] is None
        assert found["native_gamma"], "the video card's table is left as it is"


def test_texts_that_do_not_fit_are_refused(small_set, tmp_path):
    """A line of 24 pixels is about 34 high: 60 lines are 2040, and 35 are 1190, of 1024."""
    told = on_a_virtual_display("window_program.py", "overflow", small_set, tmp_path)
    for key, message in told.items():
        assert message is not None, key
        assert message.startswith(f"texts.{key} does not fit into the window of 1280 x 1024 pixels")


def test_right_to_left_texts(small_set, tmp_path):
    seen = on_a_virtual_display("window_program.py", "scripts", small_set, tmp_path)
    lines = seen["he"]["lines"]
    text = HEBREW * 10
    assert len(lines) > 2
    # Each line is seen from the right, its letters turned; so the first words stand in the first line.
    assert lines[0].endswith(HEBREW[0][::-1])
    assert [word[::-1] for line in lines if line for word in reversed(line.split())][: len(text)] == list(text)
    # Letters of an Arabic word are joined: other signs, of the block of presentation forms.
    first = seen["ar"]["lines"][0].split()[-1][::-1]
    assert all("\ufe70" <= letter <= "\ufefc" for letter in first)
    assert unicodedata.normalize("NFKC", first) == ARABIC[0]
    for language in ("he", "ar"):
        assert max(seen[language]["size"]) < 1280


def test_a_font_that_cannot_write_the_texts_is_refused(small_set, tmp_path):
    told = on_a_virtual_display("window_program.py", "fonts", small_set, tmp_path)
    assert told["shipped"] is told["generic"] is None
    assert told["japanese"].startswith("texts.font 'DejaVu Sans' has no sign for: 光 沢. Name an installed font")
    assert 'fc-list ":charset=5149 6ca2" family' in told["label"], "U+5149 and U+6CA2"
    assert " …. Name" in told["many"]
    assert told["elsewhere"].startswith("texts.font 'No Such Font' is not installed here")
    assert told["nameless"].startswith("texts.font '' is not installed here")
    # Of a letter with marks FreeType draws the first sign: another word in Lao, the same one in Hebrew.
    assert told["lao"].startswith("The window draws no marks on letters on this system: of ເບິ່ it would")
    assert told["pointed"] is told["decomposed"] is None


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
