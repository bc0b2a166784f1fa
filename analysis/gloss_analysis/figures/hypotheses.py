"""Hypotheses about a gloss axis, as figure and table: the ratings over each, and their stress on the judged pairs."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from gloss_analysis.figures.style import BLUE, ORANGE, new_figure, tidy
from gloss_analysis.hypotheses import Hypothesis, compare_hypotheses
from gloss_analysis.magnitude import Equalisation, mean_ratings

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_hypotheses", "hypotheses_table"]


def draw_hypotheses(
    hypotheses: Sequence[Hypothesis],
    stimuli: pd.DataFrame,
    ratings: pd.DataFrame,
    *,
    confirmed: pd.DataFrame | None = None,
    equalise: Equalisation = "linear",
) -> "Figure":
    """Draw mean ratings with 95 % intervals over each hypothesis, with the line; then the stress of each, if given.

    Parameters
    ----------
    hypotheses, stimuli, ratings, equalise
        See `compare_hypotheses`.
    confirmed : DataFrame, optional
        From `confirm_hypotheses`: adds a panel of Stress-1, in all pairs and in those of large alpha.

    Returns
    -------
    Figure

    Raises
    ------
    GlossError
        As of `compare_hypotheses`.
    """
    compared = compare_hypotheses(hypotheses, stimuli, ratings, equalise=equalise)
    means = mean_ratings(ratings, equalise=equalise)
    known = stimuli.drop_duplicates("stimulus").set_index("stimulus", drop=False).loc[means["stimulus"].tolist()]
    rating = means["rating"].to_numpy()
    # Matplotlib leaves out the bars of a single participant's NaN.
    bars = np.vstack([rating - means["ci_low"], means["ci_high"] - rating])
    panels = len(hypotheses) + (confirmed is not None)
    figure = new_figure(3.1 * panels, 3.2)
    grid = figure.subplots(1, panels, squeeze=False)[0]
    for axes, hypothesis, row in zip(grid, hypotheses, compared.itertuples(), strict=False):
        x = hypothesis.values(known)
        axes.errorbar(x, rating, yerr=bars, fmt="o", color=BLUE, ms=4, lw=0.9)
        ends = np.array([x.min(), x.max()])
        axes.plot(ends, rating.mean() + row.slope * (ends - x.mean()), color=ORANGE)  # a least-squares line's centre
        axes.set_title(f"r² = {row.r_squared:.3f}", fontsize=9)
        axes.set_xlabel(hypothesis.name, parse_math=False)
        tidy(axes)
    grid[0].set_ylabel("mean rating")
    if confirmed is not None:
        _draw_stress(grid[-1], confirmed)
    return figure


def hypotheses_table(compared: pd.DataFrame, confirmed: pd.DataFrame | None = None) -> pd.DataFrame:
    """Results in words and digits for a report, one row a hypothesis; AICc above the lowest.

    Parameters
    ----------
    compared : DataFrame
        From `compare_hypotheses`.
    confirmed : DataFrame, optional
        From `confirm_hypotheses`; a hypothesis without a row there gets dashes.

    Returns
    -------
    DataFrame of str
    """
    above = compared["aicc"] - compared["aicc"].min()
    columns = {
        "hypothesis": compared["hypothesis"],
        "r²": compared["r_squared"].map("{:.3f}".format),
        "adjusted r²": compared["adjusted_r_squared"].map("{:.3f}".format),
        "leave-one-out error": compared["leave_one_out_error"].map("{:.3g}".format),
        "ΔAICc": above.map("{:.1f}".format),
    }
    table = pd.DataFrame(columns)
    if confirmed is not None:
        stress = confirmed.set_index("hypothesis").reindex(compared["hypothesis"])
        for column, label in (
            ("stress1", "Stress-1"),
            ("stress1_large_alpha", "Stress-1, largest α"),
            ("stress1_other_pairs", "Stress-1, other pairs"),
        ):
            table[label] = ["–" if np.isnan(value) else f"{value:.3f}" for value in stress[column]]
    return table


def _draw_stress(axes: "Axes", confirmed: pd.DataFrame) -> None:
    place = np.arange(len(confirmed))
    axes.plot(confirmed["stress1"], place, "o", color=BLUE, label="all pairs")
    axes.plot(confirmed["stress1_large_alpha"], place, "D", color=ORANGE, label="pairs of large α")
    axes.set_yticks(place, confirmed["hypothesis"], parse_math=False)
    axes.set(xlabel="Stress-1", ylim=(len(confirmed) - 0.5, -0.5))  # the first on top, as in the table
    axes.set_xlim(left=0)
    axes.legend(frameon=False, fontsize=8, loc="lower center", bbox_to_anchor=(0.5, 1), ncols=2)
    tidy(axes)
