"""Tables of ratings: what is read, which axis they are about, and what is refused in one line."""

import re

import numpy as np
import pandas as pd
import pytest

from gloss_analysis.ratings.rating_table import from_rating_table, read_ratings, varied_axis
from glossspace.errors import GlossError

STIMULI = pd.DataFrame(
    [("a", 0.03, 0.03, 0.04), ("b", 0.2, 0.1, 0.04), ("x", 0.03, 0.03, 0.07), ("y", 0.03, 0.03, 0.1)],
    columns=["stimulus", "rho_d", "rho_s", "alpha"],
)
GOOD = "participant_id,stimulus,repeat,rating\n01,x,1,10\n01,a,1,30.5\n01,x,2,20\n02,x,1,\n02,a,1,0\n"


@pytest.fixture
def read(tmp_path):
    def run(text):
        path = tmp_path / "ratings.csv"
        path.write_text(text)
        return read_ratings(path, STIMULI)

    return run


def test_a_table_keeps_names_as_text_zeros_as_data_and_leaves_unjudged_trials_out(read):
    (axis, table), *none = read(GOOD).items()
    assert (axis, none) == ("d", [])
    assert table.columns.tolist() == ["participant_id", "stimulus", "repeat", "rating"]
    assert table.to_numpy().tolist() == [
        ["01", "x", 1, 10.0],
        ["01", "a", 1, 30.5],
        ["01", "x", 2, 20.0],
        ["02", "a", 1, 0.0],
    ]


def test_without_repeats_their_order_counts_and_further_columns_do_not_matter(read):
    table = read("stimulus,remark,participant_id,rating\nx,good,1,10\nx,,1,12\na,,1,4\nx,,2,9\n")["d"]
    assert table["repeat"].tolist() == [1, 2, 1, 1]


def test_a_column_of_axes_holds_two_studies_in_one_table(read):
    both = read("participant_id,stimulus,repeat,rating,axis\n1,a,1,5,d\n1,a,1,6,c\n1,b,1,7,c\n1,x,1,8,d\n")
    assert {axis: table["rating"].tolist() for axis, table in both.items()} == {"c": [6, 7], "d": [5, 8]}


@pytest.mark.parametrize(("names", "axis"), [(["a", "b"], "c"), (["x", "y"], "d"), (["a", "x", "y", "a"], "d")])
def test_the_stimuli_tell_the_axis(names, axis):
    assert varied_axis(STIMULI, names) == axis


@pytest.mark.parametrize(
    ("names", "why"),
    [(["a", "b", "x"], "differ in their reflectances and in alpha"), (["a"], "are all of one paint")],
)
def test_stimuli_that_do_not_tell_the_axis(names, why):
    with pytest.raises(GlossError, match=f"{why}, .*Add the column `axis` with c or d"):
        varied_axis(STIMULI, names)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("1,10", "1,-1", "line 2: rating '-1' is not allowed"),
        ("1,10", "1,ten", "line 2: rating 'ten' is not allowed"),
        ("1,10", "1,inf", "line 2: rating 'inf' is not allowed"),
        ("1,10", "1,nan", "line 2: rating 'nan' is not allowed"),
        ("1,10", "1,1e308", "line 2: rating '1e308' is not allowed. Allowed: 0, a number from 1e-100 to 1e+100"),
        ("1,10", "1,1e-310", "line 2: rating '1e-310' is not allowed"),
        ("x,2", "x,1", "line 4: repeat 1 of 'x' by participant 01 is there already"),
        ("x,2", "x,0", "line 4: repeat '0' is not allowed. Allowed: a whole number from 1"),
        ("x,2", "x,1.5", "line 4: repeat '1.5' is not allowed"),
        ("x,2", "x,", "line 4: repeat '' is not allowed"),
        ("x,2", "x,1e400", "line 4: repeat '1e400' is not allowed"),
        ("02,a", ",a", "line 6: the participant_id is empty"),
        ("02,a", "02,", "line 6: the stimulus is empty"),
        ("02,a", "02,q", "The stimulus 'q' was judged, but its rho_d, rho_s and alpha are not known"),
        ("01,a", "01,b", "Add the column `axis`"),
        ("rating", "score", "lacks the column 'rating'"),
        (GOOD[GOOD.index("\n") :], "\n", "holds no rating"),
    ],
)
def test_damaged_tables(read, old, new, message):
    with pytest.raises(GlossError, match=re.escape(message)):
        read(GOOD.replace(old, new, 1))


@pytest.mark.parametrize("axis", ["", "C", "contrast"])
def test_an_axis_is_c_or_d(read, axis):
    with pytest.raises(GlossError, match=f"line 3: axis '{axis}' is not allowed. Allowed: c or d."):
        read(f"participant_id,stimulus,repeat,rating,axis\n1,a,1,5,c\n1,b,1,6,{axis}\n")


def test_a_table_from_elsewhere_names_rows():
    table = pd.DataFrame({"participant_id": [1, 1], "stimulus": ["x", "y"], "rating": [1.0, -np.inf]})
    with pytest.raises(GlossError, match="the table, row 2: rating '-inf'"):
        from_rating_table(table, STIMULI)
    with pytest.raises(GlossError, match="lacks the column 'stimulus'"):
        from_rating_table(table.drop(columns="stimulus"), STIMULI)
