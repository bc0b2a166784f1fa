import numpy as np
import pytest
from scipy.stats import norm

from gloss_stimuli.code_error import code_error
from gloss_stimuli.display import DisplayModel
from gloss_stimuli.tone import solve_tone_curve

TONE = solve_tone_curve(adapting=10.0, minimum=0.0, maximum=250.0, slope=1.0, contrast=108 / 0.7)
DISPLAY = DisplayModel()


def sigma_codes(luminance: float, sigma: float) -> float:
    """First-order error in codes: the derivative of the whole chain by a small step."""
    step = 1e-4 * luminance
    low, high = (DISPLAY.exact_codes(108 * TONE(luminance + sign * step)) for sign in (-1, 1))
    return sigma * float(high - low) / (2 * step)


def test_equal_pixels_have_the_normal_distributions_percentiles() -> None:
    luminance, sigma = np.full((64, 64), 12.0), 0.05
    error = code_error(luminance, np.full((64, 64), sigma**2), tone=TONE, display=DISPLAY)
    scale = sigma_codes(12.0, sigma)
    # 1e-3: the secant over one sigma against the derivative, and 1e-9 of the root.
    assert error.median == pytest.approx(norm.ppf(0.75) * scale, rel=1e-3)
    assert error.percentile_99 == pytest.approx(norm.ppf(0.995) * scale, rel=1e-3)
    assert error.percentile_99_9 == pytest.approx(norm.ppf(0.9995) * scale, rel=1e-3)
    assert error.fraction_within_half_code == pytest.approx(2 * norm.cdf(0.5 / scale) - 1, abs=1e-3)


def test_a_mixture_is_what_drawing_from_it_gives() -> None:
    rng = np.random.default_rng(8)
    luminance = np.full((90, 90), 12.0)
    sigma = np.repeat([0.02, 0.1, 0.3], 30)[:, None] * np.ones((90, 90))
    error = code_error(luminance, sigma**2, tone=TONE, display=DISPLAY)
    drawn = [np.abs(rng.normal(size=sigma.shape) * sigma) * sigma_codes(12.0, 1.0) for _ in range(100)]
    # 5 %: smoothing over 3 × 3 at the two borders, one row in thirty each side; sampling adds less.
    assert error.median == pytest.approx(np.percentile(drawn, 50), rel=0.05)
    assert error.percentile_99_9 == pytest.approx(np.percentile(drawn, 99.9), rel=0.05)


def test_a_noiseless_image_has_no_error() -> None:
    error = code_error(np.full((4, 4), 3.0), np.zeros((4, 4)), tone=TONE, display=DISPLAY)
    assert error.percentile_99_9 < 1e-6
    assert error.fraction_within_half_code == 1
