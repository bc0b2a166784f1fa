"""Predicted against judged differences: how well a metric does, in one picture."""

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from gloss_analysis.figures.labels import COLOURS, name_ticks
from gloss_analysis.figures.style import BLUE, ORANGE, new_figure, tidy
from gloss_analysis.validation.metric_check import mean_interval

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gloss_analysis.validation.metric_validation import MetricValidation

__all__ = ["draw_metric_stress", "draw_predicted_against_judged"]


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
    >>> from gloss_analysis.judgements.dissimilarity import Dissimilarities
    >>> from gloss_analysis.validation.metric_validation import validate_metric
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


def draw_metric_stress(table: pd.DataFrame) -> "Figure":
    """STRESS of each participant by several metrics, and the mean of all with its 95 % t interval.

    Parameters
    ----------
    table : DataFrame
        From `gloss_analysis.validation.metric_check.MetricCheck.table`.

    Returns
    -------
    Figure
        One symbol a metric. A participant without a value by one of them has no symbol there.
    """
    series = (
        ("stress_left_out", "space fitted to the others", "o"),
        ("stress_paper", "the paper's space", "s"),
        ("stress_unweighted", "unweighted space", "^"),
        ("stress_other_observers", "mean of the other participants", "_"),
    )
    names = [*table["participant_id"], "mean"]
    figure = new_figure(min(2.2 + 0.42 * len(names), 30.0), 3.4)
    axes = figure.add_subplot(ylabel="STRESS (%)")
    place = np.arange(len(names), dtype=float)
    for index, (column, label, marker) in enumerate(series):
        values, colour = table[column].to_numpy(), COLOURS[(*range(3), 6)[index]]
        own = place + 0.16 * (index - 1.5)
        if np.isfinite(values).any():
            interval = mean_interval(values)
            mean = np.nanmean(values)
            bar = None if interval is None else [[mean - interval[0]], [interval[1] - mean]]
            axes.plot(own[:-1], values, marker, color=colour, ms=5, label=label)
            axes.errorbar(own[-1:], [mean], yerr=bar, fmt=marker, color=colour, ms=5, lw=1.1, capsize=2)
    axes.axvline(len(names) - 1.5, color="0.8", lw=0.8)
    name_ticks(axes, "x", place, names, fontsize=8)
    axes.set_ylim(bottom=0)
    figure.legend(frameon=False, fontsize=8, loc="outside lower center", ncols=2)
    tidy(axes)
    return figure
