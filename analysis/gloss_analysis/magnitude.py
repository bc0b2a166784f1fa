"""Magnitude estimates: ratings of single images, averaged over observers, against a gloss axis.

Figures 7 and 8 of the gloss paper.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.stats import linregress
from scipy.stats import t as student_t

from glossspace.errors import GlossError

__all__ = ["AxisRegression", "mean_ratings", "regress_ratings"]


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
    """

    slope: float
    intercept: float
    r_squared: float
    slope_ci95: tuple[float, float]
    polynomial_r_squared: tuple[float, ...]
    n_stimuli: int


def mean_ratings(table: pd.DataFrame) -> pd.DataFrame:
    """Average ratings over repeats, then over participants with their slider ranges equalised.

    Each participant's mean over repeats is moved and stretched so that all participants have the same mean and standard
    deviation, the averages of the group's: the linear equalisation, which suits a bounded slider with zeros. A
    participant with one rating for everything has no range to stretch or to average, and is only moved.

    Parameters
    ----------
    table : DataFrame
        Columns `participant_id`, `stimulus`, `rating`. Every participant rated every stimulus.

    Returns
    -------
    DataFrame
        `stimulus`, `rating`, `standard_error` over participants (NaN with one participant), in order of appearance.

    Raises
    ------
    GlossError
        A participant did not rate some stimulus.
    """
    means = table.pivot_table(index="participant_id", columns="stimulus", values="rating", aggfunc="mean", sort=False)
    if means.isna().to_numpy().any():
        participant = means.index[means.isna().any(axis=1)][0]
        stimulus = means.columns[means.loc[participant].isna()][0]
        raise GlossError(
            f"Participant {participant} has no rating of the stimulus {stimulus}. Finish the session first."
        )
    values = means.to_numpy()
    level, spread = values.mean(axis=1, keepdims=True), values.std(axis=1, keepdims=True)
    # Rounding makes the spread of equal ratings a little more than 0, and stretching would blow that up.
    varied = np.ptp(values, axis=1, keepdims=True) > 1e-9 * np.abs(values).max()
    stretch = np.divide(
        spread.mean(where=varied) if varied.any() else 1.0, spread, out=np.ones_like(spread), where=varied
    )
    equalised = (values - level) * stretch + level.mean()
    m = len(values)
    error = equalised.std(axis=0, ddof=1) / np.sqrt(m) if m > 1 else np.full(values.shape[1], np.nan)
    return pd.DataFrame({"stimulus": means.columns, "rating": equalised.mean(axis=0), "standard_error": error})


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
        Too few positions, values that are not finite, or all ratings the same.
    """
    coordinate, rating = np.asarray(coordinate, dtype=float), np.asarray(rating, dtype=float)
    positions = len(np.unique(coordinate))
    if not (np.all(np.isfinite(coordinate)) and np.all(np.isfinite(rating))):
        raise GlossError("A regression of ratings needs finite coordinates and ratings.")
    if positions < 3:
        raise GlossError(f"A regression of ratings needs 3 different positions along the axis, but got {positions}.")
    if np.ptp(rating) == 0:
        raise GlossError(f"All ratings are {rating[0]:g}: there is no relation to the axis to fit.")
    line = linregress(coordinate, rating)
    half = student_t.ppf(0.975, len(rating) - 2) * line.stderr
    orders = [order for order in (2, 3) if positions > order]
    return AxisRegression(
        slope=float(line.slope),
        intercept=float(line.intercept),
        r_squared=float(line.rvalue**2),
        slope_ci95=(float(line.slope - half), float(line.slope + half)),
        polynomial_r_squared=tuple(_polynomial_r_squared(coordinate, rating, order) for order in orders),
        n_stimuli=len(rating),
    )


def _polynomial_r_squared(coordinate: np.ndarray, rating: np.ndarray, order: int) -> float:
    curve = np.polynomial.Polynomial.fit(coordinate, rating, order)  # fits on a scaled domain, hence well conditioned
    total = np.sum((rating - rating.mean()) ** 2)
    return float(1 - np.sum((rating - curve(coordinate)) ** 2) / total)
