"""Figures 11 and 12 of the gloss paper, drawn from rendered spheres: the isogloss ring and the matched spheres.

Matplotlib is imported inside the functions, so that whoever only renders does not wait for it.
"""

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gloss_stimuli.applied_set import AppliedSet, space_label
from gloss_stimuli.images import read_codes
from glossspace.files import whole_file
from glossspace.metric import isogloss_contour
from glossspace.stimulus_set import StimulusSet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["draw_isogloss_ring", "draw_matched_spheres", "save_figure"]

# Largest width and height of a picture inside a figure: sharp in print at about an inch, and the files stay small.
THUMBNAIL = 256

# Of the free space between neighbours, what their pictures fill; the rest shows the contour.
FILLED = 0.8

NAME_OF_LIGHTNESS = {0.767: "white", 0.193: "gray", 0.03: "black"}
"""What the gloss paper calls the paints of its figure 12."""


def draw_isogloss_ring(applied: AppliedSet, rendered: StimulusSet) -> "Figure":
    """Draw the plane of c and d with each sphere at its place, and the contours of equal gloss distance.

    Parameters
    ----------
    applied : AppliedSet
        From `isogloss_ring`.
    rendered : StimulusSet
        Its pictures.

    Returns
    -------
    Figure
        The axes are scaled by the weights of the space, so that contours are circles. Where no paint is on a contour,
        it is dotted.
    """
    from matplotlib.figure import Figure

    space, table = applied.space, applied.table
    figure = Figure(figsize=(7.2, 7.2), layout="constrained")
    axes = figure.add_subplot(xlabel="contrast gloss c", ylabel="distinctness of image d")
    scale = np.array([space.weight_c, space.weight_d])
    places = table[["c", "d"]].to_numpy()
    side = FILLED * _room(places * scale)
    width, height = rendered.image_size
    half = side / 2 * np.array([width, height]) / max(width, height) / scale
    radii = sorted({radius for radius in table["radius"] if radius > 0})
    for radius in radii:
        contour = isogloss_contour(applied.reference, radius=radius, n=720, space=space)
        closed = np.r_[np.arange(720), 0]
        c, d, reachable = contour.c[closed], contour.d[closed], contour.reachable[closed]
        axes.plot(np.where(reachable, c, np.nan), np.where(reachable, d, np.nan), "-", color="0.35", lw=1)
        axes.plot(np.where(reachable, np.nan, c), np.where(reachable, np.nan, d), ":", color="0.6", lw=1)
    for name, place in zip(table["stimulus"], places, strict=True):
        low, high = place - half, place + half
        axes.imshow(
            _thumbnail(rendered, name), cmap="gray", vmin=0, vmax=255, aspect="auto", zorder=3,
            extent=(low[0], high[0], low[1], high[1]), interpolation="antialiased",
        )  # fmt: skip
    reach = (max(radii) + 0.75 * side) / scale
    axes.set_xlim(places[0, 0] - reach[0], places[0, 0] + reach[0])
    axes.set_ylim(places[0, 1] - reach[1], places[0, 1] + reach[1])
    axes.set_aspect(space.weight_d / space.weight_c)
    for radius in radii:
        direction = np.radians(_free_direction(table.loc[table["radius"] == radius, "angle_deg"].to_numpy()))
        place = places[0] + radius * np.array([np.cos(direction), np.sin(direction)]) / scale
        box = {"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": "none"}
        axes.text(
            float(place[0]),
            float(place[1]),
            f"D = {radius:g}",
            ha="center",
            va="center",
            fontsize=8,
            bbox=box,
            zorder=4,
        )
    axes.text(places[0, 0], places[0, 1] - 1.05 * half[1], "reference", ha="center", va="top", fontsize=8)
    axes.set_title(f"Equal gloss distances D from the reference\nSpace: {space_label(space)}", parse_math=False)
    axes.spines[["top", "right"]].set_visible(False)
    return figure


def draw_matched_spheres(applied: AppliedSet, rendered: StimulusSet) -> "Figure":
    """Draw two rows of spheres, the same physical gloss above the same apparent gloss, each with its c and d.

    Parameters
    ----------
    applied : AppliedSet
        From `matched_spheres`.
    rendered : StimulusSet
        Its pictures.

    Returns
    -------
    Figure
        A column for each diffuse reflectance. A place stays empty where no paint is as glossy as the reference.
    """
    from matplotlib.figure import Figure

    table = applied.table
    columns = list(dict.fromkeys(table["rho_d"]))
    figure = Figure(figsize=(0.6 + 2.3 * len(columns), 6.2), layout="constrained")
    panels = figure.subplots(2, len(columns), squeeze=False)
    rows = {"same_physical": "the same physical gloss ρs, α", "same_apparent": "the same apparent gloss c, d"}
    for line, (kind, title) in zip(panels, rows.items(), strict=True):
        for axes, rho_d in zip(line, columns, strict=True):
            axes.set_xticks([])
            axes.set_yticks([])
            axes.spines[:].set_visible(False)
            found = table[table[kind] & (table["rho_d"] == rho_d)]
            if found.empty:
                axes.text(0.5, 0.5, "no paint of this lightness\nis so glossy", ha="center", transform=axes.transAxes)
                continue
            sphere = found.iloc[0]
            axes.imshow(_thumbnail(rendered, sphere["stimulus"]), cmap="gray", vmin=0, vmax=255)
            axes.set_xlabel(
                f"c = {sphere['c']:.3f}, d = {sphere['d']:.2f}\nρs = {sphere['rho_s']:.3g}, α = {sphere['alpha']:.3g}"
            )
        line[0].set_ylabel(title)
    for axes, rho_d in zip(panels[0], columns, strict=True):
        name = NAME_OF_LIGHTNESS.get(rho_d)
        axes.set_title(f"{name}, ρd = {rho_d:g}" if name else f"ρd = {rho_d:g}", fontsize=10)
    figure.suptitle(f"Space: {space_label(applied.space)}", fontsize=10, parse_math=False)
    return figure


def save_figure(figure: "Figure", stem: Path) -> tuple[Path, ...]:
    """Write a figure as PNG, SVG and PDF, each whole or not at all; the same figure gives the same bytes.

    Parameters
    ----------
    figure : Figure
    stem : Path
        The files' name without its ending.

    Returns
    -------
    tuple of Path
        In that order.

    Raises
    ------
    GlossError
        A file cannot be written.
    """
    import matplotlib

    formats: dict[str, dict[str, Any]] = {
        "png": {"Software": None},
        "svg": {"Date": None},
        "pdf": {"CreationDate": None},
    }
    made = []
    for kind, metadata in formats.items():
        path = stem.with_name(f"{stem.name}.{kind}")
        with (
            whole_file(path) as temporary,
            matplotlib.rc_context({"svg.hashsalt": "glossspace"}),
            warnings.catch_warnings(),
        ):
            # The name of a space in a script that the font lacks shows as boxes; whoever looks sees that.
            warnings.filterwarnings("ignore", message="Glyph .* missing from font")
            figure.savefig(temporary, format=kind, dpi=170, metadata=metadata)
        made.append(path)
    return tuple(made)


def _thumbnail(rendered: StimulusSet, name: str) -> np.ndarray:
    from PIL import Image

    picture = Image.fromarray(read_codes(rendered.image_path(name)))
    picture.thumbnail((THUMBNAIL, THUMBNAIL), Image.Resampling.BOX, reducing_gap=None)
    return np.asarray(picture)


def _room(places: np.ndarray) -> float:
    """Side of the largest squares round the places that do not overlap."""
    apart = np.abs(places[:, None] - places[None]).max(axis=-1)
    return float(apart[~np.eye(len(places), dtype=bool)].min())


def _free_direction(angle_deg: np.ndarray) -> float:
    """Middle of the widest gap between points on a contour; of equal ones, that nearest above the axis of c."""
    ordered = np.sort(angle_deg)
    gaps = np.diff(np.r_[ordered, ordered[0] + 360])
    widest = int(np.argmax(np.round(gaps, 6)))
    return float(ordered[widest] + gaps[widest] / 2)
