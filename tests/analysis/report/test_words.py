"""What the data support, in words: another result gives another sentence."""

import re
from dataclasses import replace

import numpy as np
import pytest

from gloss_analysis.ratings.polynomials import regress_ratings
from gloss_analysis.report import words
from gloss_analysis.report.methods import methods_text
from gloss_analysis.report.numbers import counted, fixed, interval, joined, p_value


def with_confirmatory(analysis, **changed):
    return replace(analysis, fit=replace(analysis.fit, confirmatory=replace(analysis.fit.confirmatory, **changed)))


def with_line(analysis, x, y):
    return replace(analysis, fit=replace(analysis.fit, regressions={"d": regress_ratings(x, y)}))


def test_the_number_of_dimensions(simulated):
    # Judged in the plane of c and d.
    assert words.dimensions_words(simulated).startswith("Two dimensions are supported, and every criterion agrees")
    found = simulated.dimensionality
    none = replace(found, recommendation=replace(found.recommendation, n_dims=None))
    assert "No number of dimensions is supported" in words.dimensions_words(replace(simulated, dimensionality=none))
    one = replace(found, recommendation=replace(found.recommendation, n_dims=1, agreed=False))
    said = words.dimensions_words(replace(simulated, dimensionality=one))
    assert said.startswith("One dimension is supported, and the criteria do not all agree: Stress-1 is ")
    assert f"{found.stress1[0]:.3f} in one dimension and {found.stress1[1]:.3f} in two dimensions" in said


def test_axes_that_would_fit_better_turned(simulated, alone):
    assert "no rotation of the axes in steps of 5° fits the judgements better" in words.axes_words(simulated)
    stress = simulated.axes.rotation_stress1.copy()
    stress[np.flatnonzero(simulated.axes.rotation_deg == 20)] = 0
    turned = replace(simulated, axes=replace(simulated.axes, rotation_stress1=stress))
    assert "axes turned by 20° fit the judgements better" in words.axes_words(turned)
    assert "may be turned at will" in words.axes_words(alone)


def test_axes_that_are_not_independent(simulated):
    assert words.independence_words(simulated).startswith("Nothing in the judgements speaks against")
    found = replace(simulated.orthogonality, p_correlated=0.005)
    said = words.independence_words(replace(simulated, orthogonality=found))
    assert said.startswith("The judgements speak against independent axes")
    assert "(p = 0.005; 199 permutations)" in said


def test_ratings_that_bend_or_fall_or_do_nothing(simulated):
    x = np.linspace(0, 1, 9)
    assert "but not linearly" in words.ratings_words(with_line(simulated, x, 50 * x**3), "d")
    noise = np.array([1, -1, -1, 1, 0, -1, 1, 1, -1]) / 4  # odd about its middle: no parabola fits it
    assert words.ratings_words(with_line(simulated, x, 90 - 50 * x + noise), "d").startswith("Ratings fall linearly")
    assert "not seen to change along d" in words.ratings_words(with_line(simulated, x, noise), "d")
    # A slight bend: r² gains less than .01, and yet left-out stimuli are predicted better with it.
    bent = words.ratings_words(with_line(simulated, x, 50 * x + 8 * x**2 + noise / 20), "d")
    assert "linearly by the gloss paper's criterion" in bent
    assert re.search("Yet order [23] predicts left-out stimuli better", bent)


def test_a_weight_that_is_not_the_papers(simulated):
    said = words.weight_words(with_confirmatory(simulated, population_ratio=3.0, population_ci95=(2.5, 3.6)))
    assert "3.00 times as much" in said
    assert "(95 % interval 2.50 to 3.60, which excludes the gloss paper's 1.78)" in said
    # The geometric mean of 1.5, 1.8, 2.0 and 1.7.
    assert "true geometric mean is 1.74, outside the interval" in said
    assert "contains the gloss paper's 1.78" in words.weight_words(simulated)


def test_a_form_that_ratings_and_pairs_disagree_about(simulated):
    known = simulated.hypotheses["c"]
    compared, confirmed = known.compared.copy(), known.confirmed.copy()
    compared["r_squared"], compared["slope"] = [0.9, 0.5, 0.4], [1, 1, -1]
    confirmed["stress1"] = [0.3, 0.2, 0.1]
    test = {"c": replace(known, compared=compared, confirmed=confirmed)}
    said = words.hypotheses_words(replace(simulated, hypotheses=test), "c")
    assert "“luminance ratio” fits the ratings best, but “object space” the judged pairs" in said
    assert said.endswith("Ratings fall with object space.")
    assert words.hypotheses_words(replace(simulated, hypotheses={}), "c") == ""


def test_participants_who_weigh_the_axes_alike(simulated, alone):
    alike = replace(simulated.indscal, p_value=0.4)
    said = words.own_weights_words(replace(simulated, indscal=alike))
    assert said.startswith("Nothing says that participants differ in weights: own weights take away")
    assert "99 permutations (p = 0.4)" in said
    assert "°" not in said  # INDSCAL's axes are not determined
    assert words.own_weights_words(alone) == ""


def test_a_metric_that_gains_nothing(simulated):
    assert "The weight of d is needed" in words.metric_words(simulated)
    unweighted = simulated.metric.against_unweighted.second.stress
    same = replace(simulated.metric, left_out_stress=unweighted + np.array([1, -1, 1, -1]))
    assert "The weight of d is not seen to help" in words.metric_words(replace(simulated, metric=same))
    worse = replace(simulated.metric, left_out_stress=unweighted + np.array([5, 6, 5, 6]))
    assert "The weight of d does harm" in words.metric_words(replace(simulated, metric=worse))


def test_people_and_programs_together(simulated):
    mixed = replace(simulated, study=replace(simulated.study, simulated_participants=("02",)))
    said = words.observers_words(mixed)
    assert said == "Three people (01, 03, 04) and one simulated observer (02; programs, not people) took part."


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        (fixed(np.nan, 2), "–"), (fixed(-0.001, 2), "0.00"), (fixed(-2.5, 1), "−2.5"), (fixed(np.inf, 1), "∞"),
        (fixed(-np.inf, 1), "−∞"), (interval(None, 2), "not known"), (interval((-1, 2), 1), "−1.0 to 2.0"),
        (p_value(0.0004), "< 0.001"), (p_value(0.0314), "= 0.031"), (counted(0, "pair"), "no pairs"),
        (counted(13, "stimulus", "stimuli"), "13 stimuli"), (joined(["a"]), "a"),
        (joined(["a", "b", "c"]), "a, b and c"),
    ],
)  # fmt: skip
def test_numbers(said, expected):
    assert said == expected


def test_observers_who_looked_at_the_images_embody_nothing(simulated):
    """Their notes have no weights of c and d: NaN."""
    noted = simulated.study.simulated.assign(ratio=np.nan)
    looked = replace(simulated, study=replace(simulated.study, simulated=noted))
    assert simulated.study.embodied
    assert not looked.study.embodied
    assert "true geometric mean" in words.weight_words(simulated)
    assert "true geometric mean" not in words.weight_words(looked)
    text = methods_text(looked)
    assert "Answers of simulated observers were computed by a program." in text
    assert "embody" not in text
