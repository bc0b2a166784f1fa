"""``gloss gonio``: scans and spectra of the virtual gonio-spectrophotometer."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from cyclopts import App

from glossspace.brdf_options import BrdfOptions, brdf_parameters, named_brdf
from glossspace.console import FiniteNumber, JsonFlag, note, print_json, print_table, progress_bar
from glossspace.errors import GlossError
from glossspace.files import check_file_target, check_replaceable, whole_file, write_text
from glossspace.user_table import read_user_table

__all__ = ["gonio"]

gonio = App(
    name="gonio",
    help="Measure a reflectance model with the virtual gonio-spectrophotometer: scans over angles, spectra.",
    help_format="plaintext",
    help_epilogue="""
Examples:

    gloss gonio scan --brdf ward --rho-s .1 --alpha .05 --incident 45 --out scan.csv --figure scan.png

    gloss gonio spectrum --brdf cook-torrance --scale 5.3 --slope .84 --index copper_johnson_christy_1972 --json
""",
)

_FIGURE_SUFFIXES = (".png", ".svg", ".pdf")
_MOST_POINTS = 20_000
# What tells a table of ours from a file of somebody else.
_SCAN_COLUMNS = ("incident_deg", "detector_deg", "azimuth_deg")
_SPECTRUM_COLUMNS = ("wavelength_nm", "reflectance_factor")


@gonio.command(help_epilogue="")
def scan(
    *,
    lobe: BrdfOptions,
    incident: FiniteNumber,
    start: FiniteNumber = -85.0,
    stop: FiniteNumber = 85.0,
    step: FiniteNumber = 1.0,
    detector: FiniteNumber | None = None,
    source_width: FiniteNumber = 0.0,
    detector_width: FiniteNumber = 0.0,
    out: Path | None = None,
    figure: Path | None = None,
    json: JsonFlag = False,
) -> None:
    """BRDF over the detector's angle in the plane of incidence, or over its azimuth.

    Examples:

        gloss gonio scan --brdf ward --rho-s .1 --alpha .05 --incident 45 --out scan.csv --figure scan.png

        gloss gonio scan --brdf ward --rho-s .1 --alpha .05 --incident 45 --detector 45 --start 0 --stop 180 --json

    Parameters
    ----------
    lobe
        Reflectance model.
    incident
        Angle of the source from the normal, degrees; the mirror direction is at +incident.
    start
        First angle of the detector, or first azimuth.
    stop
        Last one.
    step
        Distance between them.
    detector
        Angle of the detector in an out-of-plane scan, which moves its azimuth.
    source_width
        Side of the square source, degrees; 0 is the limit.
    detector_width
        Side of the square detector, degrees; 0 is the limit.
    out
        CSV file for the scan; of files that are there, only a scan or spectrum is replaced.
    figure
        Also draw it into this file (PNG, SVG or PDF).
    """
    from glossspace.instruments.figures import scan_figure
    from glossspace.instruments.goniospectrophotometer import in_plane_scan, out_of_plane_scan

    if step <= 0 or stop < start or (stop - start) / step > _MOST_POINTS:
        raise GlossError(
            f"Invalid range {start:g} to {stop:g} in steps of {step:g}. Allowed: --start up to --stop, --step above 0, "
            f"at most {_MOST_POINTS} points."
        )
    _check_targets(out, figure)
    model = named_brdf(**asdict(lobe))
    angles = start + step * np.arange(int((stop - start) / step + 1e-9) + 1)
    widths = {
        "source_widths_deg": (source_width, source_width), "detector_widths_deg": (detector_width, detector_width)
    }  # fmt: skip
    parts = []
    with progress_bar() as progress, _unsure_values_noted():
        task = progress.add_task("Detector positions", total=len(angles))
        for angle in angles:
            if detector is None:
                parts.append(in_plane_scan(model, incident, [angle], **widths))
            else:
                parts.append(out_of_plane_scan(model, incident, detector, [angle], **widths))
            progress.advance(task)
    table = pd.concat(parts, ignore_index=True)
    _deliver(table, {}, out=out, figure=None if figure is None else (figure, scan_figure(table)), json=json)


@gonio.command(help_epilogue="")
def spectrum(
    *,
    lobe: BrdfOptions,
    index: str | None = None,
    incident: FiniteNumber = 60.0,
    detector: FiniteNumber | None = None,
    source_width: FiniteNumber = 0.0,
    detector_width: FiniteNumber = 0.0,
    illuminant: str = "D65",
    observer: str = "CIE 1931 2 Degree Standard Observer",
    first: FiniteNumber = 380.0,
    last: FiniteNumber = 780.0,
    step: FiniteNumber = 5.0,
    out: Path | None = None,
    figure: Path | None = None,
    json: JsonFlag = False,
) -> None:
    """Spectrum of the reflected flux under an illuminant, with XYZ and CIELAB.

    Examples:

        gloss gonio spectrum --brdf cook-torrance --scale 5.3 --slope .84 --index copper_johnson_christy_1972

        gloss gonio spectrum --brdf lambert --rho-d .4 --incident 45 --detector 0 --illuminant A --json

    Parameters
    ----------
    lobe
        Reflectance model.
    index
        Table of n and k by wavelength for cook-torrance, beckmann and ggx, instead of --n and --k:
        copper_johnson_christy_1972 or copper_hagemann_1974.
    incident
        Angle of the source from the normal, degrees.
    detector
        Angle of the detector; the mirror direction by default.
    source_width
        Side of the square source, degrees.
    detector_width
        Side of the square detector, degrees.
    illuminant
        A CIE illuminant by its name in colour-science: D65, A, C, E, FL2 and others.
    observer
        An observer by its name in colour-science.
    first
        First wavelength, nm.
    last
        Last wavelength, nm.
    step
        Distance between wavelengths, nm.
    out
        CSV file for the spectrum; of files that are there, only a scan or spectrum is replaced.
    figure
        Also draw it into this file (PNG, SVG or PDF).
    """
    from glossspace.instruments.apertures import Aperture
    from glossspace.instruments.colorimetry import spectrum_colour
    from glossspace.instruments.figures import spectrum_figure
    from glossspace.instruments.goniospectrophotometer import reflected_spectrum
    from glossspace.instruments.refractive_index import refractive_index

    if step <= 0 or last <= first or (last - first) / step > _MOST_POINTS:
        raise GlossError(
            f"Invalid wavelengths {first:g} to {last:g} nm in steps of {step:g}. Allowed: --first below --last, --step "
            f"above 0, at most {_MOST_POINTS} of them."
        )
    _check_targets(out, figure)
    wavelengths = first + step * np.arange(int((last - first) / step + 1e-9) + 1)
    indices: tuple[Any, Any] = (lobe.n, lobe.k)
    if index is not None:
        if lobe.n is not None or lobe.k is not None:
            raise GlossError("Give either --index or --n and --k, not both.")
        if "n" not in brdf_parameters(lobe.brdf):
            raise GlossError(f"--brdf {lobe.brdf} has no --index: it takes no index of refraction. Leave --index out.")
        indices = refractive_index(index, wavelengths)
    model = named_brdf(**asdict(lobe) | {"n": indices[0], "k": indices[1]})
    source = Aperture(incident, 180, source_width, source_width)
    receiver = Aperture(incident if detector is None else detector, 0, detector_width, detector_width)
    with _unsure_values_noted():
        table = reflected_spectrum(model, wavelengths, source, receiver, illuminant=illuminant)
    colour = spectrum_colour(table["reflectance_factor"], wavelengths, illuminant=illuminant, observer=observer)
    summary = {"illuminant": illuminant, "observer": observer, "xyz": colour.xyz.tolist(), "lab": colour.lab.tolist()}
    drawn = None if figure is None else (figure, spectrum_figure(table, illuminant=illuminant))
    _deliver(table, summary, out=out, figure=drawn, json=json)


@contextmanager
def _unsure_values_noted() -> Iterator[None]:
    """Say once, instead of at every position, how unsure the quadrature was; other warnings go on."""
    from glossspace.instruments.quadrature import QuadratureWarning

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", QuadratureWarning)
        yield
    errors = []
    for one in caught:
        if isinstance(one.message, QuadratureWarning):
            errors.append(one.message.relative_error)
        else:
            warnings.warn_explicit(one.message, one.category, one.filename, one.lineno)
    if errors:
        note(f"Note: the quadrature knows some of these values to ±{100 * max(errors):.2g} % only.")


def _check_targets(out: Path | None, figure: Path | None) -> None:
    if figure is not None and figure.suffix.lower() not in _FIGURE_SUFFIXES:
        raise GlossError(f"Invalid figure '{figure}'. Allowed: a file name that ends in {', '.join(_FIGURE_SUFFIXES)}.")
    if out is not None and figure is not None and out.resolve() == figure.resolve():
        raise GlossError(f"--out and --figure are both '{out}': one would replace the other. Name two files.")
    if out is not None:
        check_replaceable(out, _read_table, what="scan or spectrum")
    if figure is not None:
        check_file_target(figure)


def _read_table(path: Path) -> pd.DataFrame:
    """A scan or spectrum that an earlier call wrote."""
    table = read_user_table(path, what="table", columns=())
    if not any(set(needed) <= set(table.columns) for needed in (_SCAN_COLUMNS, _SPECTRUM_COLUMNS)):
        raise GlossError(f"'{path}' is no scan or spectrum.")
    return table


def _deliver(
    table: pd.DataFrame, summary: dict[str, Any], *, out: Path | None, figure: tuple[Path, Any] | None, json: bool
) -> None:
    if out is not None:
        write_text(out, table.to_csv(index=False, lineterminator="\n"))
        note(f"Table: {out}")
    if figure is not None:
        with whole_file(figure[0]) as temporary:
            figure[1].savefig(temporary)
        note(f"Figure: {figure[0]}")
    if json:
        print_json(summary | {"points": table.to_dict(orient="records")})
        return
    if summary:
        values = [_text(value) for value in summary.values()]
        print_table(pd.DataFrame({"quantity": list(summary), "value": values}))
    if out is None:
        print_table(table)


def _text(value: Any) -> str:
    return value if isinstance(value, str) else ", ".join(f"{number:.5g}" for number in value)
