"""Forms of the gloss axes beside the paper's: values, inverses, edges."""

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from glossspace.errors import GlossError
from glossspace.metric import ContrastForm, DistinctnessForm, GlossSpace, Paint, isogloss_contour, match_gloss
from glossspace.metric.axes import contrast_gloss, distinctness

REFLECTANCE = st.floats(0, 0.5)
CONTRAST = st.builds(
    ContrastForm,
    exponent=st.floats(0.05, 3),
    diffuse_share=st.floats(1e-3, 10),
    offset=st.just(0.0) | st.floats(1e-6, 10),
)
DISTINCTNESS = st.builds(DistinctnessForm, exponent=st.floats(0.05, 3), offset=st.just(0.0) | st.floats(1e-6, 10))


class TestContrast:
    @given(rho_d=REFLECTANCE, rho_s=REFLECTANCE)
    def test_a_form_beside_the_paper_s_tends_to_it(self, rho_d, rho_s):
        """The general expression a hair from the paper's exponent, against eq. 4's own cube roots.

        dc/dp of x^p - y^p on [0, 1] is below 1 / (e p) < 1.2, so that a step of 1e-9 moves c by less than 2e-9.
        """
        near = ContrastForm(exponent=1 / 3 + 1e-9)
        assert near.value(rho_d, rho_s) == pytest.approx(contrast_gloss(rho_d, rho_s), abs=2e-9)

    @given(form=CONTRAST, rho_d=REFLECTANCE, rho_s=st.floats(1e-12, 0.5))
    def test_no_digit_is_lost_where_little_is_reflected(self, form, rho_d, rho_s):
        """Against 60 digits of mpmath. Powers up to 3 of numbers with relative error 1e-16 stay within 1e-13."""
        with mpmath.workdps(60):
            base = mpmath.mpf(form.diffuse_share) * mpmath.mpf(rho_d) + mpmath.mpf(form.offset)
            exact = (rho_s + base) ** mpmath.mpf(form.exponent) - base ** mpmath.mpf(form.exponent)
        assert form.value(rho_d, rho_s) == pytest.approx(float(exact), rel=1e-13)

    @given(form=CONTRAST, rho_d=REFLECTANCE, rho_s=st.just(0.0) | st.floats(1e-9, 0.5))
    def test_round_trip(self, form, rho_d, rho_s):
        """1e-9: inverting a power of .05 magnifies the relative error of c, 1e-16, by up to 20 x the ratio of bases."""
        c = form.value(rho_d, rho_s)
        assert form.specular_reflectance(rho_d, c) == pytest.approx(rho_s, rel=1e-9, abs=1e-15)
        assert form.is_paintable(np.asarray(rho_d), np.asarray(c))

    @given(form=CONTRAST, rho_d=REFLECTANCE, low=REFLECTANCE, high=REFLECTANCE)
    def test_more_specular_reflectance_never_looks_less_glossy(self, form, rho_d, low, high):
        low, high = sorted((low, high))
        assert form.value(rho_d, low) <= form.value(rho_d, high)

    def test_nothing_reflected_is_no_gloss_and_nan_stays_nan(self):
        form = ContrastForm(exponent=0.5)
        assert form.value([0.0, 0.5, np.nan], [0.0, 0.0, 0.1]) == pytest.approx([0, 0, np.nan], nan_ok=True)

    def test_what_no_paint_has_is_refused(self):
        form = ContrastForm(exponent=0.5)
        with pytest.raises(GlossError, match=r"c = 0\.9 is out of reach for rho_d = 0\.5, which allows at most 0\.366"):
            form.specular_reflectance(0.5, 0.9)  # sqrt(.75) - sqrt(.25) = .366
        with pytest.raises(GlossError, match=r"Invalid c = -0\.1"):
            form.specular_reflectance(0.5, -0.1)
        with pytest.raises(GlossError, match=r"Invalid rho_d \+ rho_s = 1\.2"):
            form.value(0.7, 0.5)


class TestDistinctness:
    @given(form=DISTINCTNESS, alpha=st.floats(1e-3, 0.5))
    def test_round_trip(self, form, alpha):
        """1e-9 of alpha + offset, up to 10.5: 1 - d keeps 1e-16 of 1, which a root of .05 magnifies by 20."""
        d = form.value(alpha)
        if 1 - d > 1e-6:  # otherwise rounding of d near 1 eats alpha itself, as it must
            assert form.roughness_alpha(d) == pytest.approx(alpha, abs=1e-8 * (1 + form.offset))

    def test_the_paper_s(self):
        assert DistinctnessForm().value(0.07) == distinctness(0.07)

    def test_a_mirror_is_the_limit(self):
        form = DistinctnessForm(exponent=0.5, offset=0.04)
        assert form.limit == pytest.approx(0.8)
        with pytest.raises(GlossError, match=r"Invalid d = 0\.81\. Allowed: below 0\.8, since alpha is positive"):
            form.roughness_alpha(0.81)
        assert form.has_lobe(np.array([0.79, 0.81, np.nan])).tolist() == [True, False, False]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: ContrastForm(exponent=0), r"Invalid exponent = 0 of the form of a gloss axis\. Allowed: 0\.05 to 3"),
        (lambda: ContrastForm(diffuse_share=-1), "Invalid diffuse_share = -1"),
        (lambda: ContrastForm(offset=np.nan), "Invalid offset = nan"),
        (lambda: DistinctnessForm(exponent="1"), "Invalid exponent = '1'"),
        (lambda: DistinctnessForm(exponent=True), "Invalid exponent = True"),
    ],
)
def test_impossible_parameters_are_refused(make, message):
    with pytest.raises(GlossError, match=message):
        make()


class TestInASpace:
    SPACE = GlossSpace(
        weight_d=0.9,
        contrast_form=ContrastForm(exponent=0.5, diffuse_share=0.4),
        distinctness_form=DistinctnessForm(exponent=0.7, offset=0.001),
    )

    def test_distance_is_that_of_the_formula(self):
        """Written out by hand for one pair."""
        c = [np.sqrt(s + 0.4 * d) - np.sqrt(0.4 * d) for d, s in ((0.2, 0.06), (0.03, 0.1))]
        d = [1 - (alpha + 0.001) ** 0.7 for alpha in (0.04, 0.1)]
        expected = np.hypot(c[0] - c[1], 0.9 * (d[0] - d[1]))
        assert self.SPACE.distance(Paint(0.2, 0.06, 0.04), Paint(0.03, 0.1, 0.1)) == pytest.approx(expected, rel=1e-12)

    def test_appearance_and_back(self):
        paint = Paint(0.193, 0.066, 0.07)
        assert self.SPACE.paint(*self.SPACE.appearance(paint)) == pytest.approx(paint, rel=1e-10)

    def test_a_match_is_at_no_distance(self):
        white = Paint(0.767, 0.099, 0.04)
        black = match_gloss(white, rho_d=0.03, space=self.SPACE)
        assert self.SPACE.distance(white, black) == pytest.approx(0, abs=1e-12)
        assert abs(black.rho_s - match_gloss(white, rho_d=0.03).rho_s) > 1e-3  # another form, another match

    def test_a_contour_is_at_its_distance(self):
        centre = Paint(0.193, 0.066, 0.07)
        contour = isogloss_contour(centre, radius=0.04, n=24, space=self.SPACE)
        there = Paint(contour.rho_d, contour.rho_s[contour.reachable], contour.alpha[contour.reachable])
        assert self.SPACE.distance(centre, there) == pytest.approx(0.04, rel=1e-9)
        assert contour.reachable.sum() > 12

    def test_the_file_keeps_the_forms(self, tmp_path):
        self.SPACE.save(tmp_path / "space.json")
        assert GlossSpace.load(tmp_path / "space.json") == self.SPACE
