"""How sure the regression of ratings is: a band about its line over stimuli, and r² over participants."""

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from scipy.stats import linregress
from scipy.stats import t as student_t

from gloss_analysis.ratings.magnitude import mean_ratings
from glossspace.errors import GlossError

__all__ = ["line_band", "r_squared_interval"]

# A correlation of 1 has no finite Fisher's z.
_NEARLY_ONE = 1 - 1e-12


def line_band(coordinate: ArrayLike, rating: ArrayLike, at: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """95 % confidence band of a least-squares line: where the mean rating lies, position by position.

    Parameters
    ----------
    coordinate, rating : array_like, shape (n,)
        Three or more, not all at one position.
    at : array_like, shape (k,)
        Positions at which the band is wanted.

    Returns
    -------
    low, high : ndarray, shape (k,)

    Notes
    -----
    Line -+ t s sqrt(1/n + (x - mean)^2 / sum of squares), with n - 2 degrees of freedom; of one position at a time.

    Examples
    --------
    >>> low, high = line_band([0, 1, 2], [0, 1.5, 2], [1.0])  # s^2 = 1/6, t = 12.706
    >>> round(float((high - low)[0] / 2), 3)
    2.995
    """
    x, y, position = (np.asarray(values, dtype=float) for values in (coordinate, rating, at))
    if len(x) < 3 or np.ptp(x) == 0:
        raise GlossError(f"A band needs three stimuli at different positions, but got {len(x)}.")
    line = linregress(x, y)
    free = len(x) - 2
    residual = y - line.intercept - line.slope * x
    spread = np.sum((x - x.mean()) ** 2)
    error = np.sqrt(residual @ residual / free * (1 / len(x) + (position - x.mean()) ** 2 / spread))
    middle = line.intercept + line.slope * position
    half = student_t.ppf(0.975, free) * error
    return middle - half, middle + half


def r_squared_interval(table: pd.DataFrame, coordinate: pd.Series) -> tuple[float, float] | None:
    """95 % interval of r² between mean ratings and an axis, over participants.

    Parameters
    ----------
    table : DataFrame
        Columns `participant_id`, `stimulus`, `rating`. Every participant rated every stimulus.
    coordinate : Series
        Position of each stimulus, by its name.

    Returns
    -------
    tuple of float, or None
        None with fewer than three participants, or where the ratings of all but one do not vary.

    Notes
    -----
    A jackknife: each participant is left out in turn, and the spread of Fisher's z of the correlation gives its
    standard error, with which Student's interval is made. It speaks of other participants with the same stimuli.

    Examples
    --------
    >>> rows = [(who, stimulus, rating) for who, given in
    ...         (("1", [1, 2, 4]), ("2", [1, 3, 4]), ("3", [2, 2, 4])) for stimulus, rating in zip("abc", given)]
    >>> table = pd.DataFrame(rows, columns=["participant_id", "stimulus", "rating"])
    >>> low, high = r_squared_interval(table, pd.Series([0.0, 1.0, 2.0], index=list("abc")))
    >>> bool(low < 0.9 < high)
    True
    """
    names = list(dict.fromkeys(table["participant_id"]))
    if len(names) < 3:
        return None
    # Of the correlation's size: r² does not tell its sign.
    whole = _fisher_z(table, coordinate)
    without = np.array([_fisher_z(table[table["participant_id"] != name], coordinate) for name in names])
    if not np.all(np.isfinite([whole, *without])):
        return None
    m = len(names)
    error = np.sqrt((m - 1) / m * np.sum((without - without.mean()) ** 2))
    half = student_t.ppf(0.975, m - 1) * error
    return float(np.tanh(max(whole - half, 0.0)) ** 2), float(np.tanh(whole + half) ** 2)


def _fisher_z(table: pd.DataFrame, coordinate: pd.Series) -> float:
    means = mean_ratings(table)
    rating, position = means["rating"].to_numpy(), coordinate.loc[means["stimulus"]].to_numpy()
    if len(rating) < 3 or np.ptp(rating) == 0 or np.ptp(position) == 0:
        return float("nan")
    return float(np.arctanh(min(abs(np.corrcoef(position, rating)[0, 1]), _NEARLY_ONE)))
