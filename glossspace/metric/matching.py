"""Paints of different lightness that look equally glossy: section 5.2 of the gloss paper."""

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from glossspace.errors import GlossError
from glossspace.metric.axes import Paint
from glossspace.metric.space import PAPER_SPACE, GlossSpace
from glossspace.metric.validity import as_float_arrays, require_roughness

__all__ = ["match_gloss"]


def match_gloss(
    reference: Paint,
    *,
    rho_d: ArrayLike,
    out_of_reach: Literal["raise", "mask"] = "raise",
    space: GlossSpace = PAPER_SPACE,
) -> Paint:
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
    space : GlossSpace
        Whose axis functions make gloss equal; its weights do not matter, since both coordinates are kept.

    Returns
    -------
    Paint
        (rho_d, rho_s, alpha). Roughness is that of the reference, since d depends on it alone.

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
    reference_rho_d, rho_s, alpha, target = as_float_arrays(**reference._asdict(), wanted_rho_d=rho_d)
    require_roughness(alpha)
    form = space.contrast_form
    c, alpha, target = np.broadcast_arrays(form.value(reference_rho_d, rho_s), alpha, target)
    if out_of_reach == "mask":
        unreachable = ~form.is_paintable(target, c) & ~np.isnan(target + c)
        c, alpha = np.where(unreachable, np.nan, c), np.where(unreachable, np.nan, alpha)
    return Paint(target.copy()[()], form.specular_reflectance(target, c), alpha.copy()[()])
