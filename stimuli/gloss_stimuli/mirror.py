"""What the sphere mirrors: from points of the film to points of the walls, as a perfect mirror would show them."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.scene import Scene

__all__ = ["WALL_AXES", "Check", "Mirror", "mirror_rays"]

Array = NDArray[np.float64]

WALL_AXES = ((1, 2), (0, 2), (0, 1))
"""The two axes that count the checks of the walls across each axis."""


class Check(NamedTuple):
    """A check of a wall: its axis, its side (0 minimum, 1 maximum) and two indices along the other axes."""

    axis: int
    side: int
    first: int
    second: int

    @property
    def parity(self) -> int:
        """0 where the corner `minimum` of the wall has the same paint, else 1."""
        return (self.first + self.second) % 2


@dataclass(frozen=True, eq=False)
class Mirror:
    """Rays that meet the sphere, after their reflection."""

    ray: NDArray[np.intp]
    point: Array  # on the sphere
    normal: Array
    cosine: Array  # of the angle of incidence
    direction: Array
    distance: Array  # from there to the wall
    axis: NDArray[np.intp]
    side: NDArray[np.intp]
    place: Array  # on the wall, in checks from the corner `minimum`

    def cells(self) -> NDArray[np.intp]:
        """Axis, side and the two indices of the check that each ray meets."""
        along = np.array(WALL_AXES)[self.axis]
        indices = np.floor(np.take_along_axis(self.place, along, axis=1)).astype(np.intp)
        return np.column_stack([self.axis, self.side, indices])

    def shows(self, check: Check) -> NDArray[np.bool_]:
        """Which rays meet this check."""
        return np.asarray((self.cells() == check).all(axis=1))


def mirror_rays(scene: Scene, x: Array, y: Array) -> Mirror:
    """Mirror the rays through points of the film, in pixels from its top left corner."""
    right, up, forward = (np.array(axis) for axis in scene.camera.axes())
    scale = math.tan(math.radians(scene.camera.field_of_view_deg) / 2) / (scene.film.width / 2)
    across, above = (x - scene.film.width / 2) * scale, (scene.film.height / 2 - y) * scale
    rays = forward + across[:, None] * right + above[:, None] * up
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    eye, center = np.array(scene.camera.position), np.array(scene.sphere.center)
    along = rays @ (center - eye)
    # Of the ray's chord in the sphere, squared half length.
    half_chord2 = scene.sphere.radius**2 - (center - eye) @ (center - eye) + along**2
    ray = np.flatnonzero((along > 0) & (half_chord2 > 0))
    rays, along, half_chord2 = rays[ray], along[ray], half_chord2[ray]
    point = eye + (along - np.sqrt(half_chord2))[:, None] * rays
    normal = (point - center) / scene.sphere.radius
    cosine = -np.einsum("ij,ij->i", rays, normal)
    direction = rays + 2 * cosine[:, None] * normal
    low, high = np.array(scene.box.minimum), np.array(scene.box.maximum)
    with np.errstate(divide="ignore"):  # a ray along a wall meets it at infinity
        distances = np.where(direction > 0, high - point, low - point) / np.where(direction == 0, 1e-300, direction)
    axis = np.argmin(np.where(direction == 0, np.inf, distances), axis=1)
    distance = distances[np.arange(len(ray)), axis]
    side = (direction[np.arange(len(ray)), axis] > 0).astype(np.intp)
    place = (point + distance[:, None] * direction - low) / scene.box.check_size
    return Mirror(ray, point, normal, cosine, direction, distance, axis, side, place)
