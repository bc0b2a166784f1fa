"""The path of the slider in one trial, summed up: pure arithmetic on the values it showed."""

from collections.abc import Sequence
from itertools import pairwise

__all__ = ["n_changes", "n_reversals"]


def n_changes(rests: Sequence[int]) -> int:
    """How often the slider came to rest at another value; the first response counts.

    Parameters
    ----------
    rests
        The values at which it came to rest, in order.

    Examples
    --------
    >>> n_changes([30, 30, 45])
    2
    """
    return sum(before != after for before, after in pairwise(rests)) + bool(rests)


def n_reversals(path: Sequence[int]) -> int:
    """How often the slider turned round; standing still is no turn.

    Parameters
    ----------
    path
        The values it showed, in order.

    Examples
    --------
    >>> n_reversals([10, 20, 20, 30, 25, 40])
    2
    """
    steps = [after - before for before, after in pairwise(path) if after != before]
    return sum((before > 0) != (after > 0) for before, after in pairwise(steps))
