"""The readings of the fit, sorted by curve and checked: enough levels, rising, not saturated, no channel missing."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from gloss_experiments.calibration.patches import Patch
from gloss_experiments.calibration.readings import Reading
from glossspace.errors import GlossError

__all__ = ["CHANNELS", "CurveName", "CurveReadings", "FitTable", "fit_table"]

CurveName: TypeAlias = Literal["gray", "red", "green", "blue"]
CHANNELS: tuple[CurveName, ...] = ("red", "green", "blue")

# Three parameters a curve: a fit needs a level more than that to have anything left to judge it by.
_FEWEST_LEVELS = 5
# The largest dip that photometer noise makes; a deeper one is a mix-up of patches or a screen that was not warm.
_DIP_OF_NOISE = 0.03
# Exponents of displays lie between 1.8 and 2.6; below this the last step hardly brightens.
_SMALLEST_EXPONENT = 0.3


@dataclass(frozen=True)
class CurveReadings:
    """The readings of one curve.

    Attributes
    ----------
    codes : ndarray, shape (n,), int
        Code values above 0, rising; every repeat is an entry of its own.
    luminance_cd_m2 : ndarray, shape (n,)
    """

    codes: NDArray[np.int64]
    luminance_cd_m2: NDArray[np.float64]

    def levels(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """The different code values, and the mean luminance at each."""
        codes, place = np.unique(self.codes, return_inverse=True)
        return codes, np.bincount(place, weights=self.luminance_cd_m2) / np.bincount(place)


@dataclass(frozen=True)
class FitTable:
    """All readings of the fit.

    Attributes
    ----------
    black_cd_m2 : ndarray, shape (n,)
        Readings at code 0, which every curve shares.
    curves : dict
        Gray, or red, green and blue, or all four.
    position : str
        Where the patches stood.
    dips : dict
        Of each curve that falls somewhere, by no more than noise explains: the code value after the fall.
    """

    black_cd_m2: NDArray[np.float64]
    curves: dict[CurveName, CurveReadings]
    position: str
    dips: dict[CurveName, int]


def fit_table(readings: Sequence[Reading], *, top: int) -> FitTable:
    """Sort the readings of the fit by curve and check them.

    Parameters
    ----------
    readings : sequence of Reading
        Those whose purpose is the fit.
    top : int
        Largest code value of the screen.

    Raises
    ------
    GlossError
        There are too few levels, black or the largest code is missing, a channel is missing, luminance falls by more
        than noise, or the brightest levels read the same.
    """
    if not readings:
        raise GlossError("There are no readings of the purpose 'fit'. `gloss calibrate patches` lists what to measure.")
    positions = sorted({reading.patch.position for reading in readings})
    if len(positions) > 1:
        raise GlossError(
            f"The patches of the fit stood at the positions {', '.join(positions)}. One curve belongs to one position: "
            "give the others the purpose 'uniformity'."
        )
    black = np.array([reading.luminance_cd_m2 for reading in readings if reading.patch.codes == (0, 0, 0)])
    if not black.size:
        raise GlossError("The fit has no reading of black (codes 0 0 0). Measure it: every curve begins there.")
    sorted_by_curve: dict[CurveName, list[tuple[int, float]]] = {}
    for reading in readings:
        if reading.patch.codes != (0, 0, 0):
            name = _curve_of(reading.patch)
            sorted_by_curve.setdefault(name, []).append((max(reading.patch.codes), reading.luminance_cd_m2))
    missing = [name for name in CHANNELS if name not in sorted_by_curve]
    if missing and len(missing) < len(CHANNELS):
        raise GlossError(
            f"The fit has no reading of {' or '.join(missing)} alone, but of another channel. Measure red, green and "
            "blue, or gray alone."
        )
    curves, dips = {}, {}
    for name in ("gray", *CHANNELS):
        if name in sorted_by_curve:
            codes, luminance = zip(*sorted(sorted_by_curve[name]), strict=True)
            curves[name] = CurveReadings(np.array(codes), np.array(luminance))
            dip = _checked_rise(name, curves[name], float(black.mean()), top)
            if dip is not None:
                dips[name] = dip
    if not curves:
        raise GlossError("The fit has readings of black alone. Measure gray, or red, green and blue, up to white.")
    return FitTable(black, curves, positions[0], dips)


def _curve_of(patch: Patch) -> CurveName:
    if patch.is_gray:
        return "gray"
    lit = [name for name in CHANNELS if getattr(patch, name) > 0]
    if len(lit) > 1:
        raise GlossError(
            f"The patch '{patch}' is neither gray nor one channel alone, which is all that a fit takes. Give it the "
            "purpose 'verify'."
        )
    return lit[0]


def _checked_rise(name: CurveName, curve: CurveReadings, black_cd_m2: float, top: int) -> int | None:
    codes, luminance = curve.levels()
    if codes.size + 1 < _FEWEST_LEVELS:
        raise GlossError(
            f"The fit has {codes.size + 1} levels of {name}, black included, but needs {_FEWEST_LEVELS} at least; 17 "
            "are good. `gloss calibrate patches` lists them."
        )
    if codes[-1] != top:
        raise GlossError(
            f"The brightest {name} of the fit is code {codes[-1]}, but the screen reaches {top}. Measure that too, or "
            "state the bits of the code values."
        )
    before = np.concatenate([[black_cd_m2], luminance[:-1]])
    fall = 1 - luminance / np.maximum(before, np.finfo(float).tiny)
    worst = int(np.argmax(fall))
    if fall[worst] > _DIP_OF_NOISE:
        raise GlossError(
            f"The luminance of {name} falls from {before[worst]:g} to {luminance[worst]:g} cd/m2 at code "
            f"{codes[worst]}, by more than a photometer errs. Were patches mixed up, or was the screen not warm? "
            "Measure it again."
        )
    # What is not saturated grows at the end like a power of the code value.
    last, before_last = luminance[-1] - black_cd_m2, luminance[-2] - black_cd_m2
    if last <= 0 or before_last > last * (codes[-2] / codes[-1]) ** _SMALLEST_EXPONENT:
        raise GlossError(
            f"{name.capitalize()} reads {luminance[-2]:g} cd/m2 at code {codes[-2]} and {luminance[-1]:g} at code "
            f"{codes[-1]}: it is saturated. Lower the screen's contrast setting, or choose the photometer's next range."
        )
    falls = np.flatnonzero(luminance <= before)
    return int(codes[falls[0]]) if falls.size and math.isfinite(before[0]) else None
