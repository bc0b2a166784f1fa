"""The form of an axis function, chosen by how well it predicts ratings of stimuli that were left out.

The gloss paper's forms have no free number. Here their exponent, diffuse share and offset may be free; a richer form
is taken only where the data can bear it.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
import pandas as pd
from scipy.stats import wilcoxon

from gloss_analysis.axis_functions.form_fitting import AxisForm, FormFit, fit_form
from gloss_analysis.ratings.magnitude import mean_ratings
from glossspace.errors import GlossError

__all__ = ["FormChoice", "Forms", "choose_form"]

Forms: TypeAlias = Literal["chosen", "paper"]
"""Whether forms with free numbers are tried at all."""

# Free parameters of the candidates, simplest first.
_CANDIDATES: Mapping[str, tuple[tuple[str, ...], ...]] = {
    "c": ((), ("exponent",), ("exponent", "diffuse_share"), ("exponent", "offset")),
    "d": ((), ("exponent",), ("exponent", "offset")),
}
# The gloss paper calls what gains less than this in r squared no gain (3.3.4).
_GAIN = 0.01
# Of the signed-rank test.
_ALPHA = 0.05
# Squared errors that searches leave of noise-free ratings, in units of their squared range.
_ROUNDING = 1e-10
# More stimuli than coefficients, at least.
_SPARE = 3


@dataclass(frozen=True)
class FormChoice:
    """Forms that were tried for an axis, and the one that the data can bear.

    Attributes
    ----------
    axis : {"c", "d"}
    candidates : tuple of FormFit
        The paper's form first.
    chosen : FormFit
        One of them.
    sentence : str
        The choice in words.
    """

    axis: str
    candidates: tuple[FormFit, ...]
    chosen: FormFit
    sentence: str


def choose_form(
    axis: str,
    stimuli: pd.DataFrame,
    ratings: pd.DataFrame,
    *,
    forms: Forms = "chosen",
    stress_of: Callable[[AxisForm], float] | None = None,
) -> FormChoice:
    """Choose the form of an axis function by cross-validation on mean ratings.

    Parameters
    ----------
    axis : {"c", "d"}
    stimuli : DataFrame
        Columns `stimulus`, `rho_d`, `rho_s`, `alpha`: all stimuli that were rated.
    ratings : DataFrame
        Columns `participant_id`, `stimulus`, `rating`, of a study that varied this axis.
    forms : {"chosen", "paper"}
        "paper" fits the gloss paper's form alone.
    stress_of : callable, optional
        Stress of judged pairs with this axis in a given form: the arbiter where pairs were judged, since scaling by
        order is free of the curvature that a slider has.

    Returns
    -------
    FormChoice

    Raises
    ------
    GlossError
        Ratings that cannot be regressed on; an unknown axis or value of `forms`.

    Notes
    -----
    A form with free numbers is taken instead of the paper's if (1) it predicts left-out stimuli better, by Wilcoxon's
    signed-rank test of the squared errors at 5 %, (2) it gains .01 or more in r squared, what the gloss paper
    takes for a gain, and (3) the stress of judged pairs does not rise. Of those that pass, the one of fewest free
    parameters that the best of them does not beat by the same test.

    A form of which a number is driven to the end of its range is shown, and never taken.

    A candidate is left out where there are not three stimuli more than it has coefficients, or too few different values
    of what it depends on: alpha for d, rho_s for c, and rho_d for the diffuse share and the offset, which one
    lightness cannot tell apart.

    Slope and intercept are solved for inside (variable projection), the other parameters searched for on logarithms
    by Nelder and Mead from several starts. Intervals are Student's with the standard error of a jackknife over
    participants (Efron and Tibshirani 1993, chapter 11), of logarithms where a parameter is positive.

    Examples
    --------
    >>> alpha = np.array([0.01, 0.03, 0.05, 0.08, 0.12, 0.16, 0.19])
    >>> paints = pd.DataFrame({"stimulus": list("abcdefg"), "rho_d": 0.03, "rho_s": 0.1, "alpha": alpha})
    >>> rated = pd.DataFrame({"participant_id": "1", "stimulus": list("abcdefg"), "rating": 90 - 150 * np.sqrt(alpha)})
    >>> round(choose_form("d", paints, rated).chosen.form.exponent, 3)
    0.5
    """
    if axis not in _CANDIDATES:
        raise GlossError(f"There is no axis {axis!r}. Allowed: c or d.")
    if forms not in ("chosen", "paper"):
        raise GlossError(f"Invalid forms = {forms!r}. Allowed: 'chosen' (by cross-validation) or 'paper'.")
    means = mean_ratings(ratings)
    paints = _paints(stimuli, list(means["stimulus"]))
    rating = means["rating"].to_numpy()
    tried = [free for free in _CANDIDATES[axis] if forms == "chosen" or not free]
    tried = [free for free in tried if not free or _bearable(axis, free, paints)]
    fits, errors = [], []
    jackknifed = _without_each(ratings, list(means["stimulus"]))
    for free in tried:
        fit, left_out = fit_form(axis, free, paints, rating, jackknifed)
        errors.append(left_out**2)
        fits.append(fit)
    chosen, sentence = _chosen(axis, fits, np.array(errors) / np.ptp(rating) ** 2, stress_of)
    return FormChoice(axis, tuple(fits), chosen, sentence)


def _paints(stimuli: pd.DataFrame, names: list[str]) -> np.ndarray:
    """rho_d, rho_s, alpha of the named stimuli, shape (n, 3)."""
    known = stimuli.drop_duplicates("stimulus").set_index("stimulus")
    return known.loc[names, ["rho_d", "rho_s", "alpha"]].to_numpy(dtype=float)


def _bearable(axis: str, free: Sequence[str], paints: np.ndarray) -> bool:
    """Whether the stimuli tell so many coefficients."""
    distinct = [len(np.unique(column)) for column in paints.T]
    coefficients = 2 + len(free)
    if len(paints) < coefficients + _SPARE or distinct[2 if axis == "d" else 1] < coefficients:
        return False
    return axis == "d" or len(free) == 1 or distinct[0] >= 3


def _without_each(ratings: pd.DataFrame, names: list[str]) -> list[np.ndarray]:
    """Mean ratings without each participant in turn; none with fewer than three of them."""
    everyone = ratings["participant_id"].unique()
    if len(everyone) < 3:
        return []
    found = []
    for one in everyone:
        means = mean_ratings(ratings[ratings["participant_id"] != one]).set_index("stimulus")
        found.append(means.loc[names, "rating"].to_numpy())
    return found


def _predicts_better(squared: np.ndarray, than: np.ndarray) -> bool:
    difference = than - squared
    if difference.mean() <= _ROUNDING:
        return False
    # Not by the standard error of the mean: a few stimuli carry most of a squared error.
    return bool(wilcoxon(difference, alternative="greater").pvalue < _ALPHA)


def _chosen(
    axis: str, fits: list[FormFit], squared: np.ndarray, stress_of: Callable[[AxisForm], float] | None
) -> tuple[FormFit, str]:
    """The choice of `choose_form`, and why, from squared errors in units of the ratings' squared range."""
    paper, richer = fits[0], fits[1:]
    if not richer:
        return paper, f"For {axis} the gloss paper's form was fitted alone."
    best = min(richer, key=lambda one: (bool(one.at_limit), one.leave_one_out_error))
    said = (
        f"For {axis} the best form with free numbers, {best.form.text}, predicts left-out stimuli with an error of "
        f"{best.leave_one_out_error:.3g} rating units, the gloss paper's with {paper.leave_one_out_error:.3g}; r² "
        f"{best.r_squared:.4f} and {paper.r_squared:.4f}."
    )
    passed = [
        k
        for k, one in enumerate(fits)
        if k
        and not one.at_limit
        and _predicts_better(squared[k], squared[0])
        and one.r_squared - paper.r_squared >= _GAIN
    ]
    if not passed:
        return paper, f"{said} That is not enough of a gain: the gloss paper's form is kept."
    if stress_of is not None:
        before = stress_of(paper.form)
        stresses = {k: stress_of(fits[k].form) for k in passed}
        passed = [k for k in passed if stresses[k] <= before]
        if not passed:
            return paper, (
                f"{said} But the stress of the judged pairs would rise from {before:.4f} to "
                f"{min(stresses.values()):.4f}: the curvature is the rating scale's. The gloss paper's form is kept."
            )
    least = min(passed, key=lambda k: squared[k].mean())
    k = next(k for k in passed if k == least or not _predicts_better(squared[least], squared[k]))
    return fits[k], f"{said} The form {fits[k].form.text} is taken."
