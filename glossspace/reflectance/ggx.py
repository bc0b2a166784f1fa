"""The GGX lobe of Walter et al. 2007, with Smith's masking, drawn by the facets that the light sees."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from glossspace.metric.validity import FloatArray
from glossspace.reflectance.fresnel import interface_reflectance, require_index
from glossspace.reflectance.half_vector import HalfVector, half_vector, mirrored
from glossspace.reflectance.model import (
    Parameter,
    ReflectanceModel,
    as_channels,
    as_directions,
    as_uniforms,
    common_channels,
)
from glossspace.reflectance.slope_quadrature import lobe_albedo
from glossspace.reflectance.ward import LARGEST_ROUGHNESS, SMALLEST_ROUGHNESS, require_one_roughness

__all__ = ["Ggx"]


@dataclass(frozen=True, eq=False)
class Ggx(ReflectanceModel):
    """Facets of Trowbridge and Reitz's distribution, isotropic.

    With δ between half vector and normal, and F Fresnel's reflectance at h·i (Walter et al. 2007, eqs 20, 23, 33, 34)::

        f = rho_s F D G(i) G(o) / (4 cosθi cosθo)
        D = alpha² / (π cos⁴δ (alpha² + tan²δ)²)      G(v) = 2 / (1 + sqrt(1 + alpha² tan²θv))

    Half vectors are drawn among those visible from the light (Heitz 2018), so that a weight is F G(o), at most one.

    Attributes
    ----------
    alpha : float or ndarray of float64, shape (K,)
        Roughness, 1e-5 to 100.
    rho_s : float or ndarray of float64, shape (K,)
        Factor of the whole lobe, 0 to 1; the reflectance of the facets where `n` is not given.
    n : float or ndarray of float64, shape (K,), optional
        Index of refraction, 0 to 1e6; without it F is 1.
    k : float or ndarray of float64, shape (K,)
        Extinction coefficient, 0 to 1e6; it counts only beside `n`.

    Raises
    ------
    GlossError
        A parameter is out of its range.

    Examples
    --------
    >>> from glossspace.reflectance.model import direction
    >>> glass = Ggx(alpha=0.1, n=1.5)
    >>> round(float(glass.evaluate(direction(60), direction(60, 180))), 4)
    2.7971
    >>> glass.albedo([0.0, 60.0]).round(4).tolist()
    [0.0396, 0.0859]
    """

    alpha: Parameter
    rho_s: Parameter = 1.0
    n: Parameter = None
    k: Parameter = 0.0

    def __post_init__(self) -> None:
        alpha = as_channels(self.alpha, name="alpha", least=SMALLEST_ROUGHNESS, most=LARGEST_ROUGHNESS)
        object.__setattr__(self, "alpha", alpha)
        object.__setattr__(self, "rho_s", as_channels(self.rho_s, name="rho_s", least=0, most=1))
        object.__setattr__(self, "k", as_channels(self.k, name="k", least=0))
        if self.n is not None:
            object.__setattr__(self, "n", as_channels(self.n, name="n", least=0))
        _ = self.channels
        if self.n is not None:
            require_index(self.n, self.k)

    @property
    def channels(self) -> int | None:
        """Number of wavelengths or paints, None if every parameter is one number."""
        index = {} if self.n is None else {"n": self.n, "k": self.k}
        return common_channels(alpha=self.alpha, rho_s=self.rho_s, **index)

    def evaluate(self, incident: ArrayLike, exitant: ArrayLike) -> FloatArray:
        """BRDF (1/sr) of the lobe; see `ReflectanceModel.evaluate`."""
        half = half_vector(incident, exitant, self.channels)
        fresnel = 1.0 if self.n is None else interface_reflectance(half.half_dot_i, self.n, self.k)
        seen = self._visible_over_cosine(half.cos_i) * self._visible_over_cosine(half.cos_o)
        return half.reflected(self.rho_s * fresnel * self._facets(half) * seen / 4)

    def draw(self, incident: ArrayLike, u: ArrayLike) -> FloatArray:
        """Exitant directions that leave facets visible from the light; some may lie below the horizon."""
        require_one_roughness(alpha=self.alpha)
        first, second = as_uniforms(u)
        i = as_directions(incident, name="incident")
        return mirrored(i, _visible_half_vector(i, self.alpha, first, second))

    def pdf(self, incident: ArrayLike, exitant: ArrayLike) -> FloatArray:
        """Density (1/sr) of `draw`."""
        require_one_roughness(alpha=self.alpha)
        half = half_vector(incident, exitant)
        return half.reflected(self._visible_over_cosine(half.cos_i) * self._facets(half) / 4)

    def albedo(self, theta_deg: ArrayLike, *, phi_deg: ArrayLike = 0.0) -> FloatArray:
        """Directional-hemispherical reflectance by converged quadrature; see `lobe_albedo`."""
        width = min(float(np.min(self.alpha)), 1.0)
        return lobe_albedo(self, theta_deg, phi_deg, widths=(width, width))

    def _facets(self, half: HalfVector) -> FloatArray:
        """The distribution D, from slopes: alpha² / (π (alpha² cos²δ + sin²δ)²)."""
        across2, height2 = half.x**2 + half.y**2, half.z**2
        denominator = (self.alpha**2 * height2 + across2) / (height2 + across2)
        return self.alpha**2 / (np.pi * denominator**2)

    def _visible_over_cosine(self, cosine: FloatArray) -> FloatArray:
        """G(v) / cosθv = 2 / (cosθv + sqrt(cos²θv + alpha² sin²θv))."""
        return 2 / (cosine + np.sqrt(cosine**2 + self.alpha**2 * (1 - cosine) * (1 + cosine)))


def _visible_half_vector(incident: FloatArray, alpha: FloatArray, first: FloatArray, second: FloatArray) -> FloatArray:
    """Half vectors among the facets visible from `incident`: Heitz 2018, sections 3 and 4."""
    stretched = incident * np.stack([alpha, alpha, np.ones_like(alpha)])
    stretched = stretched / np.linalg.norm(stretched, axis=-1, keepdims=True)
    x, y, z = (stretched[..., axis] for axis in range(3))
    across = np.hypot(x, y)
    upright = across == 0
    safe = np.where(upright, 1.0, across)
    aside = np.stack([np.where(upright, 1.0, -y / safe), np.where(upright, 0.0, x / safe), np.zeros_like(x)], axis=-1)
    ahead = np.cross(stretched, aside)
    radius, angle = np.sqrt(first), 2 * np.pi * second
    on_aside, raw = radius * np.cos(angle), radius * np.sin(angle)
    share = 0.5 * (1 + z)
    on_ahead = (1 - share) * np.sqrt(np.maximum(1 - on_aside**2, 0)) + share * raw
    on_incident = np.sqrt(np.maximum(1 - on_aside**2 - on_ahead**2, 0))
    half = on_aside[..., None] * aside + on_ahead[..., None] * ahead + on_incident[..., None] * stretched
    half = np.concatenate([alpha * half[..., :2], np.maximum(half[..., 2:], 0)], axis=-1)
    return half / np.linalg.norm(half, axis=-1, keepdims=True)
