"""Hypotheses about a gloss axis, as figure, table and words: ratings over each, and their stress on judged pairs."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from gloss_analysis.figures.style import BLUE, ORANGE, new_figure, tidy
from gloss_analysis.hypotheses.comparison import Hypothesis, compare_hypotheses
from gloss_analysis.ratings.magnitude import Equalisation, mean_ratings
from glossspace.errors import GlossError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_hypotheses", "hypotheses_in_words", "hypotheses_table"]

_IN_A_ROW = 4


def draw_hypotheses(
    hypotheses: Sequence[Hypothesis],
    stimuli: pd.DataFrame,
    ratings: pd.DataFrame | None,
    *,
    confirmed: pd.DataFrame | None = None,
    equalise: Equalisation = "linear",
    title: str = "",
) -> "Figure":
    """Draw mean ratings with 95 % intervals over each hypothesis, with the line; then the stress of each, if given.

    Parameters
    ----------
    hypotheses, stimuli, equalise
        See `compare_hypotheses`.
    ratings : DataFrame or None
        See `compare_hypotheses`; None draws the panel of stress alone.
    confirmed : DataFrame, optional
        From `confirm_hypotheses`: adds a panel of Stress-1, in all pairs and in those of large alpha.
    title : str
        Above all panels, such as whose judgements they are.

    Returns
    -------
    Figure
        Panels in rows of four.

    Raises
    ------
    GlossError
        Neither ratings nor `confirmed`, or as of `compare_hypotheses`.
    """
    if ratings is None and confirmed is None:
        raise GlossError("There is nothing to draw. Give ratings, or the result of `confirm_hypotheses`, or both.")
    over = () if ratings is None else tuple(hypotheses)
    panels = len(over) + (confirmed is not None)
    # The panel of stress has names beside it: in several rows it takes what room is left, two places at least.
    wide = confirmed is not None and panels > _IN_A_ROW
    columns = min(panels, _IN_A_ROW)
    n_rows = -(-(panels + wide) // _IN_A_ROW)
    figure = new_figure(3.1 * columns if panels > 1 else 5.0, 3.2 * n_rows)
    # Rows of their own, so that long names in one leave no gap in another.
    rows = [part.add_gridspec(1, columns) for part in figure.subfigures(n_rows, 1, squeeze=False)[:, 0]]
    axes = [rows[k // columns].figure.add_subplot(rows[k // columns][k % columns]) for k in range(len(over))]
    if ratings is not None:
        _draw_ratings(axes, over, stimuli, ratings, equalise)
    if confirmed is not None:
        last = rows[len(over) // columns]
        place = last[len(over) % columns :] if wide else last[len(over)]
        _draw_stress(last.figure.add_subplot(place), confirmed)
    if title:
        figure.suptitle(title, fontsize=10, parse_math=False)
    return figure


def _draw_ratings(
    grid: "Sequence[Axes]",
    hypotheses: Sequence[Hypothesis],
    stimuli: pd.DataFrame,
    ratings: pd.DataFrame,
    equalise: Equalisation,
) -> None:
    compared = compare_hypotheses(hypotheses, stimuli, ratings, equalise=equalise)
    means = mean_ratings(ratings, equalise=equalise)
    known = stimuli.drop_duplicates("stimulus").set_index("stimulus", drop=False).loc[means["stimulus"].tolist()]
    rating = means["rating"].to_numpy()
    # Matplotlib leaves out the bars of a single participant's NaN.
    bars = np.vstack([rating - means["ci_low"], means["ci_high"] - rating])
    for axes, hypothesis, row in zip(grid, hypotheses, compared.itertuples(), strict=True):
        x = hypothesis.values(known)
        axes.errorbar(x, rating, yerr=bars, fmt="o", color=BLUE, ms=4, lw=0.9)
        ends = np.array([x.min(), x.max()])
        axes.plot(ends, rating.mean() + row.slope * (ends - x.mean()), color=ORANGE)  # a least-squares line's centre
        axes.set_title(f"r² = {row.r_squared:.3f}", fontsize=9)
        axes.set_xlabel(hypothesis.name, parse_math=False)
        tidy(axes)
    for axes in grid[::_IN_A_ROW]:
        axes.set_ylabel("mean rating")


def hypotheses_table(compared: pd.DataFrame | None, confirmed: pd.DataFrame | None = None) -> pd.DataFrame:
    """Results in words and digits for a report, one row a hypothesis; AICc above the lowest.

    Parameters
    ----------
    compared : DataFrame or None
        From `compare_hypotheses`.
    confirmed : DataFrame, optional
        From `confirm_hypotheses`; a hypothesis without a row there gets dashes. One of the two is needed.

    Returns
    -------
    DataFrame of str

    Raises
    ------
    GlossError
        Neither is given.
    """
    if compared is None:
        if confirmed is None:
            raise GlossError("There is nothing to show. Give the result of one of the two tests.")
        table = confirmed[["hypothesis"]].copy()
    else:
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
        stress = confirmed.set_index("hypothesis").reindex(table["hypothesis"])
        for column, label in (
            ("stress1", "Stress-1"),
            ("stress1_large_alpha", "Stress-1, largest α"),
            ("stress1_other_pairs", "Stress-1, other pairs"),
        ):
            table[label] = ["–" if np.isnan(value) else f"{value:.3f}" for value in stress[column]]
    return table


def hypotheses_in_words(compared: pd.DataFrame | None, confirmed: pd.DataFrame | None) -> tuple[str, ...]:
    """Which hypothesis each task favours, in words.

    Parameters
    ----------
    compared : DataFrame, optional
        From `compare_hypotheses`.
    confirmed : DataFrame, optional
        From `confirm_hypotheses`.

    Returns
    -------
    tuple of str

    Examples
    --------
    >>> found = pd.DataFrame({"hypothesis": ["a", "b"], "stress1": [0.1, 0.2], "n_best": [5, 4], "n_participants": 9})
    >>> hypotheses_in_words(None, found)
    ('Pairs: a has the lowest stress (0.1000; b 0.2000), and is the best for 5 of 9 participants.',)
    """
    said, winners = [], []
    if compared is not None:
        by = compared.sort_values("leave_one_out_error", kind="stable")
        if len(by) > 1 and not np.isnan(by["leave_one_out_error"].iloc[0]):
            best, second = by.iloc[0], by.iloc[1]
            above = second["aicc"] - best["aicc"]
            criterion = "" if np.isnan(above) else f", AICc {abs(above):.1f} {'lower' if above >= 0 else 'higher'}"
            said.append(
                f"Ratings: {best['hypothesis']} predicts left-out stimuli best (error "
                f"{best['leave_one_out_error']:.3g}; {second['hypothesis']} "
                f"{second['leave_one_out_error']:.3g}{criterion})."
            )
            winners.append(best["hypothesis"])
        falling = compared.loc[compared["slope"] < 0, "hypothesis"]
        if len(falling):
            said.append(f"Ratings fall where it rises: {', '.join(falling)}.")
    if confirmed is not None and len(confirmed) > 1:
        best, second = (confirmed.sort_values("stress1", kind="stable").iloc[k] for k in (0, 1))
        said.append(
            f"Pairs: {best['hypothesis']} has the lowest stress ({best['stress1']:.4f}; {second['hypothesis']} "
            f"{second['stress1']:.4f}), and is the best for {best['n_best']} of "
            f"{best['n_participants']} participants."
        )
        winners.append(best["hypothesis"])
    if len(set(winners)) == 2:
        said.append("The two tasks do not favour the same hypothesis.")
    return tuple(said)


def _draw_stress(axes: "Axes", confirmed: pd.DataFrame) -> None:
    place = np.arange(len(confirmed))
    axes.plot(confirmed["stress1"], place, "o", color=BLUE, label="all pairs")
    axes.plot(confirmed["stress1_large_alpha"], place, "D", color=ORANGE, label="pairs of large α")
    axes.set_yticks(place, confirmed["hypothesis"], parse_math=False)
    axes.set(xlabel="Stress-1", ylim=(len(confirmed) - 0.5, -0.5))  # the first on top, as in the table
    axes.set_xlim(left=0)
    axes.legend(frameon=False, fontsize=8, loc="lower center", bbox_to_anchor=(0.5, 1), ncols=2)
    tidy(axes)
