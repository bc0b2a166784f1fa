"""The report of a study: one HTML file that opens anywhere, with the paper's figures made from this run."""

import base64
import io
import platform
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING

from jinja2 import Environment, PackageLoader, StrictUndefined

from gloss_analysis import figures
from gloss_analysis.comparison import compare_with_paper
from gloss_analysis.examples import CityMap, ColourCircle, city_map, colour_circle
from gloss_analysis.figures.hypotheses import hypotheses_table
from gloss_analysis.hypotheses import HYPOTHESES_C
from gloss_analysis.magnitude import rater_consistency
from gloss_analysis.polynomials import polynomial_sentence
from gloss_analysis.study import StudyAnalysis, dataset_folder, stimulus_folder
from glossspace.files import sha256_of, write_text
from glossspace.stimulus_set import MANIFEST_NAME, StimulusSet

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

__all__ = ["write_report"]

_PACKAGES = ("glossspace", "numpy", "scipy", "pandas", "colour-science", "matplotlib", "mitsuba", "psychopy")


@dataclass(frozen=True)
class _Picture:
    """A figure as the template places it: image data, text for those who cannot see it, caption."""

    source: str
    alternative: str
    caption: str


def write_report(analysis: StudyAnalysis, path: Path) -> None:
    """Write the report of an analysed study as one self-contained HTML file, whole or not at all.

    Parameters
    ----------
    analysis : StudyAnalysis
    path : Path

    Notes
    -----
    The file holds no date and no machine name: the same study gives the same bytes.
    """
    cities, circle = city_map(seed=analysis.seed), colour_circle(seed=analysis.seed)
    environment = Environment(loader=PackageLoader("gloss_analysis"), autoescape=True, undefined=StrictUndefined)
    environment.filters["rendering_summary"] = _rendering_summary
    participants = analysis.study.pairs.participants
    programs = set(analysis.study.simulated_participants)
    write_text(
        path,
        environment.get_template("report.html.j2").render(
            analysis=analysis,
            comparison=compare_with_paper(analysis, cities),
            simulated=[name for name in participants if name in programs],
            human=[name for name in participants if name not in programs],
            pictures=_pictures(analysis, cities, circle),
            circle=circle,
            cities=cities,
            axes=_axis_rows(analysis),
            participants=_participant_rows(analysis),
            hypotheses=_hypothesis_rows(analysis),
            ratings=_rating_remarks(analysis),
            advice=analysis.dimensionality.recommendation,
            warnings=analysis.plane.warnings
            + analysis.dimensionality.held_out.warnings
            + analysis.fit.confirmatory.warnings,
            versions=_versions(),
            hashes=_hashes(analysis.study.folder),
        ),
    )


def _pictures(analysis: StudyAnalysis, cities: CityMap, circle: ColourCircle) -> dict[str, _Picture]:
    study, fit = analysis.study, analysis.fit
    simulated = " Simulated observers." if study.simulated_participants else ""
    experiment1 = study.sets["experiment1"].table()
    return {
        "map": _svg(figures.draw_city_map(cities), "Map of ten US cities", "Fig. 2: the US map, from Table 1 alone."),
        "map_stress": _svg(
            figures.draw_stress_curve(cities.curve), "Stress against dimensions", "Fig. 3: stress of the cities."
        ),
        "composite": _png(
            figures.draw_composite(study.sets["experiment1"]),
            "Twenty-seven rendered spheres",
            "Fig. 4: the stimuli of Experiment 1, code values of the calibrated display.",
        ),
        "stress": _svg(
            figures.draw_stress_curve(
                analysis.dimensionality.curve,
                random=analysis.dimensionality.random,
                permuted=analysis.dimensionality.permuted,
                held_out=analysis.dimensionality.held_out.stress1,
            ),
            "Stress against dimensions",
            f"Fig. 5: stress, beside that of random and permuted judgements and of pairs left out.{simulated}",
        ),
        "shepard": _svg(
            figures.draw_shepard(analysis.plane),
            "Judged dissimilarities against distances for every participant",
            f"Shepard diagrams of the two-dimensional solution, with each participant's Stress-1.{simulated}",
        ),
        "stress_parts": _svg(
            figures.draw_stress_per_point(analysis.plane),
            "Part of every stimulus and participant in the stress",
            f"Who and what the two-dimensional solution fits least.{simulated}",
        ),
        "plane": _svg(
            figures.draw_configuration(analysis),
            "Two-dimensional configuration of the stimuli",
            "Fig. 6: the weighted solution, permuted and reflected only. Fill: lightness; shape: α; size: ρs. "
            f"Arrows: directions in which c and d rise.{simulated}",
        ),
        "rotation": _svg(
            figures.draw_rotation_cost(analysis),
            "Stress against rotation of the axes",
            f"What turning the axes costs: how firmly the judgements fix them.{simulated}",
        ),
        "identity": _svg(
            figures.draw_identity_configuration(analysis),
            "Two-dimensional configuration without participants' weights",
            f"The same judgements without participants' weights, turned so that c rises along dimension 1.{simulated}",
        ),
        "doi": _svg(
            figures.draw_ratings(analysis.rated["d"], "d", fit.regressions["d"]),
            "Mean ratings against d",
            f"Fig. 7: magnitude estimates against d. Bars: standard errors over participants.{simulated}",
        ),
        "contrast": _svg(
            figures.draw_ratings(analysis.rated["c"], "c", fit.regressions["c"]),
            "Mean ratings against c",
            f"Fig. 8: magnitude estimates against c. Bars: standard errors over participants.{simulated}",
        ),
        **_hypothesis_picture(analysis, simulated),
        "space": _svg(
            figures.draw_gloss_space(experiment1, fit.space),
            "Stimuli in the gloss space",
            f"Fig. 9: the stimuli of Experiment 1 in the gloss space with the weights of this run.{simulated}",
        ),
        "envelope": _svg(
            figures.draw_envelope(), "Contrast gloss against lightness", "Fig. 10: the envelope of gloss space."
        ),
        "ratios": _svg(
            figures.draw_axis_ratios(fit.confirmatory, study.simulated),
            "Axis ratio of each participant",
            f"Weight of d over that of c, by confirmatory MDS.{simulated}",
        ),
        "circle": _svg(
            figures.draw_colour_circle(circle),
            "Ten colour chips round a circle",
            "Helm's colour chips. Real observers.",
        ),
        "circle_weights": _svg(
            figures.draw_participant_weights(circle),
            "Dimension weights of sixteen participants",
            "Dimension weights of Helm's participants. Real observers.",
        ),
    }


def _hypothesis_picture(analysis: StudyAnalysis, simulated: str) -> dict[str, _Picture]:
    if analysis.hypotheses is None:
        return {}
    drawn = figures.draw_hypotheses(
        HYPOTHESES_C, analysis.study.stimuli, analysis.study.ratings["c"], confirmed=analysis.hypotheses.confirmed
    )
    caption = f"Three hypotheses for c on ratings, with 95 % intervals, and on judged pairs.{simulated}"
    return {"hypotheses": _svg(drawn, "Mean ratings against three forms of contrast gloss", caption)}


def _svg(figure: "Figure", alternative: str, caption: str) -> _Picture:
    import matplotlib

    buffer = io.BytesIO()
    # A fixed salt and no date: the same figure gives the same bytes.
    with matplotlib.rc_context({"svg.hashsalt": "glossspace"}):
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    return _Picture(_data_uri(buffer.getvalue(), "image/svg+xml"), alternative, caption)


def _png(figure: "Figure", alternative: str, caption: str) -> _Picture:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=170, metadata={"Software": None})
    return _Picture(_data_uri(buffer.getvalue(), "image/png"), alternative, caption)


def _data_uri(content: bytes, kind: str) -> str:
    return f"data:{kind};base64,{base64.b64encode(content).decode('ascii')}"


def _axis_rows(analysis: StudyAnalysis) -> list[dict[str, float | str]]:
    """Per axis: which dimension stands for it, and how near the fitted direction lies to that dimension."""
    rows: list[dict[str, float | str]] = []
    for index, axis in enumerate(("c", "d")):
        dimension = int(analysis.axes.order[index])
        rows.append(
            {
                "axis": axis,
                "dimension": dimension + 1,
                "angle_deg": float(analysis.axes.vectors[axis].angle_deg[dimension]),
                "r_squared": analysis.axes.vectors[axis].r_squared,
                "identity_angle_deg": float(analysis.axes.identity_vectors[axis].angle_deg[index]),
                "identity_r_squared": analysis.axes.identity_vectors[axis].r_squared,
            }
        )
    return rows


def _participant_rows(analysis: StudyAnalysis) -> list[dict[str, float | str | None]]:
    confirmatory, simulated = analysis.fit.confirmatory, analysis.study.simulated
    true = {} if simulated is None else simulated.set_index("participant_id")["ratio"].to_dict()
    return [
        {"participant": name, "ratio": fit.ratio, "stress1": fit.stress1, "true": true.get(name)}
        for name, fit in zip(confirmatory.participants, confirmatory.individual, strict=True)
    ]


def _hypothesis_rows(analysis: StudyAnalysis) -> "pd.DataFrame | None":
    if analysis.hypotheses is None:
        return None
    return hypotheses_table(analysis.hypotheses.compared, analysis.hypotheses.confirmed)


def _rating_remarks(analysis: StudyAnalysis) -> list[str]:
    """Curvature of the ratings along each axis, and participants whose ratings look odd."""
    remarks = [
        f"Along {axis}: {polynomial_sentence(analysis.fit.regressions[axis].polynomials)}" for axis in ("c", "d")
    ]
    for axis, table in analysis.study.ratings.items():
        for rater in rater_consistency(table):
            remarks += [f"Participant {rater.participant_id}, ratings along {axis}: {flag}" for flag in rater.flags]
    return remarks


def _rendering_summary(stimuli: StimulusSet) -> str:
    """How a set was rendered, with the error of its worst image."""
    manifest = stimuli.manifest
    # Another program may have rendered the set, and say less of how.
    rendering = manifest.get("rendering") or {}
    parts = [f"{key} {rendering[key]}" for key in ("method", "quality") if key in rendering]
    if target := rendering.get("target"):
        share = f"{100 * target['fraction']:g} % of the pixels"
        parts.append(f"target {target['max_code_error']:g} code values on {share} of every image")
    if "seed" in rendering:
        parts.append(f"seed {rendering['seed']}")
    errors = [entry["error_estimate"] for entry in manifest["stimuli"] if entry.get("error_estimate")]
    if errors:
        median = max(error["median"] for error in errors)
        tail = max(error["percentile_99_9"] for error in errors)
        parts.append(
            f"error of the worst image {median:.2f} code values in the median, {tail:.2f} at 99.9 % of its pixels"
        )
    return "; ".join(parts)


def _versions() -> dict[str, str]:
    found = {"Python": platform.python_version(), "system": f"{platform.system()} {platform.machine()}"}
    for package in _PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return found


def _hashes(study: Path) -> dict[str, str]:
    """SHA-256 of what the report was made from: the manifests, which hold the images' own, and the data files."""
    files = sorted(stimulus_folder(study, "").glob(f"*/{MANIFEST_NAME}")) + sorted(
        dataset_folder(study).glob("data/**/*.csv")
    )
    return {path.relative_to(study).as_posix(): sha256_of(path) for path in files}
