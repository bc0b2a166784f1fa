"""What pairs tell about a weight, against least squares and simulation."""

import numpy as np
import pytest

from gloss_analysis.confirmatory.scaling import confirm_axes
from gloss_analysis.design.information import log_ratio_variance, observers_at, sensitivities
from gloss_analysis.design.population import Population
from gloss_analysis.design.simulation import simulated_study
from glossspace.errors import GlossError
from tests.analysis.studies import axis_values

FIRST, SECOND = np.triu_indices(27, 1)
DELTA = axis_values()[FIRST] - axis_values()[SECOND]
EVERY = np.ones(len(DELTA), dtype=bool)


@pytest.mark.parametrize("exponent", [0.5, 1.0, 1.4])
def test_as_in_least_squares_of_numerical_derivatives(exponent):
    """Of 100 (D / L)**p by log w at fixed L, beside powers of D: (X'X)^-1 of ordinary least squares."""

    def answers(log_ratio, largest):
        return 100 * (np.hypot(DELTA[:, 0], np.exp(log_ratio) * DELTA[:, 1]) / largest) ** exponent

    distance = np.hypot(DELTA[:, 0], 1.78 * DELTA[:, 1])
    step = 1e-5
    x = (answers(np.log(1.78) + step, distance.max()) - answers(np.log(1.78) - step, distance.max())) / (2 * step)
    # Legendre polynomials span the same functions as those of Chebyshev.
    columns = np.column_stack([x, np.polynomial.legendre.legvander(2 * distance / distance.max() - 1, 10)])
    expected = np.linalg.inv(columns.T @ columns)[0, 0]
    # A central difference of step 1e-5 is right to about 1e-10; the inverse loses some digits.
    assert log_ratio_variance(DELTA, EVERY, 1.78, exponent=exponent) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(("n_pairs", "noise_sd"), [(351, 4.0), (150, 4.0), (351, 2.0)])
def test_ordinal_confirmatory_scaling_is_not_better_than_the_bound(n_pairs, noise_sd):
    kept = np.zeros(351, dtype=bool)
    kept[np.random.default_rng(0).permutation(351)[:n_pairs]] = True
    population = Population(noise_sd=noise_sd)
    logs = []
    for seed in range(5):
        data = simulated_study(
            axis_values(), np.full(40, 1.78), population, kept=kept, rng=np.random.default_rng(seed)
        )  # fmt: skip
        logs += [np.log(one.ratio) for one in confirm_axes(data, axis_values(), axes=("c", "d")).individual]
    predicted = noise_sd * np.sqrt(log_ratio_variance(DELTA, kept, 1.78, exponent=0.85))
    # The inverse of the information bounds the variance of any estimate from below (Cramér and Rao); a standard
    # deviation of 200 observers is known to 5 %. How far above it scaling stays is said in analysis/README.md.
    assert np.std(logs, ddof=1) > 0.9 * predicted


def test_more_pairs_tell_more_and_too_few_nothing():
    order = np.random.default_rng(1).permutation(351)
    found = []
    for n_pairs in (12, 40, 100, 351):
        kept = np.zeros(351, dtype=bool)
        kept[order[:n_pairs]] = True
        found.append(log_ratio_variance(DELTA, kept, 1.78, exponent=0.85))
    # Eleven columns and the weight fit twelve pairs with one over for none.
    assert found[0] > 100 * found[1]
    assert found[1] > found[2] > found[3]
    assert log_ratio_variance(DELTA, ~EVERY, 1.78, exponent=0.85) == np.inf
    assert log_ratio_variance(DELTA, np.arange(351) < 11, 1.78, exponent=0.85) == np.inf


def test_pairs_along_one_axis_at_one_distance_differ_by_their_share():
    delta = np.array([[1.0, 0.0], [0.0, 0.5]])
    # At ratio 2 both are at the largest distance: the response is 100 with slope 100 p.
    np.testing.assert_allclose(sensitivities(delta, np.array([2.0]), exponent=0.7)[0, :, 0], [0, 70])
    with pytest.raises(GlossError, match="All stimuli are at one place"):
        sensitivities(np.zeros((3, 2)), np.array([1.0]), exponent=1.0)


def test_observers_stand_for_their_population():
    ratios, shares = observers_at(1.78, 0.3)
    # The mean of a log-normal number, exp(s² / 2) times the median; seven nodes integrate it to 1e-9.
    assert shares @ ratios == pytest.approx(1.78 * np.exp(0.3**2 / 2), rel=1e-9)
