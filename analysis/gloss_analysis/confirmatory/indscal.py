"""Confirmatory INDSCAL: given axes, each participant's own weights, one common objective.

With the coordinates given and a scale and transformation for every participant, the participants have nothing in
common: the INDSCAL solution *is* the individual fits of `scaling`, and its stress is their root mean square. What
a common objective adds is said here:

1. by how much own weights fit better than one set for all, and whether by more than noise makes them (a permutation
   test);
2. weights in INDSCAL's convention, which can be compared between axes and studies;
3. the axes that the participants' differences ask for among all linear combinations of the given ones (CANDELINC:
   Carroll, Pruzansky and Kruskal 1980): INDSCAL's dimensions cannot be turned, so they may contradict the given axes;
4. all participants on one transformation (unconditional), where the fits do not come apart.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import linear_sum_assignment

from gloss_analysis.axes.indscal_conventions import converted
from gloss_analysis.confirmatory.axis_weights import fit_axis_weights
from gloss_analysis.confirmatory.residual_permutation import permuted_residuals
from gloss_analysis.confirmatory.scaling import confirm_axes
from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds import external_variables, fixed_stimuli, scale
from gloss_analysis.mds.disparities import Level, Ties
from gloss_analysis.mds.objective import source_distances
from gloss_analysis.mds.problem import Problem, make_problem
from gloss_analysis.replicates import OnStep, in_parallel, no_step
from glossspace.errors import GlossError

__all__ = ["ConfirmatoryIndscal", "confirm_indscal"]

_ALPHA = 0.05
# Stress squared that rounding cannot tell from 0, and drops that it cannot tell apart.
_ROUNDING = 1e-12
# With the coordinates held in place or nearly so, few starts reach the lowest stress; the test of the module checks it.
_STARTS = 20


@dataclass(frozen=True)
class ConfirmatoryIndscal:
    """Own weights of the participants, beside one set for all.

    Attributes
    ----------
    axes : tuple of str, length p
    participants : tuple of str, length m
        Those whose weights could be fitted.
    conditional : bool
        Whether each participant has a transformation and a scale of his own.
    stress1 : float
        Of the common objective with own weights: root mean square of the participants' Stress-1.
    stress1_shared : float
        The same with one set of weights for all.
    share_taken : float
        Part of the mean square stress of shared weights that own weights take away, 0 to 1.
    squared_weights : ndarray, shape (m, p)
        What INDSCAL prints as weights, in its convention (`unit_sum_of_squares` of `axes.indscal_conventions`): they
        multiply squared differences along axes of sum of squares 1.
    stress1_combined : float or None
        With the axes that fit best among all linear combinations of the given ones. None with one axis or participant.
    angles : ndarray, shape (p,), or None
        Degrees between each given axis and the combined axis that stands for it, 0 to 90, in units of the axes'
        standard deviations. Hardly determined where all participants weigh alike.
    null : ndarray, shape (n_permutations,)
        `share_taken` of each permutation.
    p_value : float or None
        (b + 1) / (n_permutations + 1), b being the number of permutations that take as much; None without any.
    """

    axes: tuple[str, ...]
    participants: tuple[str, ...]
    conditional: bool
    stress1: float
    stress1_shared: float
    share_taken: float
    squared_weights: np.ndarray
    stress1_combined: float | None
    angles: np.ndarray | None
    null: np.ndarray
    p_value: float | None

    @property
    def sentences(self) -> tuple[str, ...]:
        """The result in words."""
        transformation = "" if self.conditional else ", one transformation for all"
        taken = (
            f"INDSCAL: own weights{transformation}: Stress-1 {self.stress1:.4f}; shared: {self.stress1_shared:.4f}. "
            f"Own weights take away {100 * self.share_taken:.1f} % of the mean square stress"
        )
        n = len(self.null)
        if self.p_value is None:
            found = [f"{taken}."]
        else:
            verdict = (
                "more than noise does: participants weigh the axes differently"
                if self.p_value <= _ALPHA
                else "no more than noise may: nothing here says that participants weigh the axes differently"
            )
            median = 100 * np.median(self.null)
            found = [f"{taken}, {median:.1f} % in the median of {n} permutations (p = {self.p_value:.3g}), {verdict}."]
            if 1 / (n + 1) > _ALPHA:
                found.append(f"With {n} permutations p cannot be below {_ALPHA:g}. Take 199 or more.")
        if self.angles is not None:
            angles = ", ".join(f"{angle:.0f}° from {axis}" for axis, angle in zip(self.axes, self.angles, strict=True))
            alike = self.p_value is not None and self.p_value > _ALPHA
            how = "hardly determined where all weigh alike; " if alike else ""
            found.append(
                f"The best combinations of these axes lie {angles} ({how}Stress-1 {self.stress1_combined:.4f})."
            )
        return tuple(found)


def confirm_indscal(
    data: Dissimilarities,
    coordinates: np.ndarray,
    *,
    axes: tuple[str, ...],
    level: Level = "ordinal",
    ties: Ties = "primary",
    conditional: bool = True,
    n_permutations: int = 0,
    seed: int = 1,
    n_jobs: int = 1,
    on_step: OnStep = no_step,
) -> ConfirmatoryIndscal:
    """Fit each participant's own weights of given axes under the common objective, and compare with shared ones.

    Parameters
    ----------
    data : Dissimilarities
        n stimuli.
    coordinates : ndarray, shape (n, p)
    axes : tuple of str, length p
    level, ties
        See `gloss_analysis.mds.scale`.
    conditional : bool
        Whether each participant has a transformation and a scale of his own. If not, all judgements are on one scale.
    n_permutations : int
        0 for no test; p is no finer than 1 / (n_permutations + 1). Needs conditional fits. There is no test of a single
        participant, or of a single axis.
    seed : int
        Of the permutations, and of the starts; the result does not depend on `n_jobs`.
    n_jobs : int
        Threads (joblib), -1 for one a core.
    on_step : callable
        Called with the number of permutations done and of all.

    Returns
    -------
    ConfirmatoryIndscal

    Raises
    ------
    GlossError
        A negative number of permutations, permutations of unconditional fits, or what `confirm_axes` refuses.

    Notes
    -----
    **The test.** Judgements are drawn for which one set of weights is true for all (`permuted_residuals` about the
    shared fit), so that each participant's response curve, noise and answers stay as they are. Own weights always fit
    better; p is how often they take as large a part of the stress where they are noise.
    It errs on the safe side where stimuli lie on a grid and judgements are few and fine: in 400 simulated studies of
    five participants who weighed alike, 66 pairs and noise of 5 on a slider of 100, p was .05 or less in 1.5 %; with
    places at random in 4.8 % (``benchmarks/confirm_claims.py``).

    **Shared weights** are those that minimise the common objective, and biased upwards where participants differ (see
    `gloss_analysis.confirmatory.scaling`). Here they are only what own weights are compared with.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> place = rng.uniform(size=(12, 2))
    >>> first, second = np.triu_indices(12, 1)
    >>> apart = np.abs(place[first] - place[second])
    >>> judged = np.array([np.hypot(apart[:, 0], ratio * apart[:, 1]) for ratio in (0.5, 2.0)])
    >>> data = Dissimilarities(tuple("abcdefghijkl"), ("1", "2"), judged)
    >>> found = confirm_indscal(data, place, axes=("c", "d"), level="ratio")
    >>> bool(found.stress1 < 1e-6 < found.stress1_shared), bool(found.angles.max() < 0.01)
    (True, True)
    """
    if n_permutations < 0:
        raise GlossError(f"Invalid number of permutations = {n_permutations}. Allowed: 0 or more.")
    if n_permutations and not conditional:
        raise GlossError("The permutation test is of conditional fits. Leave out the permutations, or --unconditional.")
    confirmed = confirm_axes(data, coordinates, axes=axes, level=level, ties=ties)  # refuses bad input
    chosen = replace(data, trials=None).of(confirmed.participants)
    # By halves, so that coordinates at both ends of the floating-point range do not overflow.
    half = np.asarray(coordinates, dtype=float) / 2
    scaled = (half - half.min(axis=0)) / np.ptp(half, axis=0)
    position = (scaled - scaled.mean(axis=0)) / scaled.std(axis=0)
    problem = make_problem(chosen, level=level, ties=ties, conditional=conditional)
    shared = fit_axis_weights(problem, position, np.ones(len(axes)))
    if conditional:
        weights, own = _individual(problem, position)
    else:
        solution = scale(
            chosen, n_dims=len(axes), model="weighted", level=level, ties=ties, conditional=False,
            restriction=fixed_stimuli(position), n_starts=_STARTS, seed=seed, initial=[position],
        )  # fmt: skip
        weights, own = solution.dimension_weights, solution.stress1**2
    taken = _part(own, shared.stress1**2)
    if problem.n_sources == 1 or len(axes) == 1:
        n_permutations = 0  # nothing can differ
    drawn = permuted_residuals(
        chosen,
        source_distances(position, np.tile(shared.weights, (problem.n_sources, 1))),
        n_weights=(len(axes) - 1) / problem.n_sources,
    )

    def one(child: np.random.SeedSequence) -> float:
        permuted = make_problem(drawn(np.random.default_rng(child)), level=level, ties=ties)
        common = fit_axis_weights(permuted, position, np.ones(len(axes))).stress1 ** 2
        return _part(_individual(permuted, position)[1], common)

    children = np.random.SeedSequence(seed).spawn(n_permutations)
    null = np.array(list(in_parallel(one, children, n_jobs, on_step))) if n_permutations else np.empty(0)
    combined = _combined(problem, position, weights, seed)
    return ConfirmatoryIndscal(
        axes=axes,
        participants=confirmed.participants,
        conditional=conditional,
        stress1=float(np.sqrt(own)),
        stress1_shared=shared.stress1,
        share_taken=taken,
        squared_weights=converted(position, weights, to="unit_sum_of_squares").squared_weights,
        stress1_combined=None if combined is None else combined[0],
        angles=None if combined is None else combined[1],
        null=null,
        p_value=(np.count_nonzero(null >= taken - _ROUNDING) + 1) / (n_permutations + 1) if n_permutations else None,
    )


def _individual(problem: Problem, position: np.ndarray) -> tuple[np.ndarray, float]:
    """Each source's own weights, shape (m, p), and the mean square stress of them all."""
    unit = np.ones(position.shape[1])
    singly = [
        fit_axis_weights(make_problem(problem.data.take([k]), level=problem.level, ties=problem.ties), position, unit)
        for k in range(problem.n_sources)
    ]
    return np.array([one.weights for one in singly]), float(
        problem.source_shares @ np.array([one.stress1**2 for one in singly])
    )


def _part(own: float, shared: float) -> float:
    # Own weights contain the shared ones: a search that ends a rounding error above them takes nothing away.
    return max((shared - own) / shared, 0.0) if shared > _ROUNDING else 0.0


def _combined(
    problem: Problem, position: np.ndarray, weights: np.ndarray, seed: int
) -> tuple[float, np.ndarray] | None:
    """Stress-1 with the best combinations of the axes, and the angles of these to the axes in degrees."""
    p = position.shape[1]
    if p < 2 or problem.n_sources < 2:
        return None
    # The given axes are among the starts, stretched as the participants weigh them on average.
    start = position * np.sqrt(np.mean((weights / np.linalg.norm(weights, axis=1, keepdims=True)) ** 2, axis=0))
    solution = scale(
        problem.data, n_dims=p, model="weighted", level=problem.level, ties=problem.ties,
        conditional=problem.conditional, restriction=external_variables(position), n_starts=_STARTS, seed=seed,
        initial=[start],
    )  # fmt: skip
    made = np.linalg.lstsq(position, solution.coordinates)[0]  # column r: the combination that dimension r is
    cosine = np.abs(made) / np.linalg.norm(made, axis=0)
    axis, dimension = linear_sum_assignment(-cosine)
    return solution.stress1, np.degrees(np.arccos(np.clip(cosine[axis, dimension], 0, 1)))
