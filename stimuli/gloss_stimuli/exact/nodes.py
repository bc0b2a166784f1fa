"""Where the walls' irradiance is unknown: n × n Gauss–Legendre nodes a cell, and the polynomials through them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.exact.compiled import compiled
from gloss_stimuli.exact.room import Room

__all__ = ["Nodes", "gauss_legendre", "lagrange", "make_nodes", "wall_points"]


@dataclass(frozen=True)
class Nodes:
    """Quadrature nodes of all cells; node ``cell n² + b n + a`` is the (a, b)-th of its cell.

    Attributes
    ----------
    order : int
        n, nodes along a side of a cell.
    abscissae, weights_1d : array, shape (n,)
        Of Gauss–Legendre's rule on [0, 1].
    powers : array, shape (n, n)
        Lagrange polynomial m is ``Σ_k powers[m, k] u^k``.
    points : array, shape (N, 3)
    weights : array, shape (N,)
        Area that each node stands for.
    wall, cell : array of int, shape (N,)
    reflectance : array, shape (N,)
    """

    order: int
    abscissae: NDArray[np.float64]
    weights_1d: NDArray[np.float64]
    powers: NDArray[np.float64]
    points: NDArray[np.float64]
    weights: NDArray[np.float64]
    wall: NDArray[np.int64]
    cell: NDArray[np.int64]
    reflectance: NDArray[np.float64]

    def values_at(self, u: NDArray[np.float64]) -> NDArray[np.float64]:
        """Lagrange polynomials at `u`, shape (len(u), n)."""
        return np.vander(u, self.order, increasing=True) @ self.powers.T


def gauss_legendre(count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Nodes and weights of Gauss–Legendre's rule on [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(count)
    return np.asarray((x + 1) / 2, dtype=np.float64), np.asarray(w / 2, dtype=np.float64)


def make_nodes(room: Room, order: int) -> Nodes:
    """Nodes of a room, n × n a cell."""
    x, w = gauss_legendre(order)
    powers = np.ascontiguousarray(np.linalg.inv(np.vander(x, order, increasing=True)).T, dtype=np.float64)
    points, sides = wall_points(room, x)
    cell = np.repeat(np.arange(len(room.cell_wall)), order * order)
    weights = (sides.prod(1)[:, None, None] * w[:, None] * w).reshape(-1)
    return Nodes(
        order, x, w, powers, points.reshape(-1, 3), weights, room.cell_wall[cell], cell, room.reflectance[cell]
    )


def wall_points(room: Room, u: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points of each cell at the grid `u` × `u` of its own coordinates, shape (C, b, a, 3), and its sides (C, 2)."""
    sides = room.cell_high - room.cell_low
    points = np.empty((len(sides), len(u), len(u), 3))
    for wall in range(6):
        cells = slice(room.wall_start[wall], room.wall_start[wall + 1])
        axis = wall // 2
        along = room.cell_low[cells, :, None] + sides[cells, :, None] * u
        points[cells, ..., axis] = (room.box.low, room.box.high)[wall % 2][axis]
        points[cells, ..., (axis + 1) % 3] = along[:, 0, None, :]
        points[cells, ..., (axis + 2) % 3] = along[:, 1, :, None]
    return points, sides


@compiled
def lagrange(powers: NDArray[np.float64], u: float, out: NDArray[np.float64]) -> None:
    """Values of the Lagrange polynomials at `u`."""
    n = powers.shape[0]
    for m in range(n):
        value = 0.0
        for k in range(n - 1, -1, -1):
            value = value * u + powers[m, k]
        out[m] = value
