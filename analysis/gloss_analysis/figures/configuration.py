"""Pictures of any scaling solution: its configuration, and its participants' weights."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from gloss_analysis.figures.labels import COLOURS, Level, label_legend, levels_of, name_points, name_ticks, name_vectors
from gloss_analysis.figures.style import new_figure, tidy
from gloss_analysis.mds import MdsSolution
from glossspace.errors import GlossError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_configuration_of", "draw_subject_weights"]

# Beyond this a sheet is no longer printed or read.
_LARGEST_INCHES = 30.0


def draw_configuration_of(
    solution: MdsSolution,
    *,
    factor: "pd.Series | Sequence[Any] | None" = None,
    regions: "Sequence[Sequence[float]] | np.ndarray | None" = None,
    labels: bool = True,
) -> "Figure":
    """Draw the group space: a dot plot in one dimension, a map in two, all pairs of dimensions in more.

    Parameters
    ----------
    solution : MdsSolution
    factor : Series or sequence, optional
        What the stimuli differ in, shown by colour and symbol; a Series with names as index is matched by them.
    regions : sequence of (centre x, centre y, semi-major axis, semi-minor axis, angle in degrees), optional
        Ellipses of two-dimensional solutions, such as 95 % regions of the stimuli, in their order; the angle is that of
        the major axis from dimension 1, counter-clockwise. A row of NaN draws none.
    labels : bool
        Whether to write the names of the stimuli.

    Returns
    -------
    Figure

    Raises
    ------
    GlossError
        The factor or the regions do not fit the stimuli, or regions are given in other than two dimensions.
    """
    levels = levels_of(factor, solution.stimuli)
    ellipses = None if regions is None else _checked_regions(solution, regions)
    if solution.n_dims == 1:
        figure = _draw_line(solution, levels, labels)
    elif solution.n_dims == 2:
        width, height = np.ptp(solution.coordinates, axis=0)
        figure = new_figure(5.2, float(np.clip(1.1 + 4.1 * height / max(width, 1e-12), 2.8, 6.0)))
        axes = figure.add_subplot(aspect="equal")
        _draw_plane(axes, solution.coordinates, levels)
        if ellipses is not None:
            _draw_regions(axes, ellipses, levels)
        axes.set(xlabel="dimension 1", ylabel="dimension 2")
        axes.margins(0.12)
        axes.autoscale_view()
    else:
        figure = _draw_pairs(solution, levels)
    _legend(figure, levels)
    if labels and solution.n_dims > 1:
        for axes, (first, second) in zip(figure.axes, _pairs(solution.n_dims), strict=True):
            name_points(figure, axes, solution.coordinates[:, [first, second]], solution.stimuli)
    return figure


def draw_subject_weights(
    solution: MdsSolution, *, factor: "pd.Series | Sequence[Any] | None" = None, labels: bool = True
) -> "Figure":
    """Draw participants' dimension weights: as vectors in two dimensions, as bars in one or more than two.

    Parameters
    ----------
    solution : MdsSolution
        Weighted or generalised; in the latter, the lengths of the rows of participants' matrices.
    factor : Series or sequence, optional
        What the participants differ in, as for `draw_configuration_of`; two dimensions only.
    labels : bool
        Whether to write the names of the participants.

    Returns
    -------
    Figure
        A dotted line marks equal weights of two dimensions.

    Raises
    ------
    GlossError
        The solution has no weights, or the factor does not fit the participants.
    """
    if solution.model == "identity":
        raise GlossError("A solution of the identity model has no weights to draw. Scale with model='weighted'.")
    levels = levels_of(factor, solution.participants)
    if solution.n_dims != 2:
        return _draw_weight_bars(solution, labels)
    figure = new_figure(4.8, 4.8)
    axes = figure.add_subplot(xlabel="weight of dimension 1", ylabel="weight of dimension 2", aspect="equal")
    weights = solution.dimension_weights
    for level in levels:
        for row in level.rows:
            axes.plot([0, weights[row, 0]], [0, weights[row, 1]], color=level.colour, lw=0.7, alpha=0.45)
    _draw_plane(axes, weights, levels)
    largest = name_vectors(axes, weights, solution.participants) if labels else 1.1 * weights.max()
    axes.plot([0, largest], [0, largest], color="0.75", lw=0.8, ls=":", zorder=0)
    axes.set(xlim=(0, largest), ylim=(0, largest))
    _legend(figure, levels)
    return figure


def _draw_plane(axes: "Axes", points: np.ndarray, levels: list[Level]) -> None:
    for level in levels:
        x, y = points[level.rows].T
        axes.plot(x, y, level.marker, color=level.colour, ms=6, mec="white", mew=0.4, clip_on=False)
    tidy(axes)


def _draw_line(solution: MdsSolution, levels: list[Level], labels: bool) -> "Figure":
    # Names on a line run into each other; one row for each stimulus keeps them apart.
    figure = new_figure(4.8, min(1.1 + 0.2 * len(solution.stimuli), _LARGEST_INCHES))
    axes = figure.add_subplot(xlabel="dimension 1")
    position = solution.coordinates[:, 0]
    row = np.empty(len(position))
    row[np.argsort(position, kind="stable")] = np.arange(len(position))
    axes.hlines(row, position.min(), position, color="0.88", lw=0.8, zorder=0)
    _draw_plane(axes, np.column_stack([position, row]), levels)
    order = np.argsort(row)
    name_ticks(axes, "y", row[order], [solution.stimuli[i] if labels else "" for i in order], fontsize=8)
    axes.set_ylim(-0.7, len(row) - 0.3)
    return figure


def _draw_pairs(solution: MdsSolution, levels: list[Level]) -> "Figure":
    p, points = solution.n_dims, solution.coordinates
    side = min(3.1 * (p - 1), _LARGEST_INCHES)
    figure = new_figure(side, side)
    grid = figure.add_gridspec(p - 1, p - 1)
    # One scale for all panels, so that the sizes of dimensions can be compared.
    middle, half = (points.max(axis=0) + points.min(axis=0)) / 2, 0.6 * np.ptp(points, axis=0).max()
    for first, second in _pairs(p):
        axes = figure.add_subplot(grid[second - 1, first], aspect="equal")
        _draw_plane(axes, points[:, [first, second]], levels)
        axes.set_xlim(middle[first] - half, middle[first] + half)
        axes.set_ylim(middle[second] - half, middle[second] + half)
        axes.set(xlabel=f"dimension {first + 1}", ylabel=f"dimension {second + 1}")
    return figure


def _pairs(n_dims: int) -> list[tuple[int, int]]:
    return [(first, second) for second in range(1, n_dims) for first in range(second)]


def _checked_regions(solution: MdsSolution, regions: "Sequence[Sequence[float]] | np.ndarray") -> np.ndarray:
    ellipses = np.asarray(regions, dtype=float)
    expected = (len(solution.stimuli), 5)
    if solution.n_dims != 2 or ellipses.shape != expected:
        raise GlossError(
            f"Regions of shape {ellipses.shape} do not fit {expected[0]} stimuli in {solution.n_dims} dimensions. "
            "Allowed: two dimensions, and centre x, centre y, two semi-axes and an angle for each stimulus."
        )
    return ellipses


def _draw_regions(axes: "Axes", ellipses: np.ndarray, levels: list[Level]) -> None:
    from matplotlib.patches import Ellipse

    for level in levels:
        for x, y, major, minor, angle in ellipses[level.rows]:
            if np.isfinite([x, y, major, minor, angle]).all():
                drawn = Ellipse((x, y), 2 * major, 2 * minor, angle=angle, fc=level.colour, ec=level.colour, zorder=1)
                drawn.set(alpha=0.22, linewidth=0.8)
                axes.add_patch(drawn)


def _draw_weight_bars(solution: MdsSolution, labels: bool) -> "Figure":
    m, p = solution.dimension_weights.shape
    figure = new_figure(min(1.6 + 0.14 * m * (p + 1), _LARGEST_INCHES), 3.4)
    axes = figure.add_subplot(ylabel="dimension weight")
    width = 0.84 / p
    place = np.arange(m)
    for dimension, weights in enumerate(solution.dimension_weights.T):
        offset = (dimension - (p - 1) / 2) * width
        colour = COLOURS[dimension % len(COLOURS)]
        axes.bar(place + offset, weights, 0.92 * width, color=colour, label=f"dimension {dimension + 1}")
    name_ticks(axes, "x", place, solution.participants if labels else [""] * m, fontsize=8, rotation=90)
    axes.set_xlim(-0.6, m - 0.4)
    axes.set_ylim(0, None)
    tidy(axes)
    if p > 1:
        figure.legend(frameon=False, fontsize=8, loc="outside upper center", ncols=min(p, 4))
    return figure


def _legend(figure: "Figure", levels: list[Level]) -> None:
    if levels[0].label:
        from matplotlib.lines import Line2D

        handles = [Line2D([], [], color=one.colour, marker=one.marker, ls="", ms=6) for one in levels]
        names = [one.label for one in levels]
        columns = max(1, min(len(names), 40 // max(8, max(map(len, names)) + 4)))
        legend = figure.legend(
            handles, [" "] * len(names), frameon=False, fontsize=8, loc="outside lower center", ncols=columns
        )
        label_legend(legend, names)
