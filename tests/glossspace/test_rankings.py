"""Rankings in the dataset: what is written is read, and what is broken is told where."""

import pytest

from glossspace.dataset import (
    dataset_problems,
    read_dissimilarities,
    read_rankings,
    tasks_of,
    validate_dataset,
    write_session_data,
)
from glossspace.errors import GlossError

WHO = {"participant": "01", "task": "order", "observer": "human"}


def ranking(order, *, reference="r", trial=1, repeat=1, start=("a", "b", "c")):
    """Rows of one ranking; an empty order is one that was not finished."""
    ranks = {name: rank for rank, name in enumerate(order, start=1)}
    return [
        {
            **{"block": repeat, "trial": trial, "repeat": repeat, "reference": reference, "stimulus": name},
            **{"start_place": place, "rank": ranks.get(name), "response_time_s": 30.5},
        }
        for place, name in enumerate(start, start=1)
    ]


@pytest.fixture
def study(tmp_path):
    """Dataset of one participant: two rankings in a first session, one in a second, and one not finished."""
    first = ranking("bac") + ranking("bca", trial=2, repeat=2, start=("c", "a", "b"))
    write_session_data(tmp_path, first, kind="ranking", session="1", **WHO)
    second = ranking("cab") + ranking("", trial=2, repeat=2)
    write_session_data(tmp_path, second, kind="ranking", session="2", **WHO)
    return tmp_path


def edit(study, old, new):
    path = study / "data" / "subject-01" / "subject-01_session-1_task-order_data.csv"
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


def test_what_is_written_is_read(study):
    validate_dataset(study)
    assert tasks_of(study) == {"order": "ranking"}
    table = read_rankings(study, "order")
    assert set(table["reference"]) == {"r"}
    ranks = {name: one.sort_values("repeat")["rank"].tolist() for name, one in table.groupby("stimulus")}
    assert ranks == {"a": [2, 3, 2], "b": [1, 1, 3], "c": [3, 2, 1]}, "repeats count on; the unfinished one is absent"
    assert set(table["repeat"]) == {1, 2, 3}
    # Another set on a third day is a fourth ranking, also for a stimulus that was not there before.
    write_session_data(study, ranking("dca", start=("a", "c", "d")), kind="ranking", session="3", **WHO)
    last = read_rankings(study, "order").query("repeat == 4").set_index("stimulus")["rank"]
    assert last.to_dict() == {"a": 3, "c": 2, "d": 1}
    write_session_data(study, ranking("abc"), kind="ranking", session="1", **(WHO | {"task": "another"}))
    assert read_rankings(study, "another")["rank"].tolist() == [1, 2, 3]
    assert len(read_rankings(study, "order")) == 12
    with pytest.raises(GlossError, match="holds no judged pair"):
        read_dissimilarities(study)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (",b,2,1,", ",b,2,0,", "line 3: rank '0' is not a whole number from 1"),
        (",b,2,1,", ",b,2,1.5,", "line 3: rank '1.5' is not a whole number from 1"),
        (",r,b,2,1,", ",r,a,2,1,", "line 3: the trial a is already in .*line 2; remove one row"),
        (",b,2,1,", ",,2,1,", "line 3: no stimulus is named"),
        ("start_place", "place", "has no column 'start_place'; a ranking file has row_id, participant_id"),
    ],
)
def test_a_broken_ranking_is_told_where(study, old, new, message):
    edit(study, old, new)
    with pytest.raises(GlossError, match=message):
        validate_dataset(study)


def test_a_dataset_without_rankings_of_that_name(study):
    with pytest.raises(GlossError, match="holds no rank of the task 'other'; its ranking tasks are: order"):
        read_rankings(study, "other")
    assert dataset_problems(study) == []
