"""Figures of the instruments: the glossmeter paper's figure 6, lobes of reflectance as a polar plot and in space."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from glossspace.instruments.goniospectrophotometer import reflected_spectrum
from glossspace.instruments.refractive_index import refractive_index
from glossspace.instruments.standards import glossmeter_geometry
from glossspace.reflectance import CookTorrance
from glossspace.reflectance.model import ReflectanceModel, direction

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["copper_spectrum", "figure6", "lobe_surface", "polar_lobes", "scan_figure"]

_FIGURE_6_NM = np.arange(380.0, 781.0, 5.0)


def copper_spectrum(
    table: str = "copper_johnson_christy_1972", *, slope: float = 0.84, scale: float = 5.3
) -> pd.DataFrame:
    """Spectrum of a copper sample at 60° under D65 from the paper's Cook–Torrance lobe: figure 6.

    Parameters
    ----------
    table : str
        One of `index_tables`; the paper does not name its own. Hagemann's gives the n = .47 at 589 nm of its figure.
    slope, scale : float
        The lobe's m and c: the unpolished sample of table 2.

    Returns
    -------
    DataFrame
        ``wavelength_nm, illuminant, reflectance_factor, flux, n, k`` from 380 to 780 nm in steps of 5.

    Examples
    --------
    >>> copper = copper_spectrum()
    >>> blue, red = (copper["reflectance_factor"][copper["wavelength_nm"] == nm].item() for nm in (450, 650))
    >>> red > blue
    True
    """
    n, k = refractive_index(table, _FIGURE_6_NM)
    geometry = glossmeter_geometry(60)
    model = CookTorrance(scale, slope, n, k)
    spectrum = reflected_spectrum(model, _FIGURE_6_NM, geometry.source, geometry.detector, illuminant="D65")
    return spectrum.assign(n=n, k=k)


def figure6(tables: Sequence[str] = ("copper_johnson_christy_1972", "copper_hagemann_1974")) -> "Figure":
    """Copper's spectrum beside D65, and its index of refraction, as in the glossmeter paper's figure 6.

    Parameters
    ----------
    tables : sequence of str
        Tables of n and k to show.

    Returns
    -------
    Figure
        A matplotlib figure of three plots.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 4.2), layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(2, 1))
    flux = figure.add_subplot(grid[:, 0], xlabel="wavelength, nm", ylabel="relative spectral flux")
    index_n = figure.add_subplot(grid[0, 1], ylabel="n")
    index_k = figure.add_subplot(grid[1, 1], xlabel="wavelength, nm", ylabel="k")
    for table in tables:
        copper = copper_spectrum(table)
        at, label = copper["wavelength_nm"], table.replace("copper_", "").replace("_", " ")
        # As shares of a perfect white's flux, scaled to D65 at the red end: the paper's unit is not stated.
        scale = copper["illuminant"].iloc[-1] / copper["flux"].iloc[-1]
        flux.plot(at, copper["flux"] * scale, label=f"copper, {label}")
        index_n.plot(at, copper["n"])
        index_k.plot(at, copper["k"])
    flux.plot(at, copper["illuminant"], color="tab:red", label="D65")
    flux.set_title("Cook–Torrance c = 5.3, m = .84 at 60°; copper scaled to D65 at 780 nm", fontsize="medium")
    flux.legend(frameon=False)
    for axes in (index_n, index_k):
        axes.axvline(589.26, color="0.7", lw=1)
    return figure


def polar_lobes(models: Mapping[str, ReflectanceModel], incident_deg: Sequence[float] = (20.0, 60.0)) -> "Figure":
    """Polar plot in the plane of incidence of BRDF times exitant cosine, each lobe over its own maximum.

    Parameters
    ----------
    models : mapping of str to ReflectanceModel
        Models without channels, by label.
    incident_deg : sequence of float
        Angles of incidence, a plot each; the light comes from the left.

    Returns
    -------
    Figure
        A matplotlib figure.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(4.6 * len(incident_deg), 3.6), layout="constrained")
    # Finer about the mirror direction, where lobes may be narrow.
    fine = np.sinh(np.linspace(-6, 6, 801)) / np.sinh(6) * 180
    for column, angle in enumerate(incident_deg):
        axes: Any = figure.add_subplot(1, len(incident_deg), column + 1, projection="polar")
        at = np.unique(np.clip(angle + fine, -89.9, 89.9))
        for label, model in models.items():
            values = model.evaluate(direction(angle, 180.0), direction(at)) * np.cos(np.radians(at))
            axes.plot(np.radians(at), values / values.max(), label=f"{label} (× {values.max():.3g}/sr)")
        axes.plot([np.radians(-angle)] * 2, [0, 1], color="0.6", ls=":")
        axes.set(title=f"incidence {angle:g}°", yticklabels=[])
        axes.set_theta_zero_location("N")
        axes.set_theta_direction(-1)
        axes.set_thetalim(-np.pi / 2, np.pi / 2)
        axes.legend(frameon=False, fontsize="small", loc="lower center", bbox_to_anchor=(0.5, -0.05))
    return figure


def lobe_surface(model: ReflectanceModel, incident_deg: float = 45.0, *, n: int = 181) -> "Figure":
    """Surface in space whose distance from the centre is BRDF times exitant cosine, in each direction.

    Parameters
    ----------
    model : ReflectanceModel
        A model without channels.
    incident_deg : float
        Angle of incidence.
    n : int
        Directions along each coordinate; the grid is about the mirror direction, so that narrow lobes are met.

    Returns
    -------
    Figure
        A matplotlib figure.
    """
    from matplotlib.figure import Figure

    mirror = direction(incident_deg)
    # Polar coordinates about the mirror direction, finer near it.
    away = np.radians(np.sinh(np.linspace(0, 5, n)) / np.sinh(5) * (90 + incident_deg))[:, None]
    turn = np.linspace(0, 2 * np.pi, n)[None, :]
    along, across = direction(incident_deg + 90), np.array([0.0, 1.0, 0.0])
    towards = np.cos(turn)[..., None] * along + np.sin(turn)[..., None] * across
    directions = np.cos(away)[..., None] * mirror + np.sin(away)[..., None] * towards
    radius = model.evaluate(direction(incident_deg, 180.0), directions) * np.maximum(directions[..., 2], 0)
    x, y, z = np.moveaxis(directions * radius[..., None], -1, 0)
    figure = Figure(figsize=(5, 4.5), layout="constrained")
    axes = figure.add_subplot(projection="3d")
    axes.plot_surface(x, y, z, rstride=2, cstride=4, cmap="viridis", linewidth=0, antialiased=False)
    largest = float(radius.max())
    source = direction(incident_deg, 180.0) * largest
    axes.plot([0, source[0]], [0, source[1]], [0, source[2]], color="tab:red")
    axes.set(title=f"f cosθ in 1/sr, incidence {incident_deg:g}° (red)", xlabel="x", ylabel="y", zlabel="z")
    axes.locator_params(axis="y", nbins=3)
    axes.set_box_aspect((np.ptp(x) + largest, max(np.ptp(y), 0.2 * largest), np.ptp(z) + 0.2 * largest))
    return figure


def scan_figure(scan: pd.DataFrame) -> "Figure":
    """BRDF over the detector's angle, of an in-plane scan, or over its azimuth, of an out-of-plane one.

    Parameters
    ----------
    scan : DataFrame
        Of `in_plane_scan` or `out_of_plane_scan`, without channels.

    Returns
    -------
    Figure
        A matplotlib figure with a logarithmic axis where the BRDF spans more than a decade.
    """
    from matplotlib.figure import Figure

    axis = (
        "azimuth_deg"
        if len(scan) > 1 and (scan["detector_deg"] == scan["detector_deg"].iloc[0]).all()
        else "detector_deg"
    )
    figure = Figure(figsize=(6, 4), layout="constrained")
    axes = figure.add_subplot(xlabel=axis.replace("_deg", ", degrees"), ylabel="BRDF, 1/sr")
    axes.plot(scan[axis], scan["brdf"])
    largest = scan["brdf"].max()
    if largest > 10 * scan["brdf"].min():
        axes.set_yscale("log")
        # A Gaussian lobe ends nowhere; eight decades are more than any instrument sees.
        axes.set_ylim(max(scan["brdf"].min(), 1e-8 * largest) / 2, 2 * largest)
    axes.set_title(f"incidence {scan['incident_deg'].iloc[0]:g}°")
    return figure


def spectrum_figure(spectrum: pd.DataFrame, *, illuminant: str) -> "Figure":
    """Reflectance factor by wavelength, and the flux beside the illuminant's.

    Parameters
    ----------
    spectrum : DataFrame
        Of `reflected_spectrum`.
    illuminant : str
        Its name, for the legend.

    Returns
    -------
    Figure
        A matplotlib figure of two plots.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8, 3.6), layout="constrained")
    factor, flux = (figure.add_subplot(1, 2, k, xlabel="wavelength, nm") for k in (1, 2))
    factor.plot(spectrum["wavelength_nm"], spectrum["reflectance_factor"])
    factor.set(ylabel="reflectance factor", ylim=(0, None))
    flux.plot(spectrum["wavelength_nm"], spectrum["illuminant"], color="tab:red", label=illuminant)
    flux.plot(spectrum["wavelength_nm"], spectrum["flux"], color="tab:blue", label="reflected, over a perfect white's")
    flux.set(ylabel="relative spectral flux", ylim=(0, None))
    flux.legend(frameon=False)
    return figure
