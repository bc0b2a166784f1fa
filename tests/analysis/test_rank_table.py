import re

import numpy as np
import pandas as pd
import pytest

from gloss_analysis.ranking.rank_table import from_rank_table, read_ranks
from glossspace.errors import GlossError


def test_ranks_are_arranged_by_participant_repeat_and_stimulus(tmp_path):
    path = tmp_path / "ranks.csv"
    path.write_text(
        "participant_id,repeat,stimulus,rank,note\n01,a,x,1,\n01,a,y,2.5,\n01,b,y,1,\n01,b,x,,\n2,a,z,3,\n", "utf-8"
    )
    rankings = read_ranks(path)
    assert (rankings.participants, rankings.stimuli) == (("01", "2"), ("x", "y", "z"))
    nan = np.nan
    expected = [[[1, 2.5, nan], [nan, 1, nan]], [[nan, nan, 3], [nan, nan, nan]]]
    assert np.array_equal(rankings.ranks, expected, equal_nan=True)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("01,x,first", "'r.csv', line 2: rank 'first' is not allowed. Allowed: a finite number"),
        ("01,x,inf", "rank 'inf' is not allowed"),
        ("01,x,nan", "rank 'nan' is not allowed"),
        ("01,x,1\n01,x,2", "line 3: participant 01 ranked 'x' already. Remove one, or add the column `repeat`"),
        (",x,1", "line 2: the participant_id is empty"),
        ("01,,1", "the stimulus is empty"),
        ("01,x,", "'r.csv' holds no rank"),
        ("", "'r.csv' holds no rank"),
    ],
)
def test_mistakes(tmp_path, monkeypatch, rows, message):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "r.csv").write_text(f"participant_id,stimulus,rank\n{rows}\n", "utf-8")
    with pytest.raises(GlossError, match=re.escape(message)):
        read_ranks("r.csv")


def test_mistakes_in_repeats_and_columns():
    table = pd.DataFrame({"participant_id": "1", "stimulus": ["a", "a"], "rank": [1, 2], "repeat": ["x", "x"]})
    with pytest.raises(GlossError, match=r"the table, row 2: participant 1 ranked 'a' already\. Remove one of the two"):
        from_rank_table(table)
    with pytest.raises(GlossError, match="row 1: the repeat is empty"):
        from_rank_table(table.assign(repeat=[None, "x"]))
    with pytest.raises(GlossError, match="lacks the column 'rank'"):
        from_rank_table(table.drop(columns="rank"))
