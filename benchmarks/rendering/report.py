"""What `benchmarks/render.py` says: run time beside error, run time at equal error, and both in a plot."""

import math
from collections.abc import Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from rich.table import Table

from gloss_analysis.figures.style import BLUE, ORANGE, new_figure, tidy
from gloss_stimuli.scene import Scene
from glossspace.files import whole_file
from rendering.methods import COEFFICIENTS, EXACT, STOCK, USUAL_LEVELS, Point

GREEN = "#009E73"  # the third of Okabe and Ito's colours
COLORS = {STOCK: ORANGE, COEFFICIENTS: GREEN, EXACT: BLUE}
HALF_A_CODE = 0.5


def run_table(scene: Scene, points: Sequence[Point]) -> Table:
    """What was measured."""
    table = Table("paint", "method", "work", title=f"Measured, {scene.film.width} x {scene.film.height} pixels")
    for heading in (
        "CPU-s\none image", "\none of 27", "error in codes\n50 %", "\n99 %", "\n99.9 %", "own\nestimate",
        "relative\nMSE", "mean off by\n%",
    ):  # fmt: skip
        table.add_column(heading, justify="right")
    for paint, runs in by_paint(points).items():
        for point in (point for own in runs.values() for point in own):
            mean = f"{100 * point.mean_off:+.4f}"
            if point.method != EXACT:  # whose pixels do not err independently
                mean += f" ± {100 * point.mean_off_error:.4f}"
            table.add_row(
                paint, point.method, point.effort, f"{point.cpu_s:.2f}", f"{point.cpu_s_of_set:.2f}",
                *(f"{error:.3f}" for error in (*point.percentiles, point.estimate)), f"{point.relative_mse:.1e}", mean,
            )  # fmt: skip
            paint = ""  # once is enough
        table.add_section()
    return table


def equal_error_table(points: Sequence[Point]) -> Table:
    """CPU seconds to one error: measured of the exact renderer, extrapolated of the others."""
    table = Table("paint", "error", "exact at", title="CPU-s at equal error in codes on 99.9 % of the pixels")
    for heading in (
        "stock\nextrapolated", "times its\nlongest run", "coefficients\none image", "extrapolated\none of 27",
        "exact\none image", "measured\none of 27", "stock / exact\none image", "\none of 27",
    ):  # fmt: skip
        table.add_column(heading, justify="right")
    for paint, runs in by_paint(points).items():
        stock, coefficients = runs[STOCK][-1], runs[COEFFICIENTS][-1]
        # What the user gets for half a code, though a coarser rung may be within it too.
        good = [point for point in runs[EXACT] if point.effort == USUAL_LEVELS and point.error <= HALF_A_CODE]
        for error, point in [(HALF_A_CODE, point) for point in good] + [(point.error, point) for point in runs[EXACT]]:
            more, more_coefficients = ((run.error / error) ** 2 for run in (stock, coefficients))
            needed = more * stock.cpu_s
            numbers = [
                needed, more, more_coefficients * coefficients.cpu_s, more_coefficients * coefficients.cpu_s_of_set,
                point.cpu_s, point.cpu_s_of_set, needed / point.cpu_s, needed / point.cpu_s_of_set,
            ]  # fmt: skip
            table.add_row(paint, f"{error:.2f}", point.effort, *(f"{n:,.{2 if n < 10 else 0}f}" for n in numbers))
            paint = ""
        table.add_section()
    return table


def decline(points: Sequence[Point]) -> str:
    """Powers of CPU time with which the errors of path tracing fell from the shortest to the longest run."""
    powers: dict[str, list[str]] = {STOCK: [], COEFFICIENTS: []}
    for runs in by_paint(points).values():
        for method, own in powers.items():
            first, last = runs[method][0], runs[method][-1]
            own.append(f"{math.log(last.error / first.error) / math.log(last.cpu_s / first.cpu_s):.2f}")
    return "; ".join(f"{', '.join(own)} ({method})" for method, own in powers.items())


def by_paint(points: Sequence[Point]) -> dict[str, dict[str, list[Point]]]:
    """Points of each paint and method, those of least work first."""
    grouped: dict[str, dict[str, list[Point]]] = {}
    for point in points:
        grouped.setdefault(point.paint, {}).setdefault(point.method, []).append(point)
    return grouped


def plot(points: Sequence[Point], file: Path) -> None:
    """Error against CPU time, a panel for each paint."""
    groups = by_paint(points)
    figure = new_figure(4.0 * len(groups), 4.6)
    panels = figure.subplots(1, len(groups), sharex=True, sharey=True, squeeze=False)[0]
    for axes, (paint, runs) in zip(panels, groups.items(), strict=True):
        axes.axhline(HALF_A_CODE, color="0.6", linewidth=0.8)
        for method, own in runs.items():
            errors = [point.error for point in own]
            draw(axes, method, [point.cpu_s for point in own], errors, label=f"{method}, one image")
            if method != STOCK:
                draw(
                    axes,
                    method,
                    [point.cpu_s_of_set for point in own],
                    errors,
                    label=f"{method}, one of 27",
                    hollow=True,
                )
        axes.set(title=paint, xlabel="CPU seconds an image")
        tidy(axes)
    panels[0].set_ylabel("error on 99.9 % of the pixels, 8-bit codes")
    panels[0].annotate("half a code", (0.01, HALF_A_CODE), xycoords=("axes fraction", "data"), va="bottom", fontsize=8)
    panels[0].plot([], [], "--", color="0.4", linewidth=0.8, label="extrapolated")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, frameon=False, fontsize=8)
    with whole_file(file) as temporary, temporary.open("wb") as stream:
        FigureCanvasAgg(figure).print_png(stream)


def draw(
    axes: Axes, method: str, seconds: Sequence[float], errors: Sequence[float], *, label: str, hollow: bool = False
) -> None:
    """Draw the runs of a method, and where path tracing would get to half a code."""
    color = COLORS[method]
    axes.loglog(
        seconds, errors, ":" if hollow else "-", marker="o", color=color, mfc="white" if hollow else color, label=label
    )
    if method != EXACT:
        needed = seconds[-1] * (errors[-1] / HALF_A_CODE) ** 2
        axes.plot([seconds[-1], needed], [errors[-1], HALF_A_CODE], "--", color=color, linewidth=0.8)
