"""``gloss glossmeter``: gloss units of a reflectance model, and parameters from gloss units."""

import warnings
from dataclasses import asdict
from typing import Any

import pandas as pd
from cyclopts import App

from glossspace.brdf_options import BrdfOptions, named_brdf, require_one_of
from glossspace.console import FiniteNumber, JsonFlag, note, print_json, print_table
from glossspace.errors import GlossError

__all__ = ["glossmeter"]

# Relative error above which it is said. Glossmeters do not agree with each other to that.
_SURE = 1e-4

glossmeter = App(
    name="glossmeter",
    help="Read a reflectance model with the glossmeter of ISO 2813, or find the parameters that give a reading.",
    help_format="plaintext",
    help_epilogue="""
Examples:

    gloss glossmeter --brdf ward --rho-s 1 --alpha .11 --json

    gloss glossmeter --brdf cook-torrance --scale 21.5 --slope .6 --n 1.32 --k 0 --reading table2

    gloss glossmeter invert --gu60 10 --rho-s .05 --json
""",
)


@glossmeter.default
def read(
    *,
    lobe: BrdfOptions,
    reading: str = "physical",
    json: JsonFlag = False,
) -> None:
    """Gloss units at 20, 60 and 85 degrees, with the albedo at each.

    Parameters
    ----------
    lobe
        Reflectance model.
    reading
        physical (true angles, converged) or table2 (as the glossmeter paper computes).
    """
    from glossspace.instruments.glossmeter import READINGS, gloss_reading
    from glossspace.instruments.quadrature import QuadratureWarning

    require_one_of(reading, READINGS, option="--reading")
    model = named_brdf(**asdict(lobe))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", QuadratureWarning)  # it is said below, from a smaller error on
        found = gloss_reading(model, reading=reading)
    result = asdict(found) | {"haze": found.haze}
    if lobe.brdf == "ward" and lobe.alpha_y is None and lobe.normalisation is None:
        result |= _gloss_space(lobe.rho_d or 0.0, lobe.rho_s, lobe.alpha)
    if not found.conserves_energy:
        note("Note: this sample reflects more than it receives (an albedo above 1): no real one does.")
    if found.relative_error > _SURE:
        note(f"Note: the quadrature knows these readings to ±{100 * found.relative_error:.2g} % only.")
    if json:
        print_json(result)
    else:
        print_table(pd.DataFrame({"quantity": list(result), "value": list(result.values())}))


@glossmeter.command(help_epilogue="")
def invert(
    *,
    gu20: FiniteNumber | None = None,
    gu60: FiniteNumber | None = None,
    gu85: FiniteNumber | None = None,
    brdf: str = "ward",
    rho_d: FiniteNumber = 0.0,
    rho_s: FiniteNumber | None = None,
    alpha: FiniteNumber | None = None,
    scale: FiniteNumber | None = None,
    slope: FiniteNumber | None = None,
    n: FiniteNumber | None = None,
    k: FiniteNumber | None = None,
    tolerance: FiniteNumber = 0.5,
    json: JsonFlag = False,
) -> None:
    """Parameters of a lobe from one, two or three gloss readings, and all parameters that read alike.

    One reading tells one unknown: give the amplitude (--rho-s, --scale) or the
    roughness (--alpha, --slope), or look at the set that reads alike. For Ward's
    lobe the gloss space's c and d are given, too.

    Examples:

        gloss glossmeter invert --gu60 10 --rho-s .05 --json

        gloss glossmeter invert --gu20 5 --gu60 12 --rho-d .193

        gloss glossmeter invert --gu60 70 --brdf beckmann --scale 1 --n 1.5

    Parameters
    ----------
    gu20
        Reading at 20 degrees, in gloss units.
    gu60
        Reading at 60 degrees.
    gu85
        Reading at 85 degrees.
    brdf
        ward, beckmann or cook-torrance.
    rho_d
        Diffuse reflectance under the lobe, which the reading does not tell.
    rho_s
        Specular reflectance of Ward's lobe, if known.
    alpha
        Its roughness, if known.
    scale
        Factor of Cook-Torrance, if known.
    slope
        Slope of its facets, if known.
    n
        Index of refraction of Cook-Torrance; 1.5 by default.
    k
        Its extinction coefficient; 0 by default.
    tolerance
        Gloss units within which readings count as alike.
    """
    from glossspace.instruments.inversion import alike_parameters, invert_gloss
    from glossspace.instruments.lobe_families import Material, lobe_family
    from glossspace.instruments.paint_gloss import alike_appearances

    readings = {angle: value for angle, value in ((20, gu20), (60, gu60), (85, gu85)) if value is not None}
    if not readings:
        raise GlossError("Give one to three readings: --gu20, --gu60, --gu85.")
    family = lobe_family(brdf)
    material = Material(rho_d, 1.5 if n is None else n, 0.0 if k is None else k)
    known = {"rho_s": rho_s, "alpha": alpha, "scale": scale, "slope": slope}
    foreign = [name for name, value in known.items() if value is not None and name not in _own(family)]
    if foreign:
        raise GlossError(f"--brdf {brdf} has no --{foreign[0].replace('_', '-')}: it has {' and '.join(_own(family))}.")
    if brdf == "ward" and (n is not None or k is not None):
        raise GlossError(f"--brdf ward has no {'--k' if n is None else '--n'}: it has rho_s and alpha.")
    amplitude, roughness = known[family.amplitude], known[family.roughness]
    if brdf == "ward":
        alike = alike_appearances(readings, rho_d=rho_d, tolerance_gu=tolerance)
    else:
        alike = alike_parameters(readings, family=brdf, tolerance_gu=tolerance, material=material)
    result: dict[str, Any] = {"brdf": brdf, "fits": [], "exact": None, "ceilings": {}}
    if len(readings) > 1 or amplitude is not None or roughness is not None:
        found = invert_gloss(readings, family=brdf, amplitude=amplitude, roughness=roughness, material=material)
        result |= {"exact": found.exact, "ceilings": {f"gu{angle}": gu for angle, gu in found.ceilings.items()}}
        for fit in found.fits:
            row = {family.amplitude: fit.amplitude, family.roughness: fit.roughness}
            row |= {f"gu{angle}": gu for angle, gu in fit.readings.items()}
            row |= {"worst_error_gu": fit.worst_error_gu, "albedo60": fit.albedo60}
            result["fits"].append(row | (_gloss_space(rho_d, fit.amplitude, fit.roughness) if brdf == "ward" else {}))
        result |= result["fits"][0]
        if not found.exact:
            note(
                f"Note: no {brdf} lobe gives these readings together; the nearest is off by up to "
                f"{found.fits[0].worst_error_gu:.3g} gloss units."
            )
        if found.fits[0].albedo60 > 1:
            note("Note: this lobe reflects more than it receives (an albedo above 1): no real sample does.")
    else:
        note(
            f"One reading does not tell both {family.amplitude} and {family.roughness}: only what reads alike is given."
        )
    if alike.empty:
        note(f"Note: no {brdf} lobe of the table reads so within {tolerance:g} gloss units.")
    result["alike"] = alike.to_dict(orient="records")
    if json:
        print_json(result)
        return
    if result["fits"]:
        print_table(pd.DataFrame(result["fits"]), title=f"{brdf} lobes with these readings")
    shown = alike if len(alike) <= 16 else alike.iloc[:: -(-len(alike) // 16)]
    print_table(shown, title=f"Read alike within {tolerance:g} gloss units ({len(alike)} of the table's roughnesses)")


def _own(family: Any) -> tuple[str, str]:
    return family.amplitude, family.roughness


def _gloss_space(rho_d: float, rho_s: Any, alpha: Any) -> dict[str, Any]:
    """Coordinates of the gloss space for Ward's paint, unless it reflects more than it receives."""
    from glossspace.metric import PAPER_SPACE, Paint, within_paper_range

    if rho_d + rho_s > 1:
        return {}
    appearance = PAPER_SPACE.appearance(Paint(rho_d, rho_s, alpha))._asdict()
    return appearance | {"within_paper_range": bool(within_paper_range(alpha))}
