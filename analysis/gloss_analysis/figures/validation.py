"""Predicted against judged differences: how well a metric does, in one picture."""

from typing import TYPE_CHECKING

import numpy as np

from gloss_analysis.figures.style import BLUE, ORANGE, new_figure, tidy

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gloss_analysis.validation import MetricValidation

__all__ = ["draw_predicted_against_judged"]


def draw_predicted_against_judged(validation: "MetricValidation", *, metric: str = "predicted difference") -> "Figure":
    """Mean judgements of pairs against predictions, and the line of proportionality that STRESS measures from.

    Parameters
    ----------
    validation : MetricValidation
    metric : str
        What to write along the axis of the predictions.

    Returns
    -------
    Figure
        One point a pair. The judgements' unit is their root mean square, since each participant has a scale of their
        own.

    Examples
    --------
    >>> from gloss_analysis.dissimilarity import Dissimilarities
    >>> from gloss_analysis.validation import validate_metric
    >>> pairs = Dissimilarities(("a", "b", "c"), ("1",), np.array([[1.0, 2.0, 3.0]]))
    >>> figure = draw_predicted_against_judged(validate_metric(pairs, np.array([1.0, 2.0, 4.0])))
    >>> figure.axes[0].get_xlabel()
    'predicted difference'
    """
    figure = new_figure(4.6, 3.8)
    axes = figure.add_subplot()
    # Names of spaces come from files: dollar signs in them are no formulas.
    axes.set_xlabel(metric, parse_math=False)
    axes.set_ylabel("judged difference, mean of participants")
    known = ~np.isnan(validation.judged)
    x, y = validation.predicted[known], validation.judged[known]
    axes.plot(x, y, "o", color=BLUE, ms=3.5, mec="none", alpha=0.6, label="pair")
    if np.isfinite(validation.scale):
        end = x.max()
        axes.plot([0, end], [0, end / validation.scale], "-", color=ORANGE, lw=1.2, label="proportional")
    title = f"STRESS {validation.pooled_stress:.1f} %"
    if validation.ceiling is not None:
        title += f"; observers {validation.mean_stress:.1f} %, among themselves {validation.ceiling:.1f} %"
    axes.set_title(title, fontsize=9)
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=0)
    axes.legend(frameon=False, fontsize=8, loc="upper left")
    tidy(axes)
    return figure
