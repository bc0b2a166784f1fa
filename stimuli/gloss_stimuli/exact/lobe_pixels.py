"""What the sphere mirrors, pixel by pixel: for lobes so narrow that a table would have more points than the film needs.

A place in the pixel and a half vector are drawn together, from an evenly spread sequence in four dimensions that every
pixel shifts for itself. A pixel whose lobes stay in one check takes fewer.
"""

import math

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.exact.camera import Camera, camera_ray, outline_radius_pixels, seen_on_sphere, sphere_point
from gloss_stimuli.exact.compiled import compiled, for_rows
from gloss_stimuli.exact.lobe import FORMS, lobe_weight, mirrored
from gloss_stimuli.exact.lobe_light import light_within_reach
from gloss_stimuli.exact.room import Box, Room, cell_at, frame, leave_box
from gloss_stimuli.exact.specular import lattice_steps
from gloss_stimuli.exact.textures import add_radiance

__all__ = ["radiance_of_pixels"]

STEPS = lattice_steps(4)
# A pixel whose lobes stay in one check is smooth and needs this part of the samples.
SMOOTH_PART = 8
# Half vectors that tell whether they do: this many on a circle of this many α, beyond which lies exp(-3.5²) = 5e-6.
PROBES, PROBE_REACH = 8, 3.5


def radiance_of_pixels(
    room: Room, camera: Camera, pixels: NDArray[np.int64], first: NDArray[np.int64], x: NDArray[np.float64],
    y: NDArray[np.float64], weight: NDArray[np.float64], patches: NDArray[np.float32], rng: np.random.Generator, *,
    alpha: float, form: str, samples: int, with_light: bool,
) -> NDArray[np.float64]:  # fmt: skip
    """Radiance of the mirrored room for ρs = 1, averaged over each pixel, shape (P, K).

    Parameters
    ----------
    pixels, first, x, y, weight
        Pixels, and their sphere samples as in `gloss_stimuli.exact.film.FilmMap`. Pixels that
        show the sphere alone draw places of their own, at its outline the samples serve.
    patches : array, shape (C, b, a, K)
        Radiance of the walls.
    samples : int
        A pixel.
    with_light : bool
        Whether samples that find the light bring its luminance to the first field.
    """
    out = np.zeros((len(pixels), patches.shape[3]))
    shifts = rng.random((len(pixels), 4))
    for_rows(
        _pixel_rows, len(pixels), room, camera, pixels, first, x, y, weight, patches, shifts, alpha, FORMS.index(form),
        samples, STEPS, with_light, 2 / outline_radius_pixels(camera), out,
    )  # fmt: skip
    return out


@compiled
def _mirrored_ray(
    camera: Camera, x: float, y: float, hx: float, hy: float
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """Where the eye's ray at (x, y) of the sphere goes on, mirrored at the half vector (hx, hy, 1).

    Returns the point, the direction, and the cosines of incidence, of reflection, h·i and cos δ for the lobe's weight.
    """
    px, py, pz, nx, ny, nz, ex, ey, ez = sphere_point(camera, x, y)
    ux, uy, uz, vx, vy, vz = frame(nx, ny, nz)
    ix, iy, iz = ex * ux + ey * uy + ez * uz, ex * vx + ey * vy + ez * vz, ex * nx + ey * ny + ez * nz
    ox, oy, oz, half_dot_i, cos_delta = mirrored(ix, iy, iz, hx, hy)
    dx, dy, dz = ox * ux + oy * vx + oz * nx, ox * uy + oy * vy + oz * ny, ox * uz + oy * vz + oz * nz
    return px, py, pz, dx, dy, dz, iz, oz, half_dot_i, cos_delta


@compiled
def _place(camera: Camera, column: float, row: float) -> tuple[float, float]:
    """Where a place of the film is on the sphere, as (X, Y)."""
    dx, dy, dz = camera_ray(camera, column, row)
    sine, c, s = seen_on_sphere(camera, dx, dy, dz)
    incidence = math.asin(min(sine, 1.0))
    return incidence * c, incidence * s


@compiled
def _sees_one_cell(
    box: Box, grid: NDArray[np.float64], is_light: NDArray[np.bool_], camera: Camera, column: int, row: int,
    alpha: float, turn: float,
) -> bool:  # fmt: skip
    """Whether the lobes of a pixel stay within one cell: those of its corners and its middle do, and no light is near.

    `turn` is the angle by which the normal turns across the pixel.
    """
    found = -1
    for corner in range(5):
        u, v = (0.5, 0.5) if corner == 4 else (float(corner % 2), float(corner // 2))
        x, y = _place(camera, column + u, row + v)
        for probe in range(PROBES + 1):
            reach = 0.0 if probe == PROBES else PROBE_REACH * alpha
            angle = 2 * math.pi * probe / PROBES
            px, py, pz, dx, dy, dz, _, oz, half_dot_i, _ = _mirrored_ray(
                camera, x, y, reach * math.cos(angle), reach * math.sin(angle)
            )
            if half_dot_i <= 0 or oz <= 0:
                return False
            wall, qx, qy, qz = leave_box(box, px, py, pz, dx, dy, dz)
            cell, _, _ = cell_at(box, grid, wall, qx, qy, qz)
            if found >= 0 and cell != found:
                return False
            found = cell
    if is_light[found]:
        return True
    x, y = _place(camera, column + 0.5, row + 0.5)
    px, py, pz, nx, ny, nz, ex, ey, ez = sphere_point(camera, x, y)
    reach = PROBE_REACH * alpha + turn
    x0, x1, z0, z1 = light_within_reach(box, px, py, pz, nx, ny, nz, ex, ey, ez, reach)
    return bool(x1 <= x0 or z1 <= z0)


@compiled
def _add_sample(
    box: Box, grid: NDArray[np.float64], is_light: NDArray[np.bool_], camera: Camera, x: float, y: float,
    alpha: float, form: int, u: float, v: float, patches: NDArray[np.float32], with_light: bool, share: float,
    total: NDArray[np.float64],
) -> None:  # fmt: skip
    """Add the radiance of one half vector at (x, y) of the sphere, drawn from two uniform numbers."""
    tangent = alpha * math.sqrt(-math.log(1 - u))
    px, py, pz, dx, dy, dz, iz, oz, half_dot_i, cos_delta = _mirrored_ray(
        camera, x, y, tangent * math.cos(2 * math.pi * v), tangent * math.sin(2 * math.pi * v)
    )
    if half_dot_i <= 0 or oz <= 0:
        return
    weight = share * lobe_weight(form, iz, oz, half_dot_i, cos_delta)
    cell = add_radiance(box, grid, is_light, patches, px, py, pz, dx, dy, dz, weight, total)
    if with_light and is_light[cell]:
        total[0] += weight * box.light_luminance


@compiled
def _is_inside(weight: NDArray[np.float64]) -> bool:
    """Whether a pixel shows the sphere alone: its samples' weights add to one."""
    total = 0.0
    for k in range(len(weight)):
        total += weight[k]
    return abs(total - 1) < 1e-9


@compiled
def _pixel_rows(
    start: int, stop: int, room: Room, camera: Camera, pixels: NDArray[np.int64], first: NDArray[np.int64],
    x: NDArray[np.float64], y: NDArray[np.float64], weight: NDArray[np.float64], patches: NDArray[np.float32],
    shifts: NDArray[np.float64], alpha: float, form: int, samples: int, steps: NDArray[np.float64], with_light: bool,
    turn: float, out: NDArray[np.float64],
) -> None:  # fmt: skip
    box, grid, is_light = room.box, room.grid, room.is_light
    total = np.empty(patches.shape[3])
    for p in range(start, stop):
        if first[p + 1] == first[p]:
            continue
        total[:] = 0.0
        drawn = 0
        if _is_inside(weight[first[p] : first[p + 1]]):
            row, column = pixels[p] // camera.width, pixels[p] % camera.width
            smooth = _sees_one_cell(box, grid, is_light, camera, column, row, alpha, turn)
            count = max(1, samples // SMOOTH_PART) if smooth else samples
            for drawn in range(count):
                sx, sy = _place(
                    camera, column + (drawn * steps[0] + shifts[p, 0]) % 1.0,
                    row + (drawn * steps[1] + shifts[p, 1]) % 1.0,
                )  # fmt: skip
                u, v = (drawn * steps[2] + shifts[p, 2]) % 1.0, (drawn * steps[3] + shifts[p, 3]) % 1.0
                _add_sample(
                    box, grid, is_light, camera, sx, sy, alpha, form, u, v, patches, with_light, 1 / count, total
                )
        else:
            for k in range(first[p], first[p + 1]):
                count = max(1, int(samples * weight[k]))
                for _ in range(count):
                    u, v = (drawn * steps[2] + shifts[p, 2]) % 1.0, (drawn * steps[3] + shifts[p, 3]) % 1.0
                    _add_sample(
                        box, grid, is_light, camera, x[k], y[k], alpha, form, u, v, patches, with_light,
                        weight[k] / count, total,
                    )  # fmt: skip
                    drawn += 1
        for q in range(len(total)):
            out[p, q] = total[q]
