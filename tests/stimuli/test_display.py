import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gloss_stimuli.display import DisplayModel


def test_the_papers_monitor_is_the_default() -> None:
    display = DisplayModel()
    assert display.contrast == pytest.approx(108 / 0.7)
    assert display.luminance([0, 255]).tolist() == [0.7, 108.0]
    # Half the code values: 0.7 + 107.3 (128/255)^2.35, by hand with logarithms.
    assert float(display.luminance(128)) == pytest.approx(0.7 + 107.3 * np.exp(2.35 * np.log(128 / 255)), rel=1e-14)


def test_every_code_value_comes_back() -> None:
    display = DisplayModel(black_cd_m2=0.3, white_cd_m2=250.0, gamma=1.9)
    codes = np.arange(256)
    assert (display.codes(display.luminance(codes)) == codes).all()


@given(st.floats(0.7, 108.0))
def test_rounding_is_at_most_half_a_code(luminance: float) -> None:
    display = DisplayModel()
    exact = float(display.exact_codes(luminance))
    assert abs(float(display.codes(luminance)) - exact) <= 0.5 + 1e-12  # 1e-12: rounding of the sum with 0.5
    # Near black a code value is the 1/2.35th root of rounding in the difference to 0.7 cd/m2: (1e-16 / 107)^(1/2.35).
    assert float(display.exact_codes(display.luminance(exact))) == pytest.approx(exact, abs=255 * 1e-7)


def test_luminance_beyond_the_display_is_held_at_its_ends() -> None:
    assert DisplayModel().codes([-1.0, 0.0, 1000.0]).tolist() == [0, 0, 255]
