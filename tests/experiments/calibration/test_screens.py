"""Gamma is corrected in one place; patches are exact; keys and plugins are read. On real X servers."""

import pytest

from tests.experiments.calibration.x_servers import run_program, xorg_dummy
from tests.experiments.conftest import make_set


@pytest.fixture(scope="module")
def stimuli(tmp_path_factory):
    return make_set(tmp_path_factory.mktemp("set") / "small", n=3, size=64)


@pytest.fixture
def home(tmp_path):
    """Of a user without a PsychoPy monitor."""
    folder = tmp_path / "home"
    folder.mkdir()
    return folder


TABLE, PSYCHOPY = "video card's gamma table", "PsychoPy's correction"


def test_gamma_is_never_corrected_twice(stimuli, home, tmp_path):
    """Through a real gamma table: as found, by a saved Monitor, by a window's Monitor, after a kill, and set back."""
    with xorg_dummy(tmp_path) as display:
        found = run_program("one_by_one", stimuli, home=home, display=display)
        fresh = found["fresh"]
        assert fresh["rows"][TABLE] == ["identity", "ok"]
        assert fresh["rows"][PSYCHOPY] == ["none", "ok"]
        assert fresh["problems"] == []
        # A gamma that was saved under the name of the sessions' monitor reaches neither window nor video card.
        assert found["saved_monitor"] == fresh
        # PsychoPy linearises a window whose Monitor has a gamma: both rows refuse.
        assert found["corrected"]["problems"] == [PSYCHOPY, TABLE]
        assert found["corrected"]["rows"][PSYCHOPY][0] == "gamma 2.2, 2.2, 2.2"
        # It put its table back when it closed.
        assert found["again"] == fresh

        # Killed, it cannot: the next window inherits the table, and is refused until the table is set back.
        killed = run_program("killed", stimuli, home=home, display=display, killed=True)
        assert killed["problems"] == [PSYCHOPY, TABLE]
        after = run_program("after_the_kill", stimuli, tmp_path / "a.json", home=home, display=display)
        assert after["inherited"]["problems"] == [TABLE]
        assert after["inherited"]["rows"][PSYCHOPY] == ["none", "ok"]
        # x^(1/2.2) - x is largest where x = 2.2^(-1/(1 - 1/2.2)) = .2356: 72.1 code values; less up to one, since
        # identity is written in three ways and the nearest one counts.
        off = float(after["inherited"]["rows"][TABLE][0].split()[2])
        assert 71 <= off <= 72.2
        assert "--reset" in after["inherited"]["rows"][TABLE][0]
        assert after["read"]["identity"] is False
        assert after["measured"] == 2, "nothing is measured through it"
        assert not (tmp_path / "a.json").exists()
        assert after["reset"]["identity"] is True
        assert after["read_again"] == after["reset"]
        assert after["set_back"] == fresh


def test_without_a_gamma_table_the_check_says_so(stimuli, home):
    found = run_program("session_window", stimuli, home=home)
    told, verdict = found["rows"][TABLE]
    assert told.startswith("cannot be read: ")
    assert verdict == "warning"
    assert found["problems"] == []
    assert "not checked" in found["table"]


def test_every_patch_is_in_the_framebuffer_as_it_is(home):
    """Zero differing code values, and black (white for veiling light) all round."""
    assert run_program("patches", home=home) == {"wrong": [], "lit_around": []}


def test_numbers_typed_at_a_patch(home):
    assert run_program("typed", home=home) == {"first": 12.5, "second": None}


def test_a_photometer_that_reads_by_itself_is_aimed(home):
    found = run_program("aimed", home=home)
    assert found["answers"] == [1, 1, 1, 1, None], "Escape at the third place"
    assert found["read"] == ["full", "centre", "left", "left"]
    # The full field is of code 64; below the others stands black: the line is gone before the reading.
    assert found["lit_below"] == [64, 0, 0, 0, 0]


def test_photometers_of_psychopy_plugins(home, tmp_path):
    found = run_program("plugin", tmp_path, home=home)
    assert "FakeLS" in found["known"]
    assert "ScreenBufferPhotometerDevice" not in found["known"], "it reads the window's pixels, not light"
    assert (found["name"], found["value"]) == ("a fake", 12.5), "after two complaints of the instrument"
    assert "cannot read the patch 'fit centre 0 0 0' (it gave -1)" in found["complains"]
    assert "pip install psychopy-minolta" in found["unknown"]
    assert "manual, simulated" in found["unknown"]
    assert "cannot be opened without a port" in found["no_port"]
    assert "at port 'COM3' (it does not answer)" in found["silent"]
    assert "gives no luminance" in found["dumb"]
    assert found["hidden"] == 3.5
