"""The folder beside the report: each run replaces its own files, and nobody else's."""

import json

import pytest

from gloss_analysis.report.folder import CONTENTS, check_report_target, report_folder, write_folder
from glossspace.errors import GlossError


def state(folder):
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and path.name != CONTENTS
    }


def test_a_second_run_replaces_its_files_and_removes_those_no_longer_made(tmp_path):
    assert write_folder(tmp_path, {"figures/a.svg": b"1", "figures/b.svg": b"2", "t.csv": b"3"}) == []
    (tmp_path / "figures" / "notes.txt").write_bytes(b"mine")
    assert write_folder(tmp_path, {"figures/a.svg": b"new", "t.csv": b"3"}) == []
    assert state(tmp_path) == {"figures/a.svg": b"new", "t.csv": b"3", "figures/notes.txt": b"mine"}


def test_what_an_author_edited_is_kept_beside_the_new_text(tmp_path):
    write_folder(tmp_path, {"methods.md": b"ours"})
    for number, text in enumerate((b"edited", b"edited again"), start=1):
        (tmp_path / "methods.md").write_bytes(text)
        kept = write_folder(tmp_path, {"methods.md": b"ours"})
        assert kept == [f"methods.md is kept as methods.kept{number}.md"]
    assert state(tmp_path) == {
        "methods.md": b"ours", "methods.kept1.md": b"edited", "methods.kept2.md": b"edited again"
    }  # fmt: skip


def test_a_file_of_somebody_else_under_our_name_is_kept_too(tmp_path):
    (tmp_path / "methods.md").write_bytes(b"theirs")
    assert write_folder(tmp_path, {"methods.md": b"ours"}) == ["methods.md is kept as methods.kept1.md"]
    # And one that is no longer made, but was changed, is not removed.
    (tmp_path / "methods.md").write_bytes(b"edited")
    assert write_folder(tmp_path, {"a.csv": b"1"}) == ["methods.md is kept as methods.kept2.md"]
    assert state(tmp_path)["methods.kept2.md"] == b"edited"


def test_an_interrupted_run_leaves_whole_files_that_the_next_one_knows(tmp_path):
    class Stop(Exception):
        pass

    def stop(done, total):
        if done == 2:
            raise Stop

    write_folder(tmp_path, {"a": b"1", "b": b"1", "c": b"1", "old": b"1"})
    new = {"a": b"2", "b": b"2", "c": b"2"}
    with pytest.raises(Stop):
        write_folder(tmp_path, new, on_step=stop)
    assert state(tmp_path) == {"a": b"2", "b": b"2", "c": b"1", "old": b"1"}
    assert write_folder(tmp_path, new) == []
    assert state(tmp_path) == new


@pytest.mark.parametrize("text", ["not json", '{"format": "other", "files": {"a": []}}', '{"format": 1, "files": 2}'])
def test_a_list_that_is_not_ours_is_believed_in_nothing(tmp_path, text):
    (tmp_path / "a").write_bytes(b"theirs")
    (tmp_path / CONTENTS).write_text(text)
    write_folder(tmp_path, {"b": b"1"})
    assert state(tmp_path) == {"a": b"theirs", "b": b"1"}


def test_a_list_that_was_tampered_with_removes_nothing_elsewhere(tmp_path):
    folder = tmp_path / "report"
    write_folder(folder, {"a": b"1"})
    outside = tmp_path / "outside"
    outside.write_bytes(b"theirs")
    document = json.loads((folder / CONTENTS).read_text())
    document["files"]["../outside"] = []
    (folder / CONTENTS).write_text(json.dumps(document))
    assert write_folder(folder, {"a": b"1"}) == []
    assert outside.read_bytes() == b"theirs"


def test_places_where_nothing_can_be_written(tmp_path):
    (tmp_path / "report").write_text("a file")
    with pytest.raises(GlossError, match="a file, where a folder is needed"):
        check_report_target(tmp_path / "report.html")
    assert report_folder(tmp_path / "page").name == "page-files"
