"""`gloss ranking` as a person types it."""

import json

import pytest

from glossspace.dataset import write_session_data
from glossspace.metric import GlossSpace
from tests.analysis.test_ranking import ORDER, PAINTS, simulated_rankings, study_ranking


@pytest.fixture
def files(tmp_path):
    stimuli, ranks = tmp_path / "stimuli.csv", tmp_path / "ranks.csv"
    rows = [f"{name},{','.join(repr(float(value)) for value in paint)}" for name, paint in PAINTS.items()]
    stimuli.write_text("\n".join(["stimulus,rho_d,rho_s,alpha", *rows]) + "\n", "utf-8")
    rankings = simulated_rankings(4)
    lines = [
        f"{participant},{stimulus},{rank!r}"
        for participant, row in zip(rankings.participants, rankings.ranks[:, 0].tolist(), strict=True)
        for stimulus, rank in zip(rankings.stimuli, row, strict=True)
    ]
    ranks.write_text("\n".join(["participant_id,stimulus,rank", *lines]) + "\n", "utf-8")
    return ranks, "--stimuli", stimuli


def test_numbers_of_the_library(gloss, files):
    code, out, err = gloss("ranking", *files, "--reference", "reference", "--permutations", 999, "--seed", 3, "--json")
    assert code == 0, err
    document = json.loads(out, parse_constant=pytest.fail)
    study = study_ranking(simulated_rankings(4), ORDER, n_permutations=999, seed=3)
    assert document["mean_tau_b"] == pytest.approx(study.mean_tau_b)
    assert [one["tau_b_p"] for one in document["participants"]] == [one.tau_b_p for one in study.participants]
    assert document["sentences"] == list(study.sentences)
    assert [len(names) for names in document["contours"]["stimuli"]] == [5, 5, 5]
    assert document["contours"]["direction"]["n_pairs"] == 30


def test_rank_1_may_be_the_most_glossy(gloss, files):
    words = ("ranking", *files, "--reference", "reference", "--json")
    least, most = (json.loads(gloss(*words, "--rank-1", which)[1])["mean_tau_b"] for which in ("least", "most"))
    assert most == pytest.approx(-least)


def test_for_a_person_and_with_a_figure_and_a_space(gloss, files, tmp_path):
    space = tmp_path / "space.json"
    GlossSpace(name="ours $1", provenance={"observers": ["01 (simulated)"]}).save(space)
    for kind, start in (("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")):
        figure = tmp_path / f"f.{kind}"
        code, out, err = gloss(
            "ranking", *files, "--reference", "reference", "--space", space, "--figure", figure, "--permutations", 99
        )
        assert code == 0, err
        assert figure.read_bytes().startswith(start)
    assert "the ranks follow the predicted order" in " ".join(out.split())
    assert "0.04@45" in out
    assert "rests on simulated participants" in err
    assert "ours $1 (simulated observers)" in (tmp_path / "f.svg").read_text("utf-8")


@pytest.fixture
def dataset(tmp_path):
    """Two simulated participants' sessions, as the session room writes them."""
    folder, rankings = tmp_path / "dataset", simulated_rankings(2, noise_sd=0.001)
    for participant, row in zip(rankings.participants, rankings.ranks[:, 0].astype(int).tolist(), strict=True):
        trials = [
            {"block": 1, "trial": 1, "repeat": 1, "response_time_s": None, "reference": "reference", "stimulus": name,
             "start_place": place, "rank": rank}
            for place, (name, rank) in enumerate(zip(rankings.stimuli, row, strict=True), start=1)
        ]  # fmt: skip
        write_session_data(
            folder, trials, kind="ranking", participant=participant, session="1", task="ranking", observer="simulated"
        )
    return folder


def test_a_dataset_knows_its_reference_and_who_is_simulated(gloss, refused, files, dataset, tmp_path):
    assert "has no stimuli.csv" in refused("ranking", dataset)
    figure = tmp_path / "f.svg"
    code, out, err = gloss("ranking", dataset, *files[1:], "--permutations", 99, "--figure", figure, "--json")
    assert code == 0, err
    document = json.loads(out)
    expected = study_ranking(simulated_rankings(2, noise_sd=0.001), ORDER, n_permutations=99)
    assert document["mean_tau_b"] == pytest.approx(expected.mean_tau_b)
    assert (document["reference"], document["simulated"]) == ("reference", ["01", "02"])
    assert "2 of 2 participants are simulated" in err
    assert "simulated participants: 2" in figure.read_text("utf-8")
    assert "was ranked round '0.04@0'. Allowed: reference." in refused("ranking", dataset, "--reference", "0.04@0")
    assert "holds no rank of the task 'other'" in refused("ranking", dataset, "--task", "other")


def test_mistakes(refused, files, tmp_path):
    assert "The reference 'x' is not among the stimuli" in refused("ranking", *files, "--reference", "x")
    known = ("--reference", "reference")
    assert "Invalid figure" in refused("ranking", *files, *known, "--figure", "a.txt")
    assert "is a file, where a folder is needed" in refused("ranking", *files, *known, "--figure", files[0] / "a.svg")
    assert "No gloss space" in refused("ranking", *files, *known, "--space", tmp_path / "no.json")
    assert "Invalid tolerance" in refused("ranking", *files, *known, "--tolerance", "-1")
    assert "Invalid number of permutations 5" in refused("ranking", *files, *known, "--permutations", "5")
    assert "does not tell the reference. Give --reference" in refused("ranking", *files)
    assert "--task is of a dataset folder" in refused("ranking", *files, *known, "--task", "other")
    assert "does not tell what its stimuli are. Give --stimuli" in refused("ranking", files[0], *known)
    assert "No rank table" in refused("ranking", tmp_path / "no.csv", *files[1:], *known)
    assert "--rank-1" in refused("ranking", *files, *known, "--rank-1", "best")
    assert "choose the least glossy stimulus" in refused("ranking", *files, "--reference", "0.12@45")
