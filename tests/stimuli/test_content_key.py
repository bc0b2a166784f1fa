from pathlib import Path

import pytest

from gloss_stimuli import content_key as module
from gloss_stimuli.content_key import content_key


@pytest.fixture
def room(tmp_path: Path, monkeypatch):
    """A room of its own, with two modules and a sub-package of two."""
    for name in ("one.py", "two.py", "package/__init__.py", "package/part.py"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(f"# {name}\n")
    monkeypatch.setattr(module, "__file__", str(tmp_path / "content_key.py"))
    # A process reads each source once, as it runs it.
    module._source_hash.cache_clear()
    yield tmp_path
    module._source_hash.cache_clear()


def change(path: Path) -> None:
    path.write_text(path.read_text() + "\n")
    module._source_hash.cache_clear()


def test_it_is_a_sha256() -> None:
    key = content_key(x=1)
    assert len(key) == 64
    assert int(key, 16) >= 0


def test_the_same_content_has_the_same_key_in_whatever_order() -> None:
    assert content_key(a=1, b={"c": [1.5, None], "d": "x"}) == content_key(b={"d": "x", "c": [1.5, None]}, a=1)


def test_every_value_and_every_name_counts() -> None:
    contents = [{"a": 1}, {"a": 2}, {"b": 1}, {"a": 1, "b": 1}, {"a": [1]}, {"a": "1"}, {"a": None}, {"a": 0.1}, {}]
    assert len({content_key(**content) for content in contents}) == len(contents)


def test_neighbouring_floats_differ() -> None:
    assert content_key(alpha=0.1) != content_key(alpha=0.1 + 2**-56)


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_what_json_cannot_hold_has_no_key(value: float) -> None:
    with pytest.raises(ValueError, match="not JSON compliant"):
        content_key(value=value)


def test_it_changes_with_the_code_that_makes_the_result(room: Path) -> None:
    before = content_key("one", x=1)
    change(room / "two.py")
    assert content_key("one", x=1) == before
    change(room / "one.py")
    assert content_key("one", x=1) != before


@pytest.mark.parametrize("part", ["__init__.py", "part.py"])
def test_a_sub_package_is_all_of_its_modules(room: Path, part: str) -> None:
    before = content_key("package")
    change(room / "package" / part)
    assert content_key("package") != before


def test_which_sources_counts(room: Path) -> None:
    assert len({content_key(), content_key("one"), content_key("two"), content_key("one", "two")}) == 4


def test_a_source_that_does_not_exist_is_no_silent_constant(room: Path) -> None:
    with pytest.raises(FileNotFoundError, match="three.py"):
        content_key("three")


def test_code_of_the_core_counts_too(tmp_path, monkeypatch) -> None:
    (tmp_path / "corepart").mkdir()
    for name in ("__init__.py", "display.py"):
        (tmp_path / "corepart" / name).write_text("# one\n")
    monkeypatch.syspath_prepend(tmp_path)
    module._source_hash.cache_clear()
    before = content_key("corepart.display")
    change(tmp_path / "corepart" / "display.py")
    assert content_key("corepart.display") != before
    module._source_hash.cache_clear()
