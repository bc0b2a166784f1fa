"""Where intermediate results live: one folder for all sets of a user, so that sets share what they have in common."""

import contextlib
import os
import time
from pathlib import Path

from glossspace.errors import GlossError
from glossspace.files import check_folder_target

__all__ = ["CACHE_VARIABLE", "cache_folder", "trim_cache"]

CACHE_VARIABLE = "GLOSSSPACE_CACHE"

# About forty sets of 27 stimuli; the files used longest ago go first.
LARGEST_BYTES = 2 * 10**9

# Half-written files older than a day are nobody's.
LEFTOVER_AGE_S = 86_400.0

# What the renderers write; whatever else lies in a folder that a user named is not ours to delete.
RESULTS = ("exact-*.npz", "coefficients-*.npz")


def cache_folder(wanted: str | Path | None, *, out: Path) -> Path:
    """The folder asked for; else that of the variable GLOSSSPACE_CACHE; else the user's own; else one inside `out`.

    Raises
    ------
    GlossError
        The folder asked for cannot be written to.
    """
    asked = wanted or os.environ.get(CACHE_VARIABLE)
    if asked:
        check_folder_target(asked)
        return Path(asked)
    from platformdirs import user_cache_path

    folder = user_cache_path("glossspace", appauthor=False)
    try:
        check_folder_target(folder)
    except GlossError:
        return out / ".coefficients"  # a user without a home, as in a container
    return folder


def trim_cache(folder: Path, *, largest_bytes: int = LARGEST_BYTES) -> None:
    """Delete the results that were used longest ago, until the folder holds no more than `largest_bytes`."""
    for leftover in folder.glob(".*.part.npz"):  # of a process that was killed while it wrote
        with contextlib.suppress(FileNotFoundError):
            if time.time() - leftover.stat().st_mtime > LEFTOVER_AGE_S:
                leftover.unlink()
    files = []
    for path in (path for pattern in RESULTS for path in folder.glob(pattern)):
        try:
            files.append((path.stat().st_mtime, path.stat().st_size, path))
        except FileNotFoundError:  # another rendering has just deleted it
            continue
    total = sum(size for _, size, _ in files)
    for _, size, path in sorted(files):
        if total <= largest_bytes:
            return
        path.unlink(missing_ok=True)
        total -= size
