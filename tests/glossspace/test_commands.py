"""`gloss convert`, `distance`, `match` and `isogloss`, as a person types them."""

import json

import numpy as np
import pytest

from glossspace.metric import ContrastForm, GlossSpace

GRAY = ".193,.066,.07"


@pytest.fixture
def result(gloss):
    """Run the command with --json: give the document, which must be all of stdout."""

    def run(*words):
        code, out, err = gloss(*words, "--json")
        assert code == 0, err
        return json.loads(out, parse_constant=pytest.fail)

    return run


@pytest.fixture
def space_file(tmp_path):
    GlossSpace(weight_c=2.0, weight_d=3.0, name="[/] :a: ρ").save(tmp_path / "gloss-space.json")
    return str(tmp_path / "gloss-space.json")


class TestConvert:
    PHYSICAL = ("convert", "--rho-d", ".193", "--rho-s", ".066", "--alpha", ".07")

    def test_physical_to_perceptual(self, result):
        document = result(*self.PHYSICAL)
        assert {key: document[key] for key in ("rho_d", "rho_s", "alpha")} == {
            "rho_d": 0.193, "rho_s": 0.066, "alpha": 0.07,
        }  # fmt: skip
        # figure 11 of the paper, with one more decimal: science of eqs 3 and 4, and CIELAB
        assert document["c"] == pytest.approx(0.08702, abs=5e-6)
        assert document["d"] == pytest.approx(0.93, abs=1e-15)
        assert document["lightness"] == pytest.approx(51.04, abs=5e-3)
        assert document["within_paper_range"] is True
        assert document["c"] < document["max_c"] < 1

    def test_perceptual_to_physical(self, result):
        document = result("convert", "--lightness", "51.036", "--c", ".08702", "--d", ".93")
        assert [document[k] for k in ("rho_d", "rho_s", "alpha")] == pytest.approx([0.193, 0.066, 0.07], abs=1e-5)

    def test_there_and_back(self, result):
        there = result(*self.PHYSICAL)
        back = result("convert", *(w for k in ("lightness", "c", "d") for w in (f"--{k}", repr(there[k]))))
        assert [back[k] for k in ("rho_d", "rho_s", "alpha")] == pytest.approx([0.193, 0.066, 0.07], rel=1e-12)

    def test_table_names_every_quantity(self, gloss):
        code, out, err = gloss(*self.PHYSICAL)
        assert code == 0
        assert err == ""
        assert f"{np.cbrt(0.066 + 0.0965) - np.cbrt(0.0965):.6g}" in out  # eq. 4
        assert all(name in out for name in ("rho_d", "rho_s", "alpha", "lightness", "max_c", "within_paper_range"))

    def test_rough_paints_are_computed_and_flagged(self, gloss):
        code, out, err = gloss("convert", "--rho-d", "0", "--rho-s", "1", "--alpha", ".5", "--json")
        assert code == 0
        assert json.loads(out)["within_paper_range"] is False
        assert json.loads(out)["c"] == 1
        assert err.startswith("Note: alpha = 0.5 is outside the range")

    @pytest.mark.parametrize(
        ("words", "message"),
        [
            (
                [],
                "Give either --rho-d, --rho-s, --alpha or --lightness, --c, --d, all three and nothing else; got none",
            ),
            (["--rho-d", ".1", "--c", ".1"], "got --rho-d, --c."),
            (["--rho-d", ".1", "--rho-s", ".1", "--alpha", ".1", "--d", ".9"], "all three and nothing else"),
            (["--rho-d", "nan", "--rho-s", ".1", "--alpha", ".1"], "Must be a finite number."),
            (["--rho-d", "inf", "--rho-s", ".1", "--alpha", ".1"], "Must be a finite number."),
            (["--rho-d", "0,1", "--rho-s", ".1", "--alpha", ".1"], '"0,1"'),
            (["--rho-d", "−.1", "--rho-s", ".1", "--alpha", ".1"], '"−.1"'),  # a minus sign as word processors set it
            (["--rho-d", "-.1", "--rho-s", ".1", "--alpha", ".1"], "Invalid rho_d = -0.1."),
            (["--rho-d", ".9", "--rho-s", ".2", "--alpha", ".1"], "Invalid rho_d + rho_s = 1.1"),
            (["--rho-d", ".9", "--rho-s", ".1", "--alpha", "0"], "Invalid alpha = 0.0."),
            (["--lightness", "101", "--c", ".1", "--d", ".9"], "Invalid lightness = 101.0."),
            (["--lightness", "90", "--c", ".5", "--d", ".9"], "c = 0.5 is out of reach"),
            (["--lightness", "90", "--c", "1e200", "--d", ".9"], "c = 1e+200 is out of reach"),
            (["--lightness", "50", "--c", ".1", "--d", "1"], "Invalid d = 1.0."),
        ],
    )
    def test_mistakes(self, gloss, words, message):
        code, out, err = gloss("convert", *words)
        assert (code, out) == (2, "")
        assert message in err
        assert err.count("\n") == 1


class TestDistance:
    def test_eq_5(self, result):
        document = result("distance", GRAY, ".193,.066,.04")
        assert document["distance"] == pytest.approx(1.78 * 0.03, rel=1e-13)
        assert document["delta_c"] == 0
        assert document["delta_d"] == pytest.approx(0.03, rel=1e-13)
        assert document["weight_d"] == 1.78

    def test_a_fitted_space(self, gloss, result, space_file):
        document = result("distance", "0,.125,.1", "0,.008,.5", "--space", space_file)
        assert document["distance"] == pytest.approx(np.hypot(2 * 0.3, 3 * 0.4), rel=1e-14)
        assert document["space"] == "[/] :a: ρ"
        assert "[/] :a: ρ" in gloss("distance", GRAY, GRAY, "--space", space_file)[1]  # no markup, no emoji

    @pytest.mark.parametrize(
        ("paint", "message"),
        [
            ("", "Invalid paint ''"),
            (".1,.1", "Invalid paint '.1,.1'. Allowed: three numbers rho_d,rho_s,alpha"),
            (".1;.1;.1", "Invalid paint"),
            (".1,.1,.1,.1", "Invalid paint"),
            ("0,1,0,1,0,1", "Invalid paint"),  # decimal commas
            (".1,.1,x", "Invalid paint"),
            (".1,nan,.1", "Invalid paint"),
            (".1,.1,inf", "Invalid paint"),
            (".1,−.1,.1", "Invalid paint"),
            (".1,.95,.1", "Invalid rho_d + rho_s = "),
            ("-.1,.1,.1", "-.1,.1,.1"),
        ],
    )
    def test_mistakes(self, gloss, paint, message):
        code, out, err = gloss("distance", GRAY, paint)
        assert (code, out) == (2, "")
        assert message in err
        assert err.count("\n") == 1

    def test_spaces_after_commas_are_fine(self, result):
        assert result("distance", " .193, .066, .07", GRAY)["distance"] == 0

    @pytest.mark.parametrize("name", [".", "none.json", "text.json"])
    def test_a_space_that_is_none(self, gloss, tmp_path, name):
        (tmp_path / "text.json").write_text("no JSON")
        code, out, err = gloss("distance", GRAY, GRAY, "--space", str(tmp_path / name))
        assert (code, out) == (2, "")
        assert "gloss space" in err
        assert err.count("\n") == 1

    def test_both_paints_are_flagged(self, gloss):
        assert gloss("distance", "0,0,.3", "0,0,.4")[2].count("Note: alpha") == 2


class TestMatch:
    @pytest.mark.parametrize("target", [["--rho-d", ".03"], ["--lightness", "20.0447"]])
    def test_figure_12(self, result, target):
        """The black sphere with the c = .0578, d = .96 of the white one: eq. 7 by hand."""
        document = result("match", ".767,.099,.04", *target)
        by_hand = (0.0578 + np.cbrt(0.015)) ** 3 - 0.015
        assert document["rho_s"] == pytest.approx(by_hand, abs=2e-5)  # c is given to four decimals
        assert document["c"] == pytest.approx(0.0578, abs=5e-5)
        assert document["d"] == pytest.approx(0.96, abs=1e-15)
        assert document["alpha"] == 0.04

    @pytest.mark.parametrize(
        ("words", "message"),
        [
            ([".767,.099,.04"], "Give one of --rho-d and --lightness"),
            ([".767,.099,.04", "--rho-d", ".1", "--lightness", "10"], "Give one of --rho-d and --lightness"),
            (
                [".03,.099,.04", "--rho-d", ".9"],
                "c = 0.2382595512 is out of reach for rho_d = 0.9, which allows at most",
            ),
            ([".03,.099,.04", "--rho-d", "nan"], "Must be a finite number."),
            ([".03,.099,.04", "--lightness", "-5"], "Invalid lightness = -5.0."),
        ],
    )
    def test_mistakes(self, gloss, words, message):
        code, out, err = gloss("match", *words)
        assert (code, out) == (2, "")
        assert message in err
        assert err.count("\n") == 1


class TestIsogloss:
    def test_figure_11(self, result):
        document = result("isogloss", GRAY, "--n", "4")
        assert document["radius"] == 0.04
        assert document["rho_d"] == 0.193
        assert [point["angle_deg"] for point in document["points"]] == [0, 90, 180, 270]
        assert [point["d"] for point in document["points"]] == pytest.approx([0.93, 0.9525, 0.93, 0.9075], abs=5e-5)

    def test_points_without_paint_are_null(self, result):
        first, second, *_ = result("isogloss", GRAY, "--n", "4", "--radius", ".2")["points"]
        assert first["reachable"] is True
        assert second["reachable"] is False
        assert second["rho_s"] is None
        assert second["alpha"] is None

    def test_a_fitted_space_and_another_lightness(self, result, space_file):
        document = result("isogloss", GRAY, "--n", "4", "--space", space_file, "--rho-d", "0")
        assert document["rho_d"] == 0
        assert document["points"][1]["d"] == pytest.approx(0.93 + 0.04 / 3, rel=1e-14)

    def test_table(self, gloss):
        code, out, err = gloss("isogloss", GRAY, "--n", "4", "--radius", ".2")
        assert (code, err) == (0, "")
        assert "Gloss distance 0.2 from" in out
        assert "–" in out
        assert out.count(" no ") >= 2

    def test_a_table_that_takes_long_is_announced(self, gloss):
        code, out, err = gloss("isogloss", GRAY, "--n", "5001")
        assert (code, out.count("\n")) == (0, 5001 + 5)
        assert err == "Setting a table of 5,001 lines, which takes a while; --json does not.\n"

    @pytest.mark.parametrize(("suffix", "magic"), [(".png", b"\x89PNG"), (".PDF", b"%PDF"), (".svg", b"<?xml")])
    def test_figure(self, gloss, tmp_path, suffix, magic):
        figure = tmp_path / "new" / f"contour{suffix}"
        code, out, err = gloss("isogloss", GRAY, "--radius", ".2", "--figure", str(figure), "--json")
        assert code == 0
        assert json.loads(out)
        assert err == f"Figure: {figure}\n"
        assert figure.read_bytes().startswith(magic)
        assert [file.name for file in figure.parent.iterdir()] == [figure.name]

    @pytest.mark.parametrize("name", ["contour.xyz", "contour", "."])
    def test_unknown_kind_of_figure(self, gloss, tmp_path, name):
        code, out, err = gloss("isogloss", GRAY, "--figure", str(tmp_path / name))
        assert (code, out) == (2, "")
        assert "Allowed: a file name that ends in .png, .svg, .pdf." in err

    def test_a_place_that_cannot_be_written(self, gloss, tmp_path):
        (tmp_path / "file").write_text("")
        code, out, err = gloss("isogloss", GRAY, "--figure", str(tmp_path / "file" / "a.svg"))
        assert (code, out) == (2, "")
        assert err.startswith("gloss: Cannot write '")
        assert err.count("\n") == 1

    @pytest.mark.parametrize(
        ("words", "message"),
        [
            (["--n", "2"], "Invalid n = 2."),
            (["--n", "36.9"], "'36.9' is not a whole number."),
            (["--n", "1000000000000"], "Invalid n = 1000000000000."),
            (["--radius", "0"], "Invalid radius = 0.0."),
            (["--radius", "nan"], "Must be a finite number."),
            (["--rho-d", "nan"], "Must be a finite number."),
            (["--rho-d", "2"], "Invalid rho_d = 2.0."),
        ],
    )
    def test_mistakes(self, gloss, words, message):
        code, out, err = gloss("isogloss", GRAY, *words)
        assert (code, out) == (2, "")
        assert message in err
        assert err.count("\n") == 1


class TestAxisFunctionsOfOtherForm:
    """A space whose c is a difference of square roots, (rho_s + .4 rho_d)^.5 - (.4 rho_d)^.5."""

    @pytest.fixture
    def other(self, tmp_path):
        GlossSpace(weight_d=0.9, contrast_form=ContrastForm(0.5, 0.4)).save(tmp_path / "other.json")
        return str(tmp_path / "other.json")

    def test_convert_there_and_back(self, result, other):
        there = result(*TestConvert.PHYSICAL, "--space", other)
        assert there["c"] == pytest.approx(np.sqrt(0.066 + 0.4 * 0.193) - np.sqrt(0.4 * 0.193), rel=1e-12)
        assert there["max_c"] == pytest.approx(np.sqrt(1 - 0.6 * 0.193) - np.sqrt(0.4 * 0.193), rel=1e-12)
        words = [word for key in ("lightness", "c", "d") for word in (f"--{key}", repr(there[key]))]
        back = result("convert", *words, "--space", other)
        assert [back[key] for key in ("rho_d", "rho_s", "alpha")] == pytest.approx([0.193, 0.066, 0.07], rel=1e-10)

    def test_match_keeps_c(self, result, other):
        matched = result("match", ".767,.099,.04", "--rho-d", ".03", "--space", other)
        c = np.sqrt(0.099 + 0.4 * 0.767) - np.sqrt(0.4 * 0.767)
        assert matched["rho_s"] == pytest.approx((c + np.sqrt(0.012)) ** 2 - 0.012, rel=1e-10)

    def test_isogloss_goes_round_it(self, result, other):
        points = result("isogloss", GRAY, "--space", other, "--n", "4")["points"]
        c = np.sqrt(0.066 + 0.4 * 0.193) - np.sqrt(0.4 * 0.193)
        assert [point["c"] for point in points] == pytest.approx([c + 0.04, c, c - 0.04, c], rel=1e-12)
