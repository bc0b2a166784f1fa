"""`gloss hypotheses`, and the expressions and stimulus columns behind it."""

import itertools
import json

import numpy as np
import pandas as pd
import pytest

from gloss_analysis.hypotheses.candidates import HYPOTHESES_C, HYPOTHESES_D, HYPOTHESIS_C
from gloss_analysis.hypotheses.comparison import compare_hypotheses, confirm_hypotheses
from gloss_analysis.hypotheses.expressions import hypothesis_from
from gloss_analysis.hypotheses.stimulus_columns import read_stimulus_columns
from gloss_analysis.judgements.judgement_table import read_table
from glossspace.dataset import write_session_data
from glossspace.errors import GlossError
from glossspace.stimulus_set import MANIFEST_FORMAT, MANIFEST_NAME
from tests.analysis.studies import EXPERIMENT_1, STIMULI, judged_by

PAINTS = pd.DataFrame(
    {"stimulus": ["a", "b", "c"], "rho_d": [0.0, 0.2, 0.7], "rho_s": [0.1, 0.05, 0.03], "alpha": [0.04, 0.1, 0.2]}
)


class TestExpressions:
    @pytest.mark.parametrize(
        ("text", "expected"),
        [
            ("x=rho_s", [0.1, 0.05, 0.03]),
            ("x = 1 - alpha", [0.96, 0.9, 0.8]),
            ("x=2*rho_s/(1+rho_d)**2", [0.2, 0.1 / 1.44, 0.06 / 2.89]),
            ("x=-log10(alpha*10)", -np.log10([0.4, 1, 2])),
            ("x=maximum(alpha, 0.1)", [0.1, 0.1, 0.2]),
            ("a name of words=abs(-rho_s) + 1e-3", [0.101, 0.051, 0.031]),
            ("x=minimum(alpha, 0.1)", [0.04, 0.1, 0.1]),
            ("x=abs(rho_d - 0.2)", [0.2, 0.0, 0.5]),
            ("x=sqrt(alpha)", [0.2, 0.1**0.5, 0.2**0.5]),
            ("x=log(exp(2*rho_d))", [0.0, 0.4, 1.4]),
            ("x=exp(log(alpha)/2)", [0.2, 0.1**0.5, 0.2**0.5]),
            ("x=log10(1000)*exp(1)*cbrt(-8)", [-6 * np.e] * 3),
            ("x=-alpha**2", [-0.0016, -0.01, -0.04]),
            ("x=2**3**2 - 8/4/2", [511.0] * 3),  # powers from the right, quotients from the left
            ("x=3", [3.0, 3.0, 3.0]),
        ],
    )
    def test_arithmetic(self, text, expected):
        # The same operations in another order of brackets at most.
        assert hypothesis_from(text, "c").values(PAINTS) == pytest.approx(expected, rel=1e-14)

    def test_the_papers_form(self):
        typed = hypothesis_from("form=cbrt(rho_s + rho_d/2) - cbrt(rho_d/2)", "c")
        assert typed.values(PAINTS) == pytest.approx(HYPOTHESIS_C.values(PAINTS), rel=1e-12)
        assert typed.axis == "c"

    @pytest.mark.parametrize(
        "expression",
        [
            "__import__('os').system('touch here')", "rho_s.__class__", "rho_s.to_csv('here')", "open('here')",
            "[rho_s for rho_s in (1,)]", "lambda: 1", "rho_s if 1 else 2", "rho_s[0]", "rho_s and rho_d", "rho_s < 1",
            "f'{rho_s}'", "exp(x=1)", "exp(*rho_s)", "cbrt.real", "@local", "(y := 2)", "eval('1')", "1 // 2", "~1",
            "open('here') + 1", "1 + open('here')",
        ],
    )  # fmt: skip
    def test_whatever_is_no_arithmetic_is_refused(self, expression, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        with pytest.raises(GlossError, match="which is not allowed|cannot be read"):
            hypothesis_from(f"x={expression}", "c")
        assert not list(tmp_path.iterdir())

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("rho_s", "Allowed: a name, an equals sign and an expression"),
            ("=rho_s", "Allowed: a name, an equals sign and an expression"),
            ("x=", "Allowed: a name, an equals sign and an expression"),
            ("x=rho_s +", "cannot be read"),
            ("x=1(2)", "not allowed"),
            ("x=cbrt", "names cbrt without brackets"),
            ("x=cbrt(1, 2)", "calls cbrt with 2 arguments; it takes 1"),
            ("x=True", "has True, which is no number"),
            ("x='a'", "has 'a', which is no number"),
            ("x=2j", "has 2j, which is no number"),
            ("x=" + "-" * 299 + "1" * 2, "longer than 300 characters"),
        ],
    )
    def test_slips(self, text, message):
        with pytest.raises(GlossError, match=message):
            hypothesis_from(text, "c")

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("x=gloss", "needs the column gloss, which the stimuli lack"),
            ("x=log(rho_d)", "no finite number for the stimulus a"),
            ("x=1/(rho_d*0)", "no finite number"),
            ("x=10**(10**10)", "no finite number"),
            ("x=sqrt(rho_d - 1)", "no finite number"),
            ("x=rho_s*1e200", "gives numbers up to 1e\\+199 in size. Allowed: from 1e-100 to 1e\\+100"),
            ("x=rho_s/1e200", "gives numbers up to 1e-201 in size"),
        ],
    )
    def test_what_has_no_value(self, text, message):
        with pytest.raises(GlossError, match=message):
            hypothesis_from(text, "c").values(PAINTS)

    def test_as_deep_as_is_allowed(self):
        assert hypothesis_from("x=" + "-" * 298 + "1", "c").values(PAINTS).tolist() == [1.0] * 3


class TestColumns:
    def test_files_are_put_side_by_side(self, tmp_path):
        PAINTS.assign(remark=["x", "", "y"]).to_csv(tmp_path / "s.csv", index=False)
        (tmp_path / "m.csv").write_text("stimulus,haze,alpha\nb,3,0.1\nz,4,0.5\n")
        found = read_stimulus_columns([tmp_path / "s.csv", tmp_path / "m.csv"]).set_index("stimulus")
        assert found.index.tolist() == ["a", "b", "c", "z"]
        assert found.columns.tolist() == ["rho_d", "rho_s", "alpha", "haze"]
        assert found.loc["b"].tolist() == [0.2, 0.05, 0.1, 3.0]
        assert np.isnan(found.loc["a", "haze"])
        assert found.loc["z", "alpha"] == 0.5

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("stimulus,alpha\nb,0.11\n", "gives alpha = 0.11 for the stimulus 'b', another file 0.1"),
            ("stimulus,haze\nb,1\nb,2\n", "line 3: 'b' is there already"),
            ("stimulus,haze\n,1\n", "line 2: the stimulus has no name"),
            ("name,haze\nb,1\n", "lacks the column 'stimulus'"),
            ("stimulus,rho_d,rho_s,alpha\nq,2,0.1,0.1\n", "the stimulus 'q' cannot be"),
        ],
    )
    def test_contradictions_and_slips(self, tmp_path, text, message):
        PAINTS.to_csv(tmp_path / "s.csv", index=False)
        (tmp_path / "m.csv").write_text(text)
        with pytest.raises(GlossError, match=message):
            read_stimulus_columns([tmp_path / "s.csv", tmp_path / "m.csv"])


def contrast_of(stimuli):
    """Made-up measurements: contrast that falls with blur."""
    light = 0.5 * stimuli["rho_d"] + stimuli["rho_s"] * (0.8 - 4 * stimuli["alpha"])
    dark = 0.5 * stimuli["rho_d"] + stimuli["rho_s"] * (0.03 + 3 * stimuli["alpha"])
    return pd.DataFrame(
        {
            "stimulus": stimuli["stimulus"],
            "displayed_luminance_ratio": light / dark,
            "displayed_lightness_difference": 116 * (np.cbrt(light) - np.cbrt(dark)),
        }
    )


@pytest.fixture
def tables(tmp_path):
    """Pairs of Experiment 1, ratings along both axes, stimuli, and measurements of the images."""
    data = judged_by([1.5, 1.78, 2.1], noise_sd=2, integers=True)
    pairs = [
        (name, data.stimuli[a], data.stimuli[b], value)
        for name, row in zip(data.participants, data.values, strict=True)
        for a, b, value in zip(*data.pairs, row, strict=True)
    ]
    pd.DataFrame(pairs, columns=["participant_id", "stimulus_a", "stimulus_b", "dissimilarity"]).to_csv(
        tmp_path / "p.csv", index=False
    )
    levels = itertools.product((0.03, 0.193, 0.767), (0.033, 0.05, 0.066, 0.099), (0.04,))
    rows = [(f"t{k}", *paint) for k, paint in enumerate([*levels, *((0.03, 0.2, a) for a in np.arange(1, 9) / 50)])]
    more = pd.DataFrame(rows, columns=EXPERIMENT_1.columns)
    stimuli = pd.concat([EXPERIMENT_1, more], ignore_index=True)
    stimuli.to_csv(tmp_path / "s.csv", index=False)
    contrast_of(stimuli).to_csv(tmp_path / "measured.csv", index=False)
    rng = np.random.default_rng(0)
    ideal = np.where(more["alpha"] == 0.04, 5 + 250 * HYPOTHESIS_C.values(more), 100 - 500 * more["alpha"])
    axis = ["c"] * 12 + ["d"] * 8
    ratings = pd.concat(
        [
            pd.DataFrame(
                {"participant_id": who, "stimulus": more["stimulus"], "axis": axis,
                 "rating": (ideal + 2 * rng.standard_normal(20)).clip(0, 100).round(1)}
            )
            for who in ("p0", "p1", "p2")
        ]
    )  # fmt: skip
    ratings.to_csv(tmp_path / "m.csv", index=False)
    return tmp_path


def options(folder, *names):
    known = {"pairs": "p.csv", "magnitudes": "m.csv"}
    given = [word for name in names for word in (f"--{name}", folder / known[name])]
    return [*given, "--stimuli", folder / "s.csv"]


def test_json_has_the_numbers_of_the_library(gloss, tables):
    measured = ["--stimuli", tables / "measured.csv"]
    words = options(tables, "pairs", "magnitudes")
    code, out, err = gloss("hypotheses", *words, *measured, "--function", "energy=rho_s", "--json")
    assert code == 0, err
    document = json.loads(out, parse_constant=pytest.fail)
    stimuli = read_stimulus_columns([tables / "s.csv", tables / "measured.csv"])
    tested = [*HYPOTHESES_C, hypothesis_from("energy=rho_s", "c")]
    ratings = pd.read_csv(tables / "m.csv", dtype={"participant_id": str}).query("axis == 'c'")
    compared = compare_hypotheses(tested, stimuli, ratings)
    confirmed = confirm_hypotheses(tested, stimuli, read_table(tables / "p.csv"))
    assert [one["hypothesis"] for one in document["ratings"]] == [*(one.name for one in HYPOTHESES_C), "energy"]
    assert [one["aicc"] for one in document["ratings"]] == compared["aicc"].tolist()
    assert [one["stress1"] for one in document["pairs"]] == confirmed["stress1"].tolist()
    assert document["axis"] == "c"
    assert document["skipped"] == {}
    # At alpha .04 lightness difference and object space are all but linear functions of each other, so that noise may
    # set either before the other on ratings; not on pairs, as in the gloss paper.
    best = compared.loc[compared["leave_one_out_error"].idxmin(), "hypothesis"]
    assert document["sentences"][0].startswith(f"Ratings: {best} predicts left-out stimuli best")
    assert "Pairs: object space has the lowest stress" in document["sentences"][1]
    assert document["sentences"][1].endswith("is the best for 3 of 3 participants.")
    assert ("not favour the same" in " ".join(document["sentences"])) == (best != "object space")


def test_what_the_stimuli_do_not_tell_is_not_tested_and_said_so(gloss, tables):
    code, out, err = gloss("hypotheses", *options(tables, "pairs", "magnitudes"))
    assert code == 0
    assert "object space" in out
    assert "Not tested: luminance ratio. The hypothesis 'luminance ratio' needs the column" in " ".join(err.split())
    assert "luminance ratio" not in out


def test_the_other_axis(gloss, tables):
    code, out, _ = gloss("hypotheses", *options(tables, "pairs", "magnitudes"), "--axis", "d", "--json")
    document = json.loads(out)
    assert code == 0
    names = [one.name for one in HYPOTHESES_D if one.name != "edge width"]
    assert [one["hypothesis"] for one in document["pairs"]] == names
    assert list(document["skipped"]) == ["edge width"]
    assert min(document["ratings"], key=lambda one: one["leave_one_out_error"])["hypothesis"] == "1 - alpha"
    # At alpha .04, .07 and .10 one minus the root of alpha bends little, yet all three participants tell it apart.
    stress = {one["hypothesis"]: one["stress1"] for one in document["pairs"]}
    assert min(stress, key=stress.get) == "1 - alpha"
    # The true axes: the geometric mean of 1.5, 1.78, 2.1, in an ordinal fit of 27 stimuli.
    assert document["pairs"][0]["ratio"] == pytest.approx(1.777, rel=0.05)
    assert all(one["slope"] > 0 for one in document["ratings"])


@pytest.mark.parametrize("names", [("pairs",), ("magnitudes",)])
@pytest.mark.parametrize("axis", ["c", "d"])
def test_either_task_alone_with_a_figure(gloss, tables, names, axis):
    figure = tables / "h.svg"
    code, out, err = gloss("hypotheses", *options(tables, *names), "--axis", axis, "--figure", figure)
    assert code == 0, err
    assert figure.read_text().startswith("<?xml")
    assert ("Stress-1" in out) == (names == ("pairs",))
    assert ("ΔAICc" in out) == (names == ("magnitudes",))


def test_mistakes(refused, tables):
    both = options(tables, "pairs", "magnitudes")
    assert "Nothing to test on" in refused("hypotheses")
    assert "not both" in refused("hypotheses", tables, *both)
    assert "Without --stimuli nothing says what was shown" in refused("hypotheses", "--pairs", tables / "p.csv")
    assert "No dataset folder" in refused("hypotheses", tables / "nowhere")
    assert "Invalid figure" in refused("hypotheses", *both, "--figure", tables / "h.txt")
    assert "which is not allowed" in refused("hypotheses", *both, "--function", "x=open('a')")
    assert "Several hypotheses are called" in refused("hypotheses", *both, "--function", "object space=rho_s")
    assert "needs the column haze" in refused("hypotheses", *both, "--function", "x=haze")
    assert "All stimuli have the same coordinate" in refused("hypotheses", *both[:2], *both[4:], "--function", "x=1")
    (tables / "s.csv").write_text("stimulus,alpha\ns0,0.1\n")
    assert "No --stimuli has a column rho_d" in refused("hypotheses", *both)


def test_ratings_along_the_other_axis_alone(refused, tables):
    table = pd.read_csv(tables / "m.csv").query("axis == 'd'")
    table.to_csv(tables / "m.csv", index=False)
    message = refused("hypotheses", *options(tables, "magnitudes"))
    assert "holds no ratings along c, but along d. Choose --axis d, or give --pairs" in message


def test_help_has_examples(gloss):
    code, out, _ = gloss("hypotheses", "--help")
    assert code == 0
    assert '    gloss hypotheses study/dataset --axis d --function "square=1 - alpha**2"' in out.splitlines()


def test_a_study_brings_its_measurements_and_calls_its_observers_simulated(gloss, tmp_path):
    dataset = tmp_path / "dataset"
    values = judged_by([1.78], integers=True).values[0]
    trials = [
        {"block": 1, "trial": n, "repeat": 1, "response_time_s": None, "stimulus_left": f"s{a}",
         "stimulus_right": f"s{b}", "dissimilarity": int(value)}
        for n, ((a, b), value) in enumerate(zip(itertools.combinations(range(27), 2), values, strict=True), start=1)
    ]  # fmt: skip
    write_session_data(
        dataset, trials, kind="pairwise", participant="01", session="1", task="pairwise", observer="simulated"
    )
    EXPERIMENT_1.to_csv(dataset / "stimuli.csv", index=False)
    folder = tmp_path / "stimuli" / "experiment1"
    folder.mkdir(parents=True)
    entries = [
        {"name": row.stimulus, "rho_d": row.rho_d, "rho_s": row.rho_s, "alpha": row.alpha}
        for row in EXPERIMENT_1.itertuples()
    ]
    assert STIMULI[0] == entries[0]["name"]
    _write_set(folder, entries)
    contrast_of(EXPERIMENT_1).to_csv(folder / "measurements.csv", index=False)
    code, out, err = gloss("hypotheses", dataset, "--json")
    assert code == 0, err
    document = json.loads(out)
    assert document["simulated"] == ["01"]
    assert "1 of 1 participants are simulated" in err
    assert document["ratings"] is None
    assert [one["hypothesis"] for one in document["pairs"]] == [one.name for one in HYPOTHESES_C]


def _write_set(folder, entries):
    """A stimulus set as far as its reader asks: files that are there, and a manifest that lists them."""
    for entry in entries:
        for kind, suffix in (("image", "png"), ("luminance", "exr")):
            entry[kind] = f"{entry['name']}.{suffix}"
            (folder / entry[kind]).write_bytes(b"x")
        entry["sha256"] = dict.fromkeys(("image", "luminance"), "0" * 64)
    manifest = {
        "format": MANIFEST_FORMAT, "version": 1, "name": "experiment1", "stimuli": entries,
        "image": {"width": 8, "height": 8}, "viewing": {"image_width_deg": 3.2}, "display": {},
    }  # fmt: skip
    (folder / MANIFEST_NAME).write_text(json.dumps(manifest))
