"""Are two axes independent? What other axes gain, beside what they gain by chance."""

from typing import TYPE_CHECKING

from gloss_analysis.figures.style import BLUE, ORANGE, new_figure, tidy

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gloss_analysis.confirmatory.orthogonality import Orthogonality

__all__ = ["draw_orthogonality"]


def draw_orthogonality(found: "Orthogonality") -> "Figure":
    """Draw the part of the mean square stress that turned and correlated axes take away, and that of permutations.

    Parameters
    ----------
    found : Orthogonality
        From `gloss_analysis.confirmatory.orthogonality.check_orthogonality`.

    Returns
    -------
    Figure
        Two panels: a line for the judgements, bars for the permutations, in per cent.
    """
    figure = new_figure(6.4, 2.6)
    panels = figure.subplots(1, 2, sharey=True)
    for axes, title, drop, null, p in (
        (panels[0], "axes turned alike for all", found.drop_rotated, found.null_rotated, found.p_rotated),
        (panels[1], "axes correlated, each alone", found.drop_correlated, found.null_correlated, found.p_correlated),
    ):
        axes.hist(100 * null, bins=20, color=BLUE, alpha=0.55, label="axes independent (permuted)")
        axes.axvline(100 * drop, color=ORANGE, lw=1.6, label="judgements")
        axes.set_title(f"{title}: p = {p:.2g}", fontsize=9)
        axes.set_xlabel("% of the mean square stress")
        axes.set_xlim(left=0)
        tidy(axes)
    panels[0].set_ylabel("permutations")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, frameon=False, fontsize=8, loc="outside lower center", ncols=2)
    return figure
