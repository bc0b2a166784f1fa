"""gloss validate: how well a gloss space predicts judged differences."""

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from gloss_analysis.commands.observers import note_simulated, simulated_of
from glossspace.console import JsonFlag, note, print_json, print_table
from glossspace.errors import GlossError
from glossspace.files import check_file_target
from glossspace.named_space import named_space, note_simulated_space

if TYPE_CHECKING:
    from gloss_analysis.judgements.dissimilarity import Dissimilarities
    from gloss_analysis.validation.metric_validation import MetricComparison, MetricValidation
    from glossspace.metric import GlossSpace

__all__ = ["validate"]

_FIGURE_SUFFIXES = (".png", ".svg", ".pdf")


def validate(
    table: Path,
    /,
    *,
    space: str = "paper",
    stimuli: Path | None = None,
    against: str | None = None,
    figure: Path | None = None,
    json: JsonFlag = False,
) -> None:
    """How well a gloss space predicts judged differences: STRESS in per cent.

    STRESS is García's index of colour-difference formulas, not Kruskal's of
    a scaling. The ceiling is how well the other participants predict one:
    about the best that a space can do; where they are few, it may do better.
    With --against, an F test compares two spaces.

    Examples:

        gloss validate study/dataset --space gloss-space.json

        gloss validate pairs.csv --stimuli stimuli.csv --against my.json --json

    Parameters
    ----------
    table
        A dataset folder, a CSV file with the columns participant_id, stimulus_a, stimulus_b, dissimilarity, or a
        square matrix.
    space
        A gloss-space.json, or the word paper for the gloss paper's space.
    stimuli
        A CSV file with the columns stimulus, rho_d, rho_s, alpha. By default what the dataset itself recorded.
    against
        Another space to compare with, named in the same way.
    figure
        A file for a picture of judged against predicted differences.
    """
    from gloss_analysis.judgements.judgement_table import read_judgements
    from gloss_analysis.judgements.participant_remarks import judgement_remarks
    from gloss_analysis.validation.metric_validation import compare_metrics, validate_metric
    from glossspace.dataset import read_stimuli, read_stimulus_table

    if figure is not None and figure.suffix.lower() not in _FIGURE_SUFFIXES:
        raise GlossError(f"Invalid figure '{figure}'. Allowed: a file name that ends in {', '.join(_FIGURE_SUFFIXES)}.")
    if figure is not None:
        check_file_target(figure)
    if stimuli is None and table.exists() and not table.is_dir():
        raise GlossError(
            f"'{table}' does not tell what its stimuli are. Give --stimuli, a CSV file with the columns stimulus, "
            "rho_d, rho_s, alpha."
        )
    spaces = [named_space(name) for name in (space, against) if name is not None]
    pairs, judgements = read_judgements(table)
    known = read_stimuli(table) if stimuli is None else read_stimulus_table(stimuli)
    predicted = [_predicted(one, known, pairs) for one in spaces]
    comparison = compare_metrics(pairs, *predicted) if len(spaces) == 2 else None
    validations = (
        [validate_metric(pairs, predicted[0])] if comparison is None else [comparison.first, comparison.second]
    )
    remarks = (*judgement_remarks(pairs, judgements), *_untested(known, pairs))
    simulated = simulated_of(table, pairs.participants)
    note_simulated(simulated, pairs.participants)
    for one in spaces:
        note_simulated_space(one)
        _note_fitted(one, pairs.participants)
    if figure is not None:
        _draw(validations[0], spaces[0].name, figure)
        note(f"Figure: {figure}")
    if json:
        print_json(
            {"space": spaces[0].name}
            | _document(validations[0])
            | {"simulated": simulated, "warnings": (*validations[0].warnings, *remarks)}
            | ({} if comparison is None else {"against": _against(comparison, spaces[1].name)})
        )
        return
    _print(validations, comparison, [one.name for one in spaces])
    for remark in remarks:
        note(remark)


def _untested(stimuli: pd.DataFrame, pairs: "Dissimilarities") -> list[str]:
    """What the judged stimuli do not vary, so that no judgement can speak for or against it."""
    judged = stimuli[stimuli["stimulus"].isin(pairs.stimuli)]
    remarks = []
    for column, what in (("rho_d", "how c depends on lightness"), ("alpha", "what it says of distinctness d")):
        values = judged[column].unique()
        if len(values) == 1:
            remarks.append(f"All judged stimuli have {column} = {values[0]:g}: of a space, {what} is not tested here.")
    return remarks


def _predicted(space: "GlossSpace", stimuli: pd.DataFrame, pairs: "Dissimilarities") -> np.ndarray:
    from gloss_analysis.axis_functions.coordinates import axis_coordinates

    c, d = axis_coordinates(stimuli, list(pairs.stimuli), space)[["c", "d"]].to_numpy().T
    first, second = pairs.pairs
    return np.asarray(space.distance_between(c[first], d[first], c[second], d[second]))


def _note_fitted(space: "GlossSpace", participants: tuple[str, ...]) -> None:
    fitted = space.provenance.get("participants")
    both = [name for name in participants if isinstance(fitted, list) and name in fitted]
    if both:
        note(
            f"The space '{space.name}' was fitted to participants of these names: {', '.join(both)}. If to these "
            "judgements, it predicts them better than it would others."
        )


def _document(validation: "MetricValidation") -> dict[str, object]:
    document = asdict(validation)
    for name in ("predicted", "judged"):
        del document[name]
    return document


def _against(comparison: "MetricComparison", name: str) -> dict[str, object]:
    document = {key: value for key, value in vars(comparison).items() if key not in ("first", "second")}
    better = {"first": "space", "second": "against", None: None}[comparison.better]
    return {"space": name} | _document(comparison.second) | document | {"better": better}


def _print(validations: "list[MetricValidation]", comparison: "MetricComparison | None", names: list[str]) -> None:
    first = validations[0]
    columns = names if len(set(names)) == len(names) else ["space", "against"]
    stress = {f"STRESS % of {column}": one.stress for column, one in zip(columns, validations, strict=True)}
    others = {"of the other participants": first.inter_observer}
    print_table(pd.DataFrame({"participant": first.participants} | stress | others))
    for column, one in zip(columns, validations, strict=True):
        print(
            f"{column}: STRESS {one.mean_stress:.4g} % in the mean of participants, {one.pooled_stress:.4g} % of their "
            f"mean judgement of {one.n_pairs} pairs."
        )
    if first.ceiling is not None:
        print(f"Ceiling: the other participants predict one with {first.ceiling:.4g} %.")
    if comparison is not None:
        low, high = comparison.f_interval
        better = {"first": columns[0], "second": columns[-1], None: "neither, as far as can be told"}[comparison.better]
        print(
            f"F = {comparison.f_ratio:.4g} (95 % if equally good: {low:.4g} to {high:.4g}), p = "
            f"{comparison.p_value:.3g}. Better: {better}. {comparison.n_favouring_first} participants are "
            f"predicted better by {columns[0]}, {comparison.n_favouring_second} by {columns[-1]}."
        )
    for warning in dict.fromkeys(warning for one in validations for warning in one.warnings):
        note(warning)


def _draw(validation: "MetricValidation", name: str, path: Path) -> None:
    from gloss_analysis.figures.validation import draw_predicted_against_judged
    from glossspace.files import whole_file

    drawn = draw_predicted_against_judged(validation, metric=f"gloss distance, {name}")
    with whole_file(path) as temporary:
        drawn.savefig(temporary, dpi=170)
