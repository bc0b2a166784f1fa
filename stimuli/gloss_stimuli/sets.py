"""Which stimuli a set holds: the shipped sets by name, or a user's list in CSV or TOML."""

import itertools
import re
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from glossspace.errors import GlossError
from glossspace.files import shipped_folder
from glossspace.stimulus_set import Stimulus
from glossspace.user_table import read_user_table

__all__ = ["StimulusList", "read_stimulus_list", "shipped_sets"]

COLUMNS = ("rho_d", "rho_s", "alpha")

# Far more than three numbers of double precision need, far less than a file name may have.
LONGEST_NAME = 120


@dataclass(frozen=True)
class StimulusList:
    """Name, title and stimuli of a set, in the order in which they are rendered."""

    name: str
    title: str
    stimuli: tuple[Stimulus, ...]


class _Grid(BaseModel):
    """All combinations of the listed values."""

    model_config = ConfigDict(extra="forbid", strict=True)

    rho_d: Annotated[list[float], Field(min_length=1)]
    rho_s: Annotated[list[float], Field(min_length=1)]
    alpha: Annotated[list[float], Field(min_length=1)]


class _Row(BaseModel):
    """One stimulus."""

    model_config = ConfigDict(extra="forbid", strict=True)

    rho_d: float
    rho_s: float
    alpha: float


class _ListFile(BaseModel):
    """A stimulus list in TOML: grids first, then single stimuli."""

    model_config = ConfigDict(extra="forbid")

    format: Literal["glossspace/stimulus-list"]
    version: Literal[1]
    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]+$")]
    title: str = ""
    grid: list[_Grid] = []
    stimulus: list[_Row] = []


def shipped_sets() -> tuple[str, ...]:
    """Names of the sets that ship with the package."""
    return tuple(sorted(path.stem for path in shipped_folder(__file__, "sets").glob("*.toml")))


def read_stimulus_list(source: str | Path) -> StimulusList:
    """Stimuli of a shipped set, or of a CSV or TOML file.

    Parameters
    ----------
    source : str or path
        ``experiment1``, ``contrast``, ``doi``, or a file. A CSV has the columns rho_d, rho_s and alpha, in any order. A
        TOML file looks like the shipped ones: ``[[grid]]`` tables of lists, ``[[stimulus]]`` tables of numbers.

    Raises
    ------
    GlossError
        The set is unknown, the file is damaged, or a row is impossible or repeated.

    Examples
    --------
    >>> len(read_stimulus_list("experiment1").stimuli)
    27
    """
    path = Path(source)
    if str(source) in shipped_sets():
        path = shipped_folder(__file__, "sets") / f"{source}.toml"
    elif not path.is_file():
        raise GlossError(
            f"Unknown stimulus set '{source}': neither a file nor a shipped set. "
            f"Shipped sets: {', '.join(shipped_sets())}."
        )
    if path.suffix.lower() == ".toml":
        return _read_toml(path)
    if path.suffix.lower() == ".csv":
        name = re.sub(r"[^A-Za-z0-9_-]+", "-", path.stem)
        return StimulusList(name, "", _stimuli(_csv_rows(path), path))
    raise GlossError(f"The stimulus list '{path}' must be a .csv or .toml file.")


def _read_toml(path: Path) -> StimulusList:
    try:
        content = _ListFile.model_validate(tomllib.loads(path.read_text(encoding="utf-8")))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise GlossError(f"Cannot read the stimulus list '{path}': {error}.") from None
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        raise GlossError(f"The stimulus list '{path}' is not valid at '{place}': {first['msg']}.") from None
    return StimulusList(content.name, content.title, _stimuli(_toml_rows(content), path))


def _toml_rows(content: _ListFile) -> Iterator[tuple[str, tuple[Any, Any, Any]]]:
    for number, grid in enumerate(content.grid, start=1):
        for values in itertools.product(grid.rho_d, grid.rho_s, grid.alpha):
            yield f"grid {number}", values
    for number, row in enumerate(content.stimulus, start=1):
        yield f"stimulus {number}", (row.rho_d, row.rho_s, row.alpha)


def _csv_rows(path: Path) -> Iterator[tuple[str, tuple[float, float, float]]]:
    table = read_user_table(path, what="stimulus list", columns=COLUMNS)[list(COLUMNS)].fillna("")
    for line, cells in zip(table.index, table.itertuples(index=False), strict=True):
        yield f"line {line}", _numbers(cells, f"The stimulus list '{path}', line {line}")


def _numbers(cells: Sequence[str], where: str) -> tuple[float, float, float]:
    values = []
    for column, cell in zip(COLUMNS, cells, strict=True):
        try:
            values.append(float(cell))
        except ValueError:
            raise GlossError(f"{where}: {column} must be a number, but is '{cell}'.") from None
    return values[0], values[1], values[2]


def _stimuli(rows: Iterator[tuple[str, tuple[Any, Any, Any]]], path: Path) -> tuple[Stimulus, ...]:
    found: dict[str, str] = {}
    stimuli = []
    for place, values in rows:
        try:
            stimulus = Stimulus.of(*values)
        except GlossError as error:
            raise GlossError(f"The stimulus list '{path}', {place}: {error}") from None
        if len(stimulus.name) > LONGEST_NAME:
            raise GlossError(
                f"The stimulus list '{path}', {place}: the files of this stimulus would have a name of "
                f"{len(stimulus.name)} characters; allowed are {LONGEST_NAME}. Give its numbers with fewer digits."
            )
        if stimulus.name in found:
            raise GlossError(
                f"The stimulus list '{path}', {place}: {stimulus.name} is already there ({found[stimulus.name]}). "
                "Remove one of the two."
            )
        found[stimulus.name] = place
        stimuli.append(stimulus)
    if not stimuli:
        raise GlossError(f"The stimulus list '{path}' holds no stimuli.")
    return tuple(stimuli)
