"""`gloss glossmeter` and `gloss gonio`, as a person types them."""

import json

import pandas as pd
import pytest

from glossspace.instruments.glossmeter import gloss_units
from glossspace.reflectance import Lambert, Ward


@pytest.fixture
def result(gloss):
    def run(*words):
        code, out, err = gloss(*words, "--json")
        assert code == 0, err
        return json.loads(out, parse_constant=pytest.fail)

    return run


def said(text: str) -> list[str]:
    return text.split()


class TestGlossmeter:
    def test_reads_a_lobe(self, result):
        document = result("glossmeter", "--brdf", "ward", "--rho-s", "1", "--alpha", ".11")
        assert document["gu60"] == float(gloss_units(Ward(1.0, 0.11), 60))
        assert {"gu20", "gu60", "gu85", "albedo20", "albedo60", "albedo85", "haze"} <= set(document)
        assert document["d"] == pytest.approx(0.89)
        assert document["within_paper_range"] is True
        assert 0 <= document["relative_error"] <= 1e-6  # what the quadrature aims at

    def test_a_roughness_beyond_the_papers_is_marked(self, result):
        assert result(*said("glossmeter --brdf ward --rho-s .1 --alpha .25"))["within_paper_range"] is False

    def test_a_reading_that_is_not_sure_says_so(self, gloss, monkeypatch):
        monkeypatch.setattr("glossspace.instruments.quadrature._MOST_NODES", 0)  # gives up at once
        code, _, err = gloss(*said("glossmeter --brdf ward --rho-s 1 --alpha .0001 --alpha-y .1"))
        assert code == 0
        assert "the quadrature knows these readings to ±4 % only" in err

    def test_a_diffuse_part_is_read_too(self, result):
        document = result("glossmeter", "--brdf", "ward", "--rho-s", ".1", "--alpha", ".11", "--rho-d", ".5")
        assert document["gu60"] == float(gloss_units(Ward(0.1, 0.11) + Lambert(0.5), 60))

    def test_the_papers_reading(self, result):
        words = said("glossmeter --brdf cook-torrance --scale 21.5 --slope .6 --n 1.32 --k 0 --reading table2")
        document = result(*words)
        # the glossmeter paper's table 2; m = .600 leaves 2 % at 60 degrees
        assert [document[f"gu{angle}"] for angle in (20, 60, 85)] == pytest.approx([0.2, 10.5, 49.5], abs=0.09)
        assert document["conserves_energy"] is False

    def test_what_breaks_energy_is_remarked(self, gloss):
        code, out, err = gloss(*said("glossmeter --brdf cook-torrance --scale 21.5 --slope .6 --n 1.32"))
        assert code == 0
        assert "conserves_energy" in out
        assert "reflects more than it receives" in err

    @pytest.mark.parametrize(
        ("words", "message"),
        [
            ("", "--brdf"),
            ("--brdf paint", "Invalid --brdf 'paint'. Allowed: lambert, ward"),
            ("--brdf ward --rho-s 1", "--brdf ward needs --alpha. Its options are"),
            ("--brdf ward --rho-s 1 --alpha .1 --n 1.5", "--brdf ward has no --n."),
            ("--brdf ward --rho-s 1 --alpha nan", "Must be a finite number"),
            ("--brdf ggx --alpha .1 --k 2", "--brdf ggx needs --n beside --k"),
            ("--brdf ward --rho-s 2 --alpha .1", "Invalid rho_s = 2.0"),
            ("--brdf lambert --rho-d .5 --reading iso", "Invalid --reading 'iso'. Allowed: physical, table2"),
        ],
    )
    def test_mistakes(self, gloss, words, message):
        code, out, err = gloss("glossmeter", *words.split())
        assert (code, out) == (2, "")
        assert message in err


class TestInvert:
    def test_there_and_back(self, result):
        found = result(*said("glossmeter invert --gu60 10 --rho-s .05"))
        assert found["exact"] is True
        back = result("glossmeter", "--brdf", "ward", "--rho-s", ".05", "--alpha", repr(found["alpha"]))
        assert back["gu60"] == pytest.approx(10, abs=1e-4)
        assert found["d"] == pytest.approx(1 - found["alpha"])
        assert len(found["alike"]) > 20

    def test_two_readings_answer_which_c_and_d(self, gloss):
        code, out, err = gloss(*said("glossmeter invert --gu20 5 --gu60 12 --rho-d .193"))
        assert (code, err) == (0, "")
        assert all(word in out for word in ("rho_s", "alpha", "lightness", "c_low", "Read alike within 0.5"))

    def test_one_reading_alone_shows_what_reads_alike(self, gloss):
        code, out, err = gloss(*said("glossmeter invert --gu60 12 --brdf beckmann"))
        assert code == 0
        assert "does not tell both scale and slope" in err
        assert "scale_low" in out

    def test_readings_that_no_lobe_gives_are_remarked(self, gloss):
        code, _, err = gloss(*said("glossmeter invert --gu20 59.4 --gu60 73.7 --gu85 96.9"))
        assert code == 0
        assert "no ward lobe gives these readings together" in err

    @pytest.mark.parametrize(
        ("words", "message"),
        [
            ("", "Give one to three readings"),
            ("--gu60 60 --rho-s .1", "out of reach of the family ward with rho_s = 0.1: its ceiling is 50."),
            ("--gu60 -1 --rho-s .1", "Invalid reading -1.0"),
            ("--gu60 10 --scale 1", "--brdf ward has no --scale: it has rho_s and alpha."),
            ("--gu60 10 --brdf phong", "Unknown family 'phong'"),
            ("--gu60 10 --tolerance 0", "Invalid tolerance_gu = 0.0"),
        ],
    )
    def test_mistakes(self, gloss, words, message):
        code, out, err = gloss("glossmeter", "invert", *words.split())
        assert (code, out) == (2, "")
        assert message in err


class TestGonio:
    LOBE = ("--brdf", "ward", "--rho-s", ".1", "--alpha", ".05")

    def test_scan_into_files(self, gloss, tmp_path):
        table, figure = tmp_path / "scan.csv", tmp_path / "scan.png"
        words = (*self.LOBE, "--incident", "45", "--step", "5", "--out", str(table), "--figure", str(figure))
        code, out, _ = gloss("gonio", "scan", *words)
        assert (code, out) == (0, "")
        scan = pd.read_csv(table)
        assert scan["detector_deg"][scan["brdf"].idxmax()] == 45
        assert len(scan) == 35
        assert figure.stat().st_size > 1000

    def test_out_of_plane(self, result):
        words = ("--incident", "45", "--detector", "45", "--start", "0", "--stop", "20", "--step", "10")
        points = result("gonio", "scan", *self.LOBE, *words)["points"]
        assert [point["azimuth_deg"] for point in points] == [0, 10, 20]

    def test_values_that_are_not_sure_are_remarked_once(self, gloss, monkeypatch):
        monkeypatch.setattr("glossspace.instruments.quadrature._MOST_NODES", 0)  # gives up at once
        lobe = "--brdf ward --rho-s .5 --alpha .0001 --alpha-y .1 --incident 60 --source-width 2 --detector-width 2"
        code, _, err = gloss(*said(f"gonio scan {lobe} --start 59 --stop 61 --step 1"))
        assert code == 0
        assert err.count("the quadrature knows some of these values to ±") == 1
        code, _, err = gloss(*said(f"gonio spectrum {lobe} --first 500 --last 510"))
        assert code == 0
        assert err.count("the quadrature knows some of these values to ±") == 1

    def test_spectrum_of_a_brushed_lobe(self, result):
        words = said("gonio spectrum --brdf ward --rho-s .1 --alpha .1 --normalisation duer2006 --first 500 --last 510")
        across = result(*words, "--alpha-y", ".05")["points"][0]["reflectance_factor"]
        # in the mirror direction Dür's lobe is rho_s / (4π αx αy cosθi cosθr): twice as high at half the roughness
        assert across / result(*words)["points"][0]["reflectance_factor"] == pytest.approx(2)

    def test_spectrum_of_copper(self, gloss, tmp_path):
        table, figure = tmp_path / "copper.csv", tmp_path / "copper.svg"
        words = said("gonio spectrum --brdf cook-torrance --scale 5.3 --slope .84 --index copper_hagemann_1974")
        code, out, err = gloss(*words, "--out", str(table), "--figure", str(figure), "--json")
        assert code == 0, err
        document = json.loads(out)
        assert document["lab"][1] > 10  # red
        assert len(pd.read_csv(table)) == len(document["points"]) == 81
        assert figure.stat().st_size > 1000

    def test_gray_has_the_illuminants_colour(self, result):
        document = result(*said("gonio spectrum --brdf lambert --rho-d .4 --incident 45 --detector 0 --illuminant A"))
        assert document["xyz"][1] == pytest.approx(40)
        assert document["lab"][1:] == pytest.approx([0, 0], abs=1e-9)

    @pytest.mark.parametrize(
        ("words", "message"),
        [
            ("scan --brdf lambert --rho-d .5 --incident 45 --step 0", "--step above 0"),
            ("scan --brdf lambert --rho-d .5 --incident 45 --start 5 --stop 1", "--start up to --stop"),
            ("scan --brdf lambert --rho-d .5 --incident 95", "Invalid theta_deg = 95.0"),
            ("scan --brdf lambert --rho-d .5 --incident 45 --figure a.txt", "Invalid figure 'a.txt'"),
            ("spectrum --brdf lambert --rho-d .5 --illuminant Q", "Unknown illuminant 'Q'"),
            ("spectrum --brdf lambert --rho-d .5 --index copper_hagemann_1974", "--brdf lambert has no --index"),
            ("spectrum --brdf beckmann --slope .1 --n 1 --index copper_hagemann_1974", "either --index or --n and --k"),
            (
                "spectrum --brdf beckmann --slope .1 --index copper_johnson_christy_1972 --first 100",
                "at 100 nm: the table covers 187.9 to 1937 nm",
            ),
            ("spectrum --brdf lambert --rho-d .5 --first 500 --last 400", "--first below --last"),
        ],
    )
    def test_mistakes(self, gloss, words, message):
        code, out, err = gloss("gonio", *words.split())
        assert (code, out) == (2, "")
        assert message in err


class TestWhatIsLeftOpen:
    @pytest.mark.parametrize(
        ("words", "message"),
        [
            ("--gu60 10 --n 3", "--brdf ward has no --n"),
            ("--gu60 10 --k 1", "--brdf ward has no --k"),
            ("--gu60 10 --gu20 1 --rho-d 1", "leaves no rho_s for a lobe"),
            ("--gu20 0 --gu60 0 --gu85 0", "no higher than those of the diffuse part"),
            ("--gu20 1 --gu60 2 --brdf beckmann --n 1", "n = 1 and k = 0 reflect nothing"),
        ],
    )
    def test_inversion_without_an_answer_is_refused(self, gloss, words, message):
        code, out, err = gloss("glossmeter", "invert", *said(words), "--json")
        assert (code, out, len(err.splitlines())) == (2, "", 1)
        assert message in err

    def test_a_reading_of_no_lobe_is_remarked(self, gloss):
        code, out, err = gloss(*said("glossmeter invert --gu60 1e9 --json"))
        assert (code, json.loads(out)["alike"]) == (0, [])
        assert "no ward lobe of the table reads so" in err

    def test_one_file_for_table_and_figure_is_refused(self, gloss, tmp_path):
        both = str(tmp_path / "scan.png")
        words = said("gonio scan --brdf lambert --rho-d .5 --incident 45")
        code, _, err = gloss(*words, "--out", both, "--figure", both)
        assert code == 2
        assert "one would replace the other" in err
        assert not list(tmp_path.iterdir())
