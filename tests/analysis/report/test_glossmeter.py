"""The section about the virtual glossmeter: what it says is what its tables hold."""

import re

import pytest

from gloss_analysis.report.glossmeter import glossmeter_pictures, glossmeter_rows, glossmeter_tables, glossmeter_words


@pytest.fixture(scope="module")
def tables():
    return glossmeter_tables()


def test_every_sample_and_model_of_table_2_is_there_with_its_three_angles(tables):
    rows = glossmeter_rows(tables)
    assert len(rows) == 10  # five samples, two models: the glossmeter paper's table 2
    assert all([cell["angle_deg"] for cell in row["cells"]] == [20, 60, 85] for row in rows)
    assert rows[0]["rmse"]["printed"] == 1.974  # polished glass by Cook and Torrance, as printed


def test_what_is_not_reproduced_says_why(tables):
    for row in glossmeter_rows(tables):
        assert bool(row["note"]) == any(not cell["reproduced"] for cell in row["cells"])


def test_the_sentence_counts_the_cells(tables):
    cells = tables["glossmeter-table2"]
    said = glossmeter_words(tables)
    for model in ("cook-torrance", "ward"):
        own = cells[cells["model"] == model]
        assert f"{own['reproduced'].sum()} of {len(own)} cells of the {model} rows" in said
    assert re.search(r"follow from its printed cells to 0\.00\d\.", said)


def test_pictures_are_exported_and_say_what_they_show():
    for picture in glossmeter_pictures().values():
        assert {name.rpartition(".")[2] for name in picture.exported} == {"svg", "pdf"}
        assert picture.caption
        assert "imulated" not in picture.caption  # no observer took part, simulated or not
