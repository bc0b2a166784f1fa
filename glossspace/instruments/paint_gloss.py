"""Across the two languages of gloss: a glossmeter's readings and the gloss space's (L*, c, d).

A paint of the gloss space is Lambert's diffuse part under Ward's lobe, so that its readings follow from the instrument,
and readings give the paint back if its lightness is known. A glossmeter cannot tell the diffuse part: give it.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from glossspace.instruments.glossmeter import GlossReading, gloss_reading
from glossspace.instruments.inversion import Inversion, alike_parameters, invert_gloss
from glossspace.instruments.lobe_families import Material
from glossspace.metric import PAPER_SPACE, Appearance, GlossSpace, Paint
from glossspace.reflectance import Lambert, Ward

__all__ = ["MeasuredPaint", "alike_appearances", "paint_from_gloss", "paint_reading"]


class MeasuredPaint(NamedTuple):
    """A paint that reads as was measured, how it looks, and the inversion that it comes from."""

    paint: Paint
    appearance: Appearance
    inversion: Inversion


def paint_reading(paint: Paint) -> GlossReading:
    """What a glossmeter reads of a paint of the gloss space.

    Parameters
    ----------
    paint : Paint
        (rho_d, rho_s, alpha): numbers, or arrays of one length (K,).

    Returns
    -------
    GlossReading
        Gloss units and albedos at the three angles.

    Raises
    ------
    GlossError
        A parameter is impossible.

    Examples
    --------
    >>> reading = paint_reading(Paint(0.193, 0.066, 0.07))
    >>> round(float(reading.gu60), 2)
    9.95
    """
    return gloss_reading(Lambert(paint.rho_d) + Ward(paint.rho_s, paint.alpha))


def paint_from_gloss(
    readings: Mapping[int, float],
    *,
    rho_d: float,
    rho_s: float | None = None,
    alpha: float | None = None,
    space: GlossSpace = PAPER_SPACE,
) -> MeasuredPaint:
    """Which c and d a paint has, from one to three glossmeter readings and its diffuse reflectance.

    Parameters
    ----------
    readings : mapping of int to float
        Gloss units by angle, of 20, 60 and 85.
    rho_d : float
        Diffuse reflectance, 0 to 1.
    rho_s, alpha : float, optional
        What else is known; one reading alone needs one of them.
    space : GlossSpace
        Whose c and d; the gloss paper's by default.

    Returns
    -------
    MeasuredPaint
        The best paint. Look at ``inversion.exact`` and ``inversion.fits``: readings that Ward's lobe does not give at
        all angles are met as well as can be, and two paints may read alike.

    Raises
    ------
    GlossError
        See `invert_gloss`.

    Examples
    --------
    >>> found = paint_from_gloss({20: 5.0, 60: 12.0}, rho_d=0.193)
    >>> [round(float(value), 3) for value in (found.appearance.c, found.appearance.d)]
    [0.111, 0.924]
    """
    inversion = invert_gloss(readings, amplitude=rho_s, roughness=alpha, material=Material(rho_d=rho_d))
    best = inversion.fits[0]
    paint = Paint(rho_d, best.amplitude, best.roughness)
    return MeasuredPaint(paint, space.appearance(paint), inversion)


def alike_appearances(
    readings: Mapping[int, float], *, rho_d: float, tolerance_gu: float = 0.5, space: GlossSpace = PAPER_SPACE
) -> pd.DataFrame:
    """All paints of one lightness that read as was measured, with the c and d of each.

    Parameters
    ----------
    readings, rho_d, space
        As in `paint_from_gloss`.
    tolerance_gu : float
        Half width of what counts as alike.

    Returns
    -------
    DataFrame
        ``alpha, rho_s_low, rho_s_high, c_low, c_high, d``. A single reading leaves a long curve in the gloss space.

    Raises
    ------
    GlossError
        See `alike_parameters`.

    Examples
    --------
    >>> curve = alike_appearances({60: 12.0}, rho_d=0.193)
    >>> bool(curve["c_high"].max() - curve["c_low"].min() > 0.2)
    True
    """
    rows = alike_parameters(readings, tolerance_gu=tolerance_gu, material=Material(rho_d=rho_d))
    for end in ("low", "high"):
        rows[f"c_{end}"] = _contrast(space, rho_d, rows[f"rho_s_{end}"])
    rows["d"] = space.distinctness_form.value(rows["alpha"].to_numpy())
    return rows


def _contrast(space: GlossSpace, rho_d: float, rho_s: ArrayLike) -> ArrayLike:
    return space.contrast_form.value(rho_d, np.minimum(np.asarray(rho_s), 1 - rho_d))
