"""One look for all figures: how a stimulus is drawn, and the paper they are drawn on."""

from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["BLUE", "ORANGE", "draw_stimuli", "legend_below", "new_figure", "tidy"]

# Okabe and Ito's colours, which people with a colour deficiency tell apart as well.
BLUE = "#0072B2"
ORANGE = "#D55E00"

_MARKERS = "osD^vP*X"


def new_figure(width: float = 5.2, height: float = 4.2) -> "Figure":
    """Make an empty figure, in inches, without touching matplotlib's global state."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def tidy(axes: "Axes") -> None:
    """Remove the box, leave the two lines that carry numbers."""
    axes.spines[["top", "right"]].set_visible(False)


def legend_below(axes: "Axes") -> None:
    """Place the legend under the axes, in one row, where it hides no point."""
    _, labels = axes.get_legend_handles_labels()
    axes.legend(frameon=False, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=len(labels))


def draw_stimuli(axes: "Axes", x: np.ndarray, y: np.ndarray, stimuli: pd.DataFrame, **options: Any) -> None:
    """Draw stimuli so that their paint can be read: fill for lightness, shape for roughness, size for energy.

    Parameters
    ----------
    axes : Axes
    x, y : ndarray, shape (n,)
    stimuli : DataFrame, n rows
        Columns `rho_d`, `rho_s`, `alpha`, `lightness`, in the order of x and y.
    options
        Passed on to `Axes.scatter`.
    """
    alphas, energies = np.unique(stimuli["alpha"]), np.unique(stimuli["rho_s"])
    for alpha, marker in zip(alphas, _cycle(_MARKERS, len(alphas)), strict=True):
        rows = (stimuli["alpha"] == alpha).to_numpy()
        fill = (stimuli["lightness"].to_numpy()[rows] / 100).clip(0, 1)
        rank = np.searchsorted(energies, stimuli["rho_s"].to_numpy()[rows])
        axes.scatter(
            x[rows],
            y[rows],
            s=28 + 38 * rank,
            c=[(grey, grey, grey) for grey in fill],
            marker=marker,
            edgecolors="black",
            linewidths=0.9,
            label=f"α = {alpha:g}",
            **options,
        )


def _cycle(symbols: str, n: int) -> list[str]:
    return [symbols[index % len(symbols)] for index in range(n)]
