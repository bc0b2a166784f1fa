"""What a dataset's rows must keep to beyond ratings of pairs: rankings, pilots, times and counts."""

import pytest

from glossspace.dataset import data_path, dataset_problems, read_rankings, validate_dataset, write_session_data
from glossspace.errors import GlossError

ITEMS = ("a", "b", "c")


def write_ranking(folder, *, ranks=(2, 1, 3), participant="01", pilot=False):
    rows = [
        {
            **{"block": 1, "trial": 1, "repeat": 1, "reference": "r", "stimulus": item, "start_place": place},
            **{"rank": rank, "response_time_s": 61.5, "timed_out": "no", "n_changes": 4},
        }
        for place, (item, rank) in enumerate(zip(ITEMS, ranks, strict=True), start=1)
    ]
    who = {"participant": participant, "session": "1", "task": "ranking", "observer": "human"}
    return write_session_data(folder, rows, kind="ranking", pilot=pilot, **who)


def problems_after(path, old, new):
    text = path.read_text("utf-8")
    assert old in text
    path.write_text(text.replace(old, new), "utf-8")
    return dataset_problems(path.parents[2])


def test_a_ranking_is_whole(tmp_path):
    write_ranking(tmp_path)
    write_ranking(tmp_path, participant="02", ranks=(None, None, None))
    validate_dataset(tmp_path)
    table = read_rankings(tmp_path, "ranking")
    assert table[["stimulus", "rank"]].to_numpy().tolist() == [["a", 2], ["b", 1], ["c", 3]]


@pytest.mark.parametrize(
    ("ranks", "said"),
    [((1, 1, 3), "1, 1, 3"), ((2, 3, 4), "2, 3, 4"), ((1, 2, None), "1, 2, empty")],
)
def test_each_rank_is_given_once(tmp_path, ranks, said):
    path = write_ranking(tmp_path, ranks=ranks)
    assert dataset_problems(tmp_path) == [
        f"'{path}', line 2: the ranks of trial 1 are {said}; each of 1 to 3 is given once."
    ]


def test_a_rank_that_is_no_number(tmp_path):
    (problem,) = problems_after(write_ranking(tmp_path), ",b,2,1,", ",b,2,first,")
    assert "line 3: rank 'first' is not a whole number from 1" in problem


def test_pilots_are_whole_where_they_belong(tmp_path):
    path = write_ranking(tmp_path / "pilots", pilot=True)
    assert path.read_text("utf-8").splitlines()[1].endswith(",yes")
    validate_dataset(tmp_path / "pilots")


def test_a_pilot_among_the_data_is_no_data(tmp_path):
    """No analysis takes it by accident: the readers refuse the whole dataset."""
    path = write_ranking(tmp_path, pilot=True)
    with pytest.raises(GlossError, match=r"line 2: this is a pilot, which is no data of the study; move the file"):
        read_rankings(tmp_path, "ranking")
    assert path == data_path(tmp_path, participant="01", session="1", task="ranking")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (",61.5,", ",-1,", "response_time_s '-1' is not a time from 0"),
        (",61.5,", ",nan,", "response_time_s 'nan' is not a time from 0"),
        (",61.5,", ",soon,", "response_time_s 'soon' is not a time from 0"),
        (",no,4\n", ",no,4.5\n", "n_changes '4.5' is not a whole number from 0"),
        (",no,4\n", ",maybe,4\n", "timed_out 'maybe'; allowed are 'yes' and 'no'"),
        (",no,4\n", ",yes,4\n", "the trial timed out, yet it has a rank"),
    ],
)
def test_times_and_counts(tmp_path, old, new, message):
    problems = problems_after(write_ranking(tmp_path), old, new)
    assert len(problems) == 3, "one a row"
    assert message in problems[0]
