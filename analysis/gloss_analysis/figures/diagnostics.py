"""Pictures by which a scaling solution is judged: stress curve, Shepard diagrams, stress per point."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from gloss_analysis.figures.labels import name_ticks
from gloss_analysis.figures.style import BLUE, ORANGE, new_figure, tidy
from gloss_analysis.mds import MdsSolution
from glossspace.errors import GlossError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_shepard", "draw_stress_curve", "draw_stress_per_point"]

_LARGEST_INCHES = 30.0
_GREEN = "#009E73"
_LARGEST_DRAWN = 1e300


def draw_stress_curve(
    curve: Sequence[MdsSolution],
    *,
    random: np.ndarray | None = None,
    permuted: np.ndarray | None = None,
    held_out: np.ndarray | None = None,
) -> "Figure":
    """Stress against the number of dimensions, beside that of data without structure and of judgements held out.

    Parameters
    ----------
    curve : sequence of MdsSolution
    random, permuted : ndarray, shape (n_replicates, n_solutions), optional
        Stress-1 of random and of permuted data, columns in the order of `curve`: median, and the middle 90 %.
    held_out : ndarray, shape (n_replicates, n_solutions), optional
        Stress-1 of judgements that were not fitted: mean, and its standard error over replicates.

    Returns
    -------
    Figure

    Raises
    ------
    GlossError
        The curve is empty, or an array has not one column for each solution.
    """
    if not curve:
        raise GlossError("A stress curve needs solutions. Scale in one or more numbers of dimensions first.")
    figure = new_figure(4.6, 3.2)
    axes = figure.add_subplot(xlabel="number of dimensions", ylabel="Stress-1")
    dims = np.array([solution.n_dims for solution in curve])
    bands = (("random data", random, "0.45", "--"), ("permuted judgements", permuted, ORANGE, "-."))
    for label, replicates, colour, style in bands:
        if replicates is not None:
            _draw_band(axes, dims, _checked_replicates(replicates, dims, label), label, colour, style)
    if held_out is not None:
        label = "held-out judgements"
        replicates = _checked_replicates(held_out, dims, label)
        known = np.isfinite(replicates)
        counted = known.any(axis=0)
        replicates, known = replicates[:, counted], known[:, counted]
        count = known.sum(axis=0)
        mean = np.nansum(replicates, axis=0) / count
        squares = np.nansum((replicates - mean) ** 2, axis=0)
        # A single replicate says nothing of its error: no bar.
        error = np.sqrt(squares / np.maximum(count - 1, 1) / count)
        axes.errorbar(dims[counted], mean, yerr=error, fmt="s:", color=_GREEN, ms=4, lw=1.1, capsize=2, label=label)
    axes.plot(dims, [solution.stress1 for solution in curve], "o-", color=BLUE, label="judgements")
    axes.set_xticks(dims)
    axes.set_ylim(bottom=0)
    tidy(axes)
    if any(one is not None for one in (random, permuted, held_out)):
        figure.legend(frameon=False, fontsize=8, loc="outside lower center", ncols=2)
    return figure


def draw_shepard(solution: MdsSolution) -> "Figure":
    """Shepard diagrams, one panel a participant: distances as points, disparities as a line, against the judgements.

    Parameters
    ----------
    solution : MdsSolution

    Returns
    -------
    Figure

    Raises
    ------
    GlossError
        A judgement is above 1e300, where matplotlib cannot compute the ticks of an axis.
    """
    largest = float(np.nanmax(solution.dissimilarities, initial=0.0))
    if largest > _LARGEST_DRAWN:
        raise GlossError(
            f"Judgements up to {largest:g} cannot be drawn, on an axis up to {_LARGEST_DRAWN:g}. Divide them all by "
            "one number: the scaling stays the same."
        )
    m = len(solution.participants)
    n_columns = int(np.ceil(np.sqrt(m)))
    n_rows = -(-m // n_columns)
    side = 4.2 if m == 1 else 1.9
    width, height = min(0.5 + side * n_columns, _LARGEST_INCHES), min(0.7 + side * n_rows, _LARGEST_INCHES)
    figure = new_figure(width, height)
    grid = figure.subplots(n_rows, n_columns, squeeze=False, sharex=_one_scale(solution), sharey=True)
    for axes in grid.ravel()[m:]:
        axes.remove()
    for k, axes in enumerate(grid.ravel()[:m]):
        judged = ~np.isnan(solution.disparities[k])
        x, distance, disparity = (
            values[k, judged] for values in (solution.dissimilarities, solution.distances, solution.disparities)
        )
        order = np.lexsort((disparity, x))
        axes.plot(x, distance, "o", color=BLUE, ms=3, mec="none", alpha=0.6, label="distance" if k == 0 else None)
        label = "disparity" if k == 0 else None
        axes.plot(x[order], disparity[order], "-", color=ORANGE, lw=1.2, label=label)
        title = solution.participants[k] if m > 1 else f"Stress-1 {solution.source_stress1[k]:.3f}"
        axes.set_title(title, fontsize=9, parse_math=False)
        if m > 1:
            axes.text(0.04, 0.96, f"{solution.source_stress1[k]:.3f}", transform=axes.transAxes, va="top", fontsize=7.5)
        axes.tick_params(labelsize=8)
        if k + n_columns >= m:  # the lowest panel of its column
            axes.tick_params(labelbottom=True)
        tidy(axes)
    # Once for all: a limit set in one panel would keep those after it from widening the axis they share.
    highest = max(np.nanmax(values, initial=0.0) for values in (solution.distances, solution.disparities))
    grid[0, 0].set_ylim(0, 1.05 * highest if highest > 0 else 1)
    figure.supxlabel("judged dissimilarity", fontsize=10)
    figure.supylabel("distance", fontsize=10)
    figure.legend(frameon=False, fontsize=8, loc="outside upper right", ncols=2)
    return figure


def draw_stress_per_point(solution: MdsSolution) -> "Figure":
    """Parts of the stimuli, and of more than one participant, in the squared stress, largest first.

    A dotted line marks what each would have if all had the same part. Numbers beside participants are their Stress-1.

    Parameters
    ----------
    solution : MdsSolution

    Returns
    -------
    Figure
    """
    n, m = len(solution.stimuli), len(solution.participants)
    several = m > 1
    height = min(1.0 + 0.19 * max(n, m if several else 0), _LARGEST_INCHES)
    figure = new_figure(7.6 if several else 4.4, height)
    panels = figure.subplots(1, 1 + several, squeeze=False)[0]
    _draw_parts(panels[0], solution.stress_per_point, solution.stimuli)
    panels[0].set(xlabel="part in the squared stress", title="stimuli")
    if several:
        order = _draw_parts(panels[1], solution.stress_per_source, solution.participants)
        panels[1].set(xlabel="part in the squared stress", title="participants, with Stress-1")
        for place, k in enumerate(order):
            beside = (solution.stress_per_source[k], place)
            number = f"{solution.source_stress1[k]:.3f}"
            paper = {"fc": "white", "ec": "none", "pad": 0.4}
            panels[1].annotate(
                number, beside, xytext=(3, 0), textcoords="offset points", fontsize=7, va="center", bbox=paper
            )
        panels[1].margins(x=0.12)
    for axes in panels:
        axes.title.set_fontsize(10)
        axes.tick_params(axis="x", labelsize=8)
        axes.locator_params(axis="x", nbins=5)
        axes.set_xlim(left=0)
    return figure


def _draw_band(axes: "Axes", dims: np.ndarray, replicates: np.ndarray, label: str, colour: str, style: str) -> None:
    counted = np.isfinite(replicates).any(axis=0)
    low, middle, high = np.nanquantile(replicates[:, counted], (0.05, 0.5, 0.95), axis=0)
    axes.fill_between(dims[counted], low, high, color=colour, alpha=0.18, lw=0)
    axes.plot(dims[counted], middle, color=colour, ls=style, lw=1.1, label=label)


def _checked_replicates(replicates: np.ndarray, dims: np.ndarray, label: str) -> np.ndarray:
    values = np.asarray(replicates, dtype=float)
    if values.ndim != 2 or len(values) == 0 or values.shape[1] != len(dims):
        raise GlossError(
            f"Stress of {label} has the shape {values.shape}. Allowed: one row for each replicate, and one column for "
            f"each of the {len(dims)} solutions."
        )
    return values


def _one_scale(solution: MdsSolution) -> bool:
    """Whether participants judged on scales so alike that one axis shows them all."""
    if not solution.conditional:
        return True
    largest = np.where(np.isnan(solution.dissimilarities), -np.inf, solution.dissimilarities).max(axis=1)
    judged = largest[np.isfinite(largest)]
    return bool(len(judged) == 0 or judged.min() > 0.5 * judged.max())


def _draw_parts(axes: "Axes", parts: np.ndarray, names: Sequence[str]) -> np.ndarray:
    """Bars with the largest on top; returns which part each is, from below."""
    order = np.argsort(parts, kind="stable")
    place = np.arange(len(parts))
    axes.barh(place, parts[order], 0.75, color=BLUE)
    axes.axvline(1 / len(parts), color="0.4", lw=0.9, ls=":")
    name_ticks(axes, "y", place, [names[k] for k in order], fontsize=8)
    axes.set_ylim(-0.7, len(parts) - 0.3)
    tidy(axes)
    return order
