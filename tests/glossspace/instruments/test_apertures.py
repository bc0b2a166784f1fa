"""Apertures: where they are, how large, and what the horizon leaves of them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import dblquad

from glossspace import GlossError
from glossspace.instruments.apertures import Aperture
from glossspace.instruments.quadrature import mean_projection

PLACES = [(0, 0, 10, 20), (60, 0, 4.4, 11.7), (85, 30, 4, 6), (85, 0, 30, 6), (90, 0, 40, 40), (20, 180, 90, 90)]


@pytest.mark.parametrize("place", PLACES)
def test_solid_angle_and_projection_against_adaptive_integration(place):
    aperture = Aperture(*place)
    normal_along, normal_centre = aperture.frame[0, 2], aperture.frame[2, 2]

    def element(y, x):
        return (1 + x * x + y * y) ** -1.5

    def projected(y, x):
        return (normal_centre + x * normal_along) * (1 + x * x + y * y) ** -2

    limits = (*aperture.x_range, *aperture.y_range)
    solid = dblquad(element, *limits, epsabs=1e-13)[0]
    assert aperture.solid_angle == pytest.approx(solid, rel=1e-9)  # scipy's own tolerance is 1.5e-8, its error less
    wanted = dblquad(projected, *limits, epsabs=1e-13)[0] / solid
    assert mean_projection(aperture) == pytest.approx(wanted, rel=1e-9)


def test_a_small_aperture_is_width_times_width():
    # to second order in the widths, here 1e-3 rad
    aperture = Aperture(40, 10, np.degrees(1e-3), np.degrees(1e-3))
    assert aperture.solid_angle == pytest.approx(1e-6, rel=1e-6)
    assert mean_projection(aperture) == pytest.approx(np.cos(np.radians(40)), rel=1e-6)


def test_the_horizon_takes_half_of_an_aperture_on_it():
    assert Aperture(90, 0, 10, 10).solid_angle == pytest.approx(Aperture(0, 0, 10, 10).solid_angle / 2, rel=1e-14)
    assert Aperture(90, 0, 10, 10).touches_horizon
    assert not Aperture(85, 0, 9.9, 10).touches_horizon
    assert Aperture(85, 0, 10.1, 10).touches_horizon


@given(st.floats(-89, 89), st.floats(-360, 360), st.floats(0, 60), st.floats(0, 60), st.floats(-1, 1), st.floats(-1, 1))
def test_directions_are_unit_vectors_above_the_horizon_and_mirror_points_invert_them(theta, phi, w, v, s, t):
    aperture = Aperture(theta, phi, w, v)
    (x0, x1), (y0, y1) = aperture.x_range, aperture.y_range
    x, y = np.array([x0 + (s + 1) / 2 * (x1 - x0)]), np.array([y0 + (t + 1) / 2 * (y1 - y0)])
    directions, _ = aperture.directions(x, y)
    assert np.linalg.norm(directions) == pytest.approx(1, rel=1e-14)
    assert directions[0, 2] > -1e-12
    # the mirror image of the aperture is the aperture turned by half a turn
    image = Aperture(theta, phi + 180, w, v)
    back = image.mirror_points(directions)
    np.testing.assert_allclose([back[0], back[1]], [x, y], atol=1e-12)


def test_a_negative_angle_is_across_the_normal():
    np.testing.assert_allclose(Aperture(-30, 20).frame, Aperture(30, 200).frame, atol=1e-15)


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ((91,), "Invalid theta_deg = 91 of an aperture. Allowed: -90 to 90"),
        ((float("nan"),), "Invalid theta_deg = nan"),
        ((10, float("inf")), "Invalid phi_deg = inf"),
        ((10, 0, -1, 1), "Invalid width_in_plane_deg = -1"),
        ((10, 0, 1, 100), "Invalid width_across_deg = 100"),
        (("ten",), "Invalid theta_deg = 'ten'"),
        ((90, 0, 0, 10), "lies on the horizon"),
    ],
)
def test_impossible_apertures(place, message):
    with pytest.raises(GlossError, match=message):
        Aperture(*place)
