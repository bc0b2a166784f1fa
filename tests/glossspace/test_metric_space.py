"""The gloss space: eq. 5 of the gloss paper, and the file that a refitted one is."""

import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from glossspace.errors import GlossError
from glossspace.metric import PAPER_SPACE, AxisFunction, GlossSpace, Paint

paints = st.builds(
    lambda rho_d, share, alpha: Paint(rho_d, share * (1 - rho_d), alpha),
    st.floats(0, 1), st.floats(0, 1), st.floats(1e-6, 10),
)  # fmt: skip
weights = st.floats(1e-3, 1e3)
spaces = st.builds(lambda c, d: GlossSpace(weight_c=c, weight_d=d), weights, weights)

REFITTED = GlossSpace(
    weight_c=1.0,
    weight_d=1.9125,
    name="Nine simulated observers – Ďurikovič's [red]",
    weight_d_ci95=(1.7, 2.1),
    axis_functions={"c": AxisFunction(7.5, 0.1, 0.94, 24), "d": AxisFunction(5.0, -0.25, 0.96, 11)},
    stimulus_range={"rho_d": (0.03, 0.767), "alpha": (0.04, 0.1)},
    provenance={"observers": "simulated", "seed": 1},
)


class TestDistance:
    def test_eq_5_by_hand(self):
        """Blacks, where c = cbrt(rho_s): c = .5 against .2, d = .9 against .5."""
        distance = PAPER_SPACE.distance(Paint(0, 0.125, 0.1), Paint(0, 0.008, 0.5))
        # 1e-15: roundings of numbers near one
        assert distance == pytest.approx(math.sqrt(0.3**2 + (1.78 * 0.4) ** 2), rel=1e-15)

    def test_the_weight_of_the_paper(self):
        assert PAPER_SPACE.weight_c == 1
        assert PAPER_SPACE.weight_d == 1.78
        assert PAPER_SPACE.distance(Paint(0.193, 0.066, 0.1), Paint(0.193, 0.066, 0.04)) == pytest.approx(
            1.78 * 0.06, rel=1e-14
        )

    @given(spaces, paints, paints)
    def test_symmetric_and_never_negative(self, space, a, b):
        assert space.distance(a, b) == space.distance(b, a) >= 0

    @given(spaces, paints)
    def test_zero_from_itself(self, space, paint):
        assert space.distance(paint, paint) == 0

    @given(spaces, paints, paints)
    def test_zero_only_between_equal_coordinates(self, space, a, b):
        same = space.coordinates(a) == space.coordinates(b)
        assert (space.distance(a, b) == 0) == same

    @given(spaces, paints, paints, paints)
    def test_no_detour_is_shorter(self, space, a, b, c):
        # the relative slack is the rounding of three hypotenuses, for detours along a straight line
        assert space.distance(a, c) <= (space.distance(a, b) + space.distance(b, c)) * (1 + 1e-14)

    @given(paints, paints, st.floats(1e-3, 1e3))
    def test_common_factor_of_the_weights_is_a_unit(self, a, b, unit):
        scaled = GlossSpace(weight_c=unit, weight_d=1.78 * unit)
        assert scaled.distance(a, b) == pytest.approx(unit * PAPER_SPACE.distance(a, b), rel=1e-14)

    def test_lightness_enters_through_c_alone(self):
        assert PAPER_SPACE.distance(Paint(0.03, 0.099, 0.04), Paint(0.767, 0.099, 0.04)) > 0.1
        assert PAPER_SPACE.distance(Paint(0.03, 0, 0.04), Paint(0.767, 0, 0.04)) == 0

    def test_arrays_broadcast_and_nan_stays_where_it_was(self):
        stimuli = Paint(np.array([0.03, np.nan, 0.767]), 0.066, 0.07)
        distances = PAPER_SPACE.distance(Paint(*(np.reshape(v, (-1, 1)) for v in stimuli)), stimuli)
        assert distances.shape == (3, 3)
        known = np.isfinite(distances)
        np.testing.assert_array_equal(known, np.outer([1, 0, 1], [1, 0, 1]).astype(bool))
        assert isinstance(PAPER_SPACE.distance(Paint(0, 0, 0.1), Paint(0, 0, 0.2)), float)
        assert [v.shape for v in PAPER_SPACE.coordinates(stimuli)] == [(3,), (3,)]

    def test_points_where_no_paint_is_have_distances(self):
        assert PAPER_SPACE.distance_between(-0.3, 1.5, 0.0, 1.5) == pytest.approx(0.3, rel=1e-15)

    @pytest.mark.parametrize(
        ("points", "message"),
        [
            ((np.inf, 0, np.inf, 0), r"^Invalid c_a = inf\. Allowed: finite\.$"),
            ((0, 0, 0, -np.inf), r"^Invalid d_b = -inf\."),
            ((0, "x", 0, 0), r"^d_a must be a number"),
            (([0, 1], 0, [0, 1, 2], 0), r"c_a \(2,\), d_a \(\), c_b \(3,\), d_b \(\)"),
        ],
    )
    def test_impossible_points_are_refused(self, points, message):
        with pytest.raises(GlossError, match=message):
            PAPER_SPACE.distance_between(*points)

    def test_impossible_paints_are_refused(self):
        with pytest.raises(GlossError, match=r"^Invalid alpha = 0\.0\."):
            PAPER_SPACE.distance(Paint(0.1, 0.1, 0.1), Paint(0.1, 0.1, 0.0))
        with pytest.raises(GlossError, match=r"do not broadcast: rho_d \(2,\), rho_s \(\), alpha \(3,\)"):
            PAPER_SPACE.coordinates(Paint([0.1, 0.2], 0.1, [0.1, 0.2, 0.3]))


def test_what_no_float_holds_is_infinitely_far():
    assert PAPER_SPACE.distance(Paint(0.1, 0.1, 1.7e308), Paint(0.1, 0.1, 0.1)) == np.inf


LINE = {"slope": 50, "intercept": 10, "r_squared": 0.9, "n_stimuli": 9}


@pytest.mark.parametrize("weight", [0, -1.78, np.nan, np.inf, "1.78", None, True, 10**400, 1j, [1.78]], ids=repr)
@pytest.mark.parametrize("name", ["weight_c", "weight_d"])
def test_impossible_weights_are_refused(name, weight):
    with pytest.raises(GlossError, match=f"^Invalid {name} = .* of a gloss space. Allowed: a finite number > 0"):
        GlossSpace(**{name: weight})


@pytest.mark.parametrize(
    "interval", [(np.nan, 2.0), (1.0,), (2.0, 1.0), (1.0, np.inf), ("1", "2"), (1, 2, 3)], ids=repr
)
def test_impossible_intervals_are_refused(interval):
    with pytest.raises(GlossError, match=r"^Invalid weight_d_ci95 = "):
        GlossSpace(weight_d_ci95=interval)


class TestFile:
    @pytest.mark.parametrize("space", [PAPER_SPACE, REFITTED], ids=["paper", "refitted"])
    def test_round_trip(self, space, tmp_path):
        space.save(tmp_path / "gloss-space.json")
        assert GlossSpace.load(tmp_path / "gloss-space.json") == space
        assert [file.name for file in tmp_path.iterdir()] == ["gloss-space.json"]

    def test_the_numbers_of_numpy_are_saved(self, tmp_path):
        space = GlossSpace(
            weight_d=np.float32(1.5),
            weight_d_ci95=(np.float64(1), np.float32(2)),
            axis_functions={"c": AxisFunction(np.float64(1), 0.0, 0.9, np.int64(24))},
            provenance={"seeds": np.arange(3)},
        )
        space.save(tmp_path / "s.json")
        loaded = GlossSpace.load(str(tmp_path / "s.json"))
        assert loaded.weight_d == 1.5
        assert loaded.axis_functions["c"].n_stimuli == 24
        assert loaded.provenance == {"seeds": [0, 1, 2]}

    def test_document_is_versioned_and_names_its_axes(self, tmp_path):
        REFITTED.save(tmp_path / "s.json")
        document = json.loads((tmp_path / "s.json").read_text(encoding="utf-8"))
        assert document["format"] == "glossspace/gloss-space"
        assert document["version"] == 2
        assert document["axes"]["d"] == {
            "form": "1 - alpha",
            "parameters": {"exponent": 1.0, "offset": 0.0},
            "weight": 1.9125,
            "weight_ci95": [1.7, 2.1],
            "ratings": {
                "slope": 5.0,
                "intercept": -0.25,
                "r_squared": 0.96,
                "n_stimuli": 11,
                "slope_ci95": None,
                "intercept_ci95": None,
            },
        }

    def test_a_file_of_version_1_still_opens(self, tmp_path):
        """Written as the first version did: without parameters of the forms, and without intervals of the ratings."""

        def change(document):
            document["version"] = 1
            for axis in document["axes"].values():
                del axis["parameters"]
                for key in ("slope_ci95", "intercept_ci95"):
                    (axis["ratings"] or {}).pop(key, None)

        assert self.load_changed(tmp_path, change) == REFITTED

    def test_a_byte_order_mark_does_no_harm(self, tmp_path):
        REFITTED.save(tmp_path / "s.json")
        content = (tmp_path / "s.json").read_bytes()
        (tmp_path / "s.json").write_bytes(b"\xef\xbb\xbf" + content)
        assert GlossSpace.load(tmp_path / "s.json") == REFITTED

    @staticmethod
    def load_changed(tmp_path, change):
        REFITTED.save(tmp_path / "s.json")
        document = json.loads((tmp_path / "s.json").read_text(encoding="utf-8"))
        change(document)
        (tmp_path / "s.json").write_text(json.dumps(document), encoding="utf-8")
        return GlossSpace.load(tmp_path / "s.json")

    def test_what_is_optional_may_be_absent(self, tmp_path):
        def change(document):
            del document["stimulus_range"], document["provenance"], document["axes"]["c"]["ratings"]

        space = self.load_changed(tmp_path, change)
        assert space.weight_d == REFITTED.weight_d
        assert space.stimulus_range == {}
        assert set(space.axis_functions) == {"d"}

    @pytest.mark.parametrize(
        ("change", "message"),
        [
            (lambda d: d.update(format="psych-ds"), "is not a gloss space: its format is 'psych-ds'"),
            (lambda d: d.pop("format"), "is not a gloss space: its format is None"),
            (
                lambda d: d.update(version=3),
                "is a gloss space of version 3; this program reads versions 1 and 2. Update",
            ),
            (lambda d: d["axes"]["c"]["parameters"].update(exponent=9), "cannot be used: Invalid exponent = 9 of"),
            (
                lambda d: d["axes"]["c"]["parameters"].update(exponent=0.5),
                "cannot be used: axis c has the unknown form",
            ),
            (lambda d: d["axes"]["c"]["parameters"].update(slope=1), "cannot be used: .*unexpected keyword"),
            (lambda d: d["axes"]["c"].pop("parameters"), "cannot be used: 'parameters' is missing"),
            (lambda d: d.update(version="1"), "is a gloss space of version '1'"),
            (lambda d: d.pop("axes"), "cannot be used: 'axes' is missing. Restore"),
            (lambda d: d.pop("name"), "cannot be used: 'name' is missing. Restore"),
            (lambda d: d["axes"].pop("d"), "cannot be used: 'd' is missing"),
            (lambda d: d["axes"]["d"].pop("weight"), "cannot be used: 'weight' is missing"),
            (lambda d: d["axes"]["d"].update(weight=-1), "cannot be used: Invalid weight_d = -1 of"),
            (lambda d: d["axes"]["d"].update(weight="1.78"), "cannot be used: Invalid weight_d = '1.78' of"),
            (lambda d: d["axes"]["d"].update(weight=True), "cannot be used: Invalid weight_d = True of"),
            (lambda d: d["axes"]["d"].update(weight=None), "cannot be used: Invalid weight_d = None of"),
            (lambda d: d["axes"]["d"].update(weight=math.nan), "is not valid JSON: NaN is not a number in JSON"),
            (lambda d: d["axes"]["d"].update(weight_ci95=[1]), "cannot be used: Invalid weight_d_ci95"),
            (lambda d: d["axes"]["d"].update(weight_ci95=7), "cannot be used: "),
            (lambda d: d["axes"]["d"].update(form="alpha"), "cannot be used: axis d has the unknown form 'alpha'"),
            (lambda d: d["axes"]["d"].update(ratings={"slope": 1}), "cannot be used: 'intercept' is missing"),
            (lambda d: d["axes"]["d"].update(ratings=[1]), "cannot be used: "),
            (lambda d: d.update(axes=[]), "cannot be used: "),
            (lambda d: d.update(stimulus_range=[1]), "cannot be used: "),
            (lambda d: d.update(stimulus_range={"rho_d": [1]}), "cannot be used: "),
            # A file that was edited by hand: 1e999 reads as infinity, and a word as a number, if nobody looks.
            (
                lambda d: d.update(stimulus_range={"alpha": ["nan", "nan"]}),
                "stimulus_range of alpha must be two finite",
            ),
            (lambda d: d.update(stimulus_range={"alpha": [0.1, 0.04]}), "the lower one first, not .0.1, 0.04."),
            (lambda d: d.update(stimulus_range={"alpha": "12"}), "must be two finite numbers.*not '12'"),
            (
                lambda d: d["axes"]["d"].update(ratings=LINE | {"slope": "nan"}),
                "cannot be used: slope = 'nan' of the ratings along d is no finite number",
            ),
            (
                lambda d: d["axes"]["d"].update(ratings=LINE | {"slope_ci95": [3, 2]}),
                "slope_ci95 of the ratings along d",
            ),
            (lambda d: d.update(provenance=[1]), "cannot be used: "),
        ],
    )
    def test_damaged_foreign_and_newer_files_are_refused_in_one_line(self, change, message, tmp_path):
        with pytest.raises(GlossError, match=message) as caught:
            self.load_changed(tmp_path, change)
        assert "s.json'" in str(caught.value)
        assert "\n" not in str(caught.value)
        assert str(caught.value).endswith(".")

    def test_missing_file_is_refused(self, tmp_path):
        with pytest.raises(GlossError, match=r"^No gloss space at '.*none\.json'\. Check the path\.$"):
            GlossSpace.load(tmp_path / "none.json")
