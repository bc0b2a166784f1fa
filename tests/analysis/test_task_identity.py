"""Ratings against MDS scale values: linear where they are, bent where they are bent, silent where too few tell."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scipy.stats import linregress

from gloss_analysis.confirmatory.scaling import confirm_axes
from gloss_analysis.confirmatory.task_identity import among, compare_tasks
from gloss_analysis.ratings.axis_ratings import read_axis_ratings
from glossspace.errors import GlossError
from tests.analysis.studies import EXPERIMENT_1, axis_values, judged_by

AXES = ("c", "d")
NAMES = EXPERIMENT_1["stimulus"].tolist()
AT_04 = [name for name, alpha in zip(NAMES, EXPERIMENT_1["alpha"], strict=True) if alpha == 0.04]


def rated(names, values):
    rows = [
        (who, name, value + shift)
        for who, shift in (("1", 0), ("2", 3))
        for name, value in zip(names, values, strict=True)
    ]
    return pd.DataFrame(rows, columns=["participant_id", "stimulus", "rating"])


@pytest.fixture(scope="module")
def data():
    return judged_by([1.5, 1.78, 2.1])


def c_of(names):
    return axis_values()[[NAMES.index(name) for name in names], 0]


def test_ratings_that_are_the_axis_are_linear_in_the_scale(data):
    (found,) = compare_tasks(data, axis_values(), {"c": rated(AT_04, 10 + 300 * c_of(AT_04))}, axes=AXES)
    assert found.stimuli == tuple(AT_04)
    assert found.n_rated == 9
    # Order alone fixes scale values of 27 stimuli to some parts in a thousand.
    assert found.regression.r_squared > 0.999
    assert found.regression.slope > 0
    assert "less than the .01" in found.sentences[1]
    assert found.stress1_rated == pytest.approx(found.stress1_given, abs=1e-9)  # the same coordinate in another unit
    # At alpha .04 nothing but c differs: the stress is that of one axis on these 36 pairs.
    nine = among(data, tuple(AT_04))
    alone = confirm_axes(nine, c_of(AT_04)[:, np.newaxis], axes=("c",)).shared.stress1
    assert found.stress1_given == pytest.approx(alone, rel=1e-12)


def test_bent_ratings_are_seen_and_cost_stress(data):
    c = c_of(AT_04)
    (found,) = compare_tasks(data, axis_values(), {"c": rated(AT_04, 90 * (c / c.max()) ** 3)}, axes=AXES)
    assert "not less than .01. Order 2 predicts left-out stimuli best" in found.sentences[1]
    assert found.stress1_rated > found.stress1_given + 0.05  # a cube is no rounding


def test_reversed_ratings_are_said_to_be(data):
    (found,) = compare_tasks(data, axis_values(), {"c": rated(AT_04, 90 - 300 * c_of(AT_04))}, axes=AXES)
    assert "Ratings fall where the MDS scale of c rises" in found.sentences[1]


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (AT_04[:2], "2 of 4 rated stimuli were judged in pairs too, too few to compare the tasks. Rate 5 or more"),
        (AT_04[:3], "Whether the relation is a line or a curve cannot be told from 3 stimuli"),
    ],
)
def test_too_few_common_stimuli_are_said_to_be(data, names, message):
    table = rated([*names, "elsewhere", "nowhere"], range(10, 10 * len(names) + 30, 10))
    (found,) = compare_tasks(data, axis_values(), {"c": table}, axes=AXES)
    assert message in " ".join(found.sentences)


def test_equal_ratings_and_unknown_axes(data):
    (found,) = compare_tasks(data, axis_values(), {"c": rated(AT_04, [50] * 9)}, axes=AXES)
    assert "do not differ enough for a line" in found.sentences[0]
    assert found.regression is None
    with pytest.raises(GlossError, match="Ratings along 'e', which is no axis here. Allowed: c, d"):
        compare_tasks(data, axis_values(), {"e": rated(AT_04, range(9))}, axes=AXES)
    with pytest.raises(GlossError, match="Ratings along c: Participant 2 has no rating of the stimulus s0"):
        compare_tasks(data, axis_values(), {"c": rated(AT_04, range(9)).drop(index=9)}, axes=AXES)


def test_pairs_of_some_stimuli_are_those_of_all(data):
    some = among(data, ("s5", "s0", "s9"))
    first, second = data.pairs
    for k, pair in enumerate([(0, 5), (5, 9), (0, 9)]):
        place = np.flatnonzero((first == pair[0]) & (second == pair[1]))[0]
        assert some.values[:, k].tolist() == data.values[:, place].tolist()


def test_weights_of_pairs_and_participants_go_with_some_stimuli(data):
    weights = np.arange(3 * 351.0).reshape(3, 351)
    some = among(replace(data, pair_weights=weights, source_weights=np.array([1.0, 2, 3])), ("s5", "s0", "s9"))
    numbers = np.zeros((27, 27), dtype=int)
    numbers[data.pairs] = np.arange(351)
    assert some.pair_weights.tolist() == weights[:, [numbers[0, 5], numbers[5, 9], numbers[0, 9]]].tolist()
    assert some.source_weights.tolist() == [1, 2, 3]


def test_the_regression_is_on_scale_values_that_rise_with_the_given_axis():
    judged = judged_by([1.5, 2.1], noise_sd=8.0)
    ratings = {"c": rated(AT_04, 10 + 300 * c_of(AT_04) ** 1.2)}
    up, down = (
        compare_tasks(judged, given, ratings, axes=AXES, n_starts=20)[0] for given in (axis_values(), -axis_values())
    )
    assert down.scale_value.tolist() == (-up.scale_value).tolist()
    for one, sign in ((up, 1), (down, -1)):
        assert sign * np.corrcoef(one.scale_value, c_of(AT_04))[0, 1] > 0.9
        line = linregress(one.scale_value, one.rating)
        assert (one.regression.slope, one.regression.r_squared) == pytest.approx((line.slope, line.rvalue**2))


class TestTable:
    def write(self, tmp_path, table):
        path = tmp_path / "m.csv"
        table.to_csv(path, index=False)
        return path

    def read(self, path):
        return read_axis_ratings(path, tuple(NAMES), axis_values(), axes=AXES)

    def test_the_stimuli_tell_the_axis(self, tmp_path):
        found = self.read(self.write(tmp_path, rated(AT_04, range(9))))
        assert list(found) == ["c"]
        assert found["c"]["rating"].tolist() == [*range(9), *range(3, 12)]
        assert found["c"]["participant_id"].tolist() == ["1"] * 9 + ["2"] * 9
        assert list(self.read(self.write(tmp_path, rated(["s0", "s1", "s2"], range(3))))) == ["d"]

    def test_a_column_tells_where_they_do_not(self, tmp_path):
        table = rated(NAMES, range(27))
        with pytest.raises(GlossError, match="the 27 rated stimuli whose coordinates are known differ along c and d"):
            self.read(self.write(tmp_path, table))
        assert list(self.read(self.write(tmp_path, table.assign(axis="d")))) == ["d"]

    @pytest.mark.parametrize(
        ("change", "message"),
        [
            (lambda t: t.assign(rating="inf"), "line 2: rating 'inf' is not allowed"),
            (lambda t: t.assign(rating="-1"), "line 2: rating '-1' is not allowed"),
            (lambda t: t.assign(rating="red"), "line 2: rating 'red' is not allowed"),
            (lambda t: t.assign(rating=""), "holds no rating"),
            (lambda t: t.assign(stimulus=""), "line 2: the stimulus is empty"),
            (lambda t: t.assign(axis="x"), "axis 'x' is not known. Allowed: c, d"),
            (lambda t: t.assign(axis=""), "axis 'nan' is not known"),
            (lambda t: t.assign(stimulus=t["stimulus"] + "x"), "none of the rated stimuli was judged in pairs"),
            (lambda t: t[t["stimulus"] == "s0"], "differ along none of the axes"),
        ],
    )
    def test_damaged_tables(self, tmp_path, change, message):
        with pytest.raises(GlossError, match=message):
            self.read(self.write(tmp_path, change(rated(AT_04, range(9)))))
