"""The perceptual axes and their inverses: eqs 3, 4 and 6-8 of the gloss paper, numerically stable.

Pellacini, Ferwerda and Greenberg (2000) describe an achromatic paint by diffuse reflectance rho_d, specular reflectance
rho_s and roughness alpha (Ward's model), and its appearance by lightness L, contrast gloss c and distinctness d:

    d = 1 - alpha                                      (3)
    c = cbrt(rho_s + rho_d/2) - cbrt(rho_d/2)          (4)
    rho_d = f^-1(L)                                    (6)
    rho_s = (c + cbrt(rho_d/2))^3 - rho_d/2            (7)
    alpha = 1 - d                                      (8)

Here lightness is CIELAB's L*, 0 to 100, everywhere; the paper's f is L*/100. All functions take scalars or arrays that
broadcast, and return floats or arrays of that shape.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from glossspace.errors import GlossError
from glossspace.metric.validity import (
    FloatArray,
    as_float_arrays,
    as_floats,
    conserves_energy,
    require,
    require_reflectances,
    require_roughness,
)

__all__ = [
    "Appearance",
    "Paint",
    "contrast_gloss",
    "diffuse_reflectance",
    "distinctness",
    "from_physical",
    "lightness",
    "roughness_alpha",
    "specular_reflectance",
    "to_physical",
]

# CIE 15:2004: below this luminance factor L* is a straight line through zero of the slope below.
_FOOT_END = (6 / 29) ** 3
_FOOT_SLOPE = 24389 / 27


class Paint(NamedTuple):
    """An achromatic paint as Ward's model describes it: diffuse and specular reflectance, roughness."""

    rho_d: FloatArray | float
    rho_s: FloatArray | float
    alpha: FloatArray | float


class Appearance(NamedTuple):
    """How a paint looks: CIELAB lightness L* (0-100), contrast gloss c, distinctness of image d."""

    lightness: FloatArray | float
    c: FloatArray | float
    d: FloatArray | float


def contrast_gloss(rho_d: ArrayLike, rho_s: ArrayLike) -> FloatArray:
    """Contrast gloss c of a paint: eq. 4 of the gloss paper.

    Parameters
    ----------
    rho_d, rho_s : array_like
        Diffuse and specular reflectance, each >= 0, with rho_d + rho_s <= 1.

    Returns
    -------
    ndarray or float
        c = cbrt(rho_s + rho_d/2) - cbrt(rho_d/2), in [0, 1]. NaN in gives NaN out.

    Raises
    ------
    GlossError
        A reflectance is negative or infinite, or the two add to more than 1.

    Notes
    -----
    The difference of two cube roots loses all its digits for rho_s << rho_d. With A and B the two roots it equals
    rho_s / (A^2 + AB + B^2), which loses none.

    Examples
    --------
    >>> round(float(contrast_gloss(0.193, 0.066)), 5)
    0.08702
    """
    rho_d, rho_s = as_float_arrays(rho_d=rho_d, rho_s=rho_s)
    require_reflectances(rho_d, rho_s)
    surface = np.cbrt(rho_d / 2)
    reflected = np.cbrt(rho_s + rho_d / 2)
    denominator = reflected**2 + reflected * surface + surface**2
    with np.errstate(invalid="ignore"):  # 0/0 of a paint that reflects nothing: the next line gives its value
        stable = rho_s / denominator
    # On black the surface term vanishes and c is the cube root itself; rho_s = 0 is included, where `stable` is 0/0.
    return np.where(surface == 0, reflected, stable)[()]


def distinctness(alpha: ArrayLike) -> FloatArray:
    """Distinctness-of-image gloss d = 1 - alpha of a paint: eq. 3 of the gloss paper.

    Parameters
    ----------
    alpha : array_like
        Roughness of Ward's lobe, > 0. See `within_paper_range` for values above 0.2.

    Returns
    -------
    ndarray or float
        d < 1, rounded to 1 for alpha below 1e-16. NaN in gives NaN out.

    Raises
    ------
    GlossError
        alpha is zero, negative or infinite.

    Notes
    -----
    A d near 1 keeps alpha to about 1e-16 absolutely, hence to 1e-14 relatively from the smoothest stimuli of the gloss
    paper (alpha = .01) on, and less for smoother ones.

    Examples
    --------
    >>> float(distinctness(0.07))
    0.9299999999999999
    """
    alpha = as_floats(alpha, name="alpha")
    require_roughness(alpha)
    return (1 - alpha)[()]


def lightness(rho_d: ArrayLike) -> FloatArray:
    """CIELAB lightness L* of a diffuse reflectance relative to the perfect diffuser.

    Parameters
    ----------
    rho_d : array_like
        Diffuse reflectance in [0, 1].

    Returns
    -------
    ndarray or float
        L* in [0, 100]. The gloss paper's normalised f(rho_d) is L*/100. NaN in gives NaN out.

    Raises
    ------
    GlossError
        rho_d is outside [0, 1].

    Notes
    -----
    colour-science's `lightness_CIE1976` (CIE 15:2004), except on the straight foot below rho_d = (6/29)^3: there the
    textbook form subtracts 16 from a number near 16 and loses up to all digits, so the line itself is evaluated.

    Examples
    --------
    >>> round(float(lightness(0.193)), 2)
    51.04
    """
    rho_d = as_floats(rho_d, name="rho_d")
    require((rho_d >= 0) & (rho_d <= 1), rho_d, name="rho_d", allowed="0 to 1")
    with _colour() as colour:
        curved = colour.colorimetry.lightness_CIE1976(100 * rho_d)
    return np.where(rho_d <= _FOOT_END, _FOOT_SLOPE * rho_d, curved)[()]


def diffuse_reflectance(lightness: ArrayLike) -> FloatArray:
    """Diffuse reflectance of a CIELAB lightness: eq. 6 of the gloss paper, the inverse of `lightness`.

    Parameters
    ----------
    lightness : array_like
        CIELAB L* in [0, 100].

    Returns
    -------
    ndarray or float
        rho_d in [0, 1]. NaN in gives NaN out.

    Raises
    ------
    GlossError
        L* is outside [0, 100].

    Examples
    --------
    >>> round(float(diffuse_reflectance(100.0)), 12)
    1.0
    """
    lightness = as_floats(lightness, name="lightness")
    require((lightness >= 0) & (lightness <= 100), lightness, name="lightness", allowed="0 to 100 (CIELAB L*)")
    with _colour() as colour:
        curved = colour.colorimetry.luminance_CIE1976(lightness) / 100
    return np.where(lightness <= _FOOT_SLOPE * _FOOT_END, lightness / _FOOT_SLOPE, curved)[()]


def specular_reflectance(rho_d: ArrayLike, c: ArrayLike) -> FloatArray:
    """Specular reflectance that gives diffuse reflectance `rho_d` the contrast gloss `c`: eq. 7 of the gloss paper.

    Parameters
    ----------
    rho_d : array_like
        Diffuse reflectance in [0, 1].
    c : array_like
        Contrast gloss, >= 0 and at most what energy conservation allows (`max_contrast_gloss`).

    Returns
    -------
    ndarray or float
        rho_s = (c + B)^3 - B^3 with B = cbrt(rho_d/2), evaluated as c (c^2 + 3cB + 3B^2), which does not cancel.

    Raises
    ------
    GlossError
        rho_d or c is outside [0, 1], or c is out of reach: the paint would reflect more than it receives.

    Examples
    --------
    >>> round(float(specular_reflectance(0.193, 0.08702)), 4)
    0.066
    """
    rho_d, c = as_float_arrays(rho_d=rho_d, c=c)
    require((rho_d >= 0) & (rho_d <= 1), rho_d, name="rho_d", allowed="0 to 1")
    require((c >= 0) & (c < np.inf), c, name="c", allowed="0 to 1")
    beyond = ~is_paintable(rho_d, c) & ~np.isnan(rho_d + c)
    if np.any(beyond):
        one_rho_d, one_c = (float(values[beyond][0]) for values in np.broadcast_arrays(rho_d, c))
        raise GlossError(
            f"Contrast gloss c = {one_c:.10g} is out of reach for rho_d = {one_rho_d:.10g}, which allows at most "
            f"{contrast_gloss(one_rho_d, 1 - one_rho_d):.10g}. Choose a darker paint or less contrast gloss."
        )
    return _specular_reflectance(rho_d, c)[()]


def is_paintable(rho_d: FloatArray, c: FloatArray) -> NDArray[np.bool_]:
    """Whether a paint of diffuse reflectance `rho_d` can have contrast gloss `c`, any number. False for NaN."""
    with np.errstate(over="ignore", invalid="ignore"):  # a contour may run far out of the space: not paintable there
        return np.asarray((c >= 0) & conserves_energy(rho_d, _specular_reflectance(rho_d, c)))


def roughness_alpha(d: ArrayLike) -> FloatArray:
    """Roughness alpha = 1 - d of a distinctness of image: eq. 8 of the gloss paper.

    Parameters
    ----------
    d : array_like
        Distinctness of image, < 1.

    Returns
    -------
    ndarray or float
        alpha > 0. NaN in gives NaN out.

    Raises
    ------
    GlossError
        d is 1 or more (a perfect mirror has no lobe) or infinite.

    Examples
    --------
    >>> round(float(roughness_alpha(0.93)), 12)
    0.07
    """
    d = as_floats(d, name="d")
    require((d < 1) & (d > -np.inf), d, name="d", allowed="below 1, since alpha = 1 - d must be positive")
    return (1 - d)[()]


def from_physical(rho_d: ArrayLike, rho_s: ArrayLike, alpha: ArrayLike) -> Appearance:
    """Appearance (L*, c, d) of a paint (rho_d, rho_s, alpha): eqs 3 and 4 and CIELAB lightness.

    Parameters
    ----------
    rho_d, rho_s, alpha : array_like
        Ward's parameters: reflectances >= 0 with rho_d + rho_s <= 1, roughness > 0. They broadcast.

    Returns
    -------
    Appearance

    Raises
    ------
    GlossError
        A parameter is impossible; the message names it and its value.

    Examples
    --------
    >>> appearance = from_physical(0.193, 0.066, 0.07)
    >>> [round(float(value), 3) for value in appearance]
    [51.036, 0.087, 0.93]
    """
    rho_d, rho_s, alpha = as_float_arrays(rho_d=rho_d, rho_s=rho_s, alpha=alpha)
    values = np.broadcast_arrays(lightness(rho_d), contrast_gloss(rho_d, rho_s), distinctness(alpha))
    return Appearance(*(value.copy()[()] for value in values))


def to_physical(lightness: ArrayLike, c: ArrayLike, d: ArrayLike) -> Paint:
    """Paint (rho_d, rho_s, alpha) of an appearance (L*, c, d): eqs 6-8, the inverse of `from_physical`.

    Parameters
    ----------
    lightness, c, d : array_like
        CIELAB L* in [0, 100], contrast gloss c >= 0, distinctness of image d < 1. They broadcast.

    Returns
    -------
    Paint

    Raises
    ------
    GlossError
        No paint looks like this; the message names the parameter and its value.

    Examples
    --------
    >>> paint = to_physical(51.036, 0.08702, 0.93)
    >>> [round(float(value), 3) for value in paint]
    [0.193, 0.066, 0.07]
    """
    lightness, c, d = as_float_arrays(lightness=lightness, c=c, d=d)
    rho_d = diffuse_reflectance(lightness)
    values = np.broadcast_arrays(rho_d, specular_reflectance(rho_d, c), roughness_alpha(d))
    return Paint(*(value.copy()[()] for value in values))


def _specular_reflectance(rho_d: FloatArray, c: FloatArray) -> FloatArray:
    surface = np.cbrt(rho_d / 2)
    return c * (c**2 + 3 * c * surface + 3 * surface**2)


@contextmanager
def _colour() -> Iterator[ModuleType]:
    with np.printoptions():  # importing colour sets NumPy's printing back to the style of version 1.13 for everybody
        import colour  # here, because it takes longer than all else together

    with colour.domain_range_scale("reference"):  # a user's own setting of its global scale must not change the result
        yield colour
