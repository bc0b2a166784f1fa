"""What ISO 2813 and ASTM D523 prescribe for glossmeters: angles, apertures, black glass, light and eye.

The apertures are those of the glossmeter paper's table 1, full widths in degrees in the plane of incidence and across
it. They agree with what makers of glossmeters publish; the standards' own texts are not free, and their tolerances,
which also allow for vignetting and for the spread of real instruments, are not modelled.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from glossspace.errors import GlossError
from glossspace.instruments.apertures import Aperture
from glossspace.metric.validity import FloatArray, as_floats

__all__ = [
    "BLACK_GLASS_INDEX",
    "GLOSS_ANGLES_DEG",
    "GlossmeterGeometry",
    "glossmeter_geometry",
    "illuminant_spectrum",
    "luminous_efficiency",
    "require_wavelengths",
]

BLACK_GLASS_INDEX = 1.567
"""Index of refraction of the primary standard, which reads 100 at every angle."""

_SOURCE_WIDTHS_DEG = (0.75, 2.5)
_DETECTOR_WIDTHS_DEG = {20: (1.8, 3.6), 60: (4.4, 11.7), 85: (4.0, 6.0)}

GLOSS_ANGLES_DEG = tuple(_DETECTOR_WIDTHS_DEG)


@dataclass(frozen=True)
class GlossmeterGeometry:
    """Source and detector of one angle of a glossmeter."""

    angle_deg: int
    source: Aperture
    detector: Aperture


def glossmeter_geometry(angle_deg: float) -> GlossmeterGeometry:
    """Apertures of the glossmeter at 20, 60 or 85 degrees.

    Raises
    ------
    GlossError
        The standards have no such angle.

    Examples
    --------
    >>> glossmeter_geometry(60).detector.width_across_deg
    11.7
    """
    if angle_deg not in _DETECTOR_WIDTHS_DEG:
        allowed = ", ".join(map(str, GLOSS_ANGLES_DEG))
        raise GlossError(f"Invalid angle_deg = {angle_deg!r} of a glossmeter. Allowed: {allowed}.")
    angle = int(angle_deg)
    source = Aperture(angle, 180, *_SOURCE_WIDTHS_DEG)
    return GlossmeterGeometry(angle, source, Aperture(angle, 0, *_DETECTOR_WIDTHS_DEG[angle]))


def illuminant_spectrum(name: str, wavelengths_nm: ArrayLike) -> FloatArray:
    """Relative spectral power of a CIE illuminant, such as "A", "C", "D65" or "E", interpolated linearly.

    Raises
    ------
    GlossError
        No such illuminant in colour-science, or a wavelength outside its table.

    Examples
    --------
    >>> round(float(illuminant_spectrum("D65", [560.0])[0]), 6)
    100.0
    """
    import colour

    table = colour.SDS_ILLUMINANTS
    if name not in table:
        raise GlossError(f"Unknown illuminant {name!r}. Allowed: {', '.join(sorted(table))}.")
    return _interpolated(table[name], wavelengths_nm, what=f"illuminant {name}")


def luminous_efficiency(wavelengths_nm: ArrayLike) -> FloatArray:
    """V(λ) of the CIE 1924 photopic observer.

    Raises
    ------
    GlossError
        A wavelength outside its table.

    Examples
    --------
    >>> round(float(luminous_efficiency([555.0])[0]), 6)
    1.0
    """
    import colour

    return _interpolated(colour.SDS_LEFS["CIE 1924 Photopic Standard Observer"], wavelengths_nm, what="V(λ)")


def _interpolated(table: Any, wavelengths_nm: ArrayLike, *, what: str) -> FloatArray:
    known = np.asarray(table.wavelengths, dtype=float)
    wavelengths = require_wavelengths(wavelengths_nm, known[0], known[-1], what=what)
    return np.interp(wavelengths, known, np.asarray(table.values, dtype=float))


def require_wavelengths(wavelengths_nm: ArrayLike, low: float, high: float, *, what: str) -> FloatArray:
    """Turn wavelengths into an array (K,), refusing those that a table does not reach.

    Raises
    ------
    GlossError
        They are not finite, ascending numbers within `low` to `high` nm.
    """
    wavelengths = np.atleast_1d(as_floats(wavelengths_nm, name="wavelengths_nm"))
    if wavelengths.ndim != 1 or wavelengths.size == 0 or not np.all(np.diff(wavelengths) > 0):
        raise GlossError("wavelengths_nm must be a list of ascending numbers, in nm.")
    outside = wavelengths[~((wavelengths >= low) & (wavelengths <= high))]
    if outside.size:
        raise GlossError(
            f"No data of {what} at {outside[0]:g} nm: the table covers {low:g} to {high:g} nm. "
            "Choose wavelengths within it."
        )
    return wavelengths
