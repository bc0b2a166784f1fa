"""The glossmeter backwards, and across to the gloss space."""

from dataclasses import replace

import numpy as np
import pytest

from glossspace import GlossError
from glossspace.instruments.glossmeter import gloss_units
from glossspace.instruments.inversion import alike_parameters, invert_gloss
from glossspace.instruments.lobe_families import FAMILIES, Material
from glossspace.instruments.paint_gloss import alike_appearances, paint_from_gloss, paint_reading
from glossspace.metric import PAPER_SPACE, Paint
from glossspace.metric.forms import ContrastForm, DistinctnessForm
from glossspace.reflectance import CookTorrance, Lambert, Ward

ANGLES = (20, 60, 85)
CASES = [
    ("ward", 0.08, 0.06, Material(rho_d=0.2)),
    ("ward", 0.5, 0.2, Material()),
    ("beckmann", 0.9, 0.15, Material(rho_d=0.1, n=1.6)),
    ("cook-torrance", 21.5, 0.6, Material(n=1.32)),
]


def readings_of(family, amplitude, roughness, material, angles):
    model = FAMILIES[family].lobe(amplitude, roughness, material) + Lambert(material.rho_d)
    return {angle: float(gloss_units(model, angle)) for angle in angles}


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case[0]} {case[2]}")
class TestRoundTrips:
    @pytest.mark.parametrize("angles", [(20, 60), (60, 85), (20, 60, 85)])
    def test_two_and_three_readings_give_both_parameters(self, case, angles):
        family, amplitude, roughness, material = case
        found = invert_gloss(readings_of(*case, angles), family=family, material=material)
        assert found.exact
        # readings are good to 1e-6; 60 and 85 degrees tell amplitude and roughness apart some hundred times worse
        truth = pytest.approx((amplitude, roughness), rel=1e-3)
        assert any((fit.amplitude, fit.roughness) == truth for fit in found.fits)

    def test_one_reading_gives_the_one_that_is_not_known(self, case):
        family, amplitude, roughness, material = case
        readings = readings_of(*case, (60,))
        narrow = invert_gloss(readings, family=family, material=material, amplitude=amplitude)
        assert any(fit.roughness == pytest.approx(roughness, rel=1e-5) for fit in narrow.fits)
        # whatever else is found reads the same
        assert all(fit.worst_error_gu < 1e-4 for fit in narrow.fits)
        scaled = invert_gloss(readings, family=family, material=material, roughness=roughness)
        assert scaled.fits[0].amplitude == pytest.approx(amplitude, rel=1e-5)

    def test_the_truth_is_among_what_reads_alike(self, case):
        family, amplitude, roughness, material = case
        one = alike_parameters(readings_of(*case, (60,)), family=family, material=material)
        three = alike_parameters(readings_of(*case, ANGLES), family=family, material=material)
        kind = FAMILIES[family]
        at = np.argmin(np.abs(np.log(one[kind.roughness] / roughness)))
        # the table's steps in roughness are below 9 %
        assert one[f"{kind.amplitude}_low"][at] / 1.2 < amplitude < one[f"{kind.amplitude}_high"][at] * 1.2
        assert len(three) < len(one)

    def test_every_lobe_that_is_said_to_read_alike_does(self, case):
        family, _, _, material = case
        readings = readings_of(*case, (20, 60))
        kind = FAMILIES[family]
        rows = alike_parameters(readings, family=family, material=material, tolerance_gu=1.0)
        for row in rows.iloc[:: max(1, len(rows) // 3)].itertuples():
            for end in (f"{kind.amplitude}_low", f"{kind.amplitude}_high"):
                model = kind.lobe(getattr(row, end), getattr(row, kind.roughness), material) + Lambert(material.rho_d)
                for angle, reading in readings.items():
                    # the table is good to 1e-4
                    assert abs(float(gloss_units(model, angle)) - reading) <= 1.0 + 1e-3 * reading


class TestNumbers:
    """Values that a fit and a table of what reads alike state."""

    def test_a_fit_states_the_whole_albedo_at_60(self):
        paint = Lambert(0.2) + Ward(0.3, 0.15)
        readings = {angle: float(gloss_units(paint, angle)) for angle in (20, 60)}
        found = invert_gloss(readings, material=Material(rho_d=0.2))
        assert found.fits[0].albedo60 == pytest.approx(float(paint.albedo(60.0)), rel=1e-3)  # of the parameters
        assert found.fits[0].worst_error_gu == min(fit.worst_error_gu for fit in found.fits)

    def test_readings_a_tenth_apart_from_any_lobe_are_not_exact(self):
        readings = readings_of("ward", 0.3, 0.1, Material(), ANGLES)
        found = invert_gloss(readings | {85: readings[85] + 0.2})
        assert 0.01 < found.fits[0].worst_error_gu <= 0.2  # the lobe itself is .2 away
        assert not found.exact

    def test_a_ceiling_counts_the_diffuse_part(self):
        material = Material(rho_d=0.9)
        found = invert_gloss({60: 5.0}, amplitude=0.1, material=material)
        # the narrowest lobe of the table reads most: 100 ρs cosθ / F of a lobe within the detector
        highest = float(gloss_units(Lambert(0.9) + Ward(0.1, 0.002), 60))
        assert found.ceilings[60] == pytest.approx(highest, rel=1e-4)  # the table's tolerance

    @pytest.mark.parametrize("tolerance", [None, 1.0])
    def test_ends_of_what_reads_alike_read_a_tolerance_away(self, tolerance):
        given = {} if tolerance is None else {"tolerance_gu": tolerance}
        rows = alike_parameters({60: 10.0}, material=Material(rho_d=0.5), **given)
        row = rows[rows["alpha"] > 0.05].iloc[0]
        for end, sign in (("rho_s_low", -1), ("rho_s_high", 1)):
            read = float(gloss_units(Lambert(0.5) + Ward(row[end], row["alpha"]), 60))
            assert read == pytest.approx(10 + sign * (tolerance or 0.5), rel=1e-4)  # the table's tolerance
        assert alike_parameters({60: 40.0}, material=Material(rho_d=0.9))["rho_s_high"].max() <= 0.1 + 1e-12
        curve = alike_appearances({60: 10.0}, rho_d=0.5, **({"tolerance_gu": tolerance} if tolerance else {}))
        assert curve["rho_s_high"].tolist() == rows["rho_s_high"].tolist()

    def test_a_narrow_and_a_wide_lobe_that_read_alike_at_85_are_both_found(self):
        # a narrow Ward lobe reads little at 85 degrees, a very wide one spreads its light: between them is a maximum
        grid = np.geomspace(0.002, 0.6, 30)
        units = gloss_units(Ward(np.full(30, 0.5), grid), 85)
        inner = int(np.argmax(units))
        assert 0 < inner < 29
        reading = float(max(units[0], units[-1]) + 0.5 * (units[inner] - max(units[0], units[-1])))
        found = invert_gloss({85: reading}, amplitude=0.5)
        assert len(found.fits) == 2
        assert min(fit.roughness for fit in found.fits) < grid[inner] < max(fit.roughness for fit in found.fits)

    def test_wide_lobes_and_metals(self):
        wide = readings_of("ward", 0.5, 0.5, Material(), (60,))
        assert invert_gloss(wide, amplitude=0.5).fits[0].roughness == pytest.approx(0.5, rel=1e-5)
        metal = Material(n=0.65, k=2.81)
        readings = readings_of("beckmann", 0.8, 0.2, metal, (20, 60))
        found = invert_gloss(readings, family="beckmann", material=metal)
        assert any((fit.amplitude, fit.roughness) == pytest.approx((0.8, 0.2), rel=1e-3) for fit in found.fits)
        model = CookTorrance(0.8, 0.2, 0.65, 2.81, form="beckmann")
        assert readings[60] == pytest.approx(float(gloss_units(model, 60)), rel=1e-12)

    def test_a_material_is_of_index_one_and_a_half_unless_told(self):
        reading = float(gloss_units(CookTorrance(1.0, 0.2, 1.5, form="beckmann"), 60))
        found = invert_gloss({60: reading}, family="beckmann", roughness=0.2)
        assert found.fits[0].amplitude == pytest.approx(1, rel=1e-6)


class TestReach:
    def test_a_ward_lobe_of_a_tenth_cannot_read_60_at_60(self):
        # science notes on the gonio-apparent paper: its ceiling is about 50 = 100 ρs cosθ / F
        with pytest.raises(GlossError, match=r"60 gloss units at 60 degrees are out of reach .* ceiling is 50\."):
            invert_gloss({60: 60.0}, amplitude=0.1)

    def test_a_bright_base_reads_more_than_that(self):
        # Lambert's closed form: 100 (.9/π) ω cosθ / F = 100 · .2865 · .01565 · .5 / .1001 = 2.24
        with pytest.raises(GlossError, match="it reads 2.41 or more, of which 2.24 are the diffuse part"):
            invert_gloss({60: 1.0}, amplitude=0.05, material=Material(rho_d=0.9))

    def test_readings_that_no_lobe_gives_together_are_met_as_well_as_can_be(self):
        found = invert_gloss({20: 59.4, 60: 73.7, 85: 96.9})  # table 2's glass, where Ward fails at 85 degrees
        assert not found.exact
        assert found.fits[0].worst_error_gu > 10
        assert found.ceilings[85] < 15

    def test_energy_of_the_fit_is_known(self):
        found = invert_gloss({60: 36.8, 85: 20.1}, family="cook-torrance", material=Material(n=0.65, k=2.81))
        assert found.fits[0].albedo60 > 1

    @pytest.mark.parametrize(
        ("call", "message"),
        [
            (lambda: invert_gloss({}), "Readings need one to three"),
            (lambda: invert_gloss({45: 1.0}), r"got \[45\]"),
            (lambda: invert_gloss({60: float("nan")}, amplitude=0.1), "Invalid reading nan at 60"),
            (lambda: invert_gloss({60: -1.0}, amplitude=0.1), "Invalid reading -1.0 at 60"),
            (lambda: invert_gloss({60: 10.0}), "One reading does not tell two unknowns. Give rho_s or alpha"),
            (lambda: invert_gloss({60: 10.0}, amplitude=0.1, roughness=0.1), "nothing is left to find"),
            (lambda: invert_gloss({60: 10.0}, amplitude=1.5), "Invalid rho_s = 1.5. Allowed: above 0 to 1"),
            (lambda: invert_gloss({60: 10.0}, roughness=2.0), "Invalid alpha = 2.0. Allowed: 0.002 to 0.6"),
            (lambda: invert_gloss({60: 10.0}, family="phong"), "Unknown family 'phong'"),
            (lambda: invert_gloss({60: 10.0}, amplitude=0.1, material=Material(rho_d=2)), "Invalid rho_d = 2"),
            (lambda: alike_parameters({60: 10.0}, tolerance_gu=0), "Invalid tolerance_gu = 0"),
        ],
    )
    def test_mistakes(self, call, message):
        with pytest.raises(GlossError, match=message):
            call()


class TestGlossSpace:
    def test_readings_give_the_paint_and_its_c_and_d_back(self):
        paint = Paint(0.193, 0.066, 0.07)
        reading = paint_reading(paint)
        found = paint_from_gloss({20: float(reading.gu20), 60: float(reading.gu60)}, rho_d=0.193)
        assert found.paint.rho_s == pytest.approx(0.066, rel=1e-4)
        assert found.paint.alpha == pytest.approx(0.07, rel=1e-4)
        # the gloss paper's figure 11: c = .087, d = .93
        assert float(found.appearance.c) == pytest.approx(0.08702, abs=1e-5)
        assert float(found.appearance.d) == pytest.approx(0.93, abs=1e-5)

    def test_one_reading_and_the_roughness_give_the_paint(self):
        reading = float(paint_reading(Paint(0.193, 0.066, 0.07)).gu60)
        found = paint_from_gloss({60: reading}, rho_d=0.193, alpha=0.07)
        assert found.paint.rho_s == pytest.approx(0.066, rel=1e-5)

    def test_c_and_d_are_of_the_space_that_is_asked_for(self):
        space = replace(
            PAPER_SPACE, contrast_form=ContrastForm(exponent=0.5), distinctness_form=DistinctnessForm(exponent=0.5)
        )
        paint = Paint(0.193, 0.066, 0.07)
        reading = {60: float(paint_reading(paint).gu60)}
        found = paint_from_gloss(reading, rho_d=0.193, alpha=0.07, space=space)
        c, d = (float(value) for value in space.coordinates(paint))
        assert (float(found.appearance.c), float(found.appearance.d)) == pytest.approx((c, d), rel=1e-4)
        rows = alike_appearances(reading, rho_d=0.193, space=space)
        row = rows.iloc[len(rows) // 2]
        c, d = (float(value) for value in space.coordinates(Paint(0.193, row["rho_s_low"], row["alpha"])))
        assert (row["c_low"], row["d"]) == pytest.approx((c, d), rel=1e-12)

    def test_one_reading_leaves_a_curve_through_the_paint(self):
        reading = float(paint_reading(Paint(0.193, 0.066, 0.07)).gu60)
        rows = alike_appearances({60: reading}, rho_d=0.193, tolerance_gu=0.3)
        c, d = PAPER_SPACE.coordinates(Paint(0.193, 0.066, 0.07))
        near = rows.iloc[(rows["d"] - d).abs().argmin()]
        assert near["c_low"] - 0.01 < c < near["c_high"] + 0.01  # the table's step in roughness is 6 %
        assert rows["d"].max() - rows["d"].min() > 0.3  # so a glossmeter's one number says little of d
