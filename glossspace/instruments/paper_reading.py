"""The glossmeter paper's way to read gloss, the only one that gives its table 2.

Apertures are full widths in the polar angle and in the **raw azimuth**, whatever the polar angle; so a width of 2.5°
across is sin θ times as wide in truth. Source and detector are cut into n × n patches of ``Δω = sinθ Δθ Δφ``, evaluated
at their midpoints. Equation 15 has cosθi cosθr, equation 16 cosθi. The paper does not say how many patches: 2 × 2 gives
its numbers, at 60° and 85° no other grid does.
"""

import math

import numpy as np

from glossspace.errors import GlossError
from glossspace.instruments.apertures import Aperture
from glossspace.instruments.standards import BLACK_GLASS_INDEX, glossmeter_geometry
from glossspace.metric.validity import FloatArray
from glossspace.reflectance.fresnel import fresnel_reflectance
from glossspace.reflectance.model import ReflectanceModel

__all__ = ["midpoint_gloss_units"]


def midpoint_gloss_units(model: ReflectanceModel, angle_deg: float, *, n_patches: int = 2) -> FloatArray:
    """Gloss units by midpoint patches in polar angle and raw azimuth, as the glossmeter paper computes them.

    Parameters
    ----------
    model : ReflectanceModel
        Reflectance; channels are kept.
    angle_deg : float
        20, 60 or 85.
    n_patches : int
        Patches along each side of each aperture, 1 to 32.

    Returns
    -------
    ndarray of float64, shape () or (K,)
        Gloss units, eq. 17.

    Raises
    ------
    GlossError
        The angle or the number of patches is not allowed.

    Examples
    --------
    >>> from glossspace.reflectance import Ward
    >>> round(float(midpoint_gloss_units(Ward(1.0, 0.110), 60)), 1)  # table 2 prints 75.1
    74.9
    """
    if not (isinstance(n_patches, int) and 1 <= n_patches <= 32):
        raise GlossError(f"Invalid n_patches = {n_patches!r}. Allowed: a whole number, 1 to 32.")
    geometry = glossmeter_geometry(angle_deg)
    incident, source_omega = _patches(geometry.source, n_patches)
    exitant, detector_omega = _patches(geometry.detector, n_patches)
    arriving = incident[:, 2] * source_omega
    weight = arriving[:, None] * (exitant[:, 2] * detector_omega)[None, :]
    sample = np.tensordot(weight, model.evaluate(incident[:, None, :], exitant[None, :, :]), axes=2)
    standard = np.sum(arriving * fresnel_reflectance(incident[:, 2], BLACK_GLASS_INDEX))
    return 100 * sample / standard


def _patches(aperture: Aperture, n: int) -> tuple[FloatArray, FloatArray]:
    """Directions at the midpoints of n × n patches, and the patches' Δω."""
    steps = (np.arange(n) + 0.5) / n - 0.5
    theta_deg, phi_deg = np.meshgrid(
        aperture.theta_deg + steps * aperture.width_in_plane_deg, aperture.phi_deg + steps * aperture.width_across_deg
    )
    theta, phi = np.radians(theta_deg.ravel()), np.radians(phi_deg.ravel())
    directions = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    area = math.radians(aperture.width_in_plane_deg / n) * math.radians(aperture.width_across_deg / n)
    return directions, np.sin(theta) * area
