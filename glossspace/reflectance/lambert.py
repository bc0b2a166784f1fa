"""Lambert's perfectly diffuse reflection."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from glossspace.metric.validity import FloatArray
from glossspace.reflectance.half_vector import half_vector
from glossspace.reflectance.model import (
    Parameter,
    ReflectanceModel,
    as_angles,
    as_channels,
    as_directions,
    as_uniforms,
    common_channels,
)

__all__ = ["Lambert", "cosine_direction"]


@dataclass(frozen=True, eq=False)
class Lambert(ReflectanceModel):
    """The same radiance in every direction: f = rho_d / π.

    Attributes
    ----------
    rho_d : float or ndarray of float64, shape (K,)
        Diffuse reflectance, 0 to 1.

    Raises
    ------
    GlossError
        The reflectance is out of its range.

    Examples
    --------
    >>> Lambert(0.5).albedo([0.0, 89.0]).tolist()
    [0.5, 0.5]
    """

    rho_d: Parameter

    def __post_init__(self) -> None:
        object.__setattr__(self, "rho_d", as_channels(self.rho_d, name="rho_d", least=0, most=1))

    @property
    def channels(self) -> int | None:
        """Number of wavelengths or paints, None if the reflectance is one number."""
        return common_channels(rho_d=self.rho_d)

    def evaluate(self, incident: ArrayLike, exitant: ArrayLike) -> FloatArray:
        """BRDF (1/sr); see `ReflectanceModel.evaluate`."""
        return half_vector(incident, exitant, self.channels).reflected(self.rho_d / np.pi)

    def draw(self, incident: ArrayLike, u: ArrayLike) -> FloatArray:
        """Exitant directions of cosine density."""
        i = as_directions(incident, name="incident")
        exitant = cosine_direction(*as_uniforms(u))
        return np.broadcast_to(exitant, np.broadcast_shapes(exitant.shape, i.shape))

    def pdf(self, incident: ArrayLike, exitant: ArrayLike) -> FloatArray:
        """Density (1/sr) of `draw`."""
        half = half_vector(incident, exitant)
        return half.reflected(half.cos_o / np.pi)

    def albedo(self, theta_deg: ArrayLike, *, phi_deg: ArrayLike = 0.0) -> FloatArray:
        """Directional-hemispherical reflectance: rho_d at every angle."""
        theta, _ = as_angles(theta_deg, phi_deg)
        shape = theta.shape + (() if self.channels is None else (self.channels,))
        return np.broadcast_to(self.rho_d, shape).copy()[()]


def cosine_direction(first: FloatArray, second: FloatArray) -> FloatArray:
    """Unit directions (..., 3) of density cosθ/π, from two uniform numbers in [0, 1)."""
    radius, angle = np.sqrt(first), 2 * np.pi * second
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), np.sqrt(1 - first)], axis=-1)
