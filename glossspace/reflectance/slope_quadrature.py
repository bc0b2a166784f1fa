"""Directional-hemispherical reflectance of a lobe around the half vector, by quadrature over facet slopes.

Over slopes (p, q) of the half vector, dω_o = 4 (h·i) cos³δ dp dq. The slopes that send light from θ above the horizon
form a disk, ``(p − tanθ)² + q² < 1/cos²θ`` with the incidence along p. The origin lies inside, so every ray from it
leaves the disk once. In polar coordinates whose unit is the lobe's width the integrand is smooth between the folds of
the model, such as those of the V-grooves' attenuation, at which rays are cut; a substitution removes the square root
that Ward's form has at the horizon. The order of Gauss and Legendre is doubled until two results agree.
"""

from collections.abc import Callable
from functools import cache, partial

import numpy as np
from numpy.typing import ArrayLike

from glossspace.metric.validity import FloatArray
from glossspace.reflectance.half_vector import mirrored_at_slopes
from glossspace.reflectance.model import ReflectanceModel, as_angles, direction

__all__ = [
    "GAUSSIAN_EXTENT",
    "Folds",
    "converged",
    "gauss_legendre",
    "geometric_breaks",
    "lobe_albedo",
    "panels",
    "radius_at_horizon",
]

GAUSSIAN_EXTENT = 6.5
"""Multiple of its width beyond which a Gaussian lobe holds less than 1e-18."""

Folds = Callable[[float, FloatArray], FloatArray]
"""From polar angle of incidence and azimuths (N,) of rays to (F, N) slopes at which the integrand has an edge."""

_TOLERANCE = 1e-8
_ORDERS = (16, 32, 64, 128)


def lobe_albedo(
    model: ReflectanceModel,
    theta_deg: ArrayLike,
    phi_deg: ArrayLike,
    *,
    widths: tuple[float, float],
    extent: float = np.inf,
    folds: Folds | None = None,
) -> FloatArray:
    """Albedo of a model whose lobe follows the half vector.

    Parameters
    ----------
    model : ReflectanceModel
        What is integrated, by its `evaluate`.
    theta_deg, phi_deg : array_like
        Polar angle, 0 to below 90, and azimuth of incidence in degrees; they broadcast.
    widths : tuple of float
        Slopes along x and y over which the lobe varies.
    extent : float
        Multiple of the widths beyond which the lobe holds nothing; infinite for one with long tails.
    folds : callable, optional
        Where an isotropic model has edges: see `Folds`.

    Returns
    -------
    ndarray of float64, shape (...) or (..., K)
        Albedo.
    """
    theta, phi = as_angles(theta_deg, phi_deg)
    incidents = (direction(*angles) for angles in zip(theta.flat, phi.flat, strict=True))
    results = [converged(partial(_estimate, model, incident, widths, extent, folds)) for incident in incidents]
    return np.reshape(results, theta.shape + (() if model.channels is None else (model.channels,)))[()]


def converged(estimate: Callable[[int], FloatArray]) -> FloatArray:
    """The estimate of the first order of Gauss and Legendre's rule that agrees with half that order, or of the last."""
    previous = estimate(_ORDERS[0])
    for order in _ORDERS[1:]:
        current = estimate(order)
        if np.all(np.abs(current - previous) <= _TOLERANCE * np.abs(current)):
            break
        previous = current
    return current


def _estimate(
    model: ReflectanceModel,
    incident: FloatArray,
    widths: tuple[float, float],
    extent: float,
    folds: Folds | None,
    order: int,
) -> FloatArray:
    width_x, width_y = widths
    tilt_x, tilt_y = width_x * incident[0] / incident[2], width_y * incident[1] / incident[2]
    tilt = np.hypot(tilt_x, tilt_y)
    # Within this angle, rays turn from leaving the disk far away to leaving it nearby.
    turn = min(width_x, width_y) / max(tilt, 1e-300)
    quarter, quarter_weights = panels(geometric_breaks(turn, np.pi / 2), order)
    turned = np.concatenate([sign * np.pi / 2 + side * quarter for sign in (1, -1) for side in (1, -1)])
    angle = np.arctan2(tilt_y, tilt_x) + turned
    along_x, along_y = width_x * np.cos(angle), width_y * np.sin(angle)
    across2 = along_x**2 + along_y**2
    forward = (along_x * incident[0] + along_y * incident[1]) / incident[2]
    ends = np.minimum(radius_at_horizon(forward, across2), extent)[None]
    if folds is not None:
        inner = folds(float(np.arccos(incident[2])), turned) / width_x
        ends = np.sort(np.concatenate([np.where(inner > 0, np.minimum(inner, ends), 0), ends]), axis=0)
    # radius = sinh(s) resolves core and tail alike; t → 1 − (1 − t)² smooths a square root at the end of a piece.
    stops = np.arcsinh(np.concatenate([np.zeros_like(ends[:1]), ends]))
    starts, lengths = stops[:-1].T[..., None], np.diff(stops, axis=0).T[..., None]
    t, t_weights = gauss_legendre(order)
    s = starts + lengths * (1 - (1 - t) ** 2)
    radial = (lengths * 2 * (1 - t) * t_weights * np.cosh(s) * np.sinh(s)).reshape(len(angle), -1)
    radius = np.sinh(s).reshape(len(angle), -1)
    slope_x, slope_y = radius * along_x[:, None], radius * along_y[:, None]
    exitant = mirrored_at_slopes(incident, slope_x, slope_y)
    length = np.sqrt(1 + slope_x**2 + slope_y**2)
    half_dot_i = (slope_x * incident[0] + slope_y * incident[1] + incident[2]) / length
    measure = 4 * half_dot_i / length**3 * np.maximum(exitant[..., 2], 0) * width_x * width_y
    weights = measure * radial * np.tile(quarter_weights, 4)[:, None]
    used = weights > 0  # pieces without length, and what rounding puts below the horizon
    return weights[used] @ model.evaluate(incident, exitant[used])


def radius_at_horizon(forward: FloatArray, across2: FloatArray | float = 1.0) -> FloatArray:
    """Radius at which a ray of facet slopes leaves the disk: the positive root of across2 r² − 2 forward r = 1.

    `forward` is the ray's step times the slope of the incident direction, `across2` the step's squared length.
    """
    root = np.sqrt(forward**2 + across2)
    # The second form does not cancel for rays that point away from the light.
    return np.where(forward > 0, (forward + root) / across2, 1 / np.where(forward > 0, 1, root - forward))


def geometric_breaks(first: float, last: float) -> FloatArray:
    """Ends of panels from 0 to `last`, of which each is four times as long as the one before, from `first` on."""
    breaks = [0.0]
    while first < last / 2:
        breaks.append(first)
        first *= 4
    return np.array([*breaks, last])


def panels(breaks: FloatArray, order: int) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights of Gauss and Legendre's rule on every panel between `breaks`, in ascending order."""
    nodes, weights = gauss_legendre(order)
    lengths = np.diff(breaks)[:, None]
    return (breaks[:-1, None] + lengths * nodes).ravel(), (lengths * weights).ravel()


@cache
def gauss_legendre(order: int) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights of Gauss and Legendre's rule on 0 to 1."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    return (nodes + 1) / 2, weights / 2
