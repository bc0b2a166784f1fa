"""Fresnel reflectance of a smooth interface with a complex index of refraction, for unpolarised light."""

import numpy as np
from numpy.typing import ArrayLike

from glossspace.errors import GlossError
from glossspace.metric.validity import FloatArray, as_float_arrays, require

__all__ = ["fresnel_reflectance", "interface_reflectance", "require_index"]

# No material comes near; beyond, squares of squares would leave double precision.
_LARGEST_INDEX = 1e6
# A cosine computed from unit vectors may round to a little above one.
_ROUNDING = 1e-9


def fresnel_reflectance(cos_theta: ArrayLike, n: ArrayLike, k: ArrayLike = 0.0) -> FloatArray:
    """Share of unpolarised light that an interface reflects: the glossmeter paper's eq. 10.

    With the index n + ik relative to the medium that the light comes from, u = cosθ and s² = (n + ik)² − 1 + u²::

        F = ½ |(s − u) / (s + u)|² · (1 + |(s u − sin²θ) / (s u + sin²θ)|²)

    which is eq. 10, whose a and b are the real and imaginary parts of s, multiplied through by u so that it stands at
    grazing incidence too.

    Parameters
    ----------
    cos_theta : array_like
        Cosine of the angle of incidence, 0 to 1.
    n : array_like
        Index of refraction, 0 to 1e6; below one for light that leaves the denser medium.
    k : array_like
        Extinction coefficient, 0 to 1e6. All three broadcast; NaN in gives NaN out.

    Returns
    -------
    ndarray of float64
        Reflectance, 0 to 1. Zero at every angle for n = 1 and k = 0, where there is no interface.

    Raises
    ------
    GlossError
        A cosine or an index is out of its range, or n and k are both zero.

    Examples
    --------
    >>> round(float(fresnel_reflectance(1.0, 1.5)), 12)  # ((n - 1) / (n + 1))²
    0.04
    >>> fresnel_reflectance([1.0, 0.5, 0.0], 0.46, 2.81).round(3).tolist()  # a metal like copper at 589 nm
    [0.817, 0.811, 1.0]
    """
    cos_theta, n, k = as_float_arrays(cos_theta=cos_theta, n=n, k=k)
    require((cos_theta >= 0) & (cos_theta <= 1 + _ROUNDING), cos_theta, name="cos_theta", allowed="0 to 1")
    require_index(n, k)
    return interface_reflectance(cos_theta, n, k)


def interface_reflectance(cos_theta: FloatArray, n: FloatArray, k: FloatArray) -> FloatArray:
    """`fresnel_reflectance` of what is known to be in range, for models that have checked their index."""
    u = np.minimum(cos_theta, 1.0)
    sin2 = (1 - u) * (1 + u)
    # Real numbers where s is real take half the time.
    index = n if np.all(n >= 1) and not np.any(k) else n + 1j * k
    nothing = index == 1
    index = np.where(nothing, 2.0, index)  # where it would be 0/0 at grazing; the last line has the answer
    # Factored, and s − u as this over s + u, so that an index near one keeps its digits.
    step = (index - 1) * (index + 1)
    s = np.sqrt(step + u * u)
    with np.errstate(invalid="ignore"):  # NaN in, NaN out
        perpendicular = np.abs(step / (s + u) ** 2) ** 2
        ratio = np.abs((s * u - sin2) / (s * u + sin2)) ** 2
    reflectance = np.minimum(0.5 * perpendicular * (1 + ratio), 1.0)
    return np.where(nothing & ~np.isnan(u), 0.0, reflectance)[()]


def require_index(n: FloatArray, k: FloatArray) -> None:
    """Refuse an index of refraction that no material has.

    Raises
    ------
    GlossError
        n or k is negative or above 1e6, or both are zero.
    """
    require((n >= 0) & (n <= _LARGEST_INDEX), n, name="n", allowed=f"0 to {_LARGEST_INDEX:g}")
    require((k >= 0) & (k <= _LARGEST_INDEX), k, name="k", allowed=f"0 to {_LARGEST_INDEX:g}")
    if np.any((n == 0) & (k == 0)):
        raise GlossError("n = 0 and k = 0 together are no index of refraction. Give n = 1 for no interface at all.")
