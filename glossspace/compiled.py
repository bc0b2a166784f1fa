"""How kernels are compiled: numba, cached on disk, without the lock of the interpreter.

Only rooms that have kernels import this module; the core itself needs no numba.
"""

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba

__all__ = ["compiler"]

# NaN and infinity keep their meaning, so that a fault is found where it arises; sums may be regrouped for SIMD.
_REGROUPED = {"reassoc", "contract", "arcp", "nsz", "afn"}


def compiler(folder: Path) -> Callable[[Any], Any]:
    """Give the decorator of the kernels in one folder of sources, having dropped what is no longer theirs on disk.

    Parameters
    ----------
    folder : Path
        Where the sources are. Numba looks at the file of a kernel alone, but a kernel also holds those that it calls:
        after a change of any source in the folder all its cached kernels are deleted.

    Returns
    -------
    callable
        Compiles a function at its first call and keeps the result on disk.

    Examples
    --------
    >>> from pathlib import Path
    >>> compiled = compiler(Path("."))
    """
    _forget_stale_kernels(folder)
    decorator: Callable[[Any], Any] = numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_REGROUPED)
    return decorator


def _forget_stale_kernels(folder: Path) -> None:
    digest = hashlib.sha256()
    for source in sorted(folder.glob("*.py")):
        digest.update(source.read_bytes())
    # Numba keeps kernels beside their sources, or under NUMBA_CACHE_DIR in a folder that bears the package's name.
    elsewhere = os.environ.get("NUMBA_CACHE_DIR")
    if elsewhere:
        places = list(Path(elsewhere).glob(f"{folder.name}_*"))
        stamp = Path(elsewhere) / f"{folder.name}-{hashlib.sha256(str(folder).encode()).hexdigest()[:16]}.sha256"
    else:
        places = [folder / "__pycache__"]
        stamp = places[0] / "kernels.sha256"
    try:
        if stamp.is_file() and stamp.read_text() == digest.hexdigest():
            return
        for place in places:
            for cached in (*place.glob("*.nbi"), *place.glob("*.nbc")):
                cached.unlink(missing_ok=True)
        stamp.parent.mkdir(parents=True, exist_ok=True)
        stamp.write_text(digest.hexdigest())
    except OSError:
        pass  # not ours to change: whoever installs there brings new sources and new kernels together
