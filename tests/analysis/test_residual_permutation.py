"""Permuted residuals: by how much they are enlarged, how far they travel, and what sets their number of parameters.

Drawn judgements are the answers of a participant in another order, so that the size of a residual shows only in whether
two sums change places. Here that is known in closed form.
"""

import numpy as np
import pytest

from gloss_analysis.confirmatory import indscal
from gloss_analysis.confirmatory.residual_permutation import permuted_residuals
from tests.analysis.studies import axis_values, judged_by, named


def draws(answers, distances, n, *, n_weights=1.0, number=200):
    """Drawn answers of one participant, shape (number, n_pairs)."""
    drawn = permuted_residuals(named(answers, n), np.array([distances], dtype=float), n_weights=n_weights)
    return np.array([drawn(np.random.default_rng(seed)).values[0] for seed in range(number)])


@pytest.mark.parametrize("n_weights", [0.0, 0.5, 1.0, 2.0])
def test_residuals_are_enlarged_by_what_the_fit_took_up(n_weights):
    """Six pairs at two distances, answers 0 and 10 with residuals -r, 0 and r: a curve of two steps.

    A pair of the first distance is above one of the second where r + r > 10, each enlarged by
    sqrt(6 / (6 - 2 - n_weights)), and never else.
    """
    enlarged = np.sqrt(6 / (4 - n_weights))
    for part, crossed in ((0.99, False), (1.01, True)):
        r = part * 5 / enlarged
        found = draws([-r, 0, r, 10 - r, 10, 10 + r], [1, 1, 1, 2, 2, 2], 4, n_weights=n_weights)
        # A large residual below and minus the same above comes about in 1 draw of 3 or more.
        assert bool((found[:, :3].max(axis=1) > 5).any()) == crossed


def test_residuals_change_places_among_twenty_neighbours():
    """Ten pairs at each of two distances and 25 at a third; noise at the second alone, enlarged by sqrt(45 / 41).

    Of the first 20 pairs those without noise must get some, of the last 25 none: a residual of 4.19 would bring 12
    below 5 + 4.19.
    """
    second = np.repeat([1.0, 9.0], 5)
    found = draws([*np.zeros(10), *second, *np.full(25, 12.0)], np.repeat([1, 2, 3], [10, 10, 25]), 10)
    assert (found[:, :10] > 0).any()
    assert np.all(found[:, 20:] == 12)
    # And all of the 20 alike: each pair of a distance has an outlier as often as any other, 4 standard errors of a
    # share of 200 draws.
    share = (found[:, :10] > 0).mean(axis=0)
    assert share == pytest.approx(np.full(10, share.mean()), abs=4 * np.sqrt(share.mean() * (1 - share.mean()) / 200))


def test_a_step_of_the_curve_is_the_mean_of_all_its_answers():
    """Distances of one, five and four pairs, answers 6, 3 and 7.6: the first two are pooled, to (6 + 5 * 3) / 6 = 3.5.

    With sqrt(10 / 7) for ten pairs, two steps and a weight, the largest sum of the first is 3.5 + 2.5 * 1.195 = 6.5,
    the least of the last 7.6 - .5 * 1.195 = 7.0. By the mean of the two means, 4.5, they would meet: 4.5 + 1.8 and
    7.6 - 1.8.
    """
    found = draws([6, *np.full(5, 3.0), *np.full(4, 7.6)], [1, *np.full(5, 2), *np.full(4, 3)], 5)
    assert np.all(found[:, 6:] == 7.6)


def test_pairs_at_one_distance_but_for_rounding_are_one_step():
    """All answers to one distance are one step of the curve, so that each pair gets each of them as often."""
    answers = np.arange(6.0)
    found = draws(answers, 1 + np.arange(6) * 1e-15, 4, number=2000)
    # Of numbers 0 to 5 the standard deviation is sqrt(35 / 12); four standard errors over 2000 draws.
    assert found.mean(axis=0) == pytest.approx(np.full(6, 2.5), abs=4 * np.sqrt(35 / 12 / 2000))


@pytest.mark.parametrize(("m", "axes"), [(2, ("c", "d")), (4, ("c", "d"))])
def test_shared_weights_take_up_one_number_among_all(monkeypatch, m, axes):
    """One weight beside the scale for m participants: 1 / m each."""
    given = []

    def spied(data, predicted, *, n_weights=1.0):
        given.append((n_weights, predicted))
        return permuted_residuals(data, predicted, n_weights=n_weights)

    monkeypatch.setattr(indscal, "permuted_residuals", spied)
    indscal.confirm_indscal(judged_by([1.2, 1.6, 2.0, 2.4][:m], noise_sd=3), axis_values(), axes=axes, level="ratio")
    [(n_weights, predicted)] = given
    assert n_weights == pytest.approx(1 / m)
    assert np.ptp(predicted, axis=0).max() == 0  # the same distances for all
