"""The gloss paper's whole study in one folder: where its parts lie, and reading them.

Layout of a study folder, which `gloss reproduce` fills and `gloss report` reads::

    stimuli/experiment1, stimuli/contrast, stimuli/doi    stimulus sets with their manifests
    stimuli/ring, stimuli/matched                         the space applied (figures 11 and 12), where it was
    dataset/                                              the judgements of all participants
    gloss-space.json                                      the fitted space
    report.html                                           the report, self-contained
    report/                                               its figures, tables and text, for a paper
"""

from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.judgements.judgement_table import from_table
from glossspace.dataset import read_dissimilarities, read_magnitudes, read_simulated_observers, simulated_participants
from glossspace.errors import GlossError
from glossspace.stimulus_set import StimulusSet, read_stimulus_set
from glossspace.user_table import read_user_table

__all__ = [
    "STIMULUS_SETS",
    "Study",
    "dataset_folder",
    "gloss_space_file",
    "read_study",
    "report_file",
    "stimulus_folder",
]

STIMULUS_SETS = ("experiment1", "contrast", "doi")
_MEASUREMENTS = "measurements.csv"


def stimulus_folder(study: Path, name: str) -> Path:
    """Folder of one stimulus set of a study."""
    return study / "stimuli" / name


def dataset_folder(study: Path) -> Path:
    """Folder of a study's dataset."""
    return study / "dataset"


def gloss_space_file(study: Path) -> Path:
    """Where a study keeps its fitted gloss space."""
    return study / "gloss-space.json"


def report_file(study: Path) -> Path:
    """Where a study keeps its report."""
    return study / "report.html"


@dataclass(frozen=True)
class Study:
    """What was shown and what was answered.

    Attributes
    ----------
    folder : Path
    sets : mapping of str to StimulusSet
    stimuli : DataFrame
        All stimuli of all sets, once each, with what was measured in their images where it was.
    judgements : DataFrame
        All judged pairs, identical ones too: `participant_id`, `stimulus_a`, `stimulus_b`, `dissimilarity`.
    pairs : Dissimilarities
        The same for scaling, without identical pairs.
    ratings : mapping of {"c", "d"} to DataFrame
        Magnitude estimates of the contrast and of the distinctness study.
    simulated_participants : tuple of str
        Those whose answers a program gave.
    simulated : DataFrame or None
        True parameters of the simulated participants, where they are known.
    """

    folder: Path
    sets: dict[str, StimulusSet]
    stimuli: pd.DataFrame
    judgements: pd.DataFrame
    pairs: Dissimilarities
    ratings: dict[str, pd.DataFrame]
    simulated_participants: tuple[str, ...]
    simulated: pd.DataFrame | None

    @property
    def participants(self) -> tuple[str, ...]:
        """Everybody who judged or rated anything, in the order of their names."""
        tables = (self.judgements, *self.ratings.values())
        return tuple(sorted({str(name) for table in tables for name in table["participant_id"].unique()}))

    @property
    def true_ratios(self) -> dict[str, float]:
        """Weights of d over c that simulated participants embody; without those who looked at images or are people."""
        known = {} if self.simulated is None else self.simulated.set_index("participant_id")["ratio"].dropna().to_dict()
        return {name: float(ratio) for name, ratio in known.items() if name in self.simulated_participants}

    @property
    def embodied(self) -> bool:
        """Whether simulated participants answered by the gloss paper's metric, so that they embody what is found."""
        programs = [name for name in self.simulated_participants if name in self.participants]
        return bool(programs) and all(name in self.true_ratios for name in programs)

    @property
    def observers(self) -> str:
        """What the participants are: "simulated", "human", or "human and simulated"."""
        programs = set(self.simulated_participants) & set(self.participants)
        if not programs:
            return "human"
        return "simulated" if programs == set(self.participants) else "human and simulated"


def read_study(folder: Path) -> Study:
    """Read a study folder.

    Raises
    ------
    GlossError
        A part is missing or broken; the message says which and how to mend it.
    """
    if not folder.is_dir():
        raise GlossError(f"No study folder at '{folder}'. Make one with `gloss reproduce --out '{folder}'`.")
    sets = {name: read_stimulus_set(stimulus_folder(folder, name)) for name in STIMULUS_SETS}
    stimuli = pd.concat([one.table() for one in sets.values()]).drop_duplicates("stimulus", ignore_index=True)
    stimuli = _with_measurements(stimuli, [stimulus_folder(folder, name) / _MEASUREMENTS for name in STIMULUS_SETS])
    dataset = dataset_folder(folder)
    judgements = read_dissimilarities(dataset)
    return Study(
        folder=folder,
        sets=sets,
        stimuli=stimuli,
        judgements=judgements,
        pairs=from_table(judgements, source=f"The dataset '{dataset}'"),
        ratings={"c": read_magnitudes(dataset, "contrast"), "d": read_magnitudes(dataset, "doi")},
        simulated_participants=simulated_participants(dataset),
        simulated=read_simulated_observers(dataset),
    )


def _with_measurements(stimuli: pd.DataFrame, files: list[Path]) -> pd.DataFrame:
    tables = [
        read_user_table(path, what="measurements of the images", columns=["stimulus"])
        for path in files
        if path.is_file()
    ]
    if not tables:
        return stimuli
    measured = pd.concat(tables).drop_duplicates("stimulus").set_index("stimulus")
    return stimuli.join(measured.apply(pd.to_numeric, errors="coerce"), on="stimulus")
