"""Fields as they are seen: the irradiance of walls and sphere on fine grids, true up to the edges of the room.

Near an edge a wall's irradiance follows the checks of the wall that it meets, on ever smaller scales. So it is put
together from three parts: the light, exactly; the cells across the edge, by product integration at each texel; and the
smooth rest, by cubic splines through the nodes. The cells across the edge kink there themselves, which the polynomials
of the nodes miss; a few passes add what the textures know better than they (`_edge_pass`).

Texels lie at u = (1 - cos θ) / 2 with θ in equal steps, dense towards the edges of a cell, and are looked up linearly
in θ.
"""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline

from gloss_stimuli.exact.compiled import compiled, for_rows
from gloss_stimuli.exact.direct import light_on_sphere, light_on_walls
from gloss_stimuli.exact.exchange import EdgeRule, edge_geometry, edge_rule, from_edge_cells, relative_distance
from gloss_stimuli.exact.levels import Level
from gloss_stimuli.exact.nodes import Nodes, wall_points
from gloss_stimuli.exact.room import Box, Room, cell_at, leave_box
from gloss_stimuli.exact.sphere import sphere_grid, walls_to_sphere

__all__ = ["add_radiance", "patch_texture", "refined", "sphere_texture", "texel_abscissae", "texel_at", "wall_texture"]

# Within this many widths of an edge the kink of the cells across it matters.
EDGE_WIDTHS = 0.5
# The sphere's indirect irradiance is smooth: it is summed on a grid coarser by this factor and interpolated.
COARSENING = 4


def texel_abscissae(count: int) -> NDArray[np.float64]:
    """Places of the texels along a side of a cell."""
    return (1 - np.cos(np.pi * (np.arange(count) + 0.5) / count)) / 2


@compiled
def texel_at(u: float, count: int) -> tuple[int, float]:
    """Texel before `u` (0 to 1), and the fraction of the way to the next."""
    place = math.acos(min(max(1 - 2 * u, -1.0), 1.0)) * (count / math.pi) - 0.5
    place = min(max(place, 0.0), count - 1.0)
    index = min(int(place), count - 2)
    return index, place - index


def wall_texture(
    room: Room, nodes: Nodes, level: Level, irradiance: NDArray[np.float64], light_at_nodes: NDArray[np.float64] | None
) -> NDArray[np.float64]:
    """Irradiance of the walls at their texels, shape (C, b, a, K).

    Parameters
    ----------
    irradiance : array, shape (N, K)
        At the nodes.
    light_at_nodes : array, shape (N,), or None
        What of the first column is the light itself; None if no column holds it.
    """
    rule = edge_rule(level.edge_points)
    u = texel_abscissae(level.texels)
    points, _ = wall_points(room, u)
    points = points.reshape(-1, 3)
    wall = np.repeat(room.cell_wall, len(u) ** 2)
    radiosity = irradiance * nodes.reflectance[:, None]
    smooth = irradiance - from_edge_cells(room, nodes, rule, nodes.points, nodes.wall, radiosity)
    if light_at_nodes is not None:
        smooth[:, 0] -= light_at_nodes
    texture = _splined(room, nodes, u, smooth).reshape(len(points), -1)
    texture += from_edge_cells(room, nodes, rule, points, wall, radiosity)
    if light_at_nodes is not None:
        texture[:, 0] += light_on_walls(room, points, wall, lines=level.light_lines)
    texture = _corrected_edges(room, nodes, rule, level, points, wall, irradiance, texture)
    if not np.isfinite(texture).all():
        raise FloatingPointError("The irradiance of the walls came out not finite.")
    return texture.reshape(len(room.cell_wall), len(u), len(u), -1)


def _splined(room: Room, nodes: Nodes, u: NDArray[np.float64], values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Cubic splines through the nodes of each whole wall, at the texels: shape (C, b, a, K)."""
    n = nodes.order
    out = np.empty((len(room.cell_wall), len(u), len(u), values.shape[1]))
    for wall in range(6):
        begin, end = room.wall_start[wall], room.wall_start[wall + 1]
        along_a, along_b = room.cells_along[wall]
        grid = values[begin * n * n : end * n * n].reshape(along_b, along_a, n, n, -1)
        grid = grid.transpose(0, 2, 1, 3, 4).reshape(along_b * n, along_a * n, -1)
        for axis, count in ((1, along_a), (0, along_b)):
            lines = room.grid[wall, 1 - axis, 3 + int(room.grid[wall, 1 - axis, 2]) :][: count + 1]
            knots, texels = (
                (lines[:-1, None] + np.diff(lines)[:, None] * place).ravel() for place in (nodes.abscissae, u)
            )
            grid = make_interp_spline(knots, grid, k=min(3, len(knots) - 1), axis=axis)(texels)
        t = len(u)
        out[begin:end] = (
            grid.reshape(along_b, t, along_a, t, -1).transpose(0, 2, 1, 3, 4).reshape(-1, t, t, out.shape[3])
        )
    return out


def _corrected_edges(
    room: Room, nodes: Nodes, rule: EdgeRule, level: Level, points: NDArray[np.float64], wall: NDArray[np.int64],
    irradiance: NDArray[np.float64], texture: NDArray[np.float64],
) -> NDArray[np.float64]:  # fmt: skip
    n, t = nodes.order, level.texels
    values = nodes.values_at(texel_abscissae(t))
    polynomials = np.einsum("bj,ai,cjik->cbak", values, values, irradiance.reshape(-1, n, n, irradiance.shape[1]))
    polynomials = polynomials.reshape(texture.shape)
    distance = np.full(len(points), np.inf)
    for axis in range(3):
        for plane in (room.box.low[axis], room.box.high[axis]):
            across = wall // 2 != axis
            distance[across] = np.minimum(distance[across], np.abs(points[across, axis] - plane))
    near = np.flatnonzero(distance < EDGE_WIDTHS * room.box.check)
    base = texture.copy()
    for _ in range(level.edge_passes):
        missed = np.ascontiguousarray(texture - polynomials).reshape(len(room.cell_wall), t, t, -1)
        added = np.zeros((len(near), texture.shape[1]))
        for_rows(_edge_pass, len(near), room, points[near], wall[near], *rule, missed, added)
        texture = base.copy()
        texture[near] += added
    return texture


@compiled
def _edge_pass(
    start: int, stop: int, room: Room, points: NDArray[np.float64], wall: NDArray[np.int64], x: NDArray[np.float64],
    w: NDArray[np.float64], missed: NDArray[np.float64], out: NDArray[np.float64],
) -> None:  # fmt: skip
    """Irradiance of points from what the polynomials of the cells across the edge miss, looked up in their textures."""
    count, fields = missed.shape[1], missed.shape[3]
    box, walls, low, high, reflectance = room.box, room.cell_wall, room.cell_low, room.cell_high, room.reflectance
    edge_cells = room.edge_cells
    for i in range(start, stop):
        px, py, pz = points[i, 0], points[i, 1], points[i, 2]
        for cell in edge_cells[wall[i]]:
            if cell < 0:
                break
            other = (walls[cell], low[cell, 0], low[cell, 1], high[cell, 0], high[cell, 1])
            if reflectance[cell] == 0 or relative_distance(box, px, py, pz, *other) > EDGE_WIDTHS:
                continue
            a_leads, height, d0, d1, x0, x1, falls = edge_geometry(box, px, py, pz, wall[i], *other)
            u0, u1 = math.asinh(d0 / height), math.asinh(d1 / height)
            for j in range(len(x)):
                u = u0 + (u1 - u0) * x[j]
                sinh, cosh = math.sinh(u), math.cosh(u)
                radial = (u1 - u0) * w[j] * sinh / (math.pi * cosh * cosh) * reflectance[cell]
                place = (height * sinh - d0) / (d1 - d0)
                d, fd = texel_at(1 - place if falls else place, count)
                reach = height * cosh
                t0, t1 = math.atan(x0 / reach), math.atan(x1 / reach)
                for k in range(len(x)):
                    t = t0 + (t1 - t0) * x[k]
                    cosine = math.cos(t)
                    e, fe = texel_at((reach * math.tan(t) - x0) / (x1 - x0), count)
                    weight = radial * (t1 - t0) * w[k] * cosine * cosine
                    a, fa, b, fb = (d, fd, e, fe) if a_leads else (e, fe, d, fd)
                    for q in range(fields):
                        lower = (1 - fa) * missed[cell, b, a, q] + fa * missed[cell, b, a + 1, q]
                        upper = (1 - fa) * missed[cell, b + 1, a, q] + fa * missed[cell, b + 1, a + 1, q]
                        out[i, q] += weight * ((1 - fb) * lower + fb * upper)


def refined(texture: NDArray[np.float64], factor: int) -> NDArray[np.float64]:
    """The same texture on `factor` times as many texels along each side of a cell, shape (C, b, a, K).

    As a function of θ a field is even about both edges of a cell, so cubic splines through the mirrored texels need no
    end conditions. Looked up linearly, the texture itself would be off by its curvature, and alike at every level.
    """
    count = texture.shape[1]
    reach = min(4, count)
    places = np.arange(-reach, count + reach)
    # Mirrored: the texel before the first is the first itself, since texels lie at half steps of θ from the edges.
    mirror = np.where(places < 0, -1 - places, np.where(places >= count, 2 * count - 1 - places, places))
    fine = (np.arange(factor * count) + 0.5) / factor - 0.5
    weights = make_interp_spline(places, np.eye(count)[mirror], k=3)(fine)
    return np.einsum("bj,ai,cjik->cbak", weights, weights, texture, optimize=True)


def patch_texture(room: Room, texture: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Radiance of the walls at (count + 1)² even vertices a cell, shape (C, b, a, K): what lobes look up."""
    u = np.arange(count + 1) / count
    texels = texel_abscissae(texture.shape[1])
    values = make_interp_spline(texels, np.eye(len(texels)), k=3)(u)
    even = np.einsum("bj,ai,cjik->cbak", values, values, texture, optimize=True)
    return np.ascontiguousarray(even * (room.reflectance / np.pi)[:, None, None, None])


def sphere_texture(
    room: Room, nodes: Nodes, level: Level, irradiance: NDArray[np.float64], *, with_light: bool
) -> NDArray[np.float64]:
    """Irradiance of the sphere, shape (T, 2 T, K): indirect light splined from a coarser grid, the light exactly."""
    rows = level.sphere_texture_rows // COARSENING
    coarse = sphere_grid(rows)
    values = walls_to_sphere(room, coarse.reshape(-1, 3), nodes, irradiance * nodes.reflectance[:, None])
    values = values.reshape(rows, 2 * rows, -1)
    pad = 8
    # Over a pole the same meridian goes on half a turn away.
    above, below = np.roll(values[:pad][::-1], rows, axis=1), np.roll(values[-pad:][::-1], rows, axis=1)
    values = np.concatenate([above, values, below])
    values = np.concatenate([values[:, -pad:], values, values[:, :pad]], axis=1)
    for axis in (0, 1):
        count = rows * (1 + axis)
        places = np.arange(-pad, count + pad) + 0.5
        fine = (np.arange(count * COARSENING) + 0.5) / COARSENING
        values = make_interp_spline(places, values, k=3, axis=axis)(fine)
    if with_light:
        normals = sphere_grid(rows * COARSENING)
        values[..., 0] += light_on_sphere(room, normals.reshape(-1, 3)).reshape(normals.shape[:2])
    if not np.isfinite(values).all():
        raise FloatingPointError("The irradiance of the sphere came out not finite.")
    return np.ascontiguousarray(values)


@compiled
def add_radiance(
    box: Box, grid: NDArray[np.float64], is_light: NDArray[np.bool_], patches: NDArray[np.float32],
    px: float, py: float, pz: float, dx: float, dy: float, dz: float, weight: float, total: NDArray[np.float64],
) -> int:  # fmt: skip
    """Add to `total`, shape (K,), the radiance that a ray from a point of the sphere finds; the cell it meets.

    The light adds nothing here: who calls knows whether it is counted elsewhere.
    """
    wall, x, y, z = leave_box(box, px, py, pz, dx, dy, dz)
    cell, u, v = cell_at(box, grid, wall, x, y, z)
    if is_light[cell]:
        return cell
    side = patches.shape[1] - 1
    u, v = u * side, v * side
    a, b = min(int(u), side - 1), min(int(v), side - 1)
    fa, fb = u - a, v - b
    w00, w10 = weight * (1 - fa) * (1 - fb), weight * fa * (1 - fb)
    w01, w11 = weight * (1 - fa) * fb, weight * fa * fb
    for q in range(len(total)):
        total[q] += (
            w00 * patches[cell, b, a, q] + w10 * patches[cell, b, a + 1, q]
            + w01 * patches[cell, b + 1, a, q] + w11 * patches[cell, b + 1, a + 1, q]
        )  # fmt: skip
    return cell
