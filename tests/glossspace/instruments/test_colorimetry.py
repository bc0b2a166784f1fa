"""Colour and its two geometries against printed values and closed forms."""

import numpy as np
import pytest

from glossspace.instruments.apertures import Aperture
from glossspace.instruments.colorimetry import reflectance_factor_8_diffuse, reflectance_factor_45_0, spectrum_colour
from glossspace.instruments.goniospectrophotometer import in_plane_scan, measured_brdf, reflected_spectrum
from glossspace.instruments.quadrature import mean_projection
from glossspace.reflectance import Lambert, Tabulated, Ward


def test_white_of_the_default_light_and_observer():
    # CIE 15: D65 and the 2 degree observer; C has Z = 118.22, the 10 degree observer 107.32
    white = spectrum_colour(np.ones(421), np.arange(360.0, 781.0))
    assert white.xyz == pytest.approx([95.04, 100.0, 108.88], abs=0.03)  # sums of 1 nm, the tail above 780 left out


def test_wavelengths_at_unequal_steps():
    nm = np.array([400.0, 410, 450, 455, 500, 540, 545, 600, 660, 700])
    assert spectrum_colour(np.full(10, 0.5), nm).xyz[1] == pytest.approx(50, rel=1e-12)


def test_45_0_of_points_is_wards_equation():
    # half vector at 22.5 degrees: eq. 14 of the glossmeter paper, times π
    found = reflectance_factor_45_0(Ward(0.5, 0.4), source_width_deg=0.0, detector_width_deg=0.0)
    closed = 0.5 * np.exp(-(np.tan(np.radians(22.5)) ** 2) / 0.4**2) / (4 * 0.4**2 * np.sqrt(np.cos(np.radians(45))))
    assert found == pytest.approx(closed, rel=1e-12)


def test_45_0_has_a_source_and_a_detector_of_their_own():
    lobe = Ward(0.5, 0.4)
    brdf = measured_brdf(lobe, Aperture(45, 0, 20, 20), Aperture(0, 0, 2, 2))
    found = reflectance_factor_45_0(lobe, source_width_deg=20.0, detector_width_deg=2.0)
    assert found == pytest.approx(np.pi * float(brdf), rel=1e-12)
    assert reflectance_factor_45_0(lobe) == reflectance_factor_45_0(lobe, source_width_deg=4.0, detector_width_deg=4.0)


def test_light_goes_from_8_degrees_into_the_trap():
    """A table that is not reciprocal: light from below 15 degrees is spread evenly, all other light is lost."""
    axis = np.array([0.0, 14.0, 15.0, 90.0])
    values = np.zeros((4, 4, 2))
    values[:2] = 0.5 / np.pi  # by angle of incidence first
    sample = Tabulated(axis, axis, [0.0, 180.0], values)
    trap = Aperture(8, 180, 30, 30)  # which reaches beyond 15 degrees
    kept = 0.5 * (1 - mean_projection(trap) * trap.solid_angle / np.pi)
    found = reflectance_factor_8_diffuse(sample, specular_included=False, trap_width_deg=30.0)
    assert found == pytest.approx(kept, rel=1e-6)  # the albedo's and the trap's own quadratures


def test_a_scan_measures_with_its_own_apertures():
    lobe, widths = Ward(0.1, 0.02), {"source_widths_deg": (1.0, 2.0), "detector_widths_deg": (3.0, 0.5)}
    scan = in_plane_scan(lobe, 45, [44.0, 47.0], **widths)
    single = [measured_brdf(lobe, Aperture(45, 180, 1, 2), Aperture(at, 0, 3, 0.5)) for at in (44, 47)]
    np.testing.assert_array_equal(scan["brdf"], single)


def test_a_spectrum_of_a_perfect_white_is_the_light():
    # CIE 15: D65 is 109.354 at 500 nm and 100 at 560 nm
    found = reflected_spectrum(Lambert([1.0, 0.5]), [500.0, 560.0], Aperture(0), Aperture(45))
    assert found["reflectance_factor"].tolist() == pytest.approx([1.0, 0.5], rel=1e-12)
    assert found["flux"].tolist() == pytest.approx([109.354, 50.0], abs=5e-4)  # as printed
