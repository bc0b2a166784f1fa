"""Flux, scans, spectra and colour, against closed forms and colour-science."""

import colour
import numpy as np
import pytest

from glossspace import GlossError
from glossspace.instruments.apertures import Aperture
from glossspace.instruments.colorimetry import reflectance_factor_8_diffuse, reflectance_factor_45_0, spectrum_colour
from glossspace.instruments.figures import copper_spectrum, figure6, lobe_surface, polar_lobes, scan_figure
from glossspace.instruments.goniospectrophotometer import (
    Specimen,
    in_plane_scan,
    measured_brdf,
    out_of_plane_scan,
    reflected_flux,
    reflected_spectrum,
)
from glossspace.instruments.haze import distinctness_of_image, goniophotometric_haze, haze_by_difference
from glossspace.instruments.quadrature import mean_projection
from glossspace.instruments.refractive_index import index_tables, refractive_index
from glossspace.reflectance import CookTorrance, Lambert, Tabulated, Ward, direction

SOURCE, DETECTOR = Aperture(30, 180, 3, 5), Aperture(45, 0, 4, 4)
NM = np.arange(400.0, 701.0, 10.0)


class TestFlux:
    def test_eq_15_of_a_diffuse_sample(self):
        projected = [mean_projection(one) * one.solid_angle for one in (SOURCE, DETECTOR)]
        flux = reflected_flux(Lambert(0.6), SOURCE, DETECTOR, radiance=200.0, area=1e-4)
        assert flux == pytest.approx(0.6 / np.pi * 200 * 1e-4 * np.prod(projected), rel=1e-12)

    def test_spectral_radiance(self):
        flux = reflected_flux(Lambert([0.2, 0.4]), SOURCE, DETECTOR, radiance=[3.0, 1.0])
        assert flux[0] / flux[1] == pytest.approx(1.5, rel=1e-12)

    def test_a_specimen_is_the_mean_of_its_patches_by_area(self):
        specimen = Specimen((Ward(0.1, 0.1), Lambert(0.5)), (3.0, 1.0))
        parts = [measured_brdf(model, SOURCE, DETECTOR) for model in specimen.models]
        assert measured_brdf(specimen, SOURCE, DETECTOR) == pytest.approx(0.75 * parts[0] + 0.25 * parts[1], rel=1e-12)

    @pytest.mark.parametrize(
        ("call", "message"),
        [
            (lambda: Specimen((Lambert(0.5),), (1.0, 2.0)), "as many areas"),
            (lambda: Specimen((Lambert(0.5),), (0.0,)), "not all 0"),
            (lambda: Specimen((Lambert(0.5),), (float("nan"),)), "not all 0"),
            (lambda: reflected_flux(Lambert(0.5), SOURCE, DETECTOR, area=0), "area of the sample finite and above 0"),
            (lambda: reflected_flux(Lambert(0.5), SOURCE, DETECTOR, radiance=-1), "radiance must be finite and 0"),
            (lambda: reflected_flux(Lambert([0.5, 0.1]), SOURCE, DETECTOR, radiance=[1, 2, 3]), "has 3 wavelengths"),
        ],
    )
    def test_mistakes(self, call, message):
        with pytest.raises(GlossError, match=message):
            call()


class TestScans:
    def test_points_are_the_brdf_in_and_out_of_plane(self):
        model = CookTorrance(1.0, 0.2, 1.5, form="beckmann") + Lambert(0.1)
        plane = in_plane_scan(model, 40, [-60, 0, 40])
        wanted = [model.evaluate(direction(40, 180.0), direction(angle)) for angle in (-60.0, 0.0, 40.0)]
        np.testing.assert_allclose(plane["brdf"], wanted, rtol=1e-12)
        around = out_of_plane_scan(model, 40, 40, [0, 30, 180])
        wanted = [model.evaluate(direction(40, 180.0), direction(40, azimuth)) for azimuth in (0.0, 30.0, 180.0)]
        np.testing.assert_allclose(around["brdf"], wanted, rtol=1e-12)

    def test_azimuths_turn_the_way_that_tables_of_a_whole_turn_do(self):
        # azimuth 90 is a quarter beyond the mirror direction, so 270 from the source's own side
        axis, turn = [0.0, 90.0], np.array([0.0, 90.0, 180.0, 270.0, 360.0])
        table = Tabulated(axis, axis, turn, np.full((2, 2, 5), [0.1, 0.2, 0.3, 0.4, 0.1]))
        scan = out_of_plane_scan(table, 30, 40, [0, 90, 180, 270])
        assert scan["brdf"].tolist() == pytest.approx([0.3, 0.4, 0.1, 0.2], rel=1e-9)

    def test_finite_apertures_converge_to_the_brdf_as_the_square_of_their_width(self):
        model = Ward(0.1, 0.08)
        limit = in_plane_scan(model, 45, [40, 45, 52])["brdf"]
        errors = [
            in_plane_scan(model, 45, [40, 45, 52], source_widths_deg=(w, w), detector_widths_deg=(w, w))["brdf"]
            / limit - 1
            for w in (0.4, 0.2)
        ]  # fmt: skip
        np.testing.assert_allclose(errors[0] / errors[1], 4, rtol=0.02)  # (w/α)², the next order, is .8 %

    def test_channels_have_columns_and_figures_can_be_drawn(self, tmp_path):
        assert list(in_plane_scan(Lambert([0.1, 0.2]), 10, [0]).columns[-2:]) == ["brdf_0", "brdf_1"]
        scan = in_plane_scan(Ward(0.1, 0.1), 45, np.arange(-80.0, 81, 5))
        figures = {
            "scan": scan_figure(scan), "lobe": lobe_surface(Ward(0.1, 0.1), n=31), "six": figure6(),
            "polar": polar_lobes({"narrow": Ward(0.1, 0.02), "wide": CookTorrance(1.0, 0.5, 1.5)}),
        }  # fmt: skip
        for name, figure in figures.items():
            figure.savefig(tmp_path / f"{name}.svg")
            assert (tmp_path / f"{name}.svg").stat().st_size > 1000


class TestColour:
    @pytest.mark.parametrize("illuminant", ["A", "C", "D65"])
    @pytest.mark.parametrize(
        "observer", ["CIE 1931 2 Degree Standard Observer", "CIE 1964 10 Degree Standard Observer"]
    )
    def test_against_colour_science(self, illuminant, observer):
        nm = np.arange(360.0, 781.0, 1.0)
        factor = 0.3 + 0.2 * np.sin(nm / 60)
        found = spectrum_colour(factor, nm, illuminant=illuminant, observer=observer)
        with colour.utilities.suppress_warnings(colour_runtime_warnings=True):  # that it aligns the illuminant's steps
            xyz = colour.sd_to_XYZ(
                colour.SpectralDistribution(factor, nm), colour.MSDS_CMFS[observer],
                colour.SDS_ILLUMINANTS[illuminant], method="Integration",
            )  # fmt: skip
        # it interpolates the illuminants' 5 nm by Sprague's method, here linearly
        np.testing.assert_allclose(found.xyz, xyz, rtol=2e-3)
        white = colour.CCS_ILLUMINANTS[observer][illuminant]
        np.testing.assert_allclose(found.lab, colour.XYZ_to_Lab(xyz / 100, white), atol=0.15)

    def test_gray_has_no_hue_under_any_light(self):
        lab = spectrum_colour(np.full(31, 0.18418), NM, illuminant="A").lab
        assert lab == pytest.approx([50.0, 0, 0], abs=1e-3)  # CIELAB: Y = 18.418 is L* = 50

    def test_mistakes(self):
        with pytest.raises(GlossError, match="Unknown illuminant 'D99'"):
            spectrum_colour(np.ones(31), NM, illuminant="D99")
        with pytest.raises(GlossError, match="Unknown observer 'me'"):
            spectrum_colour(np.ones(31), NM, observer="me")
        with pytest.raises(GlossError, match="No data of illuminant D65 at 100 nm: the table covers"):
            spectrum_colour([1.0, 1.0], [100.0, 500.0])
        with pytest.raises(GlossError, match="got 31 and 2"):
            spectrum_colour([1.0, 1.0], NM)

    def test_standard_geometries(self):
        glossy = Lambert(0.4) + Ward(0.05, 0.005)
        # a gloss trap of 8 degrees takes the whole lobe, and a share of the diffuse light
        trap = Aperture(8, 180, 8, 8)
        diffuse = 0.4 * (1 - mean_projection(trap) * trap.solid_angle / np.pi)
        assert reflectance_factor_8_diffuse(glossy, specular_included=False) == pytest.approx(diffuse, abs=1e-5)
        included = reflectance_factor_8_diffuse(glossy)
        assert included == pytest.approx(0.4 + 0.05 * np.cos(np.radians(8)), abs=1e-4)  # Ward's lobe keeps ρs cosθ
        assert reflectance_factor_45_0(glossy) == pytest.approx(0.4, rel=1e-9)

    def test_annular_light_averages_an_anisotropic_lobe(self):
        brushed = Ward(0.5, 0.4, alpha_y=0.25)
        along, around = (reflectance_factor_45_0(brushed, n_azimuths=count) for count in (1, 60))
        across = reflectance_factor_45_0(Ward(0.5, 0.25, alpha_y=0.4))
        assert across < around < along
        # turned by a quarter, the sample has another 45°x:0° but the same 45°a:0°
        turned = reflectance_factor_45_0(Ward(0.5, 0.25, alpha_y=0.4), n_azimuths=60)
        assert turned == pytest.approx(float(around), rel=1e-6)  # of the quadrature


class TestCopper:
    def test_tables_state_where_they_come_from(self):
        n, k = refractive_index("copper_johnson_christy_1972", [582.1, 616.8])
        assert n.tolist() == [0.70, 0.30]  # Johnson and Christy 1972, table I: 2.13 and 2.01 eV
        assert k.tolist() == [2.704, 3.205]
        # figure 6 of the glossmeter paper: n = .47 at 589 nm
        n, k = refractive_index("copper_hagemann_1974", [590.4])
        assert n[0] == pytest.approx(0.468, abs=5e-4)
        assert k[0] == pytest.approx(2.81, abs=5e-4)

    def test_wavelengths_outside_are_refused_with_the_range(self):
        with pytest.raises(GlossError, match="at 2500 nm: the table covers 187.9 to 1937 nm"):
            refractive_index("copper_johnson_christy_1972", [500.0, 2500.0])
        with pytest.raises(GlossError, match="Unknown table 'gold'"):
            refractive_index("gold", [500.0])

    @pytest.mark.parametrize("table", index_tables())
    def test_figure_6(self, table):
        copper = copper_spectrum(table).set_index("wavelength_nm")
        np.testing.assert_allclose(copper["flux"], copper["illuminant"] * copper["reflectance_factor"], rtol=1e-14)
        assert copper["illuminant"][560.0] == pytest.approx(100, rel=1e-9)  # D65 is normalised there
        # copper is red: flat below 550 nm, and up by half to the red
        assert copper["reflectance_factor"][650.0] > 1.3 * copper["reflectance_factor"][500.0]
        assert copper["reflectance_factor"][500.0] == pytest.approx(copper["reflectance_factor"][450.0], rel=0.1)
        colours = spectrum_colour(copper["reflectance_factor"], copper.index.to_numpy())
        assert colours.lab[1] > 10
        assert colours.lab[2] > 10

    def test_a_spectrum_needs_a_channel_for_each_wavelength(self):
        with pytest.raises(GlossError, match="3 numbers, but the model has 2 channels"):
            reflected_spectrum(Lambert([0.1, 0.2]), [400.0, 500.0, 600.0], Aperture(0), Aperture(45))


class TestHaze:
    def test_a_wider_lobe_is_hazier_and_less_distinct(self):
        lobes = [CookTorrance(1.0, slope, 1.5, form="beckmann") for slope in (0.002, 0.005, 0.02)]
        assert np.all(np.diff([float(haze_by_difference(lobe)) for lobe in lobes]) > 0)
        assert np.all(np.diff([float(goniophotometric_haze(lobe)) for lobe in lobes]) > 0)
        assert np.all(np.diff([float(distinctness_of_image(lobe)) for lobe in lobes]) < 0)

    def test_points_give_the_closed_form(self):
        # Ward's lobe at half the offset: exp(-tan²(o/2)/α²), up to 1/sqrt(cos) of both sides, and cosθr
        alpha, offset = 0.01, 0.3
        found = distinctness_of_image(
            Ward(0.1, alpha), offset_deg=offset, source_widths_deg=(0, 0), detector_widths_deg=(0, 0)
        )
        closed = 100 * (1 - np.exp(-(np.tan(np.radians(offset / 2)) ** 2) / alpha**2))
        assert found == pytest.approx(closed, abs=1e-3)

    def test_mistakes(self):
        with pytest.raises(GlossError, match="Invalid offset_deg = 0"):
            goniophotometric_haze(Lambert(0.5), offset_deg=0)
        with pytest.raises(GlossError, match="reflects nothing in the mirror direction"):
            distinctness_of_image(Lambert(0.0))
