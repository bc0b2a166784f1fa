"""`gloss fit` on tables of any study: pairs, ratings or both."""

import json

import pandas as pd
import pytest

from glossspace.dataset import write_session_data
from glossspace.metric import ContrastForm, GlossSpace, contrast_gloss, distinctness
from tests.analysis.studies import CONTRAST as CONTRAST_GRID
from tests.analysis.studies import EXPERIMENT_1, judged_by

CONTRAST = EXPERIMENT_1[EXPERIMENT_1["alpha"] == 0.04]
DOI = EXPERIMENT_1[(EXPERIMENT_1["rho_d"] == 0.03) & (EXPERIMENT_1["rho_s"] == 0.099)]


def ratings(shown, *, participants=("1", "2"), axis=None):
    """Noise-free ratings, 10 + 50 * coordinate in both repeats."""
    along = distinctness(shown["alpha"]) if shown is DOI else contrast_gloss(shown["rho_d"], shown["rho_s"])
    table = pd.DataFrame({"stimulus": shown["stimulus"], "rating": 10 + 50 * along})
    trials = [table.assign(participant_id=one, repeat=repeat) for one in participants for repeat in (1, 2)]
    return pd.concat(trials).assign(**({} if axis is None else {"axis": axis}))


@pytest.fixture
def files(tmp_path):
    """Paths of the tables of a noise-free study, by option, and of the space to write."""
    data = judged_by([1.78, 1.78])
    names = EXPERIMENT_1["stimulus"].to_numpy()
    judged = [
        pd.DataFrame({"stimulus_a": names[data.pairs[0]], "stimulus_b": names[data.pairs[1]], "dissimilarity": values})
        for values in data.values
    ]
    both = [ratings(CONTRAST, axis="c"), ratings(DOI, axis="d")]
    tables = {
        "--pairs": pd.concat([one.assign(participant_id=f"0{k}") for k, one in enumerate(judged)]),
        "--magnitudes": pd.concat(both),
        "--stimuli": EXPERIMENT_1.assign(remark="any"),
    }
    paths = {option: tmp_path / f"{option[2:]}.csv" for option in tables}
    for option, table in tables.items():
        table.to_csv(paths[option], index=False)
    return paths | {"--out": tmp_path / "space.json"}


def words(files, *options):
    return [word for option in (*options, "--stimuli", "--out") for word in (option, files[option])]


def test_pairs_and_ratings_give_the_equations_of_the_paper_back(gloss, files):
    code, out, err = gloss("fit", *words(files, "--pairs", "--magnitudes"), "--json")
    document, space = json.loads(out), GlossSpace.load(files["--out"])
    assert (code, err) == (0, "")
    assert {"space", "weight_c", "weight_d_ci95", "r_squared", "simulated", "warnings"} <= set(document)
    assert document["weight_d"] == space.weight_d == pytest.approx(1.78, abs=6e-3)  # what order determines: test_fit
    assert (document["sources"], document["weight_d_fitted"]) == (["pairs", "magnitudes"], True)
    assert document["r_squared"] == pytest.approx({"c": 1, "d": 1}, abs=1e-12)
    for axis in ("c", "d"):
        line = space.axis_functions[axis]
        assert (line.slope, line.intercept) == pytest.approx((50, 10), rel=1e-9)
    assert document["warnings"] == []
    assert space.provenance["participants"] == ["00", "01", "1", "2"]
    assert space.name == "fitted to pairs.csv and magnitudes.csv"


def test_pairs_alone(gloss, files):
    code, out, _ = gloss("fit", *words(files, "--pairs"), "--json")
    document = json.loads(out)
    assert code == 0
    assert (document["sources"], document["weight_d_fitted"], document["r_squared"]) == (["pairs"], True, {})
    assert GlossSpace.load(files["--out"]).axis_functions == {}


@pytest.mark.parametrize(("shown", "axis"), [(CONTRAST, "c"), (DOI, "d")])
def test_ratings_alone_leave_the_weight_of_the_paper_and_say_so(gloss, files, shown, axis):
    ratings(shown).to_csv(files["--magnitudes"], index=False)
    code, out, _ = gloss("fit", *words(files, "--magnitudes"), "--json")
    document, space = json.loads(out), GlossSpace.load(files["--out"])
    assert code == 0
    assert (document["weight_d"], document["weight_d_ci95"], document["weight_d_fitted"]) == (1.78, None, False)
    assert document["sources"] == ["magnitudes"]
    assert ["was not fitted" in one for one in document["warnings"]] == [True]
    assert set(document["r_squared"]) == set(space.axis_functions) == {axis}
    assert space.provenance["weight_d_fitted"] is False
    assert (space.weight_d, space.weight_d_ci95) == (1.78, None)


def test_a_person_reads_what_was_not_fitted(gloss, files):
    code, out, err = gloss("fit", *words(files, "--magnitudes"))
    assert code == 0
    assert "weight of d over that of c, not fitted" in out
    assert "slope of the ratings along c" in out
    assert "1.78 is the gloss paper's" in err


def test_what_is_given_must_make_sense(refused, files, tmp_path):
    out = files["--out"]
    assert "Nothing to fit" in refused("fit", "--out", out)
    assert "Nothing to fit" in refused("fit", "--stimuli", files["--stimuli"], "--out", out)
    assert "not both" in refused("fit", tmp_path, *words(files, "--pairs"))
    assert "--pairs and --magnitudes, not both" in refused("fit", tmp_path, *words(files, "--pairs", "--magnitudes"))
    assert "Without --stimuli" in refused("fit", "--pairs", files["--pairs"], "--out", out)
    assert "No rating table at" in refused("fit", *words(files | {"--magnitudes": tmp_path / "none"}, "--magnitudes"))
    assert not out.exists()


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda table: table.assign(rating=50), "Ratings along c: all stimuli have the same mean rating, 50"),
        (lambda table: table.assign(rating=-table["rating"]), "line 2: rating"),
        (lambda table: table.drop(columns="axis"), "Add the column `axis`"),
        (
            lambda table: table[(table["participant_id"] != "2") | (table["stimulus"] != "s0")],
            "Participant 2 has no rating of the stimulus s0",
        ),
        (lambda table: table[table["stimulus"].isin(["s0", "s3"])], "Ratings along c: A regression of ratings needs 3"),
        (lambda table: table.assign(stimulus=table["stimulus"].replace("s0", "q")), "The stimulus 'q' was judged"),
    ],
)
def test_ratings_that_cannot_be_fitted(refused, files, spoil, message):
    spoil(pd.read_csv(files["--magnitudes"], dtype={"participant_id": str})).to_csv(files["--magnitudes"], index=False)
    assert message in refused("fit", *words(files, "--magnitudes"))
    assert not files["--out"].exists()


def test_pairs_of_one_alpha_or_of_unknown_stimuli(refused, files):
    pairs = pd.read_csv(files["--pairs"], dtype={"participant_id": str})
    EXPERIMENT_1.iloc[1:].to_csv(files["--stimuli"], index=False)
    assert "'s0' was judged, but its rho_d" in refused("fit", *words(files, "--pairs"))
    EXPERIMENT_1.to_csv(files["--stimuli"], index=False)
    alike = pairs["stimulus_a"].isin(CONTRAST["stimulus"]) & pairs["stimulus_b"].isin(CONTRAST["stimulus"])
    pairs[alike].to_csv(files["--pairs"], index=False)
    message = refused("fit", *words(files, "--pairs"))
    assert "have the same d, 0.96, so that the weight of d over that of c cannot be fitted" in message
    assert "differ in alpha" in message


class TestDataset:
    """A dataset works like the tables that it holds."""

    @pytest.fixture
    def dataset(self, tmp_path):
        folder = tmp_path / "study"
        for task in ("contrast", "gloss"):
            write_session_data(
                folder,
                [
                    {"block": 1, "trial": n, "repeat": 1, "response_time_s": None, "stimulus": name, "rating": 10 * n}
                    for n, name in enumerate(CONTRAST["stimulus"], start=1)
                ],
                kind="magnitude", participant="01", session="1", task=task, observer="simulated",
            )  # fmt: skip
        EXPERIMENT_1.to_csv(folder / "stimuli.csv", index=False)
        return folder

    def test_ratings_alone(self, gloss, dataset, files):
        code, out, err = gloss("fit", dataset, "--out", files["--out"], "--json")
        document = json.loads(out)
        assert code == 0
        assert "1 of 1 participants are simulated" in err
        assert (document["sources"], document["weight_d"]) == (["magnitudes"], 1.78)
        assert (document["weight_d_fitted"], document["simulated"]) == (False, ["01"])
        assert "The ratings of the task 'gloss' are not used" in document["warnings"][-1]
        assert GlossSpace.load(files["--out"]).provenance["observers"] == ["01 (simulated)"]

    def test_neither_pairs_nor_ratings_along_an_axis(self, refused, dataset, files):
        next(dataset.rglob("*task-contrast_data.csv")).unlink()
        assert "holds no judged pair" in refused("fit", dataset, "--out", files["--out"])

    def test_pairs_may_be_those_of_a_dataset(self, refused, dataset, files):
        assert "holds no judged pair" in refused("fit", *words(files | {"--pairs": dataset}, "--pairs"))


def test_the_forms_of_the_axis_functions_are_reported(gloss, files):
    code, out, _ = gloss("fit", *words(files, "--pairs", "--magnitudes"), "--json")
    document = json.loads(out)["axis_functions"]
    assert code == 0
    # Three values of rho_s tell a line and an exponent, and nothing more; three of alpha, of three stimuli, a line
    assert [row["free"] for row in document["c"]["forms"]] == [[], ["exponent"]]
    assert [row["taken"] for row in document["c"]["forms"]] == [True, False]
    assert [row["free"] for row in document["d"]["forms"]] == [[]]
    assert document["c"]["slope_ci95"] is None  # two participants
    CONTRAST_GRID.assign(axis="c").pipe(rated_with_square_roots).to_csv(files["--magnitudes"], index=False)
    pd.concat([EXPERIMENT_1, CONTRAST_GRID]).to_csv(files["--stimuli"], index=False)
    code, out, _ = gloss("fit", *words(files, "--magnitudes"))
    assert code == 0
    assert "Axis functions: c = (rho_s + 0.5 rho_d)^0.5 - (0.5 rho_d)^0.5; d = 1 - alpha" in out
    assert "The form (rho_s + 0.5 rho_d)^0.5 - (0.5 rho_d)^0.5 is taken" in out
    code, out, _ = gloss("fit", *words(files, "--magnitudes"), "--forms", "paper")
    assert "c = cbrt(rho_s + rho_d/2) - cbrt(rho_d/2)" in out


def rated_with_square_roots(shown):
    rating = 10 + 100 * ContrastForm(exponent=0.5).value(shown["rho_d"], shown["rho_s"])
    table = pd.DataFrame({"stimulus": shown["stimulus"], "axis": "c", "repeat": 1, "rating": rating})
    return pd.concat(table.assign(participant_id=one) for one in ("1", "2", "3"))


def test_level_and_interval_are_those_asked_for(gloss, files):
    code, out, _ = gloss("fit", *words(files, "--pairs"), "--level", "ratio", "--interval", "bootstrap", "--json")
    assert code == 0
    assert json.loads(out)["weight_d"] == pytest.approx(1.78, abs=1e-6)  # noise-free: nothing is left open
    assert GlossSpace.load(files["--out"]).provenance["level"] == "ratio"


def test_of_files_that_are_there_only_a_space_is_replaced(gloss, refused, files):
    given, before = words(files, "--pairs"), files["--pairs"].read_bytes()
    into_data = [*given[:-1], files["--pairs"]]
    assert "pairs.csv' is there and is no gloss space that can be read. Choose another name" in refused(
        "fit", *into_data
    )
    assert files["--pairs"].read_bytes() == before
    GlossSpace(weight_d=9.0).save(files["--out"])
    assert gloss("fit", *given)[0] == 0
    assert GlossSpace.load(files["--out"]).weight_d == pytest.approx(1.78, abs=0.05)
