"""The form of an axis function: recovered where it is known, kept where the data cannot bear another."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import curve_fit, least_squares
from scipy.stats import t as student_t

from gloss_analysis.axis_functions.axis_forms import _chosen, choose_form
from gloss_analysis.axis_functions.form_fitting import FormFit
from gloss_analysis.ratings.polynomials import fit_polynomials
from glossspace.errors import GlossError
from glossspace.metric import ContrastForm, DistinctnessForm
from tests.analysis.studies import CONTRAST, DOI

ALPHAS = DOI["alpha"].to_numpy()


def rated(stimuli, values, *, noise=0.0, participants=1, seed=0):
    rng = np.random.default_rng(seed)
    return pd.concat(
        pd.DataFrame(
            {
                "participant_id": f"simulated-{k}",
                "stimulus": stimuli["stimulus"],
                "rating": values + noise * rng.standard_normal(len(stimuli)),
            }
        )
        for k in range(participants)
    )


def values_of(form, stimuli):
    if isinstance(form, ContrastForm):
        return 400 * form.value(stimuli["rho_d"], stimuli["rho_s"]) + 3
    return 300 * form.value(stimuli["alpha"]) - 200


@pytest.mark.parametrize(
    ("axis", "stimuli", "true", "taken"),
    [
        ("c", CONTRAST, ContrastForm(), ()),
        ("c", CONTRAST, ContrastForm(exponent=0.8), ("exponent",)),
        ("c", CONTRAST, ContrastForm(exponent=0.5, diffuse_share=0.1), ("exponent", "diffuse_share")),
        ("c", CONTRAST, ContrastForm(exponent=0.1, offset=0.05), ("exponent", "offset")),
        ("d", DOI, DistinctnessForm(), ()),
        ("d", DOI, DistinctnessForm(exponent=0.4), ("exponent",)),
        ("d", DOI, DistinctnessForm(exponent=0.1, offset=0.02), ("exponent", "offset")),
    ],
)
def test_the_form_behind_noise_free_ratings_is_found(axis, stimuli, true, taken):
    """1e-3: squared errors are flat at their minimum, so that rounding leaves half the digits of a parameter."""
    choice = choose_form(axis, stimuli, rated(stimuli, values_of(true, stimuli)))
    assert choice.chosen.free == taken
    found, expected = vars(choice.chosen.form), vars(true)
    assert [found[name] for name in expected] == pytest.approx(list(expected.values()), rel=1e-3, abs=1e-6)
    assert choice.chosen.r_squared == pytest.approx(1, abs=1e-9)


@pytest.mark.parametrize("seed", range(12))
def test_noise_alone_does_not_make_a_form(seed):
    """Nine simulated participants with a noise of 8 units each, as people have, about the paper's own forms."""
    for axis, stimuli, form in (("c", CONTRAST, ContrastForm()), ("d", DOI, DistinctnessForm())):
        ratings = rated(stimuli, values_of(form, stimuli), noise=8, participants=9, seed=seed)
        assert choose_form(axis, stimuli, ratings).chosen.form == form


def test_left_out_errors_are_those_of_the_hat_matrix():
    """For a line the error of leaving one out has a closed form, which `fit_polynomials` takes from leverages."""
    ratings = rated(DOI, values_of(DistinctnessForm(), DOI), noise=4, seed=3)
    line = choose_form("d", DOI, ratings).candidates[0]
    closed = fit_polynomials(1 - ALPHAS, ratings["rating"], orders=(1,))[0]
    assert line.leave_one_out_error == pytest.approx(closed.leave_one_out_error, rel=1e-9)
    assert line.aicc == pytest.approx(closed.aicc, rel=1e-9)
    assert line.r_squared == pytest.approx(closed.r_squared, rel=1e-9)


def test_the_interval_of_a_slope_is_student_s_over_participants():
    """Of participants whose ratings have one mean and one deviation, which equalisation leaves as they are.

    The slope of the mean ratings is then the mean of the participants' slopes, and a jackknife of a mean is its
    textbook standard error.
    """
    rng = np.random.default_rng(5)
    x = 1 - ALPHAS
    rows = 2000 * (x - x.mean()) + 60 * rng.standard_normal((6, len(x)))
    rows = 50 + 10 * (rows - rows.mean(axis=1, keepdims=True)) / rows.std(axis=1, keepdims=True)
    ratings = pd.concat(
        pd.DataFrame({"participant_id": str(k), "stimulus": DOI["stimulus"], "rating": row})
        for k, row in enumerate(rows)
    )
    slopes = np.array([np.polyfit(x, row, 1)[0] for row in rows])
    half = student_t.ppf(0.975, 5) * slopes.std(ddof=1) / np.sqrt(6)
    found = choose_form("d", DOI, ratings, forms="paper").chosen.ci95["slope"]
    assert found == pytest.approx((slopes.mean() - half, slopes.mean() + half), rel=1e-9)


def test_a_free_exponent_its_errors_and_its_interval_by_levenberg_and_marquardt():
    """Three numbers fitted together by scipy, to all, without each stimulus, and to the means without each participant.

    Participants have one mean and one deviation, so that equalisation leaves them as they are.
    """
    rng = np.random.default_rng(6)
    rows = values_of(DistinctnessForm(exponent=0.6), DOI) + 3 * rng.standard_normal((5, len(DOI)))
    rows = 50 + 10 * (rows - rows.mean(axis=1, keepdims=True)) / rows.std(axis=1, keepdims=True)
    ratings = pd.concat(rated(DOI, row).assign(participant_id=str(k)) for k, row in enumerate(rows))

    def curve(alpha, exponent, slope, intercept):
        return slope * (1 - alpha**exponent) + intercept

    def fitted(alpha, rating):
        return curve_fit(curve, alpha, rating, p0=[0.6, 60, 10], xtol=1e-12, ftol=1e-12)[0]

    mean, n = rows.mean(axis=0), len(DOI)
    best = fitted(ALPHAS, mean)
    rest = np.sum((mean - curve(ALPHAS, *best)) ** 2)
    left_out = [mean[k] - curve(ALPHAS[k], *fitted(np.delete(ALPHAS, k), np.delete(mean, k))) for k in range(n)]
    without = np.array([fitted(ALPHAS, np.delete(rows, k, axis=0).mean(axis=0)) for k in range(5)])
    found = next(one for one in choose_form("d", DOI, ratings).candidates if one.free == ("exponent",))
    # Where a sum of squares is flat, searches end at the root of its relative precision, 1e-8, or nearly so.
    assert [found.form.exponent, found.slope, found.intercept] == pytest.approx(best, rel=1e-5)
    assert found.leave_one_out_error == pytest.approx(np.sqrt(np.mean(np.square(left_out))), rel=1e-5)
    assert found.aicc == pytest.approx(n * np.log(rest / n) + 2 * 4 + 2 * 4 * 5 / (n - 5), rel=1e-6)  # 3 + variance
    without[:, 0], best[0] = np.log(without[:, 0]), np.log(best[0])
    errors = np.sqrt(4 * without.var(axis=0))
    low, high = student_t.interval(0.95, 4, loc=best, scale=errors)
    assert found.ci95["exponent"] == pytest.approx(np.exp([low[0], high[0]]), rel=1e-4)
    assert found.ci95["slope"] == pytest.approx((low[1], high[1]), rel=1e-4)
    assert found.ci95["intercept"] == pytest.approx((low[2], high[2]), rel=1e-4)


def test_the_intervals_of_a_contrast_form_by_levenberg_and_marquardt():
    """As above; of the diffuse share on logarithms as of the exponent, for neither can be negative."""
    rng = np.random.default_rng(8)
    rows = values_of(ContrastForm(exponent=0.5, diffuse_share=0.3), CONTRAST) + 2 * rng.standard_normal((4, 30))
    rows = 50 + 10 * (rows - rows.mean(axis=1, keepdims=True)) / rows.std(axis=1, keepdims=True)
    ratings = pd.concat(rated(CONTRAST, row).assign(participant_id=str(k)) for k, row in enumerate(rows))
    paints = CONTRAST["rho_d"].to_numpy(), CONTRAST["rho_s"].to_numpy()

    def curve(paints, exponent, share, slope, intercept):
        rho_d, rho_s = paints
        return slope * ((rho_s + share * rho_d) ** exponent - (share * rho_d) ** exponent) + intercept

    def fitted(rating):
        return curve_fit(curve, paints, rating, p0=[0.5, 0.3, 100, 30], xtol=1e-12, ftol=1e-12, maxfev=10000)[0]

    without = np.array([np.log(fitted(np.delete(rows, k, axis=0).mean(axis=0))[:2]) for k in range(4)])
    low, high = student_t.interval(
        0.95, 3, loc=np.log(fitted(rows.mean(axis=0))[:2]), scale=np.sqrt(3 * without.var(0))
    )
    found = next(
        one for one in choose_form("c", CONTRAST, ratings).candidates if one.free == ("exponent", "diffuse_share")
    )
    assert found.ci95["exponent"] == pytest.approx(np.exp([low[0], high[0]]), rel=1e-4)  # as above
    assert found.ci95["diffuse_share"] == pytest.approx(np.exp([low[1], high[1]]), rel=1e-4)


def best_of_d(alpha, rating):
    """Exponent, offset, slope and intercept of least squares, by scipy's trust regions from many places."""

    def line(number):
        x = 1 - (alpha + number[1]) ** number[0]
        return np.polyfit(x, rating, 1), x

    def left(number):
        (slope, intercept), x = line(number)
        return rating - slope * x - intercept

    starts = [(exponent, offset) for exponent in (0.2, 0.6, 1.0, 2.0) for offset in (1e-5, 1e-3, 1e-2, 0.1)]
    bounds = ([0.05, 0], [3, 10])
    found = [least_squares(left, one, bounds=bounds, x_scale=(1, 0.01), xtol=1e-14, ftol=1e-14) for one in starts]
    best = min(found, key=lambda one: one.cost).x
    return (*best, *line(best)[0])


def test_an_offset_of_0_does_not_stay_0_without_each_stimulus():
    """With all stimuli no offset is best; without one of them another may be, which the error of leaving out needs."""
    rating = np.round(values_of(DistinctnessForm(exponent=0.5), DOI) + 4 * np.random.default_rng(3).normal(size=11))
    found = next(one for one in choose_form("d", DOI, rated(DOI, rating)).candidates if "offset" in one.free)
    assert found.form.offset == 0
    offsets, errors = [], []
    for k in range(11):
        exponent, offset, slope, intercept = best_of_d(np.delete(ALPHAS, k), np.delete(rating, k))
        offsets.append(offset)
        errors.append(rating[k] - slope * (1 - (ALPHAS[k] + offset) ** exponent) - intercept)
    assert max(offsets) > 1e-3
    equalised = found.slope / best_of_d(ALPHAS, rating)[2]  # the unit of mean ratings
    assert found.leave_one_out_error == pytest.approx(equalised * np.sqrt(np.mean(np.square(errors))), rel=1e-3)


def test_a_curved_rating_scale_is_told_from_a_curved_axis_by_the_pairs():
    true = DistinctnessForm(exponent=0.4)
    ratings = rated(DOI, values_of(true, DOI))
    against = choose_form("d", DOI, ratings, stress_of=lambda form: 0.10 if form == DistinctnessForm() else 0.12)
    assert against.chosen.form == DistinctnessForm()
    assert "stress of the judged pairs would rise from 0.1000 to 0.1200" in against.sentence
    in_favour = choose_form("d", DOI, ratings, stress_of=lambda form: 0.12 if form == DistinctnessForm() else 0.10)
    assert in_favour.chosen.form.exponent == pytest.approx(0.4, rel=1e-3)


def fit_of(n_free, r_squared, at_limit=()):
    form = [DistinctnessForm(), DistinctnessForm(exponent=0.5), DistinctnessForm(exponent=0.5, offset=0.01)][n_free]
    return FormFit(form, ("exponent", "offset")[:n_free], 1.0, 0.0, r_squared, 1.0, 0.0, {}, at_limit)


# Differences of squared errors to the paper's form, all unlike, of 10 stimuli.
GAIN = np.linspace(0.02, 0.04, 10)


@pytest.mark.parametrize(
    ("r_squared", "gains", "taken"),
    [
        # The gloss paper calls .01 of r squared a gain (3.3.4).
        ([0.95, 0.9599], [GAIN], 0),
        ([0.95, 0.9601], [GAIN], 1),
        # Of n differences that all have one sign the signed-rank test's p is 1 / 2**n: 1 / 16 and 1 / 32.
        ([0.95, 0.97], [GAIN[:4]], 0),
        ([0.95, 0.97], [GAIN[:5]], 1),
        # The richer form is better in the mean by a single stimulus, or at each of them.
        ([0.95, 0.97, 0.98], [GAIN, GAIN + np.where(np.arange(10) == 3, 0.2, -0.001)], 1),
        ([0.95, 0.97, 0.98], [GAIN, GAIN + np.linspace(0.001, 0.002, 10)], 2),
        # Better, but nowhere is the simpler one good enough.
        ([0.95, 0.955, 0.98], [GAIN, GAIN + np.linspace(0.001, 0.002, 10)], 2),
    ],
)
def test_what_it_takes_to_be_chosen(r_squared, gains, taken):
    fits = [fit_of(k, one) for k, one in enumerate(r_squared)]
    squared = 0.3 - np.vstack([np.zeros(len(gains[0])), *gains])
    assert _chosen("d", fits, squared, None)[0] is fits[taken]
    # Stress that does not rise changes nothing, and none that rises is taken.
    assert _chosen("d", fits, squared, lambda form: 0.1)[0] is fits[taken]
    assert _chosen("d", fits, squared, lambda form: 0.1 + 1e-6 * (form != fits[0].form))[0] is fits[0]
    at_limit = [fits[0], *(replace(one, at_limit=("exponent",)) for one in fits[1:])]
    assert _chosen("d", at_limit, squared, None)[0] is fits[0]


@pytest.mark.parametrize(
    ("axis", "stimuli", "tried"),
    [
        ("c", CONTRAST[CONTRAST["rho_d"].isin([0.03, 0.767])], [(), ("exponent",)]),  # nor do two lightnesses
        ("c", CONTRAST[CONTRAST["rho_d"] == 0.03], [(), ("exponent",)]),  # one lightness: neither share nor offset
        ("c", CONTRAST[CONTRAST["rho_s"].isin([0.017, 0.099])], [()]),  # two values of rho_s bear a line alone
        ("d", DOI[:5], [()]),  # five stimuli for three coefficients
        ("d", DOI[:6], [(), ("exponent",)]),
    ],
)
def test_what_the_stimuli_cannot_tell_is_not_tried(axis, stimuli, tried):
    form = ContrastForm() if axis == "c" else DistinctnessForm()
    choice = choose_form(axis, stimuli, rated(stimuli, values_of(form, stimuli), noise=2))
    assert [one.free for one in choice.candidates] == tried


def test_a_number_that_the_ratings_do_not_tell_has_no_interval_and_is_not_taken():
    """Ratings steeper than the limit of 3 allows."""
    ratings = rated(DOI, 90 - 1e5 * ALPHAS**5, noise=0.1, participants=4)
    choice = choose_form("d", DOI, ratings)
    assert [one.at_limit[:1] for one in choice.candidates[1:]] == [("exponent",), ("exponent",)]
    assert all("exponent" not in one.ci95 for one in choice.candidates)
    assert choice.chosen.free == ()


def test_unknown_names_are_refused():
    ratings = rated(DOI, ALPHAS)
    with pytest.raises(GlossError, match="There is no axis 'e'. Allowed: c or d"):
        choose_form("e", DOI, ratings)
    with pytest.raises(GlossError, match="Invalid forms = 'free'. Allowed: 'chosen' .* or 'paper'"):
        choose_form("d", DOI, ratings, forms="free")
