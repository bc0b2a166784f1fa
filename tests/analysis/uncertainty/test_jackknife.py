"""Solutions without one participant each: influence, standard errors, the interval of the ratio."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import t as student_t

from gloss_analysis.mds import scale
from gloss_analysis.uncertainty.bootstrap import bootstrap
from gloss_analysis.uncertainty.jackknife import jackknife
from tests.analysis.studies import judged_by


def test_an_outlier_has_the_most_influence():
    usual = judged_by([1.8, 1.8, 1.8, 1.8, 1.8], noise_sd=4)
    other = np.random.default_rng(0).permutation(usual.values[2])
    values = usual.values.copy()
    values[2] = other
    data = replace(usual, values=values)
    found = jackknife(data, scale(data, n_dims=2, model="identity", n_starts=10))
    assert found.participants[int(np.argmax(found.influence))] == "p2"
    # One who judged at random moves the points clearly more than any of the others, who differ by noise.
    assert np.sort(found.influence)[-1] > 1.5 * np.sort(found.influence)[-2]
    assert found.stress1[2] == min(found.stress1)


def test_jackknife_errors_are_those_of_the_formula(noisy):
    found = jackknife(*noisy)
    deviation = found.coordinates - found.coordinates.mean(axis=0)
    expected = np.sqrt(5 / 6 * np.sum(deviation**2, axis=0))
    assert found.standard_error == pytest.approx(expected, abs=1e-12)
    assert found.stress_error == pytest.approx(np.std(found.stress1) * np.sqrt(5), rel=1e-9)
    # Bootstrap and jackknife estimate one quantity; of six participants they agree to a factor of two.
    assert 0.5 < found.standard_error.mean() / bootstrap(*noisy, n_replicates=100).coordinates.std(axis=0).mean() < 2


def test_the_interval_of_the_jackknife_is_that_of_the_formula(noisy):
    """Student's on logarithms about the ratio of all, not about the mean of those without one each."""
    _, solution = noisy
    found = jackknife(*noisy)

    def log_ratio(coordinates, weights):
        extent = weights * coordinates.std(axis=0)  # coordinates are centred
        return np.nanmean(np.log(extent[:, 1] / extent[:, 0]))

    parts = np.array([log_ratio(*one) for one in zip(found.coordinates, found.dimension_weights, strict=True)])
    centre = log_ratio(solution.coordinates, solution.dimension_weights)
    half = student_t.ppf(0.95, 5) * np.sqrt(5 / 6 * np.sum((parts - parts.mean()) ** 2))
    assert found.ratio_interval(level=0.9) == pytest.approx(np.exp([centre - half, centre + half]), rel=1e-9)
