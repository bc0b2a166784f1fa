"""A fitted space beside the paper's and an unweighted one."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from gloss_analysis.confirmatory.scaling import confirm_axes
from gloss_analysis.validation.metric_check import check_metric, mean_interval, predicted_differences
from gloss_analysis.validation.stress_index import stress_index
from glossspace.metric import GlossSpace
from tests.analysis.studies import EXPERIMENT_1, axis_values, judged_by


def checked(ratios, **options):
    data = judged_by(ratios, **options)
    fit = confirm_axes(data, axis_values(), axes=("c", "d"), level="ratio")
    return data, check_metric(EXPERIMENT_1, data, GlossSpace(weight_d=fit.population_ratio), fit)


def test_predictions_are_the_distances_of_eq_5():
    data = judged_by([1.78])
    # Judged without noise or compression, in proportion to eq. 5.
    predicted = predicted_differences(EXPERIMENT_1, data, GlossSpace())
    assert np.ptp(data.values[0] / predicted) < 1e-9 * data.values[0].max() / predicted.max()


def test_each_participant_is_predicted_by_the_weight_of_the_others():
    data, check = checked([1.2, 1.8, 2.6])
    # Noise-free ratio fits give each own ratio back; the others' is the geometric mean of two of them.
    for k, others in enumerate((np.sqrt(1.8 * 2.6), np.sqrt(1.2 * 2.6), np.sqrt(1.2 * 1.8))):
        c, d = axis_values().T
        first, second = data.pairs
        expected = stress_index(np.hypot(c[first] - c[second], others * (d[first] - d[second])), data.values[k])
        # The search for a ratio ends at about 1e-6 of it.
        assert check.left_out_stress[k] == pytest.approx(expected, rel=1e-4)
    assert (check.left_out_stress > check.fitted.stress - 1e-9).sum() >= 2


def test_observers_of_the_papers_space_are_predicted_by_it_and_not_by_equal_weights():
    _, check = checked([1.78, 1.78], noise_sd=2.0)
    assert check.against_unweighted.better == "first"
    assert check.against_paper.better is None
    assert (check.gain > 0).all()
    table = check.table()
    assert table["participant_id"].tolist() == ["p0", "p1"]
    assert table["stress_paper"].tolist() == check.against_paper.second.stress.tolist()


def test_observers_with_equal_weights_gain_nothing():
    _, check = checked([1.0, 1.0], noise_sd=2.0)
    assert check.against_unweighted.better is None
    assert check.against_paper.better == "first"


def test_a_single_participant_has_no_others():
    _, check = checked([1.7])
    assert np.isnan(check.left_out_stress).all()
    assert mean_interval(check.left_out_stress) is None


def test_the_unit_of_both_weights_does_not_matter():
    data = judged_by([1.2, 1.8, 2.6], noise_sd=2.0)
    fit = confirm_axes(data, axis_values(), axes=("c", "d"), level="ratio")
    one, twice = (
        check_metric(EXPERIMENT_1, data, GlossSpace(weight_c=c, weight_d=c * fit.population_ratio), fit).table()
        for c in (1.0, 2.0)
    )
    pd.testing.assert_frame_equal(one, twice)  # STRESS is free of units; the tolerance is that of rounding


def test_pairs_of_no_weight_do_not_enter_left_out_predictions_either():
    data = judged_by([1.2, 1.8, 2.6], noise_sd=2.0)
    weights = np.ones_like(data.values)
    weights[1, ::3] = 0
    weightless = replace(data, pair_weights=weights)
    missing = replace(data, values=np.where(weights > 0, data.values, np.nan))
    fit = confirm_axes(missing, axis_values(), axes=("c", "d"), level="ratio")
    one, other = (check_metric(EXPERIMENT_1, some, GlossSpace(), fit).table() for some in (weightless, missing))
    pd.testing.assert_frame_equal(one, other)
