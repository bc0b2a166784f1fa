"""A second, slow opinion on the box: written from the physics in plain numpy, it shares no code with the renderer."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy.stats import qmc

from gloss_stimuli.exact.room import Room
from gloss_stimuli.scene import Scene, read_scene

CEILING = 3


def scene_of(**sections: dict) -> Scene:
    """The default scene with some values replaced; `scene_with` for what is made once a module."""
    document = read_scene().model_dump(mode="json")
    for name, values in sections.items():
        document[name].update(values)
    return Scene.model_validate(document)


def furnace(room: Room, reflectance: float) -> Room:
    """The room with every check of one reflectance, and a light that is a wall like any other."""
    return room._replace(is_light=np.zeros_like(room.is_light), reflectance=np.full_like(room.reflectance, reflectance))


def inward(wall: int) -> np.ndarray:
    """Normal of a wall, into the room."""
    normal = np.zeros(3)
    normal[wall // 2] = 1 - 2 * (wall % 2)
    return normal


def wall_normals(walls: np.ndarray) -> np.ndarray:
    """Normals of several walls, shape (P, 3)."""
    return np.array([inward(wall) for wall in walls])


def polygon_irradiance(corners: np.ndarray, point: np.ndarray, normal: np.ndarray) -> float:
    """Irradiance over radiance, from a polygon above the horizon: Lambert's sum of angle × cosine over edges."""
    rays = corners - point
    rays = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    total = 0.0
    for here, there in zip(rays, np.roll(rays, -1, axis=0), strict=True):
        edge = np.cross(here, there)
        total += np.arccos(np.clip(here @ there, -1, 1)) * (edge @ normal) / np.linalg.norm(edge)
    return abs(total) / 2


def view_factor(scene: Scene, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Part of the view that a sphere wholly above the horizon fills: r² cosθ / d²."""
    away = np.array(scene.sphere.center) - points
    return scene.sphere.radius**2 * (away * normals).sum(1) / np.linalg.norm(away, axis=1) ** 3


def rectangle(wall: int, plane: float, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Corners of a rectangle on a wall, whose coordinates run along the next axis and the one after it."""
    axis = wall // 2
    corners = np.full((4, 3), plane)
    corners[:, (axis + 1) % 3] = [low[0], high[0], high[0], low[0]]
    corners[:, (axis + 2) % 3] = [low[1], low[1], high[1], high[1]]
    return corners


def plane(room: Room, wall: int) -> float:
    """Coordinate of a wall along its axis."""
    return (room.box.low, room.box.high)[wall % 2][wall // 2]


def corners_of(room: Room, cell: int) -> np.ndarray:
    """Corners of a cell."""
    wall = room.cell_wall[cell]
    return rectangle(wall, plane(room, wall), room.cell_low[cell], room.cell_high[cell])


def kernel(point: np.ndarray, wall: int, sources: np.ndarray, other: int) -> np.ndarray:
    """cosθ cosθ' / (π r²) from sources on one wall to a point on another."""
    way = sources - point
    r2 = (way**2).sum(-1)
    return np.maximum(way @ inward(wall), 0) * np.maximum(-way @ inward(other), 0) / (np.pi * r2**2)


def graded(low: float, high: float, toward: float, scale: float) -> tuple[np.ndarray, np.ndarray]:
    """Gauss points on panels that halve towards a place, down to a scale: any integrand that peaks there is smooth."""
    x, w = np.polynomial.legendre.leggauss(12)
    x, w = (x + 1) / 2, w / 2
    near = min(max(toward, low), high)
    panels = []
    for reach in (low - near, high - near):
        halvings = max(0, int(np.ceil(np.log2(max(abs(reach), 1e-300) / scale))) + 2)
        edges = near + reach * np.append(2.0 ** -np.arange(halvings + 1.0), 0.0)
        panels += [sorted(pair) for pair in pairwise(edges)]
    places = np.concatenate([begin + (end - begin) * x for begin, end in panels])
    return places, np.concatenate([(end - begin) * w for begin, end in panels])


def by_graded_quadrature(room: Room, point: np.ndarray, wall: int, cell: int, radiosity: Callable) -> float:
    """Irradiance of a point from a cell whose radiosity is a function of its two coordinates from 0 to 1."""
    other = int(room.cell_wall[cell])
    height = abs(point[other // 2] - plane(room, other))
    low, high = room.cell_low[cell], room.cell_high[cell]
    (a, wa), (b, wb) = (
        graded(low[side], high[side], point[(other // 2 + 1 + side) % 3], height) for side in (0, 1)
    )  # fmt: skip
    sources = np.full((len(b), len(a), 3), plane(room, other))
    sources[..., (other // 2 + 1) % 3], sources[..., (other // 2 + 2) % 3] = a, b[:, None]
    u, v = (a - low[0]) / (high[0] - low[0]), (b - low[1]) / (high[1] - low[1])
    return float(np.einsum("b,a,ba,ba->", wb, wa, kernel(point, wall, sources, other), radiosity(u, v[:, None])))


def light_rectangle(scene: Scene) -> np.ndarray:
    """Corners of the light."""
    (x, z), (width, depth) = scene.light.center_xz, scene.light.size_xz
    y = scene.box.maximum[1]
    return np.array(
        [[x + sx * width / 2, y, z + sz * depth / 2] for sx, sz in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    )  # fmt: skip


def cosine_directions(normal: np.ndarray, power: int, seed: int) -> np.ndarray:
    """2^power directions about a normal, distributed as the cosine, evenly spread: their mean is irradiance over π."""
    u, v = qmc.Sobol(2, rng=np.random.default_rng(seed)).random_base2(power).T
    across = np.eye(3)[np.argmin(np.abs(normal))]
    s = np.cross(normal, across)
    s /= np.linalg.norm(s)
    t = np.cross(normal, s)
    radius, angle = np.sqrt(u)[:, None], 2 * np.pi * v[:, None]
    return radius * np.cos(angle) * s + radius * np.sin(angle) * t + np.sqrt(1 - u)[:, None] * normal


@dataclass(frozen=True)
class Enclosure:
    """The box and the sphere of a scene as rays meet them."""

    scene: Scene

    @cached_property
    def low(self) -> np.ndarray:
        return np.array(self.scene.box.minimum)

    @cached_property
    def high(self) -> np.ndarray:
        return np.array(self.scene.box.maximum)

    @cached_property
    def center(self) -> np.ndarray:
        return np.array(self.scene.sphere.center)

    def meets_sphere(self, origins: np.ndarray, directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Whether rays from outside meet the sphere, and the way to it: the quadratic equation."""
        away = origins - self.center
        a = (directions**2).sum(-1)
        b = (away * directions).sum(-1)
        c = (away**2).sum(-1) - self.scene.sphere.radius**2
        discriminant = b * b - a * c
        met = (discriminant > 0) & (b < 0)
        return met, np.where(met, (-b - np.sqrt(np.maximum(discriminant, 0))) / a, np.inf)

    def leave(self, origins: np.ndarray, directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Wall that each ray from inside the box meets, and the point where: the nearest of six planes ahead."""
        ways = np.full((len(directions), 6), np.inf)
        origins = np.broadcast_to(origins, directions.shape)
        for wall in range(6):
            axis, plane = wall // 2, (self.low, self.high)[wall % 2][wall // 2]
            ahead = directions[:, axis] * (1 if wall % 2 else -1) > 0
            ways[ahead, wall] = (plane - origins[ahead, axis]) / directions[ahead, axis]
        wall = ways.argmin(1)
        return wall, origins + ways[np.arange(len(wall)), wall][:, None] * directions

    def in_light(self, wall: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Whether wall points lie in the light."""
        (x, z), (width, depth) = self.scene.light.center_xz, self.scene.light.size_xz
        beside = (np.abs(points[:, 0] - x) < width / 2) & (np.abs(points[:, 2] - z) < depth / 2)
        return (wall == CEILING) & beside

    def reflectance(self, wall: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Of wall points: dark where the numbers of the check, counted from `minimum`, have an even sum."""
        number = np.floor((points - self.low) / self.scene.box.check_size)
        number[np.arange(len(wall)), wall // 2] = 0  # a wall has two numbers
        paint = np.where(number.sum(1) % 2 == 0, self.scene.box.dark_reflectance, self.scene.box.light_reflectance)
        return np.where(self.in_light(wall, points), 0.0, paint)


def irradiance_by_rays(
    enclosure: Enclosure, point: np.ndarray, normal: np.ndarray, irradiance: Callable, *, power: int, seed: int = 0
) -> np.ndarray:
    """Indirect irradiance of a point from walls of an `irradiance` of (wall, points), none where the sphere is."""
    directions = cosine_directions(normal, power, seed)
    origins = np.broadcast_to(point, directions.shape)
    hidden, _ = enclosure.meets_sphere(origins, directions)
    directions = directions[~hidden]
    wall, points = enclosure.leave(point, directions)
    lit = enclosure.reflectance(wall, points)[:, None] * irradiance(wall, points)
    return lit.sum(0) / len(hidden)


def sphere_quadrature(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Normals and solid angles: Gauss–Legendre in the polar cosine, equal steps in azimuth."""
    cosine, weight = np.polynomial.legendre.leggauss(count)
    phi = (np.arange(2 * count) + 0.5) * np.pi / count
    cosine, phi = np.meshgrid(cosine, phi, indexing="ij")
    sine = np.sqrt(1 - cosine**2)
    normals = np.stack([sine * np.cos(phi), cosine, sine * np.sin(phi)], axis=-1)
    return normals.reshape(-1, 3), (weight[:, None] * np.full(2 * count, np.pi / count)).ravel()


def wall_texture_reader(room: Room, texture: np.ndarray) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Function of (wall, points) that reads a wall texture, shape (C, b, a, K): linear in the angle of each side."""
    texels = texture.shape[1]

    def between(u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        place = np.clip(np.arccos(np.clip(1 - 2 * u, -1, 1)) * texels / np.pi - 0.5, 0, texels - 1)
        index = np.minimum(place.astype(int), texels - 2)
        return index, (place - index)[:, None]

    def read(walls: np.ndarray, points: np.ndarray) -> np.ndarray:
        out = np.empty((len(points), texture.shape[3]))
        for wall in np.unique(walls):
            here = walls == wall
            cells = np.arange(room.wall_start[wall], room.wall_start[wall + 1])
            number, place = [], []
            for side in (0, 1):
                value = points[here, (wall // 2 + 1 + side) % 3]
                low, high = np.unique(room.cell_low[cells, side]), np.unique(room.cell_high[cells, side])
                index = np.clip(np.searchsorted(low, value, side="right") - 1, 0, len(low) - 1)
                number.append(index)
                place.append((value - low[index]) / (high - low)[index])
            cell = cells[0] + number[1] * room.cells_along[wall, 0] + number[0]
            (a, fa), (b, fb) = between(place[0]), between(place[1])
            lower = (1 - fa) * texture[cell, b, a] + fa * texture[cell, b, a + 1]
            upper = (1 - fa) * texture[cell, b + 1, a] + fa * texture[cell, b + 1, a + 1]
            out[here] = (1 - fb) * lower + fb * upper
        return out

    return read
