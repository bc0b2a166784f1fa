"""How the exact renderer's kernels are compiled and run: on threads that each own their rows."""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from glossspace.compiled import compiler

__all__ = ["compiled", "for_rows"]

# Chunks a thread: enough that one slow chunk does not leave the others idle.
CHUNKS_A_THREAD = 8

compiled: Callable[[Any], Any] = compiler(Path(__file__).parent)
"""Decorator of a kernel. Kernels of rows take ``(start, stop, …)`` first and write to those rows of their outputs."""


def for_rows(kernel: Callable[..., None], rows: int, *arguments: Any) -> None:
    """Call ``kernel(start, stop, *arguments)`` on chunks that cover ``range(rows)``, on all processors.

    Each row is computed by one thread and in one order, so the result does not depend on the number of threads.
    """
    threads = thread_count()
    size = max(1, -(-rows // (CHUNKS_A_THREAD * threads)))
    chunks = [(start, min(start + size, rows)) for start in range(0, rows, size)]
    if threads == 1:
        for start, stop in chunks:
            kernel(start, stop, *arguments)
        return
    pool = ThreadPoolExecutor(threads)
    try:
        list(pool.map(lambda chunk: kernel(*chunk, *arguments), chunks))
    finally:
        # Interrupted, it waits for the chunks that have begun and drops the others.
        pool.shutdown(cancel_futures=True)


def thread_count() -> int:
    """Threads to use: NUMBA_NUM_THREADS if it is set, else one for each processor this process may run on."""
    wanted = os.environ.get("NUMBA_NUM_THREADS", "")
    if wanted.isdigit() and int(wanted) > 0:
        return int(wanted)
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
