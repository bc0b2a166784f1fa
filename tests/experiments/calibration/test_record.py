"""A calibration on the disk, its export into a scene, and its picture."""

import json
import re
from datetime import UTC, datetime, timedelta, timezone

import pytest

from gloss_experiments.calibration import (
    ScreenIdentity,
    SimulatedScreen,
    calibrate,
    connected_edid_sha256,
    draw_calibration,
    luminance_csv,
    read_calibration,
    save_calibration,
    save_figure,
    scene_section,
    standard_patches,
    write_luminance,
)
from gloss_stimuli.scene import read_scene
from glossspace.display import DisplayModel
from glossspace.errors import GlossError
from glossspace.files import shipped_folder
from glossspace.luminance_table import LuminanceTable
from glossspace.user_table import read_user_table
from tests.experiments.calibration.screens import PAPER, SKEWED, changed, gray_only, readings_of

DAY = datetime(2026, 3, 31, 9, 30, tzinfo=UTC)
SCREEN = ScreenIdentity(
    name="EIZO no. 7", size_px=(1920, 1200), refresh_hz=59.95, pixel_pitch_mm=0.27, edid_sha256=("ab" * 32,)
)


def calibration(screen=PAPER, *, identity=SCREEN, patches=None, **options):
    return calibrate(readings_of(screen, patches=patches, **options), screen=identity, measured_at=DAY)


class TestFile:
    def test_what_a_session_needs_comes_back(self, tmp_path):
        found = calibration(photometer="LS-110 no. 3", noise=0.003)
        save_calibration(found, tmp_path / "a.json")
        stored = read_calibration(tmp_path / "a.json")
        assert (stored.screen, stored.measured_at, stored.display) == (SCREEN, DAY, found.display)
        assert (stored.photometer, stored.simulated) == ("LS-110 no. 3", False)
        best = found.verification
        assert best.rms_delta_l < found.models[-1][1].rms_delta_l
        assert (stored.n_verified, stored.rms_delta_l, stored.largest_delta_l) == (
            *(len(best.codes), best.rms_delta_l, best.largest_delta_l),
        )

    def test_what_does_not_say_that_a_screen_was_measured_is_simulated(self, tmp_path):
        document = calibration(photometer="LS-110").to_dict() | {"simulated": None}
        (tmp_path / "a.json").write_text(json.dumps(document), encoding="utf-8")
        assert read_calibration(tmp_path / "a.json").simulated

    def test_everything_is_in_it(self, tmp_path):
        screen = SimulatedScreen(veiling=0.001, warm_up_share=0.05, ambient_cd_m2=0.1)
        found = calibration(screen, patches=standard_patches(warm_up_min=60))
        save_calibration(found, tmp_path / "a.json")
        document = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"), parse_constant=pytest.fail)
        assert document["format"] == "glossspace/screen-calibration"
        assert document["version"] == 1
        assert document["simulated"] is True
        assert len(document["readings"]) == len(found.readings.items)
        assert [one["model"] for one in document["verification"]] == [model.name for model, _ in found.models]
        assert document["stray_light"]["ambient_cd_m2"] == pytest.approx(0.1)
        assert document["warm_up"]["stable_after_min"] == found.warm_up.stable_after_min
        assert document["gain_offset_gamma"]["gain-offset-gamma of gray"]["curves"]["gray"]["gamma"]
        assert "smallest residual on 8 verification patches" in document["reason"]

    def test_an_interval_that_is_not_determined_is_null(self, tmp_path):
        """Four levels above black and one reading of it: no spare reading beside the four parameters but one."""
        kept = [one for one in gray_only() if one.purpose != "fit" or one.red in (0, 64, 128, 191, 255)]
        found = calibration(SimulatedScreen(offset=(0.1,) * 3), patches=kept)
        save_calibration(found, tmp_path / "a.json")
        json.loads((tmp_path / "a.json").read_text(encoding="utf-8"), parse_constant=pytest.fail)

    @pytest.mark.parametrize(
        ("change", "message"),
        [
            ({"format": "glossspace/stimulus-set"}, "is no screen calibration"),
            ({"version": 2}, "is of version 2, but this program reads 1"),
            ({"display": {"black_cd_m2": 1}}, "is damaged: 'white_cd_m2' is missing"),
            ({"display": None}, "is damaged"),
            ({"measured_at": "yesterday"}, "is damaged"),
            ({"screen": {"name": " "}}, "is damaged: The screen needs a name"),
        ],
    )
    def test_damage_is_told(self, tmp_path, change, message):
        document = calibration().to_dict() | change
        (tmp_path / "a.json").write_text(json.dumps(document), encoding="utf-8")
        with pytest.raises(GlossError, match=message):
            read_calibration(tmp_path / "a.json")

    def test_other_files(self, tmp_path):
        with pytest.raises(GlossError, match="No screen calibration at"):
            read_calibration(tmp_path / "no.json")
        (tmp_path / "a.json").write_text("{", encoding="utf-8")
        with pytest.raises(GlossError, match="not valid JSON"):
            read_calibration(tmp_path / "a.json")

    def test_a_time_of_another_zone(self, tmp_path):
        east = datetime(2026, 3, 31, 11, 30, tzinfo=timezone(timedelta(hours=2)))
        save_calibration(calibrate(readings_of(), screen=SCREEN, measured_at=east), tmp_path / "a.json")
        assert read_calibration(tmp_path / "a.json").measured_at == DAY


class TestExport:
    @pytest.mark.parametrize("screen", [PAPER, SKEWED, SimulatedScreen(offset=(-0.1,) * 3)])
    def test_a_scene_takes_the_section(self, tmp_path, screen):
        found = calibration(screen, noise=0.002)
        shipped = (shipped_folder_of_scenes() / "checkerboard_box.toml").read_text(encoding="utf-8")
        scene, n = re.subn(r"^\[display\].*?(?=^\[)", lambda _: scene_section(found) + "\n", shipped, flags=re.M | re.S)
        assert n == 1
        (tmp_path / "scene.toml").write_text(scene, encoding="utf-8")
        assert read_scene(tmp_path / "scene.toml").display.model() == found.display

    def test_the_csv_holds_the_columns_of_the_table(self, tmp_path):
        found = calibration(noise=0.002)
        write_luminance(found, tmp_path / "luminance.csv")
        rows = read_user_table(tmp_path / "luminance.csv", what="luminance table", columns=["codes"])
        columns = {name: tuple(map(int if name == "codes" else float, rows[name])) for name in rows}
        assert LuminanceTable(**columns) == found.model.table

    def test_of_an_interpolation_the_rows_are_the_readings(self):
        def bent(patch, luminance):
            return luminance + 3 * (patch.red > 120) * (patch.red - 120) / 135

        found = calibrate(changed(readings_of(patches=gray_only()), bent), screen=SCREEN)
        assert found.model.name == "interpolation of gray"
        rows = luminance_csv(found).splitlines()
        assert rows[0] == "codes,gray_cd_m2"
        assert len(rows) == 1 + 17
        assert [float(cell) for cell in rows[-1].split(",")] == pytest.approx([255, 108 + 3], rel=1e-15)

    def test_the_papers_screen_gives_the_papers_codes(self):
        """Encoded for the measured screen, an image holds the code values that it holds for the ideal one."""
        luminance = DisplayModel().luminance(range(256))
        assert calibration().display.codes(luminance).tolist() == list(range(256))

    def test_simulated_is_said(self):
        assert "SIMULATED" in scene_section(calibration())
        assert "SIMULATED" not in scene_section(calibration(photometer="LS-110"))

    def test_no_other_format(self, tmp_path):
        with pytest.raises(GlossError, match="ends in .csv or .toml"):
            write_luminance(calibration(), tmp_path / "a.txt")


def shipped_folder_of_scenes():
    import gloss_stimuli.scene

    return shipped_folder(gloss_stimuli.scene.__file__, "scenes")


class TestRemarks:
    def test_a_good_screen_has_none(self):
        assert calibration(photometer="LS-110").remarks() == ()

    @pytest.mark.parametrize(
        ("screen", "message"),
        [
            (SimulatedScreen(black_cd_m2=0.0), "reads 0 at black"),
            (SimulatedScreen(interaction=-0.05), r"add up to \+5.2 % of gray at code 255"),
            (SimulatedScreen(left=1.05, right=0.95), "image positions differ by ΔL\\* -3.9 at code 255"),
            (SimulatedScreen(warm_up_share=0.5, warm_up_time_min=60), "not warm after 20 minutes"),
        ],
    )
    def test_a_fault_is_told(self, screen, message):
        found = calibration(screen, patches=standard_patches(warm_up_min=20), photometer="LS-110").remarks()
        assert any(re.search(message, remark) for remark in found), found

    def test_simulated_readings_are_called_so(self):
        assert "These readings are simulated" in calibration().remarks()[0]


class TestPicture:
    @pytest.mark.parametrize(("suffix", "begin"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")])
    def test_files(self, tmp_path, suffix, begin):
        save_figure(calibration(), tmp_path / f"a.{suffix}")
        assert (tmp_path / f"a.{suffix}").read_bytes().startswith(begin)

    def test_what_it_shows(self):
        identity = ScreenIdentity(name="A $1 screen\nwith two lines")
        found = calibration(SKEWED, identity=identity, noise=0.003)
        upper, lower = draw_calibration(found).axes
        assert "SIMULATED readings of A" in upper.get_title(loc="left")
        points = lower.lines[-1].get_xydata()
        assert points[:, 0].tolist() == [max(codes) for codes in found.verification.codes]
        assert points[:, 1] == pytest.approx(found.verification.delta_l)

    def test_no_other_format(self, tmp_path):
        with pytest.raises(GlossError, match="ends in .png, .svg, .pdf"):
            save_figure(calibration(), tmp_path / "a.gif")


class TestIdentity:
    @pytest.mark.parametrize(
        ("values", "message"),
        [
            ({"name": " "}, "needs a name"),
            ({"name": "a", "refresh_hz": float("nan")}, "refresh rate of the screen is nan"),
            ({"name": "a", "pixel_pitch_mm": 0}, "pixel pitch of the screen is 0"),
            ({"name": "a", "size_px": (0, 5)}, "size of the screen is"),
        ],
    )
    def test_what_cannot_be(self, values, message):
        with pytest.raises(GlossError, match=message):
            ScreenIdentity(**values)

    def test_edids_of_connected_screens(self, tmp_path, monkeypatch):
        """SHA-256 of the three letters abc: FIPS 180-4, its first example."""
        monkeypatch.setattr("sys.platform", "linux")
        for name, content in (("card0-DP-1", b"abc"), ("card0-DP-2", b"")):
            (tmp_path / name).mkdir()
            (tmp_path / name / "edid").write_bytes(content)
        assert connected_edid_sha256(tmp_path) == ("ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad",)
        assert connected_edid_sha256(tmp_path / "none") == ()
        monkeypatch.setattr("sys.platform", "darwin")
        assert connected_edid_sha256(tmp_path) == ()
