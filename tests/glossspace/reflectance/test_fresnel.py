"""Fresnel's reflectance against closed forms, the printed equation, and Fresnel's own amplitudes."""

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from glossspace.errors import GlossError
from glossspace.reflectance import fresnel_reflectance

INDEX = st.floats(0.05, 50.0)
EXTINCTION = st.one_of(st.just(0.0), st.floats(0.0, 100.0))
COSINE = st.floats(1e-3, 1.0)


@given(n=INDEX, k=EXTINCTION)
def test_normal_incidence_is_the_closed_form(n, k):
    expected = ((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2)
    assert fresnel_reflectance(1.0, n, k) == pytest.approx(expected, rel=1e-12, abs=0)


@given(step=st.floats(1e-12, 1e-3), u=st.floats(1e-6, 1.0))
def test_an_index_near_one_keeps_its_digits(step, u):
    """Against the amplitudes in forty digits."""
    with mpmath.workdps(40):
        n, cos_i = mpmath.mpf(1 + step), mpmath.mpf(u)
        cos_t = mpmath.sqrt(1 - (1 - cos_i**2) / n**2)
        parallel = (n * cos_i - cos_t) / (n * cos_i + cos_t)
        perpendicular = (cos_i - n * cos_t) / (cos_i + n * cos_t)
        expected = float((parallel**2 + perpendicular**2) / 2)
    assert fresnel_reflectance(u, 1 + step) == pytest.approx(expected, rel=1e-12, abs=0)


def printed_equation_10(u, n, k):
    """The glossmeter paper's eq. 10, as printed."""
    root = np.sqrt((n**2 - k**2 + u**2 - 1) ** 2 + 4 * n**2 * k**2)
    a2, b2 = (root + (n**2 - k**2 + u**2 - 1)) / 2, (root - (n**2 - k**2 + u**2 - 1)) / 2
    a = np.sqrt(a2)
    ratio = ((a + u - 1 / u) ** 2 + b2) / ((a - u + 1 / u) ** 2 + b2)
    return ((a - u) ** 2 + b2) / ((a + u) ** 2 + b2) * (ratio + 1) / 2


@given(u=COSINE, n=st.floats(1.05, 5.0), k=EXTINCTION)
def test_it_is_equation_10_of_the_glossmeter_paper(u, n, k):
    # 1e-6: as printed, a² cancels for large k, and a + u − 1/u at small u.
    assert fresnel_reflectance(u, n, k) == pytest.approx(printed_equation_10(u, n, k), rel=1e-6, abs=1e-9)


@given(u=COSINE, n=st.floats(1.01, 4.0))
def test_it_is_the_mean_of_the_squared_amplitudes(u, n):
    """Eqs 7 to 9 of the glossmeter paper."""
    cos_t = np.sqrt(1 - (1 - u**2) / n**2)
    parallel, perpendicular = (n * u - cos_t) / (n * u + cos_t), (u - n * cos_t) / (u + n * cos_t)
    assert fresnel_reflectance(u, n) == pytest.approx((parallel**2 + perpendicular**2) / 2, rel=1e-10, abs=1e-14)


@given(n=st.floats(1.01, 10.0))
def test_at_brewsters_angle_only_perpendicular_light_is_left(n):
    # tanθ = n: the parallel amplitude is zero and the other is (n² − 1) / (n² + 1).
    expected = 0.5 * ((n**2 - 1) / (n**2 + 1)) ** 2
    assert fresnel_reflectance(1 / np.hypot(1, n), n) == pytest.approx(expected, rel=1e-11)


@given(n=st.floats(0.1, 0.95), share=st.floats(0.001, 0.999))
def test_beyond_the_critical_angle_all_is_reflected(n, share):
    sine = n + share * (1 - n)
    assert fresnel_reflectance(np.sqrt(1 - sine**2), n) == pytest.approx(1.0, abs=1e-12)


@given(u=st.floats(0.0, 1.0))
def test_without_an_interface_nothing_is_reflected(u):
    assert fresnel_reflectance(u, 1.0) == 0.0


@given(n=st.floats(1.000001, 1000.0), k=EXTINCTION)
def test_at_grazing_all_is_reflected(n, k):
    assert fresnel_reflectance(0.0, n, k) == pytest.approx(1.0, abs=1e-12)


@given(u=st.floats(1e-6, 1.0), n=st.floats(0.0, 2.0), k=st.floats(1e3, 1e6))
def test_a_perfect_conductor_is_a_mirror(u, n, k):
    reflectance = fresnel_reflectance(u, n, k)
    # To first order 1 − F is 2 n / k² (u + 1/u), so less than this bound, and never above 1.
    assert 1 - 4 * (n + 1) / k**2 / u * 2 - 1e-12 <= reflectance <= 1


@given(u=st.floats(0.0, 1.0), n=st.floats(1e-6, 1e6), k=st.floats(0.0, 1e6))
def test_it_lies_between_zero_and_one(u, n, k):
    assert 0 <= fresnel_reflectance(u, n, k) <= 1


def test_it_broadcasts_and_lets_nan_through():
    result = fresnel_reflectance(np.array([[1.0], [np.nan]]), [1.5, 2.0])
    assert result.shape == (2, 2)
    np.testing.assert_allclose(result[0], [0.04, 1 / 9], rtol=1e-12)
    assert np.isnan(result[1]).all()
    assert np.isnan(fresnel_reflectance(0.5, np.nan))
    assert np.isnan(fresnel_reflectance(np.nan, 1.0))


def test_a_cosine_may_round_to_above_one():
    assert fresnel_reflectance(1 + 1e-10, 1.5) == fresnel_reflectance(1.0, 1.5)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((1.1, 1.5), "Invalid cos_theta = 1.1. Allowed: 0 to 1"),
        ((-0.1, 1.5), "Invalid cos_theta = -0.1"),
        ((0.5, -1.0), "Invalid n = -1.0. Allowed: 0 to 1e\\+06"),
        ((0.5, 1.5, -1.0), "Invalid k = -1.0"),
        ((0.5, np.inf), "Invalid n = inf"),
        ((0.5, 0.0, 0.0), "n = 0 and k = 0 together are no index"),
        ((0.5, "glass"), "n must be a number or an array of numbers, but got 'glass'"),
    ],
)
def test_impossible_numbers_are_refused(arguments, message):
    with pytest.raises(GlossError, match=message):
        fresnel_reflectance(*arguments)
