"""Mean ratings over a gloss axis: the line, whether a curve says more than it does, and how well each predicts.

The gloss paper calls a relation linear because polynomials gain less than .01 in r squared. That gain can only be
positive, so the criteria here also charge for the coefficients, or predict stimuli that were left out.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.stats import linregress
from scipy.stats import t as student_t

from glossspace.errors import GlossError

__all__ = ["AxisRegression", "PolynomialFit", "aicc", "fit_polynomials", "polynomial_sentence", "regress_ratings"]

# The gloss paper's limit (3.3.4): "Polynomial fits only increased r2 by less than 0.01".
_LINEAR_GAIN = 0.01
# Extents of an axis beyond this, and below its inverse, are slips of the unit: squares would overflow.
_LARGEST = 1e100
# A stimulus that the fit passes through by construction has leverage 1 but for rounding: leaving it out leaves its
# coefficient unknown.
_FULL_LEVERAGE = 1 - 1e-9


@dataclass(frozen=True)
class PolynomialFit:
    """Least-squares polynomial of one order, with criteria that compare it to others.

    Attributes
    ----------
    order : int
    r_squared : float
    adjusted_r_squared : float
        Compares variances per degree of freedom; NaN without any degree left.
    leave_one_out_error : float
        Root mean square error, in units of rating, of predicting each stimulus from all others; NaN where some stimulus
        alone determines a coefficient.
    aicc : float
        Akaike's information criterion with the correction for small samples, up to a constant that is the same for all
        fits to the same ratings; NaN with too few stimuli for the correction, -inf for a perfect fit.
    """

    order: int
    r_squared: float
    adjusted_r_squared: float
    leave_one_out_error: float
    aicc: float


@dataclass(frozen=True)
class AxisRegression:
    """Linear regression of mean ratings on an axis, and what curvature would add.

    Attributes
    ----------
    slope, intercept, r_squared : float
    slope_ci95 : tuple of float
        95 % interval of the slope.
    polynomial_r_squared : tuple of float
        r squared of the polynomials of order 2 and 3, as far as the number of distinct positions allows. The gloss
        paper calls the relation linear because they gain less than .01.
    n_stimuli : int
    polynomials : tuple of PolynomialFit
        Orders 1 to 3 with the criteria that charge for coefficients; `polynomial_sentence` puts them in words.
    """

    slope: float
    intercept: float
    r_squared: float
    slope_ci95: tuple[float, float]
    polynomial_r_squared: tuple[float, ...]
    n_stimuli: int
    polynomials: tuple[PolynomialFit, ...] = ()


def regress_ratings(coordinate: np.ndarray, rating: np.ndarray) -> AxisRegression:
    """Fit rating = intercept + slope * coordinate by least squares.

    Parameters
    ----------
    coordinate, rating : ndarray, shape (n,)
        Position along the axis and mean rating of each stimulus; at least 3 distinct positions.

    Returns
    -------
    AxisRegression

    Raises
    ------
    GlossError
        Too few positions, or positions that hardly differ; values that are not finite, or all ratings the same.
    """
    coordinate, rating = np.asarray(coordinate, dtype=float), np.asarray(rating, dtype=float)
    positions = len(np.unique(coordinate))
    if not (np.all(np.isfinite(coordinate)) and np.all(np.isfinite(rating))):
        raise GlossError("A regression of ratings needs finite coordinates and ratings.")
    if positions < 3:
        raise GlossError(f"A regression of ratings needs 3 different positions along the axis, but got {positions}.")
    extent = np.ptp(coordinate)
    if not 1 / _LARGEST <= extent <= _LARGEST:
        raise GlossError(
            f"The positions along the axis differ by {extent:g}, where a slope is beyond what a number can hold. "
            f"Allowed: {1 / _LARGEST:g} to {_LARGEST:g}. Check the table of stimuli."
        )
    if np.ptp(rating) == 0:
        raise GlossError(f"All ratings are {rating[0]:g}: there is no relation to the axis to fit.")
    line = linregress(coordinate, rating)
    half = student_t.ppf(0.975, len(rating) - 2) * line.stderr
    polynomials = fit_polynomials(coordinate, rating)
    return AxisRegression(
        slope=float(line.slope),
        intercept=float(line.intercept),
        r_squared=float(line.rvalue**2),
        slope_ci95=(float(line.slope - half), float(line.slope + half)),
        polynomial_r_squared=tuple(fit.r_squared for fit in polynomials if fit.order > 1),
        n_stimuli=len(rating),
        polynomials=polynomials,
    )


def fit_polynomials(
    coordinate: ArrayLike, rating: ArrayLike, *, orders: Sequence[int] = (1, 2, 3)
) -> tuple[PolynomialFit, ...]:
    """Fit polynomials of several orders by least squares.

    Parameters
    ----------
    coordinate, rating : array_like, shape (n,)
        Position along the axis and mean rating of each stimulus.
    orders : sequence of int, each >= 1
        Orders without enough distinct positions (one more than the order) are left out.

    Returns
    -------
    tuple of PolynomialFit
        One for each order that can be fitted.

    Raises
    ------
    GlossError
        Values that are not finite, of different number, or all ratings the same; or an order below 1.

    Notes
    -----
    With leverages h_i, the diagonal of the hat matrix, the error of predicting stimulus i from the others is
    e_i / (1 - h_i), without fitting anew. AICc = n ln(RSS / n) + 2 k + 2 k (k + 1) / (n - k - 1), where k = order + 2
    counts the coefficients and the variance of the residuals.

    Examples
    --------
    >>> x = np.arange(6.0)
    >>> line, curve = fit_polynomials(x, x**2, orders=(1, 2))
    >>> round(line.r_squared, 3), round(curve.r_squared, 3)
    (0.921, 1.0)
    """
    x, y = np.asarray(coordinate, dtype=float), np.asarray(rating, dtype=float)
    if x.ndim != 1 or x.shape != y.shape:
        raise GlossError(f"A fit needs one coordinate for each rating, but got shapes {x.shape} and {y.shape}.")
    if not (np.all(np.isfinite(x)) and np.all(np.isfinite(y))):
        raise GlossError("A fit of ratings needs finite coordinates and ratings. Leave out stimuli that lack one.")
    if len(y) == 0 or np.ptp(y) == 0:
        raise GlossError("All ratings are the same: there is no relation to the axis to fit.")
    if min(orders, default=1) < 1:
        raise GlossError(f"A polynomial of order {min(orders)} is no relation to the axis; give orders of 1 or more.")
    positions = len(np.unique(x))
    return tuple(_fit(x, y, order) for order in orders if positions > order)


def polynomial_sentence(fits: Sequence[PolynomialFit]) -> str:
    """Say in words what polynomials gain over the line.

    Parameters
    ----------
    fits : sequence of PolynomialFit
        Of orders 1 and higher, to the same ratings.

    Returns
    -------
    str

    Raises
    ------
    GlossError
        No fit of order 1 to compare with.

    Examples
    --------
    >>> x = np.arange(8.0)
    >>> print(polynomial_sentence(fit_polynomials(x, x + [0.1, -0.2, 0.1, 0.2, -0.1, 0, 0.2, -0.3], orders=(1, 2))))
    The polynomial of order 2 gains .001 in r² over the line, less than the .01 that the gloss paper takes for linear. \
The line predicts left-out stimuli best (error 0.242).
    """
    line = next((fit for fit in fits if fit.order == 1), None)
    if line is None:
        raise GlossError("There is no line among the fits to compare polynomials with; include order 1.")
    curves = sorted((fit for fit in fits if fit.order > 1), key=lambda fit: fit.order)
    if not curves:
        return "There are too few positions along the axis for a polynomial."
    # Never below the line but for rounding, which must not print as -.000.
    gains = [max(fit.r_squared - line.r_squared, 0.0) for fit in curves]
    within = max(gains) < _LINEAR_GAIN
    verdict = "less than the .01 that the gloss paper takes for linear" if within else "not all less than .01"
    if not within and len(gains) == 1:
        verdict = "not less than .01"
    subject = "The polynomial of order" if len(curves) == 1 else "Polynomials of order"
    verb = "gains" if len(curves) == 1 else "gain"
    said = (
        f"{subject} {_and([str(fit.order) for fit in curves])} {verb} {_and([_fraction(gain) for gain in gains])} in "
        f"r² over the line, {verdict}."
    )
    return f"{said} {_predicted_best(line, curves)}"


def _predicted_best(line: PolynomialFit, curves: Sequence[PolynomialFit]) -> str:
    known = [fit for fit in (line, *curves) if not np.isnan(fit.leave_one_out_error)]
    if line not in known or len(known) == 1:
        return "There are too few stimuli to tell by leaving one out."
    best = min(known, key=lambda fit: fit.leave_one_out_error)
    error = f"{best.leave_one_out_error:.3g}"
    if best is line:
        return f"The line predicts left-out stimuli best (error {error})."
    return f"Order {best.order} predicts left-out stimuli best (error {error}; line {line.leave_one_out_error:.3g})."


def _and(words: Sequence[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


def _fraction(value: float) -> str:
    return f"{value:.3f}".removeprefix("0")


def _fit(x: np.ndarray, y: np.ndarray, order: int) -> PolynomialFit:
    n = len(y)
    # From -1 to 1 and by an orthogonal basis: the powers themselves are nearly collinear over a narrow range.
    unit = 2 * (x - x.min()) / np.ptp(x) - 1
    basis, _ = np.linalg.qr(np.polynomial.legendre.legvander(unit, order))
    residual = y - basis @ (basis.T @ y)
    leverage = np.sum(basis**2, axis=1)
    rest = float(residual @ residual)
    r_squared = 1 - rest / float(np.sum((y - y.mean()) ** 2))
    free = n - order - 1
    known = free > 0 and bool(np.all(leverage < _FULL_LEVERAGE))
    return PolynomialFit(
        order=order,
        r_squared=r_squared,
        adjusted_r_squared=1 - (1 - r_squared) * (n - 1) / free if free > 0 else np.nan,
        leave_one_out_error=float(np.sqrt(np.mean((residual / (1 - leverage)) ** 2))) if known else np.nan,
        aicc=aicc(rest, n, order + 2),
    )


def aicc(rest: float, n: int, k: int) -> float:
    """Akaike's criterion for small samples of a least-squares fit, up to a constant.

    Parameters
    ----------
    rest : float
        Sum of squared residuals, >= 0.
    n, k : int
        Ratings, and estimated numbers with the variance of the residuals among them.

    Returns
    -------
    float
        n ln(rest / n) + 2 k + 2 k (k + 1) / (n - k - 1) (Hurvich and Tsai 1989); NaN with too few ratings, -inf for a
        perfect fit.

    Examples
    --------
    >>> aicc(8.0, 8, 2)
    6.4
    """
    if n - k - 1 <= 0:
        return np.nan
    return float((n * np.log(rest / n) if rest > 0 else -np.inf) + 2 * k + 2 * k * (k + 1) / (n - k - 1))
