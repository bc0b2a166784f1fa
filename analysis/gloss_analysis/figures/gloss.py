"""Figures 4 and 7 to 10 of the gloss paper: the stimuli, the rated axes, the gloss space and its envelope."""

from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from gloss_analysis.figures.style import BLUE, ORANGE, draw_stimuli, legend_below, new_figure, tidy
from gloss_analysis.ratings.magnitude import AxisRegression
from gloss_analysis.ratings.rating_uncertainty import line_band
from glossspace.metric import GlossSpace, Paint, fixed_energy_contrast_gloss, lightness, max_contrast_gloss
from glossspace.stimulus_set import StimulusSet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["draw_composite", "draw_envelope", "draw_gloss_space", "draw_ratings"]

_AXIS_LABELS = {"c": "contrast gloss c", "d": "distinctness of image d = 1 − α"}


def draw_composite(stimuli: StimulusSet) -> "Figure":
    """All images of a set on one sheet (figure 4): a row for each lightness, a column for each (ρs, α).

    The images hold code values for the calibrated display and are shown as they are.
    """
    from PIL import Image

    table = stimuli.table()
    rows = sorted(table["rho_d"].unique(), reverse=True)
    columns = sorted(set(zip(table["rho_s"], table["alpha"], strict=True)))
    figure = new_figure(1.3 * len(columns), 1.38 * len(rows))
    grid = figure.subplots(len(rows), len(columns), squeeze=False)
    for axes in grid.ravel():
        axes.set(xticks=[], yticks=[])
        axes.spines[:].set_visible(False)
    for stimulus in table.itertuples():
        axes = grid[rows.index(stimulus.rho_d), columns.index((stimulus.rho_s, stimulus.alpha))]
        with Image.open(stimuli.image_path(stimulus.stimulus)) as image:
            axes.imshow(np.asarray(image.resize((256, 256), Image.Resampling.LANCZOS)), cmap="gray", vmin=0, vmax=255)
    for axes, (rho_s, alpha) in zip(grid[0], columns, strict=True):
        axes.set_title(f"ρs {rho_s:g}\nα {alpha:g}", fontsize=9)
    for axes, rho_d in zip(grid[:, 0], rows, strict=True):
        axes.set_ylabel(f"ρd {rho_d:g}", fontsize=9)
    return figure


def draw_ratings(rated: pd.DataFrame, axis: str, fit: AxisRegression) -> "Figure":
    """Mean ratings with 95 % t intervals against an axis, with the fitted line and its 95 % band (figures 7 and 8)."""
    figure = new_figure(4.8, 3.6)
    axes = figure.add_subplot(xlabel=_AXIS_LABELS[axis], ylabel="mean rating (0–100)")
    # A single participant has no interval: NaN, which matplotlib leaves out.
    bars = np.vstack([rated["rating"] - rated["ci_low"], rated["ci_high"] - rated["rating"]])
    axes.errorbar(rated[axis], rated["rating"], yerr=bars, fmt="o", color=BLUE, ms=4, lw=0.9)
    ends = np.array([rated[axis].min(), rated[axis].max()])
    along = np.linspace(ends[0], ends[1], 101)
    axes.fill_between(along, *line_band(rated[axis], rated["rating"], along), color=ORANGE, alpha=0.18, lw=0)
    axes.plot(ends, fit.intercept + fit.slope * ends, color=ORANGE, label=f"line, r² = {fit.r_squared:.3f}")
    axes.legend(frameon=False)
    tidy(axes)
    return figure


def draw_gloss_space(stimuli: pd.DataFrame, space: GlossSpace) -> "Figure":
    """Stimuli in the gloss space with lightness as third axis, and seen along it (figure 9).

    Bars on the left show where the levels of d would lie at both ends of the interval of their weight, about the middle
    of all.
    """
    figure = new_figure(10, 4.2)
    own_c, own_d = space.coordinates(Paint(*(stimuli[key].to_numpy() for key in Paint._fields)))
    c, d = space.weight_c * own_c, space.weight_d * own_d
    grid = figure.add_gridspec(1, 2, width_ratios=[1.25, 1], wspace=0.12)
    solid: Any = figure.add_subplot(grid[0], projection="3d")
    grey = (stimuli["lightness"].to_numpy() / 100)[:, np.newaxis].repeat(3, axis=1)
    solid.scatter(c, d, stimuli["lightness"], c=grey, edgecolors="black", s=34, depthshade=False)
    solid.set(xlabel="c", ylabel=f"{space.weight_d:.2f} d", zlabel="lightness L*")
    solid.view_init(elev=22, azim=-58)
    solid.set_box_aspect(None, zoom=0.86)  # leaves room for the label of the upright axis
    flat = figure.add_subplot(grid[1], xlabel="c", ylabel=f"{space.weight_d:.2f} d", aspect="equal")
    draw_stimuli(flat, c, d, stimuli)
    if space.weight_d_ci95 is not None:
        levels = np.unique(own_d) - own_d.mean()
        low, high = np.sort(space.weight_c * np.outer(space.weight_d_ci95, levels), axis=0) + d.mean()
        flat.vlines(np.full(len(levels), c.min() - 0.08 * np.ptp(c)), low, high, color=ORANGE, lw=2)
    legend_below(flat)
    tidy(flat)
    return figure


def draw_envelope(rho_s: float = 0.099) -> "Figure":
    """Largest contrast gloss for each lightness, and that of one specular reflectance (figure 10)."""
    figure = new_figure(4.8, 3.4)
    axes = figure.add_subplot(xlabel="lightness L*", ylabel="contrast gloss c")
    all_lightness = np.linspace(0, 100, 401)
    axes.plot(all_lightness, max_contrast_gloss(all_lightness), color=BLUE, label="largest possible, ρd + ρs = 1")
    fixed = np.linspace(0, float(lightness(1 - rho_s)), 400)  # lighter paints cannot have this much
    axes.plot(
        fixed, fixed_energy_contrast_gloss(fixed, rho_s), color=ORANGE, ls="--", label=f"fixed energy, ρs = {rho_s:g}"
    )
    axes.legend(frameon=False)
    tidy(axes)
    return figure
