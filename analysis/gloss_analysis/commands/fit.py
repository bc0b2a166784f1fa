"""gloss fit: a gloss space from judgements."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import pandas as pd

from gloss_analysis.commands.observers import note_simulated, simulated_of
from gloss_analysis.commands.waiting import FITTING
from glossspace.console import JsonFlag, Seed, note, noted_if_slow, print_json, print_table
from glossspace.errors import GlossError
from glossspace.files import check_replaceable
from glossspace.metric import GlossSpace

if TYPE_CHECKING:  # for the annotations: the analysis itself is imported once it runs
    from gloss_analysis.axis_functions.axis_forms import FormChoice
    from gloss_analysis.fit import AxisFunctionsFit
    from gloss_analysis.judgements.dissimilarity import Dissimilarities

__all__ = ["fit"]

# The magnitude tasks of a dataset that vary one axis.
_TASKS = {"contrast": "c", "doi": "d"}


@dataclass(frozen=True)
class _Judgements:
    """What there is to fit; `simulated` are all participants that are known to be programs."""

    stimuli: pd.DataFrame
    pairs: "Dissimilarities | None"
    ratings: Mapping[str, pd.DataFrame]
    simulated: tuple[str, ...]
    name: str
    remarks: tuple[str, ...] = ()

    @property
    def participants(self) -> tuple[str, ...]:
        """Everyone who judged a pair or rated a stimulus, each once."""
        judges = () if self.pairs is None else self.pairs.participants
        return tuple(
            dict.fromkeys([*judges, *(one for table in self.ratings.values() for one in table["participant_id"])])
        )


def fit(
    dataset: Path | None = None,
    /,
    *,
    out: Path,
    pairs: Path | None = None,
    magnitudes: Path | None = None,
    stimuli: Path | None = None,
    forms: Literal["chosen", "paper"] = "chosen",
    level: Literal["ratio", "interval", "spline", "ordinal"] = "ordinal",
    ties: Literal["primary", "secondary"] = "primary",
    interval: Literal["t", "bootstrap"] = "t",
    seed: Seed = 1,
    json: JsonFlag = False,
) -> None:
    """Fit a gloss space to judged pairs, to magnitude estimates, or to both: of a dataset, or of tables of any study.

    Pairs give the weight of distinctness d over that of contrast gloss c. Ratings
    give the axis functions: the gloss paper's forms, or the same with another
    exponent, diffuse share or offset where left-out stimuli and pairs speak for
    it. Without pairs the weight remains the gloss paper's 1.78, and the output
    says that it was not fitted.

    Examples:

        gloss fit study/dataset --out gloss-space.json

        gloss fit study/dataset --stimuli stimuli.csv --out gloss-space.json --json

        gloss fit --pairs p.csv --magnitudes m.csv --stimuli s.csv --out space.json

        gloss fit --magnitudes m.csv --stimuli s.csv --out space.json

    Parameters
    ----------
    dataset
        The dataset folder. Leave it out to give tables.
    out
        The file to write; `gloss distance --space` reads it. Of files that are there, only a gloss space is replaced.
    pairs
        A CSV file with the columns participant_id, stimulus_a, stimulus_b, dissimilarity.
    magnitudes
        A CSV file with the columns participant_id, stimulus, repeat, rating; and axis (c or d), where the stimuli do
        not tell which axis the study varied.
    stimuli
        A CSV file with the columns stimulus, rho_d, rho_s, alpha. By default what the dataset itself recorded.
    forms
        Of the axis functions: chosen by cross-validation, or the gloss paper's alone.
    level
        What of the judged pairs is trusted: their order, their intervals, their ratios.
    ties
        Ordinal only: primary lets equal judgements differ in distance, secondary does not.
    interval
        Of the weight of d: Student's on logarithms, or a studentised bootstrap over participants.
    seed
        Of the bootstrap.
    """
    from gloss_analysis.fit import fit_axis_functions, fit_gloss_space, labelled_observers

    tables = [option for option, path in (("--pairs", pairs), ("--magnitudes", magnitudes)) if path is not None]
    if dataset is not None and tables:
        raise GlossError(f"Give either the dataset '{dataset}' or {' and '.join(tables)}, not both.")
    if dataset is None and not tables:
        raise GlossError("Nothing to fit. Give a dataset folder, or --pairs, --magnitudes or both with --stimuli.")
    check_replaceable(out, GlossSpace.load, what="gloss space that can be read")
    if dataset is not None:
        given = _from_dataset(dataset, stimuli)
    elif stimuli is not None:
        given = _from_tables(pairs, magnitudes, stimuli)
    else:
        raise GlossError(
            f"Without --stimuli nothing says what was shown in {' and '.join(tables)}. Give a CSV file with the "
            "columns stimulus, rho_d, rho_s, alpha."
        )
    provenance = {"observers": labelled_observers(given.participants, given.simulated)}
    fitted: AxisFunctionsFit
    with noted_if_slow(FITTING):
        if given.pairs is None:
            fitted = fit_axis_functions(
                given.stimuli, given.ratings, forms=forms, name=given.name, provenance=provenance
            )
        else:
            fitted = fit_gloss_space(
                given.stimuli, given.pairs, given.ratings, level=level, ties=ties, interval=interval, seed=seed,
                forms=forms, name=given.name, provenance=provenance,
            )  # fmt: skip
    simulated = [name for name in given.participants if name in given.simulated]
    note_simulated(simulated, given.participants)
    fitted.space.save(out)
    _show(fitted, out, simulated, (*fitted.warnings, *given.remarks), json=json)


def _from_dataset(dataset: Path, stimuli: Path | None) -> _Judgements:
    from gloss_analysis.judgements.judgement_table import from_table
    from gloss_analysis.judgements.participant_remarks import judgement_remarks
    from glossspace.dataset import (
        read_dissimilarities,
        read_magnitudes,
        read_stimuli,
        read_stimulus_table,
        simulated_participants,
        tasks_of,
    )

    kinds = tasks_of(dataset)
    rated = [task for task, kind in kinds.items() if kind == "magnitude"]
    studies = {axis: task for task, axis in _TASKS.items() if task in rated}
    pairs: Dissimilarities | None = None
    odd: tuple[str, ...] = ()
    if "pairwise" in kinds.values() or not studies:  # with neither, the error says how to get pairs
        table = read_dissimilarities(dataset)
        pairs = from_table(table, source=f"The dataset '{dataset}'")
        odd = judgement_remarks(pairs, table)
    unused = [task for task in rated if task not in _TASKS]
    return _Judgements(
        stimuli=read_stimuli(dataset) if stimuli is None else read_stimulus_table(stimuli),
        pairs=pairs,
        ratings={axis: read_magnitudes(dataset, task) for axis, task in studies.items()},
        simulated=simulated_participants(dataset),
        name=f"fitted to {dataset.resolve().name}",
        remarks=(
            *odd,
            *(f"The ratings of the task {task!r} are not used: it is none of {', '.join(_TASKS)}." for task in unused),
        ),
    )


def _from_tables(pairs: Path | None, magnitudes: Path | None, stimuli: Path) -> _Judgements:
    from gloss_analysis.judgements.judgement_table import read_judgements
    from gloss_analysis.judgements.participant_remarks import judgement_remarks
    from gloss_analysis.ratings.rating_table import read_ratings
    from glossspace.dataset import read_stimulus_table

    known = read_stimulus_table(stimuli)
    judged, table = (None, None) if pairs is None else read_judgements(pairs)
    ratings = {} if magnitudes is None else read_ratings(magnitudes, known)
    # The pairs may be those of a dataset, which says who is a program.
    simulated = [] if pairs is None or judged is None else simulated_of(pairs, judged.participants)
    return _Judgements(
        stimuli=known,
        pairs=judged,
        ratings={str(axis): table for axis, table in ratings.items()},
        simulated=tuple(simulated),
        name=f"fitted to {' and '.join(path.resolve().name for path in (pairs, magnitudes) if path is not None)}",
        remarks=() if judged is None else judgement_remarks(judged, table),
    )


def _show(
    fitted: "AxisFunctionsFit", out: Path, simulated: list[str], warnings: tuple[str, ...], *, json: bool
) -> None:
    space = fitted.space
    was_fitted = space.provenance["weight_d_fitted"]
    if json:
        print_json(
            {
                "space": str(out),
                "weight_c": space.weight_c,
                "weight_d": space.weight_d,
                "weight_d_ci95": space.weight_d_ci95,
                "weight_d_fitted": was_fitted,
                "sources": space.provenance["sources"],
                "r_squared": {axis: one.r_squared for axis, one in fitted.regressions.items()},
                "axis_functions": {axis: _axis_document(fitted, axis) for axis in fitted.regressions},
                "simulated": simulated,
                "warnings": warnings,
            }
        )
        return
    rows = [(f"weight of d over that of c{'' if was_fitted else ', not fitted'}", space.weight_d)]
    if space.weight_d_ci95 is not None:
        rows += zip(("95 % from", "95 % to"), space.weight_d_ci95, strict=True)
    for axis, one in fitted.regressions.items():
        line = (("slope", one.slope), ("intercept", one.intercept), ("r²", one.r_squared))
        rows += [(f"{what} of the ratings along {axis}", value) for what, value in line]
    print_table(pd.DataFrame(rows, columns=["quantity", "value"]))
    for axis, choice in fitted.forms.items():
        print_table(_forms_table(choice), title=f"Forms of {axis}")
        print(choice.sentence)
    print(f"Axis functions: c = {space.contrast_form.text}; d = {space.distinctness_form.text}")
    print(f"Gloss space: {out}")
    for warning in warnings:
        note(warning)


def _axis_document(fitted: "AxisFunctionsFit", axis: str) -> dict[str, Any]:
    """The line of the ratings along an axis with its intervals, and all forms that were tried."""
    line, choice = fitted.space.axis_functions[axis], fitted.forms[axis]
    return asdict(line) | {"forms": fitted.space.provenance["forms"][axis], "sentence": choice.sentence}


def _forms_table(choice: "FormChoice") -> pd.DataFrame:
    return pd.DataFrame(
        {
            "form": [one.form.text for one in choice.candidates],
            "95 % of the free numbers": [
                ", ".join(
                    f"{name} at its limit"
                    if name in one.at_limit
                    else "{} {:.3g} to {:.3g}".format(name, *one.ci95.get(name, (math.nan, math.nan)))
                    for name in one.free
                )
                for one in choice.candidates
            ],
            "r²": [one.r_squared for one in choice.candidates],
            "error left out": [one.leave_one_out_error for one in choice.candidates],
            "taken": ["yes" if one is choice.chosen else "" for one in choice.candidates],
        }
    )
