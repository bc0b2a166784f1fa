"""`gloss mds` on every kind of table, with every kind of answer."""

import json

import numpy as np
import pytest
from scipy.spatial.distance import pdist, squareform

from gloss_analysis.mds import load_solution


def written(path, *lines):
    path.write_text("\n".join(lines) + "\n")
    return path


def matrix_lines(square, names, corner=True):
    yield ("," if corner else "") + ",".join(names)
    for name, row in zip(names, square, strict=True):
        cells = ["" if np.isnan(value) else repr(float(value)) for value in row]
        yield ",".join([name, *cells] if corner else cells)


@pytest.fixture
def square():
    return squareform(pdist(np.random.default_rng(0).standard_normal((6, 2))))


@pytest.mark.parametrize("corner", [True, False])
def test_a_square_matrix_is_one_source(gloss, tmp_path, square, corner):
    table = written(tmp_path / "m.csv", *matrix_lines(square, list("abcdef"), corner))
    code, out, _ = gloss("mds", table, "--dims", "2", "--level", "ratio", "--json")
    assert code == 0
    found = json.loads(out)
    assert found["stimuli"] == list("abcdef")
    assert len(found["participants"]) == 1
    assert found["reliability"] == []
    solution = found["solutions"][0]
    assert solution["stress1"] < 1e-6
    assert pdist(solution["coordinates"]) / pdist(solution["coordinates"])[0] == pytest.approx(
        square[np.triu_indices(6, 1)] / square[0, 1], rel=1e-4
    )


def test_one_triangle_and_gaps_are_enough(gloss, tmp_path, square):
    lower = np.where(np.tri(6, k=-1) > 0, square, np.nan)
    lower[5, 0] = np.nan
    table = written(tmp_path / "m.csv", *matrix_lines(lower, list("abcdef")))
    code, out, _ = gloss("mds", table, "--dims", "2", "--level", "ratio", "--json")
    assert code == 0
    solution = json.loads(out)["solutions"][0]
    assert solution["stress1"] < 1e-6
    assert any("1 of 15 pairs were judged by nobody" in warning for warning in solution["warnings"])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda m: m.__setitem__((0, 1), 9.0), "is not symmetric: 9 in row 1, column 2"),
        (lambda m: m.__setitem__((slice(2), slice(2)), -1.0), "-1 for the stimuli a and b is not allowed"),
        (lambda m: m.__setitem__((0, 1), np.inf), "inf for the stimuli a and b is not allowed"),
    ],
)
def test_broken_matrices_are_refused(refused, tmp_path, square, change, message):
    change(square)
    assert message in refused("mds", written(tmp_path / "m.csv", *matrix_lines(square, list("abcdef"))))


def test_matrices_that_are_none_are_refused(refused, tmp_path):
    swapped = written(tmp_path / "m.csv", ",a,b,c", "a,0,1,2", "c,2,3,0", "b,1,0,3")
    assert "row 2 of the matrix is that of 'c', but column 2 that of 'b'" in refused("mds", swapped)
    short = written(tmp_path / "s.csv", "a,b,c,d", "0,1,2,3", "1,0,3,4")
    assert "or a square matrix; found 2 rows below 4 names" in refused("mds", short)
    words = written(tmp_path / "w.csv", "a,b,c", "0,1,2", "1,0,far", "2,far,0")
    assert "line 3: dissimilarity 'far' is not allowed" in refused("mds", words)
    small = written(tmp_path / "t.csv", "a,b", "0,1", "1,0")
    assert "holds 2 stimuli. Scaling needs at least 3" in refused("mds", small)


@pytest.mark.parametrize("model", ["identity", "weighted", "generalised"])
@pytest.mark.parametrize("level", ["ratio", "interval", "spline", "ordinal"])
def test_every_model_and_level_answers_in_full(gloss, pairs, model, level):
    code, out, _ = gloss("mds", pairs, "--dims", "1:2", "--model", model, "--level", level, "--starts", 10, "--json")
    assert code == 0
    found = json.loads(out)
    assert [one["n_dims"] for one in found["solutions"]] == [1, 2]
    for one in found["solutions"]:
        assert np.shape(one["coordinates"]) == (8, one["n_dims"])
        assert np.shape(one["dimension_weights"]) == (3, one["n_dims"])
        assert one["normalized_raw_stress"] == pytest.approx(one["stress1"] ** 2)
        assert one["starts"] >= 10
        assert one["best_hits"] >= 1
        assert one["converged"] is True
        assert isinstance(one["warnings"], list)
        assert ("transforms" in one) == (model == "generalised")
    assert found["solutions"][1]["stress1"] <= found["solutions"][0]["stress1"]


def test_repeats_count_by_their_number_or_as_one(gloss, tmp_path):
    rng = np.random.default_rng(4)
    names = list("abcdef")
    rows = [("p", names[i], names[j], rng.integers(1, 20)) for i in range(6) for j in range(i)]
    rows += [("p", b, a, rng.integers(1, 20)) for _, a, b, _ in rows[:4]] + [("p", "a", "a", 1)]
    header = "participant_id,stimulus_a,stimulus_b,dissimilarity"
    table = written(tmp_path / "t.csv", header, *(",".join(map(str, row)) for row in rows))
    stress = {}
    for repeats in ("weighted", "mean", "median"):
        _, out, _ = gloss("mds", table, "--dims", "2", "--level", "ratio", "--repeats", repeats, "--json")
        stress[repeats] = json.loads(out)["solutions"][0]["stress1"]
    assert stress["mean"] == pytest.approx(stress["median"])  # of two judgements they are the same
    assert stress["weighted"] != pytest.approx(stress["mean"])
    (consistency,) = json.loads(out)["reliability"]
    assert (consistency["n_identical"], consistency["n_repeated_pairs"]) == (1, 4)
    # A weight of 2 on the mean does what two judgements of that mean do.
    means = {}
    for _, a, b, value in rows[:-1]:
        means.setdefault(frozenset((a, b)), []).append(value)
    weighted = [("p", *sorted(pair), np.mean(v), len(v)) for pair, v in means.items()]
    table = written(tmp_path / "w.csv", header + ",weight", *(",".join(map(str, row)) for row in weighted))
    _, out, _ = gloss("mds", table, "--dims", "2", "--level", "ratio", "--json")
    assert json.loads(out)["solutions"][0]["stress1"] == pytest.approx(stress["weighted"], rel=1e-6)


def test_weights_that_are_none_are_refused(refused, tmp_path):
    header = "participant_id,stimulus_a,stimulus_b,dissimilarity,weight"
    for weight in ("0", "-1", "", "inf", "much"):
        table = written(tmp_path / "t.csv", header, f"1,a,b,1,{weight}", "1,a,c,2,1", "1,b,c,2,1")
        message = refused("mds", table)
        assert "line 2: weight" in message
        assert "Allowed: a finite number > 0" in message


def test_a_solution_is_kept_drawn_and_resampled(gloss, pairs, tmp_path):
    out, figures = tmp_path / "solution.json", tmp_path / "figures"
    code, text, err = gloss(
        "mds", pairs, "--dims", "2", "--bootstrap", 20, "--out", out, "--figures", figures, "--json"
    )
    assert code == 0
    found = json.loads(text)
    assert load_solution(out).stress1 == found["solutions"][0]["stress1"]
    names = {path.name for path in figures.iterdir()}
    assert {"configuration.png", "shepard.png", "stress-per-point.png"} <= names
    assert all((figures / name).read_bytes().startswith(b"\x89PNG") for name in names)
    assert err.count("Figure: ") == len(names)
    low, high = found["bootstrap"]["stress1_ci95"]
    assert low <= high
    assert len(found["bootstrap"]["ellipses95"]) == 8
    # For people the same in words.
    code, text, _ = gloss("mds", pairs, "--dims", "2", "--bootstrap", 20)
    assert code == 0
    assert "95 % regions" in text


def test_a_number_of_dimensions_is_recommended_with_reasons(gloss, pairs):
    words = ("mds", pairs, "--dims", "1:3", "--replicates", 19, "--starts", 10)
    code, text, _ = gloss(*words, "--json")
    assert code == 0
    advice = json.loads(text)["dimensionality"]
    assert np.shape(advice["permuted_stress1"]) == (19, 3)
    assert np.shape(advice["random_stress1"]) == (19, 3)
    assert advice["reasons"]
    assert advice["recommended"] in (None, 1, 2, 3)
    code, text, _ = gloss(*words)
    assert "Recommended: " in text
    assert advice["reasons"][0][:40] in text


def test_what_makes_no_sense_together_is_refused(refused, pairs, tmp_path):
    assert "--replicates compares numbers of dimensions" in refused("mds", pairs, "--dims", "2", "--replicates", 20)
    assert "--bootstrap is about one solution" in refused("mds", pairs, "--dims", "1:2", "--bootstrap", 20)
    assert "--out is about one solution" in refused("mds", pairs, "--dims", "1:2", "--out", tmp_path / "s.json")
    assert "Invalid --bootstrap -1" in refused("mds", pairs, "--dims", "2", "--bootstrap", "-1")


def test_somebodys_file_is_never_replaced(gloss, refused, pairs, tmp_path):
    before = pairs.read_bytes()
    message = refused("mds", pairs, "--dims", "2", "--out", pairs)
    assert "is there and is no scaling solution" in message
    assert pairs.read_bytes() == before
    kept = tmp_path / "solution.json"
    for _ in range(2):  # an earlier solution may be replaced
        assert gloss("mds", pairs, "--dims", "2", "--starts", "3", "--out", kept)[0] == 0
    assert "Give a file and a folder of other names" in refused(
        "mds", pairs, "--dims", "2", "--out", tmp_path / "x", "--figures", tmp_path / "x"
    )


def test_a_matrix_without_names_is_refused(refused, tmp_path, square):
    table = written(tmp_path / "m.csv", *(",".join(f"{value:.3f}" for value in row) for row in square))
    assert "has numbers where names are expected" in refused("mds", table)


def test_numbers_beyond_reason_are_refused(refused, pairs):
    for option in ("--starts", "--bootstrap"):
        assert f"Invalid {option} 99999999999999999999" in refused("mds", pairs, "--dims", "2", option, "9" * 20)
    assert "Invalid --replicates" in refused("mds", pairs, "--dims", "1:2", "--replicates", "9" * 20)


def test_pairs_that_hold_nothing_in_place_are_named(gloss, tmp_path):
    # A star: every stimulus was compared with the first alone, and may go round it.
    rows = [f"p,a,{name},{value}" for name, value in zip("bcdef", (1, 2, 3, 4, 5), strict=True)]
    table = written(tmp_path / "t.csv", "participant_id,stimulus_a,stimulus_b,dissimilarity", *rows)
    _, out, _ = gloss("mds", table, "--dims", "2", "--level", "ratio", "--json")
    warnings = " ".join(json.loads(out)["solutions"][0]["warnings"])
    assert "10 of 15 pairs were judged by nobody" in warnings
    assert "in 2 dimensions some stimuli can move without a change of any judged distance" in warnings


def test_who_judged_all_zero_at_ratio_level_is_not_counted(gloss, tmp_path, square):
    first, second = np.triu_indices(6, 1)
    rows = [f"p{k},{i},{j},{square[i, j] * k!r}" for k in (0, 1) for i, j in zip(first, second, strict=True)]
    table = written(tmp_path / "t.csv", "participant_id,stimulus_a,stimulus_b,dissimilarity", *rows)
    _, out, _ = gloss("mds", table, "--dims", "2", "--level", "ratio", "--json")
    solution = json.loads(out)["solutions"][0]
    assert solution["stress1"] < 1e-6
    assert "which no distances fit at ratio level, and are not counted: p0" in " ".join(solution["warnings"])
