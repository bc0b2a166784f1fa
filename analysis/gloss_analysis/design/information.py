"""What judged pairs tell about the weight of the second axis: the local information of the metric model.

**Derivation.** An observer answers y = g(D) + e for a pair at the distance D = sqrt(u² + (w v)²), where u and v are its
differences on the two axes, w is the weight, g an unknown rising response and e noise of standard deviation s. In
t = log w,

    dD / dt = w² v² / D = D f,   f = (w v / D)², the second axis's share of the squared distance,

so that a small change of t moves the answer by x = g'(D) D f; for the response g = 100 (D / L)**p by x = p g f. An
ordinal analysis knows nothing of g: whatever change of the answers is a function of D alone could be a change of g, and
tells nothing about w. What tells is that pairs at one distance differ in f. To first order in the noise therefore

    var(t) = s² / S,   S = min over h of sum over pairs (x - h(D))²,

the partial information (c-optimality and D_s-optimality are the same for one parameter: Atkinson, Donev and Tobias
2007, chapter 10). Here h is a polynomial in D, as many columns N; S is the squared length of x that N leaves over, or

    S = det([x N]'[x N]) / det(N'N).

The degree, 10, is as high as 351 pairs bear without loss. A lower one trusts that the response is smooth, which an
ordinal analysis does not: designs made with degree 4 held so few distances that the order of their pairs was the same
over a range of weights. Observers differ, and their weight is not known before the study: what is made small is the
mean of s² / S over observers spread twice as widely as the population.
"""

import numpy as np

from glossspace.errors import GlossError

__all__ = ["NUISANCE_COLUMNS", "check_axes", "log_ratio_variance", "observers_at", "sensitivities"]

_DEGREE = 10
# Observers who stand for a population.
_NODES = 7
# Axes whose spread across each other is less than this part of that along them are one axis.
_SAME_DIRECTION = 1e-9
NUISANCE_COLUMNS = _DEGREE + 1
"""Columns that stand for an unknown response curve."""


def check_axes(coordinates: np.ndarray) -> None:
    """Refuse stimuli whose pairs cannot tell the weight of the second axis.

    Raises
    ------
    GlossError
        Not three stimuli or more on two axes; coordinates that are not finite, or do not tell two axes apart.
    """
    if coordinates.ndim != 2 or coordinates.shape[1] != 2 or len(coordinates) < 3:
        raise GlossError(
            f"Coordinates of shape {coordinates.shape} are none of three stimuli or more on two axes. Allowed: (n, 2)."
        )
    if not np.all(np.isfinite(coordinates)):
        raise GlossError("Coordinates must be finite numbers.")
    extent = np.ptp(coordinates, axis=0)
    if np.any(extent == 0):
        raise GlossError("All stimuli are at one place on an axis: no pairs can tell its weight. Vary it.")
    unit = (coordinates - coordinates.mean(axis=0)) / extent
    along, across = np.linalg.svd(unit, compute_uv=False)
    if across < _SAME_DIRECTION * along:
        raise GlossError("The two axes are multiples of each other on these stimuli: no pairs can tell their weights.")


def sensitivities(delta: np.ndarray, ratios: np.ndarray, *, exponent: float) -> np.ndarray:
    """How answers move with the logarithm of the weight, beside what an unknown response may do.

    Parameters
    ----------
    delta : ndarray, shape (q, 2)
        Differences of q pairs on the two axes.
    ratios : ndarray, shape (k,)
        Weights of k observers, > 0.
    exponent : float
        Of the response.

    Returns
    -------
    ndarray, shape (k, q, 1 + NUISANCE_COLUMNS)
        First column x, in hundredths of the slider for a unit of log w; then Chebyshev polynomials of the distance.

    Examples
    --------
    >>> sensitivities(np.array([[0.0, 1.0], [1.0, 0.0]]), np.array([1.0]), exponent=0.5)[0, :, 0].tolist()
    [50.0, 0.0]
    """
    along = np.asarray(ratios, dtype=float)[:, np.newaxis] * delta[:, 1]
    distance = np.hypot(delta[:, 0], along)
    largest = distance.max(axis=1, keepdims=True)
    if not np.all(largest > 0):
        raise GlossError("All stimuli are at one place on both axes: their pairs tell nothing about the weight.")
    share = np.divide(along, distance, out=np.zeros_like(along), where=distance > 0) ** 2
    relative = distance / largest
    x = 100 * exponent * relative**exponent * share
    return np.concatenate([x[..., np.newaxis], np.polynomial.chebyshev.chebvander(2 * relative - 1, _DEGREE)], axis=2)


def log_ratio_variance(delta: np.ndarray, kept: np.ndarray, ratio: float, *, exponent: float) -> float:
    """Variance of one observer's log ratio for noise of one hundredth of the slider: 1 / S.

    Parameters
    ----------
    delta : ndarray, shape (q, 2)
        Differences of all pairs of the stimuli: the largest distance is the top of the slider.
    kept : ndarray of bool, shape (q,)
        The pairs that are judged, once each.
    ratio, exponent : float
        Of the observer.

    Returns
    -------
    float
        Infinite where the pairs kept tell nothing.

    Examples
    --------
    >>> delta = np.random.default_rng(0).uniform(-1, 1, (200, 2))
    >>> half = np.arange(200) < 100
    >>> log_ratio_variance(delta, half, 1.0, exponent=1.0) > log_ratio_variance(delta, half | True, 1.0, exponent=1.0)
    True
    """
    columns = sensitivities(delta, np.array([ratio]), exponent=exponent)[0][kept]
    x, nuisance = columns[:, 0], columns[:, 1:]
    if len(x) == 0:
        return np.inf
    left = x - nuisance @ np.linalg.lstsq(nuisance, x)[0]
    information = float(left @ left)
    # Of pairs no more than columns only rounding is left.
    return 1 / information if information > 1e-12 * float(x @ x) else np.inf


def observers_at(ratio: float, sd_log_ratio: float) -> tuple[np.ndarray, np.ndarray]:
    """Ratios and shares of seven observers who stand for a log-normal population (Gauss-Hermite quadrature).

    Returns
    -------
    ratios, shares : ndarray, shape (7,)
        Shares add up to 1.

    Examples
    --------
    >>> ratios, shares = observers_at(2.0, 0.1)
    >>> round(float(shares @ np.log(ratios / 2) ** 2), 12), ratios.shape
    (0.01, (7,))
    """
    nodes, weights = np.polynomial.hermite_e.hermegauss(_NODES)
    return ratio * np.exp(sd_log_ratio * nodes), weights / weights.sum()
