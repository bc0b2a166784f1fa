"""The report as one HTML file that opens anywhere, and its parts as files in a folder beside it."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from gloss_analysis.figures.hypotheses import hypotheses_table
from gloss_analysis.ratings.polynomials import polynomial_sentence
from gloss_analysis.report import words
from gloss_analysis.report.folder import check_report_target, report_folder, write_folder
from gloss_analysis.report.gallery import report_pictures
from gloss_analysis.report.glossmeter import glossmeter_rows, glossmeter_words
from gloss_analysis.report.methods import exclusion_words, methods_text
from gloss_analysis.report.paper_figures import paper_figures
from gloss_analysis.report.provenance import (
    calibration_words,
    display_words,
    file_hashes,
    render_words,
    rendering_summary,
    session_headers,
    software_versions,
)
from gloss_analysis.report.tables import as_csv, report_tables
from gloss_analysis.report.templates import environment
from gloss_analysis.study.analysis import StudyAnalysis
from gloss_analysis.study.comparison import compare_with_paper
from gloss_analysis.study.examples import city_map, colour_circle
from glossspace.files import write_text

__all__ = ["WrittenReport", "write_report"]


@dataclass(frozen=True)
class WrittenReport:
    """What `write_report` wrote, and where.

    Attributes
    ----------
    page : Path
        The report: one HTML file.
    folder : Path
        `figures/` (SVG and PDF), `tables/` (CSV), `methods.md`, and `contents.json`, the list of these.
    files : tuple of str
        Those in the folder, but for the list.
    kept : tuple of str
        Files under our names that somebody else wrote or changed, and the names that they now have.
    """

    page: Path
    folder: Path
    files: tuple[str, ...]
    kept: tuple[str, ...]


def write_report(
    analysis: StudyAnalysis, path: Path, *, on_step: Callable[[int, int], None] = lambda done, total: None
) -> WrittenReport:
    """Write the report of an analysed study: one self-contained HTML file, and its parts in a folder beside it.

    Parameters
    ----------
    analysis : StudyAnalysis
    path : Path
        Of the HTML file. The folder has its name without ending: `report` for `report.html`.
    on_step : callable
        Called with the number of files written and of all.

    Returns
    -------
    WrittenReport

    Raises
    ------
    GlossError
        The file or the folder cannot be written.

    Notes
    -----
    No file holds a date or the name of a machine: the same study gives the same bytes. Each is whole or absent, and the
    page comes last.
    """
    check_report_target(path)
    cities, circle = city_map(seed=analysis.seed), colour_circle(seed=analysis.seed)
    comparison = compare_with_paper(analysis, cities)
    pictures = report_pictures(analysis, cities, circle)
    paper = paper_figures(pictures)
    tables = report_tables(analysis, comparison, paper, pictures)
    study = analysis.study
    page = environment(escaped=True).get_template("report.html.j2")
    page_text = page.render(
        analysis=analysis,
        words=words,
        comparison=comparison,
        simulated=[name for name in study.participants if name in study.simulated_participants],
        human=[name for name in study.participants if name not in study.simulated_participants],
        pictures=pictures,
        paper=paper,
        circle=circle,
        cities=cities,
        rows={name: table.to_dict("records") for name, table in tables.items()},
        hypotheses={
            axis: hypotheses_table(test.compared, test.confirmed) for axis, test in analysis.hypotheses.items()
        },
        curvature=[
            f"Along {axis}: {polynomial_sentence(line.polynomials)}" for axis, line in analysis.fit.regressions.items()
        ],
        exclusions=exclusion_words(analysis),
        glossmeter=glossmeter_rows(tables),
        glossmeter_words=glossmeter_words(tables),
        warnings=_remarks(analysis),
        display=display_words(study.sets["experiment1"]),
        calibration=calibration_words(study.sets["experiment1"], session_headers(study)),
        rendered=render_words(study),
        rendering={name: (len(one.stimuli), rendering_summary(one)) for name, one in study.sets.items()},
        folder=report_folder(path).name,
        versions=software_versions(),
        hashes=file_hashes(study.folder),
    )
    files = {f"figures/{name}": content for picture in pictures.values() for name, content in picture.exported.items()}
    files |= {f"tables/{name}.csv": as_csv(table) for name, table in tables.items()}
    files["methods.md"] = methods_text(analysis).encode("utf-8")
    kept = write_folder(report_folder(path), files, on_step=on_step)
    write_text(path, page_text)
    return WrittenReport(path, report_folder(path), tuple(files), tuple(kept))


def _remarks(analysis: StudyAnalysis) -> list[str]:
    """What the parts of the analysis remark, each once."""
    remarks = (*analysis.plane.warnings, *analysis.dimensionality.held_out.warnings, *analysis.metric.fitted.warnings)
    if analysis.resampled is not None:
        remarks += analysis.resampled.warnings
    return list(dict.fromkeys(remarks))
