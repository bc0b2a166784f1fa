"""From long tables to condensed triangles."""

import numpy as np
import pandas as pd
import pytest

from gloss_analysis.judgements.judgement_table import COLUMNS, from_table, read_table
from glossspace.errors import GlossError


def table(*rows):
    return pd.DataFrame(list(rows), columns=list(COLUMNS))


def test_upper_triangle_row_by_row():
    data = from_table(table(("1", "a", "b", 1), ("1", "a", "c", 2), ("1", "b", "c", 0)))
    assert data.stimuli == ("a", "b", "c")
    assert data.values.tolist() == [[1, 2, 0]]  # zero is data


def test_both_orders_of_a_pair_are_repeats_and_identical_pairs_are_left_out():
    data = from_table(table(("1", "a", "b", 1), ("1", "b", "a", 4), ("1", "c", "c", 9), ("1", "c", "a", 2)))
    assert data.stimuli == ("a", "b", "c")
    assert data.values[0].tolist()[:2] == [2.5, 2]
    assert np.isnan(data.values[0, 2])


def test_participants_keep_their_labels_and_order(tmp_path):
    path = tmp_path / "pairs.csv"
    path.write_text("participant_id,stimulus_a,stimulus_b,dissimilarity\n02,NA,b,1\n02,NA,c,2\n01,b,c,\n01,b,NA,3\n")
    data = read_table(path)
    assert data.participants == ("02", "01")
    assert data.stimuli == ("NA", "b", "c")
    assert data.values[0, :2].tolist() == [1, 2]
    assert np.isnan(data.values[1]).tolist() == [False, True, True]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("participant_id,stimulus_a,stimulus_b\n1,a,b\n", "lacks the column 'dissimilarity'"),
        (";".join(COLUMNS) + "\n1;a;b;1\n1;b;c;2\n", r"lacks the column 'participant_id'.* Save it as CSV with commas"),
        (",".join(COLUMNS) + "\n1,a,b,1\n1,b,c,-2\n", r"line 3: dissimilarity '-2' is not allowed"),
        (",".join(COLUMNS) + "\n1,a,b,inf\n1,b,c,2\n", r"line 2: dissimilarity 'inf' is not allowed"),
        (",".join(COLUMNS) + "\n1,a,b,much\n1,b,c,2\n", r"line 2: dissimilarity 'much' is not allowed"),
        (",".join(COLUMNS) + "\n1,a,b,1\n1,,c,2\n", r"line 3: a participant or stimulus has no name"),
        (",".join(COLUMNS) + "\n1,a,b,1\n", "holds 2 stimuli. Scaling needs at least 3"),
        ("", "is empty"),
    ],
)
def test_broken_tables_are_refused_in_one_line(tmp_path, content, message):
    path = tmp_path / "pairs.csv"
    path.write_text(content)
    with pytest.raises(GlossError, match=message) as caught:
        read_table(path)
    assert "\n" not in str(caught.value)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(GlossError, match=r"No dissimilarity table at .*nowhere\.csv"):
        read_table(tmp_path / "nowhere.csv")
