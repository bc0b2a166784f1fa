"""What the sphere mirrors, tabulated: the radiance of the room through Ward's lobe, by where the sphere is seen.

Over the place (X, Y) on the sphere (`gloss_stimuli.exact.camera`) reflected radiance is the mirrored room convolved
with a Gaussian of width α: its spectrum falls as exp(-α² k² / 4), so a table with a spacing of half α holds all of it.
A power of the viewing cosine keeps it smooth up to the outline. Pixels look it up by quintic B-splines.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, spline_filter

from gloss_stimuli.exact.camera import LARGEST_INCIDENCE, Camera, sphere_point
from gloss_stimuli.exact.compiled import compiled, for_rows
from gloss_stimuli.exact.lobe import FORMS, GRAZING_POWER, lobe_weight, mirrored
from gloss_stimuli.exact.lobe_light import Rules, light_by_lobe, light_rules
from gloss_stimuli.exact.room import Room, frame
from gloss_stimuli.exact.sphere import GOLDEN
from gloss_stimuli.exact.textures import add_radiance

__all__ = ["LobeTable", "look_up", "make_table", "table_points"]

ORDER = 5  # of the splines
# Points beyond the outline, so that the spline is not cut off there.
MARGIN = 4
# Lattices of half vectors; each point of a table takes one of them, turned by an angle of its own.
LATTICES = 64


@dataclass(frozen=True)
class LobeTable:
    """B-spline coefficients of reflected radiance times a power of the viewing cosine, for ρs = 1.

    Attributes
    ----------
    coefficients : array, shape (2 H + 1, 2 H + 1, K)
        Over Y and X, in steps of `spacing` about (0, 0); one for each field of the walls.
    spacing : float
        Radians.
    half : int
        H.
    power : float
        Of the viewing cosine.
    """

    coefficients: NDArray[np.float64]
    spacing: float
    half: int
    power: float


def table_points(alpha: float, spacing: float) -> int:
    """Number of points of a table for `alpha`, its spacing in units of α."""
    return int(math.pi * (math.pi / 2 / (spacing * alpha) + MARGIN) ** 2)


def make_table(
    room: Room, camera: Camera, patches: NDArray[np.float32], rng: np.random.Generator, *,
    alpha: float, form: str, spacing: float, samples: int, light_points: int,
) -> LobeTable:  # fmt: skip
    """Tabulate reflected radiance.

    Parameters
    ----------
    patches : array, shape (C, b, a, K)
        Radiance of the walls at even vertices of each cell; the first field is the one that the light belongs to.
    rng : numpy.random.Generator
        Shifts and turns of the lattices.
    spacing : float
        Of the table, in units of α.
    samples : int
        Half vectors a point.
    light_points : int
        Gauss points across the part of the light that the lobe reaches.
    """
    step = spacing * alpha
    half = math.ceil(math.pi / 2 / step) + MARGIN + 1
    grid = np.arange(-half, half + 1) * step
    x, y = np.meshgrid(grid, grid)
    inside = np.hypot(x, y) <= math.pi / 2 + MARGIN * step
    count = int(inside.sum())
    values = np.empty((count, patches.shape[3]))
    for_rows(
        _table_rows, count, room, camera, x[inside], y[inside], alpha, FORMS.index(form), _lattices(rng, samples),
        rng.integers(0, LATTICES, count), rng.random(count), patches, light_rules(light_points),
        GRAZING_POWER[form], values,
    )  # fmt: skip
    if not np.isfinite(values).all():
        raise FloatingPointError(f"Reflected radiance for alpha = {alpha:g} came out not finite.")
    table = np.zeros((*x.shape, patches.shape[3]))
    table[inside] = values
    nearest = distance_transform_edt(~inside, return_distances=False, return_indices=True)
    table = table[nearest[0], nearest[1]]
    coefficients = np.stack([spline_filter(table[..., k], order=ORDER) for k in range(table.shape[2])], axis=-1)
    return LobeTable(np.ascontiguousarray(coefficients), step, half, GRAZING_POWER[form])


def look_up(
    table: LobeTable, first: NDArray[np.int64], x: NDArray[np.float64], y: NDArray[np.float64],
    weight: NDArray[np.float64],
) -> NDArray[np.float64]:  # fmt: skip
    """Radiance averaged over the sphere samples of each pixel, shape (P, K)."""
    out = np.zeros((len(first) - 1, table.coefficients.shape[2]))
    for_rows(
        _look_up_rows, len(out), table.coefficients, table.spacing, table.half, table.power, first, x, y, weight, out
    )
    return out


def _lattices(rng: np.random.Generator, samples: int) -> NDArray[np.float64]:
    """Half vectors (tan δ cos, tan δ sin) / α drawn from the lobe, shape (LATTICES, samples, 2)."""
    k = np.arange(samples)
    shifts = rng.random((LATTICES, 2, 1))
    radius = np.sqrt(-np.log1p(-(k + shifts[:, 0]) / samples))
    angle = 2 * np.pi * (k * GOLDEN + shifts[:, 1])
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)


@compiled
def _table_rows(
    start: int, stop: int, room: Room, camera: Camera, x: NDArray[np.float64], y: NDArray[np.float64], alpha: float,
    form: int, lattices: NDArray[np.float64], lattice: NDArray[np.int64], turn: NDArray[np.float64],
    patches: NDArray[np.float32], rules: Rules, power: float,
    out: NDArray[np.float64],
) -> None:  # fmt: skip
    samples, fields = lattices.shape[1], patches.shape[3]
    total = np.empty(fields)
    box, grid, is_light = room.box, room.grid, room.is_light
    for p in range(start, stop):
        px, py, pz, nx, ny, nz, ex, ey, ez = sphere_point(camera, x[p], y[p])
        ux, uy, uz, vx, vy, vz = frame(nx, ny, nz)
        ix, iy, iz = ex * ux + ey * uy + ez * uz, ex * vx + ey * vy + ez * vz, ex * nx + ey * ny + ez * nz
        c, s = alpha * math.cos(2 * math.pi * turn[p]), alpha * math.sin(2 * math.pi * turn[p])
        total[:] = 0.0
        for k in range(samples):
            tx, ty = lattices[lattice[p], k, 0], lattices[lattice[p], k, 1]
            hx, hy = c * tx - s * ty, s * tx + c * ty
            ox, oy, oz, half_dot_i, cos_delta = mirrored(ix, iy, iz, hx, hy)
            if half_dot_i <= 0 or oz <= 0:
                continue
            dx, dy, dz = ox * ux + oy * vx + oz * nx, ox * uy + oy * vy + oz * ny, ox * uz + oy * vz + oz * nz
            weight = lobe_weight(form, iz, oz, half_dot_i, cos_delta)
            add_radiance(box, grid, is_light, patches, px, py, pz, dx, dy, dz, weight, total)
        smooth = iz**power
        for q in range(fields):
            out[p, q] = smooth * total[q] / samples
        out[p, 0] += smooth * light_by_lobe(
            box, px, py, pz, nx, ny, nz, ex, ey, ez, alpha, form, rules
        )  # fmt: skip


@compiled
def _spline_weights(t: float, out: NDArray[np.float64]) -> None:
    """Values of the six quintic B-splines that reach a place `t` (0 to 1) between knots: the Cox–de Boor recursion."""
    out[0] = 1.0
    for order in range(1, ORDER + 1):
        out[order] = t / order * out[order - 1]
        for k in range(order - 1, 0, -1):
            out[k] = ((t + order - k) * out[k - 1] + (1 + k - t) * out[k]) / order
        out[0] *= (1 - t) / order


@compiled
def _look_up_rows(
    start: int, stop: int, coefficients: NDArray[np.float64], spacing: float, half: int, power: float,
    first: NDArray[np.int64], x: NDArray[np.float64], y: NDArray[np.float64], weight: NDArray[np.float64],
    out: NDArray[np.float64],
) -> None:  # fmt: skip
    fields = coefficients.shape[2]
    wx, wy = np.empty(ORDER + 1), np.empty(ORDER + 1)
    for p in range(start, stop):
        for k in range(first[p], first[p + 1]):
            column, row = x[k] / spacing + half, y[k] / spacing + half
            i, j = int(column), int(row)
            _spline_weights(column - i, wx)
            _spline_weights(row - j, wy)
            # As the table's own points, a sample at the outline is taken from just inside.
            incidence = min(math.sqrt(x[k] * x[k] + y[k] * y[k]), LARGEST_INCIDENCE)
            scale = weight[k] / math.cos(incidence) ** power
            for b in range(ORDER + 1):
                for a in range(ORDER + 1):
                    share = scale * wy[b] * wx[a]
                    for q in range(fields):
                        out[p, q] += share * coefficients[j - 2 + b, i - 2 + a, q]
