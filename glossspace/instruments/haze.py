"""Haze and distinctness of image: by difference of two gloss readings, and from the shape of the reflected peak.

How far the standards could be checked. Their texts are not free. ASTM D4039's abstract says that haze comes from two
specular gloss measurements, at 60° (large receptor) and 20° (small one); the difference G60 - G20 is what is commonly
published, and what is computed here. ASTM E430's abstract says that it has three methods, at specular angles of 30°,
20° and 30°; definitions quoted from it say that reflection haze is the flux at stated angles from the mirror
direction over that of a gloss standard in the mirror direction. The offsets here, .3° for distinctness of image and 2°
for haze, are those in common use, and the apertures are round numbers: none was checked against the standard itself, so
all are arguments. Ratios are to the sample's own peak.
"""

import numpy as np
from numpy.typing import ArrayLike

from glossspace.errors import GlossError
from glossspace.instruments.apertures import Aperture
from glossspace.instruments.glossmeter import gloss_units
from glossspace.instruments.quadrature import mean_over_apertures
from glossspace.metric.validity import FloatArray, as_floats
from glossspace.reflectance.model import ReflectanceModel

__all__ = ["distinctness_of_image", "goniophotometric_haze", "haze_by_difference"]


def haze_by_difference(model: ReflectanceModel) -> FloatArray:
    """Haze as gloss units at 60° less those at 20°, the two readings of ASTM D4039; for high-gloss samples.

    Examples
    --------
    >>> from glossspace.reflectance import CookTorrance
    >>> sharp, dull = (CookTorrance(1.0, slope, 1.5, form="beckmann") for slope in (0.002, 0.02))
    >>> float(haze_by_difference(sharp)) < float(haze_by_difference(dull))
    True
    """
    return gloss_units(model, 60) - gloss_units(model, 20)


def goniophotometric_haze(
    model: ReflectanceModel,
    *,
    offset_deg: float = 2.0,
    angle_deg: float = 30.0,
    source_widths_deg: tuple[float, float] = (0.4, 0.4),
    detector_widths_deg: tuple[float, float] = (0.4, 0.4),
) -> FloatArray:
    """Haze as 100 times the flux beside the mirror direction, mean of both sides, over that in it.

    Parameters
    ----------
    model : ReflectanceModel
        Reflectance; channels are kept.
    offset_deg : float
        Distance from the mirror direction in the plane of incidence, > 0.
    angle_deg : float
        Angle of incidence.
    source_widths_deg, detector_widths_deg : (float, float)
        Apertures in plane and across.

    Returns
    -------
    ndarray of float64, shape () or (K,)
        0 for a mirror, 100 for a perfectly diffuse surface.

    Raises
    ------
    GlossError
        An angle is impossible, or the sample reflects nothing.

    Examples
    --------
    >>> from glossspace.reflectance import Lambert
    >>> round(float(goniophotometric_haze(Lambert(0.5))), 1)
    99.9
    """
    peak, beside = _peak_and_sides(model, offset_deg, angle_deg, source_widths_deg, detector_widths_deg)
    return 100 * beside / peak


def distinctness_of_image(
    model: ReflectanceModel,
    *,
    offset_deg: float = 0.3,
    angle_deg: float = 30.0,
    source_widths_deg: tuple[float, float] = (0.1, 0.1),
    detector_widths_deg: tuple[float, float] = (0.1, 0.1),
) -> FloatArray:
    """Distinctness of image as 100 (1 - R_beside / R_mirror): 100 for a mirror, 0 where no image is seen.

    Parameters, errors and shapes are those of `goniophotometric_haze`. This is an instrument's number; the gloss
    paper's d = 1 - alpha is the perceptual coordinate.

    Examples
    --------
    >>> from glossspace.reflectance import Ward
    >>> [round(float(distinctness_of_image(Ward(0.1, alpha)))) for alpha in (0.001, 0.004, 0.04)]
    [100, 34, 0]
    """
    peak, beside = _peak_and_sides(model, offset_deg, angle_deg, source_widths_deg, detector_widths_deg)
    return 100 * (1 - beside / peak)


def _peak_and_sides(
    model: ReflectanceModel,
    offset_deg: float,
    angle_deg: float,
    source_widths_deg: tuple[float, float],
    detector_widths_deg: tuple[float, float],
) -> tuple[FloatArray, FloatArray]:
    if not (0 < offset_deg < 90):
        raise GlossError(f"Invalid offset_deg = {offset_deg!r}. Allowed: above 0 to below 90.")
    source = Aperture(angle_deg, 180, *source_widths_deg)

    def flux(at_deg: ArrayLike) -> FloatArray:
        detector = Aperture(float(as_floats(at_deg, name="angle_deg")), 0, *detector_widths_deg)
        return mean_over_apertures(model, source, detector).value * max(detector.solid_angle, 1e-300)

    peak = flux(angle_deg)
    if np.any(peak <= 0):
        raise GlossError("The sample reflects nothing in the mirror direction, so no ratio to it can be given.")
    sides = [flux(angle_deg + sign * offset_deg) for sign in (-1, 1)]
    return peak, (sides[0] + sides[1]) / 2
