"""Axis functions from ratings: their forms, the lines of the ratings along them, and what the ratings leave open."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import pandas as pd

from gloss_analysis.axis_functions.axis_forms import FormChoice, Forms, choose_form
from gloss_analysis.axis_functions.coordinates import rated_along
from gloss_analysis.axis_functions.form_fitting import AxisForm
from gloss_analysis.judgements.participant_remarks import rating_remarks
from gloss_analysis.ratings.polynomials import AxisRegression, regress_ratings
from glossspace.errors import GlossError
from glossspace.metric import PAPER_SPACE, AxisFunction, ContrastForm, GlossSpace

__all__ = ["RatingsFit", "fit_ratings", "one_lightness"]

# Values that differ by less than this part of the largest are equal but for rounding.
_SAME = 1e-9


@dataclass(frozen=True)
class RatingsFit:
    """What ratings say of a gloss space.

    Attributes
    ----------
    space : GlossSpace
        The gloss paper's weights, with the forms and lines of the ratings.
    regressions : mapping of str to AxisRegression
        Of the mean ratings, for each axis that was rated.
    forms : mapping of str to FormChoice
        The forms that were tried for each of them.
    remarks : tuple of str
        What the ratings leave open, and what was odd in them.
    """

    space: GlossSpace
    regressions: Mapping[str, AxisRegression]
    forms: Mapping[str, FormChoice]
    remarks: tuple[str, ...]


def fit_ratings(
    stimuli: pd.DataFrame,
    ratings: Mapping[str, pd.DataFrame],
    *,
    forms: Forms = "chosen",
    stress_of: Callable[[GlossSpace], float] | None = None,
) -> RatingsFit:
    """Fit axis functions to ratings of single images.

    Parameters
    ----------
    stimuli : DataFrame
        Columns `stimulus`, `rho_d`, `rho_s`, `alpha`: all stimuli that were rated.
    ratings : mapping of {"c", "d"} to DataFrame
        Magnitude estimates of a study that varied this axis. May be empty.
    forms : {"chosen", "paper"}
        See `choose_form`.
    stress_of : callable, optional
        Stress of judged pairs in a space, whatever its weights.

    Returns
    -------
    RatingsFit

    Raises
    ------
    GlossError
        An unknown axis, a rated stimulus that is not among `stimuli`, or a regression that cannot be made.
    """
    space, regressions, choices, remarks = PAPER_SPACE, {}, {}, []
    for axis, table in ratings.items():
        if axis not in ("c", "d"):
            raise GlossError(f"Ratings along {axis!r} are not known. Allowed: c or d.")
        try:
            _refuse_one_mean(rated_along(stimuli, table))
            arbiter = None if stress_of is None else partial(_stress_with, stress_of, space)
            choice = choose_form(axis, stimuli, table, forms=forms, stress_of=arbiter)
            space = _with_form(space, choice.chosen.form)
            rated = rated_along(stimuli, table, space)
            regressions[axis] = regress_ratings(rated[axis].to_numpy(), rated["rating"].to_numpy())
        except GlossError as error:
            raise GlossError(f"Ratings along {axis}: {error}") from None
        choices[axis] = choice
        space = replace(space, axis_functions={**space.axis_functions, axis: _axis_function(choice, regressions[axis])})
        remarks += _remarks(axis, table, rated, regressions[axis].slope)
        if axis == "c":
            remarks += one_lightness(stimuli, rated["stimulus"], "rated along c")
    return RatingsFit(space, regressions, choices, tuple(remarks))


def _refuse_one_mean(rated: pd.DataFrame) -> None:
    if np.ptp(rated["rating"]) <= _SAME * np.abs(rated["rating"]).max():
        raise GlossError(
            f"all stimuli have the same mean rating, {rated['rating'].iloc[0]:g}, and there is nothing to fit. Check "
            "those sessions, or leave them out."
        )


def _stress_with(stress_of: Callable[[GlossSpace], float], space: GlossSpace, form: AxisForm) -> float:
    return stress_of(_with_form(space, form))


def _with_form(space: GlossSpace, form: AxisForm) -> GlossSpace:
    if isinstance(form, ContrastForm):
        return replace(space, contrast_form=form)
    return replace(space, distinctness_form=form)


def _axis_function(choice: FormChoice, line: AxisRegression) -> AxisFunction:
    ci95 = choice.chosen.ci95
    return AxisFunction(
        line.slope, line.intercept, line.r_squared, line.n_stimuli, ci95.get("slope"), ci95.get("intercept")
    )


def _remarks(axis: str, table: pd.DataFrame, rated: pd.DataFrame, slope: float) -> list[str]:
    remarks = list(rating_remarks({axis: table}))
    if slope < 0:
        remarks.append(f"Ratings fall along {axis}, where gloss rises. Was the scale reversed?")
    other = "d" if axis == "c" else "c"
    if np.ptp(rated[other]) > _SAME:
        remarks.append(f"The stimuli rated along {axis} differ in {other} too, which its line does not account for.")
    return remarks


def one_lightness(stimuli: pd.DataFrame, names: Collection[str], how: str) -> list[str]:
    """Remark that stimuli of one lightness leave the diffuse term of c open; nothing where there are more."""
    reflectances = stimuli.loc[stimuli["stimulus"].isin(list(names)), "rho_d"].unique()
    if len(reflectances) > 1:
        return []
    form = "how c depends on lightness cannot be told from them, and that part of its form is the gloss paper's"
    return [f"The stimuli {how} have one lightness (rho_d {reflectances[0]:g}): {form}."]
