"""`gloss design` and `gloss design-pairs` as a person types them."""

import itertools
import json

import numpy as np
import pandas as pd
import pytest

from gloss_analysis.design.pair_choice import choose_pairs
from gloss_analysis.design.population import Population, population_like
from gloss_analysis.design.precision import simulate_designs
from gloss_analysis.design.simulation import EXPERIMENT_1
from gloss_analysis.judgements.judgement_table import read_table
from glossspace.dataset import write_session_data
from glossspace.metric import GlossSpace
from glossspace.stimulus_set import stimulus_name
from tests.analysis.studies import EXPERIMENT_1 as STIMULI
from tests.analysis.studies import axis_values, judged_by

QUICK = ("--studies", "10")


@pytest.fixture
def stimuli(tmp_path):
    path = tmp_path / "stimuli.csv"
    STIMULI.to_csv(path, index=False)
    return path


@pytest.fixture
def dataset(tmp_path):
    """A pilot of four simulated participants and all of Experiment 1."""
    folder = tmp_path / "pilot"
    data = judged_by([1.4, 1.7, 1.9, 2.3], exponent=0.8, noise_sd=3.0, integers=True)
    for name, row in zip(("01", "02", "03", "04"), data.values, strict=True):
        trials = [
            {"block": 1, "trial": n, "repeat": 1, "response_time_s": None, "stimulus_left": f"s{a}",
             "stimulus_right": f"s{b}", "dissimilarity": int(value)}
            for n, ((a, b), value) in enumerate(zip(itertools.combinations(range(27), 2), row, strict=True), start=1)
        ]  # fmt: skip
        write_session_data(
            folder, trials, kind="pairwise", participant=name, session="1", task="pairwise", observer="simulated"
        )
    STIMULI.to_csv(folder / "stimuli.csv", index=False)
    return folder


def test_numbers_of_the_library(gloss):
    code, out, err = gloss(
        "design", "--width", "1.5", "--observers", "4,6:7", "--pairs", "351,150", "--repeats", "1,2", *QUICK, "--json"
    )  # fmt: skip
    assert code == 0, err
    document = json.loads(out, parse_constant=pytest.fail)
    sets = [np.ones(351, dtype=bool), choose_pairs(EXPERIMENT_1, 150, Population()).kept]
    expected = simulate_designs(
        EXPERIMENT_1, Population(), observers=[4, 6, 7], pair_sets=sets, repeats=[1, 2], n_studies=10
    )  # fmt: skip
    assert [one["width_p90"] for one in document["designs"]] == [one.width_p90 for one in expected]
    assert [one["coverage"] for one in document["designs"]] == [one.coverage for one in expected]
    assert document["simulated"] is True
    narrow = [one for one in document["designs"] if one["width_median"] <= 1.5]
    assert document["smallest_expected"]["n_judgements"] == min(one["n_judgements"] for one in narrow)


def test_for_a_person(gloss):
    code, out, err = gloss("design", "--observers", "3,8", "--width", "1.6", *QUICK)
    assert code == 0, err
    assert "Simulated observers, as stated: weight of d 1.78" in out
    assert "95 % intervals of 10 simulated studies" in out
    assert "wide in half of the studies: 8 observers, 351 pairs, once each, 2,808 judgements in all" in out
    code, out, _ = gloss("design", "--observers", "3", "--width", "1.001", *QUICK)
    assert code == 0
    assert out.count("No design has intervals up to 1.001 wide") == 2


def test_a_pilot_and_a_space(gloss, dataset, tmp_path):
    code, out, err = gloss("design", "--like", dataset, "--observers", "3", *QUICK, "--json")
    assert code == 0, err
    assert "4 of 4 participants are simulated" in err
    assert "rests on 4 participants" in err
    document = json.loads(out)["population"]
    data = read_table(dataset)
    place = axis_values()[[STIMULI["stimulus"].tolist().index(name) for name in data.stimuli]]
    expected = population_like(data, place, axes=("c", "d")).population
    for name in ("ratio", "sd_log_ratio", "exponent", "noise_sd"):
        assert document[name] == pytest.approx(getattr(expected, name))
    assert document["of_them_simulated"] == ["01", "02", "03", "04"]

    space = tmp_path / "space.json"
    GlossSpace(weight_c=2.0, weight_d=5.0, provenance={"observers": ["p (simulated)"]}).save(space)
    given = ("--space", space, "--noise-sd", "1.5", "--slider-step", "5")
    code, out, err = gloss("design", "--like", dataset, *given, "--observers", "3", *QUICK, "--json")
    assert code == 0, err
    document = json.loads(out)["population"]
    assert (document["ratio"], document["noise_sd"], document["slider_step"]) == (2.5, 1.5, 5)
    assert document["exponent"] == pytest.approx(expected.exponent)
    assert "rests on simulated participants" in err


def test_pairs_for_a_protocol(gloss, tmp_path):
    out_file = tmp_path / "new" / "pairs.csv"
    code, out, err = gloss(
        "design-pairs", "--keep", "120", "--degree", "4", "--identical", "--out", out_file, "--observers", "4", *QUICK,
        "--json",
    )  # fmt: skip
    assert code == 0, err
    document = json.loads(out, parse_constant=pytest.fail)
    written = pd.read_csv(out_file)
    assert list(written.columns) == ["stimulus_a", "stimulus_b"]
    assert [tuple(pair) for pair in document["pairs"]] == list(written.itertuples(index=False, name=None))
    alike = written["stimulus_a"] == written["stimulus_b"]
    assert (alike.sum(), (~alike).sum()) == (27, 120)
    assert not written.duplicated().any()
    # Names that the rendered set of Experiment 1 has.
    assert stimulus_name(0.193, 0.066, 0.07) in set(written["stimulus_a"]) | set(written["stimulus_b"])
    counts = written[~alike].melt()["value"].value_counts()
    assert counts.min() >= 4
    assert {name: one["n_pairs"] for name, one in document["designs"].items()} == {
        "chosen": 120, "random": 120, "all": 351,
    }  # fmt: skip
    # It may be made again, and other files may not be replaced.
    again = gloss("design-pairs", "--keep", "120", "--studies", "0", "--out", out_file)
    assert again[0] == 0


def test_pairs_for_a_person(gloss, stimuli):
    code, out, err = gloss("design-pairs", "--share", ".5", "--stimuli", stimuli, "--observers", "4", *QUICK)
    assert code == 0, err
    assert "176 of 351 pairs. One observer's own weight is known" in out
    assert all(word in out for word in ("chosen", "random", "all", "error of one observer"))
    assert "Give --out FILE.csv" in err


def test_a_regular_grid_has_too_few_distances_for_the_choice_and_is_told_so(gloss, tmp_path):
    # Three by three: eight different distances, fewer than the eleven columns of the unknown response.
    grid = tmp_path / "grid.csv"
    c, alpha = (axis.ravel() for axis in np.meshgrid([0.1, 0.2, 0.3], [0.05, 0.1, 0.15]))
    pd.DataFrame({"stimulus": range(9), "rho_d": 0.0, "rho_s": c**3, "alpha": alpha}).to_csv(grid, index=False)
    given = ("design-pairs", "--keep", "20", "--stimuli", grid, "--studies", "0")
    code, out, err = gloss(*given, "--json")
    document = json.loads(out)
    assert (code, document["relative_error"], len(document["pairs"])) == (0, None, 20)
    assert document["warnings"][0].startswith("By local information not even all pairs tell the weight")
    code, out, err = gloss(*given)
    assert "20 of 36 pairs.\n" in out
    assert "nan" not in out
    assert "By local information not even all pairs tell the weight" in err


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (("design", "--width", "1"), "Invalid width = 1.0"),
        (("design", "--observers", "1:4"), "Allowed: 2 to"),
        (("design", "--observers", "9:4"), "from low to high"),
        (("design", "--observers", "many"), "numbers and ranges such as"),
        (("design", "--observers", "501"), "up to 500"),
        (("design", "--repeats", "0"), "Allowed: 1 to"),
        (("design", "--pairs", "12"), "needs 41"),
        (("design", "--pairs", "1000"), "27 stimuli have 351 pairs"),
        (("design", "--studies", "9"), "Allowed: 10 to"),
        (("design", "--noise-sd", "-1"), "Invalid noise_sd = -1.0"),
        (("design", "--space", "no.json"), "no.json"),
        (("design", "--like", "no-such"), "no-such"),
        (("design", "--stimuli", "no.csv"), "No stimulus table"),
        (("design-pairs",), "either --keep 120 or --share .25"),
        (("design-pairs", "--keep", "90", "--share", ".5"), "either --keep"),
        (("design-pairs", "--share", "1.5"), "above 0, up to 1"),
        (("design-pairs", "--keep", "90", "--degree", "0"), "Invalid degree = 0"),
        (("design-pairs", "--keep", "90", "--studies", "5"), "Allowed: 0, or 10"),
        (("design-pairs", "--keep", "90", "--observers", "1"), "Allowed: 2 to"),
    ],
)
def test_mistakes(refused, words, why):
    assert why in refused(*words)


def test_mistakes_in_files(refused, pairs, stimuli, dataset, tmp_path):
    assert "Give --stimuli" in refused("design", "--like", pairs)
    short = tmp_path / "short.csv"
    STIMULI[1:].to_csv(short, index=False)
    assert "'s0' was judged" in refused("design", "--like", pairs, "--stimuli", short)
    assert "is no list of pairs" in refused("design-pairs", "--keep", "90", "--out", pairs)
    assert "is no list of pairs" in refused("design-pairs", "--keep", "90", "--out", stimuli)
    same = tmp_path / "same.csv"
    STIMULI.assign(alpha=0.04).to_csv(same, index=False)
    assert "at one place on an axis" in refused("design", "--stimuli", same, *QUICK)
    assert "at one place on an axis" in refused("design-pairs", "--keep", "90", "--stimuli", same)
    two = tmp_path / "two.csv"
    STIMULI[:2].to_csv(two, index=False)
    message = refused("design", "--stimuli", two, *QUICK)
    assert "two.csv' holds 2 stimuli. A study needs at least 3. Add rows." in message
    many = tmp_path / "many.csv"
    pd.DataFrame({"stimulus": range(150), "rho_d": 0.1, "rho_s": 0.05, "alpha": np.linspace(0.01, 0.2, 150)}).to_csv(
        many, index=False
    )
    for command in (("design",), ("design-pairs", "--keep", "90")):
        assert "150 stimuli have 11,175 pairs. Allowed: up to 10,000 pairs." in refused(*command, "--stimuli", many)
    header = tmp_path / "header.csv"
    header.write_text("stimulus,rho_d,rho_s,alpha\n")
    assert "holds no stimulus. Add a row for each" in refused("design", "--stimuli", header, *QUICK)
    assert "holds no stimulus. Add a row for each" in refused("design-pairs", "--share", ".5", "--stimuli", header)
