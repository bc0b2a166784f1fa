"""Directions drawn from a table of reflectances: a cell by what it reflects, then a direction within it."""

from dataclasses import dataclass

import numpy as np

from glossspace.metric.validity import FloatArray
from glossspace.reflectance.lambert import cosine_direction
from glossspace.reflectance.model import ReflectanceModel, direction

__all__ = ["TableSampler", "table_sampler"]

# So that no direction of an empty-looking cell is left out: interpolation reaches into it from its neighbours.
COSINE_SHARE = 0.2


@dataclass(frozen=True)
class TableSampler:
    """Densities of cells of the hemisphere, constant within each, for a list of angles of incidence.

    Attributes
    ----------
    theta_incident_deg : ndarray of float64, shape (I,)
        Angles of incidence; the nearest one counts.
    cos_edges : ndarray of float64, shape (T + 1,)
        Cosines of the cells' polar limits, descending from 1 to 0.
    phi_edges : ndarray of float64, shape (P + 1,)
        The cells' azimuths relative to the incident one's, in radians, from 0 to 2π.
    shares : ndarray of float64, shape (I, T * P)
        Share of draws that falls into each cell, the cosine's share apart.
    """

    theta_incident_deg: FloatArray
    cos_edges: FloatArray
    phi_edges: FloatArray
    shares: FloatArray

    def draw(self, incident: FloatArray, first: FloatArray, second: FloatArray) -> FloatArray:
        """Exitant unit directions (..., 3) from incident ones and two uniform numbers."""
        shape = np.broadcast_shapes(incident.shape[:-1], first.shape)
        i = np.broadcast_to(incident, (*shape, 3)).reshape(-1, 3)
        u, v = (np.broadcast_to(number, shape).ravel() for number in (first, second))
        by_cosine = u < COSINE_SHARE
        exitant = cosine_direction(np.where(by_cosine, u / COSINE_SHARE, 0.0), v)
        again = (u - COSINE_SHARE) / (1 - COSINE_SHARE)
        row = self._nearest(i)
        for index in np.unique(row[~by_cosine]):
            picked = (row == index) & ~by_cosine
            ends = np.cumsum(self.shares[index])
            ends /= ends[-1]
            cell = np.searchsorted(ends, again[picked], side="right")
            share = self.shares[index][cell]
            # Rounding may leave the interval by its last digit.
            within = np.clip((again[picked] - (ends[cell] - share)) / share, 0, np.nextafter(1, 0))
            t, p = np.divmod(cell, self.phi_edges.size - 1)
            cosine = self.cos_edges[t] + v[picked] * (self.cos_edges[t + 1] - self.cos_edges[t])
            phi = self.phi_edges[p] + within * (self.phi_edges[p + 1] - self.phi_edges[p])
            phi = phi + np.arctan2(i[picked, 1], i[picked, 0])
            sine = np.sqrt((1 - cosine) * (1 + cosine))
            exitant[picked] = np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine], axis=-1)
        return exitant.reshape(*shape, 3)

    def pdf(self, incident: FloatArray, exitant: FloatArray) -> FloatArray:
        """Density (1/sr) of `draw` for directions (..., 3) above the horizon."""
        phi = (np.arctan2(exitant[..., 1], exitant[..., 0]) - np.arctan2(incident[..., 1], incident[..., 0])) % (
            2 * np.pi
        )
        t = np.clip(np.searchsorted(-self.cos_edges, -exitant[..., 2], side="right") - 1, 0, self.cos_edges.size - 2)
        p = np.clip(np.searchsorted(self.phi_edges, phi, side="right") - 1, 0, self.phi_edges.size - 2)
        solid_angles = (self.cos_edges[t] - self.cos_edges[t + 1]) * (self.phi_edges[p + 1] - self.phi_edges[p])
        share = self.shares[self._nearest(incident), t * (self.phi_edges.size - 1) + p]
        return COSINE_SHARE * exitant[..., 2] / np.pi + (1 - COSINE_SHARE) * share / solid_angles

    def _nearest(self, incident: FloatArray) -> np.ndarray:
        middles = (self.theta_incident_deg[1:] + self.theta_incident_deg[:-1]) / 2
        theta = np.degrees(np.arccos(np.clip(incident[..., 2], -1, 1)))
        return np.searchsorted(middles, theta)


def table_sampler(
    model: ReflectanceModel, theta_incident_deg: FloatArray, theta_exitant_deg: FloatArray, phi_deg: FloatArray
) -> TableSampler:
    """Cells between the given angles (degrees), weighted by what the model reflects into their middles.

    Raises
    ------
    GlossError
        The model cannot be evaluated over the whole hemisphere.
    """
    theta = np.union1d(theta_exitant_deg, [0.0, 90.0])
    middle_theta, middle_phi = (theta[1:] + theta[:-1]) / 2, (phi_deg[1:] + phi_deg[:-1]) / 2
    exitant = direction(middle_theta[:, None], middle_phi)
    cosine = np.cos(np.radians(theta))
    size = (cosine[:-1] ** 2 - cosine[1:] ** 2)[:, None] * np.diff(phi_deg)
    rows = []
    for angle in theta_incident_deg:
        # At 90° itself nothing is reflected; the density there serves the angles just below.
        value = model.evaluate(direction(min(angle, 89.999)), exitant)
        value = value if model.channels is None else value.mean(axis=-1)
        mass = (value * size).ravel()
        mass = mass if mass.sum() > 0 else size.ravel()
        rows.append(mass / mass.sum())
    return TableSampler(theta_incident_deg, cosine, np.radians(phi_deg), np.array(rows))
