"""How the exact renderer's kernels are compiled and run: numba, cached on disk, on threads that each own their rows."""

import hashlib
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numba

__all__ = ["compiled", "for_rows"]

# Chunks a thread: enough that one slow chunk does not leave the others idle.
CHUNKS_A_THREAD = 8

# NaN and infinity keep their meaning, so that a fault is found where it arises; sums may be regrouped for SIMD.
_REGROUPED = {"reassoc", "contract", "arcp", "nsz", "afn"}

compiled: Callable[[Any], Any] = numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_REGROUPED)
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


def _forget_stale_kernels() -> None:
    """Delete cached kernels if any source here has changed: numba looks at a kernel's own file alone."""
    here = Path(__file__).parent
    digest = hashlib.sha256()
    for source in sorted(here.glob("*.py")):
        digest.update(source.read_bytes())
    # Numba keeps kernels beside their sources, or under NUMBA_CACHE_DIR in a folder that bears the package's name.
    folders = [here / "__pycache__"]
    elsewhere = os.environ.get("NUMBA_CACHE_DIR")
    if elsewhere:
        folders = list(Path(elsewhere).glob(f"{here.name}_*"))
    for folder in folders:
        stamp = folder / "kernels.sha256"
        try:
            if stamp.is_file() and stamp.read_text() == digest.hexdigest():
                continue
            for cached in (*folder.glob("*.nbi"), *folder.glob("*.nbc")):
                cached.unlink(missing_ok=True)
            folder.mkdir(exist_ok=True)
            stamp.write_text(digest.hexdigest())
        except OSError:
            pass  # not ours to change: whoever installs there brings new sources and new kernels together


_forget_stale_kernels()
