"""Irradiance straight from the light: on the walls with the sphere's shadow, and on the sphere.

A wall's integral over the light is exact along x, where the shadow is an interval between the roots of a quadratic, and
Gauss–Legendre along z. The sphere sees the whole light above its horizon: Lambert's formula for a clipped polygon.
"""

import math

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.exact.compiled import compiled, for_rows
from gloss_stimuli.exact.nodes import gauss_legendre
from gloss_stimuli.exact.room import CEILING, Room

__all__ = ["light_on_sphere", "light_on_walls"]


def light_on_walls(
    room: Room, points: NDArray[np.float64], wall: NDArray[np.int64], *, lines: int, shadow: bool = True
) -> NDArray[np.float64]:
    """Illuminance (lx) of wall points, shape (P,).

    Parameters
    ----------
    points, wall : array, shape (P, 3) and (P,)
    lines : int
        Gauss points along the light's z.
    shadow : bool, optional
        Whether the sphere is there.
    """
    out = np.empty(len(points))
    for_rows(_wall_rows, len(points), room, points, wall, *gauss_legendre(lines), shadow, out)
    return out


def light_on_sphere(room: Room, normals: NDArray[np.float64]) -> NDArray[np.float64]:
    """Illuminance (lx) of the sphere where its outward normal is each of `normals`, shape (P, 3) → (P,)."""
    out = np.empty(len(normals))
    for_rows(_sphere_rows, len(normals), room, normals, out)
    return out


@compiled
def _strip(axis: int, x0: float, x1: float, c2: float, dy: float, dz: float, sign: float) -> float:
    """∫ cosθ cosθ' / r² dx from x0 to x1 along a line of the light; c² = dy² + dz²."""
    if x1 <= x0:
        return 0.0
    if axis == 0:
        return sign * dy * 0.5 * (1 / (x0 * x0 + c2) - 1 / (x1 * x1 + c2))
    c = math.sqrt(c2)
    # ∫ dx / (x² + c²)²
    value = 0.5 / c2 * (x1 / (x1 * x1 + c2) - x0 / (x0 * x0 + c2) + (math.atan(x1 / c) - math.atan(x0 / c)) / c)
    return dy * dy * value if axis == 1 else sign * dz * dy * value


@compiled
def _wall_rows(
    start: int, stop: int, room: Room, points: NDArray[np.float64], wall: NDArray[np.int64], nodes: NDArray[np.float64],
    weights: NDArray[np.float64], shadow: bool, out: NDArray[np.float64],
) -> None:  # fmt: skip
    box = room.box
    depth = box.light_high[1] - box.light_low[1]
    for i in range(start, stop):
        out[i] = 0.0
        dy = box.high[1] - points[i, 1]
        if wall[i] == CEILING or dy <= 0:
            continue
        axis = wall[i] // 2
        sign = -1.0 if wall[i] % 2 else 1.0
        x0, x1 = box.light_low[0] - points[i, 0], box.light_high[0] - points[i, 0]
        if axis == 0:  # what lies behind the wall's own plane cannot be seen from it
            if sign > 0:
                x0 = max(x0, 0.0)
            else:
                x1 = min(x1, 0.0)
        mx, my, mz = box.center[0] - points[i, 0], box.center[1] - points[i, 1], box.center[2] - points[i, 2]
        # A ray along (x, dy, dz) meets the sphere where (m·d)² > s |d|² and m·d > 0, with s = |m|² - r².
        s = mx * mx + my * my + mz * mz - box.radius * box.radius
        a = mx * mx - s
        total = 0.0
        for k in range(len(nodes)):
            dz = box.light_low[1] + depth * nodes[k] - points[i, 2]
            if axis == 2 and dz * sign <= 0:
                continue
            c2 = dy * dy + dz * dz
            value = _strip(axis, x0, x1, c2, dy, dz, sign)
            if shadow:
                m = my * dy + mz * dz
                b, c = mx * m, m * m - s * c2
                discriminant = b * b - a * c
                if discriminant > 0 or a > 0:
                    # The root of the larger magnitude first, so that nothing cancels; it is infinite where a vanishes.
                    q = -(b + math.copysign(math.sqrt(max(discriminant, 0.0)), b))
                    first, second = q / a, c / q if q != 0 else 0.0
                    low, high = min(first, second), max(first, second)
                    if a < 0:
                        if mx * 0.5 * (max(x0, low) + min(x1, high)) + m > 0:
                            value -= _strip(axis, max(x0, low), min(x1, high), c2, dy, dz, sign)
                    elif mx > 0:
                        value -= _strip(axis, max(x0, high), x1, c2, dy, dz, sign)
                    else:
                        value -= _strip(axis, x0, min(x1, low), c2, dy, dz, sign)
            total += weights[k] * value
        out[i] = box.light_luminance * depth * max(total, 0.0)


@compiled
def _sphere_rows(start: int, stop: int, room: Room, normals: NDArray[np.float64], out: NDArray[np.float64]) -> None:
    box = room.box
    corners, clipped = np.empty((4, 3)), np.empty((8, 3))
    for i in range(start, stop):
        nx, ny, nz = normals[i, 0], normals[i, 1], normals[i, 2]
        for k in range(4):
            corners[k, 0] = box.light_low[0] if k in (0, 3) else box.light_high[0]
            corners[k, 1] = box.high[1]
            corners[k, 2] = box.light_low[1] if k < 2 else box.light_high[1]
            corners[k, 0] -= box.center[0] + box.radius * nx
            corners[k, 1] -= box.center[1] + box.radius * ny
            corners[k, 2] -= box.center[2] + box.radius * nz
        count = 0
        for k in range(4):
            j = (k + 1) % 4
            here = corners[k, 0] * nx + corners[k, 1] * ny + corners[k, 2] * nz
            there = corners[j, 0] * nx + corners[j, 1] * ny + corners[j, 2] * nz
            if here > 0:
                clipped[count] = corners[k]
                count += 1
            if (here > 0) != (there > 0):
                t = here / (here - there)
                for axis in range(3):
                    clipped[count, axis] = corners[k, axis] + t * (corners[j, axis] - corners[k, axis])
                count += 1
        total = 0.0
        for k in range(count):
            j = (k + 1) % count
            x = clipped[k, 1] * clipped[j, 2] - clipped[k, 2] * clipped[j, 1]
            y = clipped[k, 2] * clipped[j, 0] - clipped[k, 0] * clipped[j, 2]
            z = clipped[k, 0] * clipped[j, 1] - clipped[k, 1] * clipped[j, 0]
            cross = math.sqrt(x * x + y * y + z * z)
            dot = clipped[k, 0] * clipped[j, 0] + clipped[k, 1] * clipped[j, 1] + clipped[k, 2] * clipped[j, 2]
            if cross > 0:
                total += math.atan2(cross, dot) / cross * (x * nx + y * ny + z * nz)
        out[i] = box.light_luminance * abs(total) * 0.5
