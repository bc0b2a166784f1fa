"""The interface of every reflectance model: evaluate, sample, density, albedo.

Directions are arrays of shape (..., 3): unit vectors in the surface's frame, whose z axis is the normal, pointing away
from the surface. ``incident`` points to where the light comes from, ``exitant`` to where it goes. Values are BRDFs in
1/sr, without the cosine, and zero where either direction is at or below the horizon. A direction with NaN gives NaN.

A parameter is one number, or an array of shape (K,) with one for each channel: K wavelengths of a spectral model, or K
paints that are evaluated at once. A model with channels appends an axis of K to what `evaluate`, `albedo` and the
weights of `sample` return; directions and densities have none, since a sampled direction serves all channels.

A model of one's own derives from `ReflectanceModel` and says how it evaluates, draws and integrates; `check_model`
tells whether the three agree.
"""

from __future__ import annotations

import reprlib
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from glossspace.errors import GlossError
from glossspace.metric.validity import FloatArray, as_floats, require

if TYPE_CHECKING:
    from glossspace.reflectance.sum import Sum

__all__ = [
    "Parameter",
    "ReflectanceModel",
    "Sample",
    "as_angles",
    "as_channels",
    "as_directions",
    "as_uniforms",
    "common_channels",
    "direction",
    "over_channels",
]

Parameter: TypeAlias = Any
"""A number or a list of K of them where it is given to a model; an array of shape () or (K,) once it is checked."""

# Directions made in single precision are this far from unit length; anything further is no rounding.
_UNIT_LENGTH_TOLERANCE = 1e-6


@dataclass(frozen=True)
class Sample:
    """Exitant directions drawn by a model's density, with what a Monte Carlo estimate needs.

    Attributes
    ----------
    exitant : ndarray of float64, shape (..., 3)
        Unit directions; one below the horizon has weight zero.
    pdf : ndarray of float64, shape (...)
        Density of the draw (1/sr).
    weight : ndarray of float64, shape (...) or (..., K)
        ``f cos(theta_exitant) / pdf``; its mean is the albedo. Zero where the density is.
    """

    exitant: FloatArray
    pdf: FloatArray
    weight: FloatArray


class ReflectanceModel(ABC):
    """A BRDF that can be evaluated, importance-sampled and integrated over the hemisphere. ``a + b`` is their sum."""

    @property
    def channels(self) -> int | None:
        """Number of wavelengths or paints, None if every parameter is one number."""
        return None

    @abstractmethod
    def evaluate(self, incident: ArrayLike, exitant: ArrayLike) -> FloatArray:
        """BRDF (1/sr) at directions of shape (..., 3) that broadcast; shape (...), or (..., K) with channels."""

    @abstractmethod
    def draw(self, incident: ArrayLike, u: ArrayLike) -> FloatArray:
        """Exitant unit directions (..., 3) by the density `pdf`, from uniform numbers u (..., 2) in [0, 1)."""

    @abstractmethod
    def pdf(self, incident: ArrayLike, exitant: ArrayLike) -> FloatArray:
        """Density (1/sr) with which `draw` gives `exitant`; zero at and below the horizon."""

    @abstractmethod
    def albedo(self, theta_deg: ArrayLike, *, phi_deg: ArrayLike = 0.0) -> FloatArray:
        """Directional-hemispherical reflectance of light from polar angle `theta_deg`, 0 to below 90 degrees.

        Only an anisotropic model depends on the azimuth `phi_deg`.
        """

    def sample(self, incident: ArrayLike, u: ArrayLike) -> Sample:
        """Draw exitant directions, with their density and weight.

        Parameters
        ----------
        incident : array_like, shape (..., 3)
            Unit directions to the light.
        u : array_like, shape (..., 2)
            Uniform numbers in [0, 1).

        Returns
        -------
        Sample
            Directions, densities and weights; their shapes are those of `incident` and `u`, broadcast.

        Raises
        ------
        GlossError
            A direction is not of unit length, or a number lies outside [0, 1).
        """
        exitant = self.draw(incident, u)
        pdf = self.pdf(incident, exitant)
        zero = over_channels(pdf == 0, self.channels)  # where the value is zero too, so anything may divide it
        cosine, density = (over_channels(array, self.channels) for array in (exitant[..., 2], pdf))
        weight = self.evaluate(incident, exitant) * cosine / np.where(zero, 1.0, density)
        return Sample(exitant, pdf, np.where(zero, 0.0, weight))

    def __add__(self, other: ReflectanceModel) -> Sum:
        from glossspace.reflectance.sum import Sum

        if not isinstance(other, ReflectanceModel):
            return NotImplemented
        return Sum((self, other))


def direction(theta_deg: ArrayLike, phi_deg: ArrayLike = 0.0) -> FloatArray:
    """Unit vectors (..., 3) of polar angle `theta_deg` from the normal and azimuth `phi_deg`, both in degrees.

    Examples
    --------
    >>> direction([0.0, 60.0]).round(4).tolist()
    [[0.0, 0.0, 1.0], [0.866, 0.0, 0.5]]
    """
    theta, phi = np.broadcast_arrays(
        np.radians(as_floats(theta_deg, name="theta_deg")), np.radians(as_floats(phi_deg, name="phi_deg"))
    )
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)


def as_directions(value: ArrayLike, *, name: str) -> FloatArray:
    """Array of unit vectors, shape (..., 3); one with NaN passes.

    Raises
    ------
    GlossError
        The last axis has not three numbers, or a vector is not of unit length.
    """
    array = as_floats(value, name=name)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise GlossError(f"{name} must be unit vectors of shape (..., 3), but has shape {array.shape}.")
    length2 = np.einsum("...i,...i->...", array, array)
    if np.any(wrong := np.abs(length2 - 1) > 2 * _UNIT_LENGTH_TOLERANCE):
        offender = array[wrong][0] if array.ndim > 1 else array
        raise GlossError(
            f"{name} must be of unit length, but {offender.tolist()} has length {np.linalg.norm(offender):.8g}. "
            "Divide it by its length."
        )
    return array


def as_uniforms(u: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """The two uniform numbers of each draw.

    Raises
    ------
    GlossError
        The last axis has not two numbers, or one lies outside [0, 1).
    """
    array = as_floats(u, name="u")
    if array.ndim == 0 or array.shape[-1] != 2:
        raise GlossError(f"u must be pairs of uniform numbers of shape (..., 2), but has shape {array.shape}.")
    inside = (array >= 0) & (array < 1)
    if not np.all(inside):
        raise GlossError(f"Invalid u = {float(array[~inside][0])!r}. Allowed: 0 to below 1, as a generator draws them.")
    return array[..., 0], array[..., 1]


def as_angles(theta_deg: ArrayLike, phi_deg: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Polar angles and azimuths of incidence in degrees, broadcast against each other.

    Raises
    ------
    GlossError
        A polar angle lies outside 0 to below 90 degrees, an azimuth is infinite, or either is NaN.
    """
    theta, phi = as_floats(theta_deg, name="theta_deg"), as_floats(phi_deg, name="phi_deg")
    for name, angle in (("theta_deg", theta), ("phi_deg", phi)):
        if np.any(np.isnan(angle)):
            raise GlossError(f"{name} has NaN, for which there is no albedo. Leave it out.")
    require((theta >= 0) & (theta < 90), theta, name="theta_deg", allowed="0 to below 90, degrees from the normal")
    require(np.isfinite(phi), phi, name="phi_deg", allowed="finite")
    theta, phi = np.broadcast_arrays(theta, phi)
    return theta, phi


def as_channels(value: ArrayLike, *, name: str, least: float, most: float = np.inf) -> FloatArray:
    """A parameter: one number, or one for each channel; it cannot be changed afterwards.

    Raises
    ------
    GlossError
        It is no number or list of numbers, NaN, infinite, or out of its range.
    """
    array = as_floats(value, name=name).copy()
    if array.ndim > 1 or array.size == 0:
        raise GlossError(
            f"{name} must be one number, or one for each wavelength or paint, but has shape {array.shape}: "
            f"{reprlib.repr(value)}."
        )
    inside = (array >= least) & (array <= most) & np.isfinite(array)
    if not np.all(inside):
        offender = float(array[~inside][0]) if array.ndim else float(array)
        allowed = f"finite, from {least:g} on" if most == np.inf else f"{least:g} to {most:g}"
        raise GlossError(f"Invalid {name} = {offender!r}. Allowed: {allowed}.")
    array.flags.writeable = False
    return array


def common_channels(**parameters: Parameter) -> int | None:
    """Number of channels of a model's parameters, None if each is one number.

    Raises
    ------
    GlossError
        Two parameters have different numbers of channels.
    """
    sizes = {name: array.size for name, array in parameters.items() if array.ndim}
    if len(set(sizes.values())) > 1:
        listed = ", ".join(f"{name} has {size}" for name, size in sizes.items())
        raise GlossError(f"All parameters need equally many channels, but {listed}. Give one number, or K of each.")
    return next(iter(sizes.values()), None)


def over_channels(array: NDArray[Any], channels: int | None) -> NDArray[Any]:
    """The array with a last axis of one, which broadcasts over the channels; as it is for a model without channels."""
    return array if channels is None else array[..., None]
