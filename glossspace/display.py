"""A calibrated display: luminance to code values and back, and what rounding to whole codes costs."""

import math
from dataclasses import asdict, dataclass
from typing import Any, Self, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from glossspace.errors import GlossError
from glossspace.luminance_table import LuminanceTable

__all__ = ["DisplayModel", "LuminanceTable", "QuantisationError"]

# Exact code values are in 8-bit units whatever the display has, so that errors compare between displays.
LARGEST_EXACT_CODE = 255


@dataclass(frozen=True, kw_only=True)
class QuantisationError:
    """What rounding to the nearest code value does to luminance, over the whole range of a display.

    Exact code values are taken as equally frequent. A Weber fraction is an error over the luminance it is made at.
    """

    bits: int
    largest_cd_m2: float
    rms_cd_m2: float
    largest_weber: float
    rms_weber: float

    def to_dict(self) -> dict[str, float]:
        """Figures of a manifest, to the digits that mean something."""
        return {"bits": self.bits} | {
            name: float(f"{value:.4g}") for name, value in asdict(self).items() if name != "bits"
        }


@dataclass(frozen=True, kw_only=True)
class DisplayModel:
    """Display of luminance ``black + (white - black) (code / largest code)^gamma``, or of a measured luminance.

    The default is the monitor of the gloss paper (3.2.3.2): 0.7 to 108 cd/m² with a gamma of 2.35. For a measured one,
    see `from_table`: between its rows the luminance of each code is interpolated by a monotone cubic (PCHIP; Fritsch &
    Butland 1984), between neighbouring codes, which no screen can show, linearly.

    Attributes
    ----------
    black_cd_m2, white_cd_m2 : float
        Luminance of the smallest and the largest code value.
    gamma : float or None
        Exponent of the curve between them; None where it was measured.
    bits : int
        8 or 16: the code values that the display takes.
    measured : LuminanceTable, optional
        Where the curve comes from, if not from a gamma.

    Raises
    ------
    GlossError
        A number is out of range, or the table does not fit the others.

    Examples
    --------
    >>> display = DisplayModel()
    >>> display.codes([0.7, 108.0]).tolist()
    [0, 255]
    """

    black_cd_m2: float = 0.7
    white_cd_m2: float = 108.0
    gamma: float | None = 2.35
    bits: int = 8
    measured: LuminanceTable | None = None

    def __post_init__(self) -> None:
        _largest_code(self.bits)
        if not 0 <= self.black_cd_m2 < self.white_cd_m2 < math.inf:
            raise GlossError(
                "A display needs a finite white_cd_m2 that exceeds black_cd_m2, and no negative black, but black is "
                f"{self.black_cd_m2} and white {self.white_cd_m2}."
            )
        if (self.gamma is None) == (self.measured is None):
            raise GlossError("A display has either a gamma or a measured luminance table. Give one of the two.")
        if self.gamma is not None and not 0 < self.gamma < math.inf:
            raise GlossError(f"The gamma of a display must be a finite number above 0, but is {self.gamma}.")
        if self.measured is not None:
            self._require_fitting(self.measured)

    @classmethod
    def from_table(cls, table: LuminanceTable, *, bits: int = 8) -> Self:
        """Display whose luminance was measured; its codes must reach the largest one of these bits."""
        gray = table.gray()
        return cls(black_cd_m2=gray[0], white_cd_m2=gray[-1], gamma=None, bits=bits, measured=table)

    @classmethod
    def from_dict(cls, document: dict[str, Any]) -> Self:
        """Display of a manifest, as `to_dict` wrote it; whatever else stands there is left alone."""
        columns = document.get("measured")
        table = None if columns is None else LuminanceTable(**{key: tuple(values) for key, values in columns.items()})
        return cls(
            black_cd_m2=document["black_cd_m2"],
            white_cd_m2=document["white_cd_m2"],
            gamma=document["gamma"],
            bits=document["bits"],
            measured=table,
        )

    @property
    def contrast(self) -> float:
        """White over black luminance."""
        return self.white_cd_m2 / self.black_cd_m2 if self.black_cd_m2 > 0 else math.inf

    def exact_codes(self, luminance_cd_m2: ArrayLike) -> NDArray[np.float64]:
        """Code values before rounding, for display luminance in cd/m² (any shape).

        In units of an 8-bit code, 0 to 255, whatever the bits. What lies outside the display's range is held at its
        ends; `clipped` counts it.
        """
        if self.measured is not None:
            table = self.measured.every_code_cd_m2
            positions = np.interp(
                np.asarray(luminance_cd_m2, dtype=float), table, np.linspace(0, LARGEST_EXACT_CODE, table.size)
            )
            return np.asarray(positions, dtype=float)
        share = np.array(luminance_cd_m2, dtype=float)  # a copy: the steps below need no further memory
        share -= self.black_cd_m2
        share /= self.white_cd_m2 - self.black_cd_m2
        np.clip(share, 0.0, 1.0, out=share)
        np.power(share, 1 / cast(float, self.gamma), out=share)
        share *= LARGEST_EXACT_CODE
        return share

    def codes(self, luminance_cd_m2: ArrayLike, *, bits: int | None = None) -> NDArray[np.unsignedinteger[Any]]:
        """Nearest code values, uint8 or uint16 by `bits` (default: the display's).

        No dither, so that equal luminances stay equal.

        Raises
        ------
        FloatingPointError
            A luminance is not finite.
        """
        bits = self.bits if bits is None else bits
        exact = self.exact_codes(luminance_cd_m2)
        if not np.isfinite(exact).all():
            raise FloatingPointError("A luminance that is not finite has no code value.")
        exact *= _largest_code(bits) / LARGEST_EXACT_CODE
        exact += 0.5
        return np.floor(exact).astype(np.uint8 if bits == 8 else np.uint16)

    def luminance(self, codes: ArrayLike, *, bits: int | None = None) -> NDArray[np.float64]:
        """Displayed luminance (cd/m²) of code values of so many bits (default: the display's), whole or not.

        Raises
        ------
        GlossError
            A code value is out of range.
        """
        bits = self.bits if bits is None else bits
        largest = _largest_code(bits)
        share = np.array(codes, dtype=float)
        if share.size and not (share.min() >= 0 and share.max() <= largest):
            raise GlossError(
                f"Code values of {bits} bits lie between 0 and {largest}, but these reach from {share.min():g} to "
                f"{share.max():g}. State their bits."
            )
        share /= largest
        if self.measured is not None:
            table = self.measured.every_code_cd_m2
            return np.asarray(np.interp(share, np.linspace(0, 1, table.size), table), dtype=float)
        np.power(share, cast(float, self.gamma), out=share)
        share *= self.white_cd_m2 - self.black_cd_m2
        share += self.black_cd_m2
        return share

    def clipped(self, luminance_cd_m2: ArrayLike) -> int:
        """Number of luminances that the display cannot show."""
        luminance = np.asarray(luminance_cd_m2, dtype=float)
        return int(np.count_nonzero((luminance < self.black_cd_m2) | (luminance > self.white_cd_m2)))

    def quantisation_error(self, *, bits: int | None = None) -> QuantisationError:
        """What rounding to code values of so many bits (default: the display's) does to luminance.

        Notes
        -----
        An exact code x in ``k ± 1/2`` is displayed as k, an error of ``|L(x) - L(k)|``: largest at the half codes, and
        squared and averaged over x by Gauss-Legendre quadrature on each half interval.
        """
        bits = self.bits if bits is None else bits
        largest = _largest_code(bits)
        nodes, weights = np.polynomial.legendre.leggauss(4)
        # Distances from the nearest whole code, and shares of the range; the last one is the half code itself.
        offsets, shares = np.append((nodes + 1) / 4, 0.5), np.append(weights / 4, 0.0)
        whole = np.arange(largest + 1)
        shown = self.luminance(whole, bits=bits)
        above = self.luminance(whole[:-1, None] + offsets, bits=bits)
        below = self.luminance(whole[1:, None] - offsets, bits=bits)
        true = np.stack([above, below])
        error = np.abs(true - np.stack([shown[:-1, None], shown[1:, None]]))
        weber = error / true
        return QuantisationError(
            bits=bits,
            largest_cd_m2=float(error.max()),
            rms_cd_m2=math.sqrt(float((error**2 @ shares).sum() / largest)),
            largest_weber=float(weber.max()),
            rms_weber=math.sqrt(float((weber**2 @ shares).sum() / largest)),
        )

    def to_dict(self) -> dict[str, Any]:
        """Parameters as JSON takes them; `from_dict` makes the display again."""
        document = {
            "black_cd_m2": self.black_cd_m2,
            "white_cd_m2": self.white_cd_m2,
            "gamma": self.gamma,
            "bits": self.bits,
        }
        return document if self.measured is None else {**document, "measured": self.measured.to_dict()}

    def _require_fitting(self, table: LuminanceTable) -> None:
        largest = _largest_code(self.bits)
        if table.codes[-1] != largest:
            raise GlossError(
                f"The luminance table of a display of {self.bits} bits must end with code {largest}, but ends with "
                f"{table.codes[-1]}. Measure it there, or state other bits."
            )
        ends = (table.gray()[0], table.gray()[-1])
        if (self.black_cd_m2, self.white_cd_m2) != ends:
            raise GlossError(
                f"black_cd_m2 and white_cd_m2 are {self.black_cd_m2:g} and {self.white_cd_m2:g}, but the luminance "
                f"table reaches from {ends[0]:g} to {ends[1]:g}. Leave them out."
            )


def _largest_code(bits: int) -> int:
    if bits not in (8, 16):
        raise GlossError(f"A display has code values of 8 or 16 bits, but bits is {bits}.")
    return int(2**bits - 1)
