"""The patches of a calibration: what is shown where, and what its reading is for."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np

from glossspace.errors import GlossError

__all__ = ["POSITIONS", "PURPOSES", "Patch", "Position", "Purpose", "largest_code", "standard_patches"]

Purpose: TypeAlias = Literal["fit", "verify", "additivity", "uniformity", "veiling", "warm_up", "ambient"]
Position: TypeAlias = Literal["centre", "left", "right", "full"]
PURPOSES: tuple[Purpose, ...] = get_args(Purpose)
POSITIONS: tuple[Position, ...] = get_args(Position)

_MEANINGS: dict[Purpose, str] = {
    "fit": "what the curve is fitted to",
    "verify": "what the curve is judged by; never used in the fit",
    "additivity": "red, green, blue, gray and black, to see whether the channels add up to gray",
    "uniformity": "gray at the places of the two images, and over the full field",
    "veiling": "black in the centre, white all round: light that strays into it",
    "warm_up": "white again and again after switching on, with its minutes",
    "ambient": "the screen switched off, in the room's light of a session",
}


def largest_code(bits: int) -> int:
    """Largest code value of so many bits.

    Raises
    ------
    GlossError
        The bits are neither 8 nor 16.
    """
    if bits not in (8, 16):
        raise GlossError(f"A screen has code values of 8 or 16 bits, but bits is {bits}.")
    return int(2**bits - 1)


@dataclass(frozen=True, kw_only=True)
class Patch:
    """One uniform patch on the screen.

    Attributes
    ----------
    purpose
        What its reading is for.
    position
        ``"centre"``, ``"left"`` and ``"right"``: of the size of an image, on black, at the places of the images;
        ``"full"``: the whole screen.
    red, green, blue
        Code values, 0 to the largest one of the screen.
    minutes
        When to read it, after the first one of the measurement; None where it does not matter.
    """

    purpose: Purpose
    position: Position
    red: int
    green: int
    blue: int
    minutes: float | None = None

    @property
    def codes(self) -> tuple[int, int, int]:
        """Code values of red, green and blue."""
        return self.red, self.green, self.blue

    @property
    def is_gray(self) -> bool:
        """Whether the three code values are equal."""
        return self.red == self.green == self.blue

    @property
    def meaning(self) -> str:
        """What its reading is for, in words."""
        return _MEANINGS[self.purpose]

    def __str__(self) -> str:
        time = "" if self.minutes is None else f", after {self.minutes:g} min"
        return f"{self.purpose} {self.position} {self.red} {self.green} {self.blue}{time}"


def standard_patches(
    *,
    bits: int = 8,
    levels: int = 17,
    warm_up_min: float = 0.0,
    every_min: float = 5.0,
    purposes: Sequence[Purpose] = PURPOSES,
) -> tuple[Patch, ...]:
    """What to measure for a whole calibration, in a good order: warm-up first, ambient light last.

    Gray and every channel are measured, the channels at every second level: the stimuli are gray, so gray decides.
    Verification lies half-way between the levels of the fit, where an interpolation is worst.

    Parameters
    ----------
    bits : {8, 16}
        Of the screen's code values.
    levels : int
        Levels of gray in the fit, black and white included: 9 to 65.
    warm_up_min, every_min : float
        White is read every so many minutes for so long; 0 leaves it out.
    purposes : sequence
        Those wanted.

    Returns
    -------
    tuple of Patch

    Raises
    ------
    GlossError
        A number or a purpose is not allowed.

    Examples
    --------
    >>> patches = standard_patches()
    >>> len(patches), str(patches[0])
    (71, 'fit centre 0 0 0')
    """
    if not 9 <= levels <= 65:
        raise GlossError(f"Invalid number of levels {levels}. Allowed: 9 to 65.")
    if not 0 <= warm_up_min <= 600 or not 0.1 <= every_min < math.inf:
        raise GlossError(
            f"Invalid warm-up of {warm_up_min:g} min, every {every_min:g} min. Allowed: 0 to 600, every 0.1 or more."
        )
    unknown = [purpose for purpose in purposes if purpose not in PURPOSES]
    if unknown:
        raise GlossError(f"Unknown purpose '{unknown[0]}'. Allowed: {', '.join(PURPOSES)}.")
    top = largest_code(bits)
    return tuple(patch for patch in _all_patches(top, levels, warm_up_min, every_min) if patch.purpose in purposes)


def _all_patches(top: int, levels: int, warm_up_min: float, every_min: float) -> Iterator[Patch]:
    def gray(purpose: Purpose, code: int, position: Position = "centre", minutes: float | None = None) -> Patch:
        return Patch(purpose=purpose, position=position, red=code, green=code, blue=code, minutes=minutes)

    def channels(purpose: Purpose, code: int) -> Iterator[Patch]:
        for red, green, blue in ((code, 0, 0), (0, code, 0), (0, 0, code)):
            yield Patch(purpose=purpose, position="centre", red=red, green=green, blue=blue)

    if warm_up_min:
        for minutes in np.arange(0, warm_up_min + every_min / 2, every_min):
            yield gray("warm_up", top, minutes=float(minutes))
    grays = np.linspace(0, top, levels)
    fitted = np.round(grays).astype(int).tolist()
    yield from (gray("fit", code) for code in fitted)
    for code in fitted[2::2] if levels % 2 else [*fitted[2:-1:2], top]:
        yield from channels("fit", code)
    halfway = np.round((grays[:-1] + grays[1:]) / 2).astype(int).tolist()
    yield from (gray("verify", code) for code in halfway[::2] if code not in fitted)
    yield gray("additivity", 0)
    for code in (round(top / 2), top):
        yield from channels("additivity", code)
        yield gray("additivity", code)
    places: tuple[Position, ...] = ("left", "right", "centre")
    for position in places:  # in this order, so that a photometer is aimed anew as seldom as can be
        yield from (gray("uniformity", code, position) for code in (round(top / 4), round(top / 2), top))
    yield gray("uniformity", top, "full")
    yield gray("veiling", 0)
    yield gray("veiling", 0, "full")
    yield gray("ambient", 0)
