"""A solution fitted anew to resampled judgements, from where it stands: what bootstrap and jackknife share."""

from dataclasses import dataclass, replace

import numpy as np

from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds import MdsSolution
from gloss_analysis.mds.descent import Start, descend_all, jittered
from gloss_analysis.mds.diagnostics import check_scalable
from gloss_analysis.mds.exchange import exchanged
from gloss_analysis.mds.kernels import DIAGONAL, FIXED, FULL
from gloss_analysis.mds.problem import Problem, make_problem
from gloss_analysis.mds.starts import random_start
from gloss_analysis.uncertainty.alignment import aligned
from glossspace.errors import GlossError

__all__ = [
    "Refit", "check_confidence", "check_fits", "check_plane", "check_weights", "geometric_mean_ratio", "refitted",
    "weight_ratio",
]  # fmt: skip

_STEPS, _ACCURACY = 3000, 1e-9
# How far points are displaced in further starts, in parts of their root mean square. On a line, where points cannot
# pass each other, many small displacements find more than few large ones.
_DISPLACED, _DISPLACED_ON_LINE = (0.3, 0.6), (0.03, 0.05, 0.1, 0.1, 0.15, 0.2, 0.3, 0.5)
# With so few judgements the landscape is rough, and a start more is cheap: so many are tried for so many steps, and so
# many kept.
_ROUGH_UP_TO, _MORE, _SHORT, _KEPT = 1000, 32, 60, 4
# Beyond, a participant follows one dimension alone, and only noise says by how much.
_LARGEST_RATIO = 1000.0


@dataclass(frozen=True)
class Refit:
    """A solution of resampled judgements, aligned to that of all.

    Attributes
    ----------
    coordinates : ndarray, shape (n, p)
    dimension_weights : ndarray, shape (m, p)
        Of the participants that were given, each once.
    stress1 : float
    """

    coordinates: np.ndarray
    dimension_weights: np.ndarray
    stress1: float


def check_fits(data: Dissimilarities, solution: MdsSolution) -> None:
    """Refuse a solution of other data, or of a kind that cannot be aligned.

    Raises
    ------
    GlossError
    """
    if data.stimuli != solution.stimuli or data.participants != solution.participants:
        raise GlossError(
            f"The solution's {len(solution.stimuli)} stimuli and {len(solution.participants)} participants are not "
            f"those of the data ({len(data.stimuli)} and {len(data.participants)}), or not in their order. Scale these "
            "data."
        )
    judged = np.where(data.judged, data.values, np.nan)
    weights = data.weights / max(data.weights.max(), np.finfo(float).tiny)
    if not (
        np.array_equal(judged, solution.dissimilarities, equal_nan=True)
        and np.allclose(weights, solution.pair_weights, rtol=1e-12, atol=0)
    ):
        raise GlossError("The solution is one of other dissimilarities or weights. Scale these data.")
    if solution.restricted:
        raise GlossError(
            "A solution with fixed stimuli or external variables cannot be resampled: replicates would be free. Scale "
            "without the restriction."
        )
    if solution.model == "generalised" and not solution.conditional:
        raise GlossError(
            "A generalised solution with one transformation for all participants cannot be aligned with others. Use "
            "the weighted model, or a transformation for each participant."
        )


def check_plane(solution: MdsSolution, first: int, second: int) -> None:
    """Refuse a pair of dimensions that the solution does not have.

    Raises
    ------
    GlossError
    """
    p = solution.n_dims
    if p < 2 or first == second or not (0 <= first < p and 0 <= second < p):
        raise GlossError(
            f"Dimensions {first} and {second} are no two dimensions of this solution. "
            + (f"Allowed: two different numbers from 0 to {p - 1}." if p > 1 else "It has one dimension only.")
        )


def check_weights(solution: MdsSolution, first: int, second: int) -> None:
    """Refuse a ratio of weights that the solution does not have.

    Raises
    ------
    GlossError
    """
    check_plane(solution, first, second)
    if solution.model != "weighted":
        raise GlossError(f"The {solution.model} model has no weights of dimensions. Use model = 'weighted'.")


def check_confidence(level: float) -> float:
    """Refuse a confidence level that is none.

    Raises
    ------
    GlossError
    """
    if not 0 < level < 1:
        raise GlossError(f"Invalid level = {level}. Allowed: above 0 and below 1, such as 0.95.")
    return level


def refitted(
    data: Dissimilarities, counts: np.ndarray, solution: MdsSolution, rows: np.ndarray, rng: np.random.Generator
) -> Refit | None:
    """Fit again from the solution, from displaced points and, where axes mean something, from turned ones.

    Parameters
    ----------
    data : Dissimilarities
        Participants who differ.
    counts : ndarray of int, shape (m,)
        How often each is there: as good as repeating them, and faster.
    solution : MdsSolution
    rows : ndarray of int, shape (m,)
        Which participants of the solution they are.
    rng : numpy.random.Generator

    Returns
    -------
    Refit or None
        None where the data do not determine a solution: no scalable judgements, or participants distinguished by a
        model of which one alone is left.
    """
    own = replace(data, source_weights=data.source_weights_or_ones * counts)
    try:
        check_scalable(own, level=solution.level, ties=solution.ties)
    except GlossError:
        return None
    problem = make_problem(own, level=solution.level, ties=solution.ties, conditional=solution.conditional)
    counted = problem.source_shares > 0
    if np.count_nonzero(counted) < min(2, int(np.count_nonzero(solution.source_shares))):
        return None
    free = _free_part(problem, solution)
    starts = _starts(solution, solution.transforms[rows], rng, turned=free == DIAGONAL)
    if len(problem.pairs.first) <= _ROUGH_UP_TO:
        starts = starts[:1] + _more_starts(problem, solution, free, rng) + starts[1:]
    run = descend_all(problem, starts, model=free, steps=_STEPS, relative=_ACCURACY)[0]
    members = np.repeat(np.arange(len(rows)), np.where(counted, counts, 0))
    # Who judged nothing is shown as the average participant.
    weights = np.ones((len(rows), solution.n_dims))
    z, c = aligned(
        run.coordinates,
        run.transforms[members],
        solution.coordinates,
        model="identity" if free == FIXED else solution.model,
        conditional=solution.conditional,
    )
    weights[members] = np.linalg.norm(c, axis=2)
    return Refit(z, weights, float(np.sqrt(max(run.value, 0.0))))


def _free_part(problem: Problem, solution: MdsSolution) -> int:
    # A single participant, or one dimension, leaves nothing that weights could change.
    alone = np.count_nonzero(problem.source_shares) == 1 or solution.n_dims == 1
    if problem.conditional and alone:
        return FIXED
    return {"identity": FIXED, "weighted": DIAGONAL, "generalised": FULL}[solution.model]


def _more_starts(problem: Problem, solution: MdsSolution, free: int, rng: np.random.Generator) -> list[Start]:
    """Best ends of short runs from points that trade places and from random ones."""
    z, p = solution.coordinates, solution.n_dims
    alike = np.tile(np.eye(p), (problem.n_sources, 1, 1))
    many = [random_start(len(z), p, rng) for _ in range(_MORE // 2)]
    many += [exchanged(z, rng) for _ in range(_MORE - len(many))]
    runs = descend_all(problem, [(one, alike) for one in many], model=free, steps=_SHORT)
    return [run.start for run in runs[:_KEPT]]


def _starts(solution: MdsSolution, transforms: np.ndarray, rng: np.random.Generator, *, turned: bool) -> list[Start]:
    z, p = solution.coordinates, solution.n_dims
    alike = np.tile(np.eye(p), (len(transforms), 1, 1))
    size = np.sqrt(np.mean(z**2))
    starts = [(jittered(z), transforms)]
    for part in _DISPLACED_ON_LINE if p == 1 else _DISPLACED:
        starts.append((z + part * size * rng.standard_normal(z.shape), alike))
    if turned and p > 1:
        turn, _ = np.linalg.qr(rng.standard_normal((p, p)))
        starts.append((jittered(z @ turn), alike))
    return starts


def weight_ratio(coordinates: np.ndarray, weights: np.ndarray, first: int, second: int) -> np.ndarray:
    """How far dimension `second` extends in each participant's own space over `first`, within 1/1000 to 1000.

    Ratio of weights times the spread of the coordinates. The weights alone have mean square 1 over participants by
    convention, so that their mean ratio would be about 1 in any data.

    Parameters
    ----------
    coordinates : ndarray, shape (..., n, p)
        Centred.
    weights : ndarray, shape (..., m, p)

    Returns
    -------
    ndarray, shape (..., m)
        NaN where the weights are.
    """
    extent = weights * np.sqrt(np.mean(coordinates**2, axis=-2, keepdims=True))
    above, below = extent[..., second], extent[..., first]
    at_limit = np.where(above > 0, _LARGEST_RATIO, np.nan)
    ratio = np.divide(above, below, out=at_limit, where=(below > 0) | np.isnan(below))
    return np.clip(ratio, 1 / _LARGEST_RATIO, _LARGEST_RATIO)


def geometric_mean_ratio(ratios: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """Geometric mean over participants, each counted as often as it is there; those with NaN are left out.

    Parameters
    ----------
    ratios, counts : ndarray, shape (..., m)

    Returns
    -------
    ndarray, shape (...)
    """
    known = ~np.isnan(ratios)
    logs = np.log(np.where(known, ratios, 1.0))
    number = np.sum(counts * known, axis=-1)
    total = np.sum(counts * logs, axis=-1)
    return np.exp(np.divide(total, number, out=np.full(np.shape(total), np.nan), where=number > 0))
