"""What each pixel sees: weights of the walls' texels, points of the sphere, and the share that the light fills.

A pixel inside a check or inside the sphere's outline takes a few samples. A pixel with an edge in it, of a check, of
the light or of the sphere, is cut by scan lines across that edge; crossings are found by bisection, and each piece of
a line takes a sample of its own. What passes between the corners, the middle and the probes of a pixel is not seen,
such as a light smaller than a pixel. The map is made once and serves every paint and every α.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from gloss_stimuli.exact.camera import Camera, camera_ray, outline_radius_pixels, seen_on_sphere, sphere_point
from gloss_stimuli.exact.compiled import compiled, for_rows
from gloss_stimuli.exact.room import CEILING, Box, Room, cell_at, coordinate, leave_box
from gloss_stimuli.exact.sphere import sphere_texels
from gloss_stimuli.exact.textures import texel_at

__all__ = ["FilmMap", "map_film", "sphere_irradiance"]

# Near the outline, from this sine of incidence on, incidence changes fast and a pixel takes more samples.
RIM, RIM_SAMPLES = 0.97, 4
# Pixels this near the outline are searched for it: half a diagonal, and some more.
OUTLINE_MARGIN = 0.8
PROBES, BISECTIONS = 8, 16
# A corner of checks in a pixel takes this many times the lines of an edge.
CORNER_LINES = 4
# Samples towards the outline on each piece of a line: dense there, where incidence goes as a square root.
OUTLINE_SAMPLES = 4

LIT, ON_SPHERE = 1 << 40, -1


@dataclass(frozen=True)
class FilmMap:
    """Samples of some pixels of the film, in their order.

    Attributes
    ----------
    walls : scipy.sparse matrix, shape (P, C T T)
        Takes irradiance at wall texels to the walls' luminance: weights times ρ/π.
    light : array, shape (P,)
        Share of each pixel that shows the light.
    sphere_start : array of int, shape (P + 1,)
        First sphere sample of each pixel.
    x, y, weight : array, shape (S,)
        Sphere samples: how each is seen (`gloss_stimuli.exact.camera`), and its share of the pixel.
    """

    walls: csr_matrix
    light: NDArray[np.float64]
    sphere_start: NDArray[np.int64]
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    weight: NDArray[np.float64]


def map_film(
    room: Room, camera: Camera, pixels: NDArray[np.int64], *, texels: int, lines: int, wall_side: int = 1,
    sphere_side: int = 2,
) -> FilmMap:  # fmt: skip
    """Samples of `pixels`, row-major indices into the film.

    Parameters
    ----------
    texels : int
        Of a wall texture, along a side of a cell.
    lines : int
        Scan lines across a pixel with an edge.
    wall_side, sphere_side : int
        Samples along a side of a pixel that shows one check, or the sphere alone.
    """
    outline = outline_radius_pixels(camera)
    counts = np.zeros((len(pixels), 2), np.int64)
    nothing_i, nothing_f = np.zeros((0, 4), np.int32), np.zeros((0, 4))
    starts = np.zeros((len(pixels) + 1, 2), np.int64)
    light = np.zeros(len(pixels))
    common = (room, camera, pixels, texels, lines, wall_side, sphere_side, outline)
    for_rows(_film_rows, len(pixels), *common, False, counts, starts, nothing_i, nothing_f, nothing_f, light)
    np.cumsum(counts, axis=0, out=starts[1:])
    walls, spheres = starts[-1]
    columns, data = np.empty((walls, 4), np.int32), np.empty((walls, 4))
    seen = np.empty((spheres, 3))
    for_rows(_film_rows, len(pixels), *common, True, counts, starts, columns, data, seen, light)
    shape = (len(pixels), len(room.cell_wall) * texels**2)
    matrix = csr_matrix((data.ravel(), columns.ravel(), 4 * starts[:, 0]), shape=shape)
    return FilmMap(
        matrix, light, starts[:, 1].copy(), seen[:, 0].copy(), seen[:, 1].copy(), seen[:, 2].copy()
    )  # fmt: skip


def sphere_irradiance(camera: Camera, film: FilmMap, texture: NDArray[np.float64]) -> NDArray[np.float64]:
    """Irradiance of the sphere averaged over each pixel, shape (P, K), from its texture, shape (T, 2 T, K)."""
    out = np.zeros((len(film.light), texture.shape[2]))
    for_rows(_irradiance_rows, len(out), camera, film.sphere_start, film.x, film.y, film.weight, texture, out)
    return out


@compiled
def _identity(box: Box, camera: Camera, column: float, row: float) -> int:
    """A number for the surface seen at a place of the film: the sphere, a check, or the light before one."""
    dx, dy, dz = camera_ray(camera, column, row)
    sine, _, _ = seen_on_sphere(camera, dx, dy, dz)
    if sine < 1:
        return ON_SPHERE
    wall, x, y, z = leave_box(box, camera.eye[0], camera.eye[1], camera.eye[2], dx, dy, dz)
    if wall == CEILING and box.light_low[0] < x < box.light_high[0] and box.light_low[1] < z < box.light_high[1]:
        return LIT
    axis = wall // 2
    along_a, along_b = (axis + 1) % 3, (axis + 2) % 3
    a = int((coordinate(x, y, z, along_a) - box.low[along_a]) / box.check)
    b = int((coordinate(x, y, z, along_b) - box.low[along_b]) / box.check)
    return (wall << 30) | (a << 15) | b


@compiled
def _identity_across(box: Box, camera: Camera, across: float, along: float, by_rows: bool) -> int:
    return _identity(box, camera, along, across) if by_rows else _identity(box, camera, across, along)


@compiled
def _put_wall(
    box: Box, grid: NDArray[np.float64], reflectance: NDArray[np.float64], camera: Camera, column: float, row: float,
    weight: float, texels: int, at: int, columns: NDArray[np.int32], data: NDArray[np.float64],
) -> None:  # fmt: skip
    dx, dy, dz = camera_ray(camera, column, row)
    wall, x, y, z = leave_box(box, camera.eye[0], camera.eye[1], camera.eye[2], dx, dy, dz)
    cell, u, v = cell_at(box, grid, wall, x, y, z)
    a, fa = texel_at(u, texels)
    b, fb = texel_at(v, texels)
    first = (cell * texels + b) * texels + a
    value = weight * reflectance[cell] / math.pi
    columns[at, 0], columns[at, 1], columns[at, 2], columns[at, 3] = (
        first,
        first + 1,
        first + texels,
        first + texels + 1,
    )
    data[at, 0], data[at, 1] = value * (1 - fa) * (1 - fb), value * fa * (1 - fb)
    data[at, 2], data[at, 3] = value * (1 - fa) * fb, value * fa * fb


@compiled
def _put_sphere(camera: Camera, column: float, row: float, weight: float, at: int, seen: NDArray[np.float64]) -> None:
    dx, dy, dz = camera_ray(camera, column, row)
    sine, c, s = seen_on_sphere(camera, dx, dy, dz)
    incidence = math.asin(min(sine, 1.0))
    seen[at, 0], seen[at, 1], seen[at, 2] = incidence * c, incidence * s, weight


@compiled
def _cut_line(
    box: Box, camera: Camera, base: int, along: float, by_rows: bool, cuts: NDArray[np.float64],
    pieces: NDArray[np.int64],
) -> int:  # fmt: skip
    """Cut a line across a pixel where the surface changes; the number of pieces.

    Piece k runs from cuts[k] to cuts[k + 1] and shows the surface pieces[k].
    """
    previous, name = float(base), _identity_across(box, camera, base, along, by_rows)
    cuts[0], pieces[0], n = previous, name, 1
    for probe in range(1, PROBES + 1):
        x = base + probe / PROBES
        found = _identity_across(box, camera, x, along, by_rows)
        while found != name and n < len(pieces):
            low, high = previous, x
            for _ in range(BISECTIONS):
                half = 0.5 * (low + high)
                if _identity_across(box, camera, half, along, by_rows) == name:
                    low = half
                else:
                    high = half
            # What begins here may end before the next probe.
            name = _identity_across(box, camera, high, along, by_rows)
            cuts[n], pieces[n] = 0.5 * (low + high), name
            n += 1
            previous = high
        previous = x
    cuts[n] = base + 1.0
    return n


@compiled
def _towards_outline(low: float, high: float, before: bool, after: bool, k: int) -> tuple[float, float]:
    """Place and share of the k-th sample of a piece that shows the sphere, with its outline before or after it."""
    z = (k + 0.5) / OUTLINE_SAMPLES
    if before and not after:
        return low + (high - low) * z * z, 2 * z
    if after and not before:
        return high - (high - low) * z * z, 2 * z
    return low + (high - low) * z, 1.0


@compiled
def _edge_pixel(
    room: Room, camera: Camera, column: int, row: int, by_rows: bool, lines: int, texels: int, fill: bool, to_wall: int,
    to_sphere: int, columns: NDArray[np.int32], data: NDArray[np.float64], seen: NDArray[np.float64],
) -> tuple[int, int, float]:  # fmt: skip
    """Sample a pixel with an edge in it; where its wall and sphere samples end, and the light's share."""
    box, grid, reflectance = room.box, room.grid, room.reflectance
    cuts, pieces = np.empty(2 * PROBES + 2), np.empty(2 * PROBES + 1, np.int64)
    base, other = (row, column) if by_rows else (column, row)
    lit = 0.0
    for line in range(lines):
        along = other + (line + 0.5) / lines
        n = _cut_line(box, camera, base, along, by_rows, cuts, pieces)
        for piece in range(n):
            low, high = cuts[piece], cuts[piece + 1]
            weight = (high - low) / lines
            if pieces[piece] == LIT:
                lit += weight
            elif pieces[piece] == ON_SPHERE:
                for k in range(OUTLINE_SAMPLES):
                    x, share = _towards_outline(low, high, piece > 0, piece < n - 1, k)
                    if fill:
                        u, v = (along, x) if by_rows else (x, along)
                        _put_sphere(camera, u, v, share * weight / OUTLINE_SAMPLES, to_sphere, seen)
                    to_sphere += 1
            else:
                if fill:
                    u, v = (along, 0.5 * (low + high)) if by_rows else (0.5 * (low + high), along)
                    _put_wall(box, grid, reflectance, camera, u, v, weight, texels, to_wall, columns, data)
                to_wall += 1
    return to_wall, to_sphere, lit


@compiled
def _film_rows(
    start: int, stop: int, room: Room, camera: Camera, pixels: NDArray[np.int64], texels: int, lines: int,
    wall_side: int, sphere_side: int, outline: float, fill: bool, counts: NDArray[np.int64], starts: NDArray[np.int64],
    columns: NDArray[np.int32], data: NDArray[np.float64], seen: NDArray[np.float64], light: NDArray[np.float64],
) -> None:  # fmt: skip
    """Count the samples of each pixel, or write them where `starts` says."""
    box, grid, reflectance = room.box, room.grid, room.reflectance
    for p in range(start, stop):
        row, column = pixels[p] // camera.width, pixels[p] % camera.width
        to_wall, to_sphere, lit = starts[p, 0], starts[p, 1], 0.0
        dx, dy, dz = camera_ray(camera, column + 0.5, row + 0.5)
        sine, _, _ = seen_on_sphere(camera, dx, dy, dz)
        middle = _identity(box, camera, column + 0.5, row + 0.5)
        upper_left, upper_right = _identity(box, camera, column, row), _identity(box, camera, column + 1, row)
        lower_left, lower_right = _identity(box, camera, column, row + 1), _identity(box, camera, column + 1, row + 1)
        uniform = middle == upper_left == upper_right == lower_left == lower_right
        if not uniform or abs(sine - 1) * outline < OUTLINE_MARGIN:
            changes_x = (upper_left != upper_right) + (lower_left != lower_right)
            changes_y = (upper_left != lower_left) + (upper_right != lower_right)
            count = lines * CORNER_LINES if changes_x > 0 and changes_y > 0 else lines
            to_wall, to_sphere, lit = _edge_pixel(
                room, camera, column, row, changes_y > changes_x, count, texels, fill, to_wall, to_sphere, columns,
                data, seen,
            )  # fmt: skip
        elif middle == ON_SPHERE:
            side = sphere_side if sine < RIM else sphere_side * RIM_SAMPLES
            for k in range(side * side if fill else 0):
                u, v = column + (k % side + 0.5) / side, row + (k // side + 0.5) / side
                _put_sphere(camera, u, v, 1 / (side * side), to_sphere + k, seen)
            to_sphere += side * side
        elif middle == LIT:
            lit = 1.0
        else:
            side = wall_side
            for k in range(side * side if fill else 0):
                u, v = column + (k % side + 0.5) / side, row + (k // side + 0.5) / side
                _put_wall(box, grid, reflectance, camera, u, v, 1 / (side * side), texels, to_wall + k, columns, data)
            to_wall += side * side
        counts[p, 0], counts[p, 1] = to_wall - starts[p, 0], to_sphere - starts[p, 1]
        light[p] = lit


@compiled
def _irradiance_rows(
    start: int, stop: int, camera: Camera, first: NDArray[np.int64], x: NDArray[np.float64], y: NDArray[np.float64],
    weight: NDArray[np.float64], texture: NDArray[np.float64], out: NDArray[np.float64],
) -> None:  # fmt: skip
    rows = texture.shape[0]
    for p in range(start, stop):
        for k in range(first[p], first[p + 1]):
            _, _, _, nx, ny, nz, _, _, _ = sphere_point(camera, x[k], y[k])
            row, left, right, fu, fv = sphere_texels(nx, ny, nz, rows)
            for q in range(texture.shape[2]):
                upper = (1 - fv) * texture[row, left, q] + fv * texture[row, right, q]
                lower = (1 - fv) * texture[row + 1, left, q] + fv * texture[row + 1, right, q]
                out[p, q] += weight[k] * ((1 - fu) * upper + fu * lower)
