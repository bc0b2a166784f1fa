"""Which pixels show a dark and a light check reflected side by side: from the geometry of a scene alone.

A ray through a pixel's center is mirrored at the sphere as a perfect mirror would, and the check that it then meets is
what a glossy paint shows there, blurred by its lobe. Of all pairs of checks that share an edge, one is chosen:

- both are whole, on one wall, and neither touched by the light nor reached by the sphere's shadow of it;
- both are seen at an angle of incidence below 60° in the mean, where the printed form of Ward's lobe still behaves;
- the light's center shines on the sphere where it mirrors the two with irradiances that differ by 10 % at most, since
  shading would pass for contrast (by 50 % where there is no such pair);
- of these, the pair whose smaller mirror image is largest. Pairs within 2 % of it, as the symmetric ones of a symmetric
  scene, are equal: the first in the order of wall (x, y, z; minimum before maximum) and check is taken.

Mirror images are measured on a grid of rays that does not depend on the film's resolution.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.edge_width import EdgeProfile
from gloss_stimuli.mirror import WALL_AXES, Check, Mirror, mirror_rays
from gloss_stimuli.scene import Scene

__all__ = ["PatchGeometry", "find_patches"]

Array = NDArray[np.float64]

LARGEST_INCIDENCE_DEG = 60.0
IRRADIANCE_RATIOS = (1.1, 1.5)
EQUAL_IMAGES = 0.98

# Rays across the longer side of the film from which a pair is chosen.
RAYS_ACROSS = 256
# A patch is the central half of a check in both directions.
HALF_PATCH = 0.25
FEWEST_PIXELS = 4


@dataclass(frozen=True, eq=False)
class PatchGeometry:
    """Pixels of a film that show the chosen pair of reflected checks; make one with `find_patches`.

    Attributes
    ----------
    film : tuple of int
        Height and width of the images.
    dark, light : array of int
        Row-major indices of the pixels of the two patches, the central half of each check.
    edge : array of int
        Indices of the pixels between the two centers, in the central half along the edge.
    profile : EdgeProfile
        Their signed distance from the edge in checks, positive on the light one.
    reflected_deg_per_check : float
        Angle that a check's width across the edge subtends, seen from where the sphere mirrors it.
    visual_deg_per_check : float
        Visual angle, at the viewing distance, of the mirror image of that width.
    incidence_deg : tuple of float
        Mean angle of incidence on the sphere, where it mirrors the dark and the light patch.
    wall : str
        The wall: ``x minimum``, ``x maximum``, ``y minimum``, …
    checks : tuple
        Indices of the dark and the light check on it, counted from the corner `minimum` of the box.
    """

    film: tuple[int, int]
    dark: NDArray[np.intp]
    light: NDArray[np.intp]
    edge: NDArray[np.intp]
    profile: EdgeProfile
    reflected_deg_per_check: float
    visual_deg_per_check: float
    incidence_deg: tuple[float, float]
    wall: str
    checks: tuple[tuple[int, int], tuple[int, int]]

    def to_dict(self) -> dict[str, Any]:
        """What a manifest says of the place of measurement."""
        return {
            "wall": self.wall,
            "dark_check": list(self.checks[0]),
            "light_check": list(self.checks[1]),
            "dark_pixels": len(self.dark),
            "light_pixels": len(self.light),
            "incidence_deg": [round(angle, 2) for angle in self.incidence_deg],
            "reflected_deg_per_check": round(self.reflected_deg_per_check, 4),
            "visual_deg_per_check": round(self.visual_deg_per_check, 6),
        }


def find_patches(scene: Scene) -> PatchGeometry | None:
    """The pair of reflected checks to measure in images of a scene; None where no pair meets the conditions above.

    Parameters
    ----------
    scene : Scene
        Its film says for which pixels.

    Examples
    --------
    >>> from gloss_stimuli.scene import read_scene
    >>> find_patches(read_scene()).wall
    'x minimum'
    """
    width, height = scene.film.width, scene.film.height
    step = max(width, height) / RAYS_ACROSS
    counts = [max(1, round(size / step)) for size in (width, height)]
    columns, rows = (
        (np.arange(count) + 0.5) * size / count for count, size in zip(counts, (width, height), strict=True)
    )
    x, y = (axis.ravel() for axis in np.meshgrid(columns, rows))
    mirror = mirror_rays(scene, x, y)
    pair = _choose(scene, _images(scene, mirror))
    if pair is None:
        return None
    dark, light = pair
    shown = mirror.shows(dark) | mirror.shows(light)
    # The film's own pixels, as far as the two images reach and one ray more.
    spans = [
        np.arange(
            max(0, math.floor(at[mirror.ray][shown].min() - step)),
            min(size, math.ceil(at[mirror.ray][shown].max() + step)),
        )
        for at, size in ((x, width), (y, height))
    ]
    column, row = (axis.ravel() for axis in np.meshgrid(*spans))
    return _patches(scene, dark, light, column, row)


class _Image(NamedTuple):
    """Mirror image of a check: rays that meet it, their mean incidence, and the irradiance where they are mirrored."""

    rays: int
    incidence_deg: float
    irradiance: float


def _images(scene: Scene, mirror: Mirror) -> dict[Check, _Image]:
    """Mirror images of all checks that are seen, in order."""
    to_light = _light_points(scene, 1)[0] - mirror.point
    distance = np.linalg.norm(to_light, axis=1)
    cosines = np.maximum(np.einsum("ij,ij->i", to_light, mirror.normal), 0.0) * to_light[:, 1]
    irradiance = cosines / distance**4
    cells, image, rays = np.unique(mirror.cells(), axis=0, return_inverse=True, return_counts=True)
    incidence = np.degrees(np.arccos(np.clip(mirror.cosine, 0.0, 1.0)))
    means = (np.bincount(image.ravel(), of) / rays for of in (incidence, irradiance))
    return {
        Check(*map(int, cell)): _Image(int(count), float(angle), float(light))
        for cell, count, angle, light in zip(cells, rays, *means, strict=True)
    }


def _choose(scene: Scene, images: dict[Check, _Image]) -> tuple[Check, Check] | None:
    """The dark and the light check of the pair to measure."""
    usable = [
        pair
        for pair in _neighbours(images)
        if all(
            images[check].incidence_deg <= LARGEST_INCIDENCE_DEG
            and _is_whole(scene, check)
            and not _is_disturbed(scene, check)
            for check in pair
        )
    ]
    by_evenness = ([pair for pair in usable if _irradiance_ratio(images, pair) <= ratio] for ratio in IRRADIANCE_RATIOS)
    evenly_lit = next((pairs for pairs in by_evenness if pairs), None)
    if evenly_lit is None:
        return None

    def size(pair: tuple[Check, Check]) -> int:
        return min(images[check].rays for check in pair)

    largest = max(map(size, evenly_lit))
    one, other = next(pair for pair in evenly_lit if size(pair) >= EQUAL_IMAGES * largest)
    dark_parity = 0 if scene.box.dark_reflectance <= scene.box.light_reflectance else 1
    return (one, other) if one.parity == dark_parity else (other, one)


def _neighbours(images: dict[Check, _Image]) -> Iterator[tuple[Check, Check]]:
    for check in images:
        for neighbour in (check._replace(first=check.first + 1), check._replace(second=check.second + 1)):
            if neighbour in images:
                yield check, neighbour


def _irradiance_ratio(images: dict[Check, _Image], pair: tuple[Check, Check]) -> float:
    weaker, stronger = sorted(images[check].irradiance for check in pair)
    return stronger / weaker if weaker > 0 else math.inf


def _is_whole(scene: Scene, check: Check) -> bool:
    extent = (np.array(scene.box.maximum) - scene.box.minimum) / scene.box.check_size
    # A wall of five checks may be 4.999999999 of them long by rounding.
    return all(
        index + 1 <= extent[axis] + 1e-9
        for axis, index in zip(WALL_AXES[check.axis], (check.first, check.second), strict=True)
    )


def _is_disturbed(scene: Scene, check: Check) -> bool:
    """Whether the light lies on the check, or the sphere keeps some of it from some of the check."""
    corner = np.array(scene.box.minimum)
    corner[check.axis] = (scene.box.minimum, scene.box.maximum)[check.side][check.axis]
    steps = np.linspace(0, scene.box.check_size, 5)
    first, second = (axis.ravel() for axis in np.meshgrid(steps, steps))
    points = np.tile(corner, (first.size, 1))
    for axis, index, offset in zip(WALL_AXES[check.axis], (check.first, check.second), (first, second), strict=True):
        points[:, axis] += index * scene.box.check_size + offset
    if (check.axis, check.side) == (1, 1):
        centers, sizes = np.array(scene.light.center_xz), np.array(scene.light.size_xz)
        low, high = points.min(axis=0)[[0, 2]], points.max(axis=0)[[0, 2]]
        return bool(((low < centers + sizes / 2) & (high > centers - sizes / 2)).all())
    paths = _light_points(scene, 5) - points[:, None]
    paths /= np.linalg.norm(paths, axis=2, keepdims=True)
    to_center = np.array(scene.sphere.center) - points[:, None]
    along = (paths * to_center).sum(axis=2)
    past2 = (to_center**2).sum(axis=2) - along**2
    return bool(((along > 0) & (past2 < scene.sphere.radius**2)).any())


def _light_points(scene: Scene, count: int) -> Array:
    """Points of the light on a grid that includes its corners, or its center alone."""
    steps = np.linspace(-0.5, 0.5, count) if count > 1 else np.zeros(1)
    (x, z), (width, depth) = scene.light.center_xz, scene.light.size_xz
    return np.array([(x + u * width, scene.box.maximum[1], z + v * depth) for u in steps for v in steps])


def _patches(
    scene: Scene, dark: Check, light: Check, column: NDArray[np.int64], row: NDArray[np.int64]
) -> PatchGeometry | None:
    """The pixels of a pair among those given."""
    x, y = column.astype(np.float64) + 0.5, row.astype(np.float64) + 0.5
    mirror = mirror_rays(scene, x, y)
    on_wall = (mirror.axis == dark.axis) & (mirror.side == dark.side)
    across, along = WALL_AXES[dark.axis] if dark.first != light.first else WALL_AXES[dark.axis][::-1]
    index = {axis: (dark[2 + k], light[2 + k]) for k, axis in enumerate(WALL_AXES[dark.axis])}
    border, sign = max(index[across]), index[across][1] - index[across][0]

    def position(place: Array) -> Array:
        """Signed distance from the common edge, in checks."""
        return np.asarray(sign * (place[:, across] - border))

    distance = position(mirror.place)
    inside = on_wall & (np.abs(mirror.place[:, along] - index[along][0] - 0.5) <= HALF_PATCH)
    is_dark, is_light = (inside & (np.abs(distance - center) <= HALF_PATCH) for center in (-0.5, 0.5))
    if min(is_dark.sum(), is_light.sum()) < FEWEST_PIXELS:
        return None
    is_edge = inside & (np.abs(distance) <= 0.5)
    pixel = (row * scene.film.width + column)[mirror.ray]
    edge_x, edge_y = x[mirror.ray][is_edge], y[mirror.ray][is_edge]
    # Derivatives by differences that are small against a pixel and large against rounding.
    h = 1e-3
    gradient = [
        (
            position(mirror_rays(scene, edge_x + dx, edge_y + dy).place)
            - position(mirror_rays(scene, edge_x - dx, edge_y - dy).place)
        )
        / (2 * h)
        for dx, dy in ((h, 0), (0, h))
    ]
    pixel_deg = math.degrees(scene.viewing.image_width_cm / scene.film.width / scene.viewing.distance_cm)
    tangent = np.sqrt(1 - mirror.direction[is_edge, across] ** 2)
    incidence = np.degrees(np.arccos(np.clip(mirror.cosine, 0.0, 1.0)))
    return PatchGeometry(
        film=(scene.film.height, scene.film.width),
        dark=pixel[is_dark],
        light=pixel[is_light],
        edge=pixel[is_edge],
        profile=EdgeProfile(distance[is_edge]),
        reflected_deg_per_check=math.degrees(np.mean(scene.box.check_size * tangent / mirror.distance[is_edge])),
        visual_deg_per_check=pixel_deg * float(np.mean(1 / np.hypot(*gradient))),
        incidence_deg=(float(incidence[is_dark].mean()), float(incidence[is_light].mean())),
        wall=f"{'xyz'[dark.axis]} {('minimum', 'maximum')[dark.side]}",
        checks=((dark.first, dark.second), (light.first, light.second)),
    )
