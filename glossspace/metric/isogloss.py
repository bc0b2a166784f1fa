"""Paints that differ equally in gloss from a standard: figure 11 of the gloss paper."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from glossspace.errors import GlossError
from glossspace.metric.axes import Paint, lightness, roughness_alpha, specular_reflectance
from glossspace.metric.envelope import max_contrast_gloss
from glossspace.metric.space import PAPER_SPACE, GlossSpace
from glossspace.metric.validity import FloatArray, as_floats, within_paper_range

__all__ = ["IsoglossContour", "isogloss_contour"]


@dataclass(frozen=True)
class IsoglossContour:
    """One isogloss contour: `n` points at equal gloss distance from a reference.

    Attributes
    ----------
    angle_deg, c, d : ndarray, shape (n,)
        Direction in the weighted (c, d) plane, 0 towards more c, 90 towards more d; coordinates.
    rho_d : float
        Diffuse reflectance of the paints on the contour.
    rho_s, alpha : ndarray, shape (n,)
        The paint at each point; NaN where none exists.
    reachable : ndarray of bool, shape (n,)
        False where no real paint of this rho_d has the coordinates: c < 0, d >= 1, or rho_d + rho_s > 1.
    within_paper_range : ndarray of bool, shape (n,)
        False where alpha > 0.2, beyond what the gloss paper vouches for, and where no paint exists.
    """

    angle_deg: FloatArray
    c: FloatArray
    d: FloatArray
    rho_d: float
    rho_s: FloatArray
    alpha: FloatArray
    reachable: np.ndarray
    within_paper_range: np.ndarray


def isogloss_contour(
    reference: Paint, *, radius: float, rho_d: float | None = None, n: int = 360, space: GlossSpace = PAPER_SPACE
) -> IsoglossContour:
    """Contour of paints whose gloss distance to `reference` is `radius`.

    Parameters
    ----------
    reference : Paint
        One paint (rho_d, rho_s, alpha).
    radius : float
        Gloss distance D, > 0, in the units of `space` (the paper's figure 11 draws 0.04 and 0.08).
    rho_d : float, optional
        Diffuse reflectance of the paints on the contour; the reference's own when left out.
    n : int
        Number of points, >= 3, at equal angles from 0 degrees.
    space : GlossSpace
        Whose weights shape the contour.

    Returns
    -------
    IsoglossContour

    Raises
    ------
    GlossError
        A parameter is impossible.

    Examples
    --------
    >>> contour = isogloss_contour(Paint(0.193, 0.066, 0.07), radius=0.04, n=4)
    >>> [round(float(c), 3) for c in contour.c]
    [0.127, 0.087, 0.047, 0.087]
    >>> [round(float(d), 4) for d in contour.d]
    [0.93, 0.9525, 0.93, 0.9075]
    """
    distance = float(as_floats(radius, name="radius"))
    if not 0 < distance < np.inf:
        raise GlossError(f"Invalid radius = {distance:g}. Allowed: finite and > 0.")
    if n < 3:
        raise GlossError(f"Invalid n = {n}. Allowed: 3 points or more.")
    c_reference, d_reference = (_one(value) for value in space.coordinates(reference))
    paint_rho_d = _one(reference.rho_d if rho_d is None else rho_d)

    angle = 2 * np.pi * np.arange(n) / n
    c = c_reference + distance / space.weight_c * np.cos(angle)
    d = d_reference + distance / space.weight_d * np.sin(angle)
    # The envelope itself can be painted; beyond it the inverse would refuse, so those points become NaN first.
    reachable = (c >= 0) & (c <= max_contrast_gloss(lightness(paint_rho_d))) & (d < 1)
    rho_s = specular_reflectance(paint_rho_d, np.where(reachable, c, np.nan))
    alpha = roughness_alpha(np.where(reachable, d, np.nan))
    return IsoglossContour(
        angle_deg=np.degrees(angle),
        c=c,
        d=d,
        rho_d=paint_rho_d,
        rho_s=rho_s,
        alpha=alpha,
        reachable=reachable,
        within_paper_range=within_paper_range(alpha),
    )


def _one(value: ArrayLike) -> float:
    array = np.asarray(value, dtype=np.float64)
    if array.size != 1:
        raise GlossError(f"A contour goes round one reference paint, but got {array.size} values.")
    return float(array.reshape(()))
