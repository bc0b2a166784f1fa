import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import norm

from gloss_stimuli.code_error import QUANTILES, CodeError, code_error
from gloss_stimuli.tone import solve_tone_curve
from glossspace.display import DisplayModel

TONE = solve_tone_curve(adapting=10.0, minimum=0.0, maximum=250.0, slope=1.0, contrast=108 / 0.7)
DISPLAY = DisplayModel()


def sigma_codes(luminance: float, sigma: float) -> float:
    """First-order error in codes: the derivative of the whole chain by a small step."""
    step = 1e-4 * luminance
    low, high = (DISPLAY.exact_codes(108 * TONE(luminance + sign * step)) for sign in (-1, 1))
    return sigma * float(high - low) / (2 * step)


def test_equal_pixels_have_the_normal_distributions_percentiles() -> None:
    luminance, sigma = np.full((64, 64), 12.0), 0.05
    error = code_error(luminance, np.full((64, 64), sigma), tone=TONE, display=DISPLAY)
    scale = sigma_codes(12.0, sigma)
    # 1e-3: the secant over one sigma against the derivative, and 1e-6 of the root.
    assert error.percentile(0.5) == pytest.approx(norm.ppf(0.75) * scale, rel=1e-3)
    assert error.percentile(0.99) == pytest.approx(norm.ppf(0.995) * scale, rel=1e-3)
    assert error.percentile(0.999) == pytest.approx(norm.ppf(0.9995) * scale, rel=1e-3)
    assert error.within(0.5) == pytest.approx(2 * norm.cdf(0.5 / scale) - 1, abs=1e-3)


def test_a_mixture_is_what_drawing_from_it_gives() -> None:
    rng = np.random.default_rng(8)
    luminance = np.full((90, 90), 12.0)
    sigma = np.repeat([0.02, 0.1, 0.3], 30)[:, None] * np.ones((90, 90))
    error = code_error(luminance, sigma, tone=TONE, display=DISPLAY)
    drawn = [np.abs(rng.normal(size=sigma.shape) * sigma) * sigma_codes(12.0, 1.0) for _ in range(100)]
    # 5 %: smoothing over 3 × 3 at the two borders, one row in thirty each side; sampling adds less.
    assert error.percentile(0.5) == pytest.approx(np.percentile(drawn, 50), rel=0.05)
    assert error.percentile(0.999) == pytest.approx(np.percentile(drawn, 99.9), rel=0.05)
    for limit in (0.1, 0.5, 2.0):
        assert error.within(limit) == pytest.approx(np.mean(np.array(drawn) < limit), abs=0.02)  # the same two borders


def test_half_the_difference_of_two_solutions_is_such_a_standard_deviation() -> None:
    """As the exact renderer uses it: one signed difference a pixel, of which a neighbourhood knows the variance."""
    rng = np.random.default_rng(3)
    truth, sigma = np.full((200, 200), 12.0), 0.1
    one, other = truth + sigma * rng.normal(size=(2, 200, 200))
    mean, spread = (one + other) / 2, (one - other) / 2
    error = code_error(mean, spread, tone=TONE, display=DISPLAY)
    # Nine squares know a variance as chi-square does, so the percentiles are those of a normal times its root.
    product = np.abs(rng.normal(size=10**6)) * np.sqrt(rng.chisquare(9, 10**6) / 9)
    scale = sigma_codes(12.0, sigma / np.sqrt(2))
    errors = np.abs(mean - truth) * sigma_codes(12.0, 1.0)
    for percent in (50, 90, 99, 99.9):
        stated = error.percentile(percent / 100)
        assert stated == pytest.approx(scale * np.percentile(product, percent), rel=0.02)  # 40,000 pixels
        # Against the errors that were made: 8 % less in the median, up to 15 % more where the target looks.
        assert 0.9 < stated / np.percentile(errors, percent) < 1.2
    assert error.percentile(0.999) > np.percentile(errors, 99.9)


def test_the_sign_of_the_spread_is_of_no_account() -> None:
    rng = np.random.default_rng(4)
    luminance, spread = rng.uniform(1, 50, (12, 9)), 0.01 * rng.normal(size=(12, 9))
    one, other = (code_error(luminance, each, tone=TONE, display=DISPLAY) for each in (spread, np.abs(spread)))
    np.testing.assert_allclose(one.sigmas, other.sigmas, rtol=1e-12)  # rounding


def test_a_bright_check_lends_its_scatter_to_no_dark_one() -> None:
    """Errors are shared in code values: the same relative error of luminance is about the same in both, not tenfold."""
    luminance = np.repeat([2.0, 20.0], 10)[None, :] * np.ones((20, 1))
    error = code_error(luminance, 0.001 * luminance, tone=TONE, display=DISPLAY)
    dark, bright = sigma_codes(2.0, 0.002), sigma_codes(20.0, 0.02)
    assert error.sigmas.min() == pytest.approx(dark, rel=1e-3)  # the secant
    assert error.sigmas.max() == pytest.approx(bright, rel=1e-3)
    # Two columns of twenty see both checks, a third of one and two of the other.
    assert np.mean(error.sigmas > 1.01 * dark) == pytest.approx(11 / 20)


def test_large_images_are_summarised_without_losing_their_worst_pixels() -> None:
    rng = np.random.default_rng(5)
    spread = np.abs(rng.standard_t(3, size=(150, 150))) * 0.01
    luminance = np.full(spread.shape, 12.0)
    error = code_error(luminance, spread, tone=TONE, display=DISPLAY)
    assert error.sigmas.shape == error.shares.shape == (QUANTILES,)
    assert error.shares.sum() == pytest.approx(1, abs=1e-12)  # rounding
    assert (np.diff(error.sigmas) >= 0).all()
    # The same image as two halves, each small enough to be kept pixel by pixel; borders of the cut differ a little.
    halves = [
        code_error(luminance[half], spread[half], tone=TONE, display=DISPLAY) for half in (np.s_[:50], np.s_[50:])
    ]
    assert len(halves[0].sigmas) == 50 * 150
    for limit in (0.01, 0.1, 0.5):
        assert error.within(limit) == pytest.approx(
            (halves[0].within(limit) + 2 * halves[1].within(limit)) / 3, abs=1e-3
        )


def test_a_noiseless_image_has_no_error() -> None:
    error = code_error(np.full((4, 4), 3.0), np.zeros((4, 4)), tone=TONE, display=DISPLAY)
    assert error.percentile(0.999) < 1e-6
    assert error.within(0.5) == 1


def test_beyond_black_and_white_of_the_display_there_is_no_error() -> None:
    luminance = np.array([[1e4, 1e4, 1e4]])
    error = code_error(luminance, 0.01 * luminance, tone=TONE, display=DISPLAY)
    assert error.within(1e-6) == 1


@given(st.lists(st.floats(1e-3, 10), min_size=1, max_size=20), st.floats(0.01, 0.9999))
def test_within_is_the_inverse_of_the_percentile(sigmas: list[float], fraction: float) -> None:
    error = CodeError(np.sort(sigmas), np.full(len(sigmas), 1 / len(sigmas)))
    # The root is found to 1e-6 codes, where the density is at most that of the smallest sigma, .8/.001.
    assert error.within(error.percentile(fraction)) == pytest.approx(fraction, abs=1e-3)


def test_the_manifest_gets_four_figures_of_four_digits() -> None:
    error = CodeError(np.array([0.123456789]), np.array([1.0]))
    assert error.to_dict() == {
        "median": float(f"{0.123456789 * norm.ppf(0.75):.4g}"),
        "percentile_99": float(f"{0.123456789 * norm.ppf(0.995):.4g}"),
        "percentile_99_9": float(f"{0.123456789 * norm.ppf(0.9995):.4g}"),
        "fraction_within_half_code": 0.9999,
    }
