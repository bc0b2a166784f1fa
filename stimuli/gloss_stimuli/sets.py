"""Which stimuli a set holds: the shipped sets by name, or a user's list in CSV or TOML."""

import csv
import itertools
import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AliasChoices, BaseModel, ConfigDict, Discriminator, Field, Tag, ValidationError, model_validator

from glossspace.errors import GlossError
from glossspace.files import read_toml, shipped_folder
from glossspace.metric import diffuse_reflectance, max_contrast_gloss, to_physical
from glossspace.stimulus_set import Stimulus
from glossspace.user_table import read_user_table

__all__ = ["StimulusList", "read_stimulus_list", "shipped_sets"]

# The two ways to state a paint, and what else the first perceptual column may be called.
PHYSICAL = ("rho_d", "rho_s", "alpha")
PERCEPTUAL = ("lightness", "c", "d")
LIGHTNESS_ALIAS = "L"

# Digits of the paint of an appearance: c and d keep nine of theirs, and names stay short.
SIGNIFICANT_DIGITS = 12

# Far more than three numbers of double precision need, far less than a file name may have.
LONGEST_NAME = 120


@dataclass(frozen=True)
class StimulusList:
    """Name, title and stimuli of a set, in the order in which they are rendered."""

    name: str
    title: str
    stimuli: tuple[Stimulus, ...]


class _Table(BaseModel):
    """A table of a TOML list: the physical or the perceptual triple, never some of both."""

    model_config = ConfigDict(extra="forbid", strict=True)

    @model_validator(mode="before")
    @classmethod
    def _is_of_one_kind(cls, table: Any) -> Any:
        if isinstance(table, dict):
            _refuse_mixture(table)
        return table


_Values = Annotated[list[float], Field(min_length=1)]
_LIGHTNESS = Field(validation_alias=AliasChoices("lightness", LIGHTNESS_ALIAS))


class _Grid(_Table):
    """All combinations of the listed values."""

    rho_d: _Values
    rho_s: _Values
    alpha: _Values


class _PerceptualGrid(_Table):
    """All combinations of the listed values."""

    lightness: Annotated[_Values, _LIGHTNESS]
    c: _Values
    d: _Values


class _Row(_Table):
    """One stimulus."""

    rho_d: float
    rho_s: float
    alpha: float


class _PerceptualRow(_Table):
    """One stimulus."""

    lightness: Annotated[float, _LIGHTNESS]
    c: float
    d: float


def _kind(table: Any) -> str:
    return "perceptual" if isinstance(table, dict) and _perceptual_names(table) else "physical"


_AnyGrid = Annotated[
    Annotated[_Grid, Tag("physical")] | Annotated[_PerceptualGrid, Tag("perceptual")], Discriminator(_kind)
]
_AnyRow = Annotated[
    Annotated[_Row, Tag("physical")] | Annotated[_PerceptualRow, Tag("perceptual")], Discriminator(_kind)
]


class _ListFile(BaseModel):
    """A stimulus list in TOML: grids first, then single stimuli."""

    model_config = ConfigDict(extra="forbid")

    format: Literal["glossspace/stimulus-list"]
    version: Literal[1]
    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]+$")]
    title: str = ""
    grid: list[_AnyGrid] = []
    stimulus: list[_AnyRow] = []


def shipped_sets() -> tuple[str, ...]:
    """Names of the sets that ship with the package."""
    return tuple(sorted(path.stem for path in shipped_folder(__file__, "sets").glob("*.toml")))


def read_stimulus_list(source: str | Path) -> StimulusList:
    """Stimuli of a shipped set, or of a CSV or TOML file.

    Parameters
    ----------
    source : str or path
        ``experiment1``, ``contrast``, ``contrast30``, ``doi``, or a file. A CSV has the columns rho_d, rho_s and alpha,
        or lightness (CIELAB L*, 0 to 100; also called L), c and d, in any order. A TOML file looks like the
        shipped ones: ``[[grid]]`` tables of lists, ``[[stimulus]]`` tables of numbers, each with either triple.

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
        content = _ListFile.model_validate(read_toml(path, what="stimulus list"))
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        reason = first["msg"].removeprefix("Value error, ").rstrip(".")
        raise GlossError(f"The stimulus list '{path}' is not valid at '{place}': {reason}.") from None
    return StimulusList(content.name, content.title, _stimuli(_toml_rows(content), path))


@dataclass(frozen=True)
class _Entry:
    """A paint as the list states it, and where."""

    place: str
    columns: tuple[str, ...]
    values: tuple[float, ...]


def _toml_rows(content: _ListFile) -> Iterator[_Entry]:
    for kind, tables in (("grid", content.grid), ("stimulus", content.stimulus)):
        for number, table in enumerate(tables, start=1):
            columns = tuple(type(table).model_fields)
            lists = [value if isinstance(value, list) else [value] for _, value in table]
            for values in itertools.product(*lists):
                yield _Entry(f"{kind} {number}", columns, values)


def _csv_rows(path: Path) -> Iterator[_Entry]:
    header, columns = _csv_columns(path)
    table = read_user_table(path, what="stimulus list", columns=header)[list(header)].fillna("")
    for line, cells in zip(table.index, table.itertuples(index=False), strict=True):
        where = f"The stimulus list '{path}', line {line}"
        yield _Entry(f"line {line}", columns, tuple(map(_number, itertools.repeat(where), header, cells)))


def _csv_columns(path: Path) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The triple that the header names, as it is spelt there and as it is called here."""
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
        cells = next(csv.reader([line for line in lines if line.strip()], skipinitialspace=True), [])
    except (OSError, UnicodeDecodeError, csv.Error):
        return PHYSICAL, PHYSICAL  # `read_user_table` tells what is wrong with the file
    header = [cell.strip() for cell in cells]
    try:
        _refuse_mixture(header)
    except ValueError as error:
        raise GlossError(f"The stimulus list '{path}' {error}") from None
    perceptual = _perceptual_names(header)
    if perceptual:
        lightness = LIGHTNESS_ALIAS if LIGHTNESS_ALIAS in perceptual else "lightness"
        return (lightness, "c", "d"), PERCEPTUAL
    if len(header) > 1 and not set(PHYSICAL) & set(header):
        raise GlossError(
            f"The stimulus list '{path}' names no paints: it must have the columns {', '.join(PHYSICAL)}, or "
            f"{', '.join(PERCEPTUAL)}, but has {', '.join(header)}."
        )
    return PHYSICAL, PHYSICAL


def _perceptual_names(names: Iterable[str]) -> list[str]:
    return [name for name in names if name in (*PERCEPTUAL, LIGHTNESS_ALIAS)]


def _refuse_mixture(names: Iterable[str]) -> None:
    names = list(names)
    perceptual, physical = _perceptual_names(names), [name for name in names if name in PHYSICAL]
    if perceptual and physical:
        raise ValueError(
            f"mixes {', '.join(physical)} with {', '.join(perceptual)}: state either {', '.join(PHYSICAL)} or "
            f"{', '.join(PERCEPTUAL)}, since each triple determines the other. Remove or rename one."
        )
    if {"lightness", LIGHTNESS_ALIAS} <= set(perceptual):
        raise ValueError(f"has both lightness and {LIGHTNESS_ALIAS}, which are the same. Remove one.")


def _number(where: str, column: str, cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        raise GlossError(f"{where}: {column} must be a number, but is '{cell}'.") from None


def _paint_of(lightness: float, c: float, d: float) -> tuple[float, float, float]:
    """Physical parameters of an appearance, without the digits that only rounding put there."""
    for name, value in zip(PERCEPTUAL, (lightness, c, d), strict=True):
        if not math.isfinite(value):
            raise GlossError(f"{name} must be a finite number, but is {value}.")
    limit = float(max_contrast_gloss(lightness))
    if c > limit * (1 + 1e-9):  # what is within rounding of the limit is on it
        rho_d = float(diffuse_reflectance(lightness))
        raise GlossError(
            f"c = {c:g} is out of reach at lightness {lightness:g}: rho_d is {rho_d:.4g} there, which leaves rho_s at "
            f"most {1 - rho_d:.4g} and c at most {limit:.4g}, since no paint reflects more than it receives."
        )
    paint = to_physical(lightness, min(c, limit), d)
    rho_d, rho_s, alpha = (float(f"{float(value):.{SIGNIFICANT_DIGITS}g}") for value in paint)
    if rho_d + rho_s > 1:  # by rounding alone
        scale = 10**SIGNIFICANT_DIGITS
        rho_s = math.floor((1 - rho_d) * scale) / scale
    return rho_d, rho_s, alpha


def _stimuli(rows: Iterator[_Entry], path: Path) -> tuple[Stimulus, ...]:
    found: dict[str, str] = {}
    stimuli = []
    for row in rows:
        place = row.place
        try:
            values = _paint_of(*row.values) if row.columns == PERCEPTUAL else row.values
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
