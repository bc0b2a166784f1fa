"""The axes and their inverses: eqs 3, 4 and 6-8 of the gloss paper."""

import subprocess
import sys

import mpmath
import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from glossspace.errors import GlossError
from glossspace.metric import (
    Appearance,
    Paint,
    contrast_gloss,
    diffuse_reflectance,
    distinctness,
    from_physical,
    lightness,
    roughness_alpha,
    specular_reflectance,
    to_physical,
)

# A handful of roundings of 1e-16 each, in a cube root and its inverse, with room: what the project promises.
RELATIVE = 1e-12

fractions = st.floats(0, 1, allow_subnormal=False)
# d = 1 - alpha stores alpha to 1e-16, so that 1e-12 relatively can hold from 1e-4 on; the paper's smoothest is 1e-2.
roughnesses = st.floats(1e-3, 10)


@st.composite
def reflectances(draw):
    """(rho_d, rho_s) with rho_d + rho_s <= 1, down to the smallest normal numbers."""
    rho_d = draw(fractions)
    return rho_d, draw(st.floats(0, 1 - rho_d, allow_subnormal=False))


def exact_contrast_gloss(rho_d: float, rho_s: float) -> mpmath.mpf:
    """Eq. 4 as printed; 700 digits hold the difference of two cube roots that agree in their first 300."""
    with mpmath.workdps(700):
        half = mpmath.mpf(rho_d) / 2
        return mpmath.cbrt(mpmath.mpf(rho_s) + half) - mpmath.cbrt(half)


def exact_specular_reflectance(rho_d: float, c: float) -> mpmath.mpf:
    """Eq. 7 as printed."""
    with mpmath.workdps(700):
        half = mpmath.mpf(rho_d) / 2
        return (mpmath.mpf(c) + mpmath.cbrt(half)) ** 3 - half


def cie_lightness(luminance_factor: float) -> mpmath.mpf:
    """CIE 15:2004, eqs 8.3 and 8.6, with the CIE's rational constants."""
    with mpmath.workdps(700):
        t = mpmath.mpf(luminance_factor)
        knee = mpmath.mpf(24) / 116
        f = mpmath.cbrt(t) if t > knee**3 else mpmath.mpf(841) / 108 * t + mpmath.mpf(16) / 116
        return 116 * f - 16


def relative_error(value: float, exact: mpmath.mpf) -> float:
    if exact == 0:
        return float(abs(value))
    with mpmath.workdps(700):
        return float(abs((mpmath.mpf(float(value)) - exact) / exact))


MAGNITUDES = [10.0**exponent for exponent in (-300, -200, -100, -50, -20, -16, -12, -8, -4, -2, -1)]
PAINTS = [(d, s) for d in [*MAGNITUDES, 0.5, 1.0] for s in [*MAGNITUDES, 0.5, 1.0] if d + s <= 1]


@pytest.mark.parametrize(("rho_d", "rho_s"), PAINTS)
def test_c_equals_eq_4_in_arbitrary_precision(rho_d, rho_s):
    assert relative_error(contrast_gloss(rho_d, rho_s), exact_contrast_gloss(rho_d, rho_s)) < RELATIVE


@given(reflectances())
def test_c_equals_eq_4_for_any_paint(paint):
    assert relative_error(contrast_gloss(*paint), exact_contrast_gloss(*paint)) < RELATIVE


@given(reflectances())
def test_rho_s_equals_eq_7_for_any_appearance(paint):
    rho_d, rho_s = paint
    c = contrast_gloss(rho_d, rho_s)
    # Below 1e-200 c loses digits to underflow of its powers, as rho_s itself would be below 1e-300.
    if c > 1e-200:
        assert relative_error(specular_reflectance(rho_d, c), exact_specular_reflectance(rho_d, c)) < RELATIVE


@given(reflectances(), roughnesses)
def test_a_paint_comes_back_from_its_appearance(reflectances, alpha):
    paint = Paint(*reflectances, alpha)
    back = to_physical(*from_physical(*paint))
    # The smallest normal number stands in for a relative error of reflectances that underflow on the way.
    assert back == pytest.approx(paint, rel=RELATIVE, abs=np.finfo(float).tiny)


@given(lightness_=st.floats(0, 100, allow_subnormal=False), share=fractions, d=st.floats(-9, 0.999))
def test_an_appearance_comes_back_from_its_paint(lightness_, share, d):
    rho_d = diffuse_reflectance(lightness_)
    appearance = Appearance(lightness_, share * contrast_gloss(rho_d, 1 - rho_d), d)
    back = from_physical(*to_physical(*appearance))
    # c is absolute below 1e-100: on black, rho_s = c^3 underflows. d near zero is absolute: alpha = 1 - d is near 1.
    assert back.lightness == pytest.approx(appearance.lightness, rel=RELATIVE, abs=np.finfo(float).tiny)
    assert back.c == pytest.approx(appearance.c, rel=RELATIVE, abs=1e-100)
    assert back.d == pytest.approx(appearance.d, rel=RELATIVE, abs=1e-15)


@given(fractions)
def test_black_is_the_cube_root_and_no_gloss_is_zero_exactly(value):
    assert contrast_gloss(0.0, value) == np.cbrt(value)
    assert contrast_gloss(value, 0.0) == 0
    assert specular_reflectance(value, 0.0) == 0


def test_ends_are_exact():
    assert contrast_gloss(0, 0) == 0
    assert contrast_gloss(0, 1) == 1
    assert specular_reflectance(0, 1) == 1
    assert lightness(0) == 0
    assert lightness(1) == 100
    assert diffuse_reflectance(0) == 0
    assert diffuse_reflectance(100) == 1


@given(st.floats(0, 1))
def test_lightness_is_cielab(rho_d):
    # Denormal numbers have few digits: absolute there.
    assert lightness(rho_d) == pytest.approx(float(cie_lightness(rho_d)), rel=RELATIVE, abs=1e-300)


@given(st.floats(0, 1))
def test_lightness_is_that_of_colour_science(rho_d):
    from colour.colorimetry import lightness_CIE1976

    # The textbook form subtracts 16 from a number near 16 on its foot: 1e-14 of lightness is its rounding.
    assert lightness(rho_d) == pytest.approx(lightness_CIE1976(100 * rho_d), rel=1e-13, abs=1e-13)


def test_the_reference_scale_of_colour_science_does_not_matter():
    import colour

    with colour.domain_range_scale("1"):
        scaled = lightness(0.193), diffuse_reflectance(51.0)
    assert scaled == (lightness(0.193), diffuse_reflectance(51.0))


@pytest.mark.parametrize("side", [-1, 0, 1])
def test_lightness_has_no_step_at_its_knee(side):
    knee = (6 / 29) ** 3
    beside = knee * (1 + side * 1e-9)
    assert lightness(beside) == pytest.approx(float(cie_lightness(beside)), rel=RELATIVE)
    assert diffuse_reflectance(lightness(beside)) == pytest.approx(beside, rel=RELATIVE)


@given(reflectances(), reflectances())
def test_c_rises_with_rho_s_and_falls_with_rho_d(paint_a, paint_b):
    rho_d, rho_s = np.minimum(paint_a, paint_b)
    more_d, more_s = max(paint_a[0], paint_b[0]), max(paint_a[1], paint_b[1])
    c = contrast_gloss(rho_d, rho_s)
    # A relative step of 1e-15 covers the rounding of two values that are equal in exact arithmetic.
    if rho_d + more_s <= 1:
        assert contrast_gloss(rho_d, more_s) >= c * (1 - 1e-15)
    if more_d + rho_s <= 1:
        assert contrast_gloss(more_d, rho_s) <= c * (1 + 1e-15)


class TestValuesOfThePaper:
    def test_figure_11_reference(self):
        """Section 5.1: c = 0.087, d = 0.93, the gray stimulus rho_s .066, alpha .07."""
        appearance = from_physical(0.193, 0.066, 0.07)
        assert appearance.c == pytest.approx(0.087, abs=5e-4)  # printed to three decimals
        assert appearance.d == pytest.approx(0.93, abs=1e-15)
        paint = to_physical(lightness(0.193), 0.087, 0.93)
        assert paint == pytest.approx((0.193, 0.066, 0.07), abs=5e-4)

    def test_figure_12_white_sphere(self):
        """Section 5.2 prints c = .057, cut off from .0578, and d = .96, for rho_d .767, rho_s .099, alpha .04."""
        appearance = from_physical(0.767, 0.099, 0.04)
        assert np.floor(appearance.c * 1000) == 57
        assert appearance.c == pytest.approx(0.0578, abs=5e-5)
        assert appearance.d == pytest.approx(0.96, abs=1e-15)

    def test_white_looks_less_glossy_than_gray_than_black(self):
        """Section 5.2, top row of figure 12."""
        white, gray, black = contrast_gloss([0.767, 0.193, 0.03], 0.099)
        assert white < gray < black


FUNCTIONS = {
    "contrast_gloss": (contrast_gloss, (0.193, 0.066)),
    "distinctness": (distinctness, (0.07,)),
    "lightness": (lightness, (0.193,)),
    "diffuse_reflectance": (diffuse_reflectance, (51.0,)),
    "specular_reflectance": (specular_reflectance, (0.193, 0.087)),
    "roughness_alpha": (roughness_alpha, (0.93,)),
    "from_physical": (from_physical, (0.193, 0.066, 0.07)),
    "to_physical": (to_physical, (51.0, 0.087, 0.93)),
}
each_function = pytest.mark.parametrize(("function", "arguments"), FUNCTIONS.values(), ids=FUNCTIONS)


def outputs(result):
    return result if isinstance(result, tuple) else (result,)


@each_function
def test_scalars_give_floats(function, arguments):
    assert all(isinstance(value, float) for value in outputs(function(*arguments)))


@each_function
@pytest.mark.parametrize("shape", [(1,), (3,), (2, 3), (2, 1, 3), (0,), (2, 0)])
def test_arrays_keep_their_shape_and_values(function, arguments, shape):
    expected = outputs(function(*arguments))
    for value, scalar in zip(outputs(function(*(np.full(shape, a) for a in arguments))), expected, strict=True):
        assert value.shape == shape
        np.testing.assert_array_equal(value, np.full(shape, scalar))


@each_function
def test_one_nan_stays_one_nan(function, arguments):
    for position in range(len(arguments)):
        arrays = [np.full(3, argument) for argument in arguments]
        arrays[position][1] = np.nan
        results = np.array(outputs(function(*arrays)))
        assert np.isfinite(results[:, [0, 2]]).all()
        assert np.isnan(results[:, 1]).any()


def test_nan_alone_gives_nan():
    assert np.isnan(contrast_gloss(np.nan, 0.1))
    assert np.isnan(contrast_gloss(0.1, np.nan))
    assert np.isnan(contrast_gloss(0.0, np.nan))
    assert np.isnan(lightness(np.nan))
    assert np.isnan(specular_reflectance(np.nan, 0.5))


def test_columns_and_rows_broadcast():
    rho_d, rho_s, alpha = np.array([[0.03], [0.193]]), np.array([0.033, 0.066, 0.099]), 0.04
    appearance = from_physical(rho_d, rho_s, alpha)
    assert [value.shape for value in appearance] == [(2, 3)] * 3
    assert appearance.c[1, 1] == contrast_gloss(0.193, 0.066)
    assert [value.shape for value in to_physical(*appearance)] == [(2, 3)] * 3


@each_function
def test_results_are_new_writable_arrays(function, arguments):
    arrays = [np.full(3, argument) for argument in arguments]
    for value in outputs(function(*arrays)):
        value += 1
    for array, argument in zip(arrays, arguments, strict=True):
        np.testing.assert_array_equal(array, argument)


@pytest.mark.parametrize(
    "container", [list, tuple, np.float32, pd.Series, lambda v: np.array(v, dtype=object), np.longdouble]
)
def test_anything_numeric_is_taken(container):
    # float32 holds .25 and .5 exactly
    np.testing.assert_array_equal(contrast_gloss(container([0.25, 0.5]), 0.25), contrast_gloss([0.25, 0.5], 0.25))


def test_integers_are_numbers():
    np.testing.assert_array_equal(contrast_gloss(np.array([0, 0]), np.array([0, 1])), [0.0, 1.0])


def test_masked_entries_become_nan():
    masked = np.ma.array([0.1, 0.2], mask=[False, True])
    np.testing.assert_array_equal(lightness(masked), [lightness(0.1), np.nan])


@pytest.mark.parametrize(
    "value",
    ["0.5", b"0.5", "", None, [0.1, None], True, np.array([True]), 1j, np.array([0.1 + 1j]), {}, pd.NA, 10**400,
     np.datetime64("2000"), [[0.1], [0.1, 0.2]], np.array(["0.1"]), object()],
    ids=lambda value: type(value).__name__,  # the same in every process: an object's repr holds its address
)  # fmt: skip
def test_what_is_no_number_is_refused_by_name(value):
    with pytest.raises(GlossError, match=r"^rho_d must be a number or an array of numbers, but got "):
        lightness(value)
    with pytest.raises(GlossError, match=r"^rho_s must be a number or an array of numbers, but got "):
        contrast_gloss(0.1, value)


def test_the_message_stays_short_for_long_input():
    with pytest.raises(GlossError, match=r"^rho_d must be a number") as caught:
        lightness(["x"] * 10_000)
    assert len(str(caught.value)) < 200


PAINT = (0.193, 0.066, 0.07)


@pytest.mark.parametrize(
    ("rho_d", "rho_s", "alpha", "message"),
    [
        (-0.1, *PAINT[1:], r"^Invalid rho_d = -0\.1\. Allowed: 0 to 1\.$"),
        (1.5, *PAINT[1:], r"^Invalid rho_d = 1\.5\."),
        (1 + 2e-16, 0, 0.07, r"^Invalid rho_d = 1\.0000000000000002\."),
        (np.inf, *PAINT[1:], r"^Invalid rho_d = inf\."),
        (-np.inf, *PAINT[1:], r"^Invalid rho_d = -inf\."),
        (0.193, -1e-300, 0.07, r"^Invalid rho_s = -1e-300\."),
        (0.193, np.inf, 0.07, r"^Invalid rho_s = inf\."),
        (np.nan, 5.0, 0.07, r"^Invalid rho_s = 5\.0\."),
        (0.5, 0.75, 0.07, r"^Invalid rho_d \+ rho_s = 1\.25\. Allowed: at most 1, since a paint cannot reflect more"),
        (0.193, 0.066, 0.0, r"^Invalid alpha = 0\.0\. Allowed: finite and > 0\.$"),
        (0.193, 0.066, -0.07, r"^Invalid alpha = -0\.07\."),
        (0.193, 0.066, np.inf, r"^Invalid alpha = inf\."),
        ([0.1, -0.2, -0.3], 0.0, 0.07, r"^Invalid rho_d = -0\.2 \(and 1 more\)\."),
        ([0.1, 0.2], [0.1, 0.2, 0.3], 0.07, r"do not broadcast: rho_d \(2,\), rho_s \(3,\), alpha \(\)\."),
    ],
)
def test_impossible_paints_are_refused_by_value(rho_d, rho_s, alpha, message):
    with pytest.raises(GlossError, match=message):
        from_physical(rho_d, rho_s, alpha)


@pytest.mark.parametrize(
    ("lightness_", "c", "d", "message"),
    [
        (-1, 0.087, 0.93, r"^Invalid lightness = -1\.0\. Allowed: 0 to 100 \(CIELAB L\*\)\.$"),
        (100.5, 0.0, 0.93, r"^Invalid lightness = 100\.5\."),
        (np.inf, 0.0, 0.93, r"^Invalid lightness = inf\."),
        (51, -0.01, 0.93, r"^Invalid c = -0\.01\. Allowed: 0 to 1\.$"),
        (51, np.inf, 0.93, r"^Invalid c = inf\."),
        (51, 1e200, 0.93, r"^Contrast gloss c = 1e\+200 is out of reach"),
        # The envelope of figure 10: at L* = 100, rho_d = 1 leaves nothing for rho_s.
        (100, 0.01, 0.93, r"^Contrast gloss c = 0\.01 is out of reach for rho_d = 1, which allows at most 0\."),
        (0, 1.01, 0.93, r"^Contrast gloss c = 1\.01 is out of reach for rho_d = 0, which allows at most 1\."),
        ([51, 90], [0.087, 0.5], 0.93, r"^Contrast gloss c = 0\.5 is out of reach for rho_d = 0\.763"),
        (51, 0.087, 1.0, r"^Invalid d = 1\.0\. Allowed: below 1, since alpha = 1 - d must be positive\.$"),
        (51, 0.087, 1.5, r"^Invalid d = 1\.5\."),
        (51, 0.087, -np.inf, r"^Invalid d = -inf\."),
        ([51, 52], 0.087, [0.9, 0.9, 0.9], r"do not broadcast: lightness \(2,\), c \(\), d \(3,\)\."),
    ],
)
def test_impossible_appearances_are_refused_by_value(lightness_, c, d, message):
    with pytest.raises(GlossError, match=message):
        to_physical(lightness_, c, d)


def test_a_gloss_error_is_a_value_error():
    with pytest.raises(ValueError, match="rho_d = -1"):
        contrast_gloss(-1, 0)


def test_a_sum_that_rounds_above_one_is_still_one():
    rho_d = np.linspace(0, 1, 10_001)
    assert np.all(contrast_gloss(rho_d, 1 - rho_d) >= 0)
    assert contrast_gloss(0.1, 0.9 + 2e-16) == pytest.approx(contrast_gloss(0.1, 0.9), rel=1e-15)


@pytest.mark.parametrize(
    ("alpha", "d"), [(0.3, 0.7), (1.0, 0.0), (2.0, -1.0)]
)  # eq. 3; what lies above .2 is computed, and flagged by within_paper_range
def test_roughness_beyond_the_paper_is_computed(alpha, d):
    assert distinctness(alpha) == pytest.approx(d, abs=1e-16)
    assert roughness_alpha(d) == pytest.approx(alpha, abs=1e-16)


def test_printing_of_arrays_is_left_alone():
    """Importing colour-science changes how NumPy prints arrays; a metric must not do that to its user."""
    code = (
        "import numpy; before = numpy.get_printoptions()\n"
        "from glossspace.metric import lightness; lightness(0.5)\n"
        "assert numpy.get_printoptions() == before, numpy.get_printoptions()\n"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
