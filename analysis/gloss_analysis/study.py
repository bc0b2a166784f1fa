"""The gloss paper's whole study in one folder, and its analysis.

Layout of a study folder, which `gloss reproduce` fills and `gloss report` reads::

    stimuli/experiment1, stimuli/contrast, stimuli/doi    stimulus sets with their manifests
    dataset/                                              the judgements of all participants
    gloss-space.json                                      the fitted space
    report.html
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from gloss_analysis.axes.orientation import matched_dimensions, rotation_cost, turned_along
from gloss_analysis.axes.property_fitting import PropertyVector, property_vector
from gloss_analysis.dimensionality.study import DimensionalityStudy, study_dimensionality
from gloss_analysis.dissimilarity import Dissimilarities
from gloss_analysis.fit import GlossSpaceFit, axis_coordinates, fit_gloss_space, labelled_observers, rated_along
from gloss_analysis.hypotheses import HYPOTHESES_C, compare_hypotheses, confirm_hypotheses
from gloss_analysis.judgement_table import from_table
from gloss_analysis.mds import MdsSolution, scale
from glossspace.dataset import read_dissimilarities, read_magnitudes, read_simulated_observers, simulated_participants
from glossspace.errors import GlossError
from glossspace.stimulus_set import StimulusSet, read_stimulus_set
from glossspace.user_table import read_user_table

__all__ = [
    "STIMULUS_SETS",
    "AxisReading",
    "HypothesisTest",
    "Study",
    "StudyAnalysis",
    "analyse_study",
    "dataset_folder",
    "gloss_space_file",
    "read_study",
    "report_file",
    "stimulus_folder",
]

STIMULUS_SETS = ("experiment1", "contrast", "doi")
_MEASUREMENTS = "measurements.csv"
_ROTATIONS_DEG = np.arange(-45.0, 46.0, 5.0)


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
    pairs : Dissimilarities
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
    pairs: Dissimilarities
    ratings: dict[str, pd.DataFrame]
    simulated_participants: tuple[str, ...]
    simulated: pd.DataFrame | None


@dataclass(frozen=True)
class AxisReading:
    """How the dimensions of the two-dimensional solutions relate to c and d.

    Attributes
    ----------
    order, sign : ndarray, shape (2,)
        Which dimension of the weighted solution stands for c and for d, and whether it runs backwards.
    vectors : mapping of {"c", "d"} to PropertyVector
        Fitted to the weighted solution.
    rotation_deg, rotation_stress1 : ndarray
        Stress after turning the weighted solution's axes, with weights fitted anew.
    identity_rotated : ndarray, shape (n, 2)
        The identity solution, turned by property fitting: c rises along its first dimension.
    identity_vectors : mapping of {"c", "d"} to PropertyVector
        Fitted to the turned identity solution.
    """

    order: np.ndarray
    sign: np.ndarray
    vectors: dict[str, PropertyVector]
    rotation_deg: np.ndarray
    rotation_stress1: np.ndarray
    identity_rotated: np.ndarray
    identity_vectors: dict[str, PropertyVector]


@dataclass(frozen=True)
class HypothesisTest:
    """How three forms of contrast gloss fare.

    Attributes
    ----------
    compared : DataFrame
        On ratings; see `compare_hypotheses`.
    confirmed : DataFrame
        On judged pairs; see `confirm_hypotheses`.
    """

    compared: pd.DataFrame
    confirmed: pd.DataFrame


@dataclass(frozen=True)
class StudyAnalysis:
    """Everything that the report of a study shows.

    Attributes
    ----------
    study : Study
    seed : int
    dimensionality : DimensionalityStudy
        Weighted non-metric solutions in 1 to 5 dimensions, beside random and permuted judgements and held-out pairs.
    plane, identity_plane : MdsSolution
        The two-dimensional solutions with and without participants' weights.
    coordinates : DataFrame
        c and d of the stimuli of Experiment 1, in the order of the solutions.
    axes : AxisReading
    fit : GlossSpaceFit
    rated : mapping of {"c", "d"} to DataFrame
        Mean ratings beside the coordinates.
    hypotheses : HypothesisTest or None
        What could contrast gloss be? None where nothing was measured in the images.
    """

    study: Study
    seed: int
    dimensionality: DimensionalityStudy
    plane: MdsSolution
    identity_plane: MdsSolution
    coordinates: pd.DataFrame
    axes: AxisReading
    fit: GlossSpaceFit
    rated: dict[str, pd.DataFrame]
    hypotheses: HypothesisTest | None


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
    return Study(
        folder=folder,
        sets=sets,
        stimuli=stimuli,
        pairs=from_table(read_dissimilarities(dataset), source=f"The dataset '{dataset}'"),
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


def analyse_study(
    study: Study, *, seed: int = 1, n_jobs: int = 1, on_step: Callable[[str], None] = lambda step: None
) -> StudyAnalysis:
    """Analyse a study as the gloss paper does: dimensionality, axes, ratings, and the gloss space.

    Parameters
    ----------
    study : Study
    seed : int
        Of the random starts.
    n_jobs : int
        Processes; the result does not depend on it.
    on_step : callable
        Called with a few words before each part, to show progress.

    Returns
    -------
    StudyAnalysis
    """
    on_step("Stress in 1 to 5 dimensions, beside random and permuted judgements and held-out pairs")
    dimensionality = study_dimensionality(study.pairs, seed=seed, n_jobs=n_jobs)
    plane = next(solution for solution in dimensionality.curve if solution.n_dims == 2)
    on_step("Common space without weights")
    identity_plane = scale(study.pairs, n_dims=2, model="identity", seed=seed, n_jobs=n_jobs)
    on_step("Weights of the axes, regression of ratings")
    fit = fit_gloss_space(
        study.stimuli, study.pairs, study.ratings, name="this study", provenance=_provenance(study, seed)
    )
    coordinates = axis_coordinates(study.stimuli, list(study.pairs.stimuli))
    on_step("The hypotheses for c")
    hypotheses = _test_hypotheses(study)
    on_step("Reading of the axes")
    return StudyAnalysis(
        study=study,
        seed=seed,
        dimensionality=dimensionality,
        plane=plane,
        identity_plane=identity_plane,
        coordinates=coordinates,
        axes=_read_axes(study.pairs, plane, identity_plane, coordinates),
        fit=fit,
        rated={axis: rated_along(study.stimuli, table) for axis, table in study.ratings.items()},
        hypotheses=hypotheses,
    )


def _test_hypotheses(study: Study) -> HypothesisTest | None:
    judged = study.stimuli["stimulus"].isin({*study.pairs.stimuli, *study.ratings["c"]["stimulus"]})
    for hypothesis in HYPOTHESES_C:
        try:
            values = hypothesis.values(study.stimuli[judged])
        except GlossError:
            return None  # the images were not measured
        if not np.all(np.isfinite(values)):
            return None  # a patch is out of sight in some image
    return HypothesisTest(
        compare_hypotheses(HYPOTHESES_C, study.stimuli, study.ratings["c"]),
        confirm_hypotheses(HYPOTHESES_C, study.stimuli, study.pairs),
    )


def _read_axes(
    pairs: Dissimilarities, plane: MdsSolution, identity: MdsSolution, coordinates: pd.DataFrame
) -> AxisReading:
    properties = coordinates[["c", "d"]].to_numpy()
    order, sign = matched_dimensions(plane.coordinates, properties)
    turned = turned_along(identity.coordinates, properties[:, 0], properties[:, 1])
    return AxisReading(
        order=order,
        sign=sign,
        vectors={axis: property_vector(plane.coordinates, coordinates[axis].to_numpy()) for axis in ("c", "d")},
        rotation_deg=_ROTATIONS_DEG,
        rotation_stress1=rotation_cost(pairs, plane, _ROTATIONS_DEG),
        identity_rotated=turned,
        identity_vectors={axis: property_vector(turned, coordinates[axis].to_numpy()) for axis in ("c", "d")},
    )


def _provenance(study: Study, seed: int) -> dict[str, object]:
    observers = labelled_observers(study.pairs.participants, study.simulated_participants)
    return {"observers": observers, "seed": seed, "stimulus_sets": list(study.sets)}
