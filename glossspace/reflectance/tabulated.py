"""Measured reflectance: a gonio-spectrophotometer's table, interpolated."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import RegularGridInterpolator

from glossspace.errors import GlossError
from glossspace.metric.validity import FloatArray, as_floats
from glossspace.reflectance.gonio_table import as_grid_axis, with_whole_turn, without_gaps
from glossspace.reflectance.half_vector import half_vector
from glossspace.reflectance.model import Parameter, ReflectanceModel, as_angles, as_directions, as_uniforms, direction
from glossspace.reflectance.slope_quadrature import panels
from glossspace.reflectance.spectrum import as_wavelengths, at_wavelengths
from glossspace.reflectance.table_sampling import TableSampler, table_sampler

__all__ = ["Tabulated"]

BEYOND = ("refuse", "hold", "zero")
RECIPROCITY = ("as-measured", "average")


@dataclass(frozen=True, eq=False)
class Tabulated(ReflectanceModel):
    """BRDF of an isotropic sample on a grid of angles, linear between its nodes.

    Azimuths are those of the exitant direction minus that of the incident one: 180° is the mirror's side.

    Attributes
    ----------
    theta_incident_deg, theta_exitant_deg : ndarray of float64, shape (I,) and (R,)
        Polar angles in degrees, ascending between 0 and 90.
    phi_deg : ndarray of float64, shape (P,)
        Azimuths, 0 to 180 (the other side is then the mirror image) or 0 to 360.
    values : ndarray of float64, shape (I, R, P) or (I, R, P, K)
        BRDF (1/sr), at K wavelengths; NaN is a gap.
    wavelengths_nm : ndarray of float64, shape (K,), optional
        Wavelengths of the last axis.
    gaps : str
        ``refuse``, or how to fill them: ``nearest``, ``along-exitant`` or ``reciprocal``; see `without_gaps`.
    reciprocity : str
        ``as-measured``, which `reciprocity_error` flags, or ``average``: the mean of both ways, which is reciprocal.
    beyond : str
        Outside the table's polar angles: ``refuse``, ``hold`` the last value, or ``zero``.

    Raises
    ------
    GlossError
        The grid is none, a value is negative or infinite, there are gaps that nobody filled, or an option is unknown.

    Examples
    --------
    >>> axis = [0.0, 45.0, 90.0]
    >>> paper = Tabulated(axis, axis, [0.0, 180.0], np.full((3, 3, 2), 0.25))
    >>> round(float(paper.albedo(30.0)), 6), round(float(paper.reciprocity_error), 6)
    (0.785398, 0.0)
    """

    theta_incident_deg: Parameter
    theta_exitant_deg: Parameter
    phi_deg: Parameter
    values: Parameter
    wavelengths_nm: Parameter = None
    gaps: str = "refuse"
    reciprocity: str = "as-measured"
    beyond: str = "refuse"

    def __post_init__(self) -> None:
        for name, allowed in (("reciprocity", RECIPROCITY), ("beyond", BEYOND)):
            if getattr(self, name) not in allowed:
                raise GlossError(
                    f"Unknown {name} '{getattr(self, name)}' of a table. Allowed are {', '.join(allowed)}."
                )
        axes = [
            as_grid_axis(getattr(self, name), name=name, last=last)
            for name, last in (("theta_incident_deg", 90), ("theta_exitant_deg", 90), ("phi_deg", 360))
        ]
        values = as_floats(self.values, name="values")
        expected = tuple(axis.size for axis in axes)
        if values.ndim not in (3, 4) or values.shape[:3] != expected or values.size == 0:
            raise GlossError(f"values must have shape {expected} or {(*expected, 'K')}, but have {values.shape}.")
        if np.any(wrong := (values < 0) | np.isinf(values)):
            raise GlossError(f"A BRDF is finite and at least 0, but the table has {float(values[wrong][0])!r}.")
        if self.wavelengths_nm is not None:
            wavelengths = as_wavelengths(self.wavelengths_nm)
            if values.ndim != 4 or wavelengths.size != values.shape[3]:
                raise GlossError(f"{wavelengths.size} wavelengths do not fit a table of shape {values.shape}.")
            object.__setattr__(self, "wavelengths_nm", wavelengths)
        filled = without_gaps((axes[0], axes[1], axes[2]), values.reshape(*expected, -1), self.gaps)
        phi, whole = with_whole_turn(axes[2], filled.reshape(values.shape))
        for name, array in zip(("theta_incident_deg", "theta_exitant_deg", "phi_deg"), (*axes[:2], phi), strict=True):
            object.__setattr__(self, name, array)
        whole = whole.copy()
        whole.flags.writeable = False
        object.__setattr__(self, "values", whole)

    @property
    def channels(self) -> int | None:
        """Number of wavelengths, None if the table has no such axis."""
        return self.values.shape[3] if self.values.ndim == 4 else None

    @cached_property
    def reciprocity_error(self) -> float:
        """Largest difference of the measured values between both ways of the light, over their largest value."""
        theta = np.union1d(self.theta_incident_deg, self.theta_exitant_deg)
        low = max(self.theta_incident_deg[0], self.theta_exitant_deg[0])
        high = min(self.theta_incident_deg[-1], self.theta_exitant_deg[-1])
        shared = theta[(theta >= low) & (theta <= high)]
        if shared.size == 0:
            return float("nan")
        i, o, phi = np.meshgrid(shared, shared, self.phi_deg, indexing="ij")
        forth = self._interpolated(i, o, phi)
        largest = float(np.max(forth))
        return float(np.max(np.abs(forth - self._interpolated(o, i, 360 - phi)))) / largest if largest > 0 else 0.0

    def at_wavelengths(self, wanted_nm: ArrayLike) -> "Tabulated":
        """The table at other wavelengths, linear between its own.

        Raises
        ------
        GlossError
            The table has no wavelengths, or one asked for lies outside them.
        """
        if self.wavelengths_nm is None:
            raise GlossError("This table has no wavelengths. Give wavelengths_nm beside its values.")
        wanted = np.atleast_1d(as_floats(wanted_nm, name="wavelengths"))
        return replace(self, values=at_wavelengths(self.values, self.wavelengths_nm, wanted), wavelengths_nm=wanted)

    def evaluate(self, incident: ArrayLike, exitant: ArrayLike) -> FloatArray:
        """BRDF (1/sr); see `ReflectanceModel.evaluate`.

        Raises
        ------
        GlossError
            A direction lies outside the table, whose ``beyond`` is ``refuse``.
        """
        half = half_vector(incident, exitant)
        i, o = (as_directions(d, name=name) for name, d in (("incident", incident), ("exitant", exitant)))
        i, o = np.broadcast_arrays(i, o)
        above = half.above
        theta_i, theta_o = _polar_deg(i[above]), _polar_deg(o[above])
        phi = np.degrees(np.arctan2(o[above, 1], o[above, 0]) - np.arctan2(i[above, 1], i[above, 0])) % 360
        value = self._within(theta_i, theta_o, phi)
        if self.reciprocity == "average":
            value = (value + self._within(theta_o, theta_i, (360 - phi) % 360)) / 2
        result = np.zeros(above.shape + self.values.shape[3:])
        result[half.unknown] = np.nan
        result[above] = value
        return result[()]

    def draw(self, incident: ArrayLike, u: ArrayLike) -> FloatArray:
        """Exitant directions from the table's cells by what they reflect, and a fifth of them by the cosine."""
        return self._sampler.draw(as_directions(incident, name="incident"), *as_uniforms(u))

    def pdf(self, incident: ArrayLike, exitant: ArrayLike) -> FloatArray:
        """Density (1/sr) of `draw`."""
        half = half_vector(incident, exitant)
        i, o = np.broadcast_arrays(np.asarray(incident, dtype=float), np.asarray(exitant, dtype=float))
        return half.reflected(self._sampler.pdf(i, o))

    def albedo(self, theta_deg: ArrayLike, *, phi_deg: ArrayLike = 0.0) -> FloatArray:
        """Directional-hemispherical reflectance, exact for what lies between the nodes but for rounding.

        Raises
        ------
        GlossError
            The table ends before the horizon and its ``beyond`` is ``refuse``.
        """
        theta, _ = as_angles(theta_deg, phi_deg)
        knots = np.union1d(np.union1d(self.theta_exitant_deg, self.theta_incident_deg), [0.0, 90.0])
        nodes, weights = panels(np.radians(knots), 8)
        azimuths = np.radians(np.union1d(self.phi_deg, 360 - self.phi_deg))
        # Linear in azimuth between the knots, where the trapezoidal rule is exact.
        steps = np.diff(azimuths)
        azimuth_weights = (np.append(steps, 0) + np.append(0, steps)) / 2
        exitant = direction(np.degrees(nodes)[:, None], np.degrees(azimuths))
        measure = (weights * np.sin(nodes) * np.cos(nodes))[:, None] * azimuth_weights
        results = [np.tensordot(measure, self.evaluate(direction(t), exitant), axes=2) for t in theta.flat]
        return np.reshape(results, theta.shape + self.values.shape[3:])[()]

    @cached_property
    def _interpolator(self) -> RegularGridInterpolator:
        axes = (self.theta_incident_deg, self.theta_exitant_deg, self.phi_deg)
        return RegularGridInterpolator(axes, self.values, bounds_error=False)

    @cached_property
    def _sampler(self) -> TableSampler:
        return table_sampler(self, self.theta_incident_deg, self.theta_exitant_deg, self.phi_deg)

    def _interpolated(self, theta_i: FloatArray, theta_o: FloatArray, phi: FloatArray) -> FloatArray:
        return self._interpolator(np.stack([theta_i, theta_o, phi], axis=-1))

    def _within(self, theta_i: FloatArray, theta_o: FloatArray, phi: FloatArray) -> FloatArray:
        ranges = [(a[0], a[-1]) for a in (self.theta_incident_deg, self.theta_exitant_deg)]
        (held_i, out_i), (held_o, out_o) = (
            (np.clip(t, *limits), (t < limits[0] - 1e-6) | (t > limits[1] + 1e-6))  # an angle's rounding
            for t, limits in zip((theta_i, theta_o), ranges, strict=True)
        )
        outside = out_i | out_o
        if self.beyond == "refuse" and np.any(outside):
            raise GlossError(
                f"Incidence {theta_i[outside][0]:.6g}° to exitance {theta_o[outside][0]:.6g}° lies outside the table, "
                f"which runs from {ranges[0][0]:g}° to {ranges[0][1]:g}° and from {ranges[1][0]:g}° to "
                f"{ranges[1][1]:g}°. Stay within it, or make it with beyond='hold' or beyond='zero'."
            )
        value = self._interpolated(held_i, held_o, phi)
        if self.beyond == "zero":
            value = np.where(outside if value.ndim == 1 else outside[:, None], 0.0, value)
        return value


def _polar_deg(directions: FloatArray) -> FloatArray:
    # Near the normal the arc cosine loses half its digits.
    return np.degrees(np.arctan2(np.hypot(directions[..., 0], directions[..., 1]), directions[..., 2]))
