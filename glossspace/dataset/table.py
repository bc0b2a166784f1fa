"""One data file as it is on the disk: a header and rows of text, each with its line number."""

import csv
import io
from dataclasses import dataclass
from pathlib import Path

from glossspace.dataset.schema import COLUMNS, TaskKind
from glossspace.errors import GlossError

__all__ = ["DataFile", "data_files", "parse_data_file", "read_data_file", "task_kind"]


@dataclass(frozen=True)
class DataFile:
    """Text of a data file: `rows` has one ``(line number, {column: text})`` a data row."""

    path: Path
    header: tuple[str, ...]
    rows: tuple[tuple[int, dict[str, str]], ...]


def data_files(folder: str | Path) -> list[Path]:
    """Every visible file under the dataset's ``data`` folder, in a stable order."""
    root = Path(folder) / "data"
    # A link whose file is not there, as some version controls of data leave it, is told of, never passed over.
    found = (path for path in root.rglob("*") if not path.is_dir())
    # A name that begins with a dot is a half-written file or the file manager's, never data.
    return sorted(path for path in found if not path.name.startswith("."))


def read_data_file(path: Path) -> DataFile:
    """Read one data file as text.

    Raises
    ------
    GlossError
        It cannot be opened, begins with a byte order mark, is not UTF-8 or no CSV, has no header, repeats a column, or
        has a row of another length.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise GlossError(f"Cannot read the data file '{path}': {error.strerror or error}.") from None
    if content.startswith(b"\xef\xbb\xbf"):
        raise GlossError(f"'{path}' begins with a byte order mark; save it as plain UTF-8 (in Excel not 'CSV UTF-8').")
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        raise GlossError(f"'{path}' is not UTF-8 (byte {error.start}); save it as UTF-8.") from None
    return parse_data_file(path, text)


def parse_data_file(path: Path, text: str) -> DataFile:
    """The content of a data file; `path` tells the delimiter by its ending, and names the file in messages.

    Raises
    ------
    GlossError
        It is no CSV, has no header, repeats a column, or has a row of another length.
    """
    try:
        return _parsed(path, text)
    except csv.Error as error:
        raise GlossError(f"'{path}' is no CSV file: {error}.") from None


def _parsed(path: Path, text: str) -> DataFile:
    delimiter = "\t" if path.suffix == ".tsv" else ","
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, strict=True)
    try:
        header = tuple(next(reader, ()))
        lines = [(reader.line_num, fields) for fields in reader]
    except csv.Error as error:
        raise csv.Error(f"line {reader.line_num}: {error}") from None
    if not header:
        raise GlossError(f"'{path}' is empty; the first line of a data file names its columns.")
    repeated = sorted({name for name in header if header.count(name) > 1})
    if repeated:
        raise GlossError(f"'{path}' has the column '{repeated[0]}' twice; each column has a name of its own.")
    rows = []
    for line, fields in lines:
        if not fields:  # a blank line, as editors leave it at the end
            continue
        if len(fields) != len(header):
            raise GlossError(
                f"'{path}', line {line}: {len(fields)} fields, but the header names {len(header)} columns."
            )
        rows.append((line, dict(zip(header, fields, strict=True))))
    return DataFile(path, header, tuple(rows))


def task_kind(table: DataFile) -> TaskKind:
    """Whether the file holds judgements of pairs, of single stimuli or rankings, told by its columns.

    Raises
    ------
    GlossError
        It has the columns of none, or lacks one of its kind.
    """
    marks: dict[TaskKind, set[str]] = {
        "pairwise": {"stimulus_left", "stimulus_right", "dissimilarity"},
        "ranking": {"reference", "rank"},  # before the magnitudes, since it has a column 'stimulus' too
        "magnitude": {"stimulus", "rating"},
    }
    for kind, names in marks.items():
        if names & set(table.header):
            missing = [name for name in COLUMNS[kind] if name not in table.header]
            if missing:
                raise GlossError(
                    f"'{table.path}' has no column '{missing[0]}'; a {kind} file has {', '.join(COLUMNS[kind])}."
                )
            return kind
    raise GlossError(
        f"'{table.path}' is neither a pairwise file (stimulus_left, stimulus_right, dissimilarity), a ranking "
        "(reference, stimulus, rank) nor a magnitude file (stimulus, rating): its header lacks those columns."
    )
