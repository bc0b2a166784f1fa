"""A gloss space from judgements: the weights by confirmatory MDS, the axis functions by regression of ratings."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from gloss_analysis.confirmatory import ConfirmatoryFit, confirm_axes
from gloss_analysis.dissimilarity import Dissimilarities
from gloss_analysis.magnitude import AxisRegression, mean_ratings, regress_ratings
from gloss_analysis.mds.disparities import Level, Ties
from glossspace.errors import GlossError
from glossspace.metric import PAPER_SPACE, AxisFunction, GlossSpace, contrast_gloss, distinctness

__all__ = [
    "AxisFunctionsFit",
    "GlossSpaceFit",
    "axis_coordinates",
    "fit_axis_functions",
    "fit_gloss_space",
    "labelled_observers",
    "rated_along",
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
    warnings : tuple of str
        What the data leave open, and what was odd in them.
    """

    space: GlossSpace
    regressions: Mapping[str, AxisRegression]
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
    level, ties
        Of the confirmatory analysis; see `gloss_analysis.mds.scale`.
    name : str
        Name of the space.
    provenance : mapping, optional
        Where the judgements came from, kept in the file.

    Returns
    -------
    GlossSpaceFit
        weight_c is 1 and weight_d the geometric mean of the participants' axis ratios, with its 95 % t interval.

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
    coordinates = axis_coordinates(stimuli, list(pairs.stimuli))
    _require_both_axes(coordinates)
    confirmatory = confirm_axes(pairs, coordinates[["c", "d"]].to_numpy(), axes=("c", "d"), level=level, ties=ties)
    regressions, remarks = _regressions(stimuli, ratings)
    judged = set(pairs.stimuli).union(*(table["stimulus"] for table in ratings.values()))
    space = GlossSpace(
        weight_c=1.0,
        weight_d=confirmatory.population_ratio,
        name=name,
        weight_d_ci95=confirmatory.population_ci95,
        axis_functions=_axis_functions(regressions),
        stimulus_range=_spanned(stimuli, judged),
        provenance=dict(provenance or {})
        | {"level": level, "ties": ties, "participants": _everyone(pairs.participants, ratings)}
        | {"sources": ["pairs", *(["magnitudes"] if ratings else [])], "weight_d_fitted": True},
    )
    unseen = _one_lightness(stimuli, pairs.stimuli, "judged in pairs")
    return GlossSpaceFit(space, regressions, (*confirmatory.warnings, *unseen, *remarks), confirmatory)


def fit_axis_functions(
    stimuli: pd.DataFrame,
    ratings: Mapping[str, pd.DataFrame],
    *,
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
    name, provenance
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
    regressions, remarks = _regressions(stimuli, ratings)
    space = replace(
        PAPER_SPACE,
        name=name,
        axis_functions=_axis_functions(regressions),
        stimulus_range=_spanned(stimuli, set().union(*(table["stimulus"] for table in ratings.values()))),
        provenance=dict(provenance or {})
        | {"participants": _everyone((), ratings), "sources": ["magnitudes"]}
        | {"weight_d_fitted": False, "weight_d_from": PAPER_SPACE.name},
    )
    unfitted = f"Without judged pairs the weight of d was not fitted: {space.weight_d:g} is the gloss paper's."
    return AxisFunctionsFit(space, regressions, (unfitted, *remarks))


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


def axis_coordinates(stimuli: pd.DataFrame, names: list[str]) -> pd.DataFrame:
    """Coordinates c and d of the named stimuli, one row each in the order of `names`.

    Raises
    ------
    GlossError
        A name is not among the stimuli, or its parameters are impossible.
    """
    indexed = stimuli.drop_duplicates("stimulus").set_index("stimulus")
    unknown = [name for name in names if name not in indexed.index]
    if unknown:
        raise GlossError(
            f"The stimulus {unknown[0]!r} was judged, but its rho_d, rho_s and alpha are not known "
            f"({len(unknown)} such). Give a table (`--stimuli`) or the stimulus set that describes it."
        )
    chosen = indexed.loc[names]
    return pd.DataFrame(
        {
            "stimulus": names,
            "c": contrast_gloss(chosen["rho_d"].to_numpy(), chosen["rho_s"].to_numpy()),
            "d": distinctness(chosen["alpha"].to_numpy()),
        }
    )


def rated_along(stimuli: pd.DataFrame, table: pd.DataFrame) -> pd.DataFrame:
    """Mean ratings beside the coordinates: the columns of `mean_ratings`, `c` and `d`."""
    means = mean_ratings(table)
    return means.merge(axis_coordinates(stimuli, list(means["stimulus"])), on="stimulus", validate="one_to_one")


def _require_both_axes(coordinates: pd.DataFrame) -> None:
    for axis, of in (("c", "rho_d and rho_s"), ("d", "alpha")):
        if np.ptp(coordinates[axis]) <= _SAME:
            raise GlossError(
                f"All stimuli that were judged in pairs have the same {axis}, {coordinates[axis].iloc[0]:g}, so that "
                f"the weight of d over that of c cannot be fitted. Judge pairs that differ in {of} too, or leave the "
                "pairs out and fit ratings alone."
            )


def _regressions(
    stimuli: pd.DataFrame, ratings: Mapping[str, pd.DataFrame]
) -> tuple[dict[str, AxisRegression], list[str]]:
    """Regress the mean ratings along each axis, and remark on what they leave open."""
    regressions, remarks = {}, []
    for axis, table in ratings.items():
        if axis not in ("c", "d"):
            raise GlossError(f"Ratings along {axis!r} are not known. Allowed: c or d.")
        try:
            rated = rated_along(stimuli, table)
            if np.ptp(rated["rating"]) <= _SAME * np.abs(rated["rating"]).max():
                same = f"all stimuli have the same mean rating, {rated['rating'].iloc[0]:g}"
                raise GlossError(f"{same}, and there is nothing to fit. Check those sessions, or leave them out.")
            regressions[axis] = regress_ratings(rated[axis].to_numpy(), rated["rating"].to_numpy())
        except GlossError as error:
            raise GlossError(f"Ratings along {axis}: {error}") from None
        remarks += _remarks(axis, table, rated, regressions[axis].slope)
        if axis == "c":
            remarks += _one_lightness(stimuli, rated["stimulus"], "rated along c")
    return regressions, remarks


def _remarks(axis: str, table: pd.DataFrame, rated: pd.DataFrame, slope: float) -> list[str]:
    remarks = []
    flat = [str(name) for name, own in table.groupby("participant_id", sort=False)["rating"] if np.ptp(own) == 0]
    if flat:
        remarks.append(f"Gave all stimuli the same rating along {axis}: {', '.join(flat)}.")
    if slope < 0:
        remarks.append(f"Ratings fall along {axis}, where gloss rises. Was the scale reversed?")
    other = "d" if axis == "c" else "c"
    if np.ptp(rated[other]) > _SAME:
        remarks.append(f"The stimuli rated along {axis} differ in {other} too, which its line does not account for.")
    return remarks


def _one_lightness(stimuli: pd.DataFrame, names: Collection[str], how: str) -> list[str]:
    reflectances = stimuli.loc[stimuli["stimulus"].isin(list(names)), "rho_d"].unique()
    if len(reflectances) > 1:
        return []
    form = "how c depends on lightness cannot be told from them, and its form is the gloss paper's"
    return [f"The stimuli {how} have one lightness (rho_d {reflectances[0]:g}): {form}."]


def _axis_functions(regressions: Mapping[str, AxisRegression]) -> dict[str, AxisFunction]:
    return {
        axis: AxisFunction(fit.slope, fit.intercept, fit.r_squared, fit.n_stimuli) for axis, fit in regressions.items()
    }


def _spanned(stimuli: pd.DataFrame, judged: set[str]) -> dict[str, tuple[float, float]]:
    known = stimuli[stimuli["stimulus"].isin(judged)]
    return {key: (float(known[key].min()), float(known[key].max())) for key in ("rho_d", "rho_s", "alpha")}


def _everyone(judges: Sequence[str], ratings: Mapping[str, pd.DataFrame]) -> list[str]:
    return list(dict.fromkeys([*judges, *(str(one) for table in ratings.values() for one in table["participant_id"])]))
