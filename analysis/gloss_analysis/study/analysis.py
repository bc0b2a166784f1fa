"""The analysis of a study as the gloss paper makes it, with what the paper does not give: how sure each number is."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from gloss_analysis.axes.orientation import matched_dimensions, rotation_cost, turned_along
from gloss_analysis.axes.property_fitting import PropertyVector, property_vector
from gloss_analysis.axis_functions.axis_forms import FormChoice
from gloss_analysis.axis_functions.coordinates import axis_coordinates, rated_along
from gloss_analysis.confirmatory.indscal import ConfirmatoryIndscal, confirm_indscal
from gloss_analysis.confirmatory.orthogonality import Orthogonality, check_orthogonality
from gloss_analysis.confirmatory.ratio_intervals import ratio_intervals
from gloss_analysis.confirmatory.task_identity import TaskIdentity, compare_tasks
from gloss_analysis.dimensionality.study import DimensionalityStudy, study_dimensionality
from gloss_analysis.fit import GlossSpaceFit, fit_gloss_space, labelled_observers
from gloss_analysis.hypotheses.candidates import HYPOTHESES, Axis, Hypothesis, with_values
from gloss_analysis.hypotheses.comparison import compare_hypotheses, confirm_hypotheses
from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.judgements.reliability import Reliability, reliability
from gloss_analysis.mds import MdsSolution, scale
from gloss_analysis.ratings.magnitude import RaterConsistency, rater_consistency
from gloss_analysis.ratings.rating_uncertainty import r_squared_interval
from gloss_analysis.study.folder import Study
from gloss_analysis.uncertainty.bootstrap import BootstrapResult, bootstrap
from gloss_analysis.validation.metric_check import MetricCheck, check_metric

__all__ = ["AxisReading", "HypothesisTest", "StudyAnalysis", "analyse_study"]

_ROTATIONS_DEG = np.arange(-45.0, 46.0, 5.0)
_REPLICATES, _PERMUTATIONS = 1000, 199
# Of weights, which are fitted to every participant anew: p is no finer than .01.
_WEIGHT_PERMUTATIONS = 99


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
    """How several forms of an axis fare.

    Attributes
    ----------
    tested : tuple of Hypothesis
        Those that have a value for every stimulus.
    skipped : mapping of str to str
        The others, and why they were not tested.
    compared : DataFrame
        On ratings; see `compare_hypotheses`.
    confirmed : DataFrame
        On judged pairs; see `confirm_hypotheses`.
    """

    tested: tuple[Hypothesis, ...]
    skipped: dict[str, str]
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
        With the gloss paper's forms of c and d.
    forms : mapping of {"c", "d"} to FormChoice
        Whether the judgements ask for other forms.
    rated : mapping of {"c", "d"} to DataFrame
        Mean ratings beside the coordinates.
    hypotheses : mapping of {"c", "d"} to HypothesisTest
        What could the axis be? Without an axis of which fewer than two forms can be tested, as where nothing was
        measured in the images.
    resampled : BootstrapResult or None
        The weighted plane fitted anew to resampled participants. None with a single one.
    ratio_intervals : mapping of str to (low, high)
        Axis ratio of each participant whose own judgements fix it; see `ratio_intervals`.
    r_squared_intervals : mapping of {"c", "d"} to (low, high) or None
        Of the regressions of ratings, over participants.
    orthogonality : Orthogonality
        Are c and d independent?
    indscal : ConfirmatoryIndscal
        Do participants weigh them differently?
    tasks : tuple of TaskIdentity
        Is the scale of ratings that of the judged pairs, along c and along d?
    metric : MetricCheck
        How well the fitted space predicts the judgements, beside other spaces.
    raters : mapping of {"c", "d"} to tuple of RaterConsistency
    judges : tuple of Reliability
        Identical pairs.
    """

    study: Study
    seed: int
    dimensionality: DimensionalityStudy
    plane: MdsSolution
    identity_plane: MdsSolution
    coordinates: pd.DataFrame
    axes: AxisReading
    fit: GlossSpaceFit
    forms: Mapping[str, FormChoice]
    rated: dict[str, pd.DataFrame]
    hypotheses: dict[Axis, HypothesisTest]
    resampled: BootstrapResult | None
    ratio_intervals: dict[str, tuple[float, float]]
    r_squared_intervals: dict[str, tuple[float, float] | None]
    orthogonality: Orthogonality
    indscal: ConfirmatoryIndscal
    tasks: tuple[TaskIdentity, ...]
    metric: MetricCheck
    raters: dict[str, tuple[RaterConsistency, ...]]
    judges: tuple[Reliability, ...]


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
    # The gloss paper's forms, so that the weight can be held against its 1.78; others are tried beside them.
    fit = fit_gloss_space(
        study.stimuli, study.pairs, study.ratings, forms="paper", name="this study", provenance=_provenance(study, seed)
    )
    forms = fit_gloss_space(study.stimuli, study.pairs, study.ratings).forms
    coordinates = axis_coordinates(study.stimuli, list(study.pairs.stimuli))
    places = coordinates[["c", "d"]].to_numpy()
    rated = {axis: rated_along(study.stimuli, table) for axis, table in study.ratings.items()}
    on_step("The hypotheses for c and d, and ratings against the scale of the pairs")
    hypotheses = _test_hypotheses(study)
    tasks = compare_tasks(study.pairs, places, study.ratings, axes=("c", "d"), seed=seed, n_jobs=n_jobs)
    on_step("Reading of the axes")
    reading = _read_axes(study.pairs, plane, identity_plane, coordinates)
    on_step(f"How sure: {_REPLICATES} resamplings of the participants, each participant's own interval")
    resampled = _resampled(study.pairs, plane, seed=seed, n_jobs=n_jobs)
    intervals = ratio_intervals(study.pairs, places, axes=("c", "d"), seed=seed, n_jobs=n_jobs)
    on_step(f"Independence of the axes: {_PERMUTATIONS} permutations")
    orthogonality = check_orthogonality(
        study.pairs, places, axes=("c", "d"), n_permutations=_PERMUTATIONS, seed=seed, n_jobs=n_jobs
    )
    on_step(f"Weights of each participant against shared ones: {_WEIGHT_PERMUTATIONS} permutations")
    indscal = confirm_indscal(
        study.pairs, places, axes=("c", "d"), n_permutations=_WEIGHT_PERMUTATIONS, seed=seed, n_jobs=n_jobs
    )
    return StudyAnalysis(
        study=study,
        seed=seed,
        dimensionality=dimensionality,
        plane=plane,
        identity_plane=identity_plane,
        coordinates=coordinates,
        axes=reading,
        fit=fit,
        forms=forms,
        rated=rated,
        hypotheses=hypotheses,
        resampled=resampled,
        ratio_intervals=intervals,
        r_squared_intervals={
            axis: r_squared_interval(study.ratings[axis], table.set_index("stimulus")[axis])
            for axis, table in rated.items()
        },
        orthogonality=orthogonality,
        indscal=indscal,
        tasks=tasks,
        metric=check_metric(study.stimuli, study.pairs, fit.space, fit.confirmatory),
        raters={axis: rater_consistency(table) for axis, table in study.ratings.items()},
        judges=reliability(study.judgements),
    )


def _resampled(pairs: Dissimilarities, plane: MdsSolution, *, seed: int, n_jobs: int) -> BootstrapResult | None:
    if np.count_nonzero(plane.source_shares) < 2:
        return None
    return bootstrap(pairs, plane, n_replicates=_REPLICATES, seed=seed, n_jobs=n_jobs)


def _test_hypotheses(study: Study) -> dict[Axis, HypothesisTest]:
    found: dict[Axis, HypothesisTest] = {}
    for axis, hypotheses in HYPOTHESES.items():
        ratings = study.ratings[axis]
        judged = study.stimuli["stimulus"].isin({*study.pairs.stimuli, *ratings["stimulus"]})
        tested, skipped = with_values(hypotheses, study.stimuli[judged])
        if len(tested) > 1:
            compared = compare_hypotheses(tested, study.stimuli, ratings)
            confirmed = confirm_hypotheses(tested, study.stimuli, study.pairs)
            found[axis] = HypothesisTest(tuple(tested), skipped, compared, confirmed)
    return found


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
