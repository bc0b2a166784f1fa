"""`gloss validate` as a person types it."""

import itertools
import json

import numpy as np
import pytest

from gloss_analysis.judgements.judgement_table import read_table
from gloss_analysis.validation.metric_validation import compare_metrics
from glossspace.dataset import write_session_data
from glossspace.metric import GlossSpace, Paint
from tests.analysis.studies import EXPERIMENT_1, STIMULI, judged_by


@pytest.fixture
def stimuli(tmp_path):
    path = tmp_path / "stimuli.csv"
    EXPERIMENT_1.to_csv(path, index=False)
    return path


@pytest.fixture
def space(tmp_path):
    path = tmp_path / "space.json"
    GlossSpace(name="mine", weight_d=9.0, provenance={"participants": ["p0"], "observers": ["p0 (simulated)"]}).save(
        path
    )
    return path


def test_numbers_of_the_library(gloss, pairs, stimuli, space):
    code, out, err = gloss("validate", pairs, "--space", "paper", "--stimuli", stimuli, "--against", space, "--json")
    assert code == 0, err
    document = json.loads(out)
    data = read_table(pairs)
    rows = EXPERIMENT_1.set_index("stimulus").loc[list(data.stimuli)]
    paints = [rows[["rho_d", "rho_s", "alpha"]].to_numpy()[index].T for index in data.pairs]
    predicted = [
        np.array([one.distance(Paint(*a), Paint(*b)) for a, b in zip(paints[0].T, paints[1].T, strict=True)])
        for one in (GlossSpace(), GlossSpace(weight_d=9.0))
    ]
    expected = compare_metrics(data, *predicted)
    assert document["stress"] == pytest.approx(expected.first.stress.tolist())
    assert document["ceiling"] == pytest.approx(expected.first.ceiling)
    assert document["against"]["f_ratio"] == pytest.approx(expected.f_ratio)
    assert document["against"]["better"] == "space"
    assert document["simulated"] == []
    assert "simulated participants (1 of 1)" in err
    assert "fitted to participants of these names: p0" in err


def test_noiseless_observers_of_the_space_itself(gloss, tmp_path, stimuli):
    data = judged_by([1.78, 1.78])
    rows = ["participant_id,stimulus_a,stimulus_b,dissimilarity"]
    for name, values in zip(data.participants, data.values, strict=True):
        for a, b, value in zip(*data.pairs, values, strict=True):
            rows.append(f"{name},s{a},s{b},{value!r}")
    path = tmp_path / "exact.csv"
    path.write_text("\n".join(rows).replace("np.float64(", "").replace(")", "") + "\n")
    code, out, _ = gloss("validate", path, "--stimuli", stimuli, "--json")
    assert code == 0
    assert json.loads(out)["mean_stress"] == pytest.approx(0, abs=1e-6)


def test_for_a_person_and_with_a_figure(gloss, pairs, stimuli, space, tmp_path):
    figure = tmp_path / "f.png"
    code, out, err = gloss(
        "validate", pairs, "--space", space, "--stimuli", stimuli, "--against", "paper", "--figure", figure
    )
    assert code == 0, err
    assert all(word in out for word in ("STRESS % of mine", "Ceiling", "F = ", "p2", "Better: Pellacini"))
    assert figure.read_bytes().startswith(b"\x89PNG")


def test_mistakes(refused, pairs, stimuli, tmp_path):
    assert "Give --stimuli" in refused("validate", pairs)
    assert "No gloss space" in refused("validate", pairs, "--stimuli", stimuli, "--space", tmp_path / "no.json")
    assert "Invalid figure" in refused("validate", pairs, "--stimuli", stimuli, "--figure", "a.txt")
    assert "is a file, where a folder is needed" in refused(
        "validate", pairs, "--stimuli", stimuli, "--figure", pairs / "a.svg"
    )
    assert "Check the path" in refused("validate", tmp_path / "no.csv")
    short = tmp_path / "short.csv"
    EXPERIMENT_1[EXPERIMENT_1["stimulus"] != STIMULI[0]].to_csv(short, index=False)
    assert repr(STIMULI[0]) in refused("validate", pairs, "--stimuli", short)


def test_a_dataset_knows_its_stimuli_and_who_is_simulated(gloss, refused, tmp_path):
    folder = tmp_path / "dataset"
    values = dict(zip(itertools.combinations(range(27), 2), judged_by([1.78], integers=True).values[0], strict=True))
    trials = [
        {"block": 1, "trial": n, "repeat": 1, "response_time_s": None, "stimulus_left": f"s{a}",
         "stimulus_right": f"s{b}", "dissimilarity": int(values[a, b])}
        for n, (a, b) in enumerate(itertools.combinations(range(8), 2), start=1)
    ]  # fmt: skip
    write_session_data(
        folder, trials, kind="pairwise", participant="01", session="1", task="pairwise", observer="simulated"
    )
    assert "has no stimuli.csv" in refused("validate", folder)
    EXPERIMENT_1.to_csv(folder / "stimuli.csv", index=False)
    code, out, err = gloss("validate", folder, "--json")
    assert code == 0, err
    document = json.loads(out, parse_constant=pytest.fail)
    assert document["simulated"] == ["01"]
    assert document["ceiling"] is None
    assert document["mean_stress"] < 1  # whole numbers up to 95 round by half a per cent
    assert "1 of 1 participants are simulated" in err
