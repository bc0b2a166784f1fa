"""The glossmeter of ISO 2813 and ASTM D523: gloss units of any reflectance model at 20°, 60° and 85°.

The **physical reading** is the default: true angles, converged quadrature. The **table2 reading** is the glossmeter
paper's, which differs by up to a third (`glossspace.instruments.paper_reading`).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from glossspace.errors import GlossError
from glossspace.instruments.apertures import Aperture
from glossspace.instruments.lobes import LobeShape
from glossspace.instruments.nodes import make_nodes
from glossspace.instruments.paper_reading import midpoint_gloss_units
from glossspace.instruments.quadrature import mean_over_apertures
from glossspace.instruments.standards import (
    BLACK_GLASS_INDEX,
    GLOSS_ANGLES_DEG,
    glossmeter_geometry,
    illuminant_spectrum,
    luminous_efficiency,
)
from glossspace.metric.validity import FloatArray
from glossspace.reflectance.fresnel import fresnel_reflectance
from glossspace.reflectance.model import ReflectanceModel

__all__ = ["READINGS", "GlossReading", "gloss_reading", "gloss_units", "mirror_gloss_units", "photopic_mean"]

READINGS = ("physical", "table2")


@dataclass(frozen=True)
class GlossReading:
    """What a glossmeter reads of a sample, and whether such a sample can be.

    Attributes
    ----------
    gu20, gu60, gu85 : ndarray, shape () or (K,)
        Gloss units.
    albedo20, albedo60, albedo85 : ndarray, shape () or (K,)
        Directional-hemispherical reflectance at those angles.
    conserves_energy : ndarray of bool
        Whether no albedo is above one.
    reading : str
        ``physical`` or ``table2``.
    relative_error : float
        Largest estimated relative error of the physical reading's quadrature; zero for table2, which is what its
        patches give.
    """

    gu20: FloatArray
    gu60: FloatArray
    gu85: FloatArray
    albedo20: FloatArray
    albedo60: FloatArray
    albedo85: FloatArray
    conserves_energy: FloatArray
    reading: str
    relative_error: float

    @property
    def haze(self) -> FloatArray:
        """Haze by difference, gu60 - gu20: the two readings of ASTM D4039."""
        return self.gu60 - self.gu20


def gloss_units(
    model: ReflectanceModel,
    angle_deg: float,
    *,
    reading: str = "physical",
    wavelengths_nm: ArrayLike | None = None,
    relative_tolerance: float = 1e-6,
) -> FloatArray:
    """Gloss units of a model at one angle: flux through the detector, over that of black glass of index 1.567.

    Parameters
    ----------
    model : ReflectanceModel
        Reflectance. Channels are many paints read at once, unless `wavelengths_nm` says that they are wavelengths.
    angle_deg : float
        20, 60 or 85.
    reading : str
        ``physical`` (true angles, Gauss–Legendre) or ``table2`` (the glossmeter paper's patches).
    wavelengths_nm : array_like, shape (K,), optional
        Wavelengths of a spectral model's channels: the reading is weighted by illuminant C and V(λ).
    relative_tolerance : float
        Of the physical reading's quadrature.

    Returns
    -------
    ndarray of float64, shape () or (K,)
        Gloss units; above 100 for what mirrors better than black glass.

    Raises
    ------
    GlossError
        The angle or reading is unknown, or the wavelengths do not fit the model.

    Warns
    -----
    QuadratureWarning
        The physical reading is not known to a thousandth.

    Examples
    --------
    >>> from glossspace.reflectance import Ward
    >>> round(float(gloss_units(Ward(1.0, 0.11), 60)), 3)
    78.149
    """
    units, _ = _units_and_error(model, angle_deg, reading=reading, relative_tolerance=relative_tolerance)
    return units[()] if wavelengths_nm is None else photopic_mean(units, wavelengths_nm)


def _units_and_error(
    model: ReflectanceModel, angle_deg: float, *, reading: str, relative_tolerance: float = 1e-6
) -> tuple[FloatArray, float]:
    """Gloss units of every channel, and the estimated relative error of the worst."""
    if reading not in READINGS:
        raise GlossError(f"Unknown reading {reading!r}. Allowed: {', '.join(READINGS)}.")
    if reading == "table2":
        return midpoint_gloss_units(model, angle_deg), 0.0
    geometry = glossmeter_geometry(angle_deg)
    found = mean_over_apertures(model, geometry.source, geometry.detector, relative_tolerance=relative_tolerance)
    standard = _mean_reflected(geometry.source, BLACK_GLASS_INDEX, 0.0)
    return 100 * found.value * geometry.detector.solid_angle / standard, found.relative_error


def gloss_reading(
    model: ReflectanceModel, *, reading: str = "physical", wavelengths_nm: ArrayLike | None = None
) -> GlossReading:
    """Gloss units at the three angles, with the albedo at each; see `gloss_units`.

    Raises
    ------
    GlossError
        The reading is unknown, or the wavelengths do not fit the model.

    Warns
    -----
    QuadratureWarning
        A physical reading is not known to a thousandth; `relative_error` says to what.

    Examples
    --------
    >>> from glossspace.reflectance import CookTorrance
    >>> paint = gloss_reading(CookTorrance(scale=21.5, slope=0.6, n=1.32), reading="table2")
    >>> round(float(paint.gu60), 1), bool(paint.conserves_energy)
    (10.6, False)
    """
    found = [_units_and_error(model, angle, reading=reading) for angle in GLOSS_ANGLES_DEG]
    units = [value[()] if wavelengths_nm is None else photopic_mean(value, wavelengths_nm) for value, _ in found]
    albedos = [np.asarray(model.albedo(float(angle))) for angle in GLOSS_ANGLES_DEG]
    conserved = np.all([albedo <= 1 + 1e-9 for albedo in albedos], axis=0)  # the albedo's own quadrature rounds
    if wavelengths_nm is not None:
        albedos = [photopic_mean(albedo, wavelengths_nm) for albedo in albedos]
        conserved = np.all(conserved)
    gu20, gu60, gu85 = units
    albedo20, albedo60, albedo85 = albedos
    relative_error = max(error for _, error in found)
    return GlossReading(gu20, gu60, gu85, albedo20, albedo60, albedo85, conserved, reading, relative_error)


def mirror_gloss_units(angle_deg: float, *, n: ArrayLike, k: ArrayLike = 0.0) -> FloatArray:
    """Gloss units of a perfect mirror of index n + ik, whose image of the source is within the detector.

    The closed form at the angle itself is ``100 F(n, k) / F(1.567)``; the source's width changes it by less than 1e-3.

    Raises
    ------
    GlossError
        The angle is unknown, or an index is impossible.

    Examples
    --------
    >>> round(float(mirror_gloss_units(60, n=1.567)), 9)
    100.0
    """
    source = glossmeter_geometry(angle_deg).source
    return 100 * _mean_reflected(source, n, k) / _mean_reflected(source, BLACK_GLASS_INDEX, 0.0)


def _mean_reflected(source: Aperture, n: ArrayLike, k: ArrayLike) -> FloatArray:
    """Mean of cosθi F over a source: eq. 16 without radiance, area and solid angle."""
    nodes = make_nodes(source, Aperture(0.0), LobeShape(np.inf, np.inf, np.inf), (6, 6, 1, 1))
    cosine, weight = nodes.outer[:, 0, 2], nodes.weight[:, 0]
    n, k = np.broadcast_arrays(np.asarray(n, dtype=float), np.asarray(k, dtype=float))
    return np.tensordot(weight * cosine, fresnel_reflectance(cosine.reshape(-1, *[1] * n.ndim), n, k), axes=1)[()]


def photopic_mean(values: ArrayLike, wavelengths_nm: ArrayLike) -> FloatArray:
    """Mean of a spectrum (K,) weighted by illuminant C and V(λ), over wavelengths spaced as they may be.

    Raises
    ------
    GlossError
        The numbers of values and wavelengths differ, or a wavelength is outside 360 to 780 nm.

    Examples
    --------
    >>> float(photopic_mean([2.0, 2.0, 2.0], [500.0, 550.0, 600.0]))
    2.0
    """
    weight = illuminant_spectrum("C", wavelengths_nm) * luminous_efficiency(wavelengths_nm)
    values = np.atleast_1d(np.asarray(values, dtype=float))
    if values.shape != weight.shape:
        raise GlossError(
            f"wavelengths_nm has {weight.size} numbers, but the model has {values.size}. Give one for each channel."
        )
    if weight.size == 1:
        return values[0]
    at = np.asarray(wavelengths_nm, dtype=float)
    return np.trapezoid(weight * values, at) / np.trapezoid(weight, at)
