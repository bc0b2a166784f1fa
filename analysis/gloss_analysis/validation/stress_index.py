"""STRESS of García et al. (2007), and the judgement that participants have in common.

STRESS here is the index by which colour-difference formulas are compared (CIE 217:2016): per cent, at the level of
ratios, with one scale factor and no other freedom. With phi the angle between the vectors of predicted and judged
differences it is 100 sin(phi): 0 where they are proportional. It is not Kruskal's Stress-1 of a scaling, which frees
the judgements' transformation and fits the distances to them; the two numbers cannot be compared.
"""

import numpy as np

from glossspace.errors import GlossError

__all__ = ["as_differences", "common_judgement", "stress_index"]

_ROUNDS = 500
_SETTLED = 1e-12


def stress_index(predicted: np.ndarray, judged: np.ndarray) -> float:
    """STRESS of García et al. (2007) in per cent; symmetric in its arguments and free of their units.

    Parameters
    ----------
    predicted, judged : ndarray, shape (n,)
        Differences >= 0. A pair with NaN in either does not enter.

    Returns
    -------
    float
        0 (proportional) to 100 (where one is above 0, the other is 0).

    Raises
    ------
    GlossError
        The shapes differ, a difference is negative or infinite, or all of one kind are 0 or NaN.

    Examples
    --------
    >>> round(stress_index(np.array([1.0, 2.0]), np.array([2.0, 1.0])), 6)  # cos = 4/5, sin = 3/5
    60.0
    """
    from colour.difference import index_stress_Garcia2007  # slow to import

    both = [as_differences(predicted, "predicted"), as_differences(judged, "judged")]
    if both[0].shape != both[1].shape:
        raise GlossError(
            f"Predicted differences have the shape {both[0].shape}, judged ones {both[1].shape}. Allowed: one of each "
            "for every pair."
        )
    known = ~np.isnan(both[0]) & ~np.isnan(both[1])
    units = []
    for name, values in zip(("predicted", "judged"), both, strict=True):
        largest = np.max(values[known], initial=0.0)
        if largest == 0:
            raise GlossError(
                f"No {name} difference of {int(known.sum())} pairs is above 0. Allowed: at least one, or there is no "
                "scale to compare on; check these stimuli and judgements."
            )
        units.append(values[known] / largest)  # so that no square is lost or overflows
    if not np.any(units[0] * units[1]):
        return 100.0  # orthogonal: the formula divides by 0 here
    return 100 * float(index_stress_Garcia2007(*units))


def common_judgement(values: np.ndarray) -> np.ndarray:
    """Mean judgement of participants who each used a scale of their own.

    Each is multiplied so that the root mean square of what they judged equals that of the mean judgement of the same
    pairs. Where all judged all pairs that is a unit root mean square for everyone; where not, nobody's scale depends on
    which pairs they were shown. Proportional judgements come out proportional in either case.

    Parameters
    ----------
    values : ndarray, shape (m, n_pairs)
        Judgements >= 0, NaN where there is none. Each participant has one above 0.

    Returns
    -------
    ndarray, shape (n_pairs,)
        With a root mean square of 1 over the pairs that somebody judged; NaN for those that nobody did.

    Examples
    --------
    >>> mean = common_judgement(np.array([[1.0, 2.0, np.nan], [np.nan, 20.0, 30.0]]))
    >>> (mean / mean[0]).round(6).tolist()
    [1.0, 2.0, 3.0]
    """
    known = ~np.isnan(values)
    count = known.sum(axis=0)
    own = np.where(known, values, 0.0) / np.nanmax(values, axis=1)[:, np.newaxis]
    own /= _rms(own, known)[:, np.newaxis]
    factor, judged = np.ones(len(own)), count > 0
    mean = np.zeros(own.shape[1])
    for _ in range(_ROUNDS):
        np.divide((factor[:, np.newaxis] * own).sum(axis=0), count, out=mean, where=judged)
        wanted = _rms(np.where(known, mean, 0.0), known)
        wanted /= np.sqrt(np.mean(wanted**2))  # their common size is free
        settled = np.max(np.abs(wanted / factor - 1)) < _SETTLED
        factor = wanted
        if settled:
            break
    return np.where(judged, mean / np.sqrt(np.mean(mean[judged] ** 2)), np.nan)


def as_differences(values: np.ndarray, name: str) -> np.ndarray:
    """Give `values` as floats, or refuse those that are negative or infinite; `name` is "predicted" or "judged"."""
    array = np.asarray(values, dtype=float)
    wrong = array[(array < 0) | np.isinf(array)]
    if len(wrong):
        raise GlossError(
            f"Invalid {name} difference {wrong[0]:g} ({len(wrong)} such). Allowed: a finite number >= 0, or NaN where "
            "it is not known."
        )
    return array


def _rms(values: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Root mean square of each row over what is known; the rest must be 0."""
    return np.sqrt((values**2).sum(axis=1) / known.sum(axis=1))
