"""gloss report: the analysis of a study, as one page, and as files for a paper."""

import os
from pathlib import Path

from glossspace.console import JsonFlag, NumberOfJobs, Seed, note, print_json, progress_bar

__all__ = ["report"]


def report(
    study: Path, /, *, out: Path | None = None, seed: Seed = 1, jobs: NumberOfJobs = 1, json: JsonFlag = False
) -> None:
    """Analyse a study folder and write its report: one HTML file with the figures of the gloss paper.

    Beside it, in a folder of its name, lie the figures as SVG and PDF
    (figures/), the tables as CSV (tables/), and a text of methods and results
    that an author can paste and edit (methods.md).

    Examples:

        gloss report out

        gloss report out --out report.html --json

    Parameters
    ----------
    study
        A folder as `gloss reproduce` makes it: stimuli/experiment1, stimuli/contrast, stimuli/doi, and dataset.
    out
        The file to write; report.html in the study folder by default.
    seed
        Of the random starts, resamplings and permutations.
    jobs
        Processes, 0 for one a core; the result does not depend on it.
    """
    from gloss_analysis.report import write_report
    from gloss_analysis.report.folder import check_report_target
    from gloss_analysis.study.analysis import analyse_study
    from gloss_analysis.study.folder import read_study, report_file

    target = report_file(study) if out is None else out
    check_report_target(target)
    analysis = analyse_study(read_study(study), seed=seed, n_jobs=jobs or os.cpu_count() or 1, on_step=note)
    note("Figures, tables and text")
    with progress_bar() as progress:
        bar = progress.add_task("Files of the report", total=None)
        made = write_report(
            analysis, target, on_step=lambda done, total: progress.update(bar, completed=done, total=total)
        )
    for remark in made.kept:
        note(f"Not ours, or changed since the last run: {remark}.")
    if json:
        print_json(
            {
                "report": str(made.page),
                "folder": str(made.folder),
                "files": made.files,
                "weight_d": analysis.fit.space.weight_d,
                "observers": analysis.study.observers,
            }
        )
    else:
        print(made.page)
        print(made.folder)
