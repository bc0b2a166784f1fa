"""How firmly the judgements fix a solution: bootstrap over participants or trials, and the jackknife.

Each replicate is fitted anew from the solution and some starts around it, then aligned with the solution, so that only
what judgements can fix counts as uncertainty.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np
from scipy.stats import t as student_t

from gloss_analysis.judgements.dissimilarity import REPEATS, Dissimilarities, Repeats, Trials
from gloss_analysis.mds import MdsSolution
from gloss_analysis.replicates import OnStep, in_parallel, no_step
from gloss_analysis.uncertainty.ellipses import Ellipse, ellipse
from gloss_analysis.uncertainty.refitting import (
    Refit,
    check_confidence,
    check_fits,
    check_plane,
    check_weights,
    geometric_mean_ratio,
    refitted,
    weight_ratio,
)
from glossspace.errors import GlossError

__all__ = ["RESAMPLES", "BootstrapResult", "Resample", "bootstrap"]

Resample: TypeAlias = Literal["observers", "trials"]
RESAMPLES: tuple[Resample, ...] = ("observers", "trials")

# Participants below which a percentile interval misses its level by more than about two per cent.
_FEW_PARTICIPANTS = 20


@dataclass(frozen=True)
class BootstrapResult:
    """Solutions of resampled judgements, aligned with that of the judgements themselves.

    Attributes
    ----------
    solution : MdsSolution
        Of the judgements themselves.
    resample : {"observers", "trials"}
    coordinates : ndarray, shape (B, n, p)
        One of each replicate that could be fitted.
    dimension_weights : ndarray, shape (B, m, p)
        NaN for participants who were not drawn.
    draws : ndarray of int, shape (B, m)
        How often each participant was drawn.
    stress1 : ndarray, shape (B,)
    n_degenerate : int
        Replicates left out: fewer than two different participants, or judgements that determine no configuration.
    warnings : tuple of str
    """

    solution: MdsSolution
    resample: Resample
    coordinates: np.ndarray
    dimension_weights: np.ndarray
    draws: np.ndarray
    stress1: np.ndarray
    n_degenerate: int
    warnings: tuple[str, ...]

    def weight_ratios(self, first: int = 0, second: int = 1) -> np.ndarray:
        """How far dimension `second` extends over `first` for each participant, shape (B, m); NaN where not drawn.

        Extent is the weight times the root mean square of the coordinates: by convention the weights alone have mean
        square 1 over participants, whatever the data. From 1/1000 to 1000.
        """
        check_weights(self.solution, first, second)
        return weight_ratio(self.coordinates, self.dimension_weights, first, second)

    def group_ratio(self, first: int = 0, second: int = 1) -> np.ndarray:
        """Geometric mean of the ratio over the participants drawn, shape (B,)."""
        return geometric_mean_ratio(self.weight_ratios(first, second), self.draws)

    def ratio_interval(self, first: int = 0, second: int = 1, *, level: float = 0.95) -> tuple[float, float]:
        """Percentile interval of `group_ratio`."""
        return _percentiles(self.group_ratio(first, second), level)

    def stress_interval(self, *, level: float = 0.95) -> tuple[float, float]:
        """Percentile interval of Stress-1. Resampled judgements fit better or worse than all by chance and by kind."""
        return _percentiles(self.stress1, level)

    def coordinate_intervals(self, *, level: float = 0.95) -> np.ndarray:
        """Percentile interval of every coordinate, shape (n, p, 2)."""
        check_confidence(level)
        return np.moveaxis(np.quantile(self.coordinates, [(1 - level) / 2, (1 + level) / 2], axis=0), 0, -1)

    def weight_intervals(self, *, level: float = 0.95) -> np.ndarray:
        """Percentile interval of every dimension weight, shape (m, p, 2), over replicates that drew the participant.

        What moves a participant's weights in a bootstrap over observers is the group space that the others make. NaN
        for a participant who was never drawn.
        """
        check_confidence(level)
        drawn = ~np.isnan(self.dimension_weights).all(axis=(0, 2))
        found = np.full((*self.dimension_weights.shape[1:], 2), np.nan)
        bounds = np.nanquantile(self.dimension_weights[:, drawn], [(1 - level) / 2, (1 + level) / 2], axis=0)
        found[drawn] = np.moveaxis(bounds, 0, -1)
        return found

    def ellipses(self, first: int = 0, second: int = 1, *, level: float = 0.95) -> tuple[Ellipse, ...]:
        """Region of every stimulus in the plane of two dimensions, from the covariance of the replicates.

        Raises
        ------
        GlossError
            No such dimensions.
        """
        check_confidence(level)
        check_plane(self.solution, first, second)
        planes = np.moveaxis(self.coordinates[:, :, [first, second]], 1, 0)
        return tuple(ellipse(*one, level=level) for one in zip(self.solution.stimuli, planes, strict=True))


def bootstrap(
    data: Dissimilarities,
    solution: MdsSolution,
    *,
    n_replicates: int = 1000,
    resample: Resample = "observers",
    seed: int = 1,
    n_jobs: int = 1,
    on_step: OnStep = no_step,
) -> BootstrapResult:
    """Resample the judgements and fit again, to see how far the solution would move with other participants or trials.

    Parameters
    ----------
    data : Dissimilarities
    solution : MdsSolution
        Of the same data, without restriction of the coordinates.
    n_replicates : int
        2 or more; 1000 for intervals.
    resample : {"observers", "trials"}
        Draw participants with replacement, for conclusions about the population that they come from; or each
        participant's repeats of each pair, for conclusions about these participants.
    seed : int
        Fixes all draws; the result does not depend on `n_jobs`.
    n_jobs : int
        Threads (joblib), -1 for one a core.
    on_step : callable
        Called with the number of replicates done and of all, to show progress.

    Returns
    -------
    BootstrapResult

    Raises
    ------
    GlossError
        The solution is not one of the data; no pair was judged twice (trials); fewer than two participants (observers);
        or fewer than two replicates could be fitted.

    Notes
    -----
    Bootstrap intervals of few units are too short. A 95 % percentile interval of nine participants covers about 90 %;
    `jackknife` with its t interval is an alternative. Redrawing k repeats shows a standard error smaller than the true
    one by the factor sqrt(1 - 1 / k), .71 with two. Both are said in the warnings.

    A replicate is fitted from the solution, from displaced points, and from turned axes, not by a full search. With
    nine participants, 27 stimuli and two dimensions, the stress so found exceeds that of a full search by less than
    .0002.

    Examples
    --------
    >>> from gloss_analysis.mds import scale
    >>> points = np.random.default_rng(0).uniform(size=(8, 2))
    >>> first, second = np.triu_indices(8, 1)
    >>> rows = [np.linalg.norm((points[first] - points[second]) * [1, w], axis=1) for w in (0.5, 1.0, 2.0)]
    >>> data = Dissimilarities(tuple("abcdefgh"), ("1", "2", "3"), np.array(rows))
    >>> found = bootstrap(data, scale(data, n_dims=2, level="ratio"), n_replicates=20)
    >>> bool(max(found.stress1) < 1e-4)
    True
    """
    if resample not in RESAMPLES:
        raise GlossError(f"Invalid resample = {resample!r}. Allowed: {', '.join(map(repr, RESAMPLES))}.")
    if n_replicates < 2:
        raise GlossError(f"Invalid number of replicates = {n_replicates}. Allowed: 2 or more.")
    check_fits(data, solution)
    one, remarks = (_observers if resample == "observers" else _trials)(data, solution)
    seeds = np.random.SeedSequence(seed).spawn(n_replicates)
    found = [pair for pair in in_parallel(one, seeds, n_jobs, on_step) if pair is not None]
    lost = n_replicates - len(found)
    if len(found) < 2:
        raise GlossError(
            f"Only {len(found)} of {n_replicates} replicates determine a solution, so that nothing can be said about "
            "its uncertainty. Collect judgements of more participants or pairs."
        )
    if lost:
        remarks.append(
            f"{lost} of {n_replicates} replicates were left out: they hold fewer than two different participants, or "
            "judgements that determine no configuration."
        )
    weights = np.full((len(found), len(data.participants), solution.n_dims), np.nan)
    for into, (counts, refit) in zip(weights, found, strict=True):
        into[counts > 0] = refit.dimension_weights
    return BootstrapResult(
        solution=solution,
        resample=resample,
        coordinates=np.array([refit.coordinates for _, refit in found]),
        dimension_weights=weights,
        draws=np.array([counts for counts, _ in found]),
        stress1=np.array([refit.stress1 for _, refit in found]),
        n_degenerate=lost,
        warnings=tuple(remarks),
    )


_Replicate: TypeAlias = Callable[[np.random.SeedSequence], "tuple[np.ndarray, Refit] | None"]


def _observers(data: Dissimilarities, solution: MdsSolution) -> tuple[_Replicate, list[str]]:
    m = len(data.participants)
    counted = np.flatnonzero(solution.source_shares > 0)
    if len(counted) < 2:
        raise GlossError(
            f"{len(counted)} participant is too few to draw from. Judgements of two or more are needed; with repeated "
            "pairs, resample = 'trials' is possible."
        )

    def one(seed: np.random.SeedSequence) -> "tuple[np.ndarray, Refit] | None":
        rng = np.random.default_rng(seed)
        counts = np.bincount(rng.choice(counted, len(counted)), minlength=m)
        rows = np.flatnonzero(counts)
        refit = refitted(data.take(rows), counts[rows], solution, rows, rng) if len(rows) > 1 else None
        return None if refit is None else (counts, refit)

    few = len(counted)
    if few >= _FEW_PARTICIPANTS:
        return one, []
    # Of a mean of normal values: the percentile interval has a normal quantile and a variance without correction.
    covered = 2 * student_t.cdf(1.96 * np.sqrt((few - 1) / few), few - 1) - 1
    return one, [f"A 95 % percentile interval of {few} participants covers about {100 * covered:.0f} % only."]


def _trials(data: Dissimilarities, solution: MdsSolution) -> tuple[_Replicate, list[str]]:
    m, n_pairs = data.values.shape
    trials = data.trials
    cell = np.empty(0, dtype=int) if trials is None else trials.source * n_pairs + trials.pair
    cells, where, repeats = np.unique(cell, return_inverse=True, return_counts=True)
    if trials is None or repeats.max(initial=0) < 2:
        raise GlossError(
            "No participant judged a pair twice, so that trials cannot be drawn anew. Use resample = 'observers'."
        )
    rule = _rule_of_repeats(data, trials)
    order = np.argsort(cell, kind="stable")
    count = repeats[where[order]]
    begin = (np.cumsum(repeats) - repeats)[where[order]]
    rows = np.arange(m)

    def one(seed: np.random.SeedSequence) -> "tuple[np.ndarray, Refit] | None":
        rng = np.random.default_rng(seed)
        drawn = order[begin + (rng.random(len(order)) * count).astype(int)]
        redrawn = replace(
            trials, source=trials.source[order], pair=trials.pair[order], value=trials.value[drawn],
            weight=trials.weight[drawn],
        )  # fmt: skip
        values, weights = redrawn.summarised(m, n_pairs, rule)
        own = replace(
            data, values=values, pair_weights=None if data.pair_weights is None else weights, trials=None
        )  # fmt: skip
        counts = np.ones(m, dtype=int)
        refit = refitted(own, counts, solution, rows, rng)
        return None if refit is None else (counts, refit)

    # Of the error variance, to which a mean of k trials adds in proportion to 1 / k, and to the square of its weight.
    error = (data.weights.ravel()[cells] / data.weights.max()) ** 2 / repeats
    shown = np.sqrt(np.average(1 - 1 / repeats, weights=error))
    remark = (
        f"Redrawing {np.mean(repeats):.1f} judgements a pair shows about {100 * shown:.0f} % of the standard error."
    )
    return one, [remark + " Pairs that were judged once do not vary."] if repeats.min() == 1 else [remark]


def _percentiles(values: np.ndarray, level: float) -> tuple[float, float]:
    check_confidence(level)
    low, high = np.quantile(values[~np.isnan(values)], [(1 - level) / 2, (1 + level) / 2])
    return float(low), float(high)


def _rule_of_repeats(data: Dissimilarities, trials: Trials) -> Repeats:
    """How the values were made of the trials: replicates must be made in the same way."""
    for rule in REPEATS:
        values, weights = trials.summarised(len(data.values), data.values.shape[1], rule)
        same = np.allclose(values, data.values, rtol=1e-9, atol=0, equal_nan=True)
        if same and (data.pair_weights is None or np.allclose((weights - data.weights)[data.judged], 0)):
            return rule
    raise GlossError(
        "The dissimilarities are no means or medians of the trials that come with them, so that trials cannot be drawn "
        "anew. Read the table of single judgements again, or use resample = 'observers'."
    )
