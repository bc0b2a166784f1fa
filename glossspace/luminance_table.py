"""A measured display: what a photometer read at some code values, and the luminance of every code between them."""

import math
from dataclasses import asdict, dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from glossspace.errors import GlossError

__all__ = ["LuminanceTable"]

CHANNELS = ("red_cd_m2", "green_cd_m2", "blue_cd_m2")

# Three readings of the same black screen, by an instrument at the foot of its range.
BLACK_READINGS_AGREE = 0.1


@dataclass(frozen=True, kw_only=True)
class LuminanceTable:
    """What a photometer read at some code values: of gray, or of each channel by itself.

    A channel is measured with the two others at code 0, so each of its readings holds the black of the screen once.
    Gray is their sum with that black counted once::

        gray = red + green + blue - 2 black

    where black is the mean of the three readings at code 0, all of the same black screen.

    Attributes
    ----------
    codes : tuple of int
        Code values, from 0 to the largest one, strictly increasing.
    gray_cd_m2 : tuple of float, optional
        Luminance of gray at these codes, strictly increasing.
    red_cd_m2, green_cd_m2, blue_cd_m2 : tuple of float, optional
        Luminance of each channel at these codes, strictly increasing; instead of `gray_cd_m2`.

    Raises
    ------
    GlossError
        A column is missing, too short or not strictly increasing; the message names the row.

    Examples
    --------
    >>> table = LuminanceTable(
    ...     codes=(0, 255), red_cd_m2=(0.5, 20.5), green_cd_m2=(0.5, 70.5), blue_cd_m2=(0.5, 10.5)
    ... )
    >>> table.gray()
    (0.5, 100.5)
    """

    codes: tuple[int, ...]
    gray_cd_m2: tuple[float, ...] | None = None
    red_cd_m2: tuple[float, ...] | None = None
    green_cd_m2: tuple[float, ...] | None = None
    blue_cd_m2: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        given = [name for name in ("gray_cd_m2", *CHANNELS) if getattr(self, name) is not None]
        if given not in (["gray_cd_m2"], list(CHANNELS)):
            found = ", ".join(given) or "neither"
            raise GlossError(f"A luminance table holds either gray_cd_m2 or {', '.join(CHANNELS)}, but got {found}.")
        if len(self.codes) < 2 or self.codes[0] != 0:
            raise GlossError(
                f"A luminance table begins with code 0 and has two rows at least, but its codes are {list(self.codes)}."
            )
        for name in ("codes", *given):
            column = getattr(self, name)
            if len(column) != len(self.codes):
                raise GlossError(f"The luminance table has {len(self.codes)} codes, but {len(column)} of {name}.")
            self._require_rising(name, column)
        if given != ["gray_cd_m2"]:
            self._require_one_black()

    def gray(self) -> tuple[float, ...]:
        """Luminance of gray (cd/m²) at each of the codes."""
        if self.gray_cd_m2 is not None:
            return self.gray_cd_m2
        columns = self._channels()
        black = sum(column[0] for column in columns) / 3
        # The first row is that black itself, not what rounding leaves of a sum.
        return (black, *(sum(row) - 2 * black for row in zip(*(column[1:] for column in columns), strict=True)))

    @cached_property
    def every_code_cd_m2(self) -> NDArray[np.float64]:
        """Luminance of gray at each code from 0 to the largest: a monotone cubic between the rows."""
        from scipy.interpolate import PchipInterpolator

        gray = self.gray()
        luminance: NDArray[np.float64] = PchipInterpolator(self.codes, gray)(np.arange(self.codes[-1] + 1))
        luminance[list(self.codes)] = gray  # what was measured is kept to the last bit
        return luminance

    def to_dict(self) -> dict[str, list[float]]:
        """Columns as JSON takes them."""
        return {name: list(column) for name, column in asdict(self).items() if column is not None}

    def _channels(self) -> list[tuple[float, ...]]:
        return [getattr(self, name) for name in CHANNELS]

    def _require_rising(self, name: str, column: tuple[float, ...]) -> None:
        for row, value in enumerate(column, start=1):
            if not 0 <= value < math.inf:
                raise GlossError(
                    f"Row {row} of the luminance table: {name} must be a number from 0 on, but is {value}."
                )
        for row, (before, value) in enumerate(pairwise(column), start=2):
            if value <= before:
                raise GlossError(
                    f"Row {row} of the luminance table (code {self.codes[row - 1]}): {name} is {value:g}, but must "
                    f"exceed the {before:g} of the row before. Measure it again, or leave the row out."
                )

    def _require_one_black(self) -> None:
        blacks = [column[0] for column in self._channels()]
        if max(blacks) - min(blacks) > BLACK_READINGS_AGREE * max(blacks):
            raise GlossError(
                f"At code 0 all channels show the same black screen, but the luminance table has {blacks[0]:g}, "
                f"{blacks[1]:g} and {blacks[2]:g} cd/m2 there. Measure each channel with the two others at code 0."
            )
