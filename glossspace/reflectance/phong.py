"""Phong's lobe around the mirror direction, normalised to conserve energy."""

from dataclasses import dataclass
from functools import partial

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
    direction,
    over_channels,
)
from glossspace.reflectance.slope_quadrature import converged, geometric_breaks, panels
from glossspace.reflectance.ward import require_one_roughness

__all__ = ["Phong"]

LARGEST_EXPONENT = 1e8


@dataclass(frozen=True, eq=False)
class Phong(ReflectanceModel):
    """The modified Phong lobe of Lafortune and Willems 1994: reciprocal, and never above rho_s.

    With the angle γ between the exitant direction and the mirror direction of the incident one::

        f = rho_s (exponent + 2) / (2π) · max(cosγ, 0)^exponent

    Its albedo is rho_s at normal incidence and falls towards grazing.

    Attributes
    ----------
    rho_s : float or ndarray of float64, shape (K,)
        Specular reflectance at normal incidence, 0 to 1.
    exponent : float or ndarray of float64, shape (K,)
        Phong's exponent, 0 to 1e8.

    Raises
    ------
    GlossError
        A parameter is out of its range.

    Examples
    --------
    >>> Phong(0.5, 50).albedo([0.0, 60.0]).round(4).tolist()
    [0.5, 0.25]
    """

    rho_s: Parameter
    exponent: Parameter

    def __post_init__(self) -> None:
        object.__setattr__(self, "rho_s", as_channels(self.rho_s, name="rho_s", least=0, most=1))
        exponent = as_channels(self.exponent, name="exponent", least=0, most=LARGEST_EXPONENT)
        object.__setattr__(self, "exponent", exponent)
        _ = self.channels

    @property
    def channels(self) -> int | None:
        """Number of wavelengths or paints, None if every parameter is one number."""
        return common_channels(rho_s=self.rho_s, exponent=self.exponent)

    def evaluate(self, incident: ArrayLike, exitant: ArrayLike) -> FloatArray:
        """BRDF (1/sr) of the lobe; see `ReflectanceModel.evaluate`."""
        half = half_vector(incident, exitant, self.channels)
        lobe = over_channels(_log_cos_gamma(incident, exitant), self.channels)
        return half.reflected(self.rho_s * (self.exponent + 2) / (2 * np.pi) * _power(lobe, self.exponent))

    def draw(self, incident: ArrayLike, u: ArrayLike) -> FloatArray:
        """Exitant directions of density cosγ^exponent around the mirror direction; some may lie below the horizon."""
        require_one_roughness(exponent=self.exponent)
        first, second = as_uniforms(u)
        # 1 − cosγ keeps its digits in narrow lobes.
        drop = -np.expm1(np.log1p(-first) / (self.exponent + 1))
        return _around_mirror(as_directions(incident, name="incident"), drop, 2 * np.pi * second)

    def pdf(self, incident: ArrayLike, exitant: ArrayLike) -> FloatArray:
        """Density (1/sr) of `draw`."""
        require_one_roughness(exponent=self.exponent)
        half = half_vector(incident, exitant)
        lobe = _power(_log_cos_gamma(incident, exitant), self.exponent)
        return half.reflected((self.exponent + 1) / (2 * np.pi) * lobe)

    def albedo(self, theta_deg: ArrayLike, *, phi_deg: ArrayLike = 0.0) -> FloatArray:
        """Directional-hemispherical reflectance by converged quadrature around the mirror direction."""
        theta, _ = as_angles(theta_deg, phi_deg)
        results = [converged(partial(self._estimate, direction(angle))) for angle in theta.flat]
        return np.reshape(results, theta.shape + (() if self.channels is None else (self.channels,)))[()]

    def _estimate(self, incident: FloatArray, order: int) -> FloatArray:
        sine, cosine = np.hypot(incident[0], incident[1]), incident[2]
        # Half a turn around the mirror direction, away from the horizon and then towards it.
        quarter, quarter_weights = panels(geometric_breaks(cosine, np.pi / 2), order)
        turn = np.pi / 2 + np.concatenate([-quarter, quarter])
        towards = np.maximum(-np.cos(turn), 0) * sine
        reach = np.arctan2(cosine, towards)  # the angle γ at which the ray meets the horizon; 90° where it never does
        width = 1 / np.sqrt(float(np.max(self.exponent)) + 1)
        share, share_weights = panels(geometric_breaks(min(width, 1.0), 1.0), order)
        gamma = reach[:, None] * share
        exitant = _around_mirror(incident, 2 * np.sin(gamma / 2) ** 2, np.broadcast_to(turn[:, None], gamma.shape))
        weights = reach[:, None] * share_weights * np.sin(gamma) * np.maximum(exitant[..., 2], 0)
        weights *= 2 * np.tile(quarter_weights, 2)[:, None]
        return np.tensordot(weights, self.evaluate(incident, exitant), axes=([0, 1], [0, 1]))


def _log_cos_gamma(incident: ArrayLike, exitant: ArrayLike) -> FloatArray:
    """ln cosγ, from the distance between exitant and mirror direction, which keeps its digits; −inf beyond 90°."""
    i, o = as_directions(incident, name="incident"), as_directions(exitant, name="exitant")
    distance2 = np.sum((o - i * [-1, -1, 1]) ** 2, axis=-1)
    with np.errstate(divide="ignore"):
        return np.log1p(-np.minimum(distance2 / 2, 1))


def _power(log_cosine: FloatArray, exponent: FloatArray) -> FloatArray:
    """cosγ^exponent, zero beyond 90° even for exponent zero."""
    with np.errstate(invalid="ignore"):  # 0 · −inf
        return np.where(log_cosine == -np.inf, 0.0, np.exp(exponent * log_cosine))


def _around_mirror(incident: FloatArray, drop: FloatArray, turn: FloatArray) -> FloatArray:
    """Unit directions at 1 − cosγ = `drop` from the mirror direction, turned around it; zero turns up to the normal."""
    x, y, z = (incident[..., axis] for axis in range(3))
    sine = np.hypot(x, y)
    upright = sine == 0
    safe = np.where(upright, 1.0, sine)
    cos_phi, sin_phi = np.where(upright, -1.0, -x / safe), np.where(upright, 0.0, -y / safe)
    mirror = np.stack([sine * cos_phi, sine * sin_phi, z], axis=-1)
    upward = np.stack([-z * cos_phi, -z * sin_phi, sine], axis=-1)
    aside = np.stack([-sin_phi, cos_phi, np.zeros_like(z)], axis=-1)
    sin_gamma = np.sqrt(drop * (2 - drop))
    return (
        (1 - drop)[..., None] * mirror
        + (sin_gamma * np.cos(turn))[..., None] * upward
        + (sin_gamma * np.sin(turn))[..., None] * aside
    )
