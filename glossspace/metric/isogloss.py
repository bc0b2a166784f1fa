"""Paints that differ equally in gloss from a standard: figure 11 of the gloss paper."""

from dataclasses import dataclass
from numbers import Integral

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import cosdg, sindg

from glossspace.errors import GlossError
from glossspace.metric.axes import Paint
from glossspace.metric.space import PAPER_SPACE, GlossSpace
from glossspace.metric.validity import FloatArray, as_floats, within_paper_range

__all__ = ["IsoglossContour", "isogloss_contour"]

_MOST_POINTS = 1_000_000


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
        False where no real paint of this rho_d has the coordinates: c < 0, d at or above that of a perfect mirror (1 in
        the gloss paper), or rho_d + rho_s > 1.
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
        Number of points, 3 to 1,000,000, at equal angles from 0 degrees.
    space : GlossSpace
        Whose weights and axis functions shape the contour.

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
    distance = _one(radius, name="radius")
    if not (distance > 0 and np.isfinite(distance / min(space.weight_c, space.weight_d))):
        raise GlossError(f"Invalid radius = {distance!r}. Allowed: finite and > 0.")
    if isinstance(n, bool) or not isinstance(n, Integral) or not 3 <= n <= _MOST_POINTS:
        raise GlossError(f"Invalid n = {n!r}. Allowed: a whole number of points, 3 to {_MOST_POINTS}.")
    rho_d_reference, *rest = (_one(value, name=name) for name, value in reference._asdict().items())
    c_reference, d_reference = space.coordinates(Paint(rho_d_reference, *rest))
    paint_rho_d = rho_d_reference if rho_d is None else _one(rho_d, name="rho_d")

    angle_deg = 360 * np.arange(n) / n
    # Exact at multiples of 90 degrees: a reference without gloss has its 12 and 6 o'clock at c = 0, not just below.
    c = c_reference + distance / space.weight_c * cosdg(angle_deg)
    d = d_reference + distance / space.weight_d * sindg(angle_deg)
    # The inverse would refuse points beyond the envelope, so those become NaN first.
    contrast, distinctness = space.contrast_form, space.distinctness_form
    reachable = contrast.is_paintable(as_floats(paint_rho_d, name="rho_d"), c) & distinctness.has_lobe(d)
    rho_s = contrast.specular_reflectance(paint_rho_d, np.where(reachable, c, np.nan))
    alpha = distinctness.roughness_alpha(np.where(reachable, d, np.nan))
    return IsoglossContour(
        angle_deg=angle_deg,
        c=c,
        d=d,
        rho_d=paint_rho_d,
        rho_s=rho_s,
        alpha=alpha,
        reachable=reachable,
        within_paper_range=within_paper_range(alpha),
    )


def _one(value: ArrayLike, *, name: str) -> float:
    array = as_floats(value, name=name)
    if array.size != 1:
        raise GlossError(f"One contour needs one value of {name}, but got {array.size}. Draw them one by one.")
    return float(array.reshape(()))
