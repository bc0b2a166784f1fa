"""A gloss space from judgements: the weights by confirmatory MDS, the axis functions by regression of ratings."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from gloss_analysis.axis_functions.axis_forms import FormChoice, Forms
from gloss_analysis.axis_functions.coordinates import axis_coordinates
from gloss_analysis.axis_functions.rating_fit import RatingsFit, fit_ratings, one_lightness
from gloss_analysis.confirmatory.scaling import ConfirmatoryFit, Interval, confirm_axes
from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds.disparities import Level, Ties
from gloss_analysis.ratings.polynomials import AxisRegression
from glossspace.errors import GlossError
from glossspace.metric import PAPER_SPACE, GlossSpace

__all__ = [
    "AxisFunctionsFit",
    "GlossSpaceFit",
    "fit_axis_functions",
    "fit_gloss_space",
    "labelled_observers",
]

# Values that differ by less than this part of the largest are equal but for rounding.
_SAME = 1e-9


@dataclass(frozen=True)
class AxisFunctionsFit:
    """A gloss space whose axis functions were fitted, and the regressions that it rests on.

    Attributes
    ----------
    space : GlossSpace
    regressions : mapping of str to AxisRegression
        Of the mean ratings, for each axis that was rated.
    forms : mapping of str to FormChoice
        The forms that were tried for each of them, and the one that was taken.
    warnings : tuple of str
        What the data leave open, and what was odd in them.
    """

    space: GlossSpace
    regressions: Mapping[str, AxisRegression]
    forms: Mapping[str, FormChoice]
    warnings: tuple[str, ...]


@dataclass(frozen=True)
class GlossSpaceFit(AxisFunctionsFit):
    """A gloss space whose weights were fitted too.

    Attributes
    ----------
    confirmatory : ConfirmatoryFit
        Of the pairs, along (c, d). Its warnings are among `warnings`.
    """

    confirmatory: ConfirmatoryFit


def fit_gloss_space(
    stimuli: pd.DataFrame,
    pairs: Dissimilarities,
    ratings: Mapping[str, pd.DataFrame],
    *,
    level: Level = "ordinal",
    ties: Ties = "primary",
    interval: Interval = "t",
    seed: int = 1,
    forms: Forms = "chosen",
    name: str = "fitted",
    provenance: Mapping[str, Any] | None = None,
) -> GlossSpaceFit:
    """Fit the weights of a gloss space to judged pairs, and its axis functions to ratings of single images.

    Parameters
    ----------
    stimuli : DataFrame
        Columns `stimulus`, `rho_d`, `rho_s`, `alpha`: all stimuli that were judged.
    pairs : Dissimilarities
        Judged differences in gloss.
    ratings : mapping of {"c", "d"} to DataFrame
        Magnitude estimates (`participant_id`, `stimulus`, `rating`) of a study that varied this axis. May be empty.
    level, ties, interval, seed
        Of the confirmatory analysis; see `gloss_analysis.confirmatory.scaling.confirm_axes`.
    forms : {"chosen", "paper"}
        Whether the axis functions may have exponents, shares and offsets of their own, where cross-validation of the
        ratings and the stress of the pairs speak for them; see `choose_form`.
    name : str
        Name of the space.
    provenance : mapping, optional
        Where the judgements came from, kept in the file.

    Returns
    -------
    GlossSpaceFit
        weight_c is 1 and weight_d the geometric mean of the participants' axis ratios, with its 95 % interval.

    Raises
    ------
    GlossError
        A judged stimulus is not among `stimuli`, the judged stimuli do not differ along both axes, or an analysis
        cannot be made; the message says why.

    Notes
    -----
    At ordinal level the weight is known as far as order determines it: every ratio that keeps the order of all
    distances fits equally well, and the middle of that range is taken.

    Examples
    --------
    >>> paints, judged = read_stimulus_table("stimuli.csv"), read_table("pairs.csv")  # doctest: +SKIP
    >>> fit_gloss_space(paints, judged, {}, level="ratio").space.weight_d  # doctest: +SKIP
    1.78
    """
    _require_both_axes(axis_coordinates(stimuli, list(pairs.stimuli)))

    def confirmed(space: GlossSpace) -> ConfirmatoryFit:
        coordinates = axis_coordinates(stimuli, list(pairs.stimuli), space)[["c", "d"]].to_numpy()
        return confirm_axes(pairs, coordinates, axes=("c", "d"), level=level, ties=ties, interval=interval, seed=seed)

    rated = fit_ratings(stimuli, ratings, forms=forms, stress_of=lambda space: confirmed(space).shared.stress1)
    confirmatory = confirmed(rated.space)
    judged = set(pairs.stimuli).union(*(table["stimulus"] for table in ratings.values()))
    space = replace(
        rated.space,
        weight_c=1.0,
        weight_d=confirmatory.population_ratio,
        name=name,
        weight_d_ci95=confirmatory.population_ci95,
        stimulus_range=_spanned(stimuli, judged),
        provenance=dict(provenance or {})
        | {"level": level, "ties": ties, "interval": interval, "participants": _everyone(pairs.participants, ratings)}
        | {"sources": ["pairs", *(["magnitudes"] if ratings else [])], "weight_d_fitted": True}
        | {"forms": _forms_tried(rated)},
    )
    unseen = one_lightness(stimuli, pairs.stimuli, "judged in pairs")
    warnings = (*confirmatory.warnings, *unseen, *rated.remarks)
    return GlossSpaceFit(space, rated.regressions, rated.forms, warnings, confirmatory)


def fit_axis_functions(
    stimuli: pd.DataFrame,
    ratings: Mapping[str, pd.DataFrame],
    *,
    forms: Forms = "chosen",
    name: str = "fitted",
    provenance: Mapping[str, Any] | None = None,
) -> AxisFunctionsFit:
    """Fit the axis functions of a gloss space to ratings of single images; its weights remain the gloss paper's.

    Ratings along one axis say nothing of how much a step along it counts beside one along the other: that takes pairs.

    Parameters
    ----------
    stimuli : DataFrame
        Columns `stimulus`, `rho_d`, `rho_s`, `alpha`: all stimuli that were rated.
    ratings : mapping of {"c", "d"} to DataFrame
        Magnitude estimates (`participant_id`, `stimulus`, `rating`) of a study that varied this axis; at least one.
    forms, name, provenance
        As of `fit_gloss_space`.

    Returns
    -------
    AxisFunctionsFit
        weight_d is 1.78, and weight_d_ci95 None.

    Raises
    ------
    GlossError
        There are no ratings, a rated stimulus is not among `stimuli`, or a regression cannot be made.

    Examples
    --------
    >>> paints = pd.DataFrame({"stimulus": list("abc"), "rho_d": 0.03, "rho_s": 0.1, "alpha": [0.04, 0.07, 0.1]})
    >>> rated = pd.DataFrame({"participant_id": "01", "stimulus": list("abc"), "rating": [80, 65, 50]})
    >>> fitted = fit_axis_functions(paints, {"d": rated})
    >>> round(fitted.space.axis_functions["d"].slope, 6), fitted.space.weight_d
    (500.0, 1.78)
    """
    if not ratings:
        raise GlossError("There are no ratings to fit axis functions to.")
    rated = fit_ratings(stimuli, ratings, forms=forms)
    space = replace(
        rated.space,
        name=name,
        stimulus_range=_spanned(stimuli, set().union(*(table["stimulus"] for table in ratings.values()))),
        provenance=dict(provenance or {})
        | {"participants": _everyone((), ratings), "sources": ["magnitudes"]}
        | {"weight_d_fitted": False, "weight_d_from": PAPER_SPACE.name, "forms": _forms_tried(rated)},
    )
    unfitted = [f"Without judged pairs the weight of d was not fitted: {space.weight_d:g} is the gloss paper's."]
    if not space.has_paper_forms:
        unfitted.append("It belongs to the gloss paper's axis functions, and these have other units: judge pairs.")
    return AxisFunctionsFit(space, rated.regressions, rated.forms, (*unfitted, *rated.remarks))


def labelled_observers(participants: Sequence[str], simulated: Collection[str]) -> list[str]:
    """Names for a file's provenance, in which no simulated participant passes for a person.

    Parameters
    ----------
    participants : sequence of str
    simulated : collection of str
        Those of them, or of others, who are programs.

    Returns
    -------
    list of str
        Each participant, with " (simulated)" behind those that are.
    """
    return [f"{name} (simulated)" if name in simulated else name for name in participants]


def _require_both_axes(coordinates: pd.DataFrame) -> None:
    for axis, of in (("c", "rho_d and rho_s"), ("d", "alpha")):
        if np.ptp(coordinates[axis]) <= _SAME:
            raise GlossError(
                f"All stimuli that were judged in pairs have the same {axis}, {coordinates[axis].iloc[0]:g}, so that "
                f"the weight of d over that of c cannot be fitted. Judge pairs that differ in {of} too, or leave the "
                "pairs out and fit ratings alone."
            )


def _spanned(stimuli: pd.DataFrame, judged: set[str]) -> dict[str, tuple[float, float]]:
    known = stimuli[stimuli["stimulus"].isin(judged)]
    return {key: (float(known[key].min()), float(known[key].max())) for key in ("rho_d", "rho_s", "alpha")}


def _everyone(judges: Sequence[str], ratings: Mapping[str, pd.DataFrame]) -> list[str]:
    return list(dict.fromkeys([*judges, *(str(one) for table in ratings.values() for one in table["participant_id"])]))


def _forms_tried(rated: RatingsFit) -> dict[str, list[dict[str, Any]]]:
    """What was tried for each axis, for the file."""
    return {
        axis: [
            {
                "form": one.form.text,
                "free": list(one.free),
                "parameters": asdict(one.form),
                "r_squared": one.r_squared,
                "leave_one_out_error": one.leave_one_out_error,
                "aicc": one.aicc if np.isfinite(one.aicc) else None,
                "ci95": {name: list(interval) for name, interval in one.ci95.items()},
                "at_limit": list(one.at_limit),
                "taken": one is choice.chosen,
            }
            for one in choice.candidates
        ]
        for axis, choice in rated.forms.items()
    }
