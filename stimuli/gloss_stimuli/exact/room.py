"""The room as kernels see it: six walls of cells, a sphere, a light; and how rays meet them.

Wall w lies across axis ``w // 2``, at its low end if w is even and its high end if odd. Within a wall, coordinate a
runs along the next axis and b along the one after it (cyclically). A *cell* is a check or a part of one: no edge of a
check or of the light ever runs through a cell, so what a cell emits is smooth.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.exact.compiled import compiled
from gloss_stimuli.scene import Scene

__all__ = ["CEILING", "Box", "Room", "build_room", "cell_at", "coordinate", "frame", "leave_box"]

CEILING = 3


class Box(NamedTuple):
    """The numbers of a room. Kernels pass these to what they call; arrays of a named tuple would be counted at each
    call.

    Attributes
    ----------
    low, high : tuple of float
        Corners of the box.
    center, radius
        The sphere.
    check : float
        Width of a check.
    light_low, light_high : tuple of float
        x and z where the light begins and ends.
    light_luminance : float
        In cd/m².
    """

    low: tuple[float, float, float]
    high: tuple[float, float, float]
    center: tuple[float, float, float]
    radius: float
    check: float
    light_low: tuple[float, float]
    light_high: tuple[float, float]
    light_luminance: float


class Room(NamedTuple):
    """A box and the cells of its walls, as compiled code takes them; make one with `build_room`.

    Attributes
    ----------
    box : Box
    wall_start : array of int, shape (7,)
        First cell of each wall, and the number of cells.
    cells_along : array of int, shape (6, 2)
        Number of cells of each wall along a and b.
    grid : array, shape (6, 2, n)
        What `cell_at` needs of each wall along a and b: the wall's first cell, the number of cells, the number of
        checks, then the first cell of each row of checks, then where the cells begin and end.
    cell_wall : array of int, shape (C,)
        Wall of each cell.
    cell_low, cell_high : array, shape (C, 2)
        Where each cell begins and ends along a and b.
    reflectance : array, shape (C,)
        Of each cell; 0 where the light is.
    is_light : array of bool, shape (C,)
    edge_cells : array of int, shape (6, m)
        Cells of other walls that begin within half a check of each wall's plane; -1 where there are no more.
    """

    box: Box
    wall_start: NDArray[np.int64]
    cells_along: NDArray[np.int64]
    grid: NDArray[np.float64]
    cell_wall: NDArray[np.int64]
    cell_low: NDArray[np.float64]
    cell_high: NDArray[np.float64]
    reflectance: NDArray[np.float64]
    is_light: NDArray[np.bool_]
    edge_cells: NDArray[np.int64]


def build_room(scene: Scene, *, width_over_gap: float) -> Room:
    """Divide the walls of a scene into cells.

    Parameters
    ----------
    scene : Scene
    width_over_gap : float
        A check is split where it is wider than this times its distance from the sphere: what the sphere hides and
        returns varies on that scale.
    """
    box, light = scene.box, scene.light
    low, high = np.array(box.minimum), np.array(box.maximum)
    half = np.array(light.size_xz) / 2
    light_low, light_high = np.array(light.center_xz) - half, np.array(light.center_xz) + half
    cuts = {2: [light_low[1], light_high[1]], 0: [light_low[0], light_high[0]]}  # of the ceiling, by axis
    lines, firsts = [], []
    for wall in range(6):
        axis = wall // 2
        plane = (low, high)[wall % 2][axis]
        for along in ((axis + 1) % 3, (axis + 2) % 3):
            places, first = _lines(
                low[along], high[along], box.check_size, cuts[along] if wall == CEILING else [],
                center=scene.sphere.center[along], height=abs(scene.sphere.center[axis] - plane),
                radius=scene.sphere.radius, width_over_gap=width_over_gap,
            )  # fmt: skip
            lines.append(places)
            firsts.append(first)
    cells_along = np.array([len(places) - 1 for places in lines]).reshape(6, 2)
    wall_start = np.concatenate([[0], np.cumsum(cells_along.prod(1))])
    cell_wall = np.repeat(np.arange(6), np.diff(wall_start))
    number = np.arange(wall_start[-1]) - wall_start[cell_wall]
    place = np.stack([number % cells_along[cell_wall, 0], number // cells_along[cell_wall, 0]], axis=1)
    ends = [[lines[2 * wall + side][place[cell, side] :][:2] for side in (0, 1)] for cell, wall in enumerate(cell_wall)]
    cell_low, cell_high = np.moveaxis(np.array(ends), 2, 0)
    middle = (cell_low + cell_high) / 2
    axes = cell_wall // 2
    checks = np.floor((middle - np.stack([low[(axes + 1) % 3], low[(axes + 2) % 3]], axis=1)) / box.check_size)
    is_light = (cell_wall == CEILING) & (middle > light_low[::-1]).all(1) & (middle < light_high[::-1]).all(1)
    reflectance = np.where(checks.sum(1) % 2 == 0, box.dark_reflectance, box.light_reflectance)
    return Room(
        box=Box(
            low=_triple(low), high=_triple(high), center=_triple(scene.sphere.center),
            radius=float(scene.sphere.radius), check=float(box.check_size),
            light_low=(float(light_low[0]), float(light_low[1])),
            light_high=(float(light_high[0]), float(light_high[1])),
            light_luminance=float(light.luminance_cd_m2),
        ),
        wall_start=wall_start, cells_along=cells_along, grid=_grid(wall_start, lines, firsts),
        cell_wall=cell_wall, cell_low=np.ascontiguousarray(cell_low), cell_high=np.ascontiguousarray(cell_high),
        reflectance=np.where(is_light, 0.0, reflectance), is_light=is_light,
        edge_cells=_edge_cells(low, high, box.check_size, cell_wall, cell_low, cell_high),
    )  # fmt: skip


def _grid(
    wall_start: NDArray[np.int64], lines: list[NDArray[np.float64]], firsts: list[NDArray[np.int64]]
) -> NDArray[np.float64]:
    rows = [
        np.concatenate([[wall_start[index // 2], len(places) - 1, len(first)], first, places])
        for index, (places, first) in enumerate(zip(lines, firsts, strict=True))
    ]
    return _padded(rows, np.inf).reshape(6, 2, -1)


def _edge_cells(
    low: NDArray[np.float64], high: NDArray[np.float64], check: float, cell_wall: NDArray[np.int64],
    cell_low: NDArray[np.float64], cell_high: NDArray[np.float64],
) -> NDArray[np.int64]:  # fmt: skip
    found = []
    for wall in range(6):
        axis, across = wall // 2, cell_wall // 2
        side = np.where((across + 1) % 3 == axis, 0, 1)
        cells = np.arange(len(cell_wall))
        gap = high[axis] - cell_high[cells, side] if wall % 2 else cell_low[cells, side] - low[axis]
        found.append(np.flatnonzero((across != axis) & (gap < 0.5 * check)))
    return _padded(found, -1).astype(np.int64)


def _lines(
    low: float, high: float, check: float, cuts: list[float], *,
    center: float, height: float, radius: float, width_over_gap: float,
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:  # fmt: skip
    """Lines between cells along one direction of a wall, and the first cell of each check."""
    sliver = 1e-9 * (high - low)
    count = max(1, math.ceil((high - low - sliver) / check))
    lines: list[float] = []
    first = []
    for index in range(count):
        begin, end = low + index * check, min(low + (index + 1) * check, high)
        first.append(len(lines))
        inside = [cut for cut in cuts if begin + sliver < cut < end - sliver]
        for start, stop in zip([begin, *inside], [*inside, end], strict=True):
            beside = max(start - center, center - stop, 0.0)
            gap = math.hypot(height, beside) - radius
            parts = max(1, math.ceil((stop - start) / (width_over_gap * gap) - 1e-9))
            lines += [start + (stop - start) * part / parts for part in range(parts)]
    return np.array([*lines, high]), np.array(first)


def _padded(rows: list[Any], filling: float) -> NDArray[np.float64]:
    result = np.full((len(rows), max(len(row) for row in rows) + 1), filling)
    for target, row in zip(result, rows, strict=True):
        target[: len(row)] = row
    return result


def _triple(values: Any) -> tuple[float, float, float]:
    return float(values[0]), float(values[1]), float(values[2])


@compiled
def coordinate(x: float, y: float, z: float, axis: int) -> float:
    """The coordinate along an axis."""
    return x if axis == 0 else (y if axis == 1 else z)


@compiled
def frame(x: float, y: float, z: float) -> tuple[float, float, float, float, float, float]:
    """Two unit vectors that make a right-handed frame with the unit vector (x, y, z): Duff et al. 2017."""
    sign = 1.0 if z >= 0 else -1.0
    a = -1.0 / (sign + z)
    b = x * y * a
    return 1 + sign * x * x * a, sign * b, -sign * x, b, sign + y * y * a, -y


@compiled
def leave_box(
    box: Box, px: float, py: float, pz: float, dx: float, dy: float, dz: float
) -> tuple[int, float, float, float]:
    """Wall that a ray from inside the box meets, and the point where."""
    # A direction of zero gives an infinite way, or NaN from a point on the wall; neither is the shortest.
    tx = ((box.high[0] if dx > 0 else box.low[0]) - px) / dx if dx != 0 else np.inf
    ty = ((box.high[1] if dy > 0 else box.low[1]) - py) / dy if dy != 0 else np.inf
    tz = ((box.high[2] if dz > 0 else box.low[2]) - pz) / dz if dz != 0 else np.inf
    if tx < ty and tx < tz:
        t, wall = tx, 1 if dx > 0 else 0
    elif ty < tz:
        t, wall = ty, 3 if dy > 0 else 2
    else:
        t, wall = tz, 5 if dz > 0 else 4
    return wall, px + t * dx, py + t * dy, pz + t * dz


@compiled
def cell_at(box: Box, grid: NDArray[np.float64], wall: int, x: float, y: float, z: float) -> tuple[int, float, float]:
    """Cell of a point on a wall, and its coordinates in that cell, each from 0 to 1."""
    if wall < 2:
        a, b, low_a, low_b = y, z, box.low[1], box.low[2]
    elif wall < 4:
        a, b, low_a, low_b = z, x, box.low[2], box.low[0]
    else:
        a, b, low_a, low_b = x, y, box.low[0], box.low[1]
    ia, ua = _place(grid, wall, 0, a, low_a, box.check)
    ib, ub = _place(grid, wall, 1, b, low_b, box.check)
    return int(grid[wall, 0, 0]) + ib * int(grid[wall, 0, 1]) + ia, ua, ub


@compiled
def _place(
    grid: NDArray[np.float64], wall: int, side: int, value: float, low: float, check_size: float
) -> tuple[int, float]:
    last, checks = int(grid[wall, side, 1]) - 1, int(grid[wall, side, 2])
    check = min(max(int((value - low) / check_size), 0), checks - 1)
    index = int(grid[wall, side, 3 + check])
    lines = 3 + checks
    while index < last and value >= grid[wall, side, lines + index + 1]:
        index += 1
    begin, end = grid[wall, side, lines + index], grid[wall, side, lines + index + 1]
    return index, min(max((value - begin) / (end - begin), 0.0), 1.0)
