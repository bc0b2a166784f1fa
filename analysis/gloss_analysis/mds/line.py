"""One dimension, where scaling is combinatorial: points cannot pass each other on a line without stress rising.

What is searched is the order of the points; in a given order the distances are differences with known signs and the
rest is local descent (`line_order`). How far the result can be trusted depends on the problem, and
`LineSearch.search` says it to the user:

- Exact. At ratio level, one source with complete, unweighted data: in every order the best points have a closed form,
  and dynamic programming over sets of stimuli finds the best of all orders. Proven, but for rounding.
- Exhaustive. Every order is tried, mirror images left out. Not proven: where orders are many, one is given up when its
  descent shows no hope of coming near the best that the heuristic found before; and the gaps within an order may have
  several local minima, so that those of the most promising orders are found by descent from two starts. (Only with
  complete, unweighted data of one source at ratio level are the best points within an order unique.)
- Heuristic. Minima of many starts, from which points are moved and exchanged as long as that lowers the stress, then a
  few are displaced at random and so on. Nothing is proven.

What a stricter level finds is a start of every looser one, so that the stress does not rise from ratio to interval,
spline, tied and untied ordinal scaling.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from joblib import Parallel, delayed
from scipy.spatial.distance import squareform
from scipy.stats import rankdata

from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds.descent import Run, Start, descend_all
from gloss_analysis.mds.disparities import Level, Ties
from gloss_analysis.mds.exchange import distinct
from gloss_analysis.mds.kernels import FIXED, Pairs
from gloss_analysis.mds.line_interchange import climb
from gloss_analysis.mds.line_order import best_points
from gloss_analysis.mds.line_orders import best_order, follow, sift
from gloss_analysis.mds.problem import Problem, make_problem
from gloss_analysis.mds.starts import random_start, torgerson_projections

__all__ = ["LineSearch", "search_line"]

_LADDER: tuple[tuple[Level, Ties], ...] = (
    ("ratio", "primary"), ("interval", "primary"), ("spline", "primary"), ("ordinal", "secondary"),
    ("ordinal", "primary"),
)  # fmt: skip

# Stimuli up to which dynamic programming is used: 2^n sets, 9 bytes each, n^2 sums a set.
_MOST_STIMULI_BY_SETS = 18
# Orders times pairs, for each start that was asked for, up to which all orders are tried. With the usual hundred starts
# that is ten stimuli of one source or nine of a dozen: a few seconds of one core.
_PAIRS_OF_ORDERS_A_START = 2e6
# A spline is projected onto by iteration, which takes this many times as long.
_SPLINE = 2.0
# Where they are so few, every order is followed to its end.
_PAIRS_OF_FEW_ORDERS_A_START = 5e4
# Evaluations that an order is given, orders kept of those that begin alike, followed to their end, and polished.
_SIFTING_STEPS, _SIFTING_STEPS_OF_FEW, _KEPT, _FOLLOWED, _POLISHED = 8, 60, 40, 400, 20
# An order is given up where it seems to end above this many times the best known objective, or starts above this many
# times it: in data sets tried, descent within an order lowered the objective by 14 per cent at most.
_MARGIN, _FARTHEST = 1.02, 1.4

# Pairs that interchange may measure at one level with a hundred starts: a fifth of a second of one core; a second or
# two where it takes that much to come to an end. With fewer starts less. Lines that it begins from.
_INTERCHANGE_PAIRS, _MOST_INTERCHANGE_PAIRS, _USUAL_STARTS = 2e7, 1.5e8, 100
_CLIMBS = 12
# Ends of a search that are starts of the next looser level.
_HANDED_ON = 6
_WIDTH, _STEPS = 48, 4
# Sweeps over orders one move away without which interchange is not begun, and those of a climb, by stimulus.
_FEWEST_SWEEPS, _SWEEPS_A_STIMULUS = 10, 1.0
_KICKED = 3

_SCREENING_STEPS, _POLISHING_STEPS, _POLISHING_ACCURACY = 60, 3000, 1e-12
_SAME_STRESS = 1e-6


@dataclass(frozen=True)
class LineSearch:
    """What was found on a line.

    Attributes
    ----------
    runs : list of Run
        Best first.
    n_starts : int
        Starts, or orders where all were tried.
    search : str
        How the order was sought, and how far that is proven: a sentence for users.
    """

    runs: list[Run]
    n_starts: int
    search: str


def search_line(problem: Problem, *, n_starts: int, seed: int, initial: Sequence[Start], n_jobs: int) -> LineSearch:
    """Find the points on a line that fit best.

    Parameters
    ----------
    problem : Problem
        Matrix-conditional: each source's scale is its own, so that all see the same line.
    n_starts : int
        Starts of the heuristic: projections of classical scaling, then random ones.
    seed : int
        Fixes what is random.
    initial : sequence of Start
        Further starts, coordinates of shape (n, 1).
    n_jobs : int
        Threads; the result does not depend on it.

    Returns
    -------
    LineSearch
    """
    n = problem.n_stimuli
    orders = math.factorial(n) // 2
    if _has_closed_form(problem) and n <= _MOST_STIMULI_BY_SETS:
        runs = _polished(problem, [_best_by_sets(problem)], n_jobs)
        return LineSearch(runs, 1, f"exact: the best of all {orders:,} orders of {n} stimuli, by dynamic programming")
    seeds = np.random.SeedSequence(seed).spawn(n_starts + 1)
    lines = torgerson_projections(problem.data, max(n_starts // 2, 1))
    lines += [random_start(n, 1, np.random.default_rng(child)) for child in seeds[len(lines) : n_starts]]
    given = [coordinates for coordinates, _ in initial]
    steps = _LADDER.index((problem.level, problem.ties if problem.level == "ordinal" else "primary"))
    below: list[np.ndarray] = []
    # What knows of ranks alone must not depend on values, even where it searches in vain.
    by_rank = problem.level == "ordinal"
    effort = min(n_starts / _USUAL_STARTS, 1.0)
    for level, ties in _LADDER[:steps]:
        stricter = make_problem(_ranked(problem) if by_rank else problem.data, level=level, ties=ties)
        if _has_closed_form(stricter) and n <= _MOST_STIMULI_BY_SETS:
            found = _polished(stricter, [_best_by_sets(stricter)], n_jobs)
        else:
            found = _climbed(stricter, given + below + lines, effort, seeds[-1], n_jobs)
        below = [run.coordinates for run in found[:_HANDED_ON]]
    work = _pairs_of_orders(problem)
    if work <= _PAIRS_OF_FEW_ORDERS_A_START * n_starts:
        runs = _all_orders(problem, given + below, np.inf, n_jobs)
    else:
        runs = _climbed(problem, given + below + lines, effort, seeds[-1], n_jobs)
    if work <= _PAIRS_OF_ORDERS_A_START * n_starts:
        if work > _PAIRS_OF_FEW_ORDERS_A_START * n_starts:
            runs = _all_orders(problem, [run.coordinates for run in runs], runs[0].value, n_jobs)
        return LineSearch(runs, orders, f"exhaustive: all {orders:,} orders of {n} stimuli were tried")
    count = len(given) + len(lines)
    return LineSearch(
        runs, count, f"heuristic: {count:,} starts, then moves and exchanges of stimuli; not proven to be the best"
    )


def _ranked(problem: Problem) -> Dissimilarities:
    ranks = np.full(problem.data.values.shape, np.nan)
    for row, order in zip(ranks, problem.orders, strict=True):
        row[order.judged] = order.block + 1.0
    return replace(problem.data, values=ranks)


def _pairs_of_orders(problem: Problem) -> float:
    """What trying all orders takes, in pairs measured once."""
    n = problem.n_stimuli
    if n > _MOST_STIMULI_BY_SETS:
        return math.inf  # a factorial too large for a float
    # To make an order and its points takes about as long as to measure some pairs.
    an_order = len(problem.pairs.first) * (_SPLINE if problem.level == "spline" else 1.0) + 4 * n
    return math.factorial(n) // 2 * an_order


def _has_closed_form(problem: Problem) -> bool:
    n, (judging,) = problem.n_stimuli, (np.flatnonzero(problem.pairs.share),)
    if problem.level != "ratio" or len(judging) != 1:
        return False
    own = slice(*problem.pairs.start[judging[0] : judging[0] + 2])
    weight = problem.pairs.weight[own]
    return len(weight) == n * (n - 1) // 2 and bool(np.all(weight == weight[0]))


def _best_by_sets(problem: Problem) -> np.ndarray:
    square, points = _pooled_dissimilarities(problem), np.empty(problem.n_stimuli)
    best_points(square, best_order(square), points)
    return points[:, np.newaxis]


def _pooled_dissimilarities(problem: Problem) -> np.ndarray:
    """Mean over sources of what their level trusts, ranks or values in units of their own, shape (n, n)."""
    total = np.zeros(problem.data.values.shape[1])
    mass = np.zeros_like(total)
    for order, share in zip(problem.orders, problem.source_shares, strict=True):
        if share > 0:
            values = rankdata(order.values) if problem.level == "ordinal" else order.values
            size = np.sqrt(np.mean(values**2)) or 1.0
            total[order.judged] += share * values / size
            mass[order.judged] += share
    pooled = np.divide(total, mass, out=np.zeros_like(total), where=mass > 0)
    pooled[mass == 0] = pooled[mass > 0].mean()
    return squareform(pooled)


def _line_pairs(problem: Problem) -> Pairs:
    """Pairs that name stimuli: all sources see the same line."""
    n = np.uint32(problem.n_stimuli)
    return problem.pairs._replace(first=problem.pairs.first % n, second=problem.pairs.second % n)


def _polished(problem: Problem, lines: Sequence[np.ndarray], n_jobs: int) -> list[Run]:
    return _descended(problem, lines, _POLISHING_STEPS, _POLISHING_ACCURACY, n_jobs)


def _descended(problem: Problem, lines: Sequence[np.ndarray], steps: int, relative: float, n_jobs: int) -> list[Run]:
    alike = np.ones((problem.n_sources, 1, 1))
    starts = [(line.reshape(-1, 1), alike) for line in lines]
    return descend_all(problem, starts, model=FIXED, steps=steps, relative=relative, n_jobs=n_jobs)


def _climbed(
    problem: Problem, lines: Sequence[np.ndarray], effort: float, seed: np.random.SeedSequence, n_jobs: int
) -> list[Run]:
    """Heuristic search: descent from all lines, interchange from some of their ends, best first."""
    runs = _descended(problem, lines, _SCREENING_STEPS, 1e-6, n_jobs)
    n, n_pairs = problem.n_stimuli, len(problem.pairs.first)
    sweep = _WIDTH * _STEPS
    cost = (n_pairs + 2 * n) * (_SPLINE if problem.level == "spline" else 1.0)
    a_climb = _SWEEPS_A_STIMULUS * n * sweep
    evaluations = int(effort * max(_INTERCHANGE_PAIRS / cost, min(2 * a_climb, _MOST_INTERCHANGE_PAIRS / cost)))
    if evaluations < _FEWEST_SWEEPS * sweep:
        return _polished(problem, [run.coordinates for run in runs[:_CLIMBS]], n_jobs)
    different = distinct(runs, _SAME_STRESS)
    climbs = int(np.clip(evaluations / a_climb, 1, min(_CLIMBS, len(different))))
    # Half of them the best, half spread over the others: interchange often gets further from a worse one.
    chosen = different[: (climbs + 1) // 2]
    rest = different[len(chosen) :]
    spread = rest[:: max(len(rest) // max(climbs // 2, 1), 1)][: climbs // 2]
    limit = evaluations // climbs
    pairs = _line_pairs(problem)
    kicks = [_kicks(n, limit // (2 * sweep), child) for child in _children(seed, climbs)]
    ends = Parallel(n_jobs=n_jobs, backend="threading")(
        delayed(climb)(pairs, run.coordinates[:, 0], kick, _WIDTH, _STEPS, limit)
        for run, kick in zip(chosen + spread, kicks, strict=False)
    )
    return _polished(problem, [x for _, x, _ in ends] + [run.coordinates for run in runs[:_CLIMBS]], n_jobs)


def _children(seed: np.random.SeedSequence, count: int) -> list[np.random.SeedSequence]:
    # Spawned afresh each time, so that every level kicks alike.
    return np.random.SeedSequence(entropy=seed.entropy, spawn_key=seed.spawn_key).spawn(count)


def _kicks(n: int, rounds: int, seed: np.random.SeedSequence) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, n, size=(rounds, _KICKED, 2))


def _all_orders(problem: Problem, known: Sequence[np.ndarray], value: float, n_jobs: int) -> list[Run]:
    """Try all orders; best first, among them what descent from the `known` lines finds, the best of them of `value`.

    Orders that have no hope to come near that value are given up; where it is infinite, none.
    """
    n, pairs = problem.n_stimuli, _line_pairs(problem)
    square = _pooled_dissimilarities(problem)
    steps = _SIFTING_STEPS if np.isfinite(value) else _SIFTING_STEPS_OF_FEW
    limit, goal = value * _FARTHEST, value * _MARGIN
    heads = [np.array([i, j]) for i in range(n) for j in range(n) if i != j]
    parallel = Parallel(n_jobs=n_jobs, backend="threading")
    found = parallel(delayed(sift)(pairs, square, head, steps, limit, goal, _KEPT) for head in heads)
    values, orders, points = (np.concatenate([part[index] for part in found]) for index in range(3))
    best = np.argsort(values, kind="stable")[:_FOLLOWED]
    parts = np.array_split(best, min(16, len(best)))
    ends = parallel(delayed(follow)(pairs, orders[part], points[part], 300, 1e-9) for part in parts)
    values, points = (np.concatenate([part[index] for part in ends]) for index in range(2))
    best = np.argsort(values, kind="stable")[:_POLISHED]
    return _polished(problem, [*points[best], *known[:_CLIMBS]], n_jobs)
