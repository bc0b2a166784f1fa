"""Photometer readings as a table: read strictly, written whole."""

import csv
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from gloss_experiments.calibration.patches import POSITIONS, PURPOSES, Patch, largest_code
from glossspace.errors import GlossError
from glossspace.files import write_text
from glossspace.user_table import read_user_table

__all__ = ["COLUMNS", "Reading", "Readings", "read_readings", "write_readings"]

COLUMNS = ("purpose", "position", "red", "green", "blue", "luminance_cd_m2")
_OPTIONAL = ("minutes", "x", "y", "photometer")
# Nothing that is shown to an observer is brighter; a larger number is a slip of the hand or of the unit.
_BRIGHTEST_CD_M2 = 1e6


@dataclass(frozen=True, kw_only=True)
class Reading:
    """What a photometer read at one patch: luminance in cd/m² and, where it tells, chromaticity x, y (CIE 1931)."""

    patch: Patch
    luminance_cd_m2: float
    minutes: float | None = None
    x: float | None = None
    y: float | None = None

    def to_dict(self) -> dict[str, Any]:
        """Row of a table."""
        patch = self.patch
        return {
            "purpose": patch.purpose,
            "position": patch.position,
            "red": patch.red,
            "green": patch.green,
            "blue": patch.blue,
            # A plain number: those of NumPy may be printed with fewer digits than they have.
            "luminance_cd_m2": float(self.luminance_cd_m2),
            "minutes": self.minutes,
            "x": self.x,
            "y": self.y,
        }


@dataclass(frozen=True)
class Readings:
    """All readings of one measurement, and the instrument that made them.

    Attributes
    ----------
    items
        In the order in which they were made.
    photometer
        Its name; one that begins with "simulated" is no instrument.
    """

    items: tuple[Reading, ...]
    photometer: str

    @property
    def simulated(self) -> bool:
        """Whether a program made them up."""
        return self.photometer.startswith("simulated")

    def of(self, purpose: str) -> tuple[Reading, ...]:
        """Readings for one purpose."""
        return tuple(reading for reading in self.items if reading.patch.purpose == purpose)


def read_readings(path: str | Path, *, bits: int = 8, photometer: str | None = None) -> Readings:
    """Read a CSV file of photometer readings.

    Its columns: `purpose` (fit, verify, additivity, uniformity, veiling, warm_up, ambient), `position` (centre, left,
    right, full), `red`, `green`, `blue` (code values shown), `luminance_cd_m2`; where known also `minutes` since the
    screen was switched on, the chromaticity `x` and `y`, and `photometer`, which is the same in every row.

    Raises
    ------
    GlossError
        The file cannot be read, a column is missing, or a value is not allowed: the message names the line.
    """
    table = read_user_table(path, what="table of readings", columns=COLUMNS)
    strange = [name for name in table.columns if name not in (*COLUMNS, *_OPTIONAL)]
    if strange:
        raise GlossError(
            f"The table of readings '{path}' has the unknown column '{strange[0]}'. Allowed: "
            f"{', '.join((*COLUMNS, *_OPTIONAL))}."
        )
    if table.empty:
        raise GlossError(f"The table of readings '{path}' has no row. `gloss calibrate patches` lists what to measure.")
    top = largest_code(bits)
    items = tuple(_reading(row, f"'{path}', line {line}", top) for line, row in table.iterrows())
    return Readings(items, _photometer(table, path, photometer))


def write_readings(path: str | Path, readings: Readings) -> None:
    """Write readings as the CSV file that `read_readings` takes, whole or not at all."""
    stream = io.StringIO()
    writer = csv.DictWriter(stream, (*COLUMNS, *_OPTIONAL), lineterminator="\n")
    writer.writeheader()
    for reading in readings.items:
        writer.writerow({**reading.to_dict(), "photometer": readings.photometer})
    write_text(path, stream.getvalue())


def _photometer(table: pd.DataFrame, path: str | Path, stated: str | None) -> str:
    names: Sequence[str] = sorted(set(table["photometer"].dropna())) if "photometer" in table else ()
    if len(names) > 1:
        raise GlossError(
            f"The table of readings '{path}' has the photometers {', '.join(names)}. Use one, or two files."
        )
    if names and stated and stated != names[0]:
        raise GlossError(f"'{path}' says that '{names[0]}' made its readings, but '{stated}' is stated. Leave it out.")
    return names[0] if names else stated or "not stated"


def _reading(row: "pd.Series", place: str, top: int) -> Reading:
    for column, allowed in (("purpose", PURPOSES), ("position", POSITIONS)):
        if row[column] not in allowed:
            raise GlossError(f"{place}: the {column} is {_shown(row[column])}. Allowed: {', '.join(allowed)}.")
    red, green, blue = (_code(row[column], f"{place}: {column}", top) for column in ("red", "green", "blue"))
    luminance = _number(row, "luminance_cd_m2", place, 0, _BRIGHTEST_CD_M2)
    if luminance is None:
        raise GlossError(f"{place}: the luminance is missing. Measure the patch, or remove the row.")
    minutes = _number(row, "minutes", place, 0, 100_000)
    if row["purpose"] == "warm_up" and minutes is None:
        raise GlossError(f"{place}: a warm-up reading needs its minutes since the screen was switched on.")
    patch = Patch(
        purpose=row["purpose"], position=row["position"], red=red, green=green, blue=blue,
        minutes=minutes if row["purpose"] == "warm_up" else None,
    )  # fmt: skip
    x, y = (_number(row, column, place, 0, 1) for column in ("x", "y"))
    return Reading(patch=patch, luminance_cd_m2=luminance, minutes=minutes, x=x, y=y)


def _code(value: Any, place: str, top: int) -> int:
    try:
        code = int(value)
    except (TypeError, ValueError):
        code = -1
    if not 0 <= code <= top:
        raise GlossError(f"{place} is {_shown(value)}. Allowed: a whole code value from 0 to {top}.")
    return code


def _number(row: "pd.Series", column: str, place: str, lowest: float, highest: float) -> float | None:
    value = row.get(column)
    if value is None or pd.isna(value):
        return None
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not lowest <= number <= highest:
        raise GlossError(f"{place}: {column} is {_shown(value)}. Allowed: a number from {lowest:g} to {highest:g}.")
    return number


def _shown(value: Any) -> str:
    return "empty" if value is None or pd.isna(value) else f"'{value}'"
