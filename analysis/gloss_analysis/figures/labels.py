"""Names in figures, as they are written in the user's files, and symbols for the levels of a factor."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from scipy.optimize import isotonic_regression

from gloss_analysis.figures.style import BLUE, ORANGE
from glossspace.errors import GlossError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.legend import Legend
    from matplotlib.text import Annotation

__all__ = ["COLOURS", "Level", "label_legend", "levels_of", "name_points", "name_ticks", "name_vectors"]

COLOURS = (BLUE, ORANGE, "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "black")
"""Okabe and Ito's colours without yellow, which is too pale for a point on white."""

# Eight symbols with seven colours: 56 levels differ in one or the other, the first seven in both.
_MARKERS = "osD^vP*X"
_ABSENT = "not given"
# Places for a name round its point, best first: where it starts (-1), is centred (0) or ends (1).
_PLACES = ((1, 1), (-1, 1), (1, -1), (-1, -1), (1, 0), (-1, 0), (0, 1), (0, -1))


@dataclass(frozen=True)
class Level:
    """One level of a factor: which rows have it, and how they are drawn.

    Attributes
    ----------
    label : str
        Empty where there is no factor.
    rows : ndarray of int
    colour, marker : str
    """

    label: str
    rows: np.ndarray
    colour: str
    marker: str


def levels_of(factor: "pd.Series | Sequence[Any] | None", names: Sequence[str]) -> list[Level]:
    """Group things by a categorical factor.

    Parameters
    ----------
    factor : Series, sequence of length n, or None
        A Series whose index holds names is matched by them; anything else by place. Levels are in the order of the
        categories if there are any, otherwise of their appearance; absent values come last.
    names : sequence of str, length n

    Returns
    -------
    list of Level

    Raises
    ------
    GlossError
        The factor has no value for a name, several for one, or another length.
    """
    n = len(names)
    if factor is None:
        return [Level("", np.arange(n), BLUE, "o")]
    if isinstance(factor, pd.Series) and not isinstance(factor.index, pd.RangeIndex):
        lacking = [name for name in names if name not in factor.index]
        if lacking:
            raise GlossError(f"The factor has no value for {lacking[0]!r} ({len(lacking)} such). Add a row for each.")
        if factor.index.duplicated().any():
            raise GlossError(f"The factor has several values for {factor.index[factor.index.duplicated()][0]!r}.")
        factor = factor.loc[list(names)]
    values = pd.Series(factor if isinstance(factor, pd.Series) else list(factor)).reset_index(drop=True)
    if len(values) != n:
        raise GlossError(f"A factor of {len(values)} values does not fit {n} names. Give one value for each.")
    present = values.dropna()
    ordered = values.cat.categories if isinstance(values.dtype, pd.CategoricalDtype) else present.unique()
    levels = [
        Level(
            f"{value:g}" if isinstance(value, float) else str(value),
            np.flatnonzero(values == value),
            COLOURS[index % len(COLOURS)],
            _MARKERS[index % len(_MARKERS)],
        )
        for index, value in enumerate(value for value in ordered if (values == value).any())
    ]
    if len(present) < n:
        levels.append(Level(_ABSENT, np.flatnonzero(values.isna()), "0.65", "o"))
    return levels


def name_ticks(axes: "Axes", which: str, places: np.ndarray, names: Sequence[str], **options: Any) -> None:
    """Write names at the ticks of the "x" or "y" axis, a dollar as a dollar and not as the start of a formula."""
    axis = axes.xaxis if which == "x" else axes.yaxis
    axis.set_ticks(places, list(names), parse_math=False, **options)


def label_legend(legend: "Legend", labels: Sequence[str]) -> None:
    """Write labels into a legend as they are: matplotlib takes dollars for formulas and hides leading underscores."""
    for text, label in zip(legend.get_texts(), labels, strict=True):
        text.set_parse_math(False)
        text.set_text(label)


def name_points(figure: "Figure", axes: "Axes", points: np.ndarray, names: Sequence[str]) -> None:
    """Write names beside points, each where it covers least of the other names and points.

    Parameters
    ----------
    figure : Figure
    axes : Axes
        Of the figure, with its limits set: they decide what lies near what.
    points : ndarray, shape (n, 2)
    names : sequence of str, length n
    """
    size = 8 if len(names) <= 30 else 6.5
    written = [
        axes.annotate(name, tuple(point), (0, 0), textcoords="offset points", fontsize=size, parse_math=False)
        for name, point in zip(names, points, strict=True)
    ]
    figure.draw_without_rendering()  # lays the figure out, so that points and names have places on it
    pixels_per_point = figure.dpi / 72
    centres = axes.transData.transform(points)
    reach = 4 * pixels_per_point
    taken = [np.array([*(centre - 0.8 * reach), *(centre + 0.8 * reach)]) for centre in centres]
    inside = np.array(axes.bbox.extents)
    for own, (annotation, centre) in enumerate(zip(written, centres, strict=True)):
        box = annotation.get_window_extent()
        extent = np.array([box.width, box.height])
        others = np.array(taken[:own] + taken[own + 1 :]).reshape(-1, 4)
        corners = [centre + reach * np.array(place) + extent * (np.array(place) - 1) / 2 for place in _PLACES]
        costs = [_covered(corner, corner + extent, others, inside) for corner in corners]
        best = int(np.argmin(costs))
        taken.append(np.array([*corners[best], *(corners[best] + extent)]))
        _move(annotation, reach / pixels_per_point * np.array(_PLACES[best]), _PLACES[best])


def name_vectors(axes: "Axes", vectors: np.ndarray, names: Sequence[str]) -> float:
    """Write names beyond the ends of vectors in the first quadrant, round an arc and apart from each other.

    Parameters
    ----------
    axes : Axes
        With both limits from 0, of equal aspect, and some inches wide.
    vectors : ndarray, shape (m, 2)
        Coordinates 0 or more.
    names : sequence of str, length m

    Returns
    -------
    float
        Upper limit for both axes that leaves room for the names.
    """
    angle = np.degrees(np.arctan2(vectors[:, 1], vectors[:, 0]))
    radius = 1.08 * np.linalg.norm(vectors, axis=1).max()
    order = np.argsort(angle, kind="stable")
    rank = np.arange(len(names))
    gap = min(2.6, 90 / len(names))  # degrees: the height of a name at that radius, while there is room
    # Least squares with a smallest distance between neighbours is monotone regression of what the gaps leave.
    places = isotonic_regression(angle[order] - gap * rank).x + gap * rank
    places += max(0.0, -places[0]) - max(0.0, places[-1] - 90)
    reach = []
    for row, place in zip(order, places, strict=True):
        towards = np.array([np.cos(np.radians(place)), np.sin(np.radians(place))])
        start = radius * towards
        leader = np.array([vectors[row], 0.99 * start])
        axes.plot(leader[:, 0], leader[:, 1], color="0.8", lw=0.5, zorder=0)
        axes.text(
            start[0],
            start[1],
            names[row],
            rotation=place,
            rotation_mode="anchor",
            va="center",
            fontsize=7.5,
            parse_math=False,
        )
        reach.append((radius * (1 + 0.022 * len(names[row])) * towards).max())  # letters about .02 of the axis wide
    return float(max(reach))


def _covered(low: np.ndarray, high: np.ndarray, others: np.ndarray, inside: np.ndarray) -> float:
    overlap = np.minimum(high, others[:, 2:]) - np.maximum(low, others[:, :2])
    shared = np.prod(np.maximum(overlap, 0.0), axis=1).sum()
    kept = np.maximum(np.minimum(high, inside[2:]) - np.maximum(low, inside[:2]), 0.0)
    return float(shared + np.prod(high - low) - np.prod(kept))


def _move(annotation: "Annotation", offset: np.ndarray, place: tuple[int, int]) -> None:
    annotation.set_position((float(offset[0]), float(offset[1])))
    annotation.set_horizontalalignment(("right", "center", "left")[place[0] + 1])
    annotation.set_verticalalignment(("top", "center", "bottom")[place[1] + 1])
