"""Permutation tests on ranks: all orders of few stimuli, random ones of many."""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.stats import friedmanchisquare, rankdata

__all__ = ["Orders", "concordance", "orders_of", "products_under", "sums_under"]

# Numbers at a time: a few tens of megabytes.
_CHUNK = 4_000_000

# Statistics that differ by less than this part of the largest are equal but for the order of their sums.
_ROUNDING = 1e-9


@dataclass(frozen=True)
class Orders:
    """Orders of n things, for a permutation test.

    Attributes
    ----------
    places : ndarray of int, shape (n_orders, n)
    exhaustive : bool
        Whether these are all n! of them, the observed one among them.
    """

    places: np.ndarray
    exhaustive: bool

    def p_value(self, null: np.ndarray, observed: float) -> float:
        """Share of orders whose statistic reaches the observed one; the observed counts as one of random orders.

        Parameters
        ----------
        null : ndarray, shape (n_orders,)
            The larger, the more against the null hypothesis; absolute values for a two-sided test.
        observed : float
        """
        slack = _ROUNDING * max(np.abs(null).max(), abs(observed))
        reached = int(np.count_nonzero(null >= observed - slack))
        return reached / len(null) if self.exhaustive else (reached + 1) / (len(null) + 1)


def orders_of(n: int, n_permutations: int, seed: np.random.SeedSequence) -> Orders:
    """All n! orders if there are at most `n_permutations` of them, else so many random ones.

    Examples
    --------
    >>> orders_of(3, 100, np.random.SeedSequence(1)).places.shape
    (6, 3)
    """
    # By comparison of logarithms, since the factorial of a large n has thousands of digits.
    if math.lgamma(n + 1) <= math.log(n_permutations) + _ROUNDING:
        return Orders(np.array(list(itertools.permutations(range(n)))), exhaustive=True)
    rng = np.random.default_rng(seed)
    return Orders(rng.permuted(np.tile(np.arange(n), (n_permutations, 1)), axis=1), exhaustive=False)


def products_under(orders: Orders, matrix: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Sum over i, j of matrix[p(i), p(j)] * others[k, i, j], for each order p (Mantel's statistic).

    Parameters
    ----------
    orders : Orders
    matrix : ndarray, shape (n, n)
    others : ndarray, shape (m, n, n)

    Returns
    -------
    ndarray, shape (n_orders, m)
    """
    flat = others.reshape(len(others), -1).astype(float).T
    found = [
        matrix[places[:, :, None], places[:, None, :]].reshape(len(places), -1).astype(float) @ flat
        for places in _chunks(orders.places, matrix.size)
    ]
    return np.concatenate(found)


def sums_under(orders: Orders, values: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Sum over i of values[p(i)] * others[k, i], for each order p: what rank correlation changes by.

    Parameters
    ----------
    orders : Orders
    values : ndarray, shape (n,)
    others : ndarray, shape (m, n)

    Returns
    -------
    ndarray, shape (n_orders, m)
    """
    return np.concatenate([values[places] @ others.T for places in _chunks(orders.places, values.size)])


def concordance(ranks: np.ndarray, n_permutations: int, seed: np.random.SeedSequence) -> tuple[float, float]:
    """Kendall's coefficient of concordance W, corrected for ties, and its p against ranks given at random.

    Parameters
    ----------
    ranks : ndarray, shape (m, n)
        Complete rankings of 3 or more things by 2 or more participants, none of them constant.
    n_permutations : int
    seed : SeedSequence

    Returns
    -------
    w, p : float
        W = chi² / (m (n - 1)) with Friedman's chi², from 0 (no agreement) to 1. p permutes each participant's ranks
        by itself, since chi² is not yet distributed as its name says where participants are few.

    Examples
    --------
    Three executives rank six applicants (Siegel 1956, *Nonparametric statistics*, table 9.6: W = .16).

    >>> ranks = np.array([[1, 6, 3, 2, 5, 4], [1, 5, 6, 4, 2, 3], [6, 3, 2, 5, 4, 1]])
    >>> round(concordance(ranks, 999, np.random.SeedSequence(1))[0], 2)
    0.16
    """
    m, n = ranks.shape
    own = rankdata(ranks, axis=1)
    w = float(friedmanchisquare(*own.T).statistic) / (m * (n - 1))
    observed = float(np.square(own.sum(axis=0) - m * (n + 1) / 2).sum())
    rng = np.random.default_rng(seed)
    reached, size = 0, max(1, _CHUNK // own.size)
    for start in range(0, n_permutations, size):
        drawn = np.broadcast_to(own, (min(size, n_permutations - start), m, n))
        sums = rng.permuted(drawn, axis=2).sum(axis=1)
        null = np.square(sums - m * (n + 1) / 2).sum(axis=1)
        reached += int(np.count_nonzero(null >= observed * (1 - _ROUNDING)))
    return w, (reached + 1) / (n_permutations + 1)


def _chunks(places: np.ndarray, size: int) -> Iterator[np.ndarray]:
    step = max(1, _CHUNK // size)
    for start in range(0, len(places), step):
        yield places[start : start + step]
