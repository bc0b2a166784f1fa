"""The image of every (ρd, ρs) at once: polynomial coefficients a pixel, with the covariance of their errors."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Coefficients", "average"]

# Errors of terms beyond the first four are a thousandth of a code value or less: their monomials are small.
COVARIANCE_TERMS = 4

Exponents = tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class Coefficients:
    """Luminance of each pixel as ``Σ mean[m] ρd^i ρs^j`` with (i, j) = exponents[m].

    This is where a renderer ends and a picture begins: any renderer that makes coefficients makes stimulus sets.

    Attributes
    ----------
    exponents : tuple of (int, int)
        Powers of (ρd, ρs), one pair a row of `mean`.
    mean : array of float32, shape (M, P)
        Coefficients of P pixels in cd/m².
    covariance : array of float32, shape (K (K + 1) / 2, P)
        Upper triangle, row by row, of the covariance of the errors of the first K = min(M, 4) coefficients.
    """

    exponents: Exponents
    mean: NDArray[np.float32]
    covariance: NDArray[np.float32]

    def luminance(self, rho_d: float, rho_s: float) -> NDArray[np.float64]:
        """Luminance (cd/m²) of each pixel, shape (P,)."""
        return _weighted_sum(_monomials(self.exponents, rho_d, rho_s), self.mean)

    def variance(self, rho_d: float, rho_s: float) -> NDArray[np.float64]:
        """Variance of the error of `luminance`, shape (P,)."""
        terms = _monomials(self.exponents, rho_d, rho_s)[:COVARIANCE_TERMS]
        first, second = np.triu_indices(len(terms))
        weights = np.where(first == second, 1.0, 2.0) * terms[first] * terms[second]
        # Rounding of float32 may leave a hair below zero where the terms cancel.
        return np.maximum(_weighted_sum(weights, self.covariance), 0.0)


def average(exponents: Exponents, estimates: Iterable[NDArray[np.float32]]) -> Coefficients:
    """Mean of independent estimates, and the covariance of that mean from their scatter.

    Parameters
    ----------
    exponents : tuple of (int, int)
        Powers of (ρd, ρs), one pair a row of each estimate.
    estimates : iterable of array, shape (M, P)
        At least two; each is used and dropped, so that memory holds one at a time.
    """
    terms = min(len(exponents), COVARIANCE_TERMS)
    first, second = np.triu_indices(terms)
    count = 0
    mean: NDArray[np.float64] = np.zeros(0)
    moments: NDArray[np.float64] = np.zeros(0)
    for estimate in estimates:
        values = estimate.astype(np.float64)
        count += 1
        if count == 1:
            mean, moments = np.zeros_like(values), np.zeros((len(first), values.shape[1]))
        # Welford's update: no cancellation between large sums.
        change = values - mean
        mean += change / count
        rest = values - mean
        moments += change[first] * rest[second]
    if count < 2:
        raise ValueError(f"An error estimate needs at least two independent estimates, but got {count}.")
    covariance = moments / ((count - 1) * count)
    return Coefficients(exponents, mean.astype(np.float32), covariance.astype(np.float32))


def _weighted_sum(weights: NDArray[np.float64], rows: NDArray[np.float32]) -> NDArray[np.float64]:
    # Row by row: a product of matrices would round differently for each number of its threads.
    total = np.zeros(rows.shape[1])
    for weight, row in zip(weights, rows, strict=True):
        total += weight * row
    return total


def _monomials(exponents: Exponents, rho_d: float, rho_s: float) -> NDArray[np.float64]:
    return np.array([rho_d**i * rho_s**j for i, j in exponents])
