"""Tests of hypotheses about a gloss axis: regression of ratings of single images, and confirmatory MDS of judged pairs.

The gloss paper (3.3.4) asks both: a form of c that fits the ratings well may yet fail on the pairs with large alpha.
"""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from gloss_analysis.confirmatory.scaling import confirm_axes
from gloss_analysis.hypotheses.candidates import HYPOTHESES_C, HYPOTHESES_D, HYPOTHESIS_C, HYPOTHESIS_D, Hypothesis
from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds.disparities import Level, Ties
from gloss_analysis.mds.objective import fitted_disparities, source_distances
from gloss_analysis.mds.problem import make_problem
from gloss_analysis.ratings.magnitude import Equalisation, mean_ratings, regress_ratings
from glossspace.errors import GlossError

__all__ = [
    "HYPOTHESES_C",
    "HYPOTHESES_D",
    "HYPOTHESIS_C",
    "HYPOTHESIS_D",
    "Hypothesis",
    "compare_hypotheses",
    "confirm_hypotheses",
]

# The paper's other axis, beside which a hypothesis about one is tested on pairs.
_BESIDE = {"c": HYPOTHESIS_D, "d": HYPOTHESIS_C}
# Stress that rounding cannot tell apart.
_SAME_STRESS = 1e-9


def compare_hypotheses(
    hypotheses: Sequence[Hypothesis],
    stimuli: pd.DataFrame,
    ratings: pd.DataFrame,
    *,
    equalise: Equalisation = "linear",
) -> pd.DataFrame:
    """Regress mean ratings on each hypothesis.

    Parameters
    ----------
    hypotheses : sequence of Hypothesis
        Of one axis.
    stimuli : DataFrame
        Column `stimulus` and those that the hypotheses need.
    ratings : DataFrame
        Columns `participant_id`, `stimulus`, `rating`, of a study that varied this axis.
    equalise
        See `mean_ratings`.

    Returns
    -------
    DataFrame
        One row a hypothesis, as given: `hypothesis`, `axis`, `slope`, `r_squared`, `adjusted_r_squared`,
        `leave_one_out_error` (in units of rating), `aicc`, `n_stimuli`.

    Raises
    ------
    GlossError
        No hypothesis, several of one name or of different axes; stimuli that are rated but not known; or values that
        cannot be regressed on.

    Notes
    -----
    A regression is blind to the sign: a hypothesis whose slope is negative says that glossy paints look matt. As each
    hypothesis has the same two coefficients, all criteria but the leave-one-out error order them alike. Those that are
    linear functions of each other over the stimuli cannot be told apart.

    Examples
    --------
    >>> stimuli = pd.DataFrame({"stimulus": list("wxyz"), "alpha": [0.01, 0.04, 0.1, 0.19]})
    >>> ratings = pd.DataFrame({"participant_id": "1", "stimulus": list("wxyz"), "rating": [99, 96, 90, 81]})
    >>> compare_hypotheses([HYPOTHESIS_D], stimuli, ratings)["slope"].round(6).tolist()
    [100.0]
    """
    _check(hypotheses)
    means = mean_ratings(ratings, equalise=equalise)
    known = _rows_of(stimuli, list(means["stimulus"]))
    rows = []
    for hypothesis in hypotheses:
        values = hypothesis.values(known)
        try:
            line = regress_ratings(values, means["rating"].to_numpy())
        except GlossError as error:
            raise GlossError(f"The hypothesis {hypothesis.name!r}: {error}") from None
        fit = line.polynomials[0]
        rows.append(
            {
                "hypothesis": hypothesis.name,
                "axis": hypothesis.axis,
                "slope": line.slope,
                "r_squared": line.r_squared,
                "adjusted_r_squared": fit.adjusted_r_squared,
                "leave_one_out_error": fit.leave_one_out_error,
                "aicc": fit.aicc,
                "n_stimuli": line.n_stimuli,
            }
        )
    return pd.DataFrame(rows)


def confirm_hypotheses(
    hypotheses: Sequence[Hypothesis],
    stimuli: pd.DataFrame,
    pairs: Dissimilarities,
    beside: np.ndarray | Hypothesis | None = None,
    *,
    level: Level = "ordinal",
    ties: Ties = "primary",
    alpha_from: float | None = None,
) -> pd.DataFrame:
    """Test hypotheses about one axis, each beside the other axis, on judged pairs by confirmatory MDS.

    Parameters
    ----------
    hypotheses : sequence of Hypothesis
        All about c, or all about d.
    stimuli : DataFrame
        Columns `stimulus`, `alpha`, and those that the hypotheses need.
    pairs : Dissimilarities
        m participants, n stimuli.
    beside : ndarray, shape (n,), or Hypothesis, optional
        The other axis, in the order of `pairs.stimuli`. By default the gloss paper's: 1 - alpha beside hypotheses about
        c, the object-space form beside those about d.
    level, ties
        See `gloss_analysis.mds.scale`.
    alpha_from : float, optional
        Alpha from which on it counts as large; by default the largest that two of the stimuli reach.

    Returns
    -------
    DataFrame
        One row a hypothesis, as given: `hypothesis`; `ratio`, the population's weight of d over that of c, in the
        hypothesis's own unit; `stress1` of the weights shared by all; `n_best`, for how many participants, each with
        weights of his own, no other hypothesis has a lower stress, and `n_participants`, of how many;
        `stress1_large_alpha`, the part of `stress1` that comes from pairs of which both stimuli have a large alpha,
        relative to these pairs' own distances (it may exceed 1); `stress1_other_pairs`, the same for all others;
        `shortfall_large_alpha`, by what part the hypothesis's distances in these pairs fall short of the judged ones
        (negative: exceed them); `n_pairs_large_alpha`, how many of these somebody judged;
        `remarks`, the warnings of `confirm_axes`.

    Raises
    ------
    GlossError
        No hypothesis, several of one name, or about different axes; stimuli that are judged but not known; fewer than
        two stimuli of the given `alpha_from`; or coordinates that cannot be fitted, see `confirm_axes`.

    Notes
    -----
    The transformation of the judgements is that of the fit to all pairs. A hypothesis that orders the pairs with large
    alpha rightly among themselves, but makes all of them too small, fails here, and would not on these pairs alone.
    """
    _check(hypotheses)
    axis = hypotheses[0].axis
    known = _rows_of(stimuli, list(pairs.stimuli))
    beside = _BESIDE[axis] if beside is None else beside
    other = beside.values(known) if isinstance(beside, Hypothesis) else np.asarray(beside, dtype=float)
    if other.shape != (len(known),):
        raise GlossError(
            f"The values of {'d' if axis == 'c' else 'c'} have shape {other.shape}; give one for each of the "
            f"{len(known)} judged stimuli."
        )
    large = _of_large_alpha(known, alpha_from)
    first, second = pairs.pairs
    both = large[first] & large[second]
    problem = make_problem(pairs, level=level, ties=ties)
    judged = np.where(pairs.judged, pairs.weights, 0.0)
    rows, own = [], []
    for hypothesis in hypotheses:
        values = hypothesis.values(known)
        columns, names = ((values, other), (hypothesis.name, "d"))
        if axis == "d":
            columns, names = ((other, values), ("c", hypothesis.name))
        coordinates = np.column_stack(columns)
        fit = confirm_axes(pairs, coordinates, axes=names, level=level, ties=ties)
        own.append(dict(zip(fit.participants, (one.stress1 for one in fit.individual), strict=True)))
        # In units of the first axis, so that squares do not overflow whatever the hypothesis's unit.
        unit = coordinates * (fit.shared.weights / np.ptp(coordinates[:, 0]))
        distances = source_distances(unit, np.ones((problem.n_sources, 2)))
        fitted = fitted_disparities(problem, distances)
        stress_large, shortfall = _within(judged * both, distances, fitted, problem.source_shares)
        stress_other, _ = _within(judged * ~both, distances, fitted, problem.source_shares)
        rows.append(
            {
                "hypothesis": hypothesis.name,
                "ratio": fit.population_ratio,
                "stress1": fit.shared.stress1,
                "n_participants": len(fit.participants),
                "stress1_large_alpha": stress_large,
                "stress1_other_pairs": stress_other,
                "shortfall_large_alpha": shortfall,
                "n_pairs_large_alpha": int(np.count_nonzero((judged * both).any(axis=0))),
                "remarks": " ".join(fit.warnings),
            }
        )
    stress = pd.DataFrame(own)
    table = pd.DataFrame(rows)
    table.insert(3, "n_best", (stress <= stress.min() + _SAME_STRESS).sum(axis=1).to_numpy())
    return table


def _of_large_alpha(known: pd.DataFrame, alpha_from: float | None) -> np.ndarray:
    if "alpha" not in known:
        raise GlossError("The stimuli have no column alpha, which tells the pairs of large alpha from the others.")
    alpha = known["alpha"].to_numpy(dtype=float)
    large = alpha >= (np.sort(alpha)[-2] if alpha_from is None else alpha_from)
    if large.sum() < 2:
        raise GlossError(
            f"{large.sum()} of the judged stimuli have a large alpha, but a pair needs two. Give `alpha_from`, up to "
            f"{np.sort(alpha)[-2]:g}."
        )
    return np.asarray(large)


def _check(hypotheses: Sequence[Hypothesis]) -> None:
    if not hypotheses:
        raise GlossError("There is no hypothesis to test; give one or more.")
    names = [hypothesis.name for hypothesis in hypotheses]
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise GlossError(f"Several hypotheses are called {twice[0]!r}; give each a name of its own.")
    meant = hypotheses[0].axis
    other = [hypothesis for hypothesis in hypotheses if hypothesis.axis != meant]
    if other:
        raise GlossError(
            f"The hypothesis {other[0].name!r} is about {other[0].axis}, but this is a comparison for {meant}."
        )


def _rows_of(stimuli: pd.DataFrame, names: list[str]) -> pd.DataFrame:
    indexed = stimuli.drop_duplicates("stimulus").set_index("stimulus", drop=False)
    unknown = [name for name in names if name not in indexed.index]
    if unknown:
        raise GlossError(
            f"The stimulus {unknown[0]!r} was judged, but is not in the table of stimuli ({len(unknown)} such). Add it."
        )
    return indexed.loc[names].reset_index(drop=True)


def _within(part: np.ndarray, distances: np.ndarray, fitted: np.ndarray, share: np.ndarray) -> tuple[float, float]:
    """Stress-1 and mean shortfall of the distances in pairs of weight `part`, shape (m, n_pairs), over all sources.

    Of Stress-1 the root mean square, as in the objective. NaN where nobody judged these pairs, or all of them at 0.
    """
    fitted = np.where(part > 0, fitted, 0.0)
    stress, shortfall = np.full((2, len(part)), np.nan)
    squared, judged = np.sum(part * distances**2, axis=1), np.sum(part * fitted, axis=1)
    np.divide(np.sum(part * (distances - fitted) ** 2, axis=1), squared, out=stress, where=squared > 0)
    np.divide(np.sum(part * (fitted - distances), axis=1), judged, out=shortfall, where=judged > 0)
    return float(np.sqrt(_over_sources(stress, share))), _over_sources(shortfall, share)


def _over_sources(values: np.ndarray, share: np.ndarray) -> float:
    known = ~np.isnan(values) & (share > 0)
    return float(np.average(values[known], weights=share[known])) if known.any() else np.nan
