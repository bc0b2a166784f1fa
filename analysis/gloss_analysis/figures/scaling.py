"""Figure 6 of the gloss paper, and what stands behind it: rotation cost, participants' axis ratios."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from gloss_analysis.confirmatory.scaling import ConfirmatoryFit
from gloss_analysis.figures.labels import name_ticks
from gloss_analysis.figures.style import BLUE, ORANGE, draw_stimuli, legend_below, new_figure, tidy
from gloss_analysis.study.analysis import StudyAnalysis
from gloss_analysis.uncertainty.ellipses import Ellipse, ellipse

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = [
    "configuration_regions",
    "draw_axis_ratios",
    "draw_configuration",
    "draw_identity_configuration",
    "draw_rotation_cost",
]


def draw_configuration(analysis: StudyAnalysis) -> "Figure":
    """Draw the weighted two-dimensional solution, permuted and reflected towards (c, d), never turned (figure 6).

    Ellipses, where participants could be resampled, are the 95 % regions of the stimuli.
    """
    from matplotlib.patches import Ellipse as EllipsePatch

    reading = analysis.axes
    points = analysis.plane.coordinates[:, reading.order] * reading.sign
    figure = new_figure(4.8, 3.3)
    axes = figure.add_subplot(xlabel="dimension matched to c", ylabel="dimension matched to d", aspect="equal")
    draw_stimuli(axes, points[:, 0], points[:, 1], _stimuli(analysis), zorder=2)
    for region in configuration_regions(analysis):
        drawn = EllipsePatch(tuple(region.centre), *(2 * region.semi_axes), angle=region.angle_deg, fc=BLUE, ec=BLUE)
        drawn.set(alpha=0.35, linewidth=0.8, zorder=1)
        axes.add_patch(drawn)
    reach = 0.55 * np.abs(points).max()
    for axis, colour in (("c", ORANGE), ("d", BLUE)):
        direction = reading.vectors[axis].direction[reading.order] * reading.sign
        corner = points.min(axis=0)
        axes.annotate(
            "",
            xy=tuple(corner + reach * direction),
            xytext=tuple(corner),
            arrowprops={"arrowstyle": "->", "color": colour, "lw": 1.8},
        )
        axes.annotate(axis, tuple(corner + 1.06 * reach * direction), color=colour, ha="center", va="center")
    legend_below(axes)
    tidy(axes)
    return figure


def configuration_regions(analysis: StudyAnalysis) -> tuple[Ellipse, ...]:
    """95 % region of every stimulus in the plane of `draw_configuration`; empty where nobody could be resampled."""
    if analysis.resampled is None:
        return ()
    reading = analysis.axes
    replicates = analysis.resampled.coordinates[:, :, reading.order] * reading.sign
    return tuple(ellipse(name, replicates[:, k]) for k, name in enumerate(analysis.plane.stimuli))


def draw_identity_configuration(analysis: StudyAnalysis) -> "Figure":
    """Draw the common space without weights, turned so that c rises along its first dimension."""
    points = analysis.axes.identity_rotated
    figure = new_figure(4.8, 3.3)
    axes = figure.add_subplot(xlabel="dimension 1, along c", ylabel="dimension 2", aspect="equal")
    draw_stimuli(axes, points[:, 0], points[:, 1], _stimuli(analysis))
    legend_below(axes)
    tidy(axes)
    return figure


def draw_rotation_cost(analysis: StudyAnalysis) -> "Figure":
    """Stress after turning the weighted solution's axes, with participants' weights fitted anew."""
    reading = analysis.axes
    figure = new_figure(4.6, 3.2)
    axes = figure.add_subplot(xlabel="rotation of the axes (degrees)", ylabel="Stress-1, weights fitted anew")
    axes.plot(reading.rotation_deg, reading.rotation_stress1, "o-", color=BLUE, ms=4)
    axes.axhline(analysis.plane.stress1, color="0.6", lw=0.8)
    tidy(axes)
    return figure


def draw_axis_ratios(
    fit: ConfirmatoryFit, simulated: pd.DataFrame | None, *, intervals: Mapping[str, tuple[float, float]]
) -> "Figure":
    """Weight of d over weight of c: each participant, the population's interval, and the truth where it is known.

    `intervals` are those of `ratio_intervals`; who is not in them is drawn without a bar.
    """
    figure = new_figure(5.2, 3.4)
    axes = figure.add_subplot(xlabel="participant", ylabel="weight of d / weight of c")
    place = np.arange(len(fit.participants))
    ratios = np.array([weights.ratio for weights in fit.individual])
    ends = np.array([intervals.get(name, (np.nan, np.nan)) for name in fit.participants])
    bars = np.vstack([ratios - ends[:, 0], ends[:, 1] - ratios])
    axes.errorbar(place, ratios, yerr=bars, fmt="o", color=BLUE, lw=1, capsize=2, label="recovered")
    if simulated is not None:
        truth = simulated.set_index("participant_id")["ratio"].reindex(list(fit.participants))
        axes.plot(place, truth, "_", color="black", ms=14, label="true, of the simulated observer")
    if fit.population_ci95 is not None:
        axes.axhspan(*fit.population_ci95, color=BLUE, alpha=0.12, lw=0, label="95 % interval, population")
    axes.axhline(fit.population_ratio, color=BLUE, lw=0.9)
    axes.axhline(1.78, color=ORANGE, lw=0.9, ls="--", label="the paper's 1.78")
    name_ticks(axes, "x", place, fit.participants)
    axes.set_ylim(bottom=0)
    axes.legend(frameon=False, fontsize=8, loc="lower right")
    tidy(axes)
    return figure


def _stimuli(analysis: StudyAnalysis) -> pd.DataFrame:
    return analysis.study.stimuli.set_index("stimulus").loc[list(analysis.plane.stimuli)]
