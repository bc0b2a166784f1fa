"""Ranks along isogloss contours: are they similar, and does it matter in which way stimuli differ (section 5.1)?"""

import itertools
import math
from dataclasses import dataclass

import numpy as np

from gloss_analysis.ranking.rank_permutation import Orders, products_under, sums_under

__all__ = ["Contours", "Direction", "contour_test", "levels_of"]


@dataclass(frozen=True)
class Direction:
    """Whether stimuli of one contour rank higher if they differ from the reference in d rather than in c.

    Attributes
    ----------
    lead : float
        By how many ranks the one of a pair that differs more in d is ahead, in the mean of the pairs that differ in
        direction.
    n_pairs : int
    p_value : float
        Two-sided, against ranks exchanged along each contour.
    """

    lead: float
    n_pairs: int
    p_value: float


@dataclass(frozen=True)
class Contours:
    """Whether stimuli on one isogloss contour get similar ranks.

    Attributes
    ----------
    tolerance : float
        Distances of one contour differ by no more.
    level : ndarray of int, shape (n,)
        The contour of each stimulus, from the reference outwards.
    n_pairs : int
        Pairs of stimuli on one contour.
    within, between : float
        Mean difference of the mean ranks of such pairs, and of all others.
    p_value : float
        One-sided, against stimuli that change places. Ranks that follow the distance at all make it small.
    direction : Direction or None
        The sharper test: what is left along a contour. None where no two stimuli of one contour differ in direction.
    """

    tolerance: float
    level: np.ndarray
    n_pairs: int
    within: float
    between: float
    p_value: float
    direction: Direction | None


def levels_of(distances: np.ndarray, tolerance: float) -> np.ndarray:
    """Number the contours on which ascending distances lie; those of one contour span no more than the tolerance.

    Examples
    --------
    >>> levels_of(np.array([0.0, 0.04, 0.041, 0.08]), 0.004).tolist()
    [0, 1, 1, 2]
    """
    levels, start = np.zeros(len(distances), dtype=int), 0
    for index in range(1, len(distances)):
        apart = distances[index] - distances[start] > tolerance
        levels[index] = levels[index - 1] + apart
        start = index if apart else start
    return levels


def contour_test(
    distances: np.ndarray,
    angle_deg: np.ndarray,
    mean_rank: np.ndarray,
    *,
    tolerance: float,
    orders: Orders,
    seed: np.random.SeedSequence,
) -> Contours | None:
    """Are the mean ranks of stimuli on one contour nearer together than those of other stimuli?

    Parameters
    ----------
    distances : ndarray, shape (n,)
        Predicted, ascending.
    angle_deg : ndarray, shape (n,)
        Whether a stimulus differs from the reference in c (0) or in d (90); NaN where it does not differ.
    mean_rank : ndarray, shape (n,)
    tolerance : float
    orders : Orders
        Of the stimuli.
    seed : SeedSequence

    Returns
    -------
    Contours or None
        None where no two stimuli lie on one contour, or all do.

    Examples
    --------
    Two contours of two stimuli, whose ranks are next to each other: no permutation of four does better, 8 as well.

    >>> from gloss_analysis.ranking.rank_permutation import orders_of
    >>> seed, ranks = np.random.SeedSequence(1), np.array([1.0, 2.0, 3.0, 4.0])
    >>> found = contour_test(
    ...     np.array([0.04, 0.04, 0.08, 0.08]), np.array([0.0, 90.0, 0.0, 90.0]), ranks, tolerance=0.004,
    ...     orders=orders_of(4, 99, seed), seed=seed,
    ... )
    >>> found.within, round(found.p_value, 3), found.direction.lead
    (1.0, 0.333, 1.0)
    """
    levels = levels_of(distances, tolerance)
    upper = np.triu(np.ones((len(levels),) * 2, dtype=bool), 1)
    same = levels[:, None] == levels
    on_one, apart = upper & same, np.abs(mean_rank[:, None] - mean_rank)
    if not on_one.any() or on_one.sum() == upper.sum():
        return None
    null = products_under(orders, same.astype(float), apart[None])[:, 0]
    return Contours(
        tolerance=tolerance,
        level=levels,
        n_pairs=int(on_one.sum()),
        within=float(apart[on_one].mean()),
        between=float(apart[upper & ~same].mean()),
        p_value=orders.p_value(-null, -float((same * apart).sum())),
        direction=_direction(levels, angle_deg, mean_rank, n_permutations=len(orders.places), seed=seed),
    )


def _direction(
    levels: np.ndarray,
    angle_deg: np.ndarray,
    mean_rank: np.ndarray,
    *,
    n_permutations: int,
    seed: np.random.SeedSequence,
) -> Direction | None:
    # Directions that differ by less than a degree are the same: stimuli of computed paints are rounded.
    apart = angle_deg[:, None] - angle_deg
    ahead = np.where((levels[:, None] == levels) & (np.abs(apart) > 1), np.sign(apart), 0.0)
    n_pairs = int(np.count_nonzero(ahead)) // 2
    if n_pairs == 0:
        return None
    # Each pair is counted in both orders: the sum over pairs of (rank of the one ahead - rank of the other).
    share = ahead.sum(axis=1) / n_pairs
    orders = _along_contours(levels, n_permutations, seed)
    lead = float(share @ mean_rank)
    null = sums_under(orders, mean_rank, share[None])[:, 0]
    return Direction(lead, n_pairs, orders.p_value(np.abs(null), abs(lead)))


def _along_contours(levels: np.ndarray, n_permutations: int, seed: np.random.SeedSequence) -> Orders:
    """Orders of the stimuli in which each stays on its contour."""
    contours = [np.flatnonzero(levels == level) for level in np.unique(levels)]
    if sum(math.lgamma(len(one) + 1) for one in contours) <= math.log(max(n_permutations, 1)) + 1e-9:
        every = itertools.product(*(itertools.permutations(one) for one in contours))
        return Orders(np.array([[place for one in order for place in one] for order in every]), exhaustive=True)
    rng = np.random.default_rng(seed)
    drawn = [rng.permuted(np.tile(one, (n_permutations, 1)), axis=1) for one in contours]
    return Orders(np.concatenate(drawn, axis=1), exhaustive=False)
