"""A ranking study on simulated rankings with a known answer, and on what goes wrong."""

import numpy as np
import pandas as pd
import pytest
from scipy.stats import kendalltau, rankdata, ttest_1samp

from gloss_analysis.figures.ranking import draw_ranking
from gloss_analysis.ranking.rank_table import Rankings
from gloss_analysis.ranking.ranking_study import predicted_order, study_ranking
from glossspace.errors import GlossError
from glossspace.metric import GlossSpace, Paint, from_physical, to_physical

REFERENCE = Paint(0.193, 0.02, 0.15)


def on_contours(radii=(0.04, 0.08, 0.12), angles=(0, 22.5, 45, 67.5, 90)):
    """Paints glossier than the reference on contours of the gloss paper's space, by eqs 5 to 8."""
    lightness, c, d = (float(value) for value in from_physical(*REFERENCE))
    paints = {"reference": REFERENCE}
    for radius in radii:
        for angle in angles:
            towards = np.radians(angle)
            paints[f"{radius:g}@{angle:g}"] = to_physical(
                lightness, c + radius * np.cos(towards), d + radius * np.sin(towards) / 1.78
            )
    return paints


PAINTS = on_contours()
ORDER = predicted_order(PAINTS, reference="reference")


def simulated_rankings(m=8, *, weight_d=1.78, noise_sd=0.01, seed=0):
    """Simulated participants who rank by noisy distances in a space of this weight of d."""
    distance = predicted_order(PAINTS, reference="reference", space=GlossSpace(weight_d=weight_d))[
        "distance"
    ].to_numpy()
    distance = np.round(distance, 9)  # points of one contour are tied, but for rounding
    rng = np.random.default_rng(seed)
    ranks = [rankdata(distance + noise_sd * rng.standard_normal(len(distance))) for _ in range(m)]
    return Rankings(tuple(f"{k + 1:02d}" for k in range(m)), tuple(PAINTS), np.array(ranks)[:, None])


def test_the_order_is_the_distance_from_the_reference():
    assert ORDER["distance"].to_numpy() == pytest.approx([0, *np.repeat([0.04, 0.08, 0.12], 5)], abs=1e-9)
    assert ORDER["angle_deg"].to_numpy()[1:] == pytest.approx(np.tile([0, 22.5, 45, 67.5, 90], 3))
    assert np.isnan(ORDER["angle_deg"].iloc[0])


def test_what_is_not_glossier_has_no_order_by_gloss_but_one_by_difference():
    paints = {"r": Paint(0.193, 0.05, 0.1), "more c, less d": Paint(0.193, 0.09, 0.12), "less": Paint(0.193, 0.01, 0.1)}
    assert predicted_order(paints, reference="r")["distance"].isna().tolist() == [False, True, True]
    by_difference = predicted_order(paints, reference="r", ranked_by="difference")["distance"]
    expected = [float(GlossSpace().distance(paints["r"], paint)) for paint in paints.values()]
    assert by_difference.tolist() == pytest.approx(expected)


def test_simulated_rankings_of_the_space_itself():
    study = study_ranking(simulated_rankings(), ORDER)
    assert study.mean_tau_b == pytest.approx(np.mean([one.tau_b for one in study.participants]))
    assert study.mean_tau_b > 0.8
    assert study.mean_tau_b_p == 1e-4  # the least that 9,999 permutations can say
    assert study.concordance > 0.8
    assert study.contours.n_pairs == 3 * 10
    assert study.contours.within < study.contours.between
    assert study.contours.p_value == 1e-4
    assert study.contours.direction.p_value > 0.05
    said = " ".join(study.sentences)
    assert "the ranks follow the predicted order" in said
    assert "(30 pairs within 0.004) got similar ranks" in said
    assert "cannot be shown to matter, as the space predicts" in said
    assert study.warnings == ()


def test_noiseless_rankings_agree_perfectly():
    study = study_ranking(simulated_rankings(3, noise_sd=0), ORDER)
    assert [one.tau_b for one in study.participants] == pytest.approx([1] * 3)
    assert study.concordance == pytest.approx(1)
    assert study.contours.within == pytest.approx(0)


@pytest.mark.parametrize(("weight_d", "more"), [(3.0, "more"), (1.0, "less")])
def test_another_weight_of_d_shows_along_contours(weight_d, more):
    study = study_ranking(simulated_rankings(weight_d=weight_d), ORDER)
    assert np.sign(study.contours.direction.lead) == np.sign(weight_d - 1.78)
    assert study.contours.direction.p_value < 0.01
    assert study.sentences[-1].endswith(f"in these rankings d counts {more} beside c than in the space.")


def test_mean_ranks_and_their_intervals_are_those_of_scipy():
    rankings = simulated_rankings(5)
    table = study_ranking(rankings, ORDER).stimuli.set_index("stimulus")
    for index, name in enumerate(rankings.stimuli):
        ranks = rankings.ranks[:, 0, index]
        assert table.loc[name, "mean_rank"] == pytest.approx(ranks.mean())
        if np.ptp(ranks) > 0:
            interval = ttest_1samp(ranks, 0).confidence_interval(0.95)
            assert table.loc[name, ["low", "high"]].tolist() == pytest.approx(list(interval))
    assert table["distance"].is_monotonic_increasing


def test_the_ceiling_is_the_agreement_with_the_others():
    rankings = simulated_rankings(4)
    study = study_ranking(rankings, ORDER)
    ranks = rankings.ranks[:, 0]
    expected = [kendalltau(np.delete(ranks, k, axis=0).mean(axis=0), ranks[k]).statistic for k in range(4)]
    assert study.ceiling == pytest.approx(np.mean(expected))
    alone = study_ranking(simulated_rankings(1), ORDER)
    assert (alone.ceiling, alone.concordance, alone.concordance_p) == (None, None, None)
    assert alone.stimuli["low"].isna().all()
    assert alone.sentences[0].startswith("1 participant ranked 16 stimuli.")


def test_repeats_are_averaged_and_their_numbers_do_not_matter():
    ranks = simulated_rankings(3).ranks
    twice = Rankings(("a", "b", "c"), tuple(PAINTS), np.concatenate([ranks, 10 * ranks + 7], axis=1))
    once = Rankings(("a", "b", "c"), tuple(PAINTS), ranks)
    pd.testing.assert_frame_equal(study_ranking(twice, ORDER).stimuli, study_ranking(once, ORDER).stimuli)


def test_odd_participants_are_named():
    rankings = simulated_rankings(5)
    ranks = rankings.ranks.copy()
    ranks[1] = 17 - ranks[1]
    ranks[2] = 4.0
    ranks[3, 0, 2:] = np.nan
    ranks[4, 0, 5] = np.nan
    study = study_ranking(Rankings(rankings.participants, rankings.stimuli, ranks), ORDER)
    assert [one.participant_id for one in study.participants] == ["01", "02", "05"]
    equal, turned, partial = study.warnings
    assert equal.startswith("Ranked all stimuli equal, or fewer than three")
    assert equal.endswith("left out: 03, 04.")
    assert turned.startswith("Ranked against the predicted order, perhaps with the scale reversed: 02. They stay in")
    assert partial.startswith("Ranked only some of the stimuli: 05.")


def test_everybody_reversed_is_said():
    rankings = simulated_rankings(4)
    study = study_ranking(Rankings(rankings.participants, rankings.stimuli, -rankings.ranks), ORDER)
    assert "the ranks run against the predicted order. Does rank 1 stand for the most gloss?" in study.sentences[0]


def test_a_stimulus_without_a_prediction_is_left_out_and_named():
    order = ORDER.copy()
    order.loc["0.04@0", "distance"] = np.nan
    study = study_ranking(simulated_rankings(3), order)
    assert len(study.stimuli) == 15
    assert study.stimuli["mean_rank"].sum() == pytest.approx(15 * 16 / 2)  # ranked anew among those that are left
    assert study.warnings[0].endswith("left out: 0.04@0.")


def test_without_contours_this_is_said():
    order = ORDER.assign(distance=np.arange(16) / 100)
    study = study_ranking(simulated_rankings(3), order)
    assert study.contours is None
    assert study.sentences[-1].startswith("No two stimuli lie on one isogloss contour")
    assert "nearest two differ by 0.01 in their distance" in study.sentences[-1]  # the steps of `order`


def test_the_seed_decides():
    first, again, other = (study_ranking(simulated_rankings(noise_sd=0.2), ORDER, seed=seed) for seed in (1, 1, 2))
    assert [one.tau_b_p for one in first.participants] == [one.tau_b_p for one in again.participants]
    assert [one.tau_b_p for one in first.participants] != [one.tau_b_p for one in other.participants]


@pytest.mark.parametrize(
    ("stimuli", "ranks", "options", "message"),
    [
        (("reference", "x", "0.04@0"), [1, 2, 3], {}, "'x' is not among the known stimuli \\(1 such\\)"),
        (("reference", "0.04@0"), [1, 2], {}, "needs three stimuli with a prediction, but 2 were ranked"),
        (("0.04@0", "0.04@45", "0.04@90"), [1, 2, 3], {}, "All 3 ranked stimuli lie at gloss distance 0.04"),
        (("reference", "0.04@0", "0.08@0"), [2, 2, 2], {}, "Nobody ranked three of the stimuli"),
        (("reference", "0.04@0", "0.08@0"), [1, 2, 3], {"tolerance": 0.0}, "Invalid tolerance = 0.0"),
        (("reference", "0.04@0", "0.08@0"), [1, 2, 3], {"n_permutations": 98}, "Invalid number of permutations 98"),
    ],
)
def test_mistakes(stimuli, ranks, options, message):
    with pytest.raises(GlossError, match=message):
        study_ranking(Rankings(("01",), stimuli, np.array([[ranks]], dtype=float)), ORDER, **options)


def test_an_unknown_reference_and_one_of_too_much_gloss():
    with pytest.raises(GlossError, match="The reference 'x' is not among the stimuli, such as reference, 0.04@0"):
        predicted_order(PAINTS, reference="x")
    glossy = predicted_order(PAINTS, reference="0.12@45")
    with pytest.raises(GlossError, match="choose the least glossy stimulus as the reference"):
        study_ranking(simulated_rankings(), glossy)


def test_the_figure_shows_each_stimulus_and_each_contour():
    study = study_ranking(simulated_rankings(), ORDER)
    axes = draw_ranking(study).axes[0]
    assert axes.lines[0].get_xydata() == pytest.approx(study.stimuli[["distance", "mean_rank"]].to_numpy())
    assert len(axes.patches) == 3
    (bars,) = axes.collections
    assert [segment[:, 1].tolist() for segment in bars.get_segments()] == [
        pytest.approx(row) for row in study.stimuli[["low", "high"]].to_numpy().tolist()
    ]


def test_stimuli_that_only_a_participant_left_out_ranked_are_left_out_with_him():
    """With no mean rank of theirs the contours were NaN, and their p the smallest that there is."""
    ranks = simulated_rankings().ranks.copy()
    few = tuple(PAINTS).index("0.04@45"), tuple(PAINTS).index("0.12@90")
    with_him = np.concatenate([ranks, np.full((1, *ranks.shape[1:]), np.nan)])
    with_him[:, :, few] = np.nan
    with_him[-1, 0, few] = [1, 2]
    names = tuple(f"{k}" for k in range(len(with_him)))
    found = study_ranking(Rankings(names, tuple(PAINTS), with_him), ORDER)

    kept = [k for k in range(len(PAINTS)) if k not in few]
    others = Rankings(names[:-1], tuple(np.array(list(PAINTS))[kept]), ranks[:, :, kept])
    expected = study_ranking(others, ORDER)
    pd.testing.assert_frame_equal(found.stimuli, expected.stimuli)
    assert (found.contours.within, found.contours.p_value) == (expected.contours.within, expected.contours.p_value)
    assert found.contours.direction == expected.contours.direction
    assert found.sentences == expected.sentences
    assert "Ranked by nobody else, and left out: 0.04@45, 0.12@90." in found.warnings


def test_left_out_stimuli_may_leave_one_distance():
    nan = np.nan
    order = pd.DataFrame({"distance": [0.1, 0.1, 0.1, 0.2], "angle_deg": 45.0}, index=list("abcd"))
    rankings = Rankings(("1", "2"), tuple("abcd"), np.array([[[1.0, 2.0, 3.0, nan]], [[nan, nan, 1.0, 2.0]]]))
    with pytest.raises(GlossError, match="All 3 ranked stimuli lie at gloss distance 0.1"):
        study_ranking(rankings, order)


def test_equal_mean_ranks_are_ties_whatever_their_sums_round_to():
    """Of three repeats mean ranks are thirds: 7/3 + 8/3 and 5/3 + 10/3 differ in their last digit, some of them."""
    rng = np.random.default_rng(0)
    names = tuple("abcdefghijkl")
    ranks = np.array([[rng.permutation(12) + 1.0 for _ in range(3)] for _ in range(5)])
    order = pd.DataFrame({"distance": np.arange(12) / 10, "angle_deg": 45.0}, index=list(names))
    study = study_ranking(Rankings(tuple("12345"), names, ranks), order, n_permutations=99)
    for k, one in enumerate(study.participants):
        sums = np.delete(ranks, k, axis=0).sum(axis=(0, 1))  # whole numbers, exact
        expected = kendalltau(sums, ranks[k].sum(axis=0)).statistic
        assert one.tau_b_others == pytest.approx(expected, rel=1e-12)  # rounding
