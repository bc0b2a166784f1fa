"""The folder beside the report: figures, tables and text, replaced by each run, and nobody else's files touched."""

import hashlib
from collections.abc import Callable, Mapping
from pathlib import Path

from glossspace.errors import GlossError
from glossspace.files import check_file_target, check_folder_target, read_json, sha256_of, write_bytes, write_json

__all__ = ["CONTENTS", "check_report_target", "report_folder", "write_folder"]

CONTENTS = "contents.json"
"""Lists the files that the last run wrote, so that the next one knows which are its own."""

_FORMAT = "glossspace/report-folder"


def report_folder(page: Path) -> Path:
    """Folder of a report's files: `report` beside `report.html`.

    Examples
    --------
    >>> report_folder(Path("study/report.html")).as_posix(), report_folder(Path("page")).as_posix()
    ('study/report', 'page-files')
    """
    return page.with_suffix("") if page.suffix else page.with_name(f"{page.name}-files")


def check_report_target(page: Path) -> None:
    """Refuse a place where report or folder cannot be written, before long work rather than after it.

    Raises
    ------
    GlossError
    """
    check_file_target(page)
    check_folder_target(report_folder(page))


def write_folder(
    folder: Path, files: Mapping[str, bytes], *, on_step: Callable[[int, int], None] = lambda done, total: None
) -> list[str]:
    """Write files into a folder, each whole or not at all, and remove those of an older run that are no longer made.

    Parameters
    ----------
    folder : Path
    files : mapping of str to bytes
        By their paths within the folder, with slashes.
    on_step : callable
        Called with the number of files written and of all.

    Returns
    -------
    list of str
        What somebody else had written under our names, or changed in our files, and where it is kept: as "NAME.kept"
        with a number, and the ending behind it.

    Raises
    ------
    GlossError
        The operating system refuses.
    """
    known = _known(folder)
    hashes = {name: hashlib.sha256(content).hexdigest() for name, content in files.items()}
    kept = []
    for name in sorted({*files, *known}):
        path = folder / name
        if not path.is_file() or sha256_of(path) in {hashes.get(name), *known.get(name, ())}:
            continue
        kept.append(f"{name} is kept as {_move_aside(path)}")
    # Both runs' files are ours until the new ones are whole: an interrupted run leaves nothing that looks foreign.
    both = {name: sorted({*known.get(name, ()), *_one(hashes.get(name))}) for name in sorted({*known, *files})}
    _write_contents(folder, both)
    for done, (name, content) in enumerate(files.items(), start=1):
        write_bytes(folder / name, content)
        on_step(done, len(files))
    for name in known.keys() - files.keys():
        (folder / name).unlink(missing_ok=True)
    _write_contents(folder, {name: [digest] for name, digest in sorted(hashes.items())})
    return kept


def _known(folder: Path) -> dict[str, list[str]]:
    """Files of an older run with the hashes that they may have; empty where there was none, or its list is broken."""
    if not (folder / CONTENTS).is_file():
        return {}
    try:
        document = read_json(folder / CONTENTS, what="list of the report's files")
    except GlossError:
        return {}
    files = document.get("files")
    if document.get("format") != _FORMAT or not isinstance(files, dict):
        return {}
    # A list that was tampered with must not make this remove files elsewhere.
    inside = {name for name in files if (folder / name).resolve().is_relative_to(folder.resolve())}
    return {name: digests for name, digests in files.items() if name in inside and isinstance(digests, list)}


def _write_contents(folder: Path, files: dict[str, list[str]]) -> None:
    write_json(folder / CONTENTS, {"format": _FORMAT, "version": 1, "files": files})


def _move_aside(path: Path) -> str:
    number = 1
    while (target := path.with_name(f"{path.stem}.kept{number}{path.suffix}")).exists():
        number += 1
    path.rename(target)
    return target.name


def _one(digest: str | None) -> tuple[str, ...]:
    return () if digest is None else (digest,)
