"""`gloss confirm`: what INDSCAL and ratings add, as a person and a program read it."""

import json

import numpy as np
import pandas as pd
import pytest

from gloss_analysis.confirmatory.indscal import confirm_indscal
from gloss_analysis.confirmatory.task_identity import compare_tasks
from gloss_analysis.judgements.judgement_table import read_table
from tests.analysis.studies import STIMULI, axis_values


@pytest.fixture
def axes(tmp_path):
    """c and d of the eight stimuli of the table `pairs`."""
    path = tmp_path / "axes.csv"
    c, d = axis_values()[:8].T
    pd.DataFrame({"stimulus": STIMULI, "c": c, "d": d}).to_csv(path, index=False)
    return path


@pytest.fixture
def ratings(tmp_path):
    """Two simulated participants who rated the eight stimuli along c."""
    path = tmp_path / "m.csv"
    rows = [
        (who, name, "c", 10 + 300 * c + 1)
        for who in "12"
        for name, c in zip(STIMULI, axis_values()[:8, 0], strict=True)
    ]
    pd.DataFrame(rows, columns=["participant_id", "stimulus", "axis", "rating"]).to_csv(path, index=False)
    return path


def test_indscal_is_in_the_document_with_and_without_its_test(gloss, pairs, axes):
    code, out, err = gloss("confirm", pairs, "--coordinates", axes, "--json")
    assert (code, err) == (0, "")
    document = json.loads(out, parse_constant=pytest.fail)
    expected = confirm_indscal(read_table(pairs), axis_values()[:8], axes=("c", "d"))
    # A number read from a file may miss its last bit, which moves where the search stops on a plateau.
    assert document["indscal"]["stress1"] == pytest.approx(expected.stress1, rel=1e-6)
    assert np.array(document["indscal"]["squared_weights"]) == pytest.approx(expected.squared_weights, rel=1e-6)
    assert document["indscal"]["participants"] == ["p0", "p1", "p2"]
    assert document["indscal"]["p_value"] is None
    assert document["tasks"] is None
    code, out, _ = gloss("confirm", pairs, "--coordinates", axes, "--indscal", 9, "--seed", 4, "--jobs", 2, "--json")
    assert code == 0
    tested = confirm_indscal(read_table(pairs), axis_values()[:8], axes=("c", "d"), n_permutations=9, seed=4)
    found = json.loads(out)["indscal"]
    assert found["p_value"] == tested.p_value  # a count
    assert found["n_permutations"] == 9
    assert found["sentences"] == list(tested.sentences)  # to four digits


def test_a_person_reads_of_own_weights_and_of_one_transformation(gloss, pairs, axes):
    code, out, _ = gloss("confirm", pairs, "--coordinates", axes)
    assert code == 0
    assert "INDSCAL: own weights: Stress-1" in out
    assert "The best combinations of these axes lie" in out
    code, out, _ = gloss("confirm", pairs, "--coordinates", axes, "--unconditional")
    assert code == 0
    assert "INDSCAL: own weights, one transformation for all: Stress-1" in out


def test_ratings_are_compared(gloss, pairs, axes, ratings):
    code, out, err = gloss("confirm", pairs, "--coordinates", axes, "--magnitudes", ratings, "--json")
    assert code == 0, err
    (found,) = json.loads(out, parse_constant=pytest.fail)["tasks"]
    table = pd.read_csv(ratings, dtype={"participant_id": str})
    (expected,) = compare_tasks(read_table(pairs), axis_values()[:8], {"c": table}, axes=("c", "d"))
    assert found["axis"] == "c"
    assert found["stimuli"] == STIMULI
    assert found["regression"]["r_squared"] == pytest.approx(expected.regression.r_squared, rel=1e-6)  # as above
    assert found["stress1_rated"] == pytest.approx(expected.stress1_rated, rel=1e-6)
    code, out, _ = gloss("confirm", pairs, "--coordinates", axes, "--magnitudes", ratings)
    assert code == 0
    assert "Axis c: 8 of 8 rated stimuli were judged in pairs too. Ratings over MDS scale values: r² =" in out


def test_mistakes(refused, pairs, axes, ratings, tmp_path):
    confirm = ["confirm", pairs, "--coordinates", axes]
    assert "Leave it out, or --unconditional" in refused(*confirm, "--indscal", 9, "--unconditional")
    assert "Invalid --indscal -1. Allowed: 0 to 1,000,000" in refused(*confirm, "--indscal=-1")
    huge = tmp_path / "huge.csv"
    huge.write_text("stimulus,c,d\n" + "".join(f"{name},{k + 1}e300,{k % 3}\n" for k, name in enumerate(STIMULI)))
    assert "the coordinates on the axis 'c' differ by 7e+300" in refused(*confirm[:2], "--coordinates", huge)
    assert "No rating table at" in refused(*confirm, "--magnitudes", tmp_path / "nowhere.csv")
    assert "is no dataset" in refused(*confirm, "--magnitudes", tmp_path)
    ratings.write_text(ratings.read_text().replace(",c,", ",x,"))
    assert "axis 'x' is not known. Allowed: c, d" in refused(*confirm, "--magnitudes", ratings)
