"""Three-way non-metric multidimensional scaling by variable projection.

Minimises the objective of `objective` over coordinates and, in the weighted model, over each participant's dimension
weights (INDSCAL), with SciPy's L-BFGS from many starts in two stages: short runs for all, then the best are polished.
In one dimension, where points cannot pass each other, minima are also improved by interchange of points. `smacof` is
the readable majorization twin.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal, TypeAlias

import numpy as np
from joblib import Parallel, delayed
from scipy.optimize import minimize
from threadpoolctl import threadpool_limits

from gloss_analysis.disparities import Level, Ties, disparities
from gloss_analysis.dissimilarity import Dissimilarities
from gloss_analysis.judgeability import check_scalable, data_warnings, solution_warnings
from gloss_analysis.objective import (
    Problem,
    make_problem,
    mean_square_stress,
    source_distances,
    stress_and_gradient,
    stress_of_sources,
)
from gloss_analysis.starts import interchanged, random_start, torgerson_configuration, torgerson_projections
from glossspace.errors import GlossError

__all__ = ["MODELS", "MdsSolution", "Model", "scale"]

Model: TypeAlias = Literal["identity", "weighted"]
MODELS: tuple[Model, ...] = ("identity", "weighted")

_SCREENING_STEPS = 40
_POLISHED = 8
_POLISHING_STEPS = 2000
# Two starts found the same minimum when their objectives agree to this: far below what a change of order costs.
_SAME_STRESS = 1e-6
# Interchange of points on a line: how many promising new orders are weighed, and how many of these tried out.
_WEIGHED_ORDERS = 60
_TRIED_ORDERS = 8


@dataclass(frozen=True)
class MdsSolution:
    """A configuration with what a careful analyst needs to judge it.

    Attributes
    ----------
    stimuli, participants : tuple of str
    n_dims : int
    model, level, ties : str
        What was assumed; see `scale`.
    coordinates : ndarray, shape (n, n_dims)
        The group space: centred, dimensions in the order of their variance, total mean square 1.
    dimension_weights : ndarray, shape (m, n_dims)
        How much each participant stretches each dimension, >= 0; ones in the identity model. Each participant's own
        space has total mean square 1, and the root mean square over participants is 1 in every dimension, so that the
        group space is the space of the average participant.
    stress1 : float
        Root of the mean over participants of Stress-1 squared, each at its own scale.
    source_stress1 : ndarray, shape (m,)
        Kruskal's Stress-1 of each participant.
    starts, best_hits : int
        How many starts were made, and how many of those that were polished ended at the best stress.
    start_stress1 : ndarray
        Stress of every polished start, best first.
    converged : bool
        Whether the best run ended by itself rather than at its step limit.
    warnings : tuple of str
        What speaks against reading the solution at face value.
    """

    stimuli: tuple[str, ...]
    participants: tuple[str, ...]
    n_dims: int
    model: Model
    level: Level
    ties: Ties
    coordinates: np.ndarray
    dimension_weights: np.ndarray
    stress1: float
    source_stress1: np.ndarray
    starts: int
    best_hits: int
    start_stress1: np.ndarray
    converged: bool
    warnings: tuple[str, ...]

    @property
    def normalized_raw_stress(self) -> float:
        """Mean over participants of Stress-1 squared: PROXSCAL's normalised raw stress at each participant's scale."""
        return self.stress1**2


def scale(
    data: Dissimilarities,
    *,
    n_dims: int,
    model: Model = "weighted",
    level: Level = "ordinal",
    ties: Ties = "primary",
    n_starts: int = 30,
    seed: int = 1,
    initial: Sequence["np.ndarray | MdsSolution"] = (),
    n_jobs: int = 1,
) -> MdsSolution:
    """Find the configuration of `n_dims` dimensions whose distances best follow the judged dissimilarities.

    Parameters
    ----------
    data : Dissimilarities
        m participants, n >= 3 stimuli; pairs may be missing.
    n_dims : int
        1 to n - 1.
    model : {"weighted", "identity"}
        Whether participants weight the dimensions of the common space (INDSCAL) or all see the same space. The weighted
        solution is fixed up to order and sign of its dimensions; the identity solution may be rotated at will.
    level : {"ordinal", "interval", "ratio"}
        What of the dissimilarities is trusted, for each participant by itself (matrix-conditional).
    ties : {"primary", "secondary"}
        Ordinal only: whether equal judgements may have different disparities.
    n_starts : int
        Classical scaling, then random configurations. In one dimension half of them are classical scaling seen from
        different directions. Noisy judgements of few stimuli have many minima: where `best_hits` is low, give more
        starts. (Of 170 solutions of published data, 30 starts missed the lowest of 600 by .0001 to .002 in seven.)
    seed : int
        Fixes the random starts; the result does not depend on `n_jobs`.
    initial : sequence of ndarray, shape (n, n_dims), or MdsSolution
        Further starts. A solution of the same data brings its weights along; where it has fewer dimensions, the others
        start empty.
    n_jobs : int
        Processes to use (joblib).

    Returns
    -------
    MdsSolution

    Raises
    ------
    GlossError
        A parameter is not allowed, or the data cannot determine a configuration.

    Notes
    -----
    The objective is mean_k [1 - |P_k d_k|^2 / |d_k|^2] (see `objective`). In one dimension the problem is combinatorial
    and this search heuristic: points of eight minima are moved and interchanged for as long as that lowers the
    stress, and the best is reported, not proven. Each participant's scale being free, weights cannot matter there.

    Examples
    --------
    >>> import numpy as np
    >>> from gloss_analysis.dissimilarity import Dissimilarities
    >>> square = Dissimilarities(("a", "b", "c", "d"), ("1",), np.array([[1.0, 2.0, 1.0, 1.0, 2.0, 1.0]]))
    >>> bool(scale(square, n_dims=2, model="identity", level="ordinal", ties="secondary").stress1 < 1e-6)
    True
    """
    n, m = len(data.stimuli), len(data.participants)
    if model not in MODELS:
        raise GlossError(f"Invalid model = {model!r}. Allowed: {', '.join(map(repr, MODELS))}.")
    if not 1 <= n_dims <= n - 1:
        raise GlossError(f"Invalid number of dimensions = {n_dims}. Allowed: 1 to {n - 1} for {n} stimuli.")
    if n_starts < 1:
        raise GlossError(f"Invalid number of starts = {n_starts}. Allowed: 1 or more.")
    if seed < 0:
        raise GlossError(f"Invalid seed = {seed}. Allowed: 0 or more.")
    if n_jobs == 0:
        raise GlossError("Invalid n_jobs = 0. Allowed: the number of processes, or -1 for one a core.")
    check_scalable(data, level=level, ties=ties)
    problem = make_problem(data, level=level, ties=ties)
    weighted = model == "weighted"

    # BLAS adds in another order on other numbers of threads, and matrices of this size gain nothing from several.
    with threadpool_limits(limits=1):
        starts = _all_starts(data, n_dims, n_starts, seed, initial)
        free_weights = weighted and n_dims > 1
        screened = _run_all(problem, starts, free_weights, _SCREENING_STEPS, n_jobs)
        chosen = _spread_out(screened) if n_dims == 1 else screened
        best = [(run.coordinates, run.weights) for run in chosen[:_POLISHED]]
        polished = _run_all(problem, best, free_weights, _POLISHING_STEPS, n_jobs)
        if n_dims == 1:
            improved = Parallel(n_jobs=n_jobs)(delayed(_interchange)(problem, run) for run in polished)
            polished = sorted(improved, key=lambda run: run.value)
        winner = polished[0]
        coordinates, weights = _normalised(winner.coordinates, winner.weights, weighted=weighted)
        distances = source_distances(problem, coordinates, weights)
        stress1 = float(np.sqrt(mean_square_stress(problem, distances)))
    return MdsSolution(
        stimuli=data.stimuli,
        participants=data.participants,
        n_dims=n_dims,
        model=model,
        level=level,
        ties=ties,
        coordinates=coordinates,
        dimension_weights=weights if weighted else np.ones((m, n_dims)),
        stress1=stress1,
        source_stress1=stress_of_sources(problem, distances),
        starts=len(starts),
        best_hits=sum(run.value <= winner.value + _SAME_STRESS for run in polished),
        start_stress1=np.sqrt([max(run.value, 0.0) for run in polished]),
        converged=winner.converged,
        warnings=data_warnings(data, level=level, ties=ties) + solution_warnings(problem, distances, n_dims, stress1),
    )


@dataclass(frozen=True)
class _Run:
    value: float
    coordinates: np.ndarray
    weights: np.ndarray
    converged: bool


_Start: TypeAlias = tuple[np.ndarray, np.ndarray]  # coordinates, dimension weights


def _all_starts(
    data: Dissimilarities, n_dims: int, n_starts: int, seed: int, initial: Sequence[np.ndarray | MdsSolution]
) -> list[_Start]:
    n, m = len(data.stimuli), len(data.participants)
    starts = [_given_start(given, n, m, n_dims) for given in initial]
    if n_dims == 1:
        configurations = torgerson_projections(data, max(n_starts // 2, 1))
    else:
        configurations = [torgerson_configuration(data, n_dims)]
    seeds = np.random.SeedSequence(seed).spawn(n_starts - len(configurations))
    configurations += [random_start(n, n_dims, np.random.default_rng(child)) for child in seeds]
    return starts + [(configuration, np.ones((m, n_dims))) for configuration in configurations]


def _given_start(given: np.ndarray | MdsSolution, n: int, m: int, n_dims: int) -> _Start:
    if isinstance(given, MdsSolution):
        empty = ((0, 0), (0, max(n_dims - given.n_dims, 0)))
        coordinates = np.pad(given.coordinates, empty)
        weights = np.pad(given.dimension_weights, empty, constant_values=1.0)
    else:
        coordinates, weights = np.asarray(given, dtype=float), np.ones((m, n_dims))
    if coordinates.shape != (n, n_dims) or weights.shape != (m, n_dims) or not np.all(np.isfinite(coordinates)):
        raise GlossError(
            f"A starting configuration must be finite and of shape {(n, n_dims)}, not {coordinates.shape}; "
            "a starting solution must be one of the same data."
        )
    return coordinates, weights


def _run_all(problem: Problem, starts: Sequence[_Start], weighted: bool, steps: int, n_jobs: int) -> list[_Run]:
    """Minimise from all starts; best first."""
    runs = Parallel(n_jobs=n_jobs)(delayed(_minimise_on_one_thread)(problem, *s, weighted, steps) for s in starts)
    return sorted(runs, key=lambda run: run.value)


def _minimise_on_one_thread(*arguments: Any) -> _Run:
    with threadpool_limits(limits=1):  # a worker process has limits of its own
        return _minimise(*arguments)


def _spread_out(runs: Sequence[_Run]) -> list[_Run]:
    """Different minima from the best to the worst: on a line, interchange gets further than from the best alone."""
    different = [runs[0], *(run for before, run in pairwise(runs) if run.value > before.value + _SAME_STRESS)]
    return different[:: max(len(different) // _POLISHED, 1)]


def _interchange(problem: Problem, run: _Run) -> _Run:
    """Move and exchange points on a line for as long as that lowers the stress.

    A new order shows its worth only when its points have settled and the disparities with them. So the orders are
    sifted: by the stress that the present disparities promise, then by their stress as they stand, then by letting them
    settle.
    """
    with threadpool_limits(limits=1):
        better: _Run | None = run
        while better is not None:
            run = better
            promising = interchanged(run.coordinates, _pooled_disparities(problem, run))[:_WEIGHED_ORDERS]
            worth = [mean_square_stress(problem, source_distances(problem, z, run.weights)) for z in promising]
            tried = (
                _minimise(problem, promising[index], run.weights, False, _POLISHING_STEPS)
                for index in np.argsort(worth, kind="stable")[:_TRIED_ORDERS]
            )
            better = next((new for new in tried if new.value < run.value - _SAME_STRESS), None)
        return run


def _pooled_disparities(problem: Problem, run: _Run) -> np.ndarray:
    """Mean over sources of their disparities on a line, condensed; the distance itself where a pair was not judged."""
    pooled = source_distances(problem, run.coordinates, run.weights)
    for d, order in zip(pooled, problem.orders, strict=True):
        d[order.judged] = disparities(d[order.judged], order, level=problem.level, ties=problem.ties)
    return pooled.mean(axis=0)


def _minimise(problem: Problem, coordinates: np.ndarray, start_weights: np.ndarray, weighted: bool, steps: int) -> _Run:
    n, p = coordinates.shape
    m = problem.n_sources
    # Unit mean square puts all parameters on one scale, which L-BFGS needs; the objective does not change.
    centred = coordinates - coordinates.mean(axis=0)
    size = np.sqrt(np.mean(centred**2))
    start = centred / size if size > 0 else centred
    # Dimensions that a start leaves empty would have no gradient and stay empty.
    jitter = np.random.default_rng(0).standard_normal(start.shape)
    start = start + 1e-3 * jitter * (np.ptp(start, axis=0) == 0)

    def unpack(theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return theta[: n * p].reshape(n, p), theta[n * p :].reshape(m, p) if weighted else start_weights

    def loss(theta: np.ndarray) -> tuple[float, np.ndarray]:
        z, w = unpack(theta)
        value, by_coordinates, by_weights = stress_and_gradient(problem, z, w)
        parts = [by_coordinates.ravel(), by_weights.ravel()] if weighted else [by_coordinates.ravel()]
        return value, np.concatenate(parts)

    theta = np.concatenate([start.ravel(), start_weights.ravel()]) if weighted else start.ravel()
    options = {"maxiter": steps, "maxfun": 4 * steps, "ftol": 1e-11, "gtol": 1e-8, "maxcor": 20}
    found = minimize(loss, theta, jac=True, method="L-BFGS-B", options=options)
    z, w = unpack(found.x)
    # Status 1 is the step limit; 0 and 2 (no further descent at a kink of the monotone regression) are ends.
    return _Run(float(found.fun), z, w, converged=found.status != 1)


def _normalised(coordinates: np.ndarray, weights: np.ndarray, *, weighted: bool) -> tuple[np.ndarray, np.ndarray]:
    """Bring a solution to the conventions that `MdsSolution` states; distances change by a factor per source only."""
    z = coordinates - coordinates.mean(axis=0)
    if not weighted:
        # Any rotation fits equally well: principal axes are the one that everybody can reproduce.
        _, _, axes = np.linalg.svd(z, full_matrices=False)
        z = _signed(z @ axes.T)
        size = np.sqrt(np.sum(np.mean(z**2, axis=0)))
        return z / size, np.ones_like(weights)
    w = np.abs(weights)
    mean_square = np.mean(z**2, axis=0)
    own_size = np.sqrt(w**2 @ mean_square)
    w = w / np.where(own_size > 0, own_size, 1.0)[:, np.newaxis]
    group = np.sqrt(np.mean(w**2, axis=0))
    group = np.where(group > 0, group, 1.0)
    z, w = z * group, w / group
    # Every participant's space now has total mean square 1, and so has the average one.
    order = np.argsort(-np.mean(z**2, axis=0), kind="stable")
    return _signed(z[:, order]), w[:, order]


def _signed(coordinates: np.ndarray) -> np.ndarray:
    """Reflect each dimension so that its point farthest from the centre is positive."""
    extreme = coordinates[np.argmax(np.abs(coordinates), axis=0), np.arange(coordinates.shape[1])]
    return coordinates * np.where(extreme < 0, -1.0, 1.0)
