"""What a paint can be: the domain of the physical and perceptual parameters, checked in one place.

NaN means "not known" and passes every check, so that it comes out as NaN where it went in. Everything else that cannot
be is refused with the offending value, since a silently clipped reflectance is a wrong stimulus.
"""

import reprlib
from numbers import Real
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from glossspace.errors import GlossError

__all__ = [
    "PAPER_ALPHA_LIMIT",
    "FloatArray",
    "as_float_arrays",
    "as_floats",
    "conserves_energy",
    "require",
    "require_reflectances",
    "require_roughness",
    "within_paper_range",
]

FloatArray: TypeAlias = NDArray[np.float64]

PAPER_ALPHA_LIMIT = 0.2
"""Roughness above which Ward's lobe is no longer normalised: the gloss paper vouches for nothing there (section 4)."""

# Sums such as rho_d + (1 - rho_d) may round to a little above one: they are on the limit, not beyond it.
_ROUNDING = 1e-12


def as_floats(value: ArrayLike, *, name: str) -> FloatArray:
    """Turn `value` into an array of floats, or say which parameter was not numeric.

    NumPy alone would read None as NaN and text as a number, and drop an imaginary part or a mask: wrong numbers in
    silence. Masked entries become NaN.
    """
    try:
        if isinstance(value, np.ma.MaskedArray):
            value = np.ma.filled(value.astype(np.float64), np.nan)
        array = np.asarray(value)
        kind = array.dtype.kind
        if kind in "fiu" or (kind == "O" and all(isinstance(item, Real) for item in array.flat)):
            return np.asarray(array, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        pass
    raise GlossError(f"{name} must be a number or an array of numbers, but got {reprlib.repr(value)}.")


def as_float_arrays(**parameters: ArrayLike) -> list[FloatArray]:
    """Turn named parameters into arrays of floats that broadcast, or say which shapes do not fit."""
    arrays = {name: as_floats(value, name=name) for name, value in parameters.items()}
    try:
        np.broadcast_shapes(*(array.shape for array in arrays.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
        raise GlossError(f"These shapes do not broadcast: {shapes}. Give one value or equally many of each.") from None
    return list(arrays.values())


def require(possible: NDArray[np.bool_], values: FloatArray, *, name: str, allowed: str) -> None:
    """Raise for the first of `values` that is neither NaN nor `possible`.

    Raises
    ------
    GlossError
        Names the parameter, the value and what is allowed.
    """
    wrong = ~possible & ~np.isnan(values)
    if np.any(wrong):
        offender = float(values[wrong][0]) if values.ndim else float(values)
        count = int(np.count_nonzero(wrong))
        more = f" (and {count - 1} more)" if count > 1 else ""
        raise GlossError(f"Invalid {name} = {offender!r}{more}. Allowed: {allowed}.")


def conserves_energy(rho_d: FloatArray, rho_s: FloatArray) -> NDArray[np.bool_]:
    """Whether paints reflect no more than they receive: rho_d + rho_s <= 1, up to rounding. False for NaN."""
    return rho_d + rho_s <= 1 + _ROUNDING


def require_reflectances(rho_d: FloatArray, rho_s: FloatArray) -> None:
    """Refuse reflectances that no paint has: one outside 0 to 1, or two that add to more than 1."""
    require((rho_d >= 0) & (rho_d <= 1), rho_d, name="rho_d", allowed="0 to 1")
    require((rho_s >= 0) & (rho_s <= 1 + _ROUNDING), rho_s, name="rho_s", allowed="0 to 1 - rho_d")
    require(
        conserves_energy(rho_d, rho_s),
        np.asarray(rho_d + rho_s),
        name="rho_d + rho_s",
        allowed="at most 1, since a paint cannot reflect more light than it receives; lower one of the two",
    )


def require_roughness(alpha: FloatArray) -> None:
    """Refuse a roughness that no lobe has: zero, negative or infinite."""
    require((alpha > 0) & (alpha < np.inf), alpha, name="alpha", allowed="finite and > 0")


def within_paper_range(alpha: ArrayLike) -> NDArray[np.bool_]:
    """Whether roughness `alpha` lies where the gloss paper vouches for its model.

    Parameters
    ----------
    alpha : array_like
        Roughness of Ward's lobe, > 0.

    Returns
    -------
    ndarray of bool
        True where alpha <= 0.2; False above and for NaN. Values above are still computed by every function here: the
        lobe is merely not normalised there (gloss paper, section 4).

    Raises
    ------
    GlossError
        alpha is zero, negative or infinite.

    Examples
    --------
    >>> within_paper_range([0.04, 0.3]).tolist()
    [True, False]
    """
    alpha = as_floats(alpha, name="alpha")
    require_roughness(alpha)
    return alpha <= PAPER_ALPHA_LIMIT
