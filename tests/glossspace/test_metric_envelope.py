"""Figure 10 of the gloss paper."""

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from glossspace.errors import GlossError
from glossspace.metric import diffuse_reflectance, fixed_energy_contrast_gloss, max_contrast_gloss, to_physical


def test_the_ends_of_figure_10():
    assert max_contrast_gloss(0) == 1
    assert max_contrast_gloss(100) == 0


@given(st.floats(0, 100))
def test_the_envelope_is_energy_conservation_in_eq_4(lightness):
    rho_d = diffuse_reflectance(lightness)
    with mpmath.workdps(60):
        half = mpmath.mpf(float(rho_d)) / 2
        expected = float(mpmath.cbrt(1 - half) - mpmath.cbrt(half))
    # 1 - rho_d rounds to 1e-16 absolutely
    assert max_contrast_gloss(lightness) == pytest.approx(expected, rel=1e-12, abs=1e-15)


def test_the_envelope_falls_with_lightness():
    assert np.all(np.diff(max_contrast_gloss(np.linspace(0, 100, 1001))) < 0)


@given(st.floats(0, 100))
def test_the_envelope_itself_can_be_painted(lightness):
    paint = to_physical(lightness, max_contrast_gloss(lightness), 0.93)
    assert paint.rho_d + paint.rho_s == pytest.approx(1, abs=1e-12)  # rho_s is the inverse of c, to 1e-12


@given(lightness=st.floats(0, 99))
def test_nothing_beyond_the_envelope_can_be_painted(lightness):
    # From L* = 99 on the envelope is so flat that the relative step is below what c resolves.
    with pytest.raises(GlossError, match="is out of reach for rho_d = "):
        to_physical(lightness, max_contrast_gloss(lightness) * (1 + 1e-6), 0.93)


def test_fixed_energy_falls_with_lightness_and_stays_inside():
    """Section 4: for the same specular energy, contrast gloss is smaller for lighter objects."""
    lightness = np.linspace(0, 95, 96)
    c = fixed_energy_contrast_gloss(lightness, 0.099)
    assert np.all(np.diff(c) < 0)
    assert np.all(c <= max_contrast_gloss(lightness))


def test_fixed_energy_ends_where_the_envelope_does():
    with pytest.raises(GlossError, match=r"^Invalid rho_d \+ rho_s = 1\.099"):
        fixed_energy_contrast_gloss([50, 100], 0.099)


def test_impossible_lightness_is_refused():
    with pytest.raises(GlossError, match=r"^Invalid lightness = 101\.0"):
        max_contrast_gloss(101)
