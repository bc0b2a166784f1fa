"""Colour of a reflectance spectrum under an illuminant, and the two geometries in which colour is measured.

The sums are over the wavelengths that are given, by the trapezoid rule: a spectrum that leaves out a part of the
visible range leaves it out of the white, too.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from glossspace.errors import GlossError
from glossspace.instruments.apertures import Aperture
from glossspace.instruments.goniospectrophotometer import measured_brdf
from glossspace.instruments.quadrature import mean_over_apertures
from glossspace.instruments.standards import illuminant_spectrum, require_wavelengths
from glossspace.metric.validity import FloatArray, as_floats
from glossspace.reflectance.model import ReflectanceModel

__all__ = ["OBSERVERS", "Colour", "reflectance_factor_8_diffuse", "reflectance_factor_45_0", "spectrum_colour"]

OBSERVERS = ("CIE 1931 2 Degree Standard Observer", "CIE 1964 10 Degree Standard Observer")


class Colour(NamedTuple):
    """Tristimulus values, Y of a perfect white being 100, and CIELAB against the illuminant's white."""

    xyz: FloatArray
    lab: FloatArray


def spectrum_colour(
    reflectance_factor: ArrayLike,
    wavelengths_nm: ArrayLike,
    *,
    illuminant: str = "D65",
    observer: str = "CIE 1931 2 Degree Standard Observer",
) -> Colour:
    """XYZ and CIELAB of a reflectance spectrum under any illuminant and for any observer of colour-science.

    Parameters
    ----------
    reflectance_factor : array_like, shape (K,)
        Share of what a perfect white would send; above one in the direction of a mirror.
    wavelengths_nm : array_like, shape (K,)
        At least two, ascending.
    illuminant, observer : str
        Names in colour-science.

    Returns
    -------
    Colour
        XYZ and CIELAB, each of shape (3,).

    Raises
    ------
    GlossError
        A name is unknown, a wavelength is outside a table, or the numbers differ.

    Examples
    --------
    >>> white = spectrum_colour([1.0] * 31, range(400, 710, 10), illuminant="A")
    >>> white.lab.round(6).tolist()
    [100.0, 0.0, 0.0]
    """
    import colour

    power = illuminant_spectrum(illuminant, wavelengths_nm)
    if observer not in colour.MSDS_CMFS:
        raise GlossError(f"Unknown observer {observer!r}. Allowed: {', '.join(sorted(colour.MSDS_CMFS))}.")
    functions = colour.MSDS_CMFS[observer]
    known = np.asarray(functions.wavelengths, dtype=float)
    wavelengths = require_wavelengths(wavelengths_nm, known[0], known[-1], what=observer)
    factor = as_floats(reflectance_factor, name="reflectance_factor")
    if factor.shape != wavelengths.shape or wavelengths.size < 2:
        raise GlossError(
            f"A spectrum needs two wavelengths or more and one reflectance for each; got {wavelengths.size} and "
            f"{factor.size}."
        )
    matching = np.stack([np.interp(wavelengths, known, functions.values[:, k]) for k in range(3)])
    white = np.trapezoid(power * matching, wavelengths)
    xyz = np.trapezoid(factor * power * matching, wavelengths)
    scale = 100 / white[1]
    lab = colour.XYZ_to_Lab(xyz / white[1], colour.XYZ_to_xy(white))
    return Colour(scale * xyz, np.asarray(lab, dtype=float))


def reflectance_factor_45_0(
    model: ReflectanceModel, *, n_azimuths: int = 1, source_width_deg: float = 4.0, detector_width_deg: float = 4.0
) -> FloatArray:
    """Reflectance factor with light from 45° and the detector along the normal (45°x:0°).

    Parameters
    ----------
    model : ReflectanceModel
        Reflectance; channels are kept.
    n_azimuths : int
        Sources around the normal whose readings are averaged; many make the annular 45°a:0° of anisotropic samples
        (the narrower the lobe, the more).
    source_width_deg, detector_width_deg : float
        Square apertures, in degrees.

    Returns
    -------
    ndarray of float64, shape () or (K,)
        One for a perfect white.

    Raises
    ------
    GlossError
        The number of azimuths is not 1 to 360, or a width is impossible.

    Examples
    --------
    >>> from glossspace.reflectance import Lambert
    >>> round(float(reflectance_factor_45_0(Lambert(0.42))), 9)
    0.42
    """
    if not (isinstance(n_azimuths, int) and 1 <= n_azimuths <= 360):
        raise GlossError(f"Invalid n_azimuths = {n_azimuths!r}. Allowed: a whole number, 1 to 360.")
    detector = Aperture(0, 0, detector_width_deg, detector_width_deg)
    readings = [
        measured_brdf(model, Aperture(45, azimuth, source_width_deg, source_width_deg), detector)
        for azimuth in np.arange(n_azimuths) * 360 / n_azimuths
    ]
    return np.pi * np.mean(readings, axis=0)


def reflectance_factor_8_diffuse(
    model: ReflectanceModel, *, specular_included: bool = True, trap_width_deg: float = 8.0
) -> FloatArray:
    """Reflectance factor between the direction at 8° and the whole hemisphere (8°:di, or 8°:de with a gloss trap).

    For a reciprocal model this is also the reading of the glossmeter paper's future work, a hemispherical source with
    the detector at 8° (di:8°).

    Parameters
    ----------
    model : ReflectanceModel
        Reflectance; channels are kept.
    specular_included : bool
        False leaves out what falls into a trap about the mirror direction.
    trap_width_deg : float
        Side of the square trap. The standards leave it to the maker of the sphere; 8° is usual.

    Returns
    -------
    ndarray of float64, shape () or (K,)
        Share of the light that is reflected.

    Examples
    --------
    >>> from glossspace.reflectance import Lambert, Ward
    >>> glossy = Lambert(0.4) + Ward(0.05, 0.01)
    >>> [round(float(reflectance_factor_8_diffuse(glossy, specular_included=kept)), 3) for kept in (True, False)]
    [0.449, 0.398]
    """
    total = np.asarray(model.albedo(8.0))
    if specular_included:
        return total[()]
    trap = Aperture(8, 180, trap_width_deg, trap_width_deg)
    narrow = Aperture(8, 0)
    trapped = mean_over_apertures(model, narrow, trap).value * trap.solid_angle / np.cos(np.radians(8))
    return (total - trapped)[()]
