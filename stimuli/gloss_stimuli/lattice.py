"""Rank-1 lattice points: evenly spread numbers that make a path tracer's noise fall faster than chance would."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

__all__ = ["lattice_generator"]


@lru_cache
def lattice_generator(count: int, dimensions: int, decay: float = 0.8) -> tuple[int, ...]:
    """Generating vector z of a lattice: point n is the fractional part of n z / count.

    Components are odd, so that no coordinate repeats a value. Each minimises the worst-case error of Korobov's space of
    smoothness 2 given those before it (component by component: Sloan & Reztsov 2002), with product weights ``decay**k``
    since a path's first decisions matter most.

    Parameters
    ----------
    count : int
        Number of points, a power of two.
    dimensions : int
        Number of components.
    decay : float, optional
        Weight of each dimension relative to the one before.

    Examples
    --------
    >>> lattice_generator(8, 2)
    (1, 3)
    """
    if count < 1 or count & (count - 1):
        raise ValueError(f"count must be a power of two, but is {count}.")
    if count <= 2:
        return (1,) * dimensions
    n = np.arange(count)
    candidates = np.arange(1, count, 2)
    x = np.outer(candidates, n) % count / count
    kernel: NDArray[np.float64] = 2 * np.pi**2 * (x * x - x + 1 / 6)
    product = np.ones(count)
    generator = []
    for dimension in range(dimensions):
        weighted = 1 + decay**dimension * kernel
        errors = weighted @ product
        # Mirrored generators tie but for rounding; the first within rounding is taken on every machine.
        best = int(np.flatnonzero(errors <= errors.min() * (1 + 1e-9))[0])
        generator.append(int(candidates[best]))
        product = product * weighted[best]
    return tuple(generator)
