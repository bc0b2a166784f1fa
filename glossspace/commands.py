"""Sub-commands of the gloss space itself: convert, distance, match, isogloss."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from glossspace.console import FiniteNumber, JsonFlag, WholeNumber, note, print_json, print_table
from glossspace.errors import GlossError
from glossspace.files import check_file_target, whole_file
from glossspace.metric import (
    PAPER_ALPHA_LIMIT,
    PAPER_SPACE,
    GlossSpace,
    IsoglossContour,
    Paint,
    diffuse_reflectance,
    isogloss_contour,
    match_gloss,
    within_paper_range,
)

__all__ = ["convert", "distance", "isogloss", "match"]

_FIGURE_SUFFIXES = (".png", ".svg", ".pdf")
_MANY_POINTS = 100_000


def convert(
    *,
    rho_d: FiniteNumber | None = None,
    rho_s: FiniteNumber | None = None,
    alpha: FiniteNumber | None = None,
    lightness: FiniteNumber | None = None,
    c: FiniteNumber | None = None,
    d: FiniteNumber | None = None,
    space: Path | None = None,
    json: JsonFlag = False,
) -> None:
    """Convert a paint (rho_d, rho_s, alpha) to its appearance (lightness, c, d), or back.

    Examples:

        gloss convert --rho-d .193 --rho-s .066 --alpha .07

        gloss convert --lightness 51.04 --c .087 --d .93 --json

        gloss convert --rho-d .193 --rho-s .066 --alpha .07 --space gloss-space.json

    Parameters
    ----------
    rho_d
        Diffuse reflectance, 0 to 1.
    rho_s
        Specular reflectance, 0 to 1 - rho_d.
    alpha
        Roughness of Ward's lobe, > 0.
    lightness
        CIELAB L*, 0 to 100.
    c
        Contrast gloss, 0 to 1.
    d
        Distinctness of image, below 1.
    space
        A fitted gloss-space.json, whose axis functions may differ; the gloss paper's by default.
    """
    gloss_space = _space(space)
    physical = {"--rho-d": rho_d, "--rho-s": rho_s, "--alpha": alpha}
    perceptual = {"--lightness": lightness, "--c": c, "--d": d}
    given_physical = [value for value in physical.values() if value is not None]
    given_perceptual = [value for value in perceptual.values() if value is not None]
    if len(given_physical) == 3 and not given_perceptual:
        paint = Paint(*given_physical)
    elif len(given_perceptual) == 3 and not given_physical:
        paint = gloss_space.paint(*given_perceptual)
    else:
        given = [name for name, value in (physical | perceptual).items() if value is not None]
        raise GlossError(
            f"Give either {', '.join(physical)} or {', '.join(perceptual)}, all three and nothing else; "
            f"got {', '.join(given) or 'none of them'}."
        )
    result = {
        **paint._asdict(),
        **gloss_space.appearance(paint)._asdict(),
        "max_c": gloss_space.contrast_form.value(paint.rho_d, 1 - np.asarray(paint.rho_d)),
        "within_paper_range": within_paper_range(paint.alpha),
    }
    _warn_outside_range(paint.alpha)
    _show(result, as_json=json)


def distance(a: str, b: str, /, *, space: Path | None = None, json: JsonFlag = False) -> None:
    """Gloss distance between two paints (eq. 5), in the paper's space or a fitted one.

    Examples:

        gloss distance .193,.066,.07 .193,.066,.04

        gloss distance .03,.099,.04 .767,.099,.04 --space gloss-space.json --json

    Parameters
    ----------
    a
        A paint as rho_d,rho_s,alpha.
    b
        The other paint.
    space
        A fitted gloss-space.json; the gloss paper's space by default.
    """
    gloss_space = _space(space)
    paint_a, paint_b = _paint(a), _paint(b)
    (c_a, d_a), (c_b, d_b) = gloss_space.coordinates(paint_a), gloss_space.coordinates(paint_b)
    result = {
        "distance": gloss_space.distance(paint_a, paint_b),
        "delta_c": c_b - c_a,
        "delta_d": d_b - d_a,
        "weight_c": gloss_space.weight_c,
        "weight_d": gloss_space.weight_d,
        "space": gloss_space.name,
    }
    _warn_outside_range(paint_a.alpha, paint_b.alpha)
    _show(result, as_json=json)


def match(
    reference: str,
    /,
    *,
    rho_d: FiniteNumber | None = None,
    lightness: FiniteNumber | None = None,
    space: Path | None = None,
    json: JsonFlag = False,
) -> None:
    """Paint of another lightness that looks as glossy as a reference (section 5.2 of the gloss paper).

    Examples:

        gloss match .767,.099,.04 --rho-d .03

        gloss match .767,.099,.04 --lightness 51 --space gloss-space.json --json

    Parameters
    ----------
    reference
        The paint to match, as rho_d,rho_s,alpha.
    rho_d
        Diffuse reflectance of the wanted paint.
    lightness
        Or its CIELAB L*, 0 to 100.
    space
        A fitted gloss-space.json, whose axis functions may differ; the gloss paper's by default.
    """
    gloss_space = _space(space)
    if rho_d is not None and lightness is None:
        target = rho_d
    elif lightness is not None and rho_d is None:
        target = float(diffuse_reflectance(lightness))
    else:
        raise GlossError("Give one of --rho-d and --lightness for the wanted paint.")
    matched = match_gloss(_paint(reference), rho_d=target, space=gloss_space)
    result = {**matched._asdict(), **gloss_space.appearance(matched)._asdict(), "space": gloss_space.name}
    _warn_outside_range(matched.alpha)
    _show(result, as_json=json)


def isogloss(
    reference: str,
    /,
    *,
    radius: FiniteNumber = 0.04,
    rho_d: FiniteNumber | None = None,
    n: WholeNumber = 36,
    space: Path | None = None,
    figure: Path | None = None,
    json: JsonFlag = False,
) -> None:
    """Paints that differ equally in gloss from a reference (figure 11 of the gloss paper).

    Points that no real paint reaches are marked, and have no rho_s and alpha.

    Examples:

        gloss isogloss .193,.066,.07

        gloss isogloss .193,.066,.07 --radius .08 --rho-d .03 --figure contour.png --json

    Parameters
    ----------
    reference
        The paint in the centre, as rho_d,rho_s,alpha.
    radius
        Gloss distance of the contour, > 0.
    rho_d
        Diffuse reflectance of the paints on the contour; the reference's own by default.
    n
        Number of points on the contour.
    space
        A fitted gloss-space.json; the gloss paper's space by default.
    figure
        Also draw the contour into this file (PNG, SVG or PDF).
    """
    if figure is not None and figure.suffix.lower() not in _FIGURE_SUFFIXES:
        raise GlossError(f"Invalid figure '{figure}'. Allowed: a file name that ends in {', '.join(_FIGURE_SUFFIXES)}.")
    if figure is not None:
        check_file_target(figure)
    gloss_space = _space(space)
    paint = _paint(reference)
    contour = isogloss_contour(paint, radius=radius, rho_d=rho_d, n=n, space=gloss_space)
    if figure is not None:
        _draw_contour(figure, contour, gloss_space.coordinates(paint))
        note(f"Figure: {figure}")
    if json and n > _MANY_POINTS:
        note(f"Writing {n:,} points, which takes a while.")
    points = pd.DataFrame(
        {
            name: getattr(contour, name)
            for name in ("angle_deg", "c", "d", "rho_s", "alpha", "reachable", "within_paper_range")
        }
    )
    if json:
        print_json({"rho_d": contour.rho_d, "radius": radius, "points": points.to_dict(orient="records")})
    else:
        print_table(points, title=f"Gloss distance {radius:g} from {reference}, paints of rho_d = {contour.rho_d:g}")


def _paint(text: str) -> Paint:
    parts = text.split(",")
    try:
        values = [float(part) for part in parts]
    except ValueError:
        values = []
    if len(values) != 3 or not np.all(np.isfinite(values)):
        raise GlossError(
            f"Invalid paint {text!r}. Allowed: three numbers rho_d,rho_s,alpha, for example .193,.066,.07."
        )
    return Paint(*values)


def _space(path: Path | None) -> GlossSpace:
    return PAPER_SPACE if path is None else GlossSpace.load(path)


def _warn_outside_range(*alphas: Any) -> None:
    for alpha in alphas:
        if not within_paper_range(alpha):
            note(
                f"Note: alpha = {alpha:g} is outside the range that the gloss paper covers, 0 to {PAPER_ALPHA_LIMIT:g}."
            )


def _show(result: dict[str, Any], *, as_json: bool) -> None:
    if as_json:
        print_json(result)
    else:
        print_table(pd.DataFrame({"quantity": list(result), "value": list(result.values())}), title=None)


def _draw_contour(path: Path, contour: IsoglossContour, centre: tuple[Any, Any]) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5, 4.5), layout="constrained")
    axes = figure.add_subplot(xlabel="contrast gloss c", ylabel="distinctness of image d")
    unreachable = ~contour.reachable
    axes.plot(contour.c[contour.reachable], contour.d[contour.reachable], "o", ms=4, label="a paint exists")
    if unreachable.any():
        axes.plot(contour.c[unreachable], contour.d[unreachable], "x", color="0.6", ms=4, label="no paint exists")
    axes.plot(*centre, "k+", ms=10, label="reference")
    axes.legend(frameon=False)
    with whole_file(path) as temporary:
        figure.savefig(temporary)
