"""Tables that users give as CSV: what is read, and what is refused in one line."""

import pytest

from glossspace.errors import GlossError
from glossspace.user_table import read_user_table


@pytest.fixture
def read(tmp_path):
    def run(content):
        path = tmp_path / "table.csv"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return read_user_table(path, what="paint list", columns=["name", "value"])

    return run


@pytest.mark.parametrize(
    "content",
    [
        "name,value\n01,1.50\nNA,\n",
        "name,value\r\n01,1.50\r\nNA,\r\n",
        b"\xef\xbb\xbfname,value\n01,1.50\nNA,\n",
        "\n name , value\n01 ,  1.50\n,\n\nNA, \n\n",
        'name,"value"\n"01","1.50"\nNA,""',
    ],
)
def test_dialects_of_the_same_table(read, content):
    table = read(content)
    assert table.columns.tolist() == ["name", "value"]
    assert table["name"].tolist() == ["01", "NA"]  # text as it stands
    assert table["value"].iloc[0] == "1.50"
    assert table["value"].isna().tolist() == [False, True]


def test_other_columns_are_kept_and_lines_counted(read):
    table = read("remark,value,name\nred,1,a\n\nblue,2,b\n")
    assert table["remark"].tolist() == ["red", "blue"]
    assert table.index.name == "line"
    assert table.index.tolist() == [2, 4]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "is empty. Its first line must name the columns name, value"),
        ("\n\n", "is empty"),
        ("name\na\n", "lacks the column 'value'. Expected name, value; found name"),
        ("name;value\na;1\n", "found name;value. Save it as CSV with commas, in UTF-8"),
        ("name,value,value\na,1,2\n", "has the column 'value' twice"),
        ("name,value,\na,1,2\n", "has a column without a name, the 3. of 3"),
        ("name,value\na,1,2\n", "line 2: 3 cells, but the header names 2 columns"),
        ("name,value\na,1\nb\n", "line 3: 1 cells, but the header names 2 columns"),
        ('name,value\n"a,1\n', "line 2, is no CSV"),
        ("name,value\né,1\n".encode("latin-1"), "is not text in UTF-8. Save it as CSV with commas"),
        ("name,value\na,1\n".encode("utf-16"), "is not text in UTF-8"),
        (bytes(range(256)), "is not text in UTF-8"),
        (b"\0" * 100, "is no text file"),
        ("x" * 1000, "found x{119}…"),
    ],
)
def test_damaged_tables(read, content, message):
    with pytest.raises(GlossError, match=message) as caught:
        read(content)
    assert str(caught.value).startswith("The paint list '")
    assert "\n" not in str(caught.value)


def test_no_file_and_a_folder(tmp_path):
    with pytest.raises(GlossError, match=r"No paint list at '.*nowhere'\. Check the path"):
        read_user_table(tmp_path / "nowhere", what="paint list", columns=["name"])
    with pytest.raises(GlossError, match=r"is a folder\. Give a CSV file|Cannot read the paint list"):
        read_user_table(tmp_path, what="paint list", columns=["name"])
