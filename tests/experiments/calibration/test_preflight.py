"""What the check of a screen lets pass, warns of and refuses."""

import json
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from types import SimpleNamespace

import numpy as np
import pytest

from gloss_experiments import read_protocol
from gloss_experiments.calibration import (
    ScreenIdentity,
    SimulatedScreen,
    calibrate,
    read_calibration,
    save_calibration,
)
from gloss_experiments.preflight.gamma_table import GammaTable, monitor_gamma, read_gamma_table
from gloss_experiments.preflight.preflight import check_screen, judge_screen
from gloss_experiments.preflight.preflight_rows import largest_delta_l
from gloss_experiments.preflight.screen_facts import ScreenFacts, screen_facts
from glossspace.display import DisplayModel
from glossspace.errors import GlossError
from glossspace.stimulus_set import StimulusSet
from tests.experiments.calibration.screens import readings_of

NOW = datetime(2026, 4, 10, tzinfo=UTC)
IDENTITY = GammaTable(np.tile(np.linspace(0, 1, 256), (3, 1)))
GOOD = ScreenFacts(
    window_px=(1920, 1200), framebuffer_px=(1920, 1200), screen_px=(1920, 1200), monitor_gamma=None,
    gamma_table=IDENTITY, frame_rate_hz=59.95, n_frames=120, n_dropped=0, edid_sha256=("ab" * 32,),
)  # fmt: skip
SCREEN = ScreenIdentity(
    name="EIZO no. 7", size_px=(1920, 1200), refresh_hz=60.0, pixel_pitch_mm=0.2695, edid_sha256=("ab" * 32,)
)
PAIRWISE = read_protocol("pairwise")


@pytest.fixture
def stored(tmp_path):
    """Make a calibration of a screen, by default the gloss paper's."""

    def make(screen=None, *, photometer="LS-110", measured_at=NOW - timedelta(days=10), identity=SCREEN):
        readings = readings_of(screen or SimulatedScreen(), photometer=photometer)
        save_calibration(calibrate(readings, screen=identity, measured_at=measured_at), tmp_path / "c.json")
        return read_calibration(tmp_path / "c.json")

    return make


def images(width=316, display=DisplayModel()):  # noqa: B008 (frozen)
    manifest = {
        "image": {"width": width, "height": width},
        "viewing": {"image_width_deg": 3.2},
        "display": display.to_dict(),
    }
    return StimulusSet(None, "a", (), manifest)


def protocol(*, display=None, **checks):
    return PAIRWISE.model_copy(
        update={
            "checks": PAIRWISE.checks.model_copy(update=checks),
            "display": PAIRWISE.display.model_copy(update=display or {}),
        }
    )


def judged(facts=GOOD, *, calibration=None, stimuli=None, rules=PAIRWISE):
    return judge_screen(facts, rules, stimuli or images(), calibration=calibration, now=NOW)


def test_a_good_screen_passes(stored):
    found = judged(calibration=stored())
    assert {row.verdict for row in found.rows} == {"ok"}
    assert (found.problems, found.warnings) == ((), ())
    found.require()
    angle = next(row for row in found.rows if row.name == "image width")
    assert angle.found == "316 px, 3.20 degrees"  # 8.514 cm at 60 inches: the gloss paper's images
    assert found.calibration["screen"] == "EIZO no. 7"
    # Of the verification patches, which the methods text of a report tells from the journal
    assert found.calibration["n_verified"] > 0
    assert 0 <= found.calibration["rms_delta_l"] <= found.calibration["largest_delta_l"]


def test_a_lab_without_a_photometer_is_warned(stored):
    found = judged()
    assert [row.name for row in found.warnings] == ["pixel pitch", "image width", "calibration", "images' display"]
    found.require()
    strict = judged(rules=protocol(uncalibrated="refuse"))
    assert [row.name for row in strict.problems] == ["calibration", "images' display"]
    with pytest.raises(GlossError, match=r"calibration: not calibrated, but expected at most 30 days old.*--override"):
        strict.require()


@pytest.mark.parametrize(
    ("change", "refused"),
    [
        ({"window_px": (1280, 1024), "framebuffer_px": (1280, 1024)}, ["window"]),
        ({"framebuffer_px": (3840, 2400)}, ["framebuffer"]),
        ({"screen_px": (1280, 1024)}, ["window", "screen size"]),
        ({"monitor_gamma": (2.2, 2.2, 2.2)}, ["PsychoPy's correction"]),
        ({"gamma_table": GammaTable(IDENTITY.values ** (1 / 2.2))}, ["video card's gamma table"]),
        ({"gamma_table": GammaTable(IDENTITY.values * np.array([[1], [1], [0.9]]))}, ["video card's gamma table"]),
        ({"frame_rate_hz": 75.0}, ["frame rate"]),
        ({"edid_sha256": ("cd" * 32,)}, ["screen's identity (EDID)"]),
    ],
)
def test_what_is_off_is_refused(stored, change, refused):
    found = judged(replace(GOOD, **change), calibration=stored())
    assert [row.name for row in found.problems] == refused
    with pytest.raises(GlossError, match="The screen is not as it must be"):
        found.require()


@pytest.mark.parametrize("ramp", [np.arange(1, 257) / 256, np.arange(1024) / 1024, np.linspace(0, 1, 4096)])
def test_identity_as_systems_write_it(ramp):
    assert GammaTable(np.tile(ramp, (3, 1))).is_identity


def test_a_gamma_that_is_too_small_to_see_in_one_code_is_found():
    """1.02 turns the largest deviation from half a code into 1.9: x - x^(1.02) is largest at x = 1.02^(-1/.02)."""
    table = GammaTable(np.tile(np.linspace(0, 1, 1024) ** 1.02, (3, 1)))
    largest = 255 * (1.02 ** (-1 / 0.02) - 1.02 ** (-1.02 / 0.02))
    assert largest == pytest.approx(1.86, abs=0.01)
    # The other ways to write identity of 1,024 entries differ by a quarter of a code.
    assert table.deviation_codes == pytest.approx(largest, abs=0.26)
    assert not table.is_identity


def test_the_images_must_be_made_for_this_screen(stored):
    found = judged(calibration=stored(SimulatedScreen(gamma=(2.2,) * 3)))
    assert [row.name for row in found.problems] == ["images' display"]
    # By hand, at code 82: Y = .7 + 107.3 (82/255)^gamma gives L* 33.02 with 2.35 and 35.65 with 2.2.
    assert "ΔL* -2.63 at code 82" in found.problems[0].found
    assert judged(calibration=stored(SimulatedScreen(gamma=(2.3,) * 3))).problems == ()
    tight = judged(calibration=stored(SimulatedScreen(gamma=(2.3,) * 3)), rules=protocol(luminance_delta_l=0.5))
    assert [row.name for row in tight.problems] == ["images' display"]


def test_images_for_a_measured_screen_fit_it(stored):
    calibration = stored(SimulatedScreen(gamma=(2.1, 2.2, 2.4), offset=(0.05,) * 3))
    found = judged(calibration=calibration, stimuli=images(display=calibration.display))
    assert found.problems == ()
    assert largest_delta_l(calibration.display, calibration.display)[0] == 0


def test_screens_of_other_bits_compare():
    assert largest_delta_l(DisplayModel(bits=16), DisplayModel(bits=8)) == (0.0, 0)


@pytest.mark.parametrize(
    ("measured_at", "refused"),
    [
        (NOW - timedelta(days=29.9), False),
        (NOW - timedelta(days=30.1), True),
        (NOW + timedelta(hours=20), False),
        (NOW + timedelta(days=2), True),
    ],
)
def test_the_age_of_the_calibration(stored, measured_at, refused):
    found = judged(calibration=stored(measured_at=measured_at))
    assert [row.name for row in found.problems] == ["calibration's age"] * refused


def test_a_simulated_calibration_is_of_no_screen(stored):
    found = judged(calibration=stored(photometer="simulated"))
    assert [row.name for row in found.problems] == ["calibration"]
    assert found.calibration["simulated"] is True


def test_the_visual_angle(stored):
    found = judged(calibration=stored(), stimuli=images(width=512))
    assert [row.name for row in found.problems] == ["image width"]
    assert "5.18 degrees (render with --size 316)" in found.problems[0].found
    # The protocol's own pitch goes before the calibrated one, but must agree with it.
    own = judged(calibration=stored(), rules=protocol(display={"pixel_pitch_mm": 0.30}))
    assert [row.name for row in own.problems] == ["pixel pitch", "image width"]
    assert judged(rules=protocol(display={"pixel_pitch_mm": 0.2695})).problems == ()


def test_frames(stored):
    dropped = replace(GOOD, n_dropped=6)
    still = judged(dropped, calibration=stored())
    assert [row.name for row in still.warnings] == ["dropped frames"], "pictures that stand still survive a late frame"
    strict = judged(dropped, calibration=stored(), rules=protocol(frame_rate_hz=60.0))
    assert [row.name for row in strict.problems] == ["dropped frames"]
    virtual = replace(GOOD, frame_rate_hz=None, n_frames=0)
    assert [row.name for row in judged(virtual, calibration=stored()).warnings] == ["frame rate"]
    wanted = judged(virtual, calibration=stored(), rules=protocol(frame_rate_hz=60.0))
    assert [row.name for row in wanted.problems] == ["frame rate"]
    # What the protocol states goes before what the screen was calibrated with.
    faster = judged(calibration=stored(), rules=protocol(frame_rate_hz=75.0))
    assert [(row.name, row.expected) for row in faster.problems] == [("frame rate", "75 Hz")]


def test_late_frames_are_counted(monkeypatch):
    """At 100 Hz a frame after 20 ms missed its turn, one after 14 ms did not: half a period is the limit."""
    gaps = iter([0.0, *([0.010] * 100), *([0.020] * 7), *([0.014] * 13)])
    now = [0.0]

    def flip():
        now[0] += next(gaps)

    monkeypatch.setattr("gloss_experiments.preflight.screen_facts.time.perf_counter", lambda: now[0])
    window = Window()
    window.flip = flip
    found = screen_facts(window, refresh_s=0.010)
    assert (found.n_frames, found.n_dropped, found.frame_rate_hz) == (120, 7, pytest.approx(100))


def test_a_gamma_table_that_cannot_be_read(stored):
    unreadable = replace(GOOD, gamma_table="no such extension")
    found = judged(unreadable, calibration=stored())
    assert [(row.name, row.found) for row in found.warnings] == [
        ("video card's gamma table", "cannot be read: no such extension")
    ]
    strict = judged(unreadable, calibration=stored(), rules=protocol(unreadable_gamma_table="refuse"))
    assert [row.name for row in strict.problems] == ["video card's gamma table"]


def test_a_window_that_is_not_full_screen(stored):
    rules = protocol(display={"fullscreen": False, "window_size_px": (1280, 1024)})
    small = replace(GOOD, window_px=(1280, 1024), framebuffer_px=(1280, 1024))
    assert judged(small, calibration=stored(), rules=rules).problems == ()
    assert [row.name for row in judged(calibration=stored(), rules=rules).problems] == ["window"]


class Window:
    """As much of a PsychoPy window as the check asks for, with a gamma table that can be read."""

    size = frameBufferSize = (1920, 1200)
    gamma = None

    def __init__(self, ramp=IDENTITY.values, gamma=None, grid=None):
        self.winHandle = SimpleNamespace(screen=SimpleNamespace(width=1920, height=1200))
        self.monitor = SimpleNamespace(getGamma=lambda: gamma, getGammaGrid=lambda: grid)
        self.backend = SimpleNamespace(getGammaRamp=self.read)
        self.ramp = ramp

    def read(self):
        if isinstance(self.ramp, Exception):
            raise self.ramp
        return self.ramp


@pytest.mark.parametrize(
    ("ramp", "reason"),
    [
        (OSError("The function (GetRamp) failed. Long advice."), "GetRamp failed"),
        (OSError("Not today. Long advice."), "Not today"),
        (AttributeError("no ramp"), "AttributeError: no ramp"),
        (None, "virtual machine"),
        (np.zeros((2, 256)), "a table of shape (2, 256)"),
        (np.full((3, 256), np.nan), "values from nan to nan"),
        (IDENTITY.values * 257, "values from 0 to 257"),
    ],
)
def test_tables_that_cannot_be_read(ramp, reason):
    found = read_gamma_table(Window(ramp))
    assert isinstance(found, str)
    assert reason in found


def test_what_psychopy_corrects():
    assert monitor_gamma(Window()) is None
    assert monitor_gamma(Window(gamma=1.0)) is None
    assert monitor_gamma(Window(gamma=2.2)) == (2.2,)
    linear = np.array([[0.0, 100.0, 1.0]] * 4)
    assert monitor_gamma(Window(grid=linear)) is None
    corrected = linear.copy()
    corrected[1:, 2] = 2.2
    assert monitor_gamma(Window(grid=corrected)) == (1, 2.2, 2.2, 2.2)


def test_the_check_of_a_window(stored, monkeypatch):
    monkeypatch.setattr("gloss_experiments.preflight.screen_facts.connected_edid_sha256", lambda: ())
    calibration = stored()
    window = Window(IDENTITY.values ** (1 / 2.2))
    found = check_screen(window, PAIRWISE, images(), refresh_s=None, calibration=calibration.path, now=NOW)
    assert [row.name for row in found.problems] == ["video card's gamma table"]
    with pytest.raises(GlossError, match="--override"):
        found.require()
    overridden = check_screen(
        window,
        PAIRWISE,
        images(),
        refresh_s=None,
        calibration=calibration,
        override=" the dimmer is broken ",
        now=NOW,
    )
    overridden.require()
    kept = json.loads(json.dumps(overridden.to_dict(), allow_nan=False))
    assert (kept["override"], kept["refused"]) == ("the dimmer is broken", ["video card's gamma table"])
    assert kept["calibration"]["sha256"] == calibration.sha256
    assert {row["name"] for row in kept["rows"]} == {row.name for row in found.rows}
    assert overridden.table().splitlines()[-1] == "Overridden: the dimmer is broken"
    assert "REFUSED" in found.table()
    with pytest.raises(GlossError, match="needs the reason"):
        check_screen(window, PAIRWISE, images(), refresh_s=None, override=" ")
    with pytest.raises(GlossError, match="No screen calibration"):
        check_screen(window, PAIRWISE, images(), refresh_s=None, calibration="no.json")
