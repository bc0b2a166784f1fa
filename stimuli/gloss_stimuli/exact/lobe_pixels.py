"""What the sphere mirrors, pixel by pixel: for lobes so narrow that a table would have more points than the film needs.

A place in the pixel and a half vector are drawn together, from an evenly spread sequence in four dimensions that every
pixel shifts for itself. A pixel that looks at one check alone stops early.
"""

import math

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.exact.camera import Camera, camera_ray, seen_on_sphere, sphere_point
from gloss_stimuli.exact.compiled import compiled, for_rows
from gloss_stimuli.exact.film import INNER_SAMPLES
from gloss_stimuli.exact.lobe import FORMS, lobe_weight
from gloss_stimuli.exact.room import Box, Room, frame
from gloss_stimuli.exact.specular import lattice_steps
from gloss_stimuli.exact.textures import add_radiance

__all__ = ["radiance_of_pixels"]

STEPS = lattice_steps(4)
# A pixel that has met one check only in this part of its samples is smooth.
EARLY_PART = 8


def radiance_of_pixels(
    room: Room, camera: Camera, pixels: NDArray[np.int64], first: NDArray[np.int64], x: NDArray[np.float64],
    y: NDArray[np.float64], weight: NDArray[np.float64], patches: NDArray[np.float32], rng: np.random.Generator, *,
    alpha: float, form: str, samples: int, with_light: bool,
) -> NDArray[np.float64]:  # fmt: skip
    """Radiance of the mirrored room for ρs = 1, averaged over each pixel, shape (P, K).

    Parameters
    ----------
    pixels, first, x, y, weight
        Pixels, and their sphere samples as in `gloss_stimuli.exact.film.FilmMap`. Pixels well inside the outline draw
        places of their own, at the outline the samples serve.
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
        samples, STEPS, with_light, out,
    )  # fmt: skip
    return out


@compiled
def _add_sample(
    box: Box, grid: NDArray[np.float64], is_light: NDArray[np.bool_], camera: Camera, x: float, y: float,
    alpha: float, form: int, u: float, v: float, patches: NDArray[np.float32], with_light: bool, share: float,
    total: NDArray[np.float64],
) -> int:  # fmt: skip
    """Add the radiance of one half vector at (x, y) of the sphere; returns the cell it finds, -1 below the horizon."""
    px, py, pz, nx, ny, nz, ex, ey, ez = sphere_point(camera, x, y)
    ux, uy, uz, vx, vy, vz = frame(nx, ny, nz)
    ix, iy, iz = ex * ux + ey * uy + ez * uz, ex * vx + ey * vy + ez * vz, ex * nx + ey * ny + ez * nz
    tangent = alpha * math.sqrt(-math.log(1 - u))
    hx, hy = tangent * math.cos(2 * math.pi * v), tangent * math.sin(2 * math.pi * v)
    cos_delta = 1 / math.sqrt(1 + hx * hx + hy * hy)
    half_dot_i = (hx * ix + hy * iy + iz) * cos_delta
    twice = 2 * half_dot_i * cos_delta
    ox, oy, oz = twice * hx - ix, twice * hy - iy, twice - iz
    if half_dot_i <= 0 or oz <= 0:
        return -1
    dx, dy, dz = ox * ux + oy * vx + oz * nx, ox * uy + oy * vy + oz * ny, ox * uz + oy * vz + oz * nz
    weight = share * lobe_weight(form, iz, oz, half_dot_i, cos_delta)
    cell = add_radiance(box, grid, is_light, patches, px, py, pz, dx, dy, dz, weight, total)
    if with_light and is_light[cell]:
        total[0] += weight * box.light_luminance
    return cell


@compiled
def _pixel_rows(
    start: int, stop: int, room: Room, camera: Camera, pixels: NDArray[np.int64], first: NDArray[np.int64],
    x: NDArray[np.float64], y: NDArray[np.float64], weight: NDArray[np.float64], patches: NDArray[np.float32],
    shifts: NDArray[np.float64], alpha: float, form: int, samples: int, steps: NDArray[np.float64], with_light: bool,
    out: NDArray[np.float64],
) -> None:  # fmt: skip
    box, grid, is_light = room.box, room.grid, room.is_light
    total = np.empty(patches.shape[3])
    for p in range(start, stop):
        total[:] = 0.0
        if first[p + 1] - first[p] == INNER_SAMPLES * INNER_SAMPLES:
            row, column = pixels[p] // camera.width, pixels[p] % camera.width
            drawn, found, alike = 0, -2, True
            while drawn < samples and (drawn < samples // EARLY_PART or not alike):
                dx, dy, dz = camera_ray(
                    camera, column + (drawn * steps[0] + shifts[p, 0]) % 1.0,
                    row + (drawn * steps[1] + shifts[p, 1]) % 1.0,
                )  # fmt: skip
                sine, c, s = seen_on_sphere(camera, dx, dy, dz)
                incidence = math.asin(min(sine, 1.0))
                u, v = (drawn * steps[2] + shifts[p, 2]) % 1.0, (drawn * steps[3] + shifts[p, 3]) % 1.0
                cell = _add_sample(
                    box,
                    grid,
                    is_light,
                    camera,
                    incidence * c,
                    incidence * s,
                    alpha,
                    form,
                    u,
                    v,
                    patches,
                    with_light,
                    1.0,
                    total,
                )
                alike = alike and (drawn == 0 or cell == found)
                found = cell
                drawn += 1
            for q in range(len(total)):
                out[p, q] = total[q] / drawn
        else:
            drawn = 0
            for k in range(first[p], first[p + 1]):
                count = max(1, int(samples * weight[k]))
                for _ in range(count):
                    u, v = (drawn * steps[2] + shifts[p, 2]) % 1.0, (drawn * steps[3] + shifts[p, 3]) % 1.0
                    _add_sample(
                        box,
                        grid,
                        is_light,
                        camera,
                        x[k],
                        y[k],
                        alpha,
                        form,
                        u,
                        v,
                        patches,
                        with_light,
                        weight[k] / count,
                        total,
                    )
                    drawn += 1
            for q in range(len(total)):
                out[p, q] = total[q]
