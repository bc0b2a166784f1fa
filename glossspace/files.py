"""Files that are whole or absent: written under a temporary name, flushed to the disk, then renamed."""

import hashlib
import json
import os
import tempfile
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from glossspace.errors import GlossError

__all__ = [
    "check_file_target",
    "check_folder_target",
    "check_replaceable",
    "read_json",
    "read_toml",
    "sha256_of",
    "shipped_folder",
    "whole_file",
    "write_bytes",
    "write_json",
    "write_text",
]


def check_file_target(path: str | Path) -> None:
    """Refuse a path that no file can be written to, before long work rather than after it.

    Raises
    ------
    GlossError
        A folder or a device has that name, or a folder on the way to it is a file or cannot be written to.
    """
    path = Path(path)
    with _refusals_to_write(path):
        if path.is_dir():
            raise GlossError(f"Cannot write '{path}': it is a folder. Give the name of a file.")
        # Renaming a finished file onto /dev/stdout or /dev/null would replace the device itself.
        if path.exists() and not path.is_file():
            raise GlossError(f"Cannot write '{path}': it is no ordinary file. Give the name of a file.")
        check_folder_target(path.parent)


def check_replaceable(path: str | Path, read: Callable[[Path], object], *, what: str) -> None:
    """Check a command's ``--out`` as `check_file_target`, and refuse another's file there: it may hold somebody's data.

    Parameters
    ----------
    path : path
        What is to be written. An empty file may be replaced by anything.
    read : callable
        Reads a file of the command's own kind, and raises `GlossError` for any other.
    what : str
        Name of that kind.

    Raises
    ------
    GlossError
        A file of another kind is there, or see `check_file_target`.
    """
    path = Path(path)
    check_file_target(path)
    if path.exists() and path.stat().st_size > 0:
        try:
            read(path)
        except GlossError:
            raise GlossError(f"'{path}' is there and is no {what}. Choose another name for --out.") from None


def check_folder_target(path: str | Path) -> None:
    """Refuse a folder that cannot be made or written to, before long work rather than after it.

    Raises
    ------
    GlossError
        It, or the nearest folder above it that exists, is a file or cannot be written to.
    """
    path = Path(path)
    with _refusals_to_write(path):
        there = next(folder for folder in (path, *path.absolute().parents) if folder.exists())
        if not there.is_dir():
            raise GlossError(f"Cannot write '{path}': '{there}' is a file, where a folder is needed.")
        if not os.access(there, os.W_OK | os.X_OK):
            raise GlossError(f"Cannot write '{path}': no permission in '{there}'. Choose another place.")


@contextmanager
def _refusals_to_write(path: str | Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise GlossError(f"Cannot write '{path}': {error.strerror or error}. Choose another place.") from error


@contextmanager
def whole_file(path: str | Path) -> Iterator[Path]:
    """Give a temporary path beside `path`; on success flush it and rename it to `path`, on any failure remove it.

    For writers that want a file name (image and plot libraries). `write_bytes` serves the others.

    Raises
    ------
    GlossError
        The operating system refuses: no permission, no space; or the path is that of a folder or a device.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> folder = pathlib.Path(tempfile.mkdtemp())
    >>> with whole_file(folder / "a.txt") as temporary:
    ...     _ = temporary.write_text("whole")
    >>> (folder / "a.txt").read_text()
    'whole'
    """
    check_file_target(path)
    temporary = None
    try:
        with _refusals_to_write(path):
            # A link stays a link: what it points at is replaced.
            target = Path(path).resolve()
            target.parent.mkdir(parents=True, exist_ok=True)
            # The suffix is kept, since image writers choose the format by it.
            descriptor, name = tempfile.mkstemp(
                dir=target.parent, prefix=f".{target.stem}-", suffix=f".part{target.suffix}"
            )
            os.close(descriptor)
            temporary = Path(name)
            yield temporary
            with temporary.open("rb+") as stream:
                os.fsync(stream.fileno())
            temporary.chmod(0o644)  # mkstemp makes files that only their owner reads
            temporary.replace(target)
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


def write_bytes(path: str | Path, content: bytes) -> None:
    """Write `content` to `path`, whole or not at all."""
    with whole_file(path) as temporary:
        temporary.write_bytes(content)


def write_text(path: str | Path, content: str) -> None:
    """Write `content` as UTF-8 without a byte order mark and with ``\\n`` line ends, whole or not at all."""
    write_bytes(path, content.encode("utf-8"))


def write_json(path: str | Path, document: Any) -> None:
    """Write strict, indented JSON: NaN and infinity are refused, since other languages cannot read them.

    NumPy's numbers and arrays are written as numbers and lists.
    """
    text = json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False, default=_plain)
    write_text(path, text + "\n")


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} cannot be written as JSON: {value!r}")


def read_json(path: str | Path, *, what: str) -> dict[str, Any]:
    """Read a JSON object; `what` names the kind of file in the error message.

    Raises
    ------
    GlossError
        The file is missing, unreadable, not strict JSON or not an object.
    """
    path = Path(path)
    try:
        # Some editors begin a file with a byte order mark, which "utf-8-sig" skips.
        document = json.loads(path.read_text(encoding="utf-8-sig"), parse_constant=_refuse_constant)
    except FileNotFoundError:
        raise GlossError(f"No {what} at '{path}'. Check the path.") from None
    except (OSError, UnicodeDecodeError) as error:
        raise GlossError(f"Cannot read the {what} '{path}': {error}.") from None
    except json.JSONDecodeError as error:
        raise GlossError(f"The {what} '{path}' is not valid JSON (line {error.lineno}: {error.msg}).") from None
    except (ValueError, RecursionError) as error:
        raise GlossError(f"The {what} '{path}' is not valid JSON: {error}.") from None
    if not isinstance(document, dict):
        raise GlossError(f"The {what} '{path}' must hold a JSON object, but holds a {type(document).__name__}.")
    return document


def read_toml(path: str | Path, *, what: str) -> dict[str, Any]:
    """Read a TOML table; `what` names the kind of file in the error message.

    Raises
    ------
    GlossError
        The file is missing, unreadable or not TOML.
    """
    path = Path(path)
    try:
        # Some editors begin a file with a byte order mark, which "utf-8-sig" skips.
        return tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except FileNotFoundError:
        raise GlossError(f"No {what} at '{path}'. Check the path.") from None
    except OSError as error:
        raise GlossError(f"Cannot read the {what} '{path}': {error.strerror or error}.") from None
    except UnicodeDecodeError:
        raise GlossError(f"The {what} '{path}' is not in UTF-8. Save it in that encoding.") from None
    except (ValueError, RecursionError) as error:
        hint = " A number needs a digit before its point: 0.1, not .1." if "Invalid value" in str(error) else ""
        raise GlossError(f"The {what} '{path}' is not valid TOML: {error}.{hint}") from None


def _refuse_constant(name: str) -> None:
    raise ValueError(f"{name} is not a number in JSON")


def sha256_of(path: str | Path) -> str:
    """SHA-256 of a file's content as 64 hexadecimal digits."""
    with Path(path).open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def shipped_folder(package_file: str, name: str) -> Path:
    """Folder `name` that ships with a package: inside it in a wheel, beside it in a checkout."""
    package = Path(package_file).parent
    inside = package / name
    return inside if inside.is_dir() else package.parent / name
