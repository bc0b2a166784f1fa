"""Intervals of single participants' axis ratios."""

import numpy as np
import pytest
from scipy.stats import t

from gloss_analysis.confirmatory.ratio_intervals import ratio_intervals
from gloss_analysis.confirmatory.scaling import confirm_axes
from glossspace.errors import GlossError
from tests.analysis.studies import axis_values, judged_by, named

AXES = ("c", "d")


def test_their_width_is_the_scatter_of_participants_alike():
    """Forty simulated participants with one true ratio: how far their ratios scatter is what each interval states."""
    data = judged_by([1.78] * 40, exponent=0.85, noise_sd=4.5, integers=True)
    fitted = confirm_axes(data, axis_values(), axes=AXES)
    scatter = np.std(np.log([one.ratio for one in fitted.individual]), ddof=1)
    found = ratio_intervals(data, axis_values(), axes=AXES, n_jobs=2)
    assert set(found) == set(data.participants)
    half = [np.log(high / low) / 2 for low, high in found.values()]
    stated = np.sqrt(np.mean(np.square(half))) / 2.093024054408263  # t(19)
    # Forty participants know their scatter to 1 / sqrt(78), 11 %; three times that.
    assert stated == pytest.approx(scatter, rel=0.34)
    for name, one in zip(fitted.participants, fitted.individual, strict=True):
        assert np.sqrt(np.prod(found[name])) == pytest.approx(one.ratio, rel=1e-12)  # centred but for rounding


def test_without_noise_they_are_narrow():
    found = ratio_intervals(judged_by([1.5, 2.0]), axis_values(), axes=AXES)
    # Order alone leaves a range of ratios, whose middle moves a little as pairs are left out.
    assert all(high / low < 1.05 for low, high in found.values())


def test_the_result_depends_on_the_seed_alone():
    data = judged_by([1.6], noise_sd=3.0, integers=True)
    one, two = (ratio_intervals(data, axis_values(), axes=AXES, seed=4, n_jobs=jobs) for jobs in (1, 2))
    assert one == two
    assert ratio_intervals(data, axis_values(), axes=AXES, seed=5) != one


def test_a_participant_who_follows_one_axis_has_none():
    data = judged_by([1.7], noise_sd=1.0, integers=True)
    c = axis_values()[:, 0]
    first, second = data.pairs
    data = named(np.vstack([data.values, np.abs(c[first] - c[second])]), 27)
    assert list(ratio_intervals(data, axis_values(), axes=AXES, level="ratio")) == ["p0"]


@pytest.mark.parametrize("n_groups", [0, 1, 352])
def test_numbers_of_groups_that_cannot_be(n_groups):
    with pytest.raises(GlossError, match=f"Invalid number of groups = {n_groups}. Allowed: 2 to 351"):
        ratio_intervals(judged_by([1.7]), axis_values(), axes=AXES, n_groups=n_groups)


def test_a_participant_with_few_pairs_has_none_where_one_of_them_is_needed():
    data = judged_by([1.7, 1.7], noise_sd=1.0, integers=True)
    values = data.values.copy()
    # Two pairs, of which one differs along c alone and one along d alone: without either a weight is not known.
    values[1] = np.nan
    first, second = data.pairs
    place = axis_values()
    same_c, same_d = (np.isclose(place[first, axis], place[second, axis]) for axis in (0, 1))
    values[1, [np.flatnonzero(same_c & ~same_d)[0], np.flatnonzero(same_d & ~same_c)[0]]] = [20, 30]
    assert list(ratio_intervals(named(values, 27), place, axes=AXES)) == ["p0"]


def test_they_are_the_grouped_jackknifes_of_student():
    """Efron and Tibshirani (1993), eq. 11.5, on four groups; each ratio without one of them by `confirm_axes`."""
    data = judged_by([1.6], noise_sd=4.0, integers=True)
    whole = confirm_axes(data, axis_values(), axes=AXES).individual[0].ratio
    group = np.random.default_rng(2).permutation(351) % 4
    without = [
        confirm_axes(named(np.where(group == k, np.nan, data.values), 27), axis_values(), axes=AXES).individual[0].ratio
        for k in range(4)
    ]
    error = np.sqrt(3 * np.var(np.log(without)))  # (g - 1) / g times the sum of squares
    expected = np.exp(t.interval(0.95, 3, loc=np.log(whole), scale=error))
    found = ratio_intervals(data, axis_values(), axes=AXES, n_groups=4, seed=2)["p0"]
    assert found == pytest.approx(expected, rel=1e-9)  # rounding
