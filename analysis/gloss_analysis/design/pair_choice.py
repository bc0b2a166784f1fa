"""Which pairs to keep when time is short: an incomplete, connected design that loses little about the weight."""

from dataclasses import dataclass

import numpy as np

from gloss_analysis.design.connected import Requirement, check_requirement, thinned
from gloss_analysis.design.information import (
    NUISANCE_COLUMNS,
    check_axes,
    log_ratio_variance,
    observers_at,
    sensitivities,
)
from gloss_analysis.design.population import Population
from gloss_analysis.replicates import OnStep, no_step
from glossspace.errors import GlossError

__all__ = ["PairChoice", "choose_pairs", "thinned_at_random"]

# A swap must lower the variance by more than this part: rounding is no improvement.
_IMPROVED = 1e-9
_ROUNDS = 50
# Random designs that the search starts from too, up to so many times the pairs of the smallest design.
_RANDOM_STARTS, _TIGHT = 6, 1.5
# Beyond, choosing takes longer than anybody waits.
_MOST_STIMULI = 100
# Keeps matrices of few pairs invertible. Their columns are of the size of 1.
_RIDGE = 1e-9
# How much wider than the population the observers are spread that a design is made for, and how wide they are at least:
# nobody knows the ratio before the study.
_WIDER, _LEAST_SPREAD = 2, 0.1


@dataclass(frozen=True)
class PairChoice:
    """Pairs to judge, and what they are expected to tell.

    Attributes
    ----------
    kept : ndarray of bool, shape (n (n - 1) / 2,)
        Upper triangle row by row.
    relative_error : float
        Expected standard error of one observer's log ratio over that with all pairs; 1 or more. Infinite where these
        pairs do not tell it to first order, NaN where all of them do not: a regular grid of stimuli has few different
        distances, and the unknown response explains whatever changes with the distance alone.
    """

    kept: np.ndarray
    relative_error: float


def choose_pairs(
    coordinates: np.ndarray,
    n_pairs: int,
    population: Population,
    *,
    degree: int = 3,
    seed: int = 1,
    on_step: OnStep = no_step,
) -> PairChoice:
    """Choose the pairs that tell most about the weight of the second axis.

    Parameters
    ----------
    coordinates : ndarray, shape (n, 2)
        Of 3 to 100 stimuli on two axes.
    n_pairs : int
        How many to keep: more than the twelve unknowns of the model, and no fewer than a connected design needs.
    population : Population
        Whose ratios and exponent the design is made for.
    degree : int
        In how many pairs every stimulus must be, 1 to n - 1.
    seed : int
        Of the random designs that the search starts from too.
    on_step : callable
        Called with the number of starts done and of all, to show progress.

    Returns
    -------
    PairChoice

    Raises
    ------
    GlossError
        Too few or too many pairs; a degree that cannot be; coordinates that are not finite, or do not tell two axes
        apart.

    Notes
    -----
    The criterion is the variance of an observer's log ratio (`gloss_analysis.design.information`), in the mean of seven
    observers who stand for a population spread twice as widely as the given one. From all pairs the one whose loss
    raises it least is dropped, again and again; then a pair kept and a pair dropped change places as long as that
    lowers it. Both steps leave the design connected and every stimulus in `degree` pairs. Where there are so few pairs
    that these can hardly change places, six designs thinned at random are exchanged too. The best is taken: a good
    design, not for certain the best of all.

    Examples
    --------
    >>> from gloss_analysis.design.simulation import EXPERIMENT_1
    >>> choice = choose_pairs(EXPERIMENT_1, 150, Population())
    >>> int(choice.kept.sum()), choice.relative_error < 1.4
    (150, True)
    """
    coordinates = np.asarray(coordinates, dtype=float)
    check_axes(coordinates)
    if len(coordinates) > _MOST_STIMULI:
        raise GlossError(
            f"{len(coordinates)} stimuli have too many pairs to choose from. Allowed: up to {_MOST_STIMULI} stimuli."
        )
    required = Requirement(len(coordinates), degree)
    check_requirement(required, n_pairs)
    if n_pairs <= 1 + NUISANCE_COLUMNS:
        raise GlossError(
            f"{n_pairs} pairs cannot tell the weight from the response of the slider. Allowed: {2 + NUISANCE_COLUMNS} "
            "pairs or more."
        )
    first, second = required.pairs
    delta = coordinates[first] - coordinates[second]
    ratios, shares = observers_at(population.ratio, max(_WIDER * population.sd_log_ratio, _LEAST_SPREAD))
    rows = sensitivities(delta, ratios, exponent=population.exponent)
    rows[..., 0] /= 100

    tight = n_pairs <= _TIGHT * required.fewest
    children = np.random.SeedSequence(seed).spawn(_RANDOM_STARTS if tight else 0)
    order = np.arange(len(coordinates))
    found = []
    for done, child in enumerate((None, *children)):
        on_step(done, 1 + len(children))
        start = (
            thinned(required, n_pairs, lambda kept: _when_one_goes(rows, shares, kept), order=order)
            if child is None
            else thinned_at_random(len(coordinates), n_pairs, degree=degree, seed=child)
        )
        for _ in range(_ROUNDS):
            if not _exchanged(required, start, rows, shares):
                break
        found.append(start)
    on_step(len(found), len(found))
    kept = min(found, key=lambda start: _mean_variance(rows, shares, start))
    whole = np.ones(len(delta), dtype=bool)
    error, least = (
        float(shares @ [log_ratio_variance(delta, these, ratio, exponent=population.exponent) for ratio in ratios])
        for these in (kept, whole)
    )
    return PairChoice(kept, float(np.sqrt(error / least)))


def thinned_at_random(
    n_stimuli: int, n_pairs: int, *, degree: int = 3, seed: int | np.random.SeedSequence = 1
) -> np.ndarray:
    """Pairs that are left when others are dropped at random, under the same conditions as in `choose_pairs`.

    Returns
    -------
    ndarray of bool, shape (n (n - 1) / 2,)

    Raises
    ------
    GlossError
        Too few or too many pairs, or a degree that cannot be.

    Examples
    --------
    >>> int(thinned_at_random(27, 100).sum())
    100
    """
    required = Requirement(n_stimuli, degree)
    check_requirement(required, n_pairs)
    rng = np.random.default_rng(seed)
    rank = rng.random(len(required.pairs[0]))
    return thinned(required, n_pairs, lambda _: rank, order=rng.permutation(n_stimuli))


def _matrices(rows: np.ndarray, kept: np.ndarray) -> np.ndarray:
    """Cross products of the columns over the pairs kept, shape (k, p, p)."""
    some = rows[:, kept]
    return np.asarray(np.swapaxes(some, 1, 2) @ some + _RIDGE * np.eye(rows.shape[2]))


def _variances(matrices: np.ndarray) -> np.ndarray:
    """1 / S of each observer: det(N'N) / det([x N]'[x N]), shape (k,)."""
    return np.asarray(np.linalg.det(matrices[:, 1:, 1:]) / np.linalg.det(matrices))


def _when_changed(matrices: np.ndarray, rows: np.ndarray, shares: np.ndarray, sign: int) -> np.ndarray:
    """Mean variance when one of the pairs comes in (sign 1) or goes (sign -1), shape (q,).

    By the determinant of a matrix of rank one more or less: det(M + r r') = det(M) (1 + r' M^-1 r).
    """
    factors = []
    for used, matrix in ((rows, matrices), (rows[..., 1:], matrices[:, 1:, 1:])):
        leverage = np.sum((used @ np.linalg.inv(matrix)) * used, axis=2)
        factors.append(1 + sign * leverage)
    # A pair of leverage 1 is all that tells of a column.
    whole = np.where(factors[0] > _RIDGE, factors[0], 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        found = _variances(matrices)[:, np.newaxis] * factors[1] / whole
    return np.asarray(shares @ np.where(whole > 0, found, np.inf))


def _mean_variance(rows: np.ndarray, shares: np.ndarray, kept: np.ndarray) -> float:
    return float(shares @ _variances(_matrices(rows, kept)))


def _when_one_goes(rows: np.ndarray, shares: np.ndarray, kept: np.ndarray) -> np.ndarray:
    return _when_changed(_matrices(rows, kept), rows, shares, -1)


def _exchanged(required: Requirement, kept: np.ndarray, rows: np.ndarray, shares: np.ndarray) -> bool:
    """Exchange pairs of `kept`, in place, for better ones; whether any was."""
    improved = False
    for leaving in np.flatnonzero(kept)[np.argsort(_when_one_goes(rows, shares, kept)[kept], kind="stable")]:
        before = _mean_variance(rows, shares, kept)
        kept[leaving] = False
        after = _when_changed(_matrices(rows, kept), rows, shares, 1)
        after[kept] = np.inf
        entering = _first_allowed(required, kept, after, before * (1 - _IMPROVED))
        improved |= entering is not None
        kept[leaving if entering is None else entering] = True
    return improved


def _first_allowed(required: Requirement, kept: np.ndarray, variance: np.ndarray, limit: float) -> int | None:
    for pair in np.argsort(variance, kind="stable"):
        if variance[pair] >= limit:
            return None
        kept[pair] = True
        allowed = required.met_by(kept)
        kept[pair] = False
        if allowed:
            return int(pair)
    return None
