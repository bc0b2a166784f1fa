"""Three-way non-metric multidimensional scaling: the best of many starts.

Minimises the objective of `objective` over coordinates and, in the weighted and generalised models, over what
distinguishes the participants, in two stages: short runs from all starts, then the best are polished. Then points of
the best exchange places for as long as that helps (`exchange`). One dimension, where points cannot pass each other, has
a search of its own (`line`). `smacof` is the readable majorization twin.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from threadpoolctl import threadpool_limits

from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds.conventions import group_conventions, scaled_transforms, signed
from gloss_analysis.mds.descent import Run, descend_all
from gloss_analysis.mds.diagnostics import check_scalable, data_warnings, position_warnings, solution_warnings
from gloss_analysis.mds.disparities import Level, Ties
from gloss_analysis.mds.exchange import exchange_points
from gloss_analysis.mds.kernels import FIXED
from gloss_analysis.mds.line import search_line
from gloss_analysis.mds.objective import fitted_disparities, mean_square_stress, source_distances, stress_of_sources
from gloss_analysis.mds.problem import Problem, make_problem
from gloss_analysis.mds.restriction import FREE, Restriction
from gloss_analysis.mds.solution import MODELS, MdsSolution, Model
from gloss_analysis.mds.start_sets import FEWEST_FOR_SIDE_RUNS, all_starts, free_part, given_start
from glossspace.errors import GlossError

__all__ = ["scale"]

_SCREENING_STEPS = 40
_POLISHED = 10
_POLISHING_STEPS = 3000
# Below the accuracy that two programs can be compared with, above rounding.
_POLISHING_ACCURACY = 1e-10
# Two starts found the same minimum when their objectives agree to this part: far below what a change of order costs.
_SAME_STRESS = 1e-6
# Of so many starts, one exchange of points in each round.
_STARTS_AN_EXCHANGE = 5
_MOST_STARTS = 1_000_000


def scale(
    data: Dissimilarities,
    *,
    n_dims: int,
    model: Model = "weighted",
    level: Level = "ordinal",
    ties: Ties = "primary",
    conditional: bool = True,
    restriction: Restriction = FREE,
    n_starts: int = 100,
    seed: int = 1,
    initial: Sequence["np.ndarray | MdsSolution"] = (),
    n_jobs: int = 1,
) -> MdsSolution:
    """Find the configuration of `n_dims` dimensions whose distances best follow the judged dissimilarities.

    Parameters
    ----------
    data : Dissimilarities
        m participants, n >= 3 stimuli; pairs may be missing or weighted, participants too.
    n_dims : int
        1 to n - 1.
    model : {"weighted", "identity", "generalised"}
        Whether participants weight the dimensions of the common space (INDSCAL), all see the same space, or each sees a
        linear transformation of it (IDIOSCAL). The weighted solution is fixed up to order and sign of its dimensions;
        the others may be rotated at will.
    level : {"ordinal", "spline", "interval", "ratio"}
        What of the dissimilarities is trusted; see `disparities`.
    ties : {"primary", "secondary"}
        Ordinal only: whether equal judgements may have different disparities.
    conditional : bool
        Whether each participant has a transformation of its own (matrix-conditional). If not, all judgements are on one
        scale and share one transformation.
    restriction : Restriction
        Some stimuli fixed, or coordinates made of external variables (`fixed_stimuli`, `external_variables`).
    n_starts : int
        Classical scaling, then random configurations. From ten up, ends of short runs of simpler models and of one
        dimension more are starts too, and points of the best solutions are exchanged. Noisy judgements of few stimuli
        have many minima: where `best_hits` is low, give more starts.
    seed : int
        Fixes the random starts; the result does not depend on `n_jobs`.
    initial : sequence of ndarray, shape (n, n_dims), or MdsSolution
        Further starts. A solution of the same data brings its weights along; where it has fewer dimensions, the others
        start empty.
    n_jobs : int
        Threads to use (joblib), -1 for one a core.

    Returns
    -------
    MdsSolution

    Raises
    ------
    GlossError
        A parameter is not allowed, or the data cannot determine a configuration.

    Notes
    -----
    The objective is mean_k [1 - |P_k d_k|^2 / |d_k|^2] (see `objective`). In one dimension the problem is
    combinatorial: `search` of the solution says whether all orders of the stimuli were tried. Each participant's scale
    being free, weights cannot matter there.

    Examples
    --------
    >>> import numpy as np
    >>> from gloss_analysis.judgements.dissimilarity import Dissimilarities
    >>> square = Dissimilarities(("a", "b", "c", "d"), ("1",), np.array([[1.0, 2.0, 1.0, 1.0, 2.0, 1.0]]))
    >>> bool(scale(square, n_dims=2, model="identity", level="ordinal", ties="secondary").stress1 < 1e-6)
    True
    """
    _check(data, n_dims, model, n_starts, seed, n_jobs, restriction)
    check_scalable(data, level=level, ties=ties)
    # BLAS adds in another order on other numbers of threads, and matrices of this size gain nothing from several.
    with threadpool_limits(limits=1):
        problem = make_problem(data, level=level, ties=ties, conditional=conditional)
        return _search(problem, n_dims, model, restriction, n_starts, seed, initial, n_jobs)


def _search(
    problem: Problem,
    n_dims: int,
    model: Model,
    restriction: Restriction,
    n_starts: int,
    seed: int,
    initial: "Sequence[np.ndarray | MdsSolution]",
    n_jobs: int,
) -> MdsSolution:
    given = [given_start(one, problem.data, n_dims) for one in initial]
    if n_dims == 1 and restriction.is_free and problem.conditional:
        found = search_line(problem, n_starts=n_starts, seed=seed, initial=given, n_jobs=n_jobs)
        return _described(problem, found.runs, model, n_dims, restriction, found.n_starts, found.search)
    # About the origin and of unit size, where the solver is at its best; undone at the end.
    laid_down, centre, size = restriction.standardised()
    given = [((coordinates - centre) / size, transforms) for coordinates, transforms in given]
    starts = given + all_starts(problem, n_dims, model, laid_down, n_starts, seed, n_jobs)
    free = free_part(problem, model, laid_down)
    promising = starts
    if len(starts) > _POLISHED:
        screened = descend_all(
            problem, starts, model=free, steps=_SCREENING_STEPS, restriction=laid_down, n_jobs=n_jobs
        )
        promising = [run.start for run in screened[:_POLISHED]]
    runs = descend_all(
        problem,
        promising,
        model=free,
        steps=_POLISHING_STEPS,
        restriction=laid_down,
        relative=_POLISHING_ACCURACY,
        n_jobs=n_jobs,
    )
    search = "best of the starts"
    if n_starts >= FEWEST_FOR_SIDE_RUNS:
        search = "best of many starts and of exchanges"
        best = exchange_points(
            problem,
            runs,
            model=free,
            restriction=laid_down,
            tries=n_starts // _STARTS_AN_EXCHANGE,
            steps=_POLISHING_STEPS,
            relative=_POLISHING_ACCURACY,
            same=_SAME_STRESS,
            rng=np.random.default_rng(np.random.SeedSequence(seed).spawn(n_starts + 1)[-1]),
            n_jobs=n_jobs,
        )
        runs = [best, *(run for run in runs if run is not best)]
    runs = [replace(run, coordinates=restriction.kept(centre + size * run.coordinates)) for run in runs]
    return _described(problem, runs, model, n_dims, restriction, len(starts), search)


def _check(
    data: Dissimilarities, n_dims: int, model: str, n_starts: int, seed: int, n_jobs: int, restriction: Restriction
) -> None:
    if not isinstance(data, Dissimilarities):
        raise GlossError(
            f"Scaling needs Dissimilarities, not {type(data).__name__}. `from_matrices` makes them of matrices."
        )
    n = len(data.stimuli)
    for name, value in (("n_dims", n_dims), ("n_starts", n_starts), ("seed", seed), ("n_jobs", n_jobs)):
        if isinstance(value, bool) or not isinstance(value, int | np.integer):
            raise GlossError(f"Invalid {name} = {value!r}. Allowed: a whole number.")
    if model not in MODELS:
        raise GlossError(f"Invalid model = {model!r}. Allowed: {', '.join(map(repr, MODELS))}.")
    if not 1 <= n_dims <= n - 1:
        raise GlossError(f"Invalid number of dimensions = {n_dims}. Allowed: 1 to {n - 1} for {n} stimuli.")
    if not 1 <= n_starts <= _MOST_STARTS:
        raise GlossError(f"Invalid number of starts = {n_starts}. Allowed: 1 to {_MOST_STARTS:,}.")
    if seed < 0:
        raise GlossError(f"Invalid seed = {seed}. Allowed: 0 or more.")
    if n_jobs == 0:
        raise GlossError("Invalid n_jobs = 0. Allowed: the number of threads, or -1 for one a core.")
    base, design = restriction.base, restriction.design
    if base is not None and base.shape != (n, n_dims):
        raise GlossError(f"Fixed coordinates of shape {base.shape} do not fit {n} stimuli in {n_dims} dimensions.")
    if base is not None and design is not None and design.shape[1] == 0 and np.all(np.ptp(base, axis=0) == 0):
        raise GlossError(
            "All stimuli are fixed on one point, where no distances are. Fix them apart, or leave some free."
        )
    if design is not None and len(design) != n:
        raise GlossError(f"External variables for {len(design)} stimuli do not fit {n} stimuli.")
    if design is not None and base is None and np.linalg.matrix_rank(design) < n_dims:
        raise GlossError(
            f"{design.shape[1]} external variables span {np.linalg.matrix_rank(design)} dimensions, too few for "
            f"{n_dims}."
        )


def _described(
    problem: Problem, runs: list[Run], model: Model, n_dims: int, restriction: Restriction, n_starts: int, search: str
) -> MdsSolution:
    data, winner = problem.data, runs[0]
    counted = problem.source_shares > 0
    shown: Model = "identity" if n_dims > 1 and free_part(problem, model, restriction) == FIXED else model
    coordinates, transforms = winner.coordinates, winner.transforms
    one_scale = not problem.conditional
    if restriction.has_scale:
        transforms = scaled_transforms(coordinates, transforms, counted, model=shown, one_scale=one_scale)
    elif one_scale and shown != "identity":
        # Sizes of participants' spaces mean something there: only the group space is put in order.
        coordinates, transforms = _one_scale(coordinates, transforms, counted, shown)
    else:
        coordinates, transforms = group_conventions(coordinates, transforms, counted, model=shown)
    distances = source_distances(coordinates, transforms)
    stress1 = float(np.sqrt(mean_square_stress(problem, coordinates, transforms)))
    return MdsSolution(
        stimuli=data.stimuli,
        participants=data.participants,
        n_dims=n_dims,
        model=model,
        level=problem.level,
        ties=problem.ties,
        conditional=problem.conditional,
        restricted=not restriction.is_free,
        coordinates=coordinates,
        dimension_weights=np.linalg.norm(transforms, axis=2),
        transforms=transforms,
        stress1=stress1,
        source_stress1=stress_of_sources(problem, coordinates, transforms),
        distances=distances,
        disparities=fitted_disparities(problem, distances),
        dissimilarities=np.where(data.judged, data.values, np.nan),
        pair_weights=data.weights / max(data.weights.max(), np.finfo(float).tiny),
        source_shares=problem.source_shares,
        starts=n_starts,
        best_hits=sum(run.value <= winner.value * (1 + _SAME_STRESS) + _SAME_STRESS**2 for run in runs),
        start_stress1=np.sqrt([max(run.value, 0.0) for run in runs]),
        search=search,
        converged=winner.converged,
        warnings=data_warnings(data, level=problem.level, ties=problem.ties)
        + (position_warnings(data, n_dims) if restriction.is_free else ())
        + solution_warnings(problem, distances, n_dims, stress1),
    )


def _one_scale(
    coordinates: np.ndarray, transforms: np.ndarray, counted: np.ndarray, model: Model
) -> tuple[np.ndarray, np.ndarray]:
    """Conventions where the sizes of participants' spaces are part of the solution: their root mean square is 1."""
    z = coordinates - coordinates.mean(axis=0)
    group = np.sqrt(np.mean(np.sum(transforms[counted] ** 2, axis=2), axis=0))
    group = np.where(group > 0, group, 1.0)
    z, c = z * group, transforms / group[:, np.newaxis]
    size = np.sqrt(np.sum(np.mean(z**2, axis=0)))
    z = z / (size if size > 0 else 1.0)
    if model == "weighted":
        order = np.argsort(-np.mean(z**2, axis=0), kind="stable")
        z, c = signed(z[:, order]), c[:, order][:, :, order]
    return z, scaled_transforms(z, c, counted, model=model, one_scale=True)
