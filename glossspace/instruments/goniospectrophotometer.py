"""The virtual gonio-spectrophotometer: flux from a source's aperture to a detector's (eq. 15), BRDF, scans, spectra.

What the instrument gives is the BRDF averaged over both apertures, each direction weighted by its cosine; with smaller
apertures it tends to the BRDF itself. A sample that is not the same everywhere is a `Specimen`: patches with areas.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from glossspace.errors import GlossError
from glossspace.instruments.apertures import Aperture
from glossspace.instruments.quadrature import mean_over_apertures, mean_projection
from glossspace.instruments.standards import illuminant_spectrum
from glossspace.metric.validity import FloatArray, as_floats
from glossspace.reflectance.model import ReflectanceModel

__all__ = ["Specimen", "in_plane_scan", "measured_brdf", "out_of_plane_scan", "reflected_flux", "reflected_spectrum"]


@dataclass(frozen=True, eq=False)
class Specimen:
    """The part of a sample that the instrument sees: patches, each with a reflectance and an area.

    Attributes
    ----------
    models : tuple of ReflectanceModel
        Reflectance of each patch.
    areas : tuple of float
        Their areas, 0 or above and not all 0, in any unit.

    Raises
    ------
    GlossError
        The numbers of models and areas differ, or an area is impossible.

    Examples
    --------
    >>> from glossspace.reflectance import Lambert
    >>> half = Specimen((Lambert(0.2), Lambert(0.6)), (1.0, 1.0))
    >>> round(float(measured_brdf(half, Aperture(20, 180), Aperture(60))) * np.pi, 9)
    0.4
    """

    models: tuple[ReflectanceModel, ...]
    areas: tuple[float, ...]

    def __post_init__(self) -> None:
        areas = as_floats(self.areas, name="areas")
        if areas.shape != (len(self.models),) or not np.all(np.isfinite(areas) & (areas >= 0)) or areas.sum() <= 0:
            raise GlossError(
                f"A specimen of {len(self.models)} models needs as many areas, 0 or above and not all 0; "
                f"got {self.areas!r}."
            )
        object.__setattr__(self, "models", tuple(self.models))
        object.__setattr__(self, "areas", tuple(areas.tolist()))


def reflected_flux(
    sample: ReflectanceModel | Specimen,
    source: Aperture,
    detector: Aperture,
    *,
    radiance: ArrayLike = 1.0,
    area: float = 1.0,
) -> FloatArray:
    """Flux that reaches a detector from a source, eq. 15: ``A ∫∫ L f cosθi cosθr dωi dωr``.

    Parameters
    ----------
    sample : ReflectanceModel or Specimen
        Reflectance; a specimen is scaled to the `area`.
    source, detector : Aperture
        Where the light comes from and is caught.
    radiance : array_like, shape () or (K,)
        Radiance of the source, W m⁻² sr⁻¹, or spectral at the wavelengths of the model's channels.
    area : float
        Area of the sample that is seen, m², > 0.

    Returns
    -------
    ndarray of float64, shape () or (K,)
        Flux in W, or W per unit of wavelength. Zero for apertures without size.

    Raises
    ------
    GlossError
        A radiance or the area is impossible, or the shapes do not fit.

    Warns
    -----
    QuadratureWarning
        The mean over the apertures is not known to a thousandth.

    Examples
    --------
    >>> from glossspace.reflectance import Lambert
    >>> small = Aperture(0, 0, 2, 2)
    >>> flux = reflected_flux(Lambert(1.0), small, small)
    >>> round(float(flux / small.solid_angle**2) * np.pi, 3)  # cosines near one
    1.0
    """
    radiance = as_floats(radiance, name="radiance")
    if not (np.all(np.isfinite(radiance) & (radiance >= 0)) and np.isfinite(area) and area > 0):
        raise GlossError("A radiance must be finite and 0 or above, and the area of the sample finite and above 0.")
    mean = _mean(sample, source, detector)
    if radiance.ndim and mean.ndim and radiance.shape != mean.shape:
        raise GlossError(f"radiance has {radiance.size} wavelengths, but the model has {mean.size}. Give one for each.")
    return (area * source.solid_angle * detector.solid_angle * radiance * mean)[()]


def measured_brdf(sample: ReflectanceModel | Specimen, source: Aperture, detector: Aperture) -> FloatArray:
    """BRDF (1/sr) as the instrument measures it: flux over what a BRDF of 1/sr would send.

    Parameters
    ----------
    sample : ReflectanceModel or Specimen
        Reflectance.
    source, detector : Aperture
        Zero widths give the BRDF itself.

    Returns
    -------
    ndarray of float64, shape () or (K,)
        ``∫∫ f cosθi cosθr dωi dωr / ∫∫ cosθi cosθr dωi dωr``.

    Warns
    -----
    QuadratureWarning
        The mean over the apertures is not known to a thousandth.

    Examples
    --------
    >>> from glossspace.reflectance import Ward
    >>> float(round(measured_brdf(Ward(0.1, 0.05), Aperture(30, 180, 1, 1), Aperture(30, 0, 1, 1)), 2))
    3.63
    """
    return (_mean(sample, source, detector) / (mean_projection(source) * mean_projection(detector)))[()]


def _mean(sample: ReflectanceModel | Specimen, source: Aperture, detector: Aperture) -> FloatArray:
    if isinstance(sample, ReflectanceModel):
        return mean_over_apertures(sample, source, detector).value
    total = sum(sample.areas)
    parts = [
        area / total * mean_over_apertures(model, source, detector).value
        for model, area in zip(sample.models, sample.areas, strict=True)
    ]
    sizes = {part.shape for part in parts if part.ndim}
    if len(sizes) > 1:
        raise GlossError("The models of a specimen need equally many channels.")
    return np.asarray(sum(parts))


def in_plane_scan(
    sample: ReflectanceModel | Specimen,
    incident_deg: float,
    detector_deg: Iterable[float],
    *,
    source_widths_deg: tuple[float, float] = (0.0, 0.0),
    detector_widths_deg: tuple[float, float] = (0.0, 0.0),
) -> pd.DataFrame:
    """Scan the detector through the plane of incidence; the mirror direction is at +incident_deg.

    Parameters
    ----------
    sample : ReflectanceModel or Specimen
        Reflectance.
    incident_deg : float
        Angle of the source, 0 to below 90.
    detector_deg : iterable of float
        Angles of the detector, above -90 to below 90; negative ones on the side of the source.
    source_widths_deg, detector_widths_deg : (float, float)
        Widths of the apertures in plane and across.

    Returns
    -------
    DataFrame
        ``incident_deg, detector_deg, azimuth_deg, brdf``; with channels ``brdf_0, brdf_1 …``.

    Examples
    --------
    >>> from glossspace.reflectance import Ward
    >>> scan = in_plane_scan(Ward(0.1, 0.05), 45, [40, 45, 50])
    >>> int(scan["brdf"].idxmax())
    1
    """
    places = [(float(angle), 0.0) for angle in detector_deg]
    return _scan(sample, incident_deg, places, source_widths_deg, detector_widths_deg)


def out_of_plane_scan(
    sample: ReflectanceModel | Specimen,
    incident_deg: float,
    detector_deg: float,
    azimuth_deg: Iterable[float],
    *,
    source_widths_deg: tuple[float, float] = (0.0, 0.0),
    detector_widths_deg: tuple[float, float] = (0.0, 0.0),
) -> pd.DataFrame:
    """Scan the detector around the normal at one polar angle; azimuth 0 is on the side of the mirror direction.

    Parameters and columns are those of `in_plane_scan`.

    Examples
    --------
    >>> from glossspace.reflectance import Lambert
    >>> out_of_plane_scan(Lambert(0.5), 30, 45, [0, 90])["azimuth_deg"].tolist()
    [0.0, 90.0]
    """
    places = [(float(detector_deg), float(azimuth)) for azimuth in azimuth_deg]
    return _scan(sample, incident_deg, places, source_widths_deg, detector_widths_deg)


def _scan(
    sample: ReflectanceModel | Specimen,
    incident_deg: float,
    places: list[tuple[float, float]],
    source_widths_deg: tuple[float, float],
    detector_widths_deg: tuple[float, float],
) -> pd.DataFrame:
    source = Aperture(incident_deg, 180, *source_widths_deg)
    values = [
        np.atleast_1d(measured_brdf(sample, source, Aperture(angle, azimuth, *detector_widths_deg)))
        for angle, azimuth in places
    ]
    table = pd.DataFrame(places, columns=["detector_deg", "azimuth_deg"])
    table.insert(0, "incident_deg", float(incident_deg))
    n = len(values[0]) if values else 1
    names = ["brdf"] if n == 1 else [f"brdf_{channel}" for channel in range(n)]
    return pd.concat([table, pd.DataFrame(np.reshape(values, (-1, n)), columns=names)], axis=1)


def reflected_spectrum(
    sample: ReflectanceModel | Specimen,
    wavelengths_nm: ArrayLike,
    source: Aperture,
    detector: Aperture,
    *,
    illuminant: str = "D65",
) -> pd.DataFrame:
    """Spectrum of the reflected flux under an illuminant, and the reflectance factor by wavelength.

    Parameters
    ----------
    sample : ReflectanceModel or Specimen
        Spectral reflectance with one channel for each wavelength, or without channels: gray.
    wavelengths_nm : array_like, shape (K,)
        Wavelengths of the channels, ascending, within the illuminant's table.
    source, detector : Aperture
        Where the light comes from and is caught.
    illuminant : str
        Name of a CIE illuminant in colour-science.

    Returns
    -------
    DataFrame
        ``wavelength_nm``; ``illuminant``, its relative power; ``reflectance_factor``, flux over that of a perfect
        white; ``flux``, their product.

    Raises
    ------
    GlossError
        The illuminant is unknown, a wavelength is outside its table, or the numbers differ.
    """
    power = illuminant_spectrum(illuminant, wavelengths_nm)
    factor = np.pi * measured_brdf(sample, source, detector)
    if np.ndim(factor) and factor.shape != power.shape:
        raise GlossError(f"wavelengths_nm has {power.size} numbers, but the model has {factor.size} channels.")
    table = {"wavelength_nm": np.atleast_1d(np.asarray(wavelengths_nm, dtype=float)), "illuminant": power}
    return pd.DataFrame(table | {"reflectance_factor": factor, "flux": power * factor})
