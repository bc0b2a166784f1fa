"""gloss report: the analysis of a study, in one file."""

import os
from pathlib import Path

from glossspace.console import JsonFlag, NumberOfJobs, Seed, note, print_json
from glossspace.files import check_file_target

__all__ = ["report"]


def report(
    study: Path, /, *, out: Path | None = None, seed: Seed = 1, jobs: NumberOfJobs = 1, json: JsonFlag = False
) -> None:
    """Analyse a study folder and write its report: one HTML file with the figures of the gloss paper.

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
        Of the random starts.
    jobs
        Processes, 0 for one a core; the result does not depend on it.
    """
    from gloss_analysis.report import write_report
    from gloss_analysis.study import analyse_study, read_study, report_file

    target = report_file(study) if out is None else out
    check_file_target(target)
    analysis = analyse_study(read_study(study), seed=seed, n_jobs=jobs or os.cpu_count() or 1, on_step=note)
    write_report(analysis, target)
    if json:
        print_json({"report": str(target), "weight_d": analysis.fit.space.weight_d})
    else:
        print(target)
