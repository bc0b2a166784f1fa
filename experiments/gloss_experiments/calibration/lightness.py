"""CIELAB lightness of a luminance, the unit in which differences between screens are judged."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["lightness_of_luminance"]

_FOOT_END = (6 / 29) ** 3
_FOOT_SLOPE = (29 / 3) ** 3


def lightness_of_luminance(luminance_cd_m2: ArrayLike, *, white_cd_m2: float) -> NDArray[np.float64]:
    """CIELAB lightness L* of luminances on a screen whose white is `white_cd_m2`.

    ``L* = 116 (Y/Yn)^(1/3) - 16``, and ``(29/3)^3 Y/Yn`` below ``(6/29)^3`` (CIE 15:2004). Unlike the lightness of a
    reflectance it may exceed 100: a reading of white is noisy.

    Parameters
    ----------
    luminance_cd_m2 : array_like
        Luminances from 0 on.
    white_cd_m2 : float
        Luminance of the white, above 0.

    Examples
    --------
    >>> lightness_of_luminance([0.7, 19.9, 108.0], white_cd_m2=108.0).round(1).tolist()
    [5.9, 50.0, 100.0]
    """
    share = np.asarray(luminance_cd_m2, dtype=float) / white_cd_m2
    return np.where(share <= _FOOT_END, _FOOT_SLOPE * share, 116 * np.cbrt(share) - 16)
