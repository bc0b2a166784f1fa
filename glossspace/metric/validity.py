"""What a paint can be: the domain of the physical and perceptual parameters, checked in one place.

NaN means "not known" and passes every check, so that it comes out as NaN where it went in. Everything else that cannot
be is refused with the offending value, since a silently clipped reflectance is a wrong stimulus.
"""

from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from glossspace.errors import GlossError

__all__ = ["PAPER_ALPHA_LIMIT", "FloatArray", "as_floats", "require", "require_energy", "within_paper_range"]

FloatArray: TypeAlias = NDArray[np.float64]

PAPER_ALPHA_LIMIT = 0.2
"""Roughness above which Ward's lobe is no longer normalised: the gloss paper vouches for nothing there (section 4)."""

# Sums such as rho_d + (1 - rho_d) may round to a little above one: they are on the limit, not beyond it.
_ROUNDING = 1e-12


def as_floats(value: ArrayLike, *, name: str) -> FloatArray:
    """Turn `value` into an array of floats, or say which parameter was not numeric."""
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise GlossError(f"{name} must be a number or an array of numbers, but got {value!r}.") from None


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
        raise GlossError(f"Invalid {name} = {offender:.10g}{more}. Allowed: {allowed}.")


def require_energy(rho_d: FloatArray, rho_s: FloatArray) -> None:
    """Refuse paints that reflect more than they receive: rho_d + rho_s must not exceed 1."""
    total = rho_d + rho_s
    require(
        total <= 1 + _ROUNDING,
        np.asarray(total),
        name="rho_d + rho_s",
        allowed="at most 1, since a paint cannot reflect more light than it receives; lower one of the two",
    )


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

    Examples
    --------
    >>> within_paper_range([0.04, 0.3])
    array([ True, False])
    """
    return as_floats(alpha, name="alpha") <= PAPER_ALPHA_LIMIT
