"""Paints of different lightness that look equally glossy: section 5.2 of the gloss paper."""

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from glossspace.errors import GlossError
from glossspace.metric.axes import Paint, contrast_gloss, lightness, specular_reflectance
from glossspace.metric.envelope import max_contrast_gloss
from glossspace.metric.validity import as_floats, require

__all__ = ["match_gloss"]


def match_gloss(reference: Paint, *, rho_d: ArrayLike, out_of_reach: Literal["raise", "mask"] = "raise") -> Paint:
    """Paint of diffuse reflectance `rho_d` whose apparent gloss (c, d) equals that of `reference`.

    Parameters
    ----------
    reference : Paint
        The paint to match: (rho_d, rho_s, alpha), scalars or arrays.
    rho_d : array_like
        Diffuse reflectance of the wanted paint, in [0, 1]. Broadcasts with the reference.
    out_of_reach : {"raise", "mask"}
        What to do where no paint of this lightness can be that glossy, because it would reflect more than it receives:
        raise an error, or give NaN for rho_s and alpha there.

    Returns
    -------
    Paint
        (rho_d, rho_s, alpha). Roughness is that of the reference, since d depends on it alone (eq. 3).

    Raises
    ------
    GlossError
        A parameter is impossible, or, with ``"raise"``, the match is out of reach.

    Examples
    --------
    The spheres of figure 12: a black paint that looks as glossy as the white one with rho_s = .099.

    >>> matched = match_gloss(Paint(0.767, 0.099, 0.04), rho_d=0.03)
    >>> round(float(matched.rho_s), 4)
    0.0132
    """
    if out_of_reach not in ("raise", "mask"):
        raise GlossError(f"Invalid out_of_reach = {out_of_reach!r}. Allowed: 'raise' and 'mask'.")
    c = contrast_gloss(reference.rho_d, reference.rho_s)
    alpha = as_floats(reference.alpha, name="alpha")
    require((alpha > 0) & (alpha < np.inf), alpha, name="alpha", allowed="finite and > 0")
    target = as_floats(rho_d, name="rho_d")
    highest = max_contrast_gloss(lightness(target))
    c, alpha, target, highest = np.broadcast_arrays(c, alpha, target, highest)
    # A match that lies on the envelope is reachable: the slack is the rounding of c, not an allowance.
    unreachable = c > highest * (1 + 1e-12) + 1e-15
    if np.any(unreachable) and out_of_reach == "raise":
        where = np.unravel_index(np.argmax(unreachable), unreachable.shape)
        raise GlossError(
            f"Contrast gloss c = {c[where]:.6g} is out of reach for rho_d = {target[where]:.6g}, "
            f"which allows at most {highest[where]:.6g}. Choose a darker paint or a less glossy reference."
        )
    matched = specular_reflectance(target, np.where(unreachable, np.nan, np.minimum(c, highest)))
    return Paint(target.copy()[()], matched, np.where(unreachable, np.nan, alpha)[()])
