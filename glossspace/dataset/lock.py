"""A lock that the operating system holds for a process, so that a killed process leaves none behind."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

from glossspace.errors import GlossError

__all__ = ["locked", "try_lock"]

if sys.platform == "win32":
    import msvcrt

    # A Windows lock also hides the bytes it covers from readers: it goes far beyond any content of the file. The C
    # library counts in 32 bits there.
    _FAR_BYTE = 2**31 - 2**16

    def try_lock(stream: IO[Any]) -> bool:
        """Take the lock of an open file, held until it is closed; False where another process holds it."""
        place = stream.tell()
        stream.seek(_FAR_BYTE)
        try:
            msvcrt.locking(stream.fileno(), msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        finally:
            stream.seek(place)
        return True

else:
    import fcntl

    def try_lock(stream: IO[Any]) -> bool:
        """Take the lock of an open file, held until it is closed; False where another process holds it."""
        try:
            fcntl.flock(stream.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return False
        return True


@contextmanager
def locked(path: str | Path, *, timeout_s: float = 30.0) -> Iterator[None]:
    """Hold the lock file `path` (made if absent, never removed), waiting up to `timeout_s` seconds for it.

    Raises
    ------
    GlossError
        Another process still holds it after `timeout_s`, or it cannot be opened.
    """
    path = Path(path)
    deadline = time.monotonic() + timeout_s
    with _opened(path) as stream:
        while not try_lock(stream):
            if time.monotonic() > deadline:
                raise GlossError(
                    f"Another process has held '{path}' for {timeout_s:g} s. Wait for it to end, then retry."
                )
            time.sleep(0.02)
        yield


def _opened(path: Path) -> IO[bytes]:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        return path.open("ab")
    except OSError as error:
        raise GlossError(
            f"Cannot open the lock file '{path}': {error.strerror or error}. Whoever writes to the folder needs the "
            "right to change it and its files; or give another folder."
        ) from None
