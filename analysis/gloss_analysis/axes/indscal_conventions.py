"""How big coordinates and weights of a weighted solution are written: the conventions of the usual programs.

In the weighted Euclidean model participant k sees stimulus i at y_kir = w_kr x_ir. A dimension may be stretched and its
weights shrunk by the same factor, and each participant's judgements say nothing about the size of his or her own space.
Programs settle both differently; only what they settle may be compared. Conventions, by name:

`group`
    That of `gloss_analysis.mds`. Each participant's own space has total mean square 1; in every dimension the weights
    have root mean square 1 over participants, so that the coordinates are what the average participant sees.
`unit_columns`
    Each dimension has mean square 1; sizes are in the weights. No participant's distances change. Of a solution in the
    `group` convention, the squared weights of a participant add up to 1 and are the dimensions' parts of what that
    participant sees.
`unit_sum_of_squares`
    INDSCAL's and SINDSCAL's (Carroll & Chang, 1970): each dimension has sum of squares 1, and the scalar products of
    each participant's own space have sum of squares 1, as INDSCAL scales those of the data. What these programs print
    as weights is w^2 (`squared_weights`): it multiplies squared differences, d^2 = sum_r w_r^2 (x_ir - x_jr)^2. Where
    dimensions are uncorrelated, each participant's squared weights have sum of squares 1.
`proc_mds`
    PROC MDS of SAS with COEF=DIAGONAL: each dimension has mean square 1, and the weights of each participant have mean
    square 1 over dimensions.
`proxscal`
    Each participant's distances have mean square 1 over all pairs: the size that PROXSCAL gives the transformed
    proximities of each source, from which its distances fall short by the factor sqrt(1 - Stress-1^2). Each dimension
    has mean square 1. Compare participants' own spaces (`spaces`) with those of the program, since how size is divided
    between the common space and the weights does not matter there.
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np

from glossspace.errors import GlossError

__all__ = ["CONVENTIONS", "Convention", "WeightedSpace", "converted"]

Convention: TypeAlias = Literal["group", "unit_columns", "unit_sum_of_squares", "proc_mds", "proxscal"]
CONVENTIONS: tuple[Convention, ...] = get_args(Convention)


@dataclass(frozen=True)
class WeightedSpace:
    """A weighted solution written in one of the conventions.

    Attributes
    ----------
    convention : str
    coordinates : ndarray, shape (n, p)
        Centred; order and sign of the dimensions as given.
    weights : ndarray, shape (m, p)
        Factors by which participants stretch the dimensions, >= 0.
    source_scale : ndarray, shape (m,)
        Each participant's distances here over those given.
    """

    convention: Convention
    coordinates: np.ndarray
    weights: np.ndarray
    source_scale: np.ndarray

    @property
    def squared_weights(self) -> np.ndarray:
        """Weights of squared differences, shape (m, p): what INDSCAL, SINDSCAL and ALSCAL call weights."""
        return self.weights**2

    @property
    def spaces(self) -> np.ndarray:
        """What each participant sees, shape (m, n, p)."""
        return self.coordinates[np.newaxis] * self.weights[:, np.newaxis]


def converted(coordinates: np.ndarray, dimension_weights: np.ndarray, *, to: Convention) -> WeightedSpace:
    """Write a weighted solution in another convention; within each participant, ratios of distances stay as they are.

    Parameters
    ----------
    coordinates : ndarray, shape (n, p)
        In any convention.
    dimension_weights : ndarray, shape (m, p)
        Factors of stretching, >= 0. Give the square roots of weights that multiply squared differences.
    to : {"group", "unit_columns", "unit_sum_of_squares", "proc_mds", "proxscal"}
        See the head of this module.

    Returns
    -------
    WeightedSpace

    Raises
    ------
    GlossError
        The convention is not known, shapes do not fit, a number is not finite, a weight is negative, or a dimension or
        a participant's space has no extent, so that it cannot be brought to a size.

    Examples
    --------
    >>> coordinates, weights = np.array([[3.0, 1.0], [-3.0, 1.0], [0.0, -2.0]]), np.array([[1.0, 2.0], [2.0, 1.0]])
    >>> written = converted(coordinates, weights, to="unit_sum_of_squares")
    >>> np.sum(written.coordinates**2, axis=0).round(6).tolist()
    [1.0, 1.0]
    """
    if to not in CONVENTIONS:
        raise GlossError(f"Invalid convention {to!r}. Allowed: {', '.join(map(repr, CONVENTIONS))}.")
    x, w = np.asarray(coordinates, dtype=float), np.asarray(dimension_weights, dtype=float)
    _check(x, w)
    x = x - x.mean(axis=0)
    x, w = _unit_columns(x, w)
    scale = _source_scale(x, w, to)
    w = w * scale[:, np.newaxis]
    if to == "group":
        stretch = np.sqrt(np.mean(w**2, axis=0))
    else:
        stretch = np.full(x.shape[1], 1 / np.sqrt(len(x)) if to == "unit_sum_of_squares" else 1.0)
    return WeightedSpace(to, x * stretch, w / stretch, scale)


def _check(x: np.ndarray, w: np.ndarray) -> None:
    if x.ndim != 2 or w.ndim != 2 or x.shape[1] != w.shape[1] or 0 in (*x.shape, *w.shape):
        raise GlossError(
            f"Coordinates of shape {x.shape} and weights of shape {w.shape} do not fit. Give stimuli by dimensions and "
            "participants by dimensions."
        )
    if not (np.all(np.isfinite(x)) and np.all(np.isfinite(w))):
        raise GlossError("Coordinates and weights must be finite numbers. Leave out stimuli and participants without.")
    if np.any(w < 0):
        k, r = np.argwhere(w < 0)[0]
        raise GlossError(
            f"The weight of participant {k + 1} in dimension {r + 1} is {w[k, r]:g}. Allowed: 0 or more. Negative "
            "squared weights, which some programs give, have no distances."
        )
    flat = (np.ptp(x, axis=0) == 0) | ~w.any(axis=0)
    if flat.any():
        raise GlossError(
            f"Dimension {np.argmax(flat) + 1} has no extent: all its coordinates are alike, or all its weights 0. "
            "Leave it out."
        )
    if not w.any(axis=1).all():
        raise GlossError(
            f"All weights of participant {np.argmin(w.any(axis=1)) + 1} are 0: that space has no size. Leave the "
            "participant out."
        )


def _unit_columns(x: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    size = np.sqrt(np.mean(x**2, axis=0))
    return x / size, w * size


def _source_scale(x: np.ndarray, w: np.ndarray, to: Convention) -> np.ndarray:
    """Factor that brings each participant's space to the convention's size, of columns `x` with mean square 1."""
    n, p = x.shape
    if to == "unit_columns":
        return np.ones(len(w))
    total = np.sum(w**2, axis=1)  # total mean square of each participant's own space
    if to == "group":
        return 1 / np.sqrt(total)
    if to == "proc_mds":
        return np.sqrt(p / total)
    if to == "proxscal":
        # Sum over pairs of d^2 is n times the sum of squares of the centred space, n total.
        return np.sqrt((n - 1) / (2 * n * total))
    products = np.einsum("kr,rs,ks->k", w**2, (x.T @ x) ** 2, w**2)  # sums of squares of Y Y'
    return np.asarray(products**-0.25)
