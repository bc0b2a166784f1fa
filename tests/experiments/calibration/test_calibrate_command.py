"""`gloss calibrate` as a person types it, and measuring."""

import csv
import json

import pytest

from gloss_experiments.calibration import measure, read_calibration, read_readings, simulated_pace, standard_patches
from gloss_experiments.calibration.simulated import SimulatedPhotometer, SimulatedScreen
from glossspace import cli
from glossspace.errors import GlossError
from tests.experiments.calibration.x_servers import run_program


@pytest.fixture
def gloss(capsys):
    def run(*words):
        code = 0
        try:
            cli.main(["calibrate", *map(str, words)])
        except SystemExit as stop:
            code = stop.code
        return code, *capsys.readouterr()

    return run


@pytest.fixture
def refused(gloss):
    def run(*words):
        code, out, err = gloss(*words)
        assert (code, out) == (2, "")
        assert err.count("gloss: ") == 1
        assert "Traceback" not in err
        return err

    return run


@pytest.fixture
def readings(gloss, tmp_path):
    """Readings of the simulated photometer, as the command leaves them."""
    words = ("--photometer", "simulated", "--windowless", "--screen", "A", "--out", tmp_path / "first.json")
    code, _, err = gloss("measure", *words)
    assert code == 0, err
    return tmp_path / "first.csv"


def test_measure_without_a_window(gloss, tmp_path):
    out, luminance, figure = tmp_path / "s.json", tmp_path / "luminance.csv", tmp_path / "s.png"
    code, printed, err = gloss(
        "measure", "--photometer", "simulated", "--windowless", "--screen", "Test", "--out", out, "--warm-up", "60",
        "--luminance", luminance, "--figure", figure, "--pixel-pitch", "0.27",
    )  # fmt: skip
    assert code == 0, err
    assert "Test (SIMULATED)" in printed
    assert "smallest residual on 8 verification patches" in printed
    assert "Warm-up: stable after" in printed
    assert "no screen was measured" in err
    stored = read_calibration(out)
    assert (stored.simulated, stored.screen.pixel_pitch_mm) == (True, 0.27)
    assert read_readings(tmp_path / "s.csv").simulated
    assert luminance.read_text(encoding="utf-8").startswith("codes,gray_cd_m2\n0,")
    assert figure.read_bytes().startswith(b"\x89PNG")


def test_fit_readings(gloss, readings, tmp_path):
    out = tmp_path / "again.json"
    code, printed, err = gloss(
        "fit", readings, "--screen", "A", "--out", out, "--date", "2026-03-31", "--size", "1920x1200",
        "--refresh", "60",        "--luminance", tmp_path / "display.toml", "--json",
    )  # fmt: skip
    assert code == 0, err
    document = json.loads(printed, parse_constant=pytest.fail)
    assert document == json.loads(out.read_text(encoding="utf-8"))
    first = json.loads((tmp_path / "first.json").read_text(encoding="utf-8"))
    assert document["display"] == first["display"], "the same readings, the same fit"
    # The simulated screen adds ambient light of 0.02 cd/m² to the gloss paper's 0.7; its photometer errs by 0.3 %.
    assert document["display"]["black_cd_m2"] == pytest.approx(0.72, rel=0.02)
    curve = document["gain_offset_gamma"]["gain-offset-gamma of gray"]["curves"]["gray"]
    assert abs(curve["gamma"] - 2.35) < 2 * curve["gamma_half_width"]
    assert document["measured_at"].startswith("2026-03-31")
    assert document["screen"]["size_px"] == [1920, 1200]
    assert (tmp_path / "display.toml").read_text(encoding="utf-8").startswith("# The screen 'A', SIMULATED")


def test_patches_make_the_table_that_fit_reads(gloss, tmp_path):
    code, printed, _ = gloss("patches", "--csv")
    assert code == 0
    rows = list(csv.DictReader(printed.splitlines()))
    assert len(rows) == len(standard_patches())
    for row in rows:
        # The gloss paper's screen, filled in by hand.
        added = sum(
            share * 107.3 * (int(row[name]) / 255) ** 2.35
            for name, share in (("red", 0.2), ("green", 0.7), ("blue", 0.1))
        )
        row["luminance_cd_m2"] = 0.0 if row["purpose"] == "ambient" else 0.7 + added
    path = tmp_path / "r.csv"
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    code, printed, err = gloss("fit", path, "--screen", "A", "--out", tmp_path / "a.json", "--json")
    assert code == 0, err
    document = json.loads(printed)
    assert (document["simulated"], document["photometer"]) == (False, "not stated")
    assert document["gain_offset_gamma"]["gain-offset-gamma of gray"]["curves"]["gray"]["gamma"] == pytest.approx(
        2.35, abs=1e-6
    )


def test_patches_for_a_person_and_a_program(gloss):
    code, printed, err = gloss("patches", "--levels", "9", "--warm-up", "10")
    assert code == 0
    assert printed.count("warm_up") == 3
    assert "verify: what the curve is judged by" in err
    code, printed, _ = gloss("patches", "--json")
    first = json.loads(printed)[0]
    assert first | {"minutes": None} == first
    assert (first["purpose"], first["red"], first["meaning"]) == ("fit", 0, "what the curve is fitted to")


def test_mistakes(refused, readings, tmp_path):
    out = ("--screen", "A", "--out", tmp_path / "x.json")
    assert "No table of readings" in refused("fit", tmp_path / "no.csv", *out)
    assert "needs a name" in refused("fit", readings, "--screen", " ", "--out", tmp_path / "x.json")
    assert "Invalid --date 'monday'" in refused("fit", readings, *out, "--date", "monday")
    assert "Invalid --size '1920'" in refused("fit", readings, *out, "--size", "1920")
    assert "refresh rate of the screen is -1" in refused("fit", readings, *out, "--refresh", "-1")
    assert "'simulated' made its readings" in refused("fit", readings, *out, "--photometer", "LS-110")
    assert "Invalid figure" in refused("fit", readings, *out, "--figure", "a.gif")
    assert "Invalid luminance file" in refused("fit", readings, *out, "--luminance", "a.txt")
    assert "Two outputs have the same name" in refused(
        "fit", readings, "--screen", "A", "--out", tmp_path / "x.csv", "--luminance", tmp_path / "x.csv"
    )
    assert "it is a folder" in refused("fit", readings, "--screen", "A", "--out", tmp_path)
    assert "brightest gray of the fit is code 255, but the screen reaches 65535" in refused(
        "fit", readings, *out, "--bits", "16"
    )
    assert not (tmp_path / "x.json").exists()
    measuring = ("measure", *out, "--photometer")
    assert "--windowless shows nothing" in refused(*measuring, "manual", "--windowless")
    assert "--instrument names" in refused(*measuring, "simulated", "--instrument", "LS")
    assert "Invalid --settle -1" in refused(*measuring, "simulated", "--windowless", "--settle", "-1")
    assert "Invalid --image-size 513" in refused(*measuring, "simulated", "--windowless", "--image-size", "513")
    assert "number of levels 4" in refused(*measuring, "simulated", "--windowless", "--levels", "4")
    assert "which is another output" in refused(
        *measuring, "simulated", "--windowless", "--readings", tmp_path / "x.json"
    )
    assert "--csv or --json" in refused("patches", "--csv", "--json")


def test_readings_of_another_measurement_are_not_gone_on_with(refused, readings, tmp_path):
    words = ("--photometer", "simulated", "--windowless", "--screen", "A", "--out", tmp_path / "y.json")
    before = readings.read_bytes()
    assert "readings of another measurement" in refused("measure", *words, "--readings", readings, "--levels", "9")
    assert readings.read_bytes() == before


class Faltering:
    """A photometer whose user stops after some patches."""

    name = "by hand"

    def __init__(self, n):
        self.inner, self.left = SimulatedPhotometer(SimulatedScreen()), n

    def read(self, patch, *, minutes):
        self.left -= 1
        return self.inner.read(patch, minutes=minutes) if self.left >= 0 else None


def test_a_measurement_that_was_stopped_goes_on(tmp_path):
    patches, shown, path = standard_patches(warm_up_min=10), [], tmp_path / "r.csv"

    def run(n):
        return measure(
            patches, show=shown.append, photometer=Faltering(n), pace=simulated_pace(), path=path, settle_s=1.0
        )

    assert run(2) is None  # in the middle of the warm-up
    assert len(read_readings(path).items) == 2
    assert run(20) is None
    done = run(1000)
    assert [reading.patch.codes for reading in done.items] == [patch.codes for patch in patches]
    assert [reading.patch.purpose for reading in done.items] == [patch.purpose for patch in patches]
    # Each stop showed one patch that was not read; it is shown again.
    assert len(shown) == len(patches) + 2
    # A second after each patch appeared; the second run waited for the third one's time, 10 minutes.
    assert [reading.minutes for reading in done.items[:3]] == pytest.approx([0.02, 5.03, 10.02], abs=0.011)
    assert all(a.minutes <= b.minutes for a, b in zip(done.items, done.items[1:], strict=False)), "one clock for all"
    assert run(0).items == done.items, "nothing is left to do"


def test_a_reading_is_on_the_disk_before_the_next_patch_is_shown(tmp_path):
    patches, path = standard_patches(), tmp_path / "r.csv"

    def show(patch):
        there = len(read_readings(path).items) if path.exists() else 0
        assert there == patches.index(patch)
        if there == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        measure(patches, show=show, photometer=Faltering(99), pace=simulated_pace(), path=path)
    assert len(read_readings(path).items) == 3
    assert [one.name for one in tmp_path.iterdir()] == ["r.csv"]


def test_a_simulated_photometer_that_cannot_be():
    with pytest.raises(GlossError, match="noise of a simulated photometer is nan"):
        SimulatedPhotometer(SimulatedScreen(), noise=float("nan"))
    with pytest.raises(GlossError, match="simulated screen of 5 to 2 cd/m2"):
        SimulatedScreen(black_cd_m2=5, white_cd_m2=2)


def test_through_the_real_window(tmp_path):
    """The whole command on a virtual display: every patch is shown, read by the simulated photometer, and fitted."""
    found = run_program("command", tmp_path / "w.json", home=tmp_path)
    assert (found["simulated"], found["screen"]["size_px"]) == (True, [1280, 1024])
    assert found["screen"]["refresh_hz"] is None, "a virtual display has none"
    assert len(found["readings"]) == len(standard_patches())
