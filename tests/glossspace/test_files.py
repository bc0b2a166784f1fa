"""Files that are whole or absent."""

import hashlib
import json
import os
from functools import partial

import numpy as np
import pytest

from glossspace.errors import GlossError
from glossspace.files import (
    check_file_target,
    check_folder_target,
    check_replaceable,
    read_json,
    sha256_of,
    shipped_folder,
    whole_file,
    write_bytes,
    write_json,
    write_text,
)


def names(folder):
    return sorted(file.name for file in folder.iterdir())


class TestWholeFile:
    def test_appears_under_its_name_with_its_content(self, tmp_path):
        with whole_file(tmp_path / "a.png") as temporary:
            assert temporary.parent == tmp_path  # so that the rename stays on one file system
            assert temporary.suffix == ".png"
            temporary.write_bytes(b"image")
            assert not (tmp_path / "a.png").exists()
        assert names(tmp_path) == ["a.png"]
        assert (tmp_path / "a.png").read_bytes() == b"image"

    @pytest.mark.parametrize("failure", [RuntimeError("broken"), KeyboardInterrupt(), SystemExit(1)], ids=repr)
    def test_failure_leaves_nothing(self, tmp_path, failure):
        with pytest.raises(type(failure)), whole_file(tmp_path / "a.txt") as temporary:  # noqa: PT012
            temporary.write_text("half")
            raise failure
        assert names(tmp_path) == []

    def test_failure_leaves_the_old_file_as_it_was(self, tmp_path):
        write_text(tmp_path / "a.txt", "old")
        with pytest.raises(RuntimeError, match="broken"), whole_file(tmp_path / "a.txt") as temporary:  # noqa: PT012
            temporary.write_text("half")
            raise RuntimeError("broken")
        assert (tmp_path / "a.txt").read_text() == "old"
        assert names(tmp_path) == ["a.txt"]

    def test_success_replaces_the_old_file(self, tmp_path):
        write_text(tmp_path / "a.txt", "old")
        write_text(tmp_path / "a.txt", "new")
        assert (tmp_path / "a.txt").read_text() == "new"

    def test_content_is_on_the_disk_before_the_name(self, tmp_path, monkeypatch):
        named_at_flush = []
        monkeypatch.setattr(os, "fsync", lambda _: named_at_flush.append((tmp_path / "a.txt").exists()))
        write_text(tmp_path / "a.txt", "x")
        assert named_at_flush == [False]

    def test_missing_folders_are_made(self, tmp_path):
        write_text(tmp_path / "b" / "c" / "a.txt", "x")
        assert (tmp_path / "b" / "c" / "a.txt").read_text() == "x"

    def test_others_may_read_it(self, tmp_path):
        write_text(tmp_path / "a.txt", "x")
        if os.name == "posix":
            assert (tmp_path / "a.txt").stat().st_mode & 0o777 == 0o644

    def test_full_disk_is_one_line_and_leaves_nothing(self, tmp_path):
        with (  # noqa: PT012
            pytest.raises(
                GlossError, match=r"^Cannot write '.*a\.txt': No space left on device\. Choose another place"
            ),
            whole_file(tmp_path / "a.txt") as temporary,
        ):
            temporary.write_text("half")
            raise OSError(28, "No space left on device")
        assert names(tmp_path) == []

    def test_a_file_where_a_folder_should_be(self, tmp_path):
        write_text(tmp_path / "a", "x")
        with pytest.raises(GlossError, match=r"^Cannot write '.*': '.*a' is a file, where a folder is needed"):
            write_text(tmp_path / "a" / "b.txt", "x")

    def test_a_folder_of_that_name(self, tmp_path):
        (tmp_path / "a").mkdir()
        with pytest.raises(GlossError, match=r"^Cannot write '.*a': "):
            write_text(tmp_path / "a", "x")
        assert names(tmp_path) == ["a"]

    @pytest.mark.skipif(os.name != "posix", reason="named pipes are of POSIX")
    def test_what_is_no_ordinary_file_is_never_replaced(self, tmp_path):
        os.mkfifo(tmp_path / "device")
        with pytest.raises(GlossError, match=r"^Cannot write '.*device': it is no ordinary file"):
            write_text(tmp_path / "device", "x")
        assert not (tmp_path / "device").is_file()
        assert names(tmp_path) == ["device"]

    @pytest.mark.skipif(os.name != "posix", reason="elsewhere links need rights")
    def test_a_link_stays_a_link(self, tmp_path):
        (tmp_path / "link").symlink_to(tmp_path / "target")
        write_text(tmp_path / "link", "x")
        assert (tmp_path / "link").is_symlink()
        assert (tmp_path / "target").read_text() == "x"

    def test_a_name_that_no_system_takes(self, tmp_path):
        with pytest.raises(GlossError, match=r"^Cannot write '.*': "):
            write_text(tmp_path / ("a" * 300), "x")
        with pytest.raises(GlossError, match=r"^Cannot write '.*': "):
            write_text(tmp_path / ("a" * 300) / "b", "x")
        assert names(tmp_path) == []


class TestTargets:
    def test_what_can_be_written_passes_and_makes_nothing(self, tmp_path):
        check_file_target(tmp_path / "new" / "a.txt")
        check_folder_target(tmp_path / "new" / "folder")
        assert names(tmp_path) == []

    def test_only_files_of_the_same_kind_and_empty_ones_may_be_replaced(self, tmp_path):
        def check(name):
            check_replaceable(tmp_path / name, partial(read_json, what="space"), what="space")

        write_json(tmp_path / "ours", {"a": 1})
        write_text(tmp_path / "data", "participant_id,rating\n")
        write_text(tmp_path / "empty", "")
        for name in ("ours", "empty", "absent"):
            check(name)
        with pytest.raises(GlossError, match=r"data' is there and is no space\. Choose another name for --out\.$"):
            check("data")
        with pytest.raises(GlossError, match="it is a folder"):
            check(".")

    def test_files_on_the_way(self, tmp_path):
        (tmp_path / "a").touch()
        with pytest.raises(GlossError, match=r"'.*a' is a file, where a folder is needed"):
            check_file_target(tmp_path / "a" / "b.txt")
        with pytest.raises(GlossError, match=r"'.*a' is a file, where a folder is needed"):
            check_folder_target(tmp_path / "a")

    def test_folders_without_permission(self, tmp_path, monkeypatch):
        monkeypatch.setattr(os, "access", lambda path, mode: False)  # root may write anywhere
        with pytest.raises(GlossError, match=r"no permission in '.*'\. Choose another place"):
            check_folder_target(tmp_path / "new")


def test_text_is_plain_utf8(tmp_path):
    write_text(tmp_path / "a.txt", "ρ\nα\n")
    assert (tmp_path / "a.txt").read_bytes() == "ρ\nα\n".encode()


class TestJson:
    def test_round_trip(self, tmp_path):
        document = {"name": "Ďurikovič", "values": [1, 2.5, None, True], "nested": {"a": "b"}}
        write_json(tmp_path / "a.json", document)
        assert read_json(tmp_path / "a.json", what="thing") == document
        assert (tmp_path / "a.json").read_text(encoding="utf-8").endswith("}\n")

    def test_floats_come_back_to_the_last_bit(self, tmp_path):
        values = [0.1, 1 / 3, 5e-324, 1.7976931348623157e308]
        write_json(tmp_path / "a.json", {"values": values})
        assert read_json(tmp_path / "a.json", what="thing")["values"] == values

    def test_numpy_numbers_are_numbers(self, tmp_path):
        write_json(tmp_path / "a.json", {"i": np.int64(3), "f": np.float32(0.5), "b": np.True_, "a": np.eye(2)})
        assert json.loads((tmp_path / "a.json").read_text()) == {"i": 3, "f": 0.5, "b": True, "a": [[1, 0], [0, 1]]}

    @pytest.mark.parametrize("value", [float("nan"), np.float64("inf"), np.array([np.nan])], ids=repr)
    def test_nan_is_refused_and_nothing_written(self, tmp_path, value):
        with pytest.raises(ValueError, match="not JSON compliant"):
            write_json(tmp_path / "a.json", {"x": value})
        assert names(tmp_path) == []

    def test_what_json_lacks_is_refused(self, tmp_path):
        with pytest.raises(TypeError, match=r"^set cannot be written as JSON: "):
            write_json(tmp_path / "a.json", {"x": {1}})

    @pytest.mark.parametrize(
        ("content", "message"),
        [
            (b"", r"is not valid JSON \(line 1: Expecting value\)\.$"),
            (b'{\n"a": 1,\n', r"is not valid JSON \(line [23]: "),
            (b"[1]", r"must hold a JSON object, but holds a list\.$"),
            (b'{"a": NaN}', r"is not valid JSON: NaN is not a number in JSON\.$"),
            (b'{"a": -Infinity}', r"is not valid JSON: -Infinity is not a number in JSON\.$"),
            (b"\xff\xfe{", r"^Cannot read the thing '.*a\.json': .*can't decode"),
            (b"[" * 200_000, r"is not valid JSON: maximum recursion depth"),
            (b'{"a": ' + b"9" * 5000 + b"}", r"is not valid JSON: Exceeds the limit"),
        ],
        ids=lambda value: repr(value)[:20],
    )
    def test_damaged_files_are_refused_in_one_line(self, tmp_path, content, message):
        (tmp_path / "a.json").write_bytes(content)
        with pytest.raises(GlossError, match=message) as caught:
            read_json(tmp_path / "a.json", what="thing")
        assert "a.json'" in str(caught.value)
        assert "\n" not in str(caught.value)

    def test_missing_file_and_folder_are_refused(self, tmp_path):
        with pytest.raises(GlossError, match=r"^No thing at '.*none\.json'\. Check the path\.$"):
            read_json(tmp_path / "none.json", what="thing")
        with pytest.raises(GlossError, match=r"^Cannot read the thing '"):
            read_json(tmp_path, what="thing")


def test_sha256(tmp_path):
    write_bytes(tmp_path / "a", b"abc")
    # FIPS 180-2, appendix B.1
    assert sha256_of(tmp_path / "a") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    assert sha256_of(tmp_path / "a") == hashlib.sha256(b"abc").hexdigest()


def test_shipped_folder_is_inside_a_wheel_and_beside_a_checkout(tmp_path):
    package = tmp_path / "package"
    (tmp_path / "data").mkdir()
    package.mkdir()
    assert shipped_folder(str(package / "__init__.py"), "data") == tmp_path / "data"
    (package / "data").mkdir()
    assert shipped_folder(str(package / "__init__.py"), "data") == package / "data"
