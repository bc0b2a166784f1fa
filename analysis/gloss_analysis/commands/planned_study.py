"""What the commands for design help share: the stimuli and the population of a study that is planned."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from cyclopts import Parameter

from gloss_analysis.commands.observers import note_simulated, simulated_of
from glossspace.console import FiniteNumber, WholeNumber, note
from glossspace.errors import GlossError
from glossspace.metric import GlossSpace, Paint
from glossspace.named_space import named_space, note_simulated_space

if TYPE_CHECKING:
    from gloss_analysis.design.population import Population
    from gloss_analysis.design.precision import DesignPrecision

__all__ = [
    "PlannedStudy",
    "StudyOptions",
    "interval_columns",
    "number_of_pairs",
    "numbers",
    "planned_study",
    "print_population",
]

# Of anything that is counted: more would not end.
_MOST = 10_000
_FEWEST_STIMULI = 3


@Parameter(name="*")
@dataclass(frozen=True)
class StudyOptions:
    """Options of a planned study.

    Attributes
    ----------
    stimuli
        A CSV file with the columns stimulus, rho_d, rho_s, alpha. By default the pilot's, or the 27 of Experiment 1.
    like
        A pilot to take the population from: a dataset folder, or a CSV file of dissimilarities with --stimuli.
    space
        A gloss-space.json, or the word paper: its weight of d is taken for the true one. By default the pilot's own, or
        the gloss paper's 1.78.
    sd_log_ratio
        Standard deviation over observers of the logarithm of their own weight of d. By default the pilot's, or .15.
    exponent
        Of the slider's response, below 1 if it compresses. By default the pilot's, or .85.
    noise_sd
        Of one answer, in hundredths of the slider. By default the pilot's, or 4.
    slider_step
        The slider, 0 to 100, stops at multiples of it.
    """

    stimuli: Path | None = None
    like: Path | None = None
    space: str | None = None
    sd_log_ratio: FiniteNumber | None = None
    exponent: FiniteNumber | None = None
    noise_sd: FiniteNumber | None = None
    slider_step: WholeNumber = 1


@dataclass(frozen=True)
class PlannedStudy:
    """Stimuli and population; `pilot` names the participants that it was taken from, `simulated` those of them."""

    names: tuple[str, ...]
    coordinates: np.ndarray
    population: "Population"
    pilot: tuple[str, ...]
    simulated: list[str]

    def document(self) -> dict[str, object]:
        """Ready for JSON."""
        population = {field.name: getattr(self.population, field.name) for field in fields(self.population)}
        return {
            "simulated": True,
            "population": population | {"from_participants": self.pilot, "of_them_simulated": self.simulated},
        }


def planned_study(options: StudyOptions) -> PlannedStudy:
    """Work out what is planned, with remarks on stderr.

    Raises
    ------
    GlossError
        A file is missing or wrong, or a number is not possible.
    """
    from gloss_analysis.design.population import Population
    from glossspace.dataset import read_stimulus_table

    space = named_space("paper" if options.space is None else options.space)
    stated: dict[str, Any] = {"slider_step": options.slider_step}
    for name in ("sd_log_ratio", "exponent", "noise_sd"):
        if (value := getattr(options, name)) is not None:
            stated[name] = value
    pilot: tuple[str, ...] = ()
    simulated: list[str] = []
    table = None if options.stimuli is None else read_stimulus_table(options.stimuli)
    if options.like is not None:
        judged, pilot, simulated, found = _pilot(options.like, table, space)
        stated = found | stated
        table = judged if table is None else table
    elif table is None:
        table = _experiment_1()
    if (n := len(table)) < _FEWEST_STIMULI:
        raise GlossError(
            f"'{options.stimuli or options.like}' holds {n} {'stimulus' if n == 1 else 'stimuli'}. A study needs at "
            f"least {_FEWEST_STIMULI}. Add rows."
        )
    if options.space is not None or options.like is None:
        stated["ratio"] = space.weight_d / space.weight_c
    if options.space is not None:
        note_simulated_space(space)
    return PlannedStudy(tuple(table["stimulus"]), _coordinates(table, space), Population(**stated), pilot, simulated)


def print_population(study: PlannedStudy) -> None:
    """Say on stdout what is simulated."""
    p = study.population
    source = f"as in {len(study.pilot)} participants of the pilot" if study.pilot else "as stated"
    print(
        f"Simulated observers, {source}: weight of d {p.ratio:.4g} in the median, standard deviation of its logarithm "
        f"{p.sd_log_ratio:.3g}; answers 100 x**{p.exponent:.3g} with noise of {p.noise_sd:.3g}, in steps of "
        f"{p.slider_step}. {len(study.names)} stimuli."
    )


def interval_columns(designs: "Sequence[DesignPrecision]") -> dict[str, list[str]]:
    """Columns of a table for a person: widths, bias and coverage of designs."""
    return {
        "median width": [f"{one.width_median:.3f}" for one in designs],
        "90 % within": [f"{one.width_p90:.3f}" for one in designs],
        "bias, %": [f"{100 * one.bias:+.1f} ± {100 * one.bias_error:.1f}" for one in designs],
        "coverage, %": [
            "{:.0f} [{:.0f}, {:.0f}]".format(*(100 * share for share in (one.coverage, *one.coverage_ci95)))
            for one in designs
        ],
    }


def number_of_pairs(study: PlannedStudy) -> int:
    """How many pairs of different stimuli there are.

    Raises
    ------
    GlossError
        More than anybody judges, so that simulating that would not end.
    """
    n = len(study.names)
    every = n * (n - 1) // 2
    if every > _MOST:
        raise GlossError(f"{n} stimuli have {every:,} pairs. Allowed: up to {_MOST:,} pairs. Give fewer --stimuli.")
    return every


def numbers(text: str, *, option: str, least: int) -> list[int]:
    """Read whole numbers and ranges, such as 6,9,12:15, in rising order.

    Raises
    ------
    GlossError
        It is no such list, or a number is out of bounds.
    """
    found: set[int] = set()
    for part in text.split(","):
        low, colon, high = part.strip().partition(":")
        ends = [low, high] if colon else [low, low]
        if not all(end.isascii() and end.isdigit() and len(end) < 9 for end in ends):
            raise GlossError(f"Invalid {option} {text!r}. Allowed: numbers and ranges such as 6,9,12:15.")
        first, last = map(int, ends)
        if not least <= first <= last <= _MOST:
            raise GlossError(f"Invalid {option} {text!r}. Allowed: {least:,} to {_MOST:,}, ranges from low to high.")
        found.update(range(first, last + 1))
    return sorted(found)


def _experiment_1() -> pd.DataFrame:
    from gloss_analysis.design.simulation import EXPERIMENT_1_PAINTS
    from glossspace.stimulus_set import stimulus_name

    table = pd.DataFrame(EXPERIMENT_1_PAINTS, columns=["rho_d", "rho_s", "alpha"])
    table.insert(0, "stimulus", [stimulus_name(*paint) for paint in EXPERIMENT_1_PAINTS])
    return table


def _pilot(
    path: Path, given: pd.DataFrame | None, space: GlossSpace
) -> tuple[pd.DataFrame, tuple[str, ...], list[str], dict[str, float]]:
    """Stimuli that were judged, participants, those simulated, and what is estimated of the population."""
    from gloss_analysis.design.population import population_like
    from gloss_analysis.fit import axis_coordinates
    from gloss_analysis.judgements.judgement_table import read_table
    from glossspace.dataset import read_stimuli

    data = read_table(path)
    if path.is_dir():
        known = read_stimuli(path)
    elif given is not None:
        known = given
    else:
        raise GlossError(
            f"'{path}' does not tell what its stimuli are. Give --stimuli, a CSV file with the columns stimulus, "
            "rho_d, rho_s, alpha."
        )
    axis_coordinates(known, list(data.stimuli))  # refuses a stimulus that is not known
    judged = known.set_index("stimulus").loc[list(data.stimuli)].reset_index()
    found = population_like(data, _coordinates(judged, space), axes=("c", "d"))
    simulated = simulated_of(path, found.participants)
    note_simulated(simulated, found.participants)
    for warning in found.warnings:
        note(f"Pilot: {warning}")
    population = {name: getattr(found.population, name) for name in ("ratio", "sd_log_ratio", "exponent", "noise_sd")}
    return judged, found.participants, simulated, population


def _coordinates(table: pd.DataFrame, space: GlossSpace) -> np.ndarray:
    return np.column_stack(space.coordinates(Paint(*(table[name].to_numpy() for name in ("rho_d", "rho_s", "alpha")))))
