import os
from pathlib import Path

import pytest

from gloss_stimuli.cache import CACHE_VARIABLE, cache_folder, trim_cache
from glossspace.errors import GlossError


def fill(folder: Path, ages: dict[str, int], size: int = 100) -> None:
    """Files of `size` bytes, each so many seconds old."""
    folder.mkdir(exist_ok=True)
    for name, age in ages.items():
        (folder / name).write_bytes(bytes(size))
        os.utime(folder / name, (10**9 - age, 10**9 - age))


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def test_the_folder_asked_for_comes_before_the_variable(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path / "variable"))
    assert cache_folder(tmp_path / "asked", out=tmp_path / "out") == tmp_path / "asked"
    assert cache_folder(None, out=tmp_path / "out") == tmp_path / "variable"
    assert names(tmp_path) == set()  # it is made by whoever writes there


def test_the_tests_never_use_the_users_own_cache() -> None:
    assert Path(os.environ[CACHE_VARIABLE]).is_dir()


@pytest.mark.parametrize("variable", [None, ""])
def test_without_either_it_is_the_users_own(tmp_path: Path, monkeypatch, variable: str | None) -> None:
    monkeypatch.delenv(CACHE_VARIABLE)
    if variable is not None:
        monkeypatch.setenv(CACHE_VARIABLE, variable)
    # The XDG base directory specification: user-specific cached data is written under $XDG_CACHE_HOME.
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert cache_folder(None, out=tmp_path / "out") == tmp_path / "xdg" / "glossspace"


def test_without_a_home_it_is_inside_the_set(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.delenv(CACHE_VARIABLE)
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    assert cache_folder(None, out=tmp_path / "out") == tmp_path / "out" / ".coefficients"


def test_a_folder_that_cannot_be_is_refused_however_it_was_asked_for(tmp_path: Path, monkeypatch) -> None:
    file = tmp_path / "file"
    file.write_text("no folder")
    with pytest.raises(GlossError, match="is a file, where a folder is needed"):
        cache_folder(file, out=tmp_path)
    monkeypatch.setenv(CACHE_VARIABLE, str(file / "below"))
    with pytest.raises(GlossError, match="is a file, where a folder is needed"):
        cache_folder(None, out=tmp_path)


def test_the_oldest_results_go_first(tmp_path: Path) -> None:
    fill(tmp_path / "cache", {"exact-a.npz": 30, "exact-b.npz": 10, "coefficients-c.npz": 40, "coefficients-d.npz": 20})
    trim_cache(tmp_path / "cache", largest_bytes=250)
    assert names(tmp_path / "cache") == {"exact-b.npz", "coefficients-d.npz"}


def test_what_fits_is_kept(tmp_path: Path) -> None:
    fill(tmp_path / "cache", {"exact-a.npz": 30, "exact-b.npz": 10})
    trim_cache(tmp_path / "cache", largest_bytes=200)
    assert names(tmp_path / "cache") == {"exact-a.npz", "exact-b.npz"}


def test_only_our_own_results_are_deleted(tmp_path: Path) -> None:
    """A user may name any folder, also one that holds years of measurements in NumPy's format."""
    fill(tmp_path / "cache", {"exact-a.npz": 30, "thesis.pdf": 500, "measured.npz": 500})
    trim_cache(tmp_path / "cache", largest_bytes=0)
    assert names(tmp_path / "cache") == {"thesis.pdf", "measured.npz"}


def test_a_folder_that_is_not_there_needs_no_trimming(tmp_path: Path) -> None:
    trim_cache(tmp_path / "nowhere")
    assert names(tmp_path) == set()


def test_a_result_that_another_rendering_has_just_deleted_is_no_trouble(tmp_path: Path, monkeypatch) -> None:
    folder = tmp_path / "cache"
    fill(folder, {"exact-a.npz": 30, "exact-b.npz": 20, "exact-c.npz": 10})
    original = Path.stat

    def stat(path: Path, **options: bool) -> os.stat_result:
        if path.name == "exact-a.npz":
            path.unlink()
        return original(path, **options)

    monkeypatch.setattr(Path, "stat", stat)
    trim_cache(folder, largest_bytes=100)
    monkeypatch.undo()
    assert names(folder) == {"exact-c.npz"}
