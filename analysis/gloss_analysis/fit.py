"""A gloss space from judgements: the weights by confirmatory MDS, the axis functions by regression of ratings."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from gloss_analysis.confirmatory import ConfirmatoryFit, confirm_axes
from gloss_analysis.dissimilarity import Dissimilarities
from gloss_analysis.magnitude import AxisRegression, mean_ratings, regress_ratings
from gloss_analysis.mds.disparities import Level, Ties
from glossspace.errors import GlossError
from glossspace.metric import AxisFunction, GlossSpace, contrast_gloss, distinctness

__all__ = ["GlossSpaceFit", "axis_coordinates", "fit_gloss_space", "labelled_observers", "rated_along"]


@dataclass(frozen=True)
class GlossSpaceFit:
    """A fitted gloss space with the analyses that it rests on.

    Attributes
    ----------
    space : GlossSpace
    confirmatory : ConfirmatoryFit
        Of the pairs, along (c, d).
    regressions : mapping of str to AxisRegression
        Of the mean ratings, for each axis that was rated.
    """

    space: GlossSpace
    confirmatory: ConfirmatoryFit
    regressions: Mapping[str, AxisRegression]


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
        A judged stimulus is not among `stimuli`, or an analysis cannot be made; the message says why.
    """
    coordinates = axis_coordinates(stimuli, list(pairs.stimuli))
    confirmatory = confirm_axes(pairs, coordinates[["c", "d"]].to_numpy(), axes=("c", "d"), level=level, ties=ties)
    regressions = {}
    for axis, table in ratings.items():
        rated = rated_along(stimuli, table)
        if np.ptp(rated["rating"]) == 0:
            raise GlossError(
                f"All stimuli have the same mean rating along {axis}, {rated['rating'].iloc[0]:g}: there is nothing to "
                "fit. Check those sessions, or leave them out of the dataset."
            )
        regressions[axis] = regress_ratings(rated[axis].to_numpy(), rated["rating"].to_numpy())
    judged = set(pairs.stimuli).union(*(table["stimulus"] for table in ratings.values()))
    known = stimuli[stimuli["stimulus"].isin(judged)]
    space = GlossSpace(
        weight_c=1.0,
        weight_d=confirmatory.population_ratio,
        name=name,
        weight_d_ci95=confirmatory.population_ci95,
        axis_functions={
            axis: AxisFunction(fit.slope, fit.intercept, fit.r_squared, fit.n_stimuli)
            for axis, fit in regressions.items()
        },
        stimulus_range={key: (float(known[key].min()), float(known[key].max())) for key in ("rho_d", "rho_s", "alpha")},
        provenance=dict(provenance or {}) | {"level": level, "ties": ties, "participants": list(pairs.participants)},
    )
    return GlossSpaceFit(space, confirmatory, regressions)


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
    """Mean ratings beside the coordinates: columns `stimulus`, `rating`, `standard_error`, `c`, `d`."""
    means = mean_ratings(table)
    return means.merge(axis_coordinates(stimuli, list(means["stimulus"])), on="stimulus", validate="one_to_one")
