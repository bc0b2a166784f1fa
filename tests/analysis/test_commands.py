"""`gloss mds`, `confirm`, `fit` and `report` as a person types them: shapes, numbers, and one line for a mistake."""

import itertools
import json

import numpy as np
import pytest

from gloss_analysis.confirmatory.scaling import confirm_axes
from gloss_analysis.dimensionality.stress_curve import stress_curve
from gloss_analysis.fit import fit_gloss_space
from gloss_analysis.judgements.judgement_table import read_table
from glossspace.dataset import write_session_data
from glossspace.metric import GlossSpace
from tests.analysis.studies import EXPERIMENT_1, STIMULI, judged_by


@pytest.fixture
def axes(tmp_path):
    """c and d of the eight stimuli, in another order and with one stimulus that nobody judged."""
    from tests.analysis.studies import axis_values

    rows = [f"{name},{c!r},{d!r}" for name, (c, d) in zip(STIMULI, axis_values()[:8].tolist(), strict=True)]
    path = tmp_path / "axes.csv"
    path.write_text("\n".join(["stimulus,c,d", "unjudged,,", *reversed(rows)]) + "\n")
    return path


@pytest.fixture
def dataset(tmp_path):
    """A whole dataset: two participants, pairs and both magnitude studies."""
    folder = tmp_path / "dataset"
    data = judged_by([1.5, 2.0], noise_sd=1.0, integers=True)
    values = dict(zip(itertools.combinations(data.stimuli, 2), data.values.T, strict=True))
    for k, participant in enumerate(("01", "02")):
        judged = [pair for pair in values if set(pair) <= set(STIMULI)]
        write_session_data(
            folder,
            [
                _trial(n) | {"stimulus_left": a, "stimulus_right": b, "dissimilarity": int(values[a, b][k])}
                for n, (a, b) in enumerate(judged, start=1)
            ],
            kind="pairwise", participant=participant, session="1", task="pairwise", observer="simulated",
        )  # fmt: skip
        for task in ("contrast", "doi"):
            write_session_data(
                folder,
                [_trial(n) | {"stimulus": s, "rating": 10 * n + k} for n, s in enumerate(STIMULI, start=1)],
                kind="magnitude", participant=participant, session="1", task=task, observer="simulated",
            )  # fmt: skip
    table = EXPERIMENT_1[EXPERIMENT_1["stimulus"].isin(STIMULI)]
    (folder / "stimuli.csv").write_text(table.to_csv(index=False))
    return folder


def _trial(number):
    return {"block": 1, "trial": number, "repeat": 1, "response_time_s": None}


class TestMds:
    def test_json_has_the_agreed_shape_and_the_numbers_of_the_library(self, gloss, pairs):
        code, out, _ = gloss("mds", pairs, "--dims", "1:2", "--starts", 4, "--seed", 3, "--json")
        document = json.loads(out)
        assert code == 0
        assert document["stimuli"] == STIMULI
        assert document["participants"] == ["p0", "p1", "p2"]
        expected = stress_curve(read_table(pairs), dims=(1, 2), n_starts=4, seed=3)
        assert [one["n_dims"] for one in document["solutions"]] == [1, 2]
        for one, solution in zip(document["solutions"], expected, strict=True):
            assert {"starts", "best_hits", "converged", "warnings"} <= set(one)
            assert one["stress1"] == solution.stress1
            # Normalised raw stress is the square of Stress-1 where each source has its own best scale.
            assert one["normalized_raw_stress"] == pytest.approx(one["stress1"] ** 2, rel=1e-12)
            assert np.array_equal(one["coordinates"], solution.coordinates)
            assert np.shape(one["dimension_weights"]) == (3, solution.n_dims)

    def test_a_person_reads_the_configuration_and_the_weights(self, gloss, pairs):
        code, out, _ = gloss("mds", pairs, "--dims", 2, "--starts", 2)
        assert code == 0
        assert all(word in out for word in ("Stress-1", "Configuration", "Dimension weights", "s0", "p2"))

    def test_dimensions_without_room_are_left_out_and_named(self, gloss, pairs):
        code, out, err = gloss(
            "mds", pairs, "--dims", "6:9", "--model", "identity", "--level", "ratio", "--starts", 1, "--json"
        )
        assert code == 0
        assert [one["n_dims"] for one in json.loads(out)["solutions"]] == [6, 7]
        assert "8 stimuli have room for 7 dimensions at most" in " ".join(err.split())

    @pytest.mark.parametrize("dims", ["x", "0", "-1", "5:1", "1:", ":3", "2.5", "1,2", "1:2:3", "1:100000000000", "٢"])
    def test_nonsense_for_dimensions(self, refused, pairs, dims):
        assert f"Invalid --dims {dims!r}. Allowed: one number such as 2" in refused("mds", pairs, "--dims", dims)

    @pytest.mark.parametrize(
        ("option", "value", "message"),
        [
            ("--dims", "8", "Allowed: 1 to 7 for 8 stimuli"),
            ("--starts", "0", "Allowed: 1 to 1,000,000"),
            ("--starts", "2.5", "is not a whole number"),
            ("--seed", "-1", "Must be 0 or more"),
            ("--seed", "1.5", "is not a whole number"),
            ("--jobs", "-1", "Must be 0 or more"),
            ("--jobs", "1.5", "is not a whole number"),
            ("--level", "nominal", "Choose from"),
        ],
    )
    def test_options_out_of_range(self, refused, pairs, option, value, message):
        assert message in refused("mds", pairs, option, value)

    def test_no_table(self, refused, tmp_path):
        assert "No dissimilarity table at" in refused("mds", tmp_path / "nowhere.csv")
        assert "is no dataset: it holds no dataset_description.json" in refused("mds", tmp_path)

    def test_an_error_while_scaling_leaves_one_line(self, refused, tmp_path):
        path = tmp_path / "constant.csv"
        path.write_text("participant_id,stimulus_a,stimulus_b,dissimilarity\n1,a,b,4\n1,a,c,4\n1,b,c,4\n")
        assert "the same dissimilarity" in refused("mds", path, "--dims", 1)


class TestConfirm:
    def test_json_has_the_agreed_shape_and_the_numbers_of_the_library(self, gloss, pairs, axes):
        from tests.analysis.studies import axis_values

        code, out, err = gloss("confirm", pairs, "--coordinates", axes, "--json")
        document = json.loads(out)
        assert (code, err) == (0, "")
        assert document["axes"] == ["c", "d"]
        fitted = confirm_axes(read_table(pairs), axis_values()[:8], axes=("c", "d"))
        assert document["population"] == {"ratio": fitted.population_ratio, "ci95": list(fitted.population_ci95)}
        assert document["shared"]["ratio"] == fitted.shared.ratio
        assert document["shared"]["stress1"] == fitted.shared.stress1
        assert [one["participant_id"] for one in document["participants"]] == ["p0", "p1", "p2"]
        for one in document["participants"]:
            assert one["ratio"] == pytest.approx(one["weights"][-1] / one["weights"][0], rel=1e-12)

    def test_a_person_reads_a_row_a_participant(self, gloss, pairs, axes):
        code, out, _ = gloss("confirm", pairs, "--coordinates", axes)
        assert code == 0
        assert all(word in out for word in ("d over c", "p0", "p1", "p2", "Population:", "95 %", "Shared:"))

    @pytest.mark.parametrize(
        ("old", "new", "message"),
        [
            ("stimulus,", "name,", "lacks the column 'stimulus'"),
            ("c,d\n", "c,c\n", "has the column 'c' twice"),
            ("stimulus,c,d\n", "stimulus,,d\n", "has a column without a name"),
            ("s3,", "s2,", "lists the stimulus 's2' twice"),
            ("s3,", "zz,", "lacks coordinates of the stimulus 's3' (1 such). Add a row for each"),
            ("0.96\n", "red\n", "line 4: the coordinate d of 's6' is 'red'. Allowed: a finite number"),
            ("0.96\n", "inf\n", "line 4: the coordinate d of 's6' is 'inf'. Allowed: a finite number"),
            ("0.96\n", "\n", "line 4: the coordinate d of 's6' is ''. Allowed: a finite number"),
            ("0.96\n", "0.96,7\n", "line 4: 4 cells, but the header names 3 columns"),
        ],
    )
    def test_damaged_coordinates(self, refused, pairs, axes, old, new, message):
        text = axes.read_text()  # .96, the d of an alpha of .04, is first found in line 4: s6
        assert old in text
        axes.write_text(text.replace(old, new, 1))
        assert message in refused("confirm", pairs, "--coordinates", axes)

    def test_a_stimulus_called_na_is_no_missing_one(self, gloss, tmp_path):
        judged, axes = tmp_path / "pairs.csv", tmp_path / "axes.csv"
        judged.write_text("participant_id,stimulus_a,stimulus_b,dissimilarity\n1,NA,b,1\n1,NA,c,2\n1,b,c,3\n")
        axes.write_text("stimulus,x,y\nNA,1,2\nb,2,4\nc,4,1\n")
        assert gloss("confirm", judged, "--coordinates", axes, "--json")[0] == 0


class TestFit:
    def test_writes_the_space_that_the_library_fits(self, gloss, dataset, tmp_path):
        out = tmp_path / "space.json"
        code, stdout, _ = gloss("fit", dataset, "--out", out, "--json")
        document = json.loads(stdout)
        assert code == 0
        space = GlossSpace.load(out)
        assert document["weight_d"] == space.weight_d
        assert document["weight_d_ci95"] == list(space.weight_d_ci95)
        assert set(document["r_squared"]) == {"c", "d"}
        expected = fit_gloss_space(EXPERIMENT_1, read_table(dataset), {})
        assert space.weight_d == expected.space.weight_d

    def test_a_person_reads_a_table_and_who_adds_nothing(self, gloss, dataset, tmp_path):
        _set_ratings(dataset, "subject-02", "pairwise", "50")
        code, out, err = gloss("fit", dataset, "--out", tmp_path / "space.json")
        assert code == 0
        assert "weight of d over that of c" in out
        assert "02" in err

    def test_pairs_alone_are_enough(self, gloss, dataset, tmp_path):
        for task in ("contrast", "doi"):
            for path in dataset.rglob(f"*task-{task}_data.csv"):
                path.unlink()
        _redescribe(dataset)
        code, stdout, _ = gloss("fit", dataset, "--out", tmp_path / "space.json", "--json")
        assert code == 0
        assert json.loads(stdout)["r_squared"] == {}

    def test_the_same_rating_for_everything(self, refused, dataset, tmp_path):
        for subject in ("subject-01", "subject-02"):
            _set_ratings(dataset, subject, "doi", "50")
        message = refused("fit", dataset, "--out", tmp_path / "space.json")
        assert "along d" in message
        assert not (tmp_path / "space.json").exists()

    @pytest.mark.parametrize(
        ("old", "new", "message"),
        [
            ("s0,0.03", "s0,-0.03", "line 2: the stimulus 's0' cannot be: rho_d must be at least 0, but is -0.03"),
            ("s0,0.03", "s0,x", "line 2: the stimulus 's0' has no valid numbers"),
            ("s0,0.03", 's0,"0,03"', "Allowed: rho_d, rho_s and alpha with a decimal point, such as 0.193."),
            ("s0,0.03", "s0,", "line 2: the stimulus 's0' cannot be: rho_d must be a finite number"),
            ("s0,", ",", "line 2: the stimulus has no name"),
            ("s1,", "s0,", "line 3: 's0' is already in line 2"),
            ("s0,", "other,", "'s0' was judged, but its rho_d, rho_s and alpha are not known (1 such)"),
            ("alpha", "roughness", "lacks the column 'alpha'"),
        ],
    )
    def test_damaged_stimuli(self, refused, dataset, tmp_path, old, new, message):
        table = tmp_path / "stimuli.csv"
        table.write_text((dataset / "stimuli.csv").read_text().replace(old, new, 1))
        assert message in refused("fit", dataset, "--stimuli", table, "--out", tmp_path / "space.json")
        assert not (tmp_path / "space.json").exists()

    def test_places_that_are_not_there(self, refused, dataset, tmp_path):
        out = tmp_path / "space.json"
        assert "No dataset folder at" in refused("fit", tmp_path / "nowhere", "--out", out)
        assert "No stimulus table at" in refused("fit", dataset, "--stimuli", tmp_path / "nowhere", "--out", out)
        assert "it is a folder" in refused("fit", dataset, "--out", tmp_path)
        (dataset / "stimuli.csv").unlink()
        assert "(`--stimuli`)" in refused("fit", dataset, "--out", out)
        assert not out.exists()


class TestReport:
    def test_no_study(self, refused, tmp_path, dataset):
        assert "No study folder at" in refused("report", tmp_path / "nowhere")
        assert "No stimulus set at" in refused("report", tmp_path)

    def test_where_no_report_can_be_written_nothing_is_analysed(self, refused, tmp_path):
        assert "it is a folder" in refused("report", tmp_path, "--out", tmp_path)


@pytest.mark.parametrize("command", ["mds", "confirm", "fit", "report"])
def test_help_has_examples_that_fit_a_terminal(gloss, command):
    code, out, _ = gloss(command, "--help")
    examples = [line for line in out.splitlines() if line.startswith(f"    gloss {command} ")]
    assert code == 0
    assert examples
    assert all(f"    gloss {command} {line.split(maxsplit=2)[2]}" == line for line in examples)


def _set_ratings(dataset, subject, task, value):
    (path,) = dataset.rglob(f"{subject}_session-1_task-{task}_data.csv")
    header, *rows = [line.split(",") for line in path.read_text().splitlines()]
    column = header.index("dissimilarity" if task == "pairwise" else "rating")
    for row in rows:
        row[column] = value
    path.write_text("\n".join(",".join(row) for row in [header, *rows]) + "\n")


def _redescribe(dataset):
    from glossspace.dataset import update_description

    update_description(dataset)


@pytest.mark.parametrize("command", ["mds", "confirm", "fit"])
def test_simulated_participants_are_called_so(gloss, dataset, axes, tmp_path, command):
    options = {
        "mds": ["--dims", "2", "--starts", "1"],
        "confirm": ["--coordinates", axes],
        "fit": ["--out", tmp_path / "space.json"],
    }
    code, out, err = gloss(command, dataset, *options[command], "--json")
    assert code == 0
    assert json.loads(out)["simulated"] == ["01", "02"]
    assert "2 of 2 participants are simulated" in err
    if command == "fit":
        space = json.loads((tmp_path / "space.json").read_text("utf-8"))
        assert space["provenance"]["observers"] == ["01 (simulated)", "02 (simulated)"]


def test_people_are_not_called_simulated(gloss, pairs):
    code, out, err = gloss("mds", pairs, "--dims", "2", "--starts", "1", "--json")
    assert code == 0
    assert json.loads(out)["simulated"] == []
    assert "simulated" not in err
