"""What the standards prescribe, as printed."""

import pytest

from glossspace.instruments.refractive_index import refractive_index
from glossspace.instruments.standards import glossmeter_geometry, illuminant_spectrum, luminous_efficiency


def test_light_and_eye_between_the_rows_of_their_tables():
    # CIE 15: D65 is 102.023 at 555 nm and 100 at 560; CIE 18.2: V(λ) is .999856 at 551, .9998 at 552 (per nm)
    assert illuminant_spectrum("D65", [556.0])[0] == pytest.approx(102.023 - 2.023 / 5, abs=1e-3)
    low, middle, high = luminous_efficiency([500.0, 500.5, 501.0])
    assert middle == pytest.approx((low + high) / 2, rel=1e-12)


def test_an_index_between_the_rows_of_its_table():
    # Johnson and Christy 1972, table I: n = .70 and .30, k = 2.704 and 3.205 at 582.1 and 616.8 nm
    n, k = refractive_index("copper_johnson_christy_1972", [599.45])
    assert (n[0], k[0]) == pytest.approx((0.5, 2.9545), rel=1e-9)


@pytest.mark.parametrize(
    ("angle", "detector"),
    [(20, (1.8, 3.6)), (60, (4.4, 11.7)), (85, (4.0, 6.0))],
)
def test_apertures_of_the_glossmeter_papers_table_1(angle, detector):
    geometry = glossmeter_geometry(angle)
    assert (geometry.source.width_in_plane_deg, geometry.source.width_across_deg) == (0.75, 2.5)
    assert (geometry.detector.width_in_plane_deg, geometry.detector.width_across_deg) == detector
    assert (geometry.source.theta_deg, geometry.source.phi_deg, geometry.detector.phi_deg) == (angle, 180, 0)
