"""Bad data, said in words: what each command answers to a participant or a study that went wrong, and its exit code."""

import itertools
import json

import numpy as np
import pandas as pd
import pytest

from gloss_analysis.judgements.judgement_table import from_table
from gloss_analysis.judgements.participant_remarks import judgement_remarks, rating_remarks
from glossspace.errors import GlossError
from glossspace.metric import contrast_gloss, distinctness
from tests.analysis.studies import EXPERIMENT_1, named

RATED = pd.DataFrame(
    [
        *(
            (f"c{k}", *paint)
            for k, paint in enumerate(itertools.product((0.03, 0.193, 0.767), (0.033, 0.066, 0.099), (0.04,)))
        ),
        *((f"d{k}", 0.03, 0.099, alpha) for k, alpha in enumerate((0.01, 0.04, 0.07, 0.1, 0.15))),
    ],
    columns=EXPERIMENT_1.columns,
)


def judged(stimuli=EXPERIMENT_1, ratios=(1.5, 1.6, 1.78, 2.0, 2.1), seed=1):
    """Five simulated participants with noise, all pairs and identical ones: a clean study."""
    rng = np.random.default_rng(seed)
    c, d = contrast_gloss(stimuli["rho_d"], stimuli["rho_s"]), distinctness(stimuli["alpha"])
    names = stimuli["stimulus"].tolist()
    rows = []
    for k, ratio in enumerate(ratios):
        pairs = list(itertools.combinations_with_replacement(range(len(names)), 2))
        apart = np.array([np.hypot(c[a] - c[b], ratio * (d[a] - d[b])) for a, b in pairs])
        answers = np.clip(np.round(95 * apart / apart.max() + 3 * rng.standard_normal(len(pairs))), 0, 100)
        rows += [(f"p{k}", names[a], names[b], value) for (a, b), value in zip(pairs, answers, strict=True)]
    return pd.DataFrame(rows, columns=["participant_id", "stimulus_a", "stimulus_b", "dissimilarity"])


def rated():
    """Three simulated participants who rated nine stimuli along c and five along d."""
    rng = np.random.default_rng(2)
    c = 5 + 350 * contrast_gloss(RATED["rho_d"], RATED["rho_s"])
    ideal = np.where(RATED["stimulus"].str.startswith("c"), c, 100 - 500 * RATED["alpha"])
    rows = [
        (who, name, name[0], float(np.clip(np.round(value + 2 * rng.standard_normal()), 0, 100)))
        for who in ("p0", "p1", "p2")
        for name, value in zip(RATED["stimulus"], ideal, strict=True)
    ]
    return pd.DataFrame(rows, columns=["participant_id", "stimulus", "axis", "rating"])


@pytest.fixture
def study(tmp_path):
    """Write a study; give the words of each command on it."""

    def write(pairs=None, ratings=None, stimuli=EXPERIMENT_1):
        pairs = judged(stimuli) if pairs is None else pairs
        pairs.to_csv(tmp_path / "p.csv", index=False)
        pd.concat([stimuli, RATED]).to_csv(tmp_path / "s.csv", index=False)
        pd.DataFrame(
            {
                "stimulus": stimuli["stimulus"],
                "c": contrast_gloss(stimuli["rho_d"], stimuli["rho_s"]),
                "d": distinctness(stimuli["alpha"]),
            }
        ).to_csv(tmp_path / "axes.csv", index=False)
        magnitudes = []
        if ratings is not None:
            ratings.to_csv(tmp_path / "m.csv", index=False)
            magnitudes = ["--magnitudes", tmp_path / "m.csv"]
        tables = ["--pairs", tmp_path / "p.csv", "--stimuli", tmp_path / "s.csv", *magnitudes]
        return {
            "confirm": ["confirm", tmp_path / "p.csv", "--coordinates", tmp_path / "axes.csv"],
            "fit": ["fit", *tables, "--out", tmp_path / "space.json"],
            "mds": ["mds", tmp_path / "p.csv", "--dims", "2", "--starts", "2"],
            "validate": ["validate", tmp_path / "p.csv", "--stimuli", tmp_path / "s.csv"],
            "hypotheses": ["hypotheses", *tables],
        }

    return write


def said(gloss, words):
    """What a command says on stderr, where it must succeed; progress apart."""
    code, _, err = gloss(*words)
    assert code == 0, err
    return " ".join(line for line in err.splitlines() if "━" not in line)


def of(pairs, participant):
    return pairs["participant_id"] == participant


CLEAN = {"confirm", "fit", "mds", "validate"}


@pytest.mark.parametrize("command", sorted(CLEAN))
def test_nothing_is_said_of_a_clean_study(gloss, study, command):
    assert said(gloss, study()[command]) == ""


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("confirm", "These participants distinguished no pairs and add nothing but a stress of 0"),
        ("fit", "These participants distinguished no pairs and add nothing but a stress of 0"),
        ("mds", "These participants distinguished no pairs and add nothing but a stress of 0"),
        ("validate", "Judged all pairs alike, or none that is predicted to differ; left out: p1"),
        ("hypotheses", "These participants distinguished no pairs and add nothing but a stress of 0"),
    ],
)
def test_always_fifty(gloss, study, command, message):
    pairs = judged()
    pairs.loc[of(pairs, "p1"), "dissimilarity"] = 50
    found = said(gloss, study(pairs)[command])
    assert message in found
    assert "p1" in found
    assert "Identical pairs" not in found  # one remark on one slip


@pytest.mark.parametrize("command", ["confirm", "mds", "validate", "hypotheses"])
def test_a_reversed_scale(gloss, study, command):
    pairs = judged()
    pairs.loc[of(pairs, "p1"), "dissimilarity"] = 100 - pairs["dissimilarity"]
    found = said(gloss, study(pairs)[command])
    assert "Judged pairs in the opposite order to the others: p1 (rank correlation -0.9" in found
    assert "Identical pairs are judged more different than different ones, on average: p1 (9" in found
    assert "Was the scale reversed?" in found
    if command in ("confirm", "hypotheses"):
        assert "leave these participants out to see how far it moves" in found


def test_a_reversed_scale_in_a_fit(gloss, study):
    pairs = judged()
    pairs.loc[of(pairs, "p1"), "dissimilarity"] = 100 - pairs["dissimilarity"]
    found = said(gloss, study(pairs)["fit"])
    assert "so that the ratio tells nothing, for: p1. Was the scale reversed?" in found


@pytest.mark.parametrize("command", ["confirm", "mds", "validate", "hypotheses"])
def test_half_the_pairs(gloss, study, command):
    pairs = judged()
    own = pairs.index[of(pairs, "p1") & (pairs["stimulus_a"] != pairs["stimulus_b"])]
    found = said(gloss, study(pairs.drop(index=own[: len(own) // 2]))[command])
    # 351 pairs of 27 stimuli, of which 175 are gone.
    assert "Judged fewer pairs than the others, whose median is 351 of 351: p1 (176)" in found


@pytest.mark.parametrize("command", ["confirm", "mds", "validate", "hypotheses"])
def test_identical_pairs_that_are_not_near_zero(gloss, study, command):
    pairs = judged()
    same = of(pairs, "p1") & (pairs["stimulus_a"] == pairs["stimulus_b"])
    pairs.loc[same, "dissimilarity"] = 25
    found = said(gloss, study(pairs)[command])
    assert "Identical pairs are not judged near 0, on average: p1 (25, different ones" in found
    assert "the lower end of the scale means no difference?" in found


@pytest.mark.parametrize("command", ["confirm", "mds", "validate"])
def test_remarks_are_in_the_json_too(gloss, study, command):
    pairs = judged()
    pairs.loc[of(pairs, "p1"), "dissimilarity"] = 100 - pairs["dissimilarity"]
    code, out, _ = gloss(*study(pairs)[command], "--json")
    assert code == 0
    assert any("opposite order" in warning for warning in json.loads(out)["warnings"])


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("fit", "have one lightness (rho_d 0.193): how c depends on lightness cannot be told"),
        (
            "validate",
            "All judged stimuli have rho_d = 0.193: of a space, how c depends on lightness is not tested here",
        ),
        ("hypotheses", "All judged stimuli have one lightness (rho_d 0.193): forms of c that differ in how it depends"),
    ],
)
def test_one_lightness(gloss, study, command, message):
    one = EXPERIMENT_1[EXPERIMENT_1["rho_d"] == 0.193].reset_index(drop=True)
    assert message in said(gloss, study(stimuli=one)[command])


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (
            "confirm",
            "same coordinate on the axis 'd': its weight cannot be known. Judge stimuli that differ along it, or",
        ),
        ("fit", "All stimuli that were judged in pairs have the same d, 0.96"),
        ("hypotheses", "same coordinate on the axis 'd': its weight cannot be known"),
    ],
)
def test_one_alpha(refused, study, command, message):
    one = EXPERIMENT_1[EXPERIMENT_1["alpha"] == 0.04].reset_index(drop=True)
    assert message in refused(*study(stimuli=one)[command])


def test_one_alpha_tests_no_distinctness(gloss, study):
    one = EXPERIMENT_1[EXPERIMENT_1["alpha"] == 0.04].reset_index(drop=True)
    found = said(gloss, study(stimuli=one)["validate"])
    assert "All judged stimuli have alpha = 0.04: of a space, what it says of distinctness d is not tested" in found


@pytest.mark.parametrize("value", [0, 100])
@pytest.mark.parametrize("command", ["confirm", "fit", "mds", "validate", "hypotheses"])
def test_all_the_same(refused, study, command, value):
    message = {"validate": "No participant's judgements can be compared with the predictions. Judged all pairs alike"}
    expected = message.get(command, "Every participant gave all pairs the same dissimilarity")
    assert expected in refused(*study(judged().assign(dissimilarity=value))[command])


@pytest.mark.parametrize("value", [0, 100])
def test_ratings_all_the_same(refused, study, value):
    words = study(ratings=rated().assign(rating=value))
    assert f"all stimuli have the same mean rating, {value}, and there is nothing to fit" in refused(*words["fit"])
    found = refused(*words["hypotheses"])
    assert f"All ratings are {value}: there is no relation to the axis to fit" in found


@pytest.mark.parametrize("text", ["nan", "inf", "-3", "red", "1e400", "NaN", "-inf"])
@pytest.mark.parametrize("command", ["confirm", "fit", "mds", "validate", "hypotheses"])
def test_text_in_judgements(refused, study, command, text):
    pairs = judged().astype({"dissimilarity": object})
    pairs.loc[3, "dissimilarity"] = text
    message = refused(*study(pairs)[command])
    assert f"line 5: dissimilarity {text!r} is not allowed. Allowed: a finite number >= 0, or an empty cell" in message


@pytest.mark.parametrize("text", ["nan", "inf", "-3", "red", "1e400"])
@pytest.mark.parametrize("command", ["fit", "hypotheses"])
def test_text_in_ratings(refused, study, command, text):
    ratings = rated().astype({"rating": object})
    ratings.loc[3, "rating"] = text
    message = refused(*study(ratings=ratings)[command])
    allowed = "0, a number from 1e-100 to 1e+100, or an empty cell"
    assert f"line 5: rating {text!r} is not allowed. Allowed: {allowed}" in message


class TestRaters:
    """What `gloss hypotheses` and `gloss confirm --magnitudes` say of single raters."""

    def test_always_fifty(self, gloss, study):
        ratings = rated()
        ratings.loc[of(ratings, "p1"), "rating"] = 50
        found = said(gloss, study(ratings=ratings)["hypotheses"])
        assert "Ratings along c, participant p1: constant: every rating is 50." in found

    def test_a_reversed_scale(self, gloss, study):
        ratings = rated()
        ratings.loc[of(ratings, "p1"), "rating"] = 100 - ratings["rating"]
        found = said(gloss, study(ratings=ratings)["hypotheses"])
        assert "Ratings along c, participant p1: reversed: correlation -" in found

    def test_half_the_ratings(self, refused, study):
        ratings = rated()
        own = ratings.index[of(ratings, "p1")]
        message = refused(*study(ratings=ratings.drop(index=own[::2]))["hypotheses"])
        assert (
            "Participant p1 has no rating of the stimulus c0. Finish the session, or leave the participant or"
            in message
        )

    def test_confirm_hears_of_them_too(self, gloss, study):
        stimuli = pd.concat([EXPERIMENT_1, RATED]).drop_duplicates(["rho_d", "rho_s", "alpha"]).reset_index(drop=True)
        ratings = rated()
        place = {tuple(paint): name for name, *paint in stimuli.itertuples(index=False)}
        ratings["stimulus"] = ratings["stimulus"].map(
            {name: place[tuple(paint)] for name, *paint in RATED.itertuples(index=False)}
        )
        ratings.loc[of(ratings, "p1"), "rating"] = 100 - ratings["rating"]
        words = study(ratings=ratings, stimuli=stimuli)
        code, out, err = gloss(*words["confirm"], *words["fit"][5:7])
        assert code == 0, err
        assert "Ratings along c, participant p1: reversed" in err
        assert "Axis c: 9 of 9 rated stimuli were judged in pairs too" in out


def test_two_participants_are_both_named():
    up = np.arange(1.0, 16)
    (remark,) = judgement_remarks(named([up, 20 - up], 6))
    assert remark.startswith("The two participants judged pairs in opposite orders: p0 (rank correlation -1.00), p1")


def test_an_incomplete_design_is_no_half_finished_session():
    # Everybody judged another third of the pairs.
    values = np.tile(np.arange(1.0, 16), (3, 1))
    for k in range(3):
        values[k, np.arange(15) % 3 != k] = np.nan
    assert judgement_remarks(named(values, 6)) == ()


def test_nobody_judged_anything():
    assert judgement_remarks(named(np.full((2, 15), np.nan), 6)) == ()


def test_huge_judgements_are_remarked_on_like_others():
    pairs = judged()
    pairs["dissimilarity"] = pairs["dissimilarity"].astype(float)
    pairs.loc[of(pairs, "p1") & (pairs["stimulus_a"] == pairs["stimulus_b"]), "dissimilarity"] = 25
    (remark,) = judgement_remarks(from_table(pairs), pairs)
    huge = pairs.assign(dissimilarity=pairs["dissimilarity"] * 1e306)  # whose sum is more than a number can hold
    (said,) = judgement_remarks(from_table(huge), huge)
    assert "p1 (25, different ones" in remark
    assert "p1 (2.5e+307, different ones" in said


def test_noise_makes_no_remark():
    # Twenty clean studies of three participants, of other ratios and noise, whose slider cannot go below 0.
    for seed in range(20):
        ratios = np.exp(np.log(1.78) + 0.15 * np.random.default_rng(seed).standard_normal(3))
        pairs = judged(ratios=ratios, seed=seed)
        assert judgement_remarks(from_table(pairs), pairs) == ()


def test_unfinished_ratings_name_their_axis():
    table = pd.DataFrame({"participant_id": ["1", "1", "2"], "stimulus": ["a", "b", "a"], "rating": [1.0, 2.0, 3.0]})
    with pytest.raises(GlossError, match="Ratings along d: Participant 2 has no rating of the stimulus b"):
        rating_remarks({"d": table})
