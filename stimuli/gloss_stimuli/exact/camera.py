"""The pinhole camera in compiled code: rays through the film, and where they meet the sphere.

A point of the sphere is named by how it is seen: (X, Y) = i (cos φ, sin φ), with i the angle of incidence and φ the
azimuth about the line from the sphere's center to the eye. The center of the disc is (0, 0), its outline the circle of
radius π/2.
"""

import math
from typing import NamedTuple

import numpy as np

from gloss_stimuli.exact.compiled import compiled
from gloss_stimuli.scene import Scene

__all__ = ["Camera", "build_camera", "camera_ray", "outline_radius_pixels", "seen_on_sphere", "sphere_point"]

Vector = tuple[float, float, float]

# The outline itself has no normal that faces the eye: the last two thousandths of a radian are taken from just inside.
LARGEST_INCIDENCE = math.pi / 2 - 2e-3


class Camera(NamedTuple):
    """Eye, film and the sphere's disc; make one with `build_camera`.

    Attributes
    ----------
    eye, right, up, forward : tuple of float
    tangent : float
        Of half the horizontal field of view.
    width, height : int
        Pixels.
    center, radius
        Of the sphere.
    axis, across, along : tuple of float
        Unit vectors: from the sphere's center to the eye, and two across it from which azimuth is counted.
    distance : float
        From the center to the eye.
    """

    eye: Vector
    right: Vector
    up: Vector
    forward: Vector
    tangent: float
    width: int
    height: int
    center: Vector
    radius: float
    axis: Vector
    across: Vector
    along: Vector
    distance: float


def build_camera(scene: Scene) -> Camera:
    """Camera of a scene."""
    right, up, forward = scene.camera.axes()
    line = np.subtract(scene.camera.position, scene.sphere.center)
    distance = float(np.linalg.norm(line))
    axis = line / distance
    # Any direction across the line serves; the axis least along it gives the best conditioned one.
    across = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    across /= np.linalg.norm(across)
    return Camera(
        eye=_vector(scene.camera.position), right=_vector(right), up=_vector(up), forward=_vector(forward),
        tangent=math.tan(math.radians(scene.camera.field_of_view_deg) / 2),
        width=scene.film.width, height=scene.film.height,
        center=_vector(scene.sphere.center), radius=float(scene.sphere.radius),
        axis=_vector(axis), across=_vector(across), along=_vector(np.cross(axis, across)), distance=distance,
    )  # fmt: skip


def _vector(values: object) -> Vector:
    x, y, z = np.asarray(values, dtype=float)
    return float(x), float(y), float(z)


def outline_radius_pixels(camera: Camera) -> float:
    """Radius of the sphere's outline, were it in the middle of the film."""
    slope = camera.radius / math.sqrt(camera.distance**2 - camera.radius**2)
    return slope / camera.tangent * camera.width / 2


@compiled
def camera_ray(camera: Camera, column: float, row: float) -> tuple[float, float, float]:
    """Unit direction through a place of the film, in pixels from its upper left corner."""
    x = (2 * column / camera.width - 1) * camera.tangent
    y = (camera.height - 2 * row) / camera.width * camera.tangent
    dx = camera.forward[0] + x * camera.right[0] + y * camera.up[0]
    dy = camera.forward[1] + x * camera.right[1] + y * camera.up[1]
    dz = camera.forward[2] + x * camera.right[2] + y * camera.up[2]
    length = math.sqrt(dx * dx + dy * dy + dz * dz)
    return dx / length, dy / length, dz / length


@compiled
def seen_on_sphere(camera: Camera, dx: float, dy: float, dz: float) -> tuple[float, float, float]:
    """Sine of incidence of a camera ray at the sphere (above 1: it misses), and cosine and sine of its azimuth."""
    toward = -(dx * camera.axis[0] + dy * camera.axis[1] + dz * camera.axis[2])
    a = dx * camera.across[0] + dy * camera.across[1] + dz * camera.across[2]
    b = dx * camera.along[0] + dy * camera.along[1] + dz * camera.along[2]
    sine = math.sqrt(a * a + b * b)
    if toward <= 0:
        return 1e9, 1.0, 0.0
    if sine == 0:
        return 0.0, 1.0, 0.0
    return sine * camera.distance / camera.radius, a / sine, b / sine


@compiled
def sphere_point(
    camera: Camera, x: float, y: float
) -> tuple[float, float, float, float, float, float, float, float, float]:
    """Point, outward normal, and unit direction to the eye, where the sphere is seen under (X, Y)."""
    incidence = math.sqrt(x * x + y * y)
    c, s = (x / incidence, y / incidence) if incidence > 0 else (1.0, 0.0)
    incidence = min(incidence, LARGEST_INCIDENCE)
    # The triangle of center, point and eye.
    turn = incidence - math.asin(camera.radius * math.sin(incidence) / camera.distance)
    cos_t, sin_t = math.cos(turn), math.sin(turn)
    nx = cos_t * camera.axis[0] + sin_t * (c * camera.across[0] + s * camera.along[0])
    ny = cos_t * camera.axis[1] + sin_t * (c * camera.across[1] + s * camera.along[1])
    nz = cos_t * camera.axis[2] + sin_t * (c * camera.across[2] + s * camera.along[2])
    px, py, pz = (
        camera.center[0] + camera.radius * nx,
        camera.center[1] + camera.radius * ny,
        camera.center[2] + camera.radius * nz,
    )
    ex, ey, ez = camera.eye[0] - px, camera.eye[1] - py, camera.eye[2] - pz
    length = math.sqrt(ex * ex + ey * ey + ez * ez)
    return px, py, pz, nx, ny, nz, ex / length, ey / length, ez / length
