"""Hypotheses about a gloss axis: functions of the stimuli, judged by ratings of single images and by pairs.

The gloss paper (3.3.4) tested three for contrast gloss. The luminance ratio of the reflected patches fitted the ratings
poorly, the difference of their lightness well but not the pairs with large alpha, the form in object space both.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from gloss_analysis.confirmatory import confirm_axes
from gloss_analysis.dissimilarity import Dissimilarities
from gloss_analysis.magnitude import Equalisation, mean_ratings, regress_ratings
from gloss_analysis.mds.disparities import Level, Ties
from gloss_analysis.mds.objective import fitted_disparities, source_distances
from gloss_analysis.mds.problem import make_problem
from glossspace.errors import GlossError
from glossspace.metric import contrast_gloss, distinctness

__all__ = ["HYPOTHESES_C", "HYPOTHESIS_D", "Axis", "Hypothesis", "compare_hypotheses", "confirm_hypotheses"]

Axis: TypeAlias = Literal["c", "d"]


@dataclass(frozen=True)
class Hypothesis:
    """A named function of the stimuli that may be a gloss axis.

    Attributes
    ----------
    name : str
    axis : {"c", "d"}
        The axis that it is meant to be.
    function : callable
        Takes a DataFrame with one row a stimulus, whose columns are those of a stimulus set's table and measurements,
        and returns one number a row. Its unit is free: ratings are regressed on it, and pairs weigh it.

    Examples
    --------
    >>> energy = Hypothesis("specular energy", "c", lambda stimuli: stimuli["rho_s"])
    >>> energy.values(pd.DataFrame({"stimulus": ["a", "b"], "rho_s": [0.033, 0.099]})).tolist()
    [0.033, 0.099]
    """

    name: str
    axis: Axis
    function: Callable[[pd.DataFrame], ArrayLike]

    def values(self, stimuli: pd.DataFrame) -> np.ndarray:
        """Value of each stimulus, shape (n,).

        Raises
        ------
        GlossError
            A column is missing, or the values are not one finite number a stimulus.
        """
        try:
            values = np.asarray(self.function(stimuli), dtype=float)
        except KeyError as error:
            raise GlossError(
                f"The hypothesis {self.name!r} needs the column {error.args[0]}, which the stimuli lack; they have "
                f"{', '.join(map(str, stimuli.columns))}. Columns of measured luminance are in `measurements.csv` "
                "beside the images: merge them on `stimulus`."
            ) from None
        if values.shape != (len(stimuli),):
            raise GlossError(
                f"The hypothesis {self.name!r} gives values of shape {values.shape} for {len(stimuli)} stimuli; its "
                "function must return one number for each row."
            )
        if not np.all(np.isfinite(values)):
            lacking = stimuli["stimulus"].to_numpy()[~np.isfinite(values)]
            raise GlossError(
                f"The hypothesis {self.name!r} gives no finite number for the stimulus {lacking[0]} ({len(lacking)} "
                "such). Leave these stimuli out, or measure them."
            )
        return values


HYPOTHESES_C = (
    Hypothesis("luminance ratio", "c", lambda stimuli: stimuli["displayed_luminance_ratio"]),
    Hypothesis("lightness difference", "c", lambda stimuli: stimuli["displayed_lightness_difference"]),
    Hypothesis("object space", "c", lambda stimuli: contrast_gloss(stimuli["rho_d"], stimuli["rho_s"])),
)
"""The gloss paper's three hypotheses for contrast gloss.

The first two are of the patches that a light and a dark check reflect, as measured on the screen; the third is eq. 4.
"""

HYPOTHESIS_D = Hypothesis("1 - alpha", "d", lambda stimuli: distinctness(stimuli["alpha"]))
"""The gloss paper's hypothesis for distinctness of image, eq. 3."""


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
    hypotheses_c: Sequence[Hypothesis],
    stimuli: pd.DataFrame,
    pairs: Dissimilarities,
    d_values: np.ndarray | Hypothesis = HYPOTHESIS_D,
    *,
    level: Level = "ordinal",
    ties: Ties = "primary",
    alpha_from: float | None = None,
) -> pd.DataFrame:
    """Test hypotheses about c, each beside d, on judged pairs by confirmatory MDS.

    Parameters
    ----------
    hypotheses_c : sequence of Hypothesis
    stimuli : DataFrame
        Columns `stimulus`, `alpha`, and those that the hypotheses need.
    pairs : Dissimilarities
        m participants, n stimuli.
    d_values : ndarray, shape (n,), or Hypothesis
        Distinctness of image in the order of `pairs.stimuli`.
    level, ties
        See `gloss_analysis.mds.scale`.
    alpha_from : float, optional
        Alpha from which on it counts as large; the largest of the stimuli by default.

    Returns
    -------
    DataFrame
        One row a hypothesis, as given: `hypothesis`; `ratio`, the population's weight of d over that of c, in the
        hypothesis's own unit; `stress1` of the weights shared by all; `stress1_large_alpha`, the part of it that comes
        from pairs of which both stimuli have a large alpha, relative to these pairs' own distances (it may exceed 1);
        `stress1_other_pairs`, the same for all others; `shortfall_large_alpha`, by what part the hypothesis's distances
        in these pairs fall short of the judged ones (negative: exceed them); `n_pairs_large_alpha`;
        `remarks`, the warnings of `confirm_axes`.

    Raises
    ------
    GlossError
        No hypothesis, several of one name, or one about d; stimuli that are judged but not known; fewer than two
        stimuli of large alpha; or coordinates that cannot be fitted, see `confirm_axes`.

    Notes
    -----
    The transformation of the judgements is that of the fit to all pairs. A hypothesis that orders the pairs with large
    alpha rightly among themselves, but makes all of them too small, fails here, and would not on these pairs alone.
    """
    _check(hypotheses_c, axis="c")
    known = _rows_of(stimuli, list(pairs.stimuli))
    d = d_values.values(known) if isinstance(d_values, Hypothesis) else np.asarray(d_values, dtype=float)
    if d.shape != (len(known),):
        raise GlossError(f"The values of d have shape {d.shape}; give one for each of the {len(known)} judged stimuli.")
    if "alpha" not in known:
        raise GlossError("The stimuli have no column alpha, which tells the pairs of large alpha from the others.")
    alpha = known["alpha"].to_numpy(dtype=float)
    large = alpha >= (alpha.max() if alpha_from is None else alpha_from)
    if large.sum() < 2:
        raise GlossError(
            f"{large.sum()} of the judged stimuli have a large alpha, but a pair needs two. Give `alpha_from`, up to "
            f"{np.sort(alpha)[-2]:g}."
        )
    first, second = pairs.pairs
    both = large[first] & large[second]
    problem = make_problem(pairs, level=level, ties=ties)
    judged = np.where(pairs.judged, pairs.weights, 0.0)
    rows = []
    for hypothesis in hypotheses_c:
        coordinates = np.column_stack([hypothesis.values(known), d])
        fit = confirm_axes(pairs, coordinates, axes=(hypothesis.name, "d"), level=level, ties=ties)
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
                "stress1_large_alpha": stress_large,
                "stress1_other_pairs": stress_other,
                "shortfall_large_alpha": shortfall,
                "n_pairs_large_alpha": int(both.sum()),
                "remarks": " ".join(fit.warnings),
            }
        )
    return pd.DataFrame(rows)


def _check(hypotheses: Sequence[Hypothesis], *, axis: Axis | None = None) -> None:
    if not hypotheses:
        raise GlossError("There is no hypothesis to test; give one or more.")
    names = [hypothesis.name for hypothesis in hypotheses]
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise GlossError(f"Several hypotheses are called {twice[0]!r}; give each a name of its own.")
    meant = axis or hypotheses[0].axis
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
