"""Gain, offset and gamma of a screen's channels, fitted to photometer readings."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gloss_experiments.calibration.fit_table import CurveName, FitTable
from glossspace.errors import GlossError

__all__ = ["Curve", "GainOffsetGamma", "fit_gain_offset_gamma"]

# A photometer errs by a share of its reading and, near black, by a digit: this share of white weighs like that digit.
_DIGIT = 1e-3
_GAMMA_START = 2.2
_LOWEST = {"range": 0.0, "offset": -0.9, "gamma": 0.1}
_HIGHEST = {"range": np.inf, "offset": 0.9, "gamma": 10.0}


@dataclass(frozen=True, kw_only=True)
class Curve:
    """One channel, or gray: its range above black, its offset and its gamma, with half-widths of 95 % intervals."""

    range_cd_m2: float
    offset: float
    gamma: float
    range_half_width: float
    offset_half_width: float
    gamma_half_width: float

    @property
    def gain(self) -> float:
        """Gain of the code value: 1 minus the offset."""
        return 1 - self.offset


@dataclass(frozen=True, kw_only=True)
class GainOffsetGamma:
    """A gain-offset-gamma model of a screen; make one with `fit_gain_offset_gamma`.

    Attributes
    ----------
    black_cd_m2, black_half_width : float
        Luminance at code 0, ambient light included, and the half-width of its 95 % interval.
    curves : dict
        Of gray alone, or of red, green and blue.
    top : int
        Largest code value.
    rms_relative : float
        Root mean square of the weighted residuals: about the relative error of a reading.
    """

    black_cd_m2: float
    black_half_width: float
    curves: dict[CurveName, Curve]
    top: int
    rms_relative: float

    def added_cd_m2(self, name: CurveName, codes: ArrayLike) -> NDArray[np.float64]:
        """What a curve adds to black at these code values."""
        curve = self.curves[name]
        shape = _shape(np.asarray(codes, dtype=float) / self.top, curve.offset, curve.gamma)
        return np.asarray(curve.range_cd_m2 * shape, dtype=float)

    def gray_cd_m2(self, codes: ArrayLike) -> NDArray[np.float64]:
        """Luminance of gray at these code values: black and what every curve adds."""
        added = [self.added_cd_m2(name, codes) for name in self.curves]
        return np.asarray(self.black_cd_m2 + np.sum(added, axis=0), dtype=float)


def fit_gain_offset_gamma(table: FitTable, names: Sequence[CurveName], *, top: int) -> GainOffsetGamma:
    """Fit black, and range, offset and gamma of each named curve, by weighted least squares.

    Parameters
    ----------
    table : FitTable
        Readings at black and along each curve.
    names : sequence
        ``("gray",)``, or the three channels.
    top : int
        Largest code value.

    Returns
    -------
    GainOffsetGamma

    Raises
    ------
    GlossError
        The fit does not converge.

    Notes
    -----
    A channel of a display emits, at the share x of the largest code value (Berns 1996, Displays 16, 173-182)::

        L(x) = Lmax h(x),   h(x) = (g x + o)^gamma,   g + o = 1,   and 0 where g x + o is negative

    What the three emit at code 0 cannot be told from ambient light by readings of the screen, so both are the black K,
    and every curve is counted from there::

        Y = K + sum over channels of A (h(x) - h(0)) / (1 - h(0))

    With the offset 0 this is the gloss paper's display, ``K + A x^gamma``. Residuals are divided by the reading plus
    a thousandth of the largest one, as photometers err: by a share, and by a digit. The intervals are Student's, from
    the Jacobian at the solution.

    Examples
    --------
    >>> from gloss_experiments.calibration import SimulatedScreen, fit_table, simulated_readings
    >>> table = fit_table(simulated_readings(SimulatedScreen()).of("fit"), top=255)
    >>> fitted = fit_gain_offset_gamma(table, ("gray",), top=255)
    >>> round(fitted.curves["gray"].gamma, 4), round(fitted.black_cd_m2, 4)
    (2.35, 0.7)
    """
    from scipy.optimize import least_squares

    black = float(table.black_cd_m2.mean())
    owner = np.concatenate([np.full(table.curves[name].codes.size, index) for index, name in enumerate(names)])
    share = np.concatenate([table.curves[name].codes for name in names]) / top
    read = np.concatenate([table.curves[name].luminance_cd_m2 for name in names])
    every = np.concatenate([table.black_cd_m2, read])
    weight = 1 / (every + _DIGIT * every.max())
    start = [black]
    for name in names:
        start += [max(float(table.curves[name].luminance_cd_m2.max()) - black, 1e-9), 0.0, _GAMMA_START]

    def residuals(parameters: NDArray[np.float64]) -> NDArray[np.float64]:
        ranges, offsets, gammas = parameters[1:].reshape(-1, 3).T
        added = ranges[owner] * _shape(share, offsets[owner], gammas[owner])
        predicted = parameters[0] + np.concatenate([np.zeros(table.black_cd_m2.size), added])
        return np.asarray((predicted - every) * weight, dtype=float)

    bounds = ([0.0, *[*_LOWEST.values()] * len(names)], [np.inf, *[*_HIGHEST.values()] * len(names)])
    solution = least_squares(
        residuals, np.maximum(start, bounds[0]), bounds=bounds, jac="3-point", x_scale="jac",
        xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=2000,
    )  # fmt: skip
    if solution.status <= 0 and not np.sqrt(2 * solution.cost / every.size) < 1e-9:
        raise GlossError(
            f"The gain-offset-gamma fit of {', '.join(names)} does not converge. Look at the readings: does luminance "
            "rise smoothly with the code values?"
        )
    widths = _half_widths(solution.jac, residual_sum=2 * float(solution.cost))
    found, half = solution.x[1:].reshape(-1, 3), widths[1:].reshape(-1, 3)
    curves = {
        name: Curve(
            range_cd_m2=float(values[0]), offset=float(values[1]), gamma=float(values[2]),
            range_half_width=float(width[0]), offset_half_width=float(width[1]), gamma_half_width=float(width[2]),
        )
        for name, values, width in zip(names, found, half, strict=True)
    }  # fmt: skip
    return GainOffsetGamma(
        black_cd_m2=float(solution.x[0]),
        black_half_width=float(widths[0]),
        curves=curves,
        top=top,
        rms_relative=float(np.sqrt(2 * solution.cost / every.size)),
    )


def _shape(
    share: NDArray[np.float64], offset: NDArray[np.float64] | float, gamma: NDArray[np.float64] | float
) -> NDArray[np.float64]:
    """From 0 at code 0 to 1 at the largest one."""
    raised = np.maximum((1 - offset) * share + offset, 0.0) ** gamma
    foot = np.maximum(offset, 0.0) ** gamma
    return np.asarray((raised - foot) / (1 - foot), dtype=float)


def _half_widths(jacobian: NDArray[np.float64], *, residual_sum: float) -> NDArray[np.float64]:
    """Half-widths of 95 % intervals; infinite where the readings do not determine the parameters."""
    from scipy.stats import t as student

    n, k = jacobian.shape
    scale = np.linalg.norm(jacobian, axis=0)
    if n <= k or not scale.all() or np.linalg.matrix_rank(jacobian / scale) < k:
        return np.full(k, np.inf)
    inverse = np.linalg.inv((jacobian / scale).T @ (jacobian / scale))
    errors = np.sqrt(np.diag(inverse) * residual_sum / (n - k)) / scale
    return np.asarray(student.ppf(0.975, n - k) * errors, dtype=float)
