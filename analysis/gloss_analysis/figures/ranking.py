"""Mean ranks against the predicted distance from the reference: a ranking study in one picture."""

from typing import TYPE_CHECKING

import numpy as np

from gloss_analysis.figures.style import BLUE, new_figure, tidy

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gloss_analysis.ranking.ranking_study import RankingStudy

__all__ = ["draw_ranking"]


def draw_ranking(
    study: "RankingStudy", *, metric: str = "gloss distance from the reference", n_simulated: int = 0
) -> "Figure":
    """Mean rank of each stimulus, with its interval, against its predicted distance; contours as bands.

    Parameters
    ----------
    study : RankingStudy
    metric : str
        What to write along the axis of the distances.
    n_simulated : int
        How many of the participants are simulated, to be said in the title.

    Returns
    -------
    Figure
        One point a stimulus. A band marks stimuli that lie on one isogloss contour.

    Examples
    --------
    >>> import pandas as pd
    >>> from gloss_analysis.ranking.rank_table import Rankings
    >>> from gloss_analysis.ranking.ranking_study import study_ranking
    >>> rankings = Rankings(("01",), ("a", "b", "c"), np.array([[[1.0, 2.0, 3.0]]]))
    >>> order = pd.DataFrame({"distance": [0.0, 0.1, 0.2], "angle_deg": 45.0}, index=list("abc"))
    >>> figure = draw_ranking(study_ranking(rankings, order))
    >>> figure.axes[0].get_ylabel()
    'mean rank'
    """
    figure = new_figure(4.8, 3.9)
    axes = figure.add_subplot()
    axes.set_xlabel(metric, parse_math=False)  # names of spaces come from files: dollar signs are no formulas
    table = study.stimuli
    x, y = table["distance"].to_numpy(), table["mean_rank"].to_numpy()
    if study.contours is not None:
        margin = study.contours.tolerance / 4
        for level in np.unique(study.contours.level):
            on_it = x[study.contours.level == level]
            if len(on_it) > 1:
                axes.axvspan(on_it.min() - margin, on_it.max() + margin, color="0.9", lw=0)
    low, high = table["low"].to_numpy(), table["high"].to_numpy()
    known = np.isfinite(low)
    if known.any():
        axes.vlines(x[known], low[known], high[known], color=BLUE, lw=1, alpha=0.6)
    axes.plot(x, y, "o", color=BLUE, ms=4, mec="none")
    axes.set_ylabel("mean rank, 95 % interval" if known.any() else "mean rank")
    title = f"tau-b {study.mean_tau_b:.2f}"
    if study.ceiling is not None:
        title += f"; participants with the others {study.ceiling:.2f}"
    if n_simulated:
        title += f"\nsimulated participants: {n_simulated}"
    axes.set_title(title, fontsize=9)
    tidy(axes)
    return figure
