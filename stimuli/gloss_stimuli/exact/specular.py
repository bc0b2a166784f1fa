"""Light that reaches the walls by a specular reflection at the sphere: from the other walls, and from the light.

Both are estimated at each node from evenly spread samples that every node shifts for itself.

- *From the walls*: a ray through the sphere's cone, and a half vector of the lobe there.
- *From the light*: a point of the light, then a point of the sphere near the one that mirrors it to the node. A
  Gaussian of width α about the mirror's normal follows the lobe so closely that few samples are needed.
"""

import math

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.exact.compiled import compiled, for_rows
from gloss_stimuli.exact.lobe import FORMS, lobe_value, lobe_weight, mirrored
from gloss_stimuli.exact.nodes import Nodes, lagrange
from gloss_stimuli.exact.room import Room, cell_at, coordinate, frame, leave_box
from gloss_stimuli.exact.sphere import cone, cone_ray, to_sphere

__all__ = ["lattice_steps", "light_by_sphere", "walls_by_sphere"]

# Steps towards the mirroring point; it only centers the samples, so it need not be found exactly.
MIRROR_STEPS = 4
# Samples reach this much further than the lobe, so that none of its tail is rare.
WIDER = 1.15
# Nearer to grazing the lobe's width changes faster than the samples follow.
SMALLEST_COSINE = 0.1


def lattice_steps(count: int) -> NDArray[np.float64]:
    """Steps of an evenly spread sequence in `count` dimensions: powers of a generalised golden ratio (Roberts 2018)."""
    ratio = 2.0
    for _ in range(60):
        ratio = (1 + ratio) ** (1 / (count + 1))
    return ratio ** -np.arange(1.0, count + 1)


STEPS = lattice_steps(3)


def walls_by_sphere(
    room: Room, nodes: Nodes, shifts: NDArray[np.float64], samples: int, *,
    alpha: float, form: str, radiosity: NDArray[np.float64],
) -> NDArray[np.float64]:  # fmt: skip
    """Irradiance of the nodes from the walls by way of the sphere's lobe, for ρs = 1, shape (N, K).

    Parameters
    ----------
    shifts : array, shape (N, 4)
        Uniform numbers.
    samples : int
        A node.
    alpha, form
        Of the lobe.
    radiosity : array, shape (N, K)
        ρE of the walls at their nodes.
    """
    out = np.zeros((len(nodes.points), radiosity.shape[1]))
    for_rows(
        _wall_rows, len(nodes.points), room, nodes.points, nodes.wall, nodes.powers, shifts, samples, alpha,
        FORMS.index(form), STEPS, np.ascontiguousarray(radiosity), out,
    )  # fmt: skip
    return out


def light_by_sphere(
    room: Room, nodes: Nodes, shifts: NDArray[np.float64], samples: int, *, alpha: float, form: str
) -> NDArray[np.float64]:
    """Irradiance of the nodes from the light by way of the sphere's lobe, for ρs = 1, shape (N,).

    Parameters
    ----------
    shifts : array, shape (N, 4)
        Uniform numbers.
    samples : int
        A node.
    """
    out = np.zeros(len(nodes.points))
    for_rows(
        _light_rows, len(nodes.points), room, nodes.points, nodes.wall, shifts, samples, alpha, FORMS.index(form),
        STEPS, out,
    )  # fmt: skip
    return out


@compiled
def _wall_rows(
    start: int, stop: int, room: Room, points: NDArray[np.float64], wall: NDArray[np.int64],
    powers: NDArray[np.float64], shifts: NDArray[np.float64], samples: int, alpha: float, form: int,
    steps: NDArray[np.float64], radiosity: NDArray[np.float64], out: NDArray[np.float64],
) -> None:  # fmt: skip
    n, fields = powers.shape[0], radiosity.shape[1]
    box, grid, is_light = room.box, room.grid, room.is_light
    basis_a, basis_b = np.empty(n), np.empty(n)
    for i in range(start, stop):
        px, py, pz = points[i, 0], points[i, 1], points[i, 2]
        seen, distance, spread = cone(box, px, py, pz)
        sign = -1.0 if wall[i] % 2 else 1.0
        for k in range(samples):
            dx, dy, dz, cosine = cone_ray(seen, (k + shifts[i, 0]) / samples, k * steps[0] + shifts[i, 1])
            facing = sign * coordinate(dx, dy, dz, wall[i] // 2)
            if facing <= 0:
                continue
            length = to_sphere(distance, cosine, box.radius)
            yx, yy, yz = px + length * dx, py + length * dy, pz + length * dz
            nx, ny, nz = (
                (yx - box.center[0]) / box.radius,
                (yy - box.center[1]) / box.radius,
                (yz - box.center[2]) / box.radius,
            )
            ux, uy, uz, vx, vy, vz = frame(nx, ny, nz)
            ix, iy, iz = -(dx * ux + dy * uy + dz * uz), -(dx * vx + dy * vy + dz * vz), -(dx * nx + dy * ny + dz * nz)
            if iz <= 1e-9:
                continue
            tangent = alpha * math.sqrt(-math.log(1 - (k * steps[1] + shifts[i, 2]) % 1.0))
            turn = 2 * math.pi * (k * steps[2] + shifts[i, 3])
            hx, hy = tangent * math.cos(turn), tangent * math.sin(turn)
            ox, oy, oz, half_dot_i, cos_delta = mirrored(ix, iy, iz, hx, hy)
            if half_dot_i <= 0 or oz <= 0:
                continue
            gx, gy, gz = ox * ux + oy * vx + oz * nx, ox * uy + oy * vy + oz * ny, ox * uz + oy * vz + oz * nz
            there, x, y, z = leave_box(box, yx, yy, yz, gx, gy, gz)
            cell, a, b = cell_at(box, grid, there, x, y, z)
            if is_light[cell]:
                continue
            # The ray's solid angle, and radiosity over π.
            weight = 2 * spread / samples * facing * lobe_weight(form, iz, oz, half_dot_i, cos_delta)
            lagrange(powers, a, basis_a)
            lagrange(powers, b, basis_b)
            for q in range(fields):
                total = 0.0
                for kb in range(n):
                    for ka in range(n):
                        total += basis_b[kb] * basis_a[ka] * radiosity[cell * n * n + kb * n + ka, q]
                out[i, q] += weight * total


@compiled
def _mirror_normal(
    radius: float, px: float, py: float, pz: float, lx: float, ly: float, lz: float
) -> tuple[float, float, float]:
    """Normal where a sphere about the origin nearly mirrors one point to another: Alhazen's problem, damped steps."""
    nx, ny, nz = 0.0, 0.0, 0.0
    for step in range(MIRROR_STEPS):
        ex, ey, ez = px - radius * nx, py - radius * ny, pz - radius * nz
        fx, fy, fz = lx - radius * nx, ly - radius * ny, lz - radius * nz
        e, f = 1 / math.sqrt(ex * ex + ey * ey + ez * ez), 1 / math.sqrt(fx * fx + fy * fy + fz * fz)
        hx, hy, hz = ex * e + fx * f, ey * e + fy * f, ez * e + fz * f
        length = math.sqrt(hx * hx + hy * hy + hz * hz) + 1e-12
        # The half vector turns back by this much for each turn of the normal.
        damping = 1.0 if step == 0 else 1 / (1 + 0.5 * radius * (e + f))
        nx, ny, nz = (
            nx + damping * (hx / length - nx),
            ny + damping * (hy / length - ny),
            nz + damping * (hz / length - nz),
        )
        length = math.sqrt(nx * nx + ny * ny + nz * nz) + 1e-300
        nx, ny, nz = nx / length, ny / length, nz / length
    return nx, ny, nz


@compiled
def _lobe_axes(
    radius: float, px: float, py: float, pz: float, lx: float, ly: float, lz: float, mx: float, my: float, mz: float
) -> tuple[float, float, float, float, float, float, float, float]:
    """Tangent vectors along and across the plane of incidence, and how far the lobe reaches along each, in units of α.

    Where the normal turns by t, the half vector turns back by g cosθ t along the plane and by g/cosθ t across it, with
    g = r/2 (1/distance to one point + 1/distance to the other). So the lobe is that much narrower than α.
    """
    ex, ey, ez = px - radius * mx, py - radius * my, pz - radius * mz
    fx, fy, fz = lx - radius * mx, ly - radius * my, lz - radius * mz
    e, f = 1 / math.sqrt(ex * ex + ey * ey + ez * ez), 1 / math.sqrt(fx * fx + fy * fy + fz * fz)
    cosine = (ex * mx + ey * my + ez * mz) * e
    ux, uy, uz = ex * e - cosine * mx, ey * e - cosine * my, ez * e - cosine * mz
    length = math.sqrt(ux * ux + uy * uy + uz * uz)
    if length > 1e-6:
        ux, uy, uz = ux / length, uy / length, uz / length
        vx, vy, vz = my * uz - mz * uy, mz * ux - mx * uz, mx * uy - my * ux
    else:
        ux, uy, uz, vx, vy, vz = frame(mx, my, mz)
    g, cosine = 0.5 * radius * (e + f), max(cosine, SMALLEST_COSINE)
    return ux, uy, uz, vx, vy, vz, WIDER / (1 + g * cosine), WIDER / (1 + g / cosine)


@compiled
def _light_rows(
    start: int, stop: int, room: Room, points: NDArray[np.float64], wall: NDArray[np.int64],
    shifts: NDArray[np.float64], samples: int, alpha: float, form: int, steps: NDArray[np.float64],
    out: NDArray[np.float64],
) -> None:  # fmt: skip
    box = room.box
    width, depth = box.light_high[0] - box.light_low[0], box.light_high[1] - box.light_low[1]
    radius = box.radius
    for i in range(start, stop):
        px, py, pz = points[i, 0] - box.center[0], points[i, 1] - box.center[1], points[i, 2] - box.center[2]
        sign = -1.0 if wall[i] % 2 else 1.0
        total = 0.0
        for k in range(samples):
            lx = box.light_low[0] + width * ((k + shifts[i, 0]) / samples) - box.center[0]
            lz = box.light_low[1] + depth * ((k * steps[0] + shifts[i, 1]) % 1.0) - box.center[2]
            ly = box.high[1] - box.center[1]
            mx, my, mz = _mirror_normal(radius, px, py, pz, lx, ly, lz)
            ux, uy, uz, vx, vy, vz, along, across = _lobe_axes(radius, px, py, pz, lx, ly, lz, mx, my, mz)
            u = 1 - (k * steps[1] + shifts[i, 2]) % 1.0
            turn = 2 * math.pi * (k * steps[2] + shifts[i, 3])
            distance = math.sqrt(-math.log(u))
            c, s = alpha * along * distance * math.cos(turn), alpha * across * distance * math.sin(turn)
            length2 = 1 + c * c + s * s
            scale = 1 / math.sqrt(length2)
            nx, ny, nz = (mx + c * ux + s * vx) * scale, (my + c * uy + s * vy) * scale, (mz + c * uz + s * vz) * scale
            ex, ey, ez = px - radius * nx, py - radius * ny, pz - radius * nz
            fx, fy, fz = lx - radius * nx, ly - radius * ny, lz - radius * nz
            e2, f2 = ex * ex + ey * ey + ez * ez, fx * fx + fy * fy + fz * fz
            e, f = 1 / math.sqrt(e2), 1 / math.sqrt(f2)
            ex, ey, ez, fx, fy, fz = ex * e, ey * e, ez * e, fx * f, fy * f, fz * f
            cos_i, cos_o = ex * nx + ey * ny + ez * nz, fx * nx + fy * ny + fz * nz
            arriving = -sign * coordinate(ex, ey, ez, wall[i] // 2)
            if cos_i <= 1e-9 or cos_o <= 0 or arriving <= 0:
                continue
            ax, ay, az, bx, by, bz = frame(nx, ny, nz)
            value, _ = lobe_value(
                form, alpha, ex * ax + ey * ay + ez * az, ex * bx + ey * by + ez * bz, cos_i,
                fx * ax + fy * ay + fz * az, fx * bx + fy * by + fz * bz, cos_o,
            )  # fmt: skip
            # Of the normal, per steradian.
            density = u / (math.pi * alpha * alpha * along * across) * length2 * math.sqrt(length2)
            total += value * fy / f2 * cos_i * arriving / e2 / density
        out[i] = box.light_luminance * width * depth * radius * radius * total / samples
