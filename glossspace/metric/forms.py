"""Forms of the gloss axes: the gloss paper's, and the same with another exponent, diffuse share or offset.

    c = (rho_s + k rho_d + o)^p - (k rho_d + o)^p        the paper's: p = 1/3, k = 1/2, o = 0  (eq. 4)
    d = 1 - (alpha + o)^q                                the paper's: q = 1, o = 0             (eq. 3)

k says how much of its diffuse reflectance a surface adds to what it mirrors, half in the paper's box of black and white
checks; o is light that the eye adds to everything, or roughness that it adds to every lobe. Another scene or shape may
have others.
"""

import math
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from glossspace.errors import GlossError
from glossspace.metric import axes as paper
from glossspace.metric.validity import (
    FloatArray,
    as_float_arrays,
    as_floats,
    conserves_energy,
    require,
    require_reflectances,
    require_roughness,
)

__all__ = ["FORM_LIMITS", "PAPER_CONTRAST", "PAPER_DISTINCTNESS", "ContrastForm", "DistinctnessForm"]

FORM_LIMITS = {"exponent": (0.05, 3.0), "diffuse_share": (1e-3, 10.0), "offset": (0.0, 10.0)}
"""Smallest and largest value of each parameter of a form."""


@dataclass(frozen=True)
class ContrastForm:
    """How contrast gloss depends on a paint: c = (rho_s + k rho_d + o)^p - (k rho_d + o)^p.

    Attributes
    ----------
    exponent : float
        p, .05 to 3; a cube root in the gloss paper, after CIELAB.
    diffuse_share : float
        k, .001 to 10.
    offset : float
        o, 0 to 10, in units of reflectance.

    Raises
    ------
    GlossError
        A parameter is out of its range.

    Examples
    --------
    >>> round(float(ContrastForm().value(0.193, 0.066)), 5)
    0.08702
    >>> round(float(ContrastForm(exponent=0.5).value(0.193, 0.066)), 5)
    0.09247
    """

    exponent: float = 1 / 3
    diffuse_share: float = 0.5
    offset: float = 0.0

    def __post_init__(self) -> None:
        _check(self)

    @property
    def text(self) -> str:
        """The form as a formula."""
        if self == PAPER_CONTRAST:
            return "cbrt(rho_s + rho_d/2) - cbrt(rho_d/2)"
        base = f"{self.diffuse_share:.4g} rho_d" + (f" + {self.offset:.4g}" if self.offset else "")
        return f"(rho_s + {base})^{self.exponent:.4g} - ({base})^{self.exponent:.4g}"

    def value(self, rho_d: ArrayLike, rho_s: ArrayLike) -> FloatArray:
        """Contrast gloss c >= 0 of paints, scalars or arrays that broadcast. NaN in gives NaN out.

        Raises
        ------
        GlossError
            A reflectance is impossible; see `contrast_gloss`.
        """
        if self == PAPER_CONTRAST:
            return paper.contrast_gloss(rho_d, rho_s)
        rho_d, rho_s = as_float_arrays(rho_d=rho_d, rho_s=rho_s)
        require_reflectances(rho_d, rho_s)
        base = self._base(rho_d)
        # A difference of powers loses its digits where rho_s is the smaller; the other form is 0/0 on black.
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            small = base**self.exponent * np.expm1(self.exponent * np.log1p(rho_s / base))
        return np.where(
            rho_s > base, (rho_s + base) ** self.exponent - base**self.exponent, np.where(rho_s == 0, 0.0, small)
        )[()]

    def specular_reflectance(self, rho_d: ArrayLike, c: ArrayLike) -> FloatArray:
        """Specular reflectance that gives paints of `rho_d` the contrast gloss `c`: the inverse of `value`.

        Raises
        ------
        GlossError
            rho_d or c is impossible, or the paint would reflect more than it receives.
        """
        if self == PAPER_CONTRAST:
            return paper.specular_reflectance(rho_d, c)
        rho_d, c = as_float_arrays(rho_d=rho_d, c=c)
        require((rho_d >= 0) & (rho_d <= 1), rho_d, name="rho_d", allowed="0 to 1")
        require((c >= 0) & (c < np.inf), c, name="c", allowed="finite and >= 0")
        beyond = ~self.is_paintable(rho_d, c) & ~np.isnan(rho_d + c)
        if np.any(beyond):
            one_rho_d, one_c = (float(values[beyond][0]) for values in np.broadcast_arrays(rho_d, c))
            raise GlossError(
                f"Contrast gloss c = {one_c:.10g} is out of reach for rho_d = {one_rho_d:.10g}, which allows at most "
                f"{self.value(one_rho_d, 1 - one_rho_d):.10g}. Choose a darker paint or less contrast gloss."
            )
        return self._inverse(rho_d, c)[()]

    def is_paintable(self, rho_d: FloatArray, c: FloatArray) -> NDArray[np.bool_]:
        """Whether a paint of diffuse reflectance `rho_d` can have contrast gloss `c`, any number. False for NaN."""
        if self == PAPER_CONTRAST:
            return paper.is_paintable(rho_d, c)
        with np.errstate(over="ignore", invalid="ignore"):  # a contour may run far out of the space
            return np.asarray((c >= 0) & conserves_energy(rho_d, self._inverse(rho_d, np.maximum(c, 0.0))))

    def _base(self, rho_d: FloatArray) -> FloatArray:
        return np.asarray(self.diffuse_share * rho_d + self.offset)

    def _inverse(self, rho_d: FloatArray, c: FloatArray) -> FloatArray:
        base = self._base(rho_d)
        root = base**self.exponent
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            small = base * np.expm1(np.log1p(c / root) / self.exponent)
            large = (c + root) ** (1 / self.exponent) - base
        return np.asarray(np.where(c > root, large, np.where(c == 0, 0.0, small)))


@dataclass(frozen=True)
class DistinctnessForm:
    """How distinctness of image depends on roughness: d = 1 - (alpha + o)^q.

    Attributes
    ----------
    exponent : float
        q, .05 to 3; 1 in the gloss paper.
    offset : float
        o, 0 to 10, in units of alpha.

    Raises
    ------
    GlossError
        A parameter is out of its range.

    Examples
    --------
    >>> round(float(DistinctnessForm(exponent=0.5).value(0.09)), 3)
    0.7
    """

    exponent: float = 1.0
    offset: float = 0.0

    def __post_init__(self) -> None:
        _check(self)

    @property
    def text(self) -> str:
        """The form as a formula."""
        base = f"(alpha + {self.offset:.4g})" if self.offset else "alpha"
        return f"1 - {base}" + ("" if self.exponent == 1 else f"^{self.exponent:.4g}")

    @property
    def limit(self) -> float:
        """The d of a perfect mirror, alpha = 0, which no lobe reaches."""
        return 1 - self.offset**self.exponent

    def value(self, alpha: ArrayLike) -> FloatArray:
        """Distinctness of image of roughness alpha > 0. NaN in gives NaN out.

        Raises
        ------
        GlossError
            alpha is zero, negative or infinite.
        """
        if self == PAPER_DISTINCTNESS:
            return paper.distinctness(alpha)
        alpha = as_floats(alpha, name="alpha")
        require_roughness(alpha)
        return np.asarray(1 - (alpha + self.offset) ** self.exponent)[()]

    def roughness_alpha(self, d: ArrayLike) -> FloatArray:
        """Roughness of a distinctness of image: the inverse of `value`.

        Raises
        ------
        GlossError
            d is not below that of a perfect mirror, or infinite.
        """
        if self == PAPER_DISTINCTNESS:
            return paper.roughness_alpha(d)
        d = as_floats(d, name="d")
        require(self.has_lobe(d) & (d > -np.inf), d, name="d", allowed=f"below {self.limit:g}, since alpha is positive")
        with np.errstate(over="ignore", invalid="ignore"):
            return np.asarray((1 - d) ** (1 / self.exponent) - self.offset)[()]

    def has_lobe(self, d: FloatArray) -> NDArray[np.bool_]:
        """Whether some roughness gives this d, any number. False for NaN."""
        with np.errstate(over="ignore", invalid="ignore"):
            base = np.maximum(1 - d, 0.0) ** (1 / self.exponent)
        return np.asarray((d < 1) & (base > self.offset) & (base < np.inf))


def _check(form: ContrastForm | DistinctnessForm) -> None:
    for field in fields(form):
        value, (low, high) = getattr(form, field.name), FORM_LIMITS[field.name]
        number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
        if not (number and math.isfinite(value) and low <= value <= high):
            raise GlossError(
                f"Invalid {field.name} = {value!r} of the form of a gloss axis. Allowed: {low:g} to {high:g}."
            )


PAPER_CONTRAST = ContrastForm()
"""Eq. 4 of the gloss paper."""

PAPER_DISTINCTNESS = DistinctnessForm()
"""Eq. 3 of the gloss paper."""
