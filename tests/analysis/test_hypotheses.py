"""Hypotheses about an axis: the true one wins on ratings and pairs, and the criteria agree with their definitions."""

import itertools
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from gloss_analysis.confirmatory.scaling import confirm_axes
from gloss_analysis.figures.hypotheses import draw_hypotheses, hypotheses_in_words, hypotheses_table
from gloss_analysis.hypotheses.candidates import HYPOTHESES_D
from gloss_analysis.hypotheses.comparison import (
    HYPOTHESES_C,
    HYPOTHESIS_D,
    Hypothesis,
    compare_hypotheses,
    confirm_hypotheses,
)
from gloss_analysis.mds.objective import fitted_disparities, source_distances
from gloss_analysis.mds.problem import make_problem
from gloss_analysis.ratings.polynomials import fit_polynomials, polynomial_sentence
from glossspace.errors import GlossError
from glossspace.metric import lightness
from tests.analysis.studies import EXPERIMENT_1, judged_by, named

NAMES = ["luminance ratio", "lightness difference", "object space"]


def measured(stimuli):
    """Add the patches' luminance ratio and lightness difference; blur takes from both what it does from contrast."""
    light = 0.5 * stimuli["rho_d"] + stimuli["rho_s"] * 0.767 * (1 - 6 * (stimuli["alpha"] - 0.04))
    dark = 0.5 * stimuli["rho_d"] + stimuli["rho_s"] * 0.03 * (1 + 60 * (stimuli["alpha"] - 0.04))
    return stimuli.assign(
        displayed_luminance_ratio=light / dark,
        displayed_lightness_difference=lightness(light.to_numpy()) - lightness(dark.to_numpy()),
    )


CONTRAST = measured(
    pd.DataFrame(
        [
            (f"t{index}", *paint, 0.04)
            for index, paint in enumerate(
                itertools.product((0.03, 0.087, 0.193, 0.42, 0.767), (0.017, 0.033, 0.05, 0.066, 0.083, 0.099))
            )
        ],
        columns=["stimulus", "rho_d", "rho_s", "alpha"],
    )
)
STIMULI = measured(EXPERIMENT_1)


def rated_by(hypothesis, *, noise_sd=3.0, participants=5, seed=0):
    rng = np.random.default_rng(seed)
    value = hypothesis.values(CONTRAST)
    ideal = 10 + 80 * (value - value.min()) / np.ptp(value)
    rows = [
        (str(participant), stimulus, rating + noise_sd * rng.standard_normal())
        for participant in range(participants)
        for _ in range(3)
        for stimulus, rating in zip(CONTRAST["stimulus"], ideal, strict=True)
    ]
    return pd.DataFrame(rows, columns=["participant_id", "stimulus", "rating"])


@pytest.mark.parametrize("truth", range(3), ids=NAMES)
def test_the_true_hypothesis_wins_by_every_criterion(truth):
    found = compare_hypotheses(HYPOTHESES_C, CONTRAST, rated_by(HYPOTHESES_C[truth])).set_index("hypothesis")
    assert found.index.tolist() == NAMES
    for criterion, best in (
        ("r_squared", "idxmax"),
        ("adjusted_r_squared", "idxmax"),
        ("leave_one_out_error", "idxmin"),
        ("aicc", "idxmin"),
    ):
        assert getattr(found[criterion], best)() == NAMES[truth]
    # A mean over 5 x 3 ratings of sd 3 has the error .77, variance .6; ratings over 80 vary by some 400 or more. Ten
    # times that share leaves room for the draw.
    assert found["r_squared"].iloc[truth] > 1 - 10 * 0.6 / 400


def test_without_noise_the_line_is_the_ratings():
    found = compare_hypotheses([HYPOTHESES_C[2]], CONTRAST, rated_by(HYPOTHESES_C[2], noise_sd=0)).iloc[0]
    value = HYPOTHESES_C[2].values(CONTRAST)
    assert found["slope"] == pytest.approx(80 / np.ptp(value), rel=1e-9)  # rounding of 30 sums
    assert found["leave_one_out_error"] < 1e-9  # the same, on ratings up to 90
    assert found["n_stimuli"] == 30


@pytest.mark.parametrize("order", [1, 2, 3])
def test_criteria_of_a_fit_agree_with_their_definitions(order):
    rng = np.random.default_rng(order)
    x = rng.uniform(0.8, 0.99, 12)
    y = 100 * x + 3 * rng.standard_normal(12)
    (fit,) = fit_polynomials(x, y, orders=(order,))
    errors = []
    for left_out in range(12):
        kept = np.arange(12) != left_out
        curve = np.polynomial.Polynomial.fit(x[kept], y[kept], order)
        errors.append(y[left_out] - curve(x[left_out]))
    # Both by orthogonal factors; what differs is rounding, times the condition of a cubic in 12 points.
    assert fit.leave_one_out_error == pytest.approx(np.sqrt(np.mean(np.square(errors))), rel=1e-9)
    rest = np.sum((y - np.polynomial.Polynomial.fit(x, y, order)(x)) ** 2)
    total = np.sum((y - y.mean()) ** 2)
    k = order + 2
    assert fit.r_squared == pytest.approx(1 - rest / total, rel=1e-9)
    assert fit.adjusted_r_squared == pytest.approx(1 - (rest / (11 - order)) / (total / 11), rel=1e-9)
    assert fit.aicc == pytest.approx(12 * np.log(rest / 12) + 2 * k + 2 * k * (k + 1) / (12 - k - 1), rel=1e-9)


def test_what_too_few_stimuli_cannot_tell_is_not_a_number():
    x, y = np.array([0.0, 1.0, 1.0, 1.0]), np.array([1.0, 2.0, 4.0, 3.0])
    (line,) = fit_polynomials(x, y)  # two positions: no curve; without the first stimulus no line
    assert np.isnan(line.leave_one_out_error)
    assert np.isnan(line.aicc)  # 4 - 3 - 1 = 0 in the denominator
    assert not np.isnan(line.adjusted_r_squared)
    assert "too few positions" in polynomial_sentence((line,))


def test_the_sentence_says_whether_a_curve_gains():
    x = np.linspace(0, 1, 11)
    wiggle = 0.01 * np.array([1, -1, 1, 1, -1, -1, 1, -1, 1, -1, 0])
    straight = polynomial_sentence(fit_polynomials(x, x + wiggle))
    assert straight.startswith("Polynomials of order 2 and 3 gain .00")
    assert "r² over the line, less than the .01 that the gloss paper takes for linear" in straight
    assert "The line predicts left-out stimuli best" in straight
    curved = polynomial_sentence(fit_polynomials(x, x**2 + wiggle))
    assert "not all less than .01. Order 2 predicts left-out stimuli best" in curved
    with pytest.raises(GlossError, match="include order 1"):
        polynomial_sentence(fit_polynomials(x, x**2, orders=(2,)))


@pytest.fixture(scope="module")
def pairs():
    return judged_by([1.5, 1.8, 2.1], noise_sd=1.0)


def test_a_form_that_fits_ratings_but_fails_at_large_alpha_is_seen(pairs):
    # Same value on the rated stimuli, all of alpha .04, but contrast that falls with blur.
    fading = Hypothesis(
        "fading", "c", lambda stimuli: HYPOTHESES_C[2].values(stimuli) * (1 - 14 * (stimuli["alpha"] - 0.04))
    )
    both = (HYPOTHESES_C[2], fading)
    compared = compare_hypotheses(both, CONTRAST, rated_by(HYPOTHESES_C[2]))
    assert compared["r_squared"].iloc[0] == pytest.approx(compared["r_squared"].iloc[1], rel=1e-12)  # same numbers
    found = confirm_hypotheses(both, STIMULI, pairs).set_index("hypothesis")
    assert found["stress1"].idxmin() == "object space"
    assert found.loc["fading", "stress1_large_alpha"] > 5 * found.loc["object space", "stress1_large_alpha"]
    assert found.loc["fading", "stress1_large_alpha"] > found.loc["fading", "stress1_other_pairs"]
    # At alpha .10 the form has .16 of the contrast it should have; the common fit gives some of it back.
    assert found.loc["fading", "shortfall_large_alpha"] > 0.3
    assert abs(found.loc["object space", "shortfall_large_alpha"]) < 0.05  # noise of 1 on judgements up to 95
    assert found["n_pairs_large_alpha"].tolist() == [36, 36]  # 9 of the 27 have alpha .10


def test_the_papers_three_on_pairs(pairs):
    found = confirm_hypotheses(HYPOTHESES_C, STIMULI, pairs).set_index("hypothesis")
    assert found["stress1"].idxmin() == "object space"
    assert found["stress1_large_alpha"].idxmin() == "object space"
    assert found.loc["object space", "ratio"] == pytest.approx(1.8, rel=0.1)  # geometric mean of 1.5, 1.8, 2.1 is 1.78


def test_stress_of_parts_by_brute_force(pairs):
    found = confirm_hypotheses(HYPOTHESES_C[1:2], STIMULI, pairs).iloc[0]
    position = np.column_stack([HYPOTHESES_C[1].values(STIMULI), 1 - STIMULI["alpha"]])
    fit = confirm_axes(pairs, position, axes=("c", "d"))
    problem = make_problem(pairs)
    distances = source_distances(position, np.tile(fit.shared.weights, (3, 1)))
    off = (distances - fitted_disparities(problem, distances)) ** 2
    first, second = pairs.pairs
    large = (STIMULI["alpha"] == 0.1).to_numpy()
    chosen = large[first] & large[second]
    expected = [
        np.sqrt(np.mean(off[:, part].sum(axis=1) / (distances[:, part] ** 2).sum(axis=1)))
        for part in (chosen, ~chosen, np.full(351, True))
    ]
    # The same sums in other units: rounding alone.
    assert found[["stress1_large_alpha", "stress1_other_pairs", "stress1"]].tolist() == pytest.approx(
        expected, rel=1e-8
    )


def test_stress_of_parts_weighs_pairs_and_participants_by_brute_force(pairs):
    rng = np.random.default_rng(8)
    pair_weights, shares = rng.uniform(0.5, 3, pairs.values.shape), np.array([1.0, 2.0, 5.0])
    weighted = replace(pairs, pair_weights=pair_weights, source_weights=shares)
    found = confirm_hypotheses(HYPOTHESES_C[1:2], STIMULI, weighted).iloc[0]
    position = np.column_stack([HYPOTHESES_C[1].values(STIMULI), 1 - STIMULI["alpha"]])
    fit = confirm_axes(weighted, position, axes=("c", "d"))
    distances = source_distances(position, np.tile(fit.shared.weights, (3, 1)))
    fitted = fitted_disparities(make_problem(weighted), distances)
    first, second = pairs.pairs
    large = (STIMULI["alpha"] == 0.1).to_numpy()
    w, d, e = (some[:, large[first] & large[second]] for some in (pair_weights, distances, fitted))
    by_participant = (w * (d - e) ** 2).sum(axis=1) / (w * d**2).sum(axis=1)
    short = (w * (e - d)).sum(axis=1) / (w * e).sum(axis=1)
    expected = [np.sqrt(shares @ by_participant / 8), shares @ short / 8]
    # The same sums in other units: rounding alone.
    assert found[["stress1_large_alpha", "shortfall_large_alpha"]].tolist() == pytest.approx(expected, rel=1e-8)


def test_pairs_that_nobody_judged_and_the_order_of_the_stimuli_do_not_matter(pairs):
    values = pairs.values.copy()
    values[:, ::7] = np.nan
    some = named(values, 27)
    found = confirm_hypotheses(HYPOTHESES_C[2:], STIMULI, some)
    shuffled = confirm_hypotheses(
        HYPOTHESES_C[2:], STIMULI.sample(frac=1, random_state=0), some, 1 - STIMULI["alpha"].to_numpy()
    )
    pd.testing.assert_frame_equal(found, shuffled)
    assert np.isfinite(found.select_dtypes("number").to_numpy()).all()
    large = (STIMULI["alpha"] == 0.1).to_numpy()
    first, second = some.pairs
    assert found["n_pairs_large_alpha"].tolist() == [np.sum((large[first] & large[second])[np.arange(351) % 7 > 0])]


def test_hypotheses_about_d_are_tested_beside_c(pairs):
    forms = HYPOTHESES_D[:4]  # the fifth needs measurements
    found = confirm_hypotheses(forms, STIMULI, pairs).set_index("hypothesis")
    assert found["stress1"].idxmin() == "1 - alpha"
    assert found.loc["1 - alpha", "n_best"] == found.loc["1 - alpha", "n_participants"] == 3
    # The ratio is that of d over c, as for hypotheses about c: the same axes, the same fit.
    same = confirm_hypotheses([HYPOTHESES_C[2]], STIMULI, pairs).iloc[0]
    assert found.loc["1 - alpha", ["ratio", "stress1"]].tolist() == same[["ratio", "stress1"]].tolist()
    for name in found.index[1:]:
        form = next(one for one in forms if one.name == name)
        position = np.column_stack([HYPOTHESES_C[2].values(STIMULI), form.values(STIMULI)])
        assert found.loc[name, "stress1"] == confirm_axes(pairs, position, axes=("c", "d")).shared.stress1
    given = confirm_hypotheses(forms[:1], STIMULI, pairs, HYPOTHESES_C[1]).iloc[0]  # beside another c
    assert given["stress1"] > same["stress1"]
    with pytest.raises(GlossError, match=r"The values of c have shape \(3,\); give one for each of the 27 judged"):
        confirm_hypotheses(forms, STIMULI, pairs, np.ones(3))


def test_each_participant_has_a_best_hypothesis_or_several(pairs):
    found = confirm_hypotheses(HYPOTHESES_C, STIMULI, pairs)
    own = np.array(
        [
            [one.stress1 for one in confirm_axes(pairs, _beside_d(form), axes=("c", "d")).individual]
            for form in HYPOTHESES_C
        ]
    )
    assert found["n_best"].tolist() == np.bincount(own.argmin(axis=0), minlength=3).tolist()
    # A form and its double are the best for the same participants.
    double = Hypothesis("double", "c", lambda stimuli: 2 * HYPOTHESES_C[2].values(stimuli))
    both = confirm_hypotheses([HYPOTHESES_C[2], double], STIMULI, pairs)
    assert both["n_best"].tolist() == [3, 3]


def _beside_d(form):
    return np.column_stack([form.values(STIMULI), 1 - STIMULI["alpha"]])


def test_the_words_name_what_each_task_favours():
    compared = pd.DataFrame(
        {
            "hypothesis": ["a", "b"], "slope": [1.0, -1.0], "aicc": [10.0, 4.0], "leave_one_out_error": [3.0, 2.0]
        }
    )  # fmt: skip
    confirmed = pd.DataFrame({"hypothesis": ["a", "b"], "stress1": [0.1, 0.2], "n_best": [2, 2], "n_participants": 3})
    assert hypotheses_in_words(compared, confirmed) == (
        "Ratings: b predicts left-out stimuli best (error 2; a 3, AICc 6.0 lower).",
        "Ratings fall where it rises: b.",
        "Pairs: a has the lowest stress (0.1000; b 0.2000), and is the best for 2 of 3 participants.",
        "The two tasks do not favour the same hypothesis.",
    )
    assert hypotheses_in_words(compared.iloc[:1], confirmed.iloc[:1]) == ()


def test_nothing_to_show():
    with pytest.raises(GlossError, match="There is nothing to draw"):
        draw_hypotheses(HYPOTHESES_C, CONTRAST, None)
    with pytest.raises(GlossError, match="There is nothing to show"):
        hypotheses_table(None)


def test_many_hypotheses_stand_in_rows(pairs):
    forms = [Hypothesis(f"form {k}", "c", lambda stimuli, k=k: stimuli["rho_s"] ** (k + 1)) for k in range(4)]
    confirmed = confirm_hypotheses(forms, STIMULI, pairs)
    figure = draw_hypotheses(forms, CONTRAST, rated_by(HYPOTHESES_C[2]), confirmed=confirmed, title="simulated $x$")
    figure.draw_without_rendering()  # warnings are errors
    assert [axes.get_xlabel() for axes in figure.axes] == [*(one.name for one in forms), "Stress-1"]
    tops = [axes.get_position().y1 for axes in figure.axes]
    assert tops[4] < min(tops[:4])
    assert figure.get_suptitle() == "simulated $x$"
    alone = draw_hypotheses(forms, CONTRAST, None, confirmed=confirmed)
    assert [axes.get_xlabel() for axes in alone.axes] == ["Stress-1"]


def test_table_and_figure_show_every_hypothesis(pairs):
    ratings = rated_by(HYPOTHESES_C[2])
    confirmed = confirm_hypotheses(HYPOTHESES_C[1:], STIMULI, pairs)
    compared = compare_hypotheses(HYPOTHESES_C, CONTRAST, ratings)
    table = hypotheses_table(compared, confirmed)
    assert table["hypothesis"].tolist() == NAMES
    assert table["Stress-1"].tolist() == ["–", *(f"{value:.3f}" for value in confirmed["stress1"])]
    assert table["ΔAICc"].iloc[2] == "0.0"
    assert "Stress-1" not in hypotheses_table(compared)
    figure = draw_hypotheses(HYPOTHESES_C, CONTRAST, ratings, confirmed=confirmed)
    figure.draw_without_rendering()  # warnings are errors
    assert [axes.get_xlabel() for axes in figure.axes] == [*NAMES, "Stress-1"]
    assert figure.axes[2].lines[0].get_xdata() == pytest.approx(HYPOTHESES_C[2].values(CONTRAST), rel=1e-12)
    alone = draw_hypotheses([HYPOTHESES_C[2]], CONTRAST, ratings[ratings["participant_id"] == "0"])
    alone.draw_without_rendering()


@pytest.mark.parametrize(
    ("hypotheses", "message"),
    [
        ([], "There is no hypothesis to test"),
        ([HYPOTHESIS_D, HYPOTHESIS_D], "Several hypotheses are called '1 - alpha'"),
        ([HYPOTHESES_C[0], HYPOTHESIS_D], "'1 - alpha' is about d, but this is a comparison for c"),
        ([Hypothesis("x", "c", lambda s: s["sheen"])], "'x' needs the column sheen, which the stimuli lack"),
        ([Hypothesis("x", "c", lambda s: 3.0)], r"'x' gives values of shape \(\) for 30 stimuli"),
        ([Hypothesis("x", "c", lambda s: np.log(s["rho_s"] > 0.02))], "no finite number for the stimulus t0 (5 such)"),
        ([HYPOTHESIS_D], "'1 - alpha': A regression of ratings needs 3 different positions"),
    ],
)
@pytest.mark.filterwarnings("ignore:divide by zero:RuntimeWarning")
def test_what_cannot_be_compared_is_refused(hypotheses, message):
    with pytest.raises(GlossError, match=message.replace("(5", r"\(5").replace("such)", r"such\)")):
        compare_hypotheses(hypotheses, CONTRAST, rated_by(HYPOTHESES_C[2], participants=1))


def test_one_stimulus_of_the_largest_alpha_makes_a_pair_with_the_next_largest(pairs):
    """A design where alpha is finely graded has no two stimuli of the largest."""
    largest = STIMULI["alpha"].max()
    graded = STIMULI.copy()
    graded.loc[graded.index[graded["alpha"] == largest][0], "alpha"] += 0.01
    found = confirm_hypotheses([HYPOTHESES_C[2]], graded, pairs)
    # One stimulus of .11 and eight of .10: those that reach .10 are nine.
    assert found["n_pairs_large_alpha"].tolist() == [36]


def test_unknown_stimuli_and_too_few_of_large_alpha_are_refused(pairs):
    with pytest.raises(GlossError, match="The stimulus 's3' was judged, but is not in the table"):
        confirm_hypotheses(HYPOTHESES_C, STIMULI.drop(index=3), pairs)
    with pytest.raises(GlossError, match="0 of the judged stimuli have a large alpha.* up to 0.1"):
        confirm_hypotheses(HYPOTHESES_C, STIMULI, pairs, alpha_from=0.2)
    with pytest.raises(GlossError, match=r"The values of d have shape \(3,\); give one for each of the 27"):
        confirm_hypotheses(HYPOTHESES_C, STIMULI, pairs, np.arange(3))
