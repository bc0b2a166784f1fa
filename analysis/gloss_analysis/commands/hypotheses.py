"""gloss hypotheses: what a gloss axis could be, by ratings and by judged pairs."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import pandas as pd

from gloss_analysis.commands.observers import note_simulated, simulated_of
from gloss_analysis.commands.waiting import FITTING
from glossspace.console import JsonFlag, note, noted_if_slow, print_json, print_table, print_text
from glossspace.errors import GlossError
from glossspace.files import check_file_target

if TYPE_CHECKING:
    from gloss_analysis.hypotheses.candidates import Axis, Hypothesis
    from gloss_analysis.judgements.dissimilarity import Dissimilarities

__all__ = ["hypotheses"]

_FIGURE_SUFFIXES = (".png", ".svg", ".pdf")
# The magnitude tasks of a dataset that vary each axis.
_TASKS = {"c": "contrast", "d": "doi"}


@dataclass(frozen=True)
class _Judgements:
    stimuli: pd.DataFrame
    pairs: "Dissimilarities | None"
    ratings: pd.DataFrame | None
    simulated: list[str]
    judgements: pd.DataFrame | None
    axis: str

    @property
    def remarks(self) -> tuple[str, ...]:
        """What is odd in the answers, and what the stimuli leave open."""
        from gloss_analysis.judgements.participant_remarks import judgement_remarks, rating_remarks

        odd = () if self.pairs is None else judgement_remarks(self.pairs, self.judgements)
        odd += () if self.ratings is None else rating_remarks({self.axis: self.ratings})
        reflectances = self.stimuli.loc[self.stimuli["stimulus"].isin(self.stimuli_judged), "rho_d"].unique()
        if self.axis == "c" and len(reflectances) == 1:
            odd += (
                f"All judged stimuli have one lightness (rho_d {reflectances[0]:g}): forms of c that differ in how it "
                "depends on lightness cannot be told apart by them.",
            )
        return odd

    @property
    def participants(self) -> tuple[str, ...]:
        judges = () if self.pairs is None else self.pairs.participants
        raters = () if self.ratings is None else self.ratings["participant_id"]
        return tuple(dict.fromkeys([*judges, *raters]))

    @property
    def stimuli_judged(self) -> list[str]:
        paired = () if self.pairs is None else self.pairs.stimuli
        return list(dict.fromkeys([*paired, *(() if self.ratings is None else self.ratings["stimulus"])]))


def hypotheses(
    dataset: Path | None = None,
    /,
    *,
    pairs: Path | None = None,
    magnitudes: Path | None = None,
    stimuli: list[Path] | None = None,
    axis: Literal["c", "d"] = "c",
    function: list[str] | None = None,
    level: Literal["ratio", "interval", "spline", "ordinal"] = "ordinal",
    ties: Literal["primary", "secondary"] = "primary",
    figure: Path | None = None,
    json: JsonFlag = False,
) -> None:
    """Compare what contrast gloss c, or distinctness d, could be: on ratings, and on judged pairs.

    For c the gloss paper's three: luminance ratio and lightness difference of
    the reflected patches, measured in the images, and its object-space form.
    For d its 1 - alpha, beside the square root, the logarithm and the inverse
    of alpha, and the measured width of a reflected edge. Add your own with
    --function, an expression over columns of the stimuli; columns, numbers,
    + - * / **, brackets, and cbrt, sqrt, log, log10, exp, abs, minimum,
    maximum.

    Examples:

        gloss hypotheses study/dataset --axis c --figure hypotheses.svg

        gloss hypotheses study/dataset --axis d --function "square=1 - alpha**2"

        gloss hypotheses --pairs p.csv --magnitudes m.csv --stimuli s.csv --json

        gloss hypotheses --pairs p.csv --stimuli s.csv --stimuli sets/mine

    Parameters
    ----------
    dataset
        The dataset folder. Leave it out to give tables.
    pairs
        A CSV file with the columns participant_id, stimulus_a, stimulus_b, dissimilarity.
    magnitudes
        A CSV file with the columns participant_id, stimulus, repeat, rating; and axis (c or d), where the stimuli do
        not tell which axis the study varied.
    stimuli
        A CSV file with the columns stimulus, rho_d, rho_s, alpha and any more, or the folder of a stimulus set, whose
        images were measured; may be given several times. By default what the dataset recorded, and the stimulus sets
        of the study folder that it lies in.
    axis
        Which axis.
    function
        One more hypothesis, name=expression, such as "no halves=cbrt(rho_s + rho_d) - cbrt(rho_d)"; may be given
        several times.
    level
        Of the pairs: what of the judgements is trusted.
    ties
        Ordinal only: primary lets equal judgements differ in distance, secondary does not.
    figure
        A file for a picture: ratings over each hypothesis, and the stress of each.
    """
    from gloss_analysis.figures.hypotheses import hypotheses_in_words, hypotheses_table
    from gloss_analysis.hypotheses.candidates import HYPOTHESES, with_values
    from gloss_analysis.hypotheses.comparison import compare_hypotheses, confirm_hypotheses
    from gloss_analysis.hypotheses.expressions import hypothesis_from

    tables = [option for option, path in (("--pairs", pairs), ("--magnitudes", magnitudes)) if path is not None]
    if dataset is not None and tables:
        raise GlossError(f"Give either the dataset '{dataset}' or {' and '.join(tables)}, not both.")
    if dataset is None and not tables:
        raise GlossError("Nothing to test on. Give a dataset folder, or --pairs, --magnitudes or both with --stimuli.")
    if figure is not None:
        if figure.suffix.lower() not in _FIGURE_SUFFIXES:
            raise GlossError(
                f"Invalid figure '{figure}'. Allowed: a file name that ends in {', '.join(_FIGURE_SUFFIXES)}."
            )
        check_file_target(figure)
    typed = [hypothesis_from(text, axis) for text in function or ()]
    if dataset is not None:
        given = _from_dataset(dataset, stimuli or [], axis)
    else:
        given = _from_tables(pairs, magnitudes, stimuli or [], axis)
    judged = given.stimuli["stimulus"].isin(given.stimuli_judged)
    known, skipped = with_values(HYPOTHESES[axis], given.stimuli[judged])
    tested = [*known, *typed]
    compared = None if given.ratings is None else compare_hypotheses(tested, given.stimuli, given.ratings)
    confirmed = None
    if given.pairs is not None:
        with noted_if_slow(FITTING):
            confirmed = confirm_hypotheses(tested, given.stimuli, given.pairs, level=level, ties=ties)
    sentences = hypotheses_in_words(compared, confirmed)
    remarks = given.remarks
    if confirmed is not None:
        remarks += tuple(dict.fromkeys(one for one in confirmed["remarks"] if one))
    note_simulated(given.simulated, given.participants)
    if figure is not None:
        _draw(tested, given, confirmed, figure)
    if json:
        print_json(
            {
                "axis": axis,
                "ratings": _records(compared),
                "pairs": _records(confirmed),
                "sentences": sentences,
                "skipped": skipped,
                "simulated": given.simulated,
                "warnings": remarks,
            }
        )
        return
    print_table(hypotheses_table(compared, confirmed))
    print_text(*sentences)
    for name, why in skipped.items():
        note(f"Not tested: {name}. {why}")
    for remark in remarks:
        note(remark)


def _from_dataset(dataset: Path, stimuli: list[Path], axis: "Axis") -> _Judgements:
    from gloss_analysis.judgements.judgement_table import from_table
    from glossspace.dataset import read_dissimilarities, read_magnitudes, simulated_participants, tasks_of

    kinds = tasks_of(dataset)
    rated = kinds.get(_TASKS[axis]) == "magnitude"
    judged = "pairwise" in kinds.values()
    if not rated and not judged:
        raise GlossError(
            f"The dataset '{dataset}' has neither judged pairs nor the task {_TASKS[axis]!r}, whose ratings are along "
            f"{axis}. Run 'gloss session' into it."
        )
    table = read_dissimilarities(dataset) if judged else None
    return _Judgements(
        stimuli=_stimuli_of(dataset, stimuli),
        pairs=None if table is None else from_table(table, source=f"The dataset '{dataset}'"),
        ratings=read_magnitudes(dataset, _TASKS[axis]) if rated else None,
        simulated=list(simulated_participants(dataset)),
        judgements=table,
        axis=axis,
    )


def _stimuli_of(dataset: Path, stimuli: list[Path]) -> pd.DataFrame:
    from gloss_analysis.hypotheses.stimulus_columns import joined, read_stimulus_columns
    from gloss_analysis.study.folder import STIMULUS_SETS, stimulus_folder
    from glossspace.dataset import read_stimuli
    from glossspace.stimulus_set import MANIFEST_NAME

    if not stimuli:
        sets = [stimulus_folder(dataset.absolute().parent, name) for name in STIMULUS_SETS]
        stimuli = [folder for folder in sets if (folder / MANIFEST_NAME).is_file()]
    recorded = (dataset / "stimuli.csv").is_file()
    if not stimuli:
        return read_stimuli(dataset)
    known = read_stimulus_columns(stimuli)
    return joined([("The dataset", read_stimuli(dataset)), ("A file", known)]) if recorded else known


def _from_tables(pairs: Path | None, magnitudes: Path | None, stimuli: list[Path], axis: "Axis") -> _Judgements:
    from gloss_analysis.hypotheses.stimulus_columns import read_stimulus_columns
    from gloss_analysis.judgements.judgement_table import read_judgements
    from gloss_analysis.ratings.rating_table import read_ratings

    if not stimuli:
        raise GlossError("Without --stimuli nothing says what was shown. Give a CSV file with the columns stimulus, "
                         "rho_d, rho_s, alpha, or the folder of a stimulus set.")  # fmt: skip
    known = read_stimulus_columns(stimuli)
    lacking = [name for name in ("rho_d", "rho_s", "alpha") if name not in known]
    if lacking:
        raise GlossError(
            f"No --stimuli has a column {lacking[0]} of numbers; found {', '.join(known.columns)}. One of them must "
            "have the columns stimulus, rho_d, rho_s, alpha."
        )
    judged, table = (None, None) if pairs is None else read_judgements(pairs)
    ratings: Mapping[Any, pd.DataFrame] = {} if magnitudes is None else read_ratings(magnitudes, known)
    if judged is None and axis not in ratings:
        raise GlossError(
            f"'{magnitudes}' holds no ratings along {axis}, but along {' and '.join(ratings)}. Choose --axis "
            f"{next(iter(ratings))}, or give --pairs."
        )
    simulated = [] if pairs is None or judged is None else simulated_of(pairs, judged.participants)
    return _Judgements(known, judged, ratings.get(axis), simulated, table, axis)


def _records(table: pd.DataFrame | None) -> list[dict[str, Any]] | None:
    if table is None:
        return None
    # AICc of a perfect fit is -inf, which JSON has no word for.
    return [dict(row) for row in table.drop(columns="remarks", errors="ignore").to_dict("records")]


def _draw(tested: "list[Hypothesis]", given: _Judgements, confirmed: pd.DataFrame | None, path: Path) -> None:
    from gloss_analysis.figures.hypotheses import draw_hypotheses
    from glossspace.files import whole_file

    some = f"{len(given.simulated)} of {len(given.participants)} participants simulated"
    title = some if given.simulated else ""
    drawn = draw_hypotheses(tested, given.stimuli, given.ratings, confirmed=confirmed, title=title)
    with whole_file(path) as temporary:
        drawn.savefig(temporary, dpi=170)
    note(f"Figure: {path}")
