"""Haze and distinctness of image against closed forms of lobes and apertures."""

import numpy as np
import pytest
from scipy.special import erf

from glossspace.instruments.apertures import Aperture
from glossspace.instruments.glossmeter import mirror_gloss_units
from glossspace.instruments.haze import distinctness_of_image, goniophotometric_haze, haze_by_difference
from glossspace.instruments.quadrature import mean_projection
from glossspace.reflectance import CookTorrance, Lambert, Ward

POINT = (0.0, 0.0)


def test_the_difference_of_a_mirror_is_that_of_its_two_gloss_values():
    lobe = CookTorrance(1.0, 0.001, 1.5, form="beckmann")
    closed = mirror_gloss_units(60, n=1.5) - mirror_gloss_units(20, n=1.5)
    assert haze_by_difference(lobe) == pytest.approx(float(closed), rel=1e-3)  # slopes of .001: 1e-4 of either reading


def test_both_sides_count():
    # points of a diffuse sample: (cos 28° + cos 32°) / 2 cos 30° = cos 2°
    found = goniophotometric_haze(Lambert(0.5), source_widths_deg=POINT, detector_widths_deg=POINT)
    assert found == pytest.approx(100 * np.cos(np.radians(2)), rel=1e-12)


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("which", ["source_widths_deg", "detector_widths_deg"])
def test_a_slit_in_plane_blurs_the_lobe_and_one_across_does_less(which, axis):
    # Ward's lobe by the slopes of half vectors: offset/2 in plane; across, half the projection on the half vector.
    alpha, offset, width = 0.01, np.radians(2.0), np.radians(1.5)
    widths = {"source_widths_deg": POINT, "detector_widths_deg": POINT, which: (1.5, 0.0) if axis == 0 else (0.0, 1.5)}
    found = goniophotometric_haze(Ward(0.1, alpha), **widths) / 100
    if axis == 0:
        scale = 2 * alpha

        def mean(at):
            return (erf((at + width / 2) / scale) - erf((at - width / 2) / scale)) * np.sqrt(np.pi) * scale / width / 2

        closed = mean(offset) / mean(0.0)
    else:
        closed = np.exp(-((offset / 2 / alpha) ** 2))  # a Gaussian's parts along and across multiply
    # Angles for tangents, and sqrt(cosθ) over 2 degrees: (.035 tan 30°)² = 4e-4. A point y of the slit across is
    # y² tan 30° / 2 = 4e-5 nearer in plane at y = .013, of .035, which moves exp(-3.05) by 2 · 3.05 · 1e-3.
    assert found == pytest.approx(closed, rel=7e-3)


def test_a_side_that_the_horizon_cuts_gives_less_flux():
    # the detector at 80 + 9 degrees is cut at 90: fluxes of a diffuse sample are the projected solid angles
    places = {at: Aperture(at, 0, 4, 4) for at in (71, 80, 89)}
    flux = {at: mean_projection(place) * place.solid_angle for at, place in places.items()}
    found = goniophotometric_haze(Lambert(0.5), angle_deg=80, offset_deg=9, detector_widths_deg=(4, 4))
    assert found == pytest.approx(50 * (flux[71] + flux[89]) / flux[80], rel=1e-9)


def test_what_is_measured_unless_told():
    # the offsets in common use and round apertures that the module's text states
    lobe = Ward(0.1, 0.01)
    settings = {"angle_deg": 30, "source_widths_deg": (0.4, 0.4), "detector_widths_deg": (0.4, 0.4)}
    assert goniophotometric_haze(lobe) == goniophotometric_haze(lobe, offset_deg=2.0, **settings)
    settings |= {"source_widths_deg": (0.1, 0.1), "detector_widths_deg": (0.1, 0.1)}
    assert distinctness_of_image(lobe) == distinctness_of_image(lobe, offset_deg=0.3, **settings)
