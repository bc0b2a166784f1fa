"""Apertures of a light source or a detector, seen from the measured spot: where they are and how wide, in true angles.

An aperture is a rectangle on the plane that touches the unit sphere at its centre, as the field stop of a collimating
lens is: a point (x, y) of it is seen in the direction of ``centre + x e_theta + y e_phi``. Its half widths are the
tangents of half the angles, which is how ISO 2813 and ASTM D523 turn angles into the sizes of stops, and its element of
solid angle is ``dx dy / (1 + x² + y²)^(3/2)``. What lies below the horizon of the surface sends and receives nothing:
the rectangle ends at ``x = cot(theta)``.
"""

import math
from dataclasses import dataclass

import numpy as np

from glossspace.errors import GlossError
from glossspace.metric.validity import FloatArray

__all__ = ["Aperture"]

# The tangents of half of it are at most one, where Gauss–Legendre rules of low order are exact to rounding.
_WIDEST_DEG = 90.0


@dataclass(frozen=True)
class Aperture:
    """A rectangular aperture above the surface. Frozen, and so a key for tables of nodes.

    Attributes
    ----------
    theta_deg : float
        Angle of its centre from the surface's normal, -90 to 90. A negative angle lies across the normal.
    phi_deg : float
        Azimuth of its centre. A source at 180 and a detector at 0 are in one plane with the normal.
    width_in_plane_deg, width_across_deg : float
        Full angular widths along theta and across it, 0 to 90. Zero is the limit of a point.

    Raises
    ------
    GlossError
        An angle is not finite or outside its range, or a point lies on the horizon, where nothing is measured.

    Examples
    --------
    >>> detector = Aperture(60, 0, 4.4, 11.7)
    >>> round(detector.solid_angle, 5)
    0.01565
    >>> Aperture(90, 0, 10, 10).solid_angle / Aperture(0, 0, 10, 10).solid_angle  # half of it is below the horizon
    0.5
    """

    theta_deg: float
    phi_deg: float = 0.0
    width_in_plane_deg: float = 0.0
    width_across_deg: float = 0.0

    def __post_init__(self) -> None:
        for name, value, low, high in (
            ("theta_deg", self.theta_deg, -90, 90),
            ("phi_deg", self.phi_deg, -720, 720),
            ("width_in_plane_deg", self.width_in_plane_deg, 0, _WIDEST_DEG),
            ("width_across_deg", self.width_across_deg, 0, _WIDEST_DEG),
        ):
            if not (isinstance(value, int | float | np.number) and low <= value <= high):
                raise GlossError(f"Invalid {name} = {value!r} of an aperture. Allowed: {low:g} to {high:g} degrees.")
            object.__setattr__(self, name, float(value))
        if self.theta_deg < 0:
            object.__setattr__(self, "theta_deg", -self.theta_deg)
            object.__setattr__(self, "phi_deg", self.phi_deg + 180)
        if self.theta_deg == 90 and self.width_in_plane_deg == 0:
            raise GlossError(
                "An aperture without width in plane at theta_deg = 90 lies on the horizon, where there is no light. "
                "Give it a width, or an angle below 90."
            )

    @property
    def frame(self) -> FloatArray:
        """Unit vectors (3, 3): towards increasing theta, towards increasing phi, and the centre."""
        theta, phi = math.radians(self.theta_deg), math.radians(self.phi_deg)
        sin_t, cos_t, sin_p, cos_p = math.sin(theta), self._cos_theta, math.sin(phi), math.cos(phi)
        return np.array(
            [[cos_t * cos_p, cos_t * sin_p, -sin_t], [-sin_p, cos_p, 0.0], [sin_t * cos_p, sin_t * sin_p, cos_t]]
        )

    @property
    def _cos_theta(self) -> float:
        return 0.0 if self.theta_deg == 90 else math.cos(math.radians(self.theta_deg))

    @property
    def horizon(self) -> float:
        """The x at which the horizon is; infinite for an aperture about the normal."""
        sin_t = math.sin(math.radians(self.theta_deg))
        return self._cos_theta / sin_t if sin_t > 0 else math.inf

    @property
    def touches_horizon(self) -> bool:
        """Whether a part is cut away by the horizon."""
        return math.tan(math.radians(self.width_in_plane_deg) / 2) >= self.horizon

    @property
    def x_range(self) -> tuple[float, float]:
        """The part above the horizon, along theta, as tangents."""
        half = math.tan(math.radians(self.width_in_plane_deg) / 2)
        return -half, min(half, self.horizon)

    @property
    def y_range(self) -> tuple[float, float]:
        """The extent across theta, as tangents."""
        half = math.tan(math.radians(self.width_across_deg) / 2)
        return -half, half

    @property
    def solid_angle(self) -> float:
        """Solid angle of the part above the horizon, in steradians: the closed form for a rectangle."""
        return sum(
            sign * math.atan(x * y / math.sqrt(1 + x * x + y * y))
            for x, sign_x in zip(self.x_range, (-1, 1), strict=True)
            for y, sign_y in zip(self.y_range, (-1, 1), strict=True)
            for sign in (sign_x * sign_y,)
        )

    def directions(self, x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Give the directions (..., 3) of points (x, y), and the solid angle per unit of area there.

        Parameters
        ----------
        x, y : ndarray
            Tangents along and across theta, which broadcast.

        Returns
        -------
        tuple of ndarray
            Unit vectors away from the surface, and ``(1 + x² + y²)^(-3/2)``.
        """
        length2 = 1 + np.square(x) + np.square(y)
        along, across, centre = self.frame
        vectors = x[..., None] * along + y[..., None] * across + centre
        return vectors / np.sqrt(length2)[..., None], length2**-1.5

    def mirror_points(self, directions: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Where on this aperture's plane a mirror would send light that comes from `directions` (..., 3).

        NaN where the mirrored direction points away from the plane.
        """
        along, across, centre = self.frame
        mirrored = directions * np.array([-1.0, -1.0, 1.0])
        depth = mirrored @ centre
        depth = np.where(depth > 1e-6, depth, np.nan)
        return (mirrored @ along) / depth, (mirrored @ across) / depth
