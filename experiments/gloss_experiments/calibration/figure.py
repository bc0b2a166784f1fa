"""The picture of a calibration: the curve through the readings, and what it misses on patches it has not seen."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gloss_experiments.calibration.patches import largest_code
from gloss_experiments.calibration.record import Calibration
from glossspace.errors import GlossError
from glossspace.files import whole_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["FIGURE_SUFFIXES", "check_figure_name", "draw_calibration", "save_figure"]

FIGURE_SUFFIXES = (".png", ".svg", ".pdf")
# Okabe and Ito's colours, which people with a colour deficiency tell apart as well.
_COLOURS = {"gray": "#404040", "red": "#D55E00", "green": "#009E73", "blue": "#0072B2"}
_VERIFY = "#CC79A7"


def check_figure_name(path: str | Path) -> None:
    """Refuse a name that no picture can have, before long work.

    Raises
    ------
    GlossError
        Its suffix is not .png, .svg or .pdf.
    """
    if Path(path).suffix.lower() not in FIGURE_SUFFIXES:
        raise GlossError(f"Invalid figure '{path}'. Allowed: a file name that ends in {', '.join(FIGURE_SUFFIXES)}.")


def draw_calibration(calibration: Calibration) -> "Figure":
    """Draw luminance against code value, and below it the residuals of every verification patch in ΔL*."""
    from matplotlib.figure import Figure
    from matplotlib.ticker import FuncFormatter

    figure = Figure(figsize=(6.4, 6.0), layout="constrained")
    upper, lower = figure.subplots(2, sharex=True, height_ratios=(2, 1))
    said = "SIMULATED readings of " if calibration.simulated else ""
    name = " ".join(calibration.screen.name.split())
    # A dollar sign in a name would begin a formula.
    title = f"{said}{name}, {calibration.measured_at:%Y-%m-%d}\n{calibration.model.name}"
    upper.set_title(title.replace("$", r"\$"), loc="left", fontsize=10)
    top = largest_code(calibration.bits)
    codes = np.linspace(0, top, 256).round()
    model = calibration.model
    for curve, added in model.added_cd_m2.items():
        upper.plot(codes, model.black_cd_m2 + added(codes), color=_COLOURS[curve], linewidth=1, label=f"model, {curve}")
    if "gray" not in model.added_cd_m2:
        gray = model.predict(np.repeat(codes.astype(int)[:, None], 3, axis=1))
        upper.plot(codes, gray, color=_COLOURS["gray"], linewidth=1, label="model, gray")
    _draw_readings(upper, calibration)
    upper.set_yscale("log")
    upper.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    upper.set_ylabel("Luminance (cd/m²)")
    verification = calibration.verification
    place = [max(codes) for codes in verification.codes]
    lower.axhline(0, color="0.7", linewidth=0.8)
    lower.plot(place, verification.delta_l, "o", color=_VERIFY, markersize=5)
    lower.set_ylabel("Measured less\npredicted, ΔL*")
    lower.set_xlabel("Code value")
    reach = max(1.0, 1.15 * max(abs(value) for value in verification.delta_l))
    lower.set_ylim(-reach, reach)
    for axes in (upper, lower):
        axes.spines[["top", "right"]].set_visible(False)
    upper.legend(frameon=False, fontsize=8, loc="lower right", ncols=2)
    return figure


def _draw_readings(axes: "object", calibration: Calibration) -> None:
    plot = axes.plot  # type: ignore[attr-defined]
    drawn = set()
    for reading in calibration.readings.items:
        patch = reading.patch
        if patch.purpose not in ("fit", "verify") or reading.luminance_cd_m2 <= 0:
            continue
        lit = [name for name in ("red", "green", "blue") if getattr(patch, name)]
        colour = _COLOURS[lit[0]] if len(lit) == 1 else _COLOURS["gray"]
        verified = patch.purpose == "verify"
        label = None if patch.purpose in drawn else ("verification, not fitted" if verified else "readings of the fit")
        drawn.add(patch.purpose)
        plot(
            max(patch.codes), reading.luminance_cd_m2, "D" if verified else "o", label=label, markersize=5,
            color=_VERIFY if verified else colour, markerfacecolor="none",
        )  # fmt: skip


def save_figure(calibration: Calibration, path: str | Path) -> None:
    """Draw a calibration into a file (PNG, SVG or PDF by its suffix), whole or not at all."""
    check_figure_name(path)
    figure = draw_calibration(calibration)
    with whole_file(path) as temporary:
        figure.savefig(temporary, dpi=150)
