"""How well a metric predicts judgements: closed forms, colour-science."""

import doctest
import math
import re

import numpy as np
import pytest
from colour.difference import index_stress
from scipy.stats import f as f_distribution

import gloss_analysis.figures.validation
import gloss_analysis.validation.metric_validation
import gloss_analysis.validation.stress_index
from gloss_analysis.figures.validation import draw_predicted_against_judged
from gloss_analysis.validation.metric_validation import compare_metrics, validate_metric
from gloss_analysis.validation.stress_index import common_judgement, stress_index
from glossspace.errors import GlossError
from tests.analysis.studies import named

NAN = math.nan


@pytest.fixture
def noisy():
    rng = np.random.default_rng(5)
    truth = rng.uniform(1, 10, 45)
    return truth, named(np.abs(truth + rng.normal(0, 1.5, (4, 45))) * [[1], [2], [10], [0.1]], 10)


@pytest.mark.parametrize(
    "module",
    [
        gloss_analysis.validation.stress_index,
        gloss_analysis.validation.metric_validation,
        gloss_analysis.figures.validation,
    ],
)
def test_examples_of_docstrings(module):
    failed, tried = doctest.testmod(module)
    assert failed == 0
    assert tried > 0


class TestStressIndex:
    def test_sine_of_the_angle(self):
        """By hand: cos = (3·1 + 4·0)/(5·1)."""
        assert stress_index(np.array([3.0, 4.0]), np.array([1.0, 0.0])) == pytest.approx(80, rel=1e-12)

    def test_as_colour_science_has_it(self, noisy):
        truth, pairs = noisy
        for row in pairs.values:
            assert stress_index(truth, row) == pytest.approx(100 * float(index_stress(truth, row)), rel=1e-10)

    def test_the_printed_formula(self):
        e, v = np.array([2.0425, 2.8615, 3.4412]), np.array([1.2644, 1.2630, 1.8731])
        factor = (e**2).sum() / (e * v).sum()
        by_hand = 100 * math.sqrt(((e - factor * v) ** 2).sum() / (factor**2 * v**2).sum())
        assert stress_index(e, v) == pytest.approx(by_hand, rel=1e-12)
        assert by_hand == pytest.approx(12.11709, abs=1e-5)  # printed in colour-science's documentation

    @pytest.mark.parametrize("scale", [1e-300, 1e-3, 1, 1e300])
    def test_units_drop_out(self, noisy, scale):
        truth, pairs = noisy
        assert stress_index(truth, scale * truth) == pytest.approx(0, abs=1e-6)
        assert stress_index(scale * truth, pairs.values[0]) == pytest.approx(stress_index(pairs.values[0], truth))

    def test_missing_pairs_do_not_enter(self):
        assert stress_index(np.array([3.0, 4.0, NAN, 7.0]), np.array([1.0, 0.0, 5.0, NAN])) == pytest.approx(80)

    def test_nothing_in_common(self):
        assert stress_index(np.array([0.0, 1.0]), np.array([1.0, 0.0])) == 100

    @pytest.mark.parametrize(
        ("predicted", "judged", "message"),
        [
            ([0.0, 0.0], [1.0, 2.0], "No predicted difference of 2 pairs is above 0"),
            ([1.0, 2.0], [0.0, NAN], "No judged difference of 1 pairs is above 0"),
            ([1.0, -2.0], [1.0, 2.0], "Invalid predicted difference -2 "),
            ([1.0, 2.0], [1.0, np.inf], "Invalid judged difference inf "),
            ([1.0, 2.0], [1.0], "shape (2,), judged ones (1,)"),
        ],
    )
    def test_refused(self, predicted, judged, message):
        with pytest.raises(GlossError, match=re.escape(message)):
            stress_index(np.array(predicted), np.array(judged))


class TestCommonJudgement:
    def test_unit_root_mean_square_of_everyone_where_all_is_judged(self, noisy):
        _, pairs = noisy
        unit = pairs.values / np.sqrt((pairs.values**2).mean(axis=1, keepdims=True))
        expected = unit.mean(axis=0)
        found = common_judgement(pairs.values)
        assert found == pytest.approx(expected / np.sqrt((expected**2).mean()), rel=1e-10)

    def test_proportional_judgements_of_different_pairs(self):
        truth = np.arange(1.0, 8.0)
        values = np.outer([1, 5, 0.01], truth)
        values[0, 5:] = values[1, :4] = values[2, 1:3] = NAN
        found = common_judgement(values)
        assert found / found[0] == pytest.approx(truth, rel=1e-9)

    def test_participants_without_a_common_pair(self):
        values = np.array([[1.0, 2.0, NAN, NAN], [NAN, NAN, 20.0, 40.0]])
        assert common_judgement(values) == pytest.approx(np.array([1, 2, 1, 2]) / math.sqrt(2.5))


class TestValidateMetric:
    def test_proportional_judgements_are_predicted_perfectly(self):
        truth = np.arange(1.0, 11)
        values = np.outer([1, 7], truth)
        values[0, 3] = values[1, 4] = NAN
        found = validate_metric(named(values, 5), 3 * truth)
        assert found.stress == pytest.approx([0, 0], abs=1e-6)
        assert found.pooled_stress == pytest.approx(0, abs=1e-6)
        assert found.ceiling == pytest.approx(0, abs=1e-6)
        assert found.warnings == ()
        assert found.scale * found.judged == pytest.approx(3 * truth)

    def test_each_number_by_its_definition(self, noisy):
        truth, pairs = noisy
        found = validate_metric(pairs, truth)
        assert found.stress == pytest.approx([stress_index(truth, row) for row in pairs.values])
        assert found.mean_stress == pytest.approx(found.stress.mean())
        assert found.pooled_stress == pytest.approx(stress_index(truth, common_judgement(pairs.values)))
        assert found.pooled_stress < found.mean_stress  # noise averages out
        others = common_judgement(pairs.values[1:])
        assert found.inter_observer[0] == pytest.approx(stress_index(others, pairs.values[0]))
        assert found.ceiling == pytest.approx(found.inter_observer.mean())
        assert found.n_pairs == 45

    def test_one_participant_has_no_ceiling(self, noisy):
        truth, pairs = noisy
        found = validate_metric(pairs.take([0]), truth)
        assert found.ceiling is None
        assert np.isnan(found.inter_observer).all()
        assert found.mean_stress == pytest.approx(found.pooled_stress, rel=1e-9)
        assert "a single participant" in found.warnings[0]

    @pytest.mark.parametrize("value", [0.0, 50.0, NAN])
    def test_constant_judgements_are_left_out(self, noisy, value):
        truth, pairs = noisy
        values = pairs.values.copy()
        values[2] = value
        found = validate_metric(named(values, 10), truth)
        assert np.isnan(found.stress).tolist() == [False, False, True, False]
        assert found.pooled_stress == validate_metric(pairs.take([0, 1, 3]), truth).pooled_stress
        assert found.warnings[0].endswith("left out: p2.")

    def test_pairs_without_prediction_are_left_out(self, noisy):
        truth, pairs = noisy
        partial = truth.copy()
        partial[:5] = NAN
        found = validate_metric(pairs, partial)
        assert found.stress[0] == pytest.approx(stress_index(truth[5:], pairs.values[0, 5:]))
        assert found.n_pairs == 40
        assert np.isnan(found.judged[:5]).all()
        assert "5 of 45 pairs have no prediction" in found.warnings[0]

    @pytest.mark.parametrize(
        ("judged", "predicted", "message"),
        [
            ([[1.0, 2.0, 3.0]], [0.0, 0.0, 0.0], "No participant's judgements can be compared"),
            ([[1.0, 2.0, 3.0]], [NAN, NAN, NAN], "3 of 3 pairs have no prediction"),
            ([[4.0, 4.0, 4.0]], [1.0, 2.0, 3.0], "left out: p0"),
            ([[1.0, 2.0, 3.0]], [1.0, 2.0], "(2,). Allowed: (3,)"),
            ([[1.0, -2.0, 3.0]], [1.0, 2.0, 3.0], "Invalid judged difference -2"),
        ],
    )
    def test_refused(self, judged, predicted, message):
        with pytest.raises(GlossError, match=re.escape(message)):
            validate_metric(named(np.array(judged), 3), np.array(predicted))


class TestCompareMetrics:
    def test_f_by_hand(self, noisy):
        truth, pairs = noisy
        found = compare_metrics(pairs, truth**3, truth)
        assert found.f_ratio == pytest.approx((found.first.pooled_stress / found.second.pooled_stress) ** 2)
        assert found.p_value == pytest.approx(2 * f_distribution.sf(found.f_ratio, 44, 44))
        assert found.f_interval[1] == pytest.approx(f_distribution.ppf(0.975, 44, 44))
        assert found.f_interval[0] * found.f_interval[1] == pytest.approx(1)
        assert found.better == "second"
        assert (found.n_favouring_first, found.n_favouring_second) == (0, 4)

    def test_swapped(self, noisy):
        truth, pairs = noisy
        one, other = compare_metrics(pairs, truth**3, truth), compare_metrics(pairs, truth, truth**3)
        assert one.f_ratio * other.f_ratio == pytest.approx(1)
        assert one.p_value == pytest.approx(other.p_value)
        assert other.better == "first"

    def test_equal_metrics(self, noisy):
        truth, pairs = noisy
        found = compare_metrics(pairs, truth, 5 * truth)
        assert found.f_ratio == pytest.approx(1)
        assert found.p_value == pytest.approx(1)
        assert found.better is None
        assert (found.n_favouring_first, found.n_favouring_second) == (0, 0)

    def test_perfect_metrics(self):
        truth = np.arange(1.0, 11)
        pairs = named(truth, 5)
        assert compare_metrics(pairs, truth, 2 * truth).f_ratio == 1
        found = compare_metrics(pairs, truth**2, truth)
        assert (found.f_ratio, found.p_value, found.better) == (np.inf, 0, "second")
        assert compare_metrics(pairs, truth, truth**2).better == "first"

    def test_only_pairs_that_both_predict(self, noisy):
        truth, pairs = noisy
        one, other = truth.copy(), truth**2
        one[0] = other[1] = NAN
        found = compare_metrics(pairs, one, other)
        assert found.first.n_pairs == found.second.n_pairs == 43

    @pytest.mark.parametrize("confidence", [0, 1, NAN])
    def test_refused(self, noisy, confidence):
        truth, pairs = noisy
        with pytest.raises(GlossError, match="Invalid confidence"):
            compare_metrics(pairs, truth, truth, confidence=confidence)


def test_figure_shows_each_pair_and_the_line(noisy):
    truth, pairs = noisy
    found = validate_metric(pairs, truth)
    axes = draw_predicted_against_judged(found, metric="$ of_5").axes[0]
    points, line = axes.lines
    assert np.array_equal(points.get_xydata(), np.column_stack([truth, found.judged]))
    assert line.get_xydata()[1, 1] == pytest.approx(truth.max() / found.scale)
    assert f"{found.ceiling:.1f} %" in axes.get_title()
