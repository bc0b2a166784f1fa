"""How wide the interval of the weight will be: simulated studies of planned designs."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import binomtest

from gloss_analysis.confirmatory.scaling import confirm_axes, population_interval
from gloss_analysis.design.information import check_axes
from gloss_analysis.design.population import Population
from gloss_analysis.design.simulation import drawn_ratios, simulated_study
from gloss_analysis.replicates import OnStep, in_parallel, no_step
from glossspace.errors import GlossError

__all__ = [
    "ASSURANCE",
    "FEWEST_STUDIES",
    "DesignPrecision",
    "check_width",
    "remarks",
    "simulate_designs",
    "smallest_design",
]

ASSURANCE = 0.9
"""Share of studies whose interval is to be narrow enough."""

FEWEST_STUDIES = 10
"""Below, nothing can be said of nine in ten."""
_NOMINAL = 0.95
# Bias and loss of spread that are worth a word.
_BIAS, _FOLLOWS = 0.03, 0.9


@dataclass(frozen=True)
class DesignPrecision:
    """What simulated studies of one design found.

    Attributes
    ----------
    n_observers, n_pairs, n_repeats : int
        Each observer judges each pair so many times.
    width_median, width_p90 : float
        Of the 95 % interval: its upper bound over its lower one, 1 for a point; in the median study, and such that 90 %
        of studies have a narrower one.
    bias, bias_error : float
        Of the population's ratio, in parts of the true one (of the mean logarithm), with its standard error.
    coverage : float
        Share of studies whose interval holds the true ratio.
    coverage_ci95 : tuple of float
        Wilson's interval of it.
    follows : float
        By how much the logarithm of an observer's found ratio rises with that of the true one, by regression over all
        simulated observers: 1 where the judgements tell the ratio; below 1 where few or noisy ones draw all observers
        together, so that intervals are too narrow. NaN where the population has no spread.
    observer_error : float
        Standard deviation of an observer's found log ratio about that line.
    n_studies : int
        Simulated studies.
    n_without : int
        Of them, those without an interval: fewer than two simulated observers could be fitted.
    """

    n_observers: int
    n_pairs: int
    n_repeats: int
    width_median: float
    width_p90: float
    bias: float
    bias_error: float
    coverage: float
    coverage_ci95: tuple[float, float]
    follows: float
    observer_error: float
    n_studies: int
    n_without: int

    @property
    def n_judgements(self) -> int:
        """Of all observers together."""
        return self.n_observers * self.n_pairs * self.n_repeats


def simulate_designs(
    coordinates: np.ndarray,
    population: Population,
    *,
    observers: Sequence[int],
    pair_sets: Sequence[np.ndarray],
    repeats: Sequence[int] = (1,),
    axes: tuple[str, str] = ("c", "d"),
    n_studies: int = 400,
    seed: int = 1,
    n_jobs: int = 1,
    on_step: OnStep = no_step,
) -> tuple[DesignPrecision, ...]:
    """Simulate studies of every combination of observers, pairs and repeats.

    Parameters
    ----------
    coordinates : ndarray, shape (n, 2)
    population : Population
    observers : sequence of int
        Numbers of observers, each 2 or more.
    pair_sets : sequence of ndarray of bool, shape (n (n - 1) / 2,) or (n_studies, n (n - 1) / 2)
        Pairs that are judged, upper triangle row by row: the same in all studies, or others in each.
    repeats : sequence of int
        How often each pair is judged; each 1 or more.
    n_studies : int
        Of each design, 10 or more; 400 know a coverage to ± 2 %.
    seed : int
        Of everything drawn; the result does not depend on `n_jobs`.
    n_jobs : int
        Processes (joblib), -1 for one a core.
    on_step : callable
        Called with the number of studies done and of all, to show progress.

    Returns
    -------
    tuple of DesignPrecision
        Pair sets in their order; within them repeats, then observers.

    Raises
    ------
    GlossError
        A number that is too small, pairs that do not fit the coordinates, studies without an interval, or what
        `confirm_axes` refuses.

    Notes
    -----
    Repeats are averaged and each study is analysed by ordinal `confirm_axes`, with Student's interval. A study of m
    observers is the first m of one of more: an observer's own ratio does not depend on the others. All designs are
    simulated with the same observers, and the same noise where they have pairs and repeats in common, so that they
    differ by what is designed and less by chance.

    Examples
    --------
    >>> from gloss_analysis.design.simulation import EXPERIMENT_1
    >>> every = np.ones(351, dtype=bool)
    >>> few, many = simulate_designs(EXPERIMENT_1, Population(), observers=[5, 10], pair_sets=[every], n_studies=20)
    >>> few.width_median > many.width_median
    True
    """
    coordinates = np.asarray(coordinates, dtype=float)
    n_pairs = len(coordinates) * (len(coordinates) - 1) // 2
    check_axes(coordinates)
    _check(observers, repeats, n_studies)
    for kept in pair_sets:
        if kept.shape not in ((n_pairs,), (n_studies, n_pairs)):
            raise GlossError(f"Pairs of shape {kept.shape} do not fit {len(coordinates)} stimuli: {n_pairs} pairs.")
    most = max(observers)
    children = np.random.SeedSequence(seed).spawn(n_studies)
    designs = list(itertools.product(pair_sets, repeats))
    cases = [
        (kept if kept.ndim == 1 else kept[study], times, child)
        for kept, times in designs
        for study, child in enumerate(children)
    ]

    def one(case: tuple[np.ndarray, int, np.random.SeedSequence]) -> tuple[np.ndarray, np.ndarray]:
        kept, times, child = case
        rng = np.random.default_rng(child)
        ratios = drawn_ratios(population, most, rng)
        data = simulated_study(coordinates, ratios, population, n_repeats=times, kept=kept, rng=rng)
        fit = confirm_axes(data, coordinates, axes=axes)
        logs = np.full(most, np.nan)
        logs[[data.participants.index(name) for name in fit.participants]] = np.log(
            [weights.ratio for weights in fit.individual]
        )
        return np.column_stack([np.log(ratios), logs]), np.array([_interval(logs[:m]) for m in observers])

    results = list(in_parallel(one, cases, n_jobs, on_step, prefer="processes"))
    found = []
    for row, (kept, times) in enumerate(designs):
        logs, intervals = zip(*results[row * n_studies : (row + 1) * n_studies], strict=True)
        n_kept = int(np.atleast_2d(kept)[0].sum())
        for m, of_studies in zip(observers, np.swapaxes(intervals, 0, 1), strict=True):
            found.append(_summary(of_studies, np.concatenate(logs), np.log(population.ratio), m, n_kept, times))
    return tuple(found)


def smallest_design(
    designs: Sequence[DesignPrecision], width: float, *, assured: bool = True
) -> DesignPrecision | None:
    """Design of fewest judgements, and of these of fewest observers, whose interval is narrow enough.

    Parameters
    ----------
    designs : sequence of DesignPrecision
    width : float
        Upper bound of the 95 % interval over the lower one; above 1.
    assured : bool
        Whether 90 % of studies must have an interval at most so wide, or half of them.

    Returns
    -------
    DesignPrecision, or None
        None where no design meets it.

    Raises
    ------
    GlossError
        See `check_width`.
    """
    check_width(width)
    enough = [one for one in designs if (one.width_p90 if assured else one.width_median) <= width]
    return min(enough, key=lambda one: (one.n_judgements, one.n_observers), default=None)


def check_width(width: float) -> None:
    """Refuse a width of an interval that cannot be.

    Raises
    ------
    GlossError
        Not a finite number above 1.
    """
    if not (np.isfinite(width) and width > 1):
        raise GlossError(f"Invalid width = {width!r}. Allowed: above 1; 1.25 is an upper bound 25 % above the lower.")


def remarks(design: DesignPrecision) -> tuple[str, ...]:
    """Say what speaks against taking the width of a design at face value."""
    found = []
    name = f"{design.n_observers} observers, {design.n_pairs} pairs, {design.n_repeats} repeats"
    low, high = design.coverage_ci95
    if high < _NOMINAL:
        found.append(
            f"{name}: the 95 % intervals hold the true weight in {design.coverage:.0%} [{low:.0%}, {high:.0%}] of "
            "simulated studies only. They are narrow, but not right."
        )
    if abs(design.bias) - 2 * design.bias_error > _BIAS:
        found.append(
            f"{name}: noise moves the weight by {100 * design.bias:+.1f} % in the mean. More observers do not help; "
            "repeats and less noise do."
        )
    if design.follows < _FOLLOWS:
        found.append(
            f"{name}: an observer's own weight is followed by {100 * design.follows:.0f} % only, so that observers "
            "look more alike than they are. Take more pairs or repeats."
        )
    if design.n_without:
        found.append(f"{name}: {design.n_without} of {design.n_studies} simulated studies gave no interval.")
    return tuple(found)


def _check(observers: Sequence[int], repeats: Sequence[int], n_studies: int) -> None:
    for name, numbers, least in (("observers", observers, 2), ("repeats", repeats, 1)):
        if min(numbers, default=0) < least:
            raise GlossError(f"Invalid numbers of {name}: {list(numbers)}. Allowed: one or more, each {least} or more.")
    if n_studies < FEWEST_STUDIES:
        raise GlossError(f"Invalid number of studies = {n_studies}. Allowed: {FEWEST_STUDIES} or more.")


def _interval(logs: np.ndarray) -> tuple[float, float, float]:
    """Mean logarithm and the logarithms of the bounds of its interval; NaN where there are none."""
    logs = logs[~np.isnan(logs)]
    interval = population_interval(logs)
    return (np.nan, np.nan, np.nan) if interval is None else (float(logs.mean()), *np.log(interval))


def _summary(
    intervals: np.ndarray, logs: np.ndarray, truth: float, n_observers: int, n_pairs: int, n_repeats: int
) -> DesignPrecision:
    n_studies = len(intervals)
    seen = intervals[~np.isnan(intervals).any(axis=1)]
    if len(seen) < 2:
        raise GlossError(
            f"Simulated studies of {n_observers} observers, {n_pairs} pairs and {n_repeats} repeats have no interval: "
            "fewer than two simulated observers could be fitted. Take more observers or pairs, or less noise."
        )
    mean, low, high = seen.T
    bias = float(np.expm1(np.mean(mean - truth)))
    covered = int(np.count_nonzero((low <= truth) & (truth <= high)))
    bounds = binomtest(covered, len(seen)).proportion_ci(method="wilson")
    follows, error = _response_to_truth(*logs[~np.isnan(logs).any(axis=1)].T)
    return DesignPrecision(
        n_observers=n_observers,
        n_pairs=n_pairs,
        n_repeats=n_repeats,
        width_median=float(np.exp(np.median(high - low))),
        width_p90=float(np.exp(np.quantile(high - low, ASSURANCE))),
        bias=bias,
        bias_error=float((1 + bias) * mean.std(ddof=1) / np.sqrt(len(seen))),
        coverage=covered / len(seen),
        coverage_ci95=(float(bounds.low), float(bounds.high)),
        follows=follows,
        observer_error=error,
        n_studies=n_studies,
        n_without=n_studies - len(seen),
    )


def _response_to_truth(true: np.ndarray, found: np.ndarray) -> tuple[float, float]:
    """Slope of the found log ratios on the true ones, and the standard deviation about that line."""
    if np.ptp(true) == 0:
        return np.nan, float(found.std(ddof=1))
    slope, intercept = np.polyfit(true, found, 1)
    return float(slope), float(np.std(found - slope * true - intercept, ddof=2))
