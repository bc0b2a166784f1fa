import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from glossspace.display import DisplayModel, LuminanceTable
from glossspace.errors import GlossError

MEASURED = LuminanceTable(codes=(0, 32, 64, 128, 192, 255), gray_cd_m2=(0.7, 1.6, 4.9, 21.9, 55.8, 108.0))


@st.composite
def displays(draw: st.DrawFn) -> DisplayModel:
    """Displays with a gamma and measured ones, of 8 and of 16 bits."""
    bits = draw(st.sampled_from([8, 16]))
    black = draw(st.floats(0.01, 2.0))
    if draw(st.booleans()):
        white = black * draw(st.floats(30, 2000))
        return DisplayModel(black_cd_m2=black, white_cd_m2=white, gamma=draw(st.floats(1.0, 3.0)), bits=bits)
    steps = draw(st.lists(st.floats(0.01, 50), min_size=1, max_size=12))
    codes = np.linspace(0, 2**bits - 1, len(steps) + 1).astype(int)
    table = LuminanceTable(codes=tuple(codes.tolist()), gray_cd_m2=tuple((black + np.cumsum([0.0, *steps])).tolist()))
    return DisplayModel.from_table(table, bits=bits)


def test_the_papers_monitor_is_the_default() -> None:
    display = DisplayModel()
    assert display.contrast == pytest.approx(108 / 0.7)
    assert display.luminance([0, 255]).tolist() == [0.7, 108.0]
    # Half the code values: 0.7 + 107.3 (128/255)^2.35, by hand with logarithms.
    assert float(display.luminance(128)) == pytest.approx(0.7 + 107.3 * np.exp(2.35 * np.log(128 / 255)), rel=1e-14)


@given(displays())
def test_every_code_value_comes_back(display: DisplayModel) -> None:
    codes = np.arange(2**display.bits)
    assert (display.codes(display.luminance(codes)) == codes).all()


@given(displays(), st.floats(0, 1))
def test_rounding_is_at_most_half_a_code(display: DisplayModel, share: float) -> None:
    luminance = display.black_cd_m2 + share * (display.white_cd_m2 - display.black_cd_m2)
    exact = float(display.exact_codes(luminance))
    assert 0 <= exact <= 255
    for bits, largest in ((8, 255), (16, 65535)):
        # 1e-11: rounding of the product with 65535/255 and of the sum with 0.5.
        assert abs(float(display.codes(luminance, bits=bits)) - exact * largest / 255) <= 0.5 + 1e-11
    # Exact codes are in 8-bit units whatever the display's own. Luminance comes back to rounding of the white.
    assert float(display.luminance(exact, bits=8)) == pytest.approx(luminance, abs=1e-13 * display.white_cd_m2)


@given(displays(), st.lists(st.floats(0, 1), min_size=2, max_size=20))
def test_brighter_is_never_a_smaller_code(display: DisplayModel, shares: list[float]) -> None:
    luminance = display.black_cd_m2 + np.sort(shares) * (display.white_cd_m2 - display.black_cd_m2)
    assert (np.diff(display.exact_codes(luminance)) >= 0).all()


@given(displays())
def test_json_holds_all_there_is(display: DisplayModel) -> None:
    assert DisplayModel.from_dict(json.loads(json.dumps(display.to_dict()))) == display


def test_codes_have_the_type_of_their_bits() -> None:
    display = DisplayModel(bits=16)
    assert display.codes([0.7, 108.0]).tolist() == [0, 65535]
    assert display.codes(1.0).dtype == np.uint16
    assert display.codes([0.7, 108.0], bits=8).tolist() == [0, 255]
    assert display.codes(1.0, bits=8).dtype == np.uint8


def test_luminance_beyond_the_display_is_held_at_its_ends_and_counted() -> None:
    for display in (DisplayModel(), DisplayModel.from_table(MEASURED)):
        assert display.codes([-1.0, 0.0, 1000.0]).tolist() == [0, 0, 255]
        assert display.clipped([-1.0, 0.0, 0.7, 50.0, 108.0, 1000.0]) == 3


def test_a_luminance_that_is_not_finite_has_no_code() -> None:
    for display in (DisplayModel(), DisplayModel.from_table(MEASURED)):
        with pytest.raises(FloatingPointError, match="not finite"):
            display.codes([1.0, math.nan])


def test_codes_of_more_bits_than_stated_are_refused() -> None:
    with pytest.raises(
        GlossError, match="Code values of 8 bits lie between 0 and 255, but these reach from 0 to 65535"
    ):
        DisplayModel().luminance(np.array([0, 65535], np.uint16))


def test_a_display_without_black_has_infinite_contrast() -> None:
    assert DisplayModel(black_cd_m2=0.0).contrast == math.inf


# A measured display


def test_what_was_measured_is_displayed() -> None:
    display = DisplayModel.from_table(MEASURED)
    assert display.luminance(MEASURED.codes).tolist() == list(MEASURED.gray())
    assert (display.black_cd_m2, display.white_cd_m2, display.gamma) == (0.7, 108.0, None)


def test_between_the_readings_luminance_rises_all_the_way() -> None:
    assert (np.diff(DisplayModel.from_table(MEASURED).luminance(np.arange(256))) > 0).all()


def test_two_readings_are_joined_by_a_straight_line() -> None:
    display = DisplayModel.from_table(LuminanceTable(codes=(0, 255), gray_cd_m2=(1.0, 256.0)))
    # Luminance is code + 1 in closed form; rounding of the cubic.
    assert display.luminance(np.arange(256)) == pytest.approx(np.arange(256) + 1.0, rel=1e-13)
    assert display.exact_codes([1.25, 100.5]) == pytest.approx([0.25, 99.5], rel=1e-12)


def test_readings_of_a_gamma_are_followed() -> None:
    truth = DisplayModel()
    codes = tuple(range(0, 256, 15))
    table = LuminanceTable(codes=codes, gray_cd_m2=tuple(truth.luminance(codes).tolist()))
    every = np.arange(256)
    error = DisplayModel.from_table(table).luminance(every) - truth.luminance(every)
    # Worst where the curve turns up, at code 15: PCHIP takes the harmonic mean .0147 of the slopes .0092 and .0375 of
    # the two intervals for the true .0215; a cubic spreads an error of slope to 4/27 of it times the interval: .015.
    assert np.abs(error).max() < 0.02


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        (
            {"codes": (0, 128, 255), "gray_cd_m2": (0.7, 20.0, 20.0)},
            r"Row 3 of the luminance table \(code 255\): gray_cd_m2 is 20, but must exceed the 20 of the row before",
        ),
        ({"codes": (0, 128, 128), "gray_cd_m2": (0.7, 20.0, 30.0)}, "Row 3 .*: codes is 128, but must exceed the 128"),
        (
            {"codes": (0, 255), "gray_cd_m2": (0.7, math.nan)},
            "Row 2 .*: gray_cd_m2 must be a number from 0 on, but is nan",
        ),
        (
            {"codes": (0, 255), "gray_cd_m2": (-0.1, 9.0)},
            "Row 1 .*: gray_cd_m2 must be a number from 0 on, but is -0.1",
        ),
        ({"codes": (1, 255), "gray_cd_m2": (0.7, 9.0)}, r"begins with code 0 .*, but its codes are \[1, 255\]"),
        ({"codes": (0,), "gray_cd_m2": (0.7,)}, "two rows at least"),
        ({"codes": (0, 255), "gray_cd_m2": (0.7, 1.0, 2.0)}, "has 2 codes, but 3 of gray_cd_m2"),
        ({"codes": (0, 255)}, "either gray_cd_m2 or red_cd_m2, green_cd_m2, blue_cd_m2, but got neither"),
        ({"codes": (0, 255), "red_cd_m2": (0.7, 9.0)}, "but got red_cd_m2"),
        (
            {"codes": (0, 255), "red_cd_m2": (0.0, 9.0), "green_cd_m2": (0.7, 9.0), "blue_cd_m2": (0.7, 9.0)},
            "all channels show the same black screen, but the luminance table has 0, 0.7 and 0.7",
        ),
    ],
)
def test_a_damaged_table_names_its_row(columns: dict, message: str) -> None:
    with pytest.raises(GlossError, match=message):
        LuminanceTable(**columns)


@pytest.mark.parametrize(
    ("stated", "message"),
    [
        ({"white_cd_m2": 0.5}, "white_cd_m2 that exceeds black_cd_m2.*but black is 0.7 and white 0.5"),
        ({"black_cd_m2": -1.0}, "no negative black"),
        ({"gamma": 0.0}, "gamma of a display must be a finite number above 0, but is 0.0"),
        ({"gamma": None}, "either a gamma or a measured luminance table"),
        ({"measured": MEASURED}, "either a gamma or a measured luminance table"),
        ({"bits": 10}, "8 or 16 bits, but bits is 10"),
        ({"gamma": None, "measured": MEASURED, "white_cd_m2": 100.0}, "0.7 and 100, but the luminance table reaches"),
        ({"gamma": None, "measured": MEASURED, "bits": 16}, "must end with code 65535, but ends with 255"),
    ],
)
def test_an_impossible_display_is_refused(stated: dict, message: str) -> None:
    with pytest.raises(GlossError, match=message):
        DisplayModel(**stated)


# Quantisation


def test_quantisation_of_a_linear_display_has_a_closed_form() -> None:
    display = DisplayModel(black_cd_m2=1.0, white_cd_m2=256.0, gamma=1.0)
    error = display.quantisation_error()
    # Steps of 1 cd/m2: at most half of one, uniform, so 1/√12 in the root mean square. The largest Weber fraction is at
    # the first half code, 0.5 / 1.5. 1e-12: rounding over a thousand terms.
    assert error.largest_cd_m2 == pytest.approx(0.5, rel=1e-12)
    assert error.rms_cd_m2 == pytest.approx(1 / math.sqrt(12), rel=1e-12)
    assert error.largest_weber == pytest.approx(1 / 3, rel=1e-12)
    # ∫ (x - round x)² / (1 + x)² dx over 0 … 255, term by term: on k ± t with L = k + 1 it is
    # F(L, t) = t - 2 L ln(1 + t/L) + t L / (L + t), at t = 1/2 and, from the other side, -F(L, -1/2).
    level = np.arange(1, 257, dtype=float)

    def integral(t: float) -> np.ndarray:
        return t - 2 * level * np.log1p(t / level) + t * level / (level + t)

    total = integral(0.5)[:-1].sum() - integral(-0.5)[1:].sum()
    # Four Gauss points a half interval, whose integrand is smooth but for the first, where L rises by a half.
    assert error.rms_weber == pytest.approx(math.sqrt(total / 255), rel=1e-5)


def test_the_papers_monitor_is_quantised_by_at_most_two_percent() -> None:
    error = DisplayModel().quantisation_error()
    # The largest step is the last: 107.3 (1 - (254.5/255)^2.35).
    assert error.largest_cd_m2 == pytest.approx(107.3 * (1 - (254.5 / 255) ** 2.35), rel=1e-9)
    # With L = 107.3 (b + x^2.35) and b = 0.7/107.3, d ln L / dx is largest where x^2.35 = 1.35 b. Half a code there
    # changes ln L by 2.35/2 · x^1.35 / (b + x^2.35) / 255, and half a code is finite: 2 %.
    black = 0.7 / 107.3
    x = (black * 1.35) ** (1 / 2.35)
    assert error.largest_weber == pytest.approx(2.35 / 2 / 255 * x**1.35 / (black + x**2.35), rel=0.02)
    assert error.to_dict()["bits"] == 8


def test_sixteen_bits_are_257_times_finer() -> None:
    display = DisplayModel()
    coarse, fine = display.quantisation_error(bits=8), display.quantisation_error(bits=16)
    # Where the curve bends within a code, the ratio of the steps is not quite 65535/255: by 1 % of it at the white.
    for name in ("largest_cd_m2", "rms_cd_m2", "largest_weber", "rms_weber"):
        assert getattr(coarse, name) / getattr(fine, name) == pytest.approx(257, rel=0.02)


@given(displays(), st.floats(0, 1))
def test_no_luminance_is_missed_by_more_than_the_largest_error(display: DisplayModel, share: float) -> None:
    luminance = display.black_cd_m2 + share * (display.white_cd_m2 - display.black_cd_m2)
    error = display.quantisation_error(bits=8)
    shown = float(display.luminance(display.codes(luminance, bits=8), bits=8))
    # 1e-12 of the white: rounding, which may also choose the other of two equally near codes.
    assert abs(shown - luminance) <= error.largest_cd_m2 + 1e-12 * display.white_cd_m2
    assert abs(shown - luminance) / luminance <= error.largest_weber * (1 + 1e-9) + 1e-12
