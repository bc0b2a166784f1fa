"""Cook and Torrance's lobe of V-grooved facets: as the glossmeter paper writes it, and with Beckmann's distribution."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from glossspace.errors import GlossError
from glossspace.metric.validity import FloatArray
from glossspace.reflectance import ward_terms
from glossspace.reflectance.fresnel import interface_reflectance, require_index
from glossspace.reflectance.half_vector import HalfVector, half_vector, mirrored_at_slopes
from glossspace.reflectance.model import (
    Parameter,
    ReflectanceModel,
    as_channels,
    as_directions,
    as_uniforms,
    common_channels,
)
from glossspace.reflectance.slope_quadrature import GAUSSIAN_EXTENT, lobe_albedo
from glossspace.reflectance.ward import LARGEST_ROUGHNESS, SMALLEST_ROUGHNESS, require_one_roughness

__all__ = ["FORMS", "CookTorrance", "v_groove_attenuation"]

FORMS = ("paper", "beckmann")


@dataclass(frozen=True, eq=False)
class CookTorrance(ReflectanceModel):
    """Cook and Torrance's specular lobe, without its diffuse term, for which add a `Lambert`.

    With δ between half vector and normal, F Fresnel's reflectance at h·i and G the attenuation of V-grooves::

        paper      f = F D G / (π cosθi cosθo)    D = scale · exp(-δ²/slope²), δ in radians
        beckmann   f = F D G / (4 cosθi cosθo)    D = scale · exp(-tan²δ/slope²) / (π slope² cos⁴δ)

    The first is the glossmeter paper's eqs 10 to 13 with ks = 1. Its D has a scale of its own instead of a norm, so it
    may reflect more than it receives; `check_model` says so. The second is a distribution of facets: its projected area
    is one at scale 1, where the lobe never reflects more than it receives.

    Attributes
    ----------
    scale : float or ndarray of float64, shape (K,)
        The paper's c in the first form, a factor of the whole lobe in the second; 0 or above.
    slope : float or ndarray of float64, shape (K,)
        The paper's m, root mean square slope of the facets, 1e-5 to 100.
    n, k : float or ndarray of float64, shape (K,)
        Index of refraction and extinction coefficient, 0 to 1e6.
    form : str
        ``paper`` or ``beckmann``.

    Raises
    ------
    GlossError
        A parameter is out of its range, or the form is unknown.

    Examples
    --------
    >>> from glossspace.reflectance.model import direction
    >>> red = CookTorrance(scale=21.5, slope=0.6, n=1.32)  # the paper's Rouge Tiziano
    >>> round(float(red.evaluate(direction(60), direction(60, 180))), 4)
    1.5667
    >>> red.albedo([20.0, 85.0]).round(3).tolist()
    [0.391, 4.571]
    """

    scale: Parameter
    slope: Parameter
    n: Parameter
    k: Parameter = 0.0
    form: str = "paper"

    def __post_init__(self) -> None:
        for name in ("scale", "n", "k"):
            object.__setattr__(self, name, as_channels(getattr(self, name), name=name, least=0))
        slope = as_channels(self.slope, name="slope", least=SMALLEST_ROUGHNESS, most=LARGEST_ROUGHNESS)
        object.__setattr__(self, "slope", slope)
        if self.form not in FORMS:
            raise GlossError(f"Unknown form '{self.form}' of Cook-Torrance. Allowed are {', '.join(FORMS)}.")
        _ = self.channels
        require_index(self.n, self.k)

    @property
    def channels(self) -> int | None:
        """Number of wavelengths or paints, None if every parameter is one number."""
        return common_channels(scale=self.scale, slope=self.slope, n=self.n, k=self.k)

    def evaluate(self, incident: ArrayLike, exitant: ArrayLike) -> FloatArray:
        """BRDF (1/sr) of the lobe; see `ReflectanceModel.evaluate`."""
        half = half_vector(incident, exitant, self.channels)
        fresnel = interface_reflectance(half.half_dot_i, self.n, self.k)
        if self.form == "paper":
            facets = np.exp(-((_delta(half) / self.slope) ** 2)) / np.pi
        else:
            facets = self._beckmann_peak(half) / half.cos2_delta**2
        # Divided one by one: the attenuation may be as small as either cosine.
        return half.reflected(self.scale * fresnel * facets * (v_groove_attenuation(half) / half.cos_i / half.cos_o))

    def draw(self, incident: ArrayLike, u: ArrayLike) -> FloatArray:
        """Exitant directions whose half vectors follow the distribution; some may lie below the horizon."""
        require_one_roughness(slope=self.slope)
        first, second = as_uniforms(u)
        if self.form == "paper":
            # δ of density ∝ δ exp(-δ²/m²) up to 90°, so δ² is a truncated exponential.
            delta = self.slope * np.sqrt(-np.log1p(-first * self._share_below_90_deg()))
            slope_x, slope_y = (np.tan(delta) * turn(2 * np.pi * second) for turn in (np.cos, np.sin))
        else:
            slope_x, slope_y = ward_terms.half_vector_slopes(1 - first, second, self.slope, self.slope, xp=np)
        return mirrored_at_slopes(as_directions(incident, name="incident"), slope_x, slope_y)

    def pdf(self, incident: ArrayLike, exitant: ArrayLike) -> FloatArray:
        """Density (1/sr) of `draw`."""
        require_one_roughness(slope=self.slope)
        half = half_vector(incident, exitant)
        if self.form == "beckmann":
            factor = ward_terms.density_factor(half.half_dot_i, half.cos2_delta, xp=np)
            return half.reflected(self._beckmann_peak(half) * factor)
        delta = _delta(half)
        per_slope2 = np.exp(-((delta / self.slope) ** 2)) / (np.pi * self.slope**2 * self._share_below_90_deg())
        return half.reflected(per_slope2 / np.sinc(delta / np.pi) / (4 * half.half_dot_i))

    def albedo(self, theta_deg: ArrayLike, *, phi_deg: ArrayLike = 0.0) -> FloatArray:
        """Directional-hemispherical reflectance by converged quadrature; see `lobe_albedo`."""
        narrowest, widest = float(np.min(self.slope)), float(np.max(self.slope))
        # tan δ grows without limit where δ itself is the Gaussian.
        reach = np.tan(min(GAUSSIAN_EXTENT * widest, np.pi / 2)) if self.form == "paper" else GAUSSIAN_EXTENT * widest
        width = min(narrowest, 1.0)
        return lobe_albedo(self, theta_deg, phi_deg, widths=(width, width), extent=reach / width, folds=_folds)

    def _beckmann_peak(self, half: HalfVector) -> FloatArray:
        exponent = ward_terms.slope_exponent(half.x, half.y, half.z, self.slope, self.slope)
        return ward_terms.gaussian_peak(exponent, self.slope, self.slope, xp=np)

    def _share_below_90_deg(self) -> FloatArray:
        return -np.expm1(-((np.pi / 2 / self.slope) ** 2))


def v_groove_attenuation(half: HalfVector) -> FloatArray:
    """Share of the facets' light that V-grooves neither shadow nor mask: the glossmeter paper's eq. 12, 0 to 1."""
    facing = 2 * np.sqrt(half.cos2_delta) / half.half_dot_i
    return np.minimum(1.0, facing * np.minimum(half.cos_i, half.cos_o))


def _delta(half: HalfVector) -> FloatArray:
    """Angle in radians between half vector and normal, with all its digits in narrow lobes."""
    return np.arctan2(np.hypot(half.x, half.y), half.z)


def _folds(theta: float, azimuth: FloatArray) -> FloatArray:
    """Slopes (5, ...) at which the attenuation's minimum changes from one term to another, along rays of facet slopes.

    With a = sinθ cos(azimuth), b = cosθ and A = r a + b: A = 2b, where light begins to be shadowed; A (1 + r²)⁻¹ = b,
    where both directions are equally steep; and a r³ + 3 b r² − 3 a r − b = 0, where it begins to be masked, which is
    tan 3x = −b/a for r = tan x.
    """
    a, b = np.sin(theta) * np.cos(azimuth), np.cos(theta)
    x = (np.arctan2(-b, a) + np.pi * np.arange(3)[:, None]) / 3
    with np.errstate(divide="ignore"):
        return np.concatenate([np.tan(x), [b / a, a / b]])
