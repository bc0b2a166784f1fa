"""How much contrast gloss a paint of a given lightness can have: figure 10 of the gloss paper."""

from numpy.typing import ArrayLike

from glossspace.metric.axes import contrast_gloss, diffuse_reflectance
from glossspace.metric.validity import FloatArray

__all__ = ["fixed_energy_contrast_gloss", "max_contrast_gloss"]


def max_contrast_gloss(lightness: ArrayLike) -> FloatArray:
    """Largest contrast gloss that energy conservation, rho_d + rho_s <= 1, leaves a paint of this lightness.

    Parameters
    ----------
    lightness : array_like
        CIELAB L* in [0, 100].

    Returns
    -------
    ndarray or float
        The envelope of figure 10: 1 for L* = 0, falling to 0 for L* = 100.

    Raises
    ------
    GlossError
        L* is outside [0, 100].

    Examples
    --------
    >>> float(max_contrast_gloss(0.0))
    1.0
    """
    rho_d = diffuse_reflectance(lightness)
    return contrast_gloss(rho_d, 1 - rho_d)


def fixed_energy_contrast_gloss(lightness: ArrayLike, rho_s: ArrayLike) -> FloatArray:
    """Contrast gloss of one specular reflectance on paints of these lightnesses: the lower curve of figure 10.

    Parameters
    ----------
    lightness : array_like
        CIELAB L* in [0, 100].
    rho_s : array_like
        Specular reflectance, >= 0; with the diffuse reflectance of `lightness` at most 1.

    Returns
    -------
    ndarray or float
        c, smaller for lighter paints: the same gloss coat looks less glossy on white than on black.

    Raises
    ------
    GlossError
        A parameter is impossible, or the paint would reflect more than it receives.

    Examples
    --------
    >>> black, white = fixed_energy_contrast_gloss([20.0, 90.0], 0.099)
    >>> bool(black > white)
    True
    """
    return contrast_gloss(diffuse_reflectance(lightness), rho_s)
