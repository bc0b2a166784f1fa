"""The sphere among the walls: what it hides, the irradiance it receives, and the light it returns diffusely.

Seen from a wall, the sphere fills a cone. Rays of a shifted lattice through that cone tell which wall lies behind, to
be taken out of the empty box's matrix, and which point of the sphere lies in front.
"""

import math

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.exact.compiled import compiled, for_rows
from gloss_stimuli.exact.nodes import Nodes, lagrange
from gloss_stimuli.exact.room import Box, Room, cell_at, coordinate, frame, leave_box

__all__ = [
    "GOLDEN",
    "cone",
    "cone_ray",
    "hide_walls",
    "sphere_grid",
    "sphere_texels",
    "sphere_to_walls",
    "to_sphere",
    "walls_to_sphere",
]

GOLDEN = 0.6180339887498949
FEWEST_RAYS = 64

# Axis, two vectors across it, and 1 - cos of the half angle.
Cone = tuple[float, float, float, float, float, float, float, float, float, float]


def hide_walls(room: Room, nodes: Nodes, shifts: NDArray[np.float64], rays: int, matrix: NDArray[np.float32]) -> None:
    """Subtract from the empty box's matrix, in place, what the sphere hides.

    Parameters
    ----------
    shifts : array, shape (N, 2)
        Uniform numbers that shift each node's lattice.
    rays : int
        Through a cone that filled the whole view; a narrower one gets fewer: see `rays_of_cone`.
    """
    for_rows(
        _hidden_rows, len(nodes.points), room, nodes.points, nodes.wall, nodes.powers, shifts, rays, matrix
    )  # fmt: skip


def sphere_to_walls(
    room: Room, nodes: Nodes, shifts: NDArray[np.float64], rays: int, texture: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Irradiance at the nodes, shape (N, K), from a sphere of radiosity `texture` on a `sphere_grid`, (T, 2 T, K)."""
    out = np.zeros((len(nodes.points), texture.shape[2]))
    for_rows(_returned_rows, len(nodes.points), room, nodes.points, nodes.wall, shifts, rays, texture, out)
    return out


def walls_to_sphere(
    room: Room, normals: NDArray[np.float64], nodes: Nodes, radiosity: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Irradiance of the sphere, shape (P, K), where its normals are (P, 3), from walls of radiosity (N, K)."""
    out = np.zeros((len(normals), radiosity.shape[1]))
    for_rows(
        _received_rows, len(normals), room, normals, nodes.points, nodes.wall, nodes.weights,
        np.ascontiguousarray(radiosity), out,
    )  # fmt: skip
    return out


def sphere_grid(rows: int) -> NDArray[np.float64]:
    """Normals at the middles of a grid of polar angle from +y (rows) and azimuth (2 rows), shape (rows, 2 rows, 3)."""
    theta = (np.arange(rows) + 0.5) * np.pi / rows
    phi = (np.arange(2 * rows) + 0.5) * np.pi / rows
    theta, phi = np.meshgrid(theta, phi, indexing="ij")
    return np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], axis=-1)


@compiled
def sphere_texels(nx: float, ny: float, nz: float, rows: int) -> tuple[int, int, int, float, float]:
    """Bilinear look-up in a `sphere_grid`: row, two columns, and the fractions towards the next row and column."""
    u = math.acos(min(max(ny, -1.0), 1.0)) * (rows / math.pi) - 0.5
    v = math.atan2(nz, nx)
    v = (v + 2 * math.pi if v < 0 else v) * (rows / math.pi) - 0.5
    row = min(max(math.floor(u), 0), rows - 2)
    column = math.floor(v)
    return row, (column + 2 * rows) % (2 * rows), (column + 1) % (2 * rows), u - row, v - column


@compiled
def cone(box: Box, px: float, py: float, pz: float) -> tuple[Cone, float, float]:
    """The sphere seen from a point: its cone, the distance of its center, and 1 - cos of the half angle."""
    x, y, z = box.center[0] - px, box.center[1] - py, box.center[2] - pz
    distance = math.sqrt(x * x + y * y + z * z)
    x, y, z = x / distance, y / distance, z / distance
    sx, sy, sz, tx, ty, tz = frame(x, y, z)
    sine2 = (box.radius / distance) ** 2
    spread = sine2 / (1 + math.sqrt(1 - sine2))
    return (x, y, z, sx, sy, sz, tx, ty, tz, spread), distance, spread


@compiled
def cone_ray(seen: Cone, u: float, v: float) -> tuple[float, float, float, float]:
    """Unit direction through a cone for two uniform numbers, even over solid angle, and its cosine from the axis."""
    cosine = 1 - seen[9] * u
    sine = math.sqrt(max(1 - cosine * cosine, 0.0))
    c, s = math.cos(2 * math.pi * v) * sine, math.sin(2 * math.pi * v) * sine
    return (
        seen[0] * cosine + seen[3] * c + seen[6] * s,
        seen[1] * cosine + seen[4] * c + seen[7] * s,
        seen[2] * cosine + seen[5] * c + seen[8] * s,
        cosine,
    )


@compiled
def rays_of_cone(rays: int, spread: float) -> int:
    """Rays that give every cone the same error of irradiance: n of them err by n^-3/4 of the cone's share."""
    share = spread * (2 - spread)  # sin² of the half angle
    return max(FEWEST_RAYS, int(rays * share ** (4 / 3)))


@compiled
def to_sphere(distance: float, cosine: float, radius: float) -> float:
    """Length of a ray from a point outside to the sphere, at this cosine from its axis."""
    inside = radius * radius - distance * distance * (1 - cosine * cosine)
    return distance * cosine - math.sqrt(max(inside, 0.0))


@compiled
def _hidden_rows(
    start: int, stop: int, room: Room, points: NDArray[np.float64], wall: NDArray[np.int64],
    powers: NDArray[np.float64], shifts: NDArray[np.float64], rays: int, matrix: NDArray[np.float32],
) -> None:  # fmt: skip
    n, box, grid = powers.shape[0], room.box, room.grid
    basis_a, basis_b, hidden = np.empty(n), np.empty(n), np.empty(matrix.shape[1])
    for i in range(start, stop):
        hidden[:] = 0.0
        px, py, pz = points[i, 0], points[i, 1], points[i, 2]
        seen, _, spread = cone(box, px, py, pz)
        count = rays_of_cone(rays, spread)
        share = 2 * spread / count  # solid angle of a ray over π
        for k in range(count):
            dx, dy, dz, _ = cone_ray(seen, (k + shifts[i, 0]) / count, k * GOLDEN + shifts[i, 1])
            behind, x, y, z = leave_box(box, px, py, pz, dx, dy, dz)
            if behind == wall[i]:
                continue
            cell, u, v = cell_at(box, grid, behind, x, y, z)
            weight = share * abs(coordinate(dx, dy, dz, wall[i] // 2))
            lagrange(powers, u, basis_a)
            lagrange(powers, v, basis_b)
            for b in range(n):
                for a in range(n):
                    hidden[cell * n * n + b * n + a] += weight * basis_a[a] * basis_b[b]
        for j in range(matrix.shape[1]):
            matrix[i, j] -= hidden[j]


@compiled
def _returned_rows(
    start: int, stop: int, room: Room, points: NDArray[np.float64], wall: NDArray[np.int64],
    shifts: NDArray[np.float64], rays: int, texture: NDArray[np.float64], out: NDArray[np.float64],
) -> None:  # fmt: skip
    rows, box = texture.shape[0], room.box
    for i in range(start, stop):
        px, py, pz = points[i, 0], points[i, 1], points[i, 2]
        seen, distance, spread = cone(box, px, py, pz)
        count = rays_of_cone(rays, spread)
        share = 2 * spread / count
        sign = -1.0 if wall[i] % 2 else 1.0
        for k in range(count):
            dx, dy, dz, cosine = cone_ray(seen, (k + shifts[i, 0]) / count, k * GOLDEN + shifts[i, 1])
            facing = sign * coordinate(dx, dy, dz, wall[i] // 2)
            if facing <= 0:
                continue
            length = to_sphere(distance, cosine, box.radius)
            nx = (px + length * dx - box.center[0]) / box.radius
            ny = (py + length * dy - box.center[1]) / box.radius
            nz = (pz + length * dz - box.center[2]) / box.radius
            row, left, right, fu, fv = sphere_texels(nx, ny, nz, rows)
            for q in range(texture.shape[2]):
                upper = (1 - fv) * texture[row, left, q] + fv * texture[row, right, q]
                lower = (1 - fv) * texture[row + 1, left, q] + fv * texture[row + 1, right, q]
                out[i, q] += share * facing * ((1 - fu) * upper + fu * lower)


@compiled
def _received_rows(
    start: int, stop: int, room: Room, normals: NDArray[np.float64], points: NDArray[np.float64],
    wall: NDArray[np.int64], areas: NDArray[np.float64], radiosity: NDArray[np.float64], out: NDArray[np.float64],
) -> None:  # fmt: skip
    fields, box = radiosity.shape[1], room.box
    for i in range(start, stop):
        nx, ny, nz = normals[i, 0], normals[i, 1], normals[i, 2]
        px = box.center[0] + box.radius * nx
        py = box.center[1] + box.radius * ny
        pz = box.center[2] + box.radius * nz
        for j in range(len(points)):
            x, y, z = points[j, 0] - px, points[j, 1] - py, points[j, 2] - pz
            facing = x * nx + y * ny + z * nz
            if facing > 0:
                r2 = x * x + y * y + z * z
                weight = areas[j] * facing * abs(coordinate(x, y, z, wall[j] // 2)) / (math.pi * r2 * r2)
                for q in range(fields):
                    out[i, q] += weight * radiosity[j, q]
