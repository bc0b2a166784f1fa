"""Light from wall to wall in the empty box: the matrix K with E(x) = Σ_j K_j(x) ρ_j E_j, sphere and light left aside.

Far from a source cell its nodes are plain Gauss points. Near a cell of a perpendicular wall the kernel cosθ cosθ'/(π
r²) peaks towards the common edge, so each polynomial of the cell is integrated against it exactly to rounding (*product
integration*): with ε the distance of the point from the source's plane and δ that of the source from the point's plane,
the substitutions δ = ε sinh u, and x = ε cosh u tan t along the edge, leave the smooth integrand ``sinh u cos² t / (π
cosh² u)``. Points of one wall do not see each other.
"""

import math

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.exact.compiled import compiled, for_rows
from gloss_stimuli.exact.nodes import Nodes, gauss_legendre, lagrange
from gloss_stimuli.exact.room import Box, Room, coordinate

__all__ = ["EdgeRule", "apply_matrix", "edge_rule", "exchange_matrix", "from_edge_cells"]

# A cell is near within this many of its own widths; beyond, plain Gauss errs by less than product integration's tables.
NEAR_WIDTHS = 1.25
# Points closer to a source's plane than this many cell widths are taken there: the integral has a limit.
SMALLEST_HEIGHT = 2e-4

EdgeRule = tuple[NDArray[np.float64], NDArray[np.float64]]


def edge_rule(points: int) -> EdgeRule:
    """Gauss–Legendre rule of product integration, along both substituted coordinates."""
    return gauss_legendre(points)


def exchange_matrix(room: Room, nodes: Nodes, rule: EdgeRule) -> NDArray[np.float32]:
    """Matrix of the empty box, shape (N, N): irradiance at node i from radiosity ρE at node j."""
    matrix = np.zeros((len(nodes.points), len(nodes.points)), np.float32)
    for_rows(
        _exchange_rows, len(nodes.points), room, nodes.points, nodes.wall, nodes.weights, nodes.powers, *rule, matrix
    )
    return matrix


def from_edge_cells(
    room: Room,
    nodes: Nodes,
    rule: EdgeRule,
    points: NDArray[np.float64],
    wall: NDArray[np.int64],
    radiosity: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Irradiance at `points` from the cells that meet the point's own wall, shape (P, K): the part with kinks at edges.

    Parameters
    ----------
    points, wall : array, shape (P, 3) and (P,)
        Points on walls.
    radiosity : array, shape (N, K)
        ρE at the nodes, several fields at a time.
    """
    out = np.zeros((len(points), radiosity.shape[1]))
    for_rows(
        _edge_cell_rows, len(points), room, points, wall, nodes.points, nodes.weights, nodes.powers, *rule,
        np.ascontiguousarray(radiosity), out,
    )  # fmt: skip
    return out


def apply_matrix(matrix: NDArray[np.float32], vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Product of a float32 matrix and a few float64 vectors, shape (N, K); the same bits for any number of threads."""
    out = np.empty((len(matrix), vectors.shape[1]))
    for_rows(_product_rows, len(matrix), matrix, np.ascontiguousarray(vectors.T), out)
    return out


@compiled
def relative_distance(
    box: Box, px: float, py: float, pz: float, wall: int, low_a: float, low_b: float, high_a: float, high_b: float
) -> float:
    """Distance of a point from a cell of `wall`, in widths of that cell."""
    axis = wall // 2
    height = coordinate(px, py, pz, axis) - (box.high[axis] if wall % 2 else box.low[axis])
    a, b = coordinate(px, py, pz, (axis + 1) % 3), coordinate(px, py, pz, (axis + 2) % 3)
    beside_a, beside_b = max(low_a - a, a - high_a, 0.0), max(low_b - b, b - high_b, 0.0)
    distance = math.sqrt(height * height + beside_a * beside_a + beside_b * beside_b)
    return distance / max(high_a - low_a, high_b - low_b)


@compiled
def edge_geometry(
    box: Box, px: float, py: float, pz: float, wall: int, other: int,
    low_a: float, low_b: float, high_a: float, high_b: float,
) -> tuple[bool, float, float, float, float, float, bool]:  # fmt: skip
    """Of a cell on the wall `other`, across from a point on `wall`, as product integration needs it.

    Returns whether its coordinate a leads away from the point's wall; the point's height ε over the cell's plane; the
    range of δ; the range of x along the edge, relative to the point; whether the coordinate that leads away falls with
    δ.
    """
    axis, across = wall // 2, other // 2
    a_leads = axis == (across + 1) % 3
    begin, end = (low_a, high_a) if a_leads else (low_b, high_b)
    x0, x1 = (low_b, high_b) if a_leads else (low_a, high_a)
    plane = box.high[across] if other % 2 else box.low[across]
    height = max(abs(coordinate(px, py, pz, across) - plane), SMALLEST_HEIGHT * (end - begin))
    falls = wall % 2 == 1
    nearest = max(box.high[axis] - end if falls else begin - box.low[axis], 0.0)
    along = coordinate(px, py, pz, 3 - axis - across)
    return a_leads, height, nearest, nearest + end - begin, x0 - along, x1 - along, falls


@compiled
def edge_weights(
    box: Box, px: float, py: float, pz: float, wall: int, other: int, low_a: float, low_b: float, high_a: float,
    high_b: float, powers: NDArray[np.float64], x: NDArray[np.float64], w: NDArray[np.float64],
    basis_d: NDArray[np.float64], basis_x: NDArray[np.float64], out: NDArray[np.float64],
) -> None:  # fmt: skip
    """Product-integration weights of the n² nodes of one cell."""
    n = powers.shape[0]
    a_leads, height, d0, d1, x0, x1, falls = edge_geometry(
        box, px, py, pz, wall, other, low_a, low_b, high_a, high_b
    )  # fmt: skip
    out[:] = 0.0
    u0, u1 = math.asinh(d0 / height), math.asinh(d1 / height)
    for i in range(len(x)):
        u = u0 + (u1 - u0) * x[i]
        sinh, cosh = math.sinh(u), math.cosh(u)
        radial = (u1 - u0) * w[i] * sinh / (math.pi * cosh * cosh)
        place = (height * sinh - d0) / (d1 - d0)
        lagrange(powers, 1 - place if falls else place, basis_d)
        reach = height * cosh
        t0, t1 = math.atan(x0 / reach), math.atan(x1 / reach)
        for j in range(len(x)):
            t = t0 + (t1 - t0) * x[j]
            cosine = math.cos(t)
            lagrange(powers, (reach * math.tan(t) - x0) / (x1 - x0), basis_x)
            weight = radial * (t1 - t0) * w[j] * cosine * cosine
            for k in range(n):
                for m in range(n):
                    if a_leads:
                        out[k * n + m] += weight * basis_x[k] * basis_d[m]
                    else:
                        out[k * n + m] += weight * basis_d[k] * basis_x[m]


@compiled
def point_weights(
    px: float, py: float, pz: float, wall: int, other: int, cell: int, sources: NDArray[np.float64],
    areas: NDArray[np.float64], n: int, out: NDArray[np.float64],
) -> None:  # fmt: skip
    """Weights of the n² nodes of one cell as plain Gauss points."""
    axis, across = wall // 2, other // 2
    for k in range(n * n):
        j = cell * n * n + k
        x, y, z = sources[j, 0] - px, sources[j, 1] - py, sources[j, 2] - pz
        r2 = x * x + y * y + z * z
        cosines = abs(coordinate(x, y, z, axis)) * abs(coordinate(x, y, z, across))
        out[k] = areas[j] * cosines / (math.pi * r2 * r2)


@compiled
def _exchange_rows(
    start: int, stop: int, room: Room, points: NDArray[np.float64], wall: NDArray[np.int64],
    areas: NDArray[np.float64], powers: NDArray[np.float64], x: NDArray[np.float64], w: NDArray[np.float64],
    matrix: NDArray[np.float32],
) -> None:  # fmt: skip
    n, box, walls, low, high = powers.shape[0], room.box, room.cell_wall, room.cell_low, room.cell_high
    dark = room.is_light
    basis_d, basis_x, weights = np.empty(n), np.empty(n), np.empty(n * n)
    for i in range(start, stop):
        px, py, pz = points[i, 0], points[i, 1], points[i, 2]
        for cell in range(len(walls)):
            if walls[cell] == wall[i] or dark[cell]:
                continue
            other = (walls[cell], low[cell, 0], low[cell, 1], high[cell, 0], high[cell, 1])
            perpendicular = walls[cell] // 2 != wall[i] // 2
            if perpendicular and relative_distance(box, px, py, pz, *other) < NEAR_WIDTHS:
                edge_weights(box, px, py, pz, wall[i], *other, powers, x, w, basis_d, basis_x, weights)
            else:
                point_weights(px, py, pz, wall[i], walls[cell], cell, points, areas, n, weights)
            for k in range(n * n):
                matrix[i, cell * n * n + k] = weights[k]


@compiled
def _edge_cell_rows(
    start: int, stop: int, room: Room, points: NDArray[np.float64], wall: NDArray[np.int64],
    sources: NDArray[np.float64], areas: NDArray[np.float64], powers: NDArray[np.float64], x: NDArray[np.float64],
    w: NDArray[np.float64], radiosity: NDArray[np.float64], out: NDArray[np.float64],
) -> None:  # fmt: skip
    n, box, walls, low, high = powers.shape[0], room.box, room.cell_wall, room.cell_low, room.cell_high
    edge_cells, dark, fields = room.edge_cells, room.is_light, radiosity.shape[1]
    basis_d, basis_x, weights = np.empty(n), np.empty(n), np.empty(n * n)
    for i in range(start, stop):
        px, py, pz = points[i, 0], points[i, 1], points[i, 2]
        for cell in edge_cells[wall[i]]:
            if cell < 0:
                break
            if dark[cell]:
                continue
            other = (walls[cell], low[cell, 0], low[cell, 1], high[cell, 0], high[cell, 1])
            if relative_distance(box, px, py, pz, *other) < NEAR_WIDTHS:
                edge_weights(box, px, py, pz, wall[i], *other, powers, x, w, basis_d, basis_x, weights)
            else:
                point_weights(px, py, pz, wall[i], walls[cell], cell, sources, areas, n, weights)
            for k in range(n * n):
                for q in range(fields):
                    out[i, q] += weights[k] * radiosity[cell * n * n + k, q]


@compiled
def _product_rows(
    start: int, stop: int, matrix: NDArray[np.float32], vectors: NDArray[np.float64], out: NDArray[np.float64]
) -> None:
    for i in range(start, stop):
        for k in range(vectors.shape[0]):
            total = 0.0
            for j in range(matrix.shape[1]):
                total += matrix[i, j] * vectors[k, j]
            out[i, k] = total
