"""Methods and results as text that an author can paste and edit: every number in it comes from the study."""

from collections.abc import Iterable
from typing import Any

import pandas as pd

from gloss_analysis.judgements.participant_remarks import judgement_remarks, rating_remarks
from gloss_analysis.report import words
from gloss_analysis.report.numbers import counted, fixed, interval, joined
from gloss_analysis.report.provenance import (
    calibration_words,
    display_words,
    render_words,
    rendering_summary,
    session_headers,
    software_versions,
    tone_words,
)
from gloss_analysis.report.templates import environment
from gloss_analysis.study.analysis import StudyAnalysis
from gloss_analysis.study.folder import Study

__all__ = ["exclusion_words", "methods_text"]

_TASKS = {"c": "contrast", "d": "doi"}


def methods_text(analysis: StudyAnalysis) -> str:
    """Write the methods and the results of a study in Markdown.

    Parameters
    ----------
    analysis : StudyAnalysis

    Returns
    -------
    str
        Without date or place: the same study gives the same text.
    """
    study = analysis.study
    template = environment(escaped=False).get_template("methods.md.j2")
    return template.render(
        analysis=analysis,
        words=words,
        observers=study.observers,
        simulated=_simulated_words(study),
        display=display_words(study.sets["experiment1"]),
        calibration=calibration_words(study.sets["experiment1"], session_headers(study)),
        tone=tone_words(study.sets["experiment1"]),
        rendered=render_words(study),
        sets=[(name, _levels(one.table()), rendering_summary(one)) for name, one in study.sets.items()],
        sessions=_session_words(session_headers(study)),
        procedure=_procedure_words(study),
        exclusions=exclusion_words(analysis),
        regressions={axis: _regression_words(analysis, axis) for axis in ("d", "c")},
        versions=software_versions(),
    )


def exclusion_words(analysis: StudyAnalysis) -> list[str]:
    """Who was left out, who was flagged and why; what the analysis remarks about the data."""
    study, fitted = analysis.study, analysis.fit.confirmatory.participants
    unfitted = [name for name in study.pairs.participants if name not in fitted]
    said = [
        f"Judgements of {joined(unfitted)} could not be fitted and add nothing to the weight of d."
        if unfitted
        else "No participant was excluded."
    ]
    odd = [*judgement_remarks(study.pairs, study.judgements), *rating_remarks(study.ratings)]
    said += odd or ["No participant's judgements or ratings stand out as constant, reversed or unlike the others'."]
    return [*said, *dict.fromkeys(remark for remark in analysis.fit.warnings if remark not in odd)]


def _simulated_words(study: Study) -> str:
    truth = study.simulated
    if truth is None or truth.empty:
        return ""
    if not study.embodied:
        return "Answers of simulated observers were computed by a program."
    ranges = {name: (float(truth[name].min()), float(truth[name].max())) for name in ("ratio", "exponent", "noise_sd")}
    return (
        f"Answers of simulated observers were computed from the gloss paper's metric with a weight of d of their own "
        f"({interval(ranges['ratio'], 2)}), a slider compressed by an exponent of {interval(ranges['exponent'], 2)}, "
        f"and noise with a standard deviation of {interval(ranges['noise_sd'], 1)} slider units."
    )


def _levels(table: pd.DataFrame) -> str:
    parts = []
    for column, symbol in (("rho_d", "ρd"), ("rho_s", "ρs"), ("alpha", "α")):
        parts.append(f"{symbol} {', '.join(f'{value:g}' for value in sorted(table[column].unique()))}")
    return f"{counted(len(table), 'stimulus', 'stimuli')}: {'; '.join(parts)}"


def _procedure_words(study: Study) -> list[str]:
    judged = study.judgements
    same = judged["stimulus_a"] == judged["stimulus_b"]
    different, identical = (
        rows.groupby("participant_id").size().reindex(list(study.pairs.participants), fill_value=0)
        for rows in (judged[~same], judged[same])
    )
    said = [
        f"In the pairwise task each participant judged the difference in gloss of {_each(different)} pairs of "
        f"different stimuli and of {_each(identical)} identical pairs."
    ]
    for axis, table in study.ratings.items():
        times = table.groupby(["participant_id", "stimulus"]).size()
        said.append(
            f"In the task “{_TASKS[axis]}” each participant rated the gloss of "
            f"{_each(table.groupby('participant_id')['stimulus'].nunique())} single images, each {_each(times)} times."
        )
    return said


def _session_words(headers: list[dict[str, Any]]) -> list[str]:
    """What the sessions' journals tell of the tasks and of how they were run."""
    said = []
    protocols: dict[Any, Any] = {header.get("task"): header.get("protocol") for header in headers}
    for task, protocol in sorted(protocols.items(), key=str):
        try:
            question, slider = protocol["texts"]["question"], protocol["slider"]
            labels = f"“{slider['low_label']}” and “{slider['high_label']}”"
        except (KeyError, TypeError):
            continue  # a journal of another kind of session
        said.append(f"The question of “{task}” was: “{question}” The ends of its slider were labelled {labels}.")
    modes = sorted({str(header["mode"]) for header in headers if "mode" in header})
    if modes == ["headless"]:
        said.append("All sessions ran without a screen.")
    elif modes:
        said.append(f"Modes of the sessions: {joined(modes)}.")
    angles = sorted({header["image_angle_deg"] for header in headers if header.get("image_angle_deg")})
    if angles:
        said.append(f"On the screen an image subtended {interval((angles[0], angles[-1]), 2)}°.")
    return said


def _regression_words(analysis: StudyAnalysis, axis: str) -> str:
    line = analysis.fit.regressions[axis]
    return (
        f"rating = {fixed(line.intercept, 1)} + {fixed(line.slope, 1)} {axis} (95 % interval of the slope over stimuli "
        f"{interval(line.slope_ci95, 1)}; {counted(line.n_stimuli, 'stimulus', 'stimuli')})"
    )


def _each(counts: Iterable[int]) -> str:
    """A number that all share, or the range of numbers."""
    low, high = min(counts), max(counts)
    return f"{low}" if low == high else f"{low} to {high}"
