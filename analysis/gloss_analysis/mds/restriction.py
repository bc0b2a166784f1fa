"""What may be laid down about the coordinates: some stimuli fixed, or coordinates made of external variables.

Both are linear: Z = base + design B, of which only B is free.
"""

from dataclasses import dataclass

import numpy as np

from glossspace.errors import GlossError

__all__ = ["FREE", "Restriction", "external_variables", "fixed_stimuli"]

# Squares of larger coordinates come near what a number can hold.
_LARGEST = 1e100


@dataclass(frozen=True)
class Restriction:
    """Coordinates of the form base + design B.

    Attributes
    ----------
    base : ndarray, shape (n, p), or None
        None is zero.
    design : ndarray, shape (n, q), or None
        None leaves all coordinates free.
    """

    base: np.ndarray | None = None
    design: np.ndarray | None = None

    @property
    def is_free(self) -> bool:
        """Whether nothing is laid down."""
        return self.design is None

    @property
    def has_scale(self) -> bool:
        """Whether positions and scale are laid down, so that a solution must not be moved or rescaled."""
        return self.base is not None

    @property
    def fixed(self) -> np.ndarray:
        """Which stimuli are fixed, shape (n,): those that no free number moves."""
        if self.base is None or self.design is None:
            return np.zeros(0 if self.base is None else len(self.base), dtype=bool)
        return ~np.asarray(self.design.any(axis=1))

    def standardised(self) -> "tuple[Restriction, np.ndarray | float, float]":
        """Bring fixed stimuli to the origin and to unit size; coordinates are centre + size * those found then.

        Only where every other stimulus is free by itself; else nothing is changed.

        Returns
        -------
        restriction : Restriction
        centre : ndarray, shape (p,), or 0
        size : float
        """
        fixed = self.fixed
        if self.base is None or self.design is None or not fixed.any():
            return self, 0.0, 1.0
        if not np.array_equal(self.design[~fixed], np.eye(int(np.count_nonzero(~fixed)))):
            return self, 0.0, 1.0
        centre = self.base[fixed].mean(axis=0)
        size = float(np.sqrt(np.mean((self.base[fixed] - centre) ** 2))) or 1.0
        placed = np.where(fixed[:, np.newaxis], (self.base - centre) / size, 0.0)
        return Restriction(placed, self.design), centre, size

    def kept(self, coordinates: np.ndarray) -> np.ndarray:
        """Put fixed stimuli exactly where they are fixed: rounding has moved them."""
        if self.base is None or not self.fixed.any():
            return coordinates
        return np.where(self.fixed[:, np.newaxis], self.base, coordinates)


FREE = Restriction()
"""No restriction."""


def fixed_stimuli(coordinates: np.ndarray) -> Restriction:
    """Fix the stimuli whose coordinates are given; the others are free.

    Parameters
    ----------
    coordinates : ndarray, shape (n, p)
        A row of NaN where a stimulus is free.

    Returns
    -------
    Restriction

    Raises
    ------
    GlossError
        A row is given in part, or a coordinate is infinite.

    Examples
    --------
    >>> fixed_stimuli(np.array([[0.0, 0.0], [1.0, 0.0], [np.nan, np.nan]])).design
    array([[0.],
           [0.],
           [1.]])
    """
    coordinates = np.ma.filled(np.ma.asarray(coordinates, dtype=float), np.nan)
    if coordinates.ndim != 2 or coordinates.shape[1] == 0:
        raise GlossError(f"Fixed coordinates must be of shape (n, p), not {coordinates.shape}.")
    missing = np.isnan(coordinates)
    partly = missing.any(axis=1) & ~missing.all(axis=1)
    too_large = (np.abs(coordinates) > _LARGEST).any(axis=1)
    if partly.any() or too_large.any():
        row = int(np.argmax(partly | too_large))
        raise GlossError(
            f"Fixed coordinates of stimulus {row + 1} are {coordinates[row].tolist()}. Give finite numbers for all "
            f"dimensions, up to {_LARGEST:g} in size, or NaN for all of a stimulus that is free."
        )
    free = missing[:, 0]
    return Restriction(np.where(missing, 0.0, coordinates), np.eye(len(coordinates))[:, free])


def external_variables(variables: np.ndarray) -> Restriction:
    """Coordinates that are linear combinations of external variables: Z = E B.

    Parameters
    ----------
    variables : ndarray, shape (n, q)
        At least as many independent ones as the solution has dimensions. They are centred, and scaled to unit mean
        square, which changes no solution.

    Returns
    -------
    Restriction

    Raises
    ------
    GlossError
        A variable is not finite or the same for all stimuli.
    """
    variables = np.ma.filled(np.ma.asarray(variables, dtype=float), np.nan)
    variables = variables[:, np.newaxis] if variables.ndim == 1 else variables
    if variables.ndim != 2 or variables.size == 0:
        raise GlossError(f"External variables must be of shape (n, q), not {variables.shape}.")
    if not np.all(np.isfinite(variables)) or np.any(np.ptp(variables, axis=0) == 0):
        raise GlossError("External variables must be finite and differ between the stimuli.")
    scaled = variables / np.abs(variables).max(axis=0)
    centred = scaled - scaled.mean(axis=0)
    return Restriction(None, centred / np.sqrt(np.mean(centred**2, axis=0)))
