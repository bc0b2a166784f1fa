"""Whether a model's draws follow its density: a chi² test over cells that fit lobes of any width.

An exitant direction above the horizon is the half vector's slope, in polar coordinates around the normal. A ray of
slopes ends at the horizon (see `slope_quadrature`); the inverse hyperbolic sine of its radius, in units of the
narrowest slopes drawn, is cut into equal cells. So a lobe of α = .001 and a Lambertian base beneath it both meet many.
"""

from itertools import pairwise

import numpy as np
from scipy.special import chdtrc

from glossspace.metric.validity import FloatArray
from glossspace.reflectance.half_vector import mirrored_at_slopes
from glossspace.reflectance.model import ReflectanceModel, direction
from glossspace.reflectance.slope_quadrature import gauss_legendre, geometric_breaks, radius_at_horizon

__all__ = ["sampling_p_value"]

_RADIAL_CELLS, _CELLS_A_PANEL, _ORDER = 20, 4, 16
_LEAST_EXPECTED = 5.0  # the usual rule for chi²; smaller cells are pooled


def sampling_p_value(model: ReflectanceModel, theta_deg: float, exitant: FloatArray) -> float:
    """Probability of a chi² as large as that of these draws, if they follow the model's density.

    Parameters
    ----------
    model : ReflectanceModel
        Its `pdf` is tested.
    theta_deg : float
        Angle of incidence, 0 to below 90 degrees, at azimuth zero.
    exitant : ndarray of float64, shape (N, 3)
        Draws for this incidence, some ten thousand. Those below the horizon are one cell, whose share the density
        leaves to them.

    Returns
    -------
    float
        The p-value; 0 if the density integrates to more than one.
    """
    incident = direction(theta_deg)
    above = exitant[:, 2] > 0
    radius, turn = _polar_slopes(incident, exitant[above])
    unit = max(float(np.quantile(radius, 0.005)), 1e-9) if above.any() else 1.0
    tilt = incident[0] / incident[2]
    turn_edges = _turn_edges(tilt)
    expected = _masses(model, incident, unit, turn_edges)
    below = 1 - expected.sum()
    if below < -1e-3:  # what Gauss and Legendre miss at the edges of a density that has some
        return 0.0
    row = np.clip(np.searchsorted(turn_edges, turn, side="right") - 1, 0, turn_edges.size - 2)
    share = np.arcsinh(radius / unit) / np.arcsinh(radius_at_horizon(tilt * np.cos(turn)) / unit)
    column = np.clip((share * _RADIAL_CELLS).astype(int), 0, _RADIAL_CELLS - 1)
    observed = np.bincount(row * _RADIAL_CELLS + column, minlength=expected.size)
    return _pooled_p_value(
        np.append(observed, np.count_nonzero(~above)), np.append(expected, max(below, 0.0)) * len(exitant)
    )


def _polar_slopes(incident: FloatArray, exitant: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Radius and azimuth, from −π/2 to 3π/2, of the half vectors' slopes."""
    x, y, z = np.moveaxis(incident + exitant, -1, 0)
    return np.hypot(x, y) / z, (np.arctan2(y, x) + np.pi / 2) % (2 * np.pi) - np.pi / 2


def _turn_edges(tilt: float) -> FloatArray:
    """Azimuths between the cells: dense around ±90°, where rays of slopes turn from long to short at grazing."""
    breaks = geometric_breaks(1 / max(tilt, 1e-300), np.pi / 2)
    quarter = np.concatenate([np.linspace(*pair, _CELLS_A_PANEL + 1)[:-1] for pair in pairwise(breaks)])
    half = np.concatenate([quarter, np.pi - np.append(quarter, np.pi / 2)[::-1]])
    return np.concatenate([half - np.pi / 2, half[1:] + np.pi / 2])


def _masses(model: ReflectanceModel, incident: FloatArray, unit: float, turn_edges: FloatArray) -> FloatArray:
    """Integral of the density over each cell, row by row of azimuths."""
    nodes, weights = gauss_legendre(_ORDER)
    turn = (turn_edges[:-1, None] + np.diff(turn_edges)[:, None] * nodes).ravel()
    turn_weights = (np.diff(turn_edges)[:, None] * weights).ravel()
    s_end = np.arcsinh(radius_at_horizon(incident[0] / incident[2] * np.cos(turn)) / unit)
    share = ((np.arange(_RADIAL_CELLS)[:, None] + nodes) / _RADIAL_CELLS).ravel()
    s = s_end[:, None] * share
    radius, step = (
        unit * np.sinh(s),
        unit * np.cosh(s) * s_end[:, None] * np.tile(weights, _RADIAL_CELLS) / _RADIAL_CELLS,
    )
    slope_x, slope_y = radius * np.cos(turn)[:, None], radius * np.sin(turn)[:, None]
    exitant = mirrored_at_slopes(incident, slope_x, slope_y)
    length = np.sqrt(1 + radius**2)
    solid_angle = 4 * (slope_x * incident[0] + incident[2]) / length**4 * radius * step * turn_weights[:, None]
    mass = model.pdf(incident, exitant) * solid_angle
    return mass.reshape(turn_edges.size - 1, _ORDER, _RADIAL_CELLS, _ORDER).sum(axis=(1, 3)).ravel()


def _pooled_p_value(observed: FloatArray, expected: FloatArray) -> float:
    small = expected < _LEAST_EXPECTED
    pooled_observed = np.append(observed[~small], observed[small].sum())
    pooled_expected = np.append(expected[~small], expected[small].sum())
    if pooled_expected[-1] < _LEAST_EXPECTED:
        # What is expected nowhere: its draws are judged together with the least of the others.
        if pooled_expected.size == 1:
            return 1.0
        least = int(np.argmin(pooled_expected[:-1]))
        pooled_observed[least] += pooled_observed[-1]
        pooled_expected[least] += pooled_expected[-1]
        pooled_observed, pooled_expected = pooled_observed[:-1], pooled_expected[:-1]
    statistic = float(np.sum((pooled_observed - pooled_expected) ** 2 / pooled_expected))
    return float(chdtrc(max(pooled_expected.size - 1, 1), statistic))
