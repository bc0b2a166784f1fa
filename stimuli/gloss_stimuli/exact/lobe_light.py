"""The light's image in the sphere: Ward's lobe integrated over the part of the light that it reaches.

The lobe is a Gaussian of the half vector, zero to a display beyond a few α. Its reach about the mirrored direction is a
cone, whose shadow on the ceiling bounds a rectangle of the light for Gauss–Legendre's rule. Towards grazing the lobe is
narrower across the plane of incidence than along it, by the cosine of incidence, and the rule takes more points. Up
to 80° it errs by .4 % at most; beyond about 83° they no longer suffice for a narrow lobe: 9 % at 85°.
"""

import math

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.exact.camera import Camera, sphere_point
from gloss_stimuli.exact.compiled import compiled, for_rows
from gloss_stimuli.exact.lobe import FORMS, lobe_value
from gloss_stimuli.exact.nodes import gauss_legendre
from gloss_stimuli.exact.room import Box, Room, frame

__all__ = ["light_by_lobe", "light_in_pixels", "light_rules", "light_within_reach"]

# Half vectors beyond this many α carry exp(-4.6²) = 6e-10 of the lobe's peak.
REACH = 4.6


Rules = tuple[NDArray[np.float64], ...]


def light_rules(points: int) -> Rules:
    """Nodes and weights of three rules, of `points`, twice and four times as many."""
    return (*gauss_legendre(points), *gauss_legendre(2 * points), *gauss_legendre(4 * points))


def light_in_pixels(
    room: Room, camera: Camera, first: NDArray[np.int64], x: NDArray[np.float64], y: NDArray[np.float64],
    weight: NDArray[np.float64], *, alpha: float, form: str, points: int,
) -> NDArray[np.float64]:  # fmt: skip
    """Luminance of the light's image for ρs = 1 (cd/m²), averaged over the sphere samples of each pixel, shape (P,)."""
    out = np.zeros(len(first) - 1)
    for_rows(
        _pixel_rows, len(out), room, camera, first, x, y, weight, alpha, FORMS.index(form), light_rules(points), out
    )
    return out


@compiled
def _reach(toward: float, aside: float, spread: float, height: float) -> tuple[float, float]:
    """Where a cone of half angle `spread` meets the ceiling along one axis, relative to its apex.

    Parameters: components of the cone's axis upwards and along that axis, and the ceiling's height above the apex.
    """
    length = math.sqrt(toward * toward + aside * aside)
    sine = math.sin(spread)
    if spread >= math.pi / 2 or length <= sine:
        return -1e300, 1e300
    middle, half = math.atan2(aside, toward), math.asin(sine / length)
    low, high = middle - half, middle + half
    if low >= math.pi / 2 or high <= -math.pi / 2:
        return 1.0, -1.0
    return (
        height * math.tan(low) if low > -math.pi / 2 else -1e300,
        height * math.tan(high) if high < math.pi / 2 else 1e300,
    )


@compiled
def light_within_reach(
    box: Box, px: float, py: float, pz: float, nx: float, ny: float, nz: float, ex: float, ey: float, ez: float,
    tangent: float,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Part of the light that half vectors up to a tangent from the normal reach: x and z ranges from the point."""
    facing = ex * nx + ey * ny + ez * nz
    mx, my, mz = 2 * facing * nx - ex, 2 * facing * ny - ey, 2 * facing * nz - ez
    height = box.high[1] - py
    spread = 2 * math.atan(tangent)
    x0, x1 = _reach(my, mx, spread, height)
    z0, z1 = _reach(my, mz, spread, height)
    return (
        max(x0, box.light_low[0] - px),
        min(x1, box.light_high[0] - px),
        max(z0, box.light_low[1] - pz),
        min(z1, box.light_high[1] - pz),
    )


@compiled
def light_by_lobe(
    box: Box, px: float, py: float, pz: float, nx: float, ny: float, nz: float, ex: float, ey: float, ez: float,
    alpha: float, form: int, rules: Rules,
) -> float:  # fmt: skip
    """Luminance towards (ex, ey, ez) of the light reflected at a point of the sphere, for ρs = 1 (cd/m²)."""
    facing = ex * nx + ey * ny + ez * nz
    x0, x1, z0, z1 = light_within_reach(box, px, py, pz, nx, ny, nz, ex, ey, ez, REACH * alpha)
    if x1 <= x0 or z1 <= z0:
        return 0.0
    nodes, weights = rules[0], rules[1]
    if facing < 0.35:
        nodes, weights = rules[4], rules[5]
    elif facing < 0.7:
        nodes, weights = rules[2], rules[3]
    height = box.high[1] - py
    ux, uy, uz, vx, vy, vz = frame(nx, ny, nz)
    ix, iy = ex * ux + ey * uy + ez * uz, ex * vx + ey * vy + ez * vz
    total = 0.0
    for i in range(len(nodes)):
        lx = x0 + (x1 - x0) * nodes[i]
        for j in range(len(nodes)):
            lz = z0 + (z1 - z0) * nodes[j]
            r2 = lx * lx + height * height + lz * lz
            scale = 1 / math.sqrt(r2)
            dx, dy, dz = lx * scale, height * scale, lz * scale
            oz = dx * nx + dy * ny + dz * nz
            if oz > 0:
                ox, oy = dx * ux + dy * uy + dz * uz, dx * vx + dy * vy + dz * vz
                value, _ = lobe_value(form, alpha, ix, iy, facing, ox, oy, oz)
                total += weights[i] * weights[j] * value * dy / r2
    return box.light_luminance * (x1 - x0) * (z1 - z0) * total


@compiled
def _pixel_rows(
    start: int, stop: int, room: Room, camera: Camera, first: NDArray[np.int64], x: NDArray[np.float64],
    y: NDArray[np.float64], weight: NDArray[np.float64], alpha: float, form: int, rules: Rules,
    out: NDArray[np.float64],
) -> None:  # fmt: skip
    box = room.box
    for p in range(start, stop):
        for k in range(first[p], first[p + 1]):
            px, py, pz, nx, ny, nz, ex, ey, ez = sphere_point(camera, x[k], y[k])
            out[p] += weight[k] * light_by_lobe(
                box, px, py, pz, nx, ny, nz, ex, ey, ez, alpha, form, rules
            )  # fmt: skip
