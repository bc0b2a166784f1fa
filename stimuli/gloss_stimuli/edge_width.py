"""How wide a blurred edge is: its steepest slope, fitted so that neither noise nor quantisation can steepen it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

__all__ = ["EdgeProfile", "steepest_slope"]

Array = NDArray[np.float64]

# A profile from one check's center to the next one's, in about as many steps as such a check has pixels at 512.
BINS = 32
FEWEST_BINS = 8

WIDEST = 4.0
LARGEST_SHIFT = 0.25

# Nested grids over width and location: 9 x 9 points, the next one half as wide, so that it can follow a ridge between
# the two; the last one's steps are 0.1 % of the width.
GRID = 9
REFINEMENTS = 11


@dataclass(frozen=True, eq=False)
class EdgeProfile:
    """Samples of an edge gathered by their signed distance from it, which lies between -1/2 and 1/2.

    Attributes
    ----------
    positions : array, shape (P,)
        Distance of each sample.
    """

    positions: Array

    @cached_property
    def _bins(self) -> tuple[NDArray[np.intp], Array]:
        index = np.clip(np.floor((self.positions + 0.5) * BINS), 0, BINS - 1).astype(np.intp)
        return index, np.bincount(index, minlength=BINS).astype(float)

    def is_resolved(self) -> bool:
        """Whether there are samples at enough distances to tell a slope."""
        return bool(np.count_nonzero(self._bins[1]) >= FEWEST_BINS)

    def means(self, values: NDArray[np.float64]) -> tuple[Array, Array, Array]:
        """Mean position, mean value and number of the samples in each interval that has some."""
        index, counts = self._bins
        filled = counts > 0
        sums = (np.bincount(index, weights, minlength=BINS)[filled] for weights in (self.positions, values))
        position, value = (total / counts[filled] for total in sums)
        return position, value, counts[filled]


def steepest_slope(positions: Array, values: Array, weights: Array) -> float:
    """Steepest slope of an edge: that of the error function that fits it best.

    Parameters
    ----------
    positions : array, shape (P,)
        Distances from the nominal edge, ascending, between -1/2 and 1/2.
    values, weights : array, shape (P,)
        The profile, and how much each value counts.

    Returns
    -------
    float
        Change of value per unit of distance, positive where the profile rises.

    Notes
    -----
    The fit is ``m + (A/2) erf(√π (s - s₀) / w)`` by least squares: m and A in closed form, w from the spacing of the
    positions to 4 and s₀ within ± 1/4 on nested grids. Its slope at s₀ is A / w. An edge blurred by a Gaussian of
    standard deviation σ has ``w = √(2π) σ``; a straight ramp is fitted by the widest w, to 1 % of its slope.

    Examples
    --------
    >>> s = np.linspace(-0.5, 0.5, 33)
    >>> round(steepest_slope(s, 3 * s, np.ones(33)), 1)
    3.0
    """
    from scipy.special import erf

    narrowest = (positions[-1] - positions[0]) / (len(positions) - 1)
    low, high = np.array([np.log(narrowest), -LARGEST_SHIFT]), np.array([np.log(WIDEST), LARGEST_SHIFT])
    center, reach = (low + high) / 2, (high - low) / 2
    total = weights.sum()
    values = values - weights @ values / total
    slope = 0.0
    for _ in range(REFINEMENTS):
        # Clipped, so that the grid ends where the parameters do.
        widths, shifts = np.clip(center + reach * np.linspace(-1, 1, GRID)[:, None], low, high).T
        width, shift = (axis.ravel() for axis in np.meshgrid(np.exp(widths), shifts, indexing="ij"))
        shape = erf(np.sqrt(np.pi) * (positions - shift[:, None]) / width[:, None]) / 2
        shape -= (shape @ weights / total)[:, None]
        product, energy = shape @ (weights * values), (shape**2) @ weights
        # What the best amplitude explains of the sum of squares; nothing where all positions lie on one side.
        best = int(np.argmax(product**2 / np.maximum(energy, np.finfo(float).tiny)))
        slope = float(product[best] / max(energy[best], np.finfo(float).tiny) / width[best])
        center, reach = np.array([np.log(width[best]), shift[best]]), reach / 2
    return slope
