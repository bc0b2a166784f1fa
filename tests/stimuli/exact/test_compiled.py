"""How kernels are run and kept: with kernels in plain Python, and a small package of its own for the cache."""

import importlib
import shutil
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gloss_stimuli.exact import compiled as compiled_module
from gloss_stimuli.exact.compiled import for_rows, thread_count


@given(rows=st.integers(0, 300), threads=st.integers(1, 9))
@settings(max_examples=60, deadline=None)  # threads start
def test_every_row_is_computed_once(rows: int, threads: int) -> None:
    counts, chunks, lock = np.zeros(rows, int), [], threading.Lock()

    def kernel(start: int, stop: int, step: int, out: np.ndarray) -> None:
        assert 0 <= start < stop <= rows
        with lock:
            out[start:stop] += step
            chunks.append((start, stop))

    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("NUMBA_NUM_THREADS", str(threads))
        for_rows(kernel, rows, 3, counts)
    assert (counts == 3).all()
    # enough chunks for every thread, where there are rows enough, and not many more
    assert len(chunks) <= 8 * threads
    if rows >= 8 * threads:
        assert len(chunks) > 4 * threads


@pytest.mark.parametrize("threads", ["1", "3"])
def test_what_a_chunk_raises_is_raised(monkeypatch: pytest.MonkeyPatch, threads: str) -> None:
    monkeypatch.setenv("NUMBA_NUM_THREADS", threads)
    ran = []

    def kernel(start: int, stop: int) -> None:
        ran.append(start)
        if start <= 50 < stop:
            raise FloatingPointError("row 50 is not finite")

    with pytest.raises(FloatingPointError, match="row 50 is not finite"):
        for_rows(kernel, 100)
    assert len(ran) == len(set(ran))


def test_the_chunks_left_are_dropped_after_a_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_NUM_THREADS", "2")
    ran, second = [], threading.Event()

    def kernel(start: int, stop: int) -> None:
        ran.append(start)
        if start == 0:
            raise ValueError("first")
        second.wait(0.05)  # so that most chunks are still to come

    with pytest.raises(ValueError, match="first"):
        for_rows(kernel, 1600)
    assert len(ran) < 16


def test_threads_work_at_the_same_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_NUM_THREADS", "3")
    together = threading.Barrier(3, timeout=30)

    def kernel(start: int, stop: int) -> None:
        if start < 3:  # chunks of one row: the first three must meet
            together.wait()

    for_rows(kernel, 24)
    assert not together.broken


@pytest.mark.parametrize(
    ("wanted", "count"), [("3", 3), ("1", 1), ("", None), ("0", None), ("-2", None), ("all", None), (None, None)]
)
def test_number_of_threads(monkeypatch: pytest.MonkeyPatch, wanted: str | None, count: int | None) -> None:
    monkeypatch.delenv("NUMBA_NUM_THREADS", raising=False)
    monkeypatch.setattr("os.sched_getaffinity", lambda _: {0, 1, 2, 5, 7}, raising=False)
    if wanted is not None:
        monkeypatch.setenv("NUMBA_NUM_THREADS", wanted)
    assert thread_count() == (count or 5)


# --- the cache of kernels ------------------------------------------------------------------------------------------

INNER = """
from {name}.compiled import compiled

@compiled
def factor(x: float) -> float:
    return x * {value}
"""
OUTER = """
from {name}.compiled import compiled
from {name}.inner import factor

@compiled
def doubled(x: float) -> float:
    return 2 * factor(x)
"""


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[float | None], float]]:
    """Import afresh a package of two kernels, one of which calls the other, with another factor if one is given."""
    name = f"kernels_of_{tmp_path.name}".replace("-", "_")
    folder = tmp_path / name
    folder.mkdir()
    (folder / "__init__.py").touch()
    shutil.copy(compiled_module.__file__, folder / "compiled.py")
    (folder / "outer.py").write_text(OUTER.format(name=name), encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)

    def run(factor: float | None = None) -> float:
        if factor is not None:
            (folder / "inner.py").write_text(INNER.format(name=name, value=factor), encoding="utf-8")
        for loaded in [module for module in sys.modules if module.split(".")[0] == name]:
            del sys.modules[loaded]
        importlib.invalidate_caches()
        return float(importlib.import_module(f"{name}.outer").doubled(1.0))

    run.folder = folder
    yield run
    for loaded in [module for module in sys.modules if module.split(".")[0] == name]:
        del sys.modules[loaded]


def kernels(folder: Path) -> dict[str, int]:
    return {path.name: path.stat().st_mtime_ns for path in folder.glob("*.nb[ic]")}


def test_a_changed_source_drops_the_kernels_that_call_it(package: Callable) -> None:
    cache = package.folder / "__pycache__"
    assert package(3.0) == 6.0
    kept = kernels(cache)
    assert any(name.startswith("outer.doubled") for name in kept)
    assert package() == 6.0
    assert kernels(cache) == kept  # nothing has changed, so nothing is compiled again
    assert package(5.0) == 10.0
    assert package() == 10.0


def test_numba_alone_would_keep_them(package: Callable) -> None:
    # If this fails numba follows calls by itself, and the cache needs no help.
    cache = package.folder / "__pycache__"
    assert package(3.0) == 6.0
    stale = {path: path.read_bytes() for path in cache.glob("outer.doubled*")}
    assert package(5.0) == 10.0
    for path in cache.glob("outer.doubled*"):
        path.unlink()
    for path, content in stale.items():
        path.write_bytes(content)
    assert package() == 6.0


def test_kernels_kept_elsewhere_are_dropped_too(
    package: Callable, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    elsewhere = tmp_path / "elsewhere"
    other = elsewhere / "others_0123"
    other.mkdir(parents=True)
    (other / "kernel.nbi").touch()
    monkeypatch.setattr("numba.core.config.CACHE_DIR", str(elsewhere))
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(elsewhere))
    assert package(3.0) == 6.0
    assert not kernels(package.folder / "__pycache__")
    assert package(5.0) == 10.0
    assert package(7.0) == 14.0
    assert (other / "kernel.nbi").is_file()


def test_a_folder_that_cannot_be_written_to_does_not_matter(
    package: Callable, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (package.folder / "__pycache__").write_text("a file, so no folder can be made here", encoding="utf-8")
    monkeypatch.setattr("numba.core.config.CACHE_DIR", str(tmp_path / "elsewhere"))
    assert package(3.0) == 6.0
