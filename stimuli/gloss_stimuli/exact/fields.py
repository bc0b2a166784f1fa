"""The irradiance fields of the room: the coefficient of each power of ρd and ρs, at the nodes of the walls and on a
grid of the sphere.

Light that has met the sphere i times diffusely and j times specularly makes the fields E_ij of the walls and H_ij of
the sphere. With K the exchange among walls past the sphere, D from the sphere's diffuse light to the walls, S from its
specular light, e and h the light itself, and ρ the checks::

    E00 = K ρE00 + e                         H_ij = (walls to sphere) ρE_ij,  H00 also + h
    E10 = K ρE10 + D H00                     E01 = K ρE01 + S ρE00 + (light by way of the lobe)
    E20 = K ρE20 + D H10                     E11 = K ρE11 + D H01 + S ρE10
    E30 = K ρE30 + D H20                     E02 = K ρE02 + S ρE01

Each return to the sphere keeps a small part of the light, and what has returned often has forgotten where it came from:
from the third order on the series is taken as geometric (`Fields.returned`); of mixed kinds, from the second.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.exact.direct import light_on_sphere, light_on_walls
from gloss_stimuli.exact.exchange import apply_matrix, edge_rule, exchange_matrix
from gloss_stimuli.exact.levels import Level
from gloss_stimuli.exact.nodes import Nodes, gauss_legendre, make_nodes, wall_points
from gloss_stimuli.exact.room import Room
from gloss_stimuli.exact.specular import light_by_sphere, walls_by_sphere
from gloss_stimuli.exact.sphere import hide_walls, sphere_grid, sphere_to_walls, walls_to_sphere

__all__ = ["FieldSolver", "Fields"]

# Relative change at which the sum over reflections is complete: far below anything a display shows.
TOLERANCE = 1e-7
MOST_REFLECTIONS = 400


@dataclass(frozen=True)
class Fields:
    """Irradiance coefficients at the nodes.

    Attributes
    ----------
    walls : array, shape (N, 4) or (N, 3)
        At the nodes of the walls, the light included. Columns are E00, E10, E20, E30, or E01, E11, E02.
    returned : float
        Ratio in which one more return to the sphere reduces the last field of pure kind: E30, or E02.
    """

    walls: NDArray[np.float64]
    returned: float


class FieldSolver:
    """Solves the fields of one room; the diffuse ones serve every α.

    Parameters
    ----------
    room : Room
    level : Level
        How finely.
    seed : numpy.random.SeedSequence
        Of the lattices' shifts.
    form : str
        Of the lobe.
    """

    def __init__(self, room: Room, level: Level, seed: np.random.SeedSequence, form: str) -> None:
        self.room, self.level, self.form = room, level, form
        self.nodes = make_nodes(room, level.nodes)
        # One stream a purpose, none of them shared between roughnesses: any α may be added later and come out the same.
        hidden, returned, self._lobe_seed = seed.spawn(3)
        count = len(self.nodes.points)
        self._matrix = exchange_matrix(room, self.nodes, edge_rule(level.edge_points))
        hide_walls(room, self.nodes, np.random.default_rng(hidden).random((count, 2)), level.cone_rays, self._matrix)
        self._returned_shifts = np.random.default_rng(returned).random((count, 2))
        grid = sphere_grid(level.sphere_rows)
        self._normals, self._grid = grid.reshape(-1, 3), grid.shape[:2]
        self.light_at_nodes = _projected_light(room, self.nodes, level.light_lines)
        self.diffuse = self._solve_diffuse()

    def _solve_diffuse(self) -> Fields:
        e00 = self._exchange(self.light_at_nodes[:, None])
        h00 = self._on_sphere(e00) + light_on_sphere(self.room, self._normals)[:, None]
        e10 = self._exchange(self._return(h00))
        h10 = self._on_sphere(e10)
        e20 = self._exchange(self._return(h10))
        h20 = self._on_sphere(e20)
        e30 = self._exchange(self._return(h20))
        return Fields(np.hstack([e00, e10, e20, e30]), self._ratio(self._on_sphere(e30), h20))

    def specular(self, alpha: float) -> Fields:
        """Fields of the lobe with roughness `alpha`."""
        e00, e10, _, _ = self.diffuse.walls.T[:, :, None]
        # The same numbers for every α: noise that stimuli share does not tell them apart.
        shifts = np.random.default_rng(self._lobe_seed).random((len(e00), 4))

        def from_walls(samples: int, irradiance: NDArray[np.float64]) -> NDArray[np.float64]:
            lit = self._lit(irradiance)
            return walls_by_sphere(
                self.room, self.nodes, shifts, samples, alpha=alpha, form=self.form, radiosity=lit
            )  # fmt: skip

        first = from_walls(self.level.lobe_samples, np.hstack([e00, e10]))
        light = light_by_sphere(
            self.room, self.nodes, shifts, self.level.lobe_samples // 2, alpha=alpha, form=self.form
        )  # fmt: skip
        e01 = self._exchange(first[:, :1] + light[:, None])
        # Of second order, hence small: an eighth of the samples is plenty.
        second = from_walls(self.level.lobe_samples // 8, e01)
        h01 = self._on_sphere(e01)
        e11, e02 = self._exchange(np.hstack([self._return(h01) + first[:, 1:], second])).T[:, :, None]
        return Fields(np.hstack([e01, e11, e02]), self._ratio(self._on_sphere(e02), h01))

    def _ratio(self, later: NDArray[np.float64], earlier: NDArray[np.float64]) -> float:
        """Part of the sphere's mean irradiance that is left after one more return."""
        # A row of the grid is a ring of the sphere, whose area goes as the sine of its polar angle.
        area = np.hypot(self._normals[:, 0], self._normals[:, 2])
        total = float(area @ earlier[:, 0])
        return float(area @ later[:, 0]) / total if total > 0 else 0.0

    def _lit(self, irradiance: NDArray[np.float64]) -> NDArray[np.float64]:
        return irradiance * self.nodes.reflectance[:, None]

    def _exchange(self, source: NDArray[np.float64]) -> NDArray[np.float64]:
        """Sum over all reflections between walls: E = K ρE + source."""
        total, last = source, source
        scale = np.abs(source).max(0) + np.finfo(float).tiny
        for _ in range(MOST_REFLECTIONS):
            last = apply_matrix(self._matrix, self._lit(last))
            total = total + last
            if (np.abs(last).max(0) <= TOLERANCE * scale).all():
                break
        else:
            raise FloatingPointError(f"Light between the walls has not died away after {MOST_REFLECTIONS} reflections.")
        if not np.isfinite(total).all():
            raise FloatingPointError("The irradiance of the walls came out not finite.")
        return total

    def _on_sphere(self, irradiance: NDArray[np.float64]) -> NDArray[np.float64]:
        return walls_to_sphere(self.room, self._normals, self.nodes, self._lit(irradiance))

    def _return(self, sphere: NDArray[np.float64]) -> NDArray[np.float64]:
        texture = np.ascontiguousarray(sphere.reshape(*self._grid, -1))
        return sphere_to_walls(self.room, self.nodes, self._returned_shifts, self.level.cone_rays // 4, texture)


def _projected_light(room: Room, nodes: Nodes, lines: int) -> NDArray[np.float64]:
    """The light's irradiance as the best-fitting polynomials of each cell: a shadow's edge keeps its flux."""
    x, w = gauss_legendre(2 * nodes.order)
    points, _ = wall_points(room, x)
    wall = np.repeat(room.cell_wall, len(x) ** 2)
    light = light_on_walls(room, points.reshape(-1, 3), wall, lines=lines).reshape(len(room.cell_wall), len(x), len(x))
    # Lagrange polynomials at Gauss points are orthogonal, so the fit is a sum.
    project = nodes.values_at(x).T * w / nodes.weights_1d[:, None]
    fitted: NDArray[np.float64] = np.einsum("bj,ai,cji->cba", project, project, light)
    return fitted.reshape(-1)
