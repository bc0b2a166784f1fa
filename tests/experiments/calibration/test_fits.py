"""Known screens are recovered from their readings, and what cannot be fitted is refused in clear words."""

import numpy as np
import pytest
from colour.colorimetry import lightness_CIE1976
from scipy.stats import linregress
from scipy.stats import t as student

from gloss_experiments.calibration import (
    Patch,
    SimulatedScreen,
    fit_gain_offset_gamma,
    fit_screen,
    fit_table,
    standard_patches,
    verify,
)
from gloss_experiments.calibration.fit_table import CHANNELS
from gloss_experiments.calibration.gain_offset_gamma import _half_widths
from gloss_experiments.calibration.lightness import lightness_of_luminance
from glossspace.display import DisplayModel
from glossspace.errors import GlossError
from tests.experiments.calibration.screens import PAPER, SKEWED, changed, gray_only, readings_of


def fitted(screen=PAPER, names=("gray",), **noise):
    return fit_gain_offset_gamma(fit_table(readings_of(screen, **noise).of("fit"), top=255), names, top=255)


class TestGainOffsetGamma:
    def test_the_papers_display(self):
        found = fitted()
        gray = found.curves["gray"]
        assert found.black_cd_m2 == pytest.approx(0.7, abs=1e-6)
        assert gray.range_cd_m2 == pytest.approx(108 - 0.7, abs=1e-6)
        assert (gray.gamma, gray.offset) == pytest.approx((2.35, 0), abs=1e-6)
        codes = np.arange(256)
        # 1e-6 of a luminance up to 108: what the parameters may be off by.
        assert found.gray_cd_m2(codes) == pytest.approx(DisplayModel().luminance(codes), abs=1e-6)

    def test_three_channels_with_positive_and_negative_offsets(self):
        found = fitted(SKEWED, CHANNELS)
        for name, gamma, offset, share in zip(CHANNELS, SKEWED.gamma, SKEWED.offset, SKEWED.shares, strict=True):
            curve = found.curves[name]
            assert (curve.gamma, curve.offset) == pytest.approx((gamma, offset), abs=1e-6)
            assert curve.range_cd_m2 == pytest.approx(share * 107.3, abs=1e-6)
            assert curve.gain + curve.offset == 1

    def test_as_psychopy_fits_a_gamma(self):
        """Its GammaCalculator knows no offset: ``min + (max - min) x^gamma`` through the same readings."""
        from psychopy.monitors import GammaCalculator

        screen = SimulatedScreen(gamma=(2.1,) * 3)
        readings = [one for one in readings_of(screen).of("fit") if one.patch.is_gray]
        shares = np.array([one.patch.red / 255 for one in readings])
        theirs = GammaCalculator(inputs=shares, lums=np.array([one.luminance_cd_m2 for one in readings]), eq=1)
        # Its simplex search ends where gamma is known to about 1e-8; without noise both see the same power.
        assert fitted(screen).curves["gray"].gamma == pytest.approx(theirs.gamma, abs=1e-6)

    def test_intervals_cover_what_they_should(self):
        """95 % of 400 intervals, within four binomial standard errors (1.1 % each): one seed in 16,000 fails."""
        truth = {"gamma": 2.35, "offset": 0.0, "range_cd_m2": 107.3}
        covered = dict.fromkeys((*truth, "black"), 0)
        for seed in range(400):
            found = fitted(patches=gray_only(), noise=0.005, digit_cd_m2=0.0005, seed=seed)
            curve = found.curves["gray"]
            for name, true in truth.items():
                half = getattr(curve, f"{name.removesuffix('_cd_m2')}_half_width")
                covered[name] += abs(getattr(curve, name) - true) <= half
            covered["black"] += abs(found.black_cd_m2 - 0.7) <= found.black_half_width
        assert all(0.95 - 0.044 <= count / 400 <= 0.95 + 0.044 for count in covered.values()), covered

    def test_residuals_tell_the_photometers_error(self):
        found = fitted(patches=gray_only(), noise=0.01, seed=3)
        # 17 readings less 4 parameters: a standard deviation of 1 % is known to a fifth, taken threefold; the weights
        # (reading plus a thousandth of white) take off up to an eighth of it at black.
        assert found.rms_relative == pytest.approx(0.01, rel=0.6)
        # And by hand, from what the model gives at each reading.
        readings = readings_of(patches=gray_only(), noise=0.01, seed=3).of("fit")
        read = np.array([one.luminance_cd_m2 for one in readings])
        given = found.gray_cd_m2([one.patch.red for one in readings])
        by_hand = np.sqrt(np.mean(((given - read) / (read + read.max() / 1000)) ** 2))
        assert found.rms_relative == pytest.approx(by_hand, rel=1e-9)  # rounding

    def test_intervals_of_a_straight_line(self):
        """A line is its own linearisation: the intervals are those of ordinary least squares, which scipy works out."""
        x = np.linspace(0, 3, 7)
        y = 2 * x + np.array([0.1, -0.2, 0.05, 0.3, -0.1, -0.25, 0.1])
        line = linregress(x, y)
        residuals = y - line.intercept - line.slope * x
        found = _half_widths(np.column_stack([np.ones(7), x]), residual_sum=float(residuals @ residuals))
        expected = student.ppf(0.975, 5) * np.array([line.intercept_stderr, line.stderr])
        assert found == pytest.approx(expected, rel=1e-9)  # rounding of a 2 x 2 inverse

    def test_as_many_readings_as_parameters_leave_no_interval(self):
        codes = (0, 100, 180, 220, 255)
        patches = [Patch(purpose="fit", position="centre", red=c, green=c, blue=c) for c in codes]
        found = fitted(patches=patches, noise=0.005)
        assert np.isfinite(found.curves["gray"].gamma_half_width), "five readings, four parameters"


class TestChoice:
    def test_a_power_law_is_fitted_by_one(self):
        models = fit_screen(readings_of())
        assert models[0][0].name == "gain-offset-gamma of gray"
        assert len(models) == 4
        # Rounding of luminances near 100 in double precision.
        assert models[0][1].largest_delta_l < 1e-9

    def test_a_screen_that_is_no_power_law_is_interpolated(self):
        """An S-curve, as liquid crystals have before their correction."""

        def s_curve(patch, _):
            x = np.array(patch.codes) / 255
            return 0.5 + float(np.dot((20.0, 70.0, 10.0), 0.5 - 0.5 * np.cos(np.pi * x**1.8)))

        readings = changed(readings_of(), s_curve)
        models = fit_screen(readings)
        assert models[0][0].name == "interpolation of gray"
        residuals = {model.name: verification.rms_delta_l for model, verification in models}
        assert residuals["interpolation of gray"] < 0.5 < residuals["gain-offset-gamma of gray"]

    def test_channels_decide_where_gray_was_read_less_well(self):
        def spoilt(patch, luminance):
            return luminance * (1.02 if patch.purpose == "fit" and patch.is_gray and patch.red > 100 else 1)

        assert fit_screen(changed(readings_of(SKEWED), spoilt))[0][0].name == "gain-offset-gamma of the channels"

    def test_verification_patches_are_not_in_the_fit(self):
        first = fit_screen(readings_of())[0]
        shifted = changed(readings_of(), lambda patch, value: value * (1.1 if patch.purpose == "verify" else 1))
        again = {model.name: (model, verification) for model, verification in fit_screen(shifted)}
        model, verification = again[first[0].name]
        assert model.table == first[0].table
        assert verification.error_percent == pytest.approx([10.0] * 8, abs=1e-6)

    def test_residuals_by_hand(self):
        model = fit_screen(readings_of())[0][0]
        readings = changed(readings_of(), lambda patch, value: value + 0.25 if patch.purpose == "verify" else None)
        found = verify(model, readings.items, white_cd_m2=108.0)
        predicted = np.array([DisplayModel().luminance(codes[0]) for codes in found.codes])
        assert found.predicted_cd_m2 == pytest.approx(predicted, abs=1e-6)
        assert found.error_cd_m2 == pytest.approx([0.25] * 8, abs=1e-6)
        assert found.error_percent == pytest.approx(25 / predicted, rel=1e-6)
        expected = lightness_CIE1976((predicted + 0.25) / 1.08) - lightness_CIE1976(predicted / 1.08)
        # colour-science subtracts 16 from a number near it where the curve is straight: 1e-12 is lost.
        assert found.delta_l == pytest.approx(expected, abs=1e-6)
        assert found.rms_delta_l == pytest.approx(np.sqrt(np.mean(expected**2)), abs=1e-6)

    def test_colours_are_verified_by_the_channels(self):
        colour = Patch(purpose="verify", position="centre", red=200, green=80, blue=30)
        found = {m.name: v for m, v in fit_screen(readings_of(patches=[*standard_patches(), colour]))}
        assert len(found["gain-offset-gamma of the channels"].codes) == 9
        assert len(found["gain-offset-gamma of gray"].codes) == 8
        # A colour is told with the others, but the models are compared by gray, which all of them predict.
        skewed = changed(
            readings_of(patches=[*standard_patches(), colour]),
            lambda patch, value: value * (1.5 if patch == colour else 1),
        )
        spoilt = {m.name: v for m, v in fit_screen(skewed)}["gain-offset-gamma of the channels"]
        assert max(map(abs, spoilt.error_percent)) == pytest.approx(50, abs=1e-6)
        assert max(spoilt.rms_delta_l, spoilt.rms_percent, spoilt.largest_delta_l) < 1e-6
        assert found["gain-offset-gamma of the channels"].error_cd_m2[-1] == pytest.approx(0, abs=1e-6)

    def test_gray_alone_is_enough(self):
        models = fit_screen(readings_of(patches=gray_only()))
        assert [model.name for model, _ in models] == ["gain-offset-gamma of gray", "interpolation of gray"]

    def test_channels_alone_are_enough(self):
        patches = [one for one in standard_patches() if one.purpose != "fit" or not one.is_gray or one.red == 0]
        models = fit_screen(readings_of(SKEWED, patches=patches))
        assert {model.name.partition(" of ")[2] for model, _ in models} == {"the channels"}
        assert models[0][1].largest_delta_l < 1e-6

    def test_an_interpolation_passes_through_its_readings(self):
        readings = readings_of(noise=0.003)
        model = next(m for m, _ in fit_screen(readings) if m.name == "interpolation of gray")
        gray = [one for one in readings.of("fit") if one.patch.is_gray]
        assert model.display.luminance([one.patch.red for one in gray]) == pytest.approx(
            [one.luminance_cd_m2 for one in gray], abs=1e-12
        )

    def test_a_dip_of_noise_leaves_the_interpolation_out(self):
        dipped = changed(readings_of(), lambda p, v: 0.69 if p.purpose == "fit" and p.codes == (16, 16, 16) else v)
        names = {model.name for model, _ in fit_screen(dipped)}
        assert "interpolation of gray" not in names
        assert "gain-offset-gamma of gray" in names

    def test_a_cut_off_foot_gives_a_table_that_rises(self):
        models = fit_screen(readings_of(SimulatedScreen(offset=(-0.1,) * 3), patches=gray_only()))
        table = models[0][0].table
        assert models[0][0].name == "gain-offset-gamma of gray"
        assert table.codes[0] == 0
        # (1 + 0.1) x - 0.1 is above 0 from x = 1/11 on, code 23.2.
        assert table.codes[1] == 24

    def test_codes_of_16_bits(self):
        screen = SimulatedScreen(bits=16)
        model, verification = fit_screen(readings_of(screen, patches=standard_patches(bits=16)), bits=16)[0]
        assert verification.largest_delta_l < 1e-6
        assert model.display.bits == 16
        assert model.display.luminance(32768) == pytest.approx(0.7 + 107.3 * (32768 / 65535) ** 2.35, rel=1e-4)


def test_lightness_as_colour_science_has_it():
    luminance = np.array([0.0, 0.2, 0.7, 1.0, 10.0, 50.0, 108.0, 115.0])
    # Above the straight foot; below it colour-science loses digits to a subtraction.
    assert lightness_of_luminance(luminance, white_cd_m2=108.0) == pytest.approx(
        lightness_CIE1976(luminance / 1.08), abs=1e-10
    )


def leave_out(*channels):
    def change(patch, luminance):
        lit = [name for name in CHANNELS if getattr(patch, name)]
        return None if patch.purpose == "fit" and lit in [[name] for name in channels] else luminance

    return change


def gray_levels(*kept):
    return lambda p, v: None if p.purpose == "fit" and (not p.is_gray or p.red not in kept) else v


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda p, v: None if p.purpose == "fit" else v, "no readings of the purpose 'fit'"),
        (lambda p, v: None if p.purpose == "fit" and p.codes == (0, 0, 0) else v, "no reading of black"),
        (gray_levels(0), "readings of black alone"),
        (leave_out("blue"), "no reading of blue alone, but of another channel"),
        (leave_out("red", "green"), "no reading of red or green alone"),
        (gray_levels(0, 128, 191, 255), "has 4 levels of gray, black included, but needs 5"),
        (gray_levels(0, 64, 128, 191, 223), "brightest gray of the fit is code 223, but the screen reaches 255"),
        (lambda p, v: 20.0 if p.codes == (207, 207, 207) else v, "luminance of gray falls from .* to 20 .* code 207"),
        (lambda p, v: min(v, 80.0), "saturated. Lower the screen's contrast"),
        (lambda p, v: 0.7, "it is saturated"),
        (lambda p, v: None if p.purpose == "verify" else v, "0 gray readings of the purpose 'verify', but 3"),
        (lambda p, v: None if p.purpose == "verify" and p.red > 40 else v, "2 gray readings of the purpose 'verify'"),
    ],
)  # fmt: skip
def test_readings_that_make_no_fit(change, message):
    with pytest.raises(GlossError, match=message):
        fit_screen(changed(readings_of(), change))


def test_patches_that_make_no_fit():
    def with_patch(**patch):
        return readings_of(patches=[*standard_patches(), Patch(**patch)])

    with pytest.raises(GlossError, match="stood at the positions centre, left"):
        fit_screen(with_patch(purpose="fit", position="left", red=9, green=9, blue=9))
    with pytest.raises(GlossError, match="is neither gray nor one channel alone"):
        fit_screen(with_patch(purpose="fit", position="centre", red=9, green=9, blue=0))
    with pytest.raises(GlossError, match=r"verification patch \(64, 64, 64\) is one of the fit too"):
        fit_screen(with_patch(purpose="verify", position="centre", red=64, green=64, blue=64))
    with pytest.raises(GlossError, match="stood at 'full', but the fit at 'centre'"):
        fit_screen(with_patch(purpose="verify", position="full", red=9, green=9, blue=9))
    with pytest.raises(GlossError, match="8 or 16 bits, but bits is 10"):
        fit_screen(readings_of(), bits=10)
