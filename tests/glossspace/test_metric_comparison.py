"""Two gloss spaces side by side: closed forms, what is not known, and `gloss compare`."""

import json
import math

import numpy as np
import pytest

from glossspace.errors import GlossError
from glossspace.metric import PAPER_SPACE, AxisFunction, ContrastForm, GlossSpace, contrast_gloss
from glossspace.metric.comparison import compare_spaces

RANGES = {"rho_d": (0.0, 0.5), "rho_s": (0.02, 0.1), "alpha": (0.04, 0.1)}


def space(weight_d=1.78, half=None, **options):
    """Make a space whose weight has a 95 % interval of `half` either way on logs."""
    ci95 = None if half is None else (weight_d * math.exp(-half), weight_d * math.exp(half))
    return GlossSpace(weight_d=weight_d, weight_d_ci95=ci95, **{"stimulus_range": RANGES, "name": "one"} | options)


class TestWeight:
    def test_equal_spaces_do_not_differ(self):
        found = compare_spaces(space(half=0.1), space(half=0.1))
        assert found.weight.ratio == 1
        assert found.weight.differs is False
        assert found.distances.relative_difference == pytest.approx(0, abs=1e-12)
        assert found.distances.median_factor == pytest.approx(1, abs=1e-12)

    def test_interval_by_hand(self):
        """Half widths add as the legs of a right triangle: .3 and .4 give .5."""
        found = compare_spaces(space(1.0, 0.3), space(2.0, 0.4)).weight
        assert found.log_ratio == pytest.approx(math.log(2))
        assert found.ratio_ci95 == pytest.approx((2 * math.exp(-0.5), 2 * math.exp(0.5)))
        assert found.differs is True  # log 2 = .69 > .5

    def test_swapped(self):
        there, back = compare_spaces(space(1, 0.3), space(1.5, 0.4)), compare_spaces(space(1.5, 0.4), space(1, 0.3))
        assert there.weight.ratio * back.weight.ratio == pytest.approx(1)
        assert there.weight.differs is back.weight.differs is False  # log 1.5 = .41 < .5
        assert there.distances.ratio * back.distances.ratio == pytest.approx(1)

    def test_a_missing_interval_is_said(self):
        found = compare_spaces(space(2.0, 0.1), space(1.0))
        assert found.weight.ratio_ci95 == pytest.approx((0.5 * math.exp(-0.1), 0.5 * math.exp(0.1)))
        assert "The weight of d in b has no interval: it is taken as exact." in found.remarks

    def test_no_interval_at_all(self):
        found = compare_spaces(space(2.0), space(1.0)).weight
        assert (found.ratio, found.ratio_ci95, found.differs) == (0.5, None, None)

    def test_an_interval_that_reaches_0_has_no_logarithm(self):
        odd = GlossSpace(weight_d=1.0, weight_d_ci95=(0.0, 2.0), stimulus_range=RANGES)
        found = compare_spaces(odd, space(1.0, 0.1))
        assert any("0 to 2, does not lie above 0" in remark for remark in found.remarks)

    def test_only_the_ratio_of_weights_counts(self):
        found = compare_spaces(GlossSpace(weight_c=2, weight_d=4), GlossSpace(weight_c=1, weight_d=2))
        assert found.weight.ratio == 1
        assert found.distances.ratio == pytest.approx(1)

    def test_weights_of_any_size(self):
        found = compare_spaces(GlossSpace(weight_c=1e-300, weight_d=1e300), GlossSpace(weight_d=1e-300))
        assert found.weight.ratio == 0


class TestSlopes:
    def test_the_unit_of_the_ratings_drops_out(self):
        a = space(axis_functions={"d": AxisFunction(5.0, -1.0, 0.9, 11)})
        b = space(axis_functions={"d": AxisFunction(500.0, -100.0, 0.9, 11)})
        found = compare_spaces(a, b)
        assert found.slopes["d"].ratio == pytest.approx(1)
        assert found.slopes["d"].a == pytest.approx(5 / (5 * 0.93 - 1))  # alpha's middle is .07
        assert found.r_squared == {"d": (0.9, 0.9)}
        error = math.sqrt(0.1 / 0.9 / 9)  # of log slope, by the formula of simple regression
        assert math.log(found.slopes["d"].ratio_ci95[1]) == pytest.approx(1.96 * math.sqrt(2) * error, rel=1e-4)
        assert any(remark.startswith("No ratings along c in a and b") for remark in found.remarks)

    def test_the_error_of_a_slope_is_that_of_regression(self):
        from scipy.stats import linregress

        rng = np.random.default_rng(2)
        x = np.linspace(0.9, 0.96, 12)
        line = linregress(x, 3 * x + rng.normal(0, 0.02, 12))
        sure = AxisFunction(line.slope, line.intercept, 1.0, 12)
        fitted = AxisFunction(line.slope, line.intercept, line.rvalue**2, 12)
        found = compare_spaces(space(axis_functions={"d": sure}), space(axis_functions={"d": fitted})).slopes["d"]
        assert math.log(found.ratio_ci95[1]) == pytest.approx(1.96 * line.stderr / line.slope, rel=1e-4)

    def test_different_slopes_of_c(self):
        a = space(axis_functions={"c": AxisFunction(1.0, 0.0, 0.99, 24)})
        b = space(axis_functions={"c": AxisFunction(1.0, 1.0, 0.99, 24)})
        found = compare_spaces(a, b).slopes["c"]
        corners = [contrast_gloss(rho_d, rho_s) for rho_d in (0, 0.5) for rho_s in (0.02, 0.1)]
        middle = float(np.mean(corners))
        assert found.a == pytest.approx(1 / middle)
        assert found.b == pytest.approx(1 / (1 + middle))
        assert found.differs is True

    def test_falling_ratings_are_not_compared(self):
        a = space(axis_functions={"d": AxisFunction(-5.0, 9.0, 0.9, 11)})
        b = space(axis_functions={"d": AxisFunction(5.0, 0.0, 0.9, 11)})
        found = compare_spaces(a, b)
        assert math.isnan(found.slopes["d"].ratio)
        assert found.slopes["d"].differs is None
        assert any("slope -5" in remark for remark in found.remarks)


class TestRanges:
    def test_overlap(self):
        other = space(stimulus_range=RANGES | {"alpha": (0.07, 0.15)})
        alpha = compare_spaces(space(), other).ranges[2]
        assert alpha.common == (0.07, 0.1)
        assert alpha.share == pytest.approx(0.03 / 0.11)

    def test_nothing_in_common(self):
        found = compare_spaces(space(), space(stimulus_range=RANGES | {"alpha": (0.15, 0.2)}))
        assert found.ranges[2].share == 0
        assert found.distances is None
        assert any("no alpha in common" in remark for remark in found.remarks)

    def test_one_space_does_not_tell(self):
        found = compare_spaces(PAPER_SPACE, space())
        assert [one.common for one in found.ranges] == list(RANGES.values())
        assert any("in a is not known (rho_d, rho_s, alpha)" in remark for remark in found.remarks)

    def test_neither_tells(self):
        found = compare_spaces(PAPER_SPACE, PAPER_SPACE)
        assert found.distances is not None
        assert any("that of the gloss paper's stimuli is taken" in remark for remark in found.remarks)

    def test_a_single_paint(self):
        point = {"rho_d": (0.1, 0.1), "rho_s": (0.1, 0.1), "alpha": (0.1, 0.1)}
        found = compare_spaces(space(stimulus_range=point), space(stimulus_range=point))
        assert [one.share for one in found.ranges] == [1, 1, 1]
        assert found.distances is None

    def test_impossible_paints(self):
        found = compare_spaces(*2 * [space(stimulus_range=RANGES | {"rho_d": (0.99, 1.0)})])
        assert found.distances is None
        assert any("no possible paint" in remark for remark in found.remarks)


class TestDistances:
    def test_blacks_by_hand(self):
        """Two blacks a c apart, two alphas a d apart: pairs differ in c, in d, or in both."""
        ranges = {"rho_d": (0.0, 0.0), "rho_s": (0.001, 0.008), "alpha": (0.1, 0.2)}  # dc = .2 - .1, dd = .1
        found = compare_spaces(*(space(w, stimulus_range=ranges) for w in (1.0, 2.0)), n=2).distances
        size_a, size_b = (math.sqrt((2 * 1 + 2 * w**2 + 2 * (1 + w**2)) / 6) for w in (1, 2))
        ratios = {"c": size_a / size_b, "d": 2 * size_a / size_b, "both": math.sqrt(5 / 2) * size_a / size_b}
        worst = max(ratios.values(), key=lambda ratio: abs(math.log(ratio)))
        assert found.ratio == pytest.approx(worst)
        assert found.n_paints == 4
        assert found.paint_1.alpha == found.paint_2.alpha  # they differ in c alone
        assert {found.paint_1.rho_s, found.paint_2.rho_s} == {0.001, 0.008}

    def test_of_ties_the_furthest_apart(self):
        """With c far apart and d not, only pairs of the same c reach the extreme: those of extreme alphas are shown."""
        ranges = {"rho_d": (0.0, 0.0), "rho_s": (0.001, 0.729), "alpha": (0.04, 0.1)}
        found = compare_spaces(*(space(w, stimulus_range=ranges) for w in (1.0, 1.5))).distances
        assert found.ratio > 1
        assert {found.paint_1.alpha, found.paint_2.alpha} == {0.04, 0.1}
        assert found.paint_1.rho_s == found.paint_2.rho_s


@pytest.mark.parametrize("n", [1, 13, 2.0, True])
def test_grid_size_refused(n):
    with pytest.raises(GlossError, match="Invalid n = "):
        compare_spaces(PAPER_SPACE, PAPER_SPACE, n=n)


class TestCommand:
    @pytest.fixture
    def file(self, tmp_path):
        path = tmp_path / "mine.json"
        functions = {"d": AxisFunction(5.0, -1.0, 0.9, 11)}
        space(3.0, 0.1, name="[mine]", axis_functions=functions, provenance={"observers": ["1 (simulated)", "2"]}).save(
            path
        )
        return str(path)

    def test_json(self, gloss, file):
        code, out, err = gloss("compare", file, "paper", "--json")
        assert code == 0, err
        document = json.loads(out, parse_constant=pytest.fail)
        assert document["a"] == {"file": file, "name": "[mine]"}
        assert document["weight"]["ratio"] == pytest.approx(1.78 / 3)
        assert document["weight"]["differs"] is True
        assert set(document["distances"]["paint_1"]) == {"rho_d", "rho_s", "alpha"}
        assert "simulated participants (1 of 2)" in err

    def test_for_a_person(self, gloss, file):
        code, out, err = gloss("compare", file, file)
        assert code == 0
        assert all(word in out for word in ("a: [mine]", "weight of d", "r² of ratings along d", "0.04 to 0.1"))
        assert "No ratings along c in a and b" in err

    def test_help_has_examples(self, gloss):
        code, out, _ = gloss("compare", "--help")
        assert code == 0
        assert "    gloss compare " in out.partition("Examples:")[2]
        assert "--json" in out

    def test_a_file_that_is_not_there(self, gloss, tmp_path):
        code, out, err = gloss("compare", "paper", str(tmp_path / "no.json"))
        assert (code, out) == (2, "")
        assert err.startswith("gloss: No gloss space at")
        assert err.count("\n") == 1


class TestOtherForms:
    def test_the_same_space_in_other_units_does_not_differ(self):
        """With an exponent of 1 c is rho_s, whatever the diffuse share: one space in two forms."""
        one = space(0.1, 0.1, contrast_form=ContrastForm(exponent=1.0, diffuse_share=0.5))
        other = space(0.1, 0.1, contrast_form=ContrastForm(exponent=1.0, diffuse_share=2.0))
        found = compare_spaces(one, other)
        assert found.weight.ratio == pytest.approx(1, abs=1e-9)
        assert found.distances.relative_difference == pytest.approx(0, abs=1e-9)
        assert any("The axis functions have other forms" in remark for remark in found.remarks)

    def test_weights_are_compared_in_one_unit(self):
        """Square roots against cube roots; extents over the corners of the common range, by hand."""
        roots = space(1.0, contrast_form=ContrastForm(exponent=0.5))
        extent = {}
        for p in (1 / 3, 0.5):
            corners = [(s + d / 2) ** p - (d / 2) ** p for d in RANGES["rho_d"] for s in RANGES["rho_s"]]
            extent[p] = max(corners) - min(corners)
        assert compare_spaces(space(1.0), roots).weight.ratio == pytest.approx(extent[1 / 3] / extent[0.5], rel=1e-9)

    def test_without_common_paints_weights_are_not_compared(self):
        far = {"rho_d": (0.6, 0.7), "rho_s": (0.2, 0.3), "alpha": (0.04, 0.1)}
        found = compare_spaces(space(), space(contrast_form=ContrastForm(0.5), stimulus_range=far))
        assert math.isnan(found.weight.ratio)
        assert found.weight.differs is None
        assert any("weights are not compared" in remark for remark in found.remarks)

    def test_the_interval_of_a_slope_over_participants_is_taken_where_it_is_known(self):
        """Equal lines, intervals of exp(±.3) and exp(±.4) on logs: .5 together, as for weights."""
        a, b = (
            space(
                axis_functions={"c": AxisFunction(100.0, 0.0, 0.9, 24, (100 * math.exp(-h), 100 * math.exp(h)), None)}
            )
            for h in (0.3, 0.4)
        )
        assert compare_spaces(a, b).slopes["c"].ratio_ci95 == pytest.approx((math.exp(-0.5), math.exp(0.5)))
