"""How kernels are run on threads, with kernels in plain Python."""

import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

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
