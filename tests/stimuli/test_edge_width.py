import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import ndtr

from gloss_stimuli.edge_width import EdgeProfile, steepest_slope

POSITIONS = (np.arange(32) + 0.5) / 32 - 0.5
EVENLY = np.ones(32)


@given(st.floats(0.02, 1.0), st.floats(-0.2, 0.2), st.floats(1e-3, 1e3), st.floats(-1e3, 1e3), st.sampled_from([1, -1]))
def test_a_gaussian_edge_has_the_slope_of_its_equation(
    sigma: float, shift: float, height: float, level: float, sign: int
) -> None:
    values = level + sign * height * ndtr((POSITIONS - shift) / sigma)
    # d/ds of the normal distribution at its mean is 1 / (√(2π) σ). The nested grids end at 0.1 % of the width.
    expected = sign * height / (np.sqrt(2 * np.pi) * sigma)
    # 1e-12: what rounding leaves of a small edge on a high level, over the 32 values.
    assert steepest_slope(POSITIONS, values, EVENLY) == pytest.approx(expected, rel=1e-3, abs=1e-9 * abs(level))


def test_a_ramp_has_its_own_slope() -> None:
    # The widest error function, w = 4, bends by (π/16) s² at the ends s = 1/2 of the ramp: 1 % of its slope.
    assert steepest_slope(POSITIONS, 3 * POSITIONS + 1, EVENLY) == pytest.approx(3, rel=0.015)


def test_blurred_checks_have_the_slope_of_their_sine_wave() -> None:
    # What remains of a check pattern under a lobe wider than a check: sin πs, of slope π. An error function is another
    # curve: 3 %.
    assert steepest_slope(POSITIONS, np.sin(np.pi * POSITIONS), EVENLY) == pytest.approx(np.pi, rel=0.03)


def test_an_edge_sharper_than_its_samples_is_one_sample_wide() -> None:
    slope = steepest_slope(POSITIONS, np.sign(POSITIONS), EVENLY)
    # It rises by 2 over the 1/31 between the positions; the grid of widths ends there.
    assert slope == pytest.approx(2 * 31, rel=0.1)


def test_neither_noise_nor_codes_steepen_an_edge() -> None:
    rng = np.random.default_rng(1)
    edge = ndtr(POSITIONS / 0.12)
    expected = 1 / (np.sqrt(2 * np.pi) * 0.12)
    # The largest difference between neighbours would be some 32 · .04 · √2 = 1.8 too steep. A fit of 32 values knows
    # the slope to about noise / (edge · √(values within it, 8)) = 1.5 %, of which this is three.
    assert steepest_slope(POSITIONS, edge + rng.normal(0, 0.04, 32), EVENLY) == pytest.approx(expected, rel=0.05)
    # In steps of an eighth of the edge: uniform errors of 1/8/√12 = .036.
    assert steepest_slope(POSITIONS, np.round(edge * 8) / 8, EVENLY) == pytest.approx(expected, rel=0.05)


def test_a_weight_counts_as_so_many_equal_samples() -> None:
    values = ndtr(POSITIONS / 0.1) + 0.1 * np.cos(17 * POSITIONS)
    weights = np.arange(1.0, 33.0)
    repeated = [np.repeat(of, weights.astype(int)) for of in (POSITIONS, values)]
    weighted = steepest_slope(POSITIONS, values, weights)
    # The spacing, from which widths begin, is taken from the number of positions; the best width is far above either.
    assert steepest_slope(*repeated, np.ones(528)) == pytest.approx(weighted, rel=2e-3)


def test_samples_are_averaged_where_they_are() -> None:
    rng = np.random.default_rng(2)
    positions = rng.uniform(-0.5, 0.5, 5000)
    place, value, count = EdgeProfile(positions).means(3 * positions + 1)
    assert count.sum() == 5000
    assert (np.diff(place) > 0).all()
    # A line stays a line, since the mean value belongs to the mean place.
    assert value == pytest.approx(3 * place + 1, rel=1e-12)


def test_a_few_pixels_resolve_no_edge() -> None:
    assert EdgeProfile(np.linspace(-0.5, 0.5, 40)).is_resolved()
    assert not EdgeProfile(np.tile(np.linspace(-0.5, 0.5, 7), 10)).is_resolved()
