"""Tumblin's rational sigmoid: scene luminance to display luminance, smooth, monotone and invertible.

Tumblin, Hodgins & Guenter 1999, *Two methods for display of high contrast images*. With x = luminance over the adapting
luminance::

    s(x) = D (x^g + 1/k) / (x^g + k)

Its log-log slope is largest at x = 1, where it is ``g (k - 1) / (k + 1)``; its asymptotic contrast is k². In ln x and
ln s it is symmetric about that point: ``s(x) s(1/x) = (D/k)²``. `solve_tone_curve` chooses g, k and D so that the slope
is the wanted one, s(x_max) / s(x_min) is the display's contrast and s(x_max) = 1.
"""

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from glossspace.errors import GlossError

__all__ = ["ToneCurve", "solve_tone_curve"]

# By how much the darkest displayed luminance may be missed, relative to itself, and still be taken for it.
ROUNDING = 1e-12


@dataclass(frozen=True, kw_only=True)
class ToneCurve:
    """A rational sigmoid with its parameters; make one with `solve_tone_curve`.

    Attributes
    ----------
    adapting_luminance_cd_m2 : float
        Luminance where x = 1.
    minimum_luminance_cd_m2, maximum_luminance_cd_m2 : float
        Scene luminances displayed as the display's black and white. The curve goes on outside them, where the display
        cannot follow; `clipped` counts what lies there.
    gain, exponent, knee : float
        D, g and k of the equation.
    """

    adapting_luminance_cd_m2: float
    minimum_luminance_cd_m2: float
    maximum_luminance_cd_m2: float
    gain: float
    exponent: float
    knee: float

    def __call__(self, luminance_cd_m2: ArrayLike) -> NDArray[np.float64]:
        """Display luminance relative to the display's white, for scene luminance in cd/m² (any shape).

        Examples
        --------
        >>> curve = solve_tone_curve(adapting=30.0, minimum=0.0, maximum=300.0, slope=1.0, contrast=154.0)
        >>> float(curve(300.0).round(12))
        1.0
        """
        power = self._power(luminance_cd_m2)
        displayed = power + 1 / self.knee
        displayed *= self.gain
        power += self.knee
        displayed /= power
        return displayed

    def inverse(self, relative_display_luminance: ArrayLike) -> NDArray[np.float64]:
        """Scene luminance (cd/m²) that is displayed at this luminance relative to white.

        Raises
        ------
        GlossError
            A value is below what darkness is displayed at, D / k², or not below the curve's asymptote D.
        """
        s = np.asarray(relative_display_luminance, dtype=float)
        darkest = self.gain / self.knee**2
        reached = (s >= darkest * (1 - ROUNDING)) & (s < self.gain)
        if not np.all(reached | np.isnan(s)):
            raise GlossError(
                f"No scene luminance is displayed at {float(s[~reached].flat[0]):g} of white: this tone curve reaches "
                f"from {darkest:.6g} to below {self.gain:.6g}."
            )
        # s (y + k) = D (y + 1/k) solved for y = x^g; rounding may leave the darkest value a hair below zero.
        power = np.maximum((s * self.knee - self.gain / self.knee) / (self.gain - s), 0.0)
        return self.adapting_luminance_cd_m2 * power ** (1 / self.exponent)

    def log_log_slope(self, luminance_cd_m2: ArrayLike) -> NDArray[np.float64]:
        """Derivative d ln s / d ln luminance: ``g y (k - 1/k) / ((y + 1/k) (y + k))`` with y = x^g."""
        y, k = self._power(luminance_cd_m2), self.knee
        return self.exponent * y * (k - 1 / k) / ((y + 1 / k) * (y + k))

    def clipped(self, luminance_cd_m2: ArrayLike) -> int:
        """Number of values that lie outside the displayed range."""
        luminance = np.asarray(luminance_cd_m2, dtype=float)
        outside = (luminance < self.minimum_luminance_cd_m2) | (luminance > self.maximum_luminance_cd_m2)
        return int(np.count_nonzero(outside))

    def to_dict(self) -> dict[str, Any]:
        """Parameters as JSON takes them, with the name of the equation."""
        return {"kind": "rational sigmoid (Tumblin, Hodgins & Guenter 1999)", **asdict(self)}

    def _power(self, luminance_cd_m2: ArrayLike) -> NDArray[np.float64]:
        power = np.array(luminance_cd_m2, dtype=float)  # a copy: the steps below need no further memory
        power /= self.adapting_luminance_cd_m2
        np.maximum(power, 0.0, out=power)
        np.power(power, self.exponent, out=power)
        return power


def solve_tone_curve(*, adapting: float, minimum: float, maximum: float, slope: float, contrast: float) -> ToneCurve:
    """Rational sigmoid with the given slope, contrast and range.

    Parameters
    ----------
    adapting, minimum, maximum : float
        Scene luminances (cd/m²), 0 ≤ minimum < adapting < maximum: where the slope holds, and what the display's black
        and white show.
    slope : float
        Log-log slope at the adapting luminance; 1 keeps the contrasts of the scene there.
    contrast : float
        White over black luminance of the display, above 1.

    Returns
    -------
    ToneCurve

    Raises
    ------
    GlossError
        The numbers are out of order, or no rational sigmoid spans the contrast with this slope and range.

    Examples
    --------
    >>> curve = solve_tone_curve(adapting=30.0, minimum=0.0, maximum=300.0, slope=1.0, contrast=154.0)
    >>> round(float(curve.log_log_slope(30.0)), 12)
    1.0
    """
    from scipy.optimize import brentq

    if not (0 <= minimum < adapting < maximum < math.inf and slope > 0 and 1 < contrast < math.inf):
        raise GlossError(
            "A tone curve needs 0 <= minimum < adapting < maximum luminance, a slope above 0 and a contrast above 1, "
            f"but got {minimum:g}, {adapting:g}, {maximum:g} cd/m2, {slope:g} and {contrast:g}."
        )
    low, high = minimum / adapting, maximum / adapting

    def excess(log_knee: float) -> float:
        return _log_contrast(log_knee, slope=slope, low=low, high=high) - math.log(contrast)

    # The contrast lies between k² and 1; k spans what float64 can tell apart from its ends.
    smallest, largest = 0.5 * math.log(contrast) * (1 - 1e-9), 200.0
    if excess(smallest) > 0 or excess(largest) < 0:
        reach = math.exp(min(_log_contrast(largest, slope=slope, low=low, high=high), 700.0))
        raise GlossError(
            f"No tone curve of slope {slope:g} spans a contrast of {contrast:g} between {minimum:g} and {maximum:g} "
            f"cd/m2: it reaches {reach:.4g} at most. Raise [tone] slope, or widen its luminance range."
        )
    knee = math.exp(brentq(excess, smallest, largest, xtol=1e-15, rtol=1e-15, maxiter=500))
    exponent = _exponent(math.log(knee), slope)
    try:
        top = high**exponent
    except OverflowError:
        raise GlossError(
            f"No tone curve of slope {slope:g} reaches from {adapting:g} to {maximum:g} cd/m2: its power of "
            f"{exponent:g} is beyond any number. Lower [tone] slope, or narrow its luminance range."
        ) from None
    gain = (top + knee) / (top + 1 / knee)
    return ToneCurve(
        adapting_luminance_cd_m2=adapting,
        minimum_luminance_cd_m2=minimum,
        maximum_luminance_cd_m2=maximum,
        gain=gain,
        exponent=exponent,
        knee=knee,
    )


def _exponent(log_knee: float, slope: float) -> float:
    return slope / math.tanh(log_knee / 2)  # (k + 1) / (k - 1)


def _log_contrast(log_knee: float, *, slope: float, low: float, high: float) -> float:
    exponent = _exponent(log_knee, slope)

    def log_s(x: float) -> float:
        if x == 0:
            return -2 * log_knee
        log_power = exponent * math.log(x)
        return float(np.logaddexp(log_power, -log_knee) - np.logaddexp(log_power, log_knee))

    return log_s(high) - log_s(low)
