"""All starts of a search: classical scaling, random ones, and the ends of short runs of related problems."""

import numpy as np
from scipy.linalg import orthogonal_procrustes

from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds.conventions import group_conventions
from gloss_analysis.mds.descent import Start, descend_all, jittered
from gloss_analysis.mds.kernels import DIAGONAL, FIXED, FULL
from gloss_analysis.mds.line import search_line
from gloss_analysis.mds.problem import Problem, make_problem
from gloss_analysis.mds.restriction import FREE, Restriction
from gloss_analysis.mds.solution import MdsSolution, Model
from gloss_analysis.mds.starts import random_start, torgerson_configuration
from glossspace.errors import GlossError

__all__ = ["FEWEST_FOR_SIDE_RUNS", "all_starts", "free_part", "given_start"]

# Of so many starts, one also makes a run of each related problem, whose ends are starts; up to so many runs, of so many
# steps.
FEWEST_FOR_SIDE_RUNS = 10
_MOST_SIDE_RUNS, _SIDE_STEPS = 6, 160
_FREE_PART = {"identity": FIXED, "weighted": DIAGONAL, "generalised": FULL}


def free_part(problem: Problem, model: Model, restriction: Restriction) -> int:
    """What of the matrices C_k a model leaves free: kernels.FIXED, DIAGONAL or FULL.

    What distinguishes participants has nothing to say about a single one, unless the points are held in place.
    """
    alone = problem.conditional and np.count_nonzero(problem.source_shares) == 1
    return FIXED if alone and not restriction.has_scale else _FREE_PART[model]


def all_starts(
    problem: Problem, n_dims: int, model: Model, restriction: Restriction, n_starts: int, seed: int, n_jobs: int
) -> list[Start]:
    """`n_starts` starts, and those that related problems give; parameters as of `scale`."""
    data = problem.data
    n, m = len(data.stimuli), len(data.participants)
    seeds = np.random.SeedSequence(seed).spawn(n_starts)
    configurations = [torgerson_configuration(data, n_dims)]
    configurations += [random_start(n, n_dims, np.random.default_rng(child)) for child in seeds[1:]]
    alike = np.tile(np.eye(n_dims), (m, 1, 1))
    starts = [(jittered(one / (np.sqrt(np.mean(one**2)) or 1.0)), alike) for one in configurations]
    few = starts[: min(n_starts // FEWEST_FOR_SIDE_RUNS, _MOST_SIDE_RUNS)]
    if not few:
        return starts
    side: list[Start] = []
    free = free_part(problem, model, restriction)
    if free != FIXED:
        simpler = FIXED if free == DIAGONAL else DIAGONAL
        runs = descend_all(problem, few, model=simpler, steps=_SIDE_STEPS, restriction=restriction, n_jobs=n_jobs)
        side += [run.start for run in runs[:2]]
    if restriction.has_scale:
        side += _moved_into_place(problem, restriction, few, n_jobs)
    elif restriction.is_free and n_dims + 1 <= n - 1:
        side += _reduced(problem, n_dims, free, few, n_jobs)
    if n_dims == 1 and restriction.is_free:
        side += _from_the_line(problem, n_starts, seed, n_jobs)
    return starts + side


def _reduced(problem: Problem, n_dims: int, free: int, few: list[Start], n_jobs: int) -> list[Start]:
    """Ends of short runs with one dimension more, without the dimension that carries least."""
    m = problem.n_sources
    wider = []
    for index, (z, _) in enumerate(few):
        extra = np.random.default_rng(index).standard_normal((len(z), 1)) * np.sqrt(np.mean(z**2))
        wider.append((np.hstack([z, extra]), np.tile(np.eye(n_dims + 1), (m, 1, 1))))
    runs = descend_all(problem, wider, model=free, steps=_SIDE_STEPS // 2, n_jobs=n_jobs)
    counted = problem.source_shares > 0
    shown = {FIXED: "identity", DIAGONAL: "weighted", FULL: "generalised"}[free]
    reduced = []
    for run in runs[:3]:
        z, c = group_conventions(run.coordinates, run.transforms, counted, model=shown)
        reduced.append((jittered(z[:, :n_dims]), np.ascontiguousarray(c[:, :n_dims, :n_dims])))
    return reduced


def _moved_into_place(problem: Problem, restriction: Restriction, few: list[Start], n_jobs: int) -> list[Start]:
    """Ends of free runs, turned and stretched so that the fixed stimuli come near their places."""
    fixed, base = restriction.fixed, restriction.base
    if base is None or not fixed.any():
        return []
    placed = []
    for run in descend_all(problem, few, model=FIXED, steps=_SIDE_STEPS, restriction=FREE, n_jobs=n_jobs)[:2]:
        centre, target = run.coordinates[fixed].mean(axis=0), base[fixed].mean(axis=0)
        own, theirs = run.coordinates[fixed] - centre, base[fixed] - target
        turn, stretch = orthogonal_procrustes(own, theirs)
        size = stretch / np.sum(own**2) if np.sum(own**2) > 0 else 1.0
        placed.append((size * (run.coordinates - centre) @ turn + target, run.transforms))
    return placed


def _from_the_line(problem: Problem, n_starts: int, seed: int, n_jobs: int) -> list[Start]:
    """In one dimension with one transformation for all: what is best where each participant has one of its own."""
    data = problem.data
    own = make_problem(data, level=problem.level, ties=problem.ties)
    found = search_line(own, n_starts=n_starts, seed=seed, initial=[], n_jobs=n_jobs)
    return [run.start for run in found.runs]


def given_start(given: "np.ndarray | MdsSolution", data: Dissimilarities, n_dims: int) -> Start:
    """Start from a configuration or a solution of the same data.

    Raises
    ------
    GlossError
        It does not fit the data or the number of dimensions, or is not finite.
    """
    n, m = len(data.stimuli), len(data.participants)
    if isinstance(given, MdsSolution):
        empty = max(n_dims - given.n_dims, 0)
        coordinates = np.pad(given.coordinates, ((0, 0), (0, empty)))
        transforms = np.tile(np.eye(coordinates.shape[1]), (len(given.transforms), 1, 1))
        transforms[:, : given.n_dims, : given.n_dims] = given.transforms
    else:
        coordinates, transforms = np.asarray(given, dtype=float), np.tile(np.eye(n_dims), (m, 1, 1))
    fits = coordinates.shape == (n, n_dims) and transforms.shape == (m, n_dims, n_dims)
    if not fits or not np.all(np.isfinite(coordinates)):
        raise GlossError(
            f"A starting configuration must be finite and of shape {(n, n_dims)}, not {coordinates.shape}; "
            "a starting solution must be one of the same data."
        )
    return jittered(coordinates), transforms
