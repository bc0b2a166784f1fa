"""What a solution tells: fit measures against their definitions, and files that come back."""

import json
from pathlib import Path

import numpy as np
import pytest
from sklearn.base import clone

from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.judgements.square_matrix import from_matrices
from gloss_analysis.mds import load_solution, scale
from gloss_analysis.mds.estimator import ThreeWayMDS
from glossspace.errors import GlossError
from tests.analysis.studies import judged_by, named

REFERENCE = Path(__file__).parents[2] / "reference"


@pytest.fixture(scope="module")
def solution():
    values = judged_by([1.0, 1.8, 2.6], noise_sd=8, integers=True).values[:, :45].copy()
    values[1, [3, 8]] = np.nan
    return scale(named(values, 10), n_dims=2, model="identity")


def test_fit_measures_follow_their_definitions(solution):
    s1, s2 = [], []
    for d, fitted in zip(solution.distances, solution.disparities, strict=True):
        seen = ~np.isnan(fitted)
        residual = np.sum((d[seen] - fitted[seen]) ** 2)
        s1.append(residual / np.sum(d[seen] ** 2))
        s2.append(residual / np.sum((d[seen] - d[seen].mean()) ** 2))
    assert solution.source_stress1**2 == pytest.approx(np.array(s1), rel=1e-9)
    assert solution.stress1**2 == pytest.approx(np.mean(s1), rel=1e-9)
    assert solution.source_stress2**2 == pytest.approx(np.array(s2), rel=1e-9)
    assert solution.stress2**2 == pytest.approx(np.mean(s2), rel=1e-9)
    assert solution.normalized_raw_stress == pytest.approx(np.mean(s1), rel=1e-9)
    assert solution.dispersion_accounted_for == pytest.approx(1 - np.mean(s1), rel=1e-9)
    assert solution.tucker_phi == pytest.approx(np.sqrt(1 - np.mean(s1)), rel=1e-9)


def test_proxscals_value_has_one_common_scale():
    # Complete data: with disparities of equal norm and one scale t of the common distances, its minimum over t is what
    # a grid finds.
    solution = scale(named(judged_by([1.0, 3.0], noise_sd=8).values[:, :45], 10), n_dims=2, model="identity")
    fitted = solution.disparities / np.linalg.norm(solution.disparities, axis=1, keepdims=True)
    d = solution.distances / np.linalg.norm(solution.distances, axis=1, keepdims=True)
    losses = [np.mean(np.sum((fitted - t * d) ** 2, axis=1)) for t in np.linspace(0, 1, 200001)]
    # The grid's step of 5e-6 leaves 1e-11.
    assert solution.proxscal_normalized_raw_stress == pytest.approx(min(losses), abs=1e-9)
    assert solution.proxscal_normalized_raw_stress >= solution.normalized_raw_stress
    weighted = scale(named(judged_by([1.0, 3.0], noise_sd=8).values[:, :45], 10), n_dims=2)
    assert weighted.proxscal_normalized_raw_stress == pytest.approx(weighted.normalized_raw_stress, rel=1e-12)


def test_parts_of_stress_add_up(solution):
    assert solution.stress_per_pair.sum() == pytest.approx(1)
    assert solution.stress_per_point.sum() == pytest.approx(1)
    assert solution.stress_per_source.sum() == pytest.approx(1)
    assert solution.stress_per_source == pytest.approx(solution.source_stress1**2 / np.sum(solution.source_stress1**2))
    first, second = np.triu_indices(10, 1)
    expected = [np.sum(solution.stress_per_pair[(first == i) | (second == i)]) / 2 for i in range(10)]
    assert solution.stress_per_point == pytest.approx(expected)


def test_shepard_data_hold_every_judgement(solution):
    table = solution.shepard_table()
    assert len(table) == 3 * 45 - 2
    for _, rows in table.groupby("participant_id"):
        # Ordinal: disparities never fall as judgements rise.
        ordered = rows.groupby("dissimilarity")["disparity"].agg(["min", "max"])
        assert np.all(ordered["max"].to_numpy()[:-1] <= ordered["min"].to_numpy()[1:] + 1e-12)


def test_a_saved_solution_comes_back(solution, tmp_path):
    solution.save(tmp_path / "solution.json")
    loaded = load_solution(tmp_path / "solution.json")
    for name in ("coordinates", "transforms", "distances", "disparities", "dissimilarities", "source_stress1"):
        assert np.array_equal(getattr(loaded, name), getattr(solution, name), equal_nan=True)
    assert (loaded.stimuli, loaded.warnings, loaded.search) == (solution.stimuli, solution.warnings, solution.search)
    assert loaded.stress2 == solution.stress2


def test_files_that_are_no_solutions_are_refused(solution, tmp_path):
    path = tmp_path / "solution.json"
    path.write_text("{}")
    with pytest.raises(GlossError, match="holds no scaling solution"):
        load_solution(path)
    solution.save(path)
    content = json.loads(path.read_text())
    path.write_text(json.dumps(content | {"version": 99}))
    with pytest.raises(GlossError, match="has version 99"):
        load_solution(path)
    path.write_text(json.dumps(content | {"coordinates": "none"}))
    with pytest.raises(GlossError, match="'coordinates' is no table of numbers"):
        load_solution(path)
    del content["coordinates"]
    path.write_text(json.dumps(content))
    with pytest.raises(GlossError, match="lacks 'coordinates'"):
        load_solution(path)


def test_the_estimator_keeps_scikit_learns_customs():
    square = np.zeros((10, 10))
    square[np.triu_indices(10, 1)] = np.random.default_rng(0).uniform(1, 2, 45)
    square += square.T
    estimator = ThreeWayMDS(n_components=3, level="interval", random_state=4)
    assert clone(estimator).get_params() == estimator.get_params()
    embedding = clone(estimator).set_params(n_init=20).fit_transform(square)
    assert embedding.shape == (10, 3)
    fitted = estimator.set_params(n_init=20).fit(np.array([square, square]))
    assert np.array_equal(fitted.embedding_, fitted.solution_.coordinates)
    assert fitted.dimension_weights_.shape == (2, 3)
    alone = scale(from_matrices(square), n_dims=3, level="interval", n_starts=20, seed=4)
    assert fitted.stress_ == pytest.approx(alone.stress1, rel=1e-6)
    with pytest.raises(GlossError, match="not symmetric"):
        estimator.fit(np.arange(9.0).reshape(3, 3))


def gappy(conditional, model="identity"):
    rng = np.random.default_rng(3)
    values = rng.uniform(1, 9, (3, 28))
    values[0, rng.uniform(size=28) < 0.4] = np.nan
    weights = rng.uniform(0.2, 3, (3, 28))
    data = Dissimilarities(tuple("abcdefgh"), tuple("123"), values, weights, np.array([1.0, 2.0, 0.5]))
    return data, scale(data, n_dims=2, model=model, conditional=conditional, level="interval")


def test_proxscals_value_with_gaps_and_weights_follows_its_definition():
    data, solution = gappy(conditional=True)
    weights = np.where(data.judged, data.weights / data.weights.max(), 0)
    share = data.source_weights / data.source_weights.sum()
    fitted = np.where(data.judged, solution.disparities, 0)
    norm = np.sqrt(np.sum(weights, axis=1) / np.sum(weights * fitted**2, axis=1))
    fitted = fitted * norm[:, np.newaxis]
    whole = share @ np.sum(weights * fitted**2, axis=1)
    losses = [
        share @ np.sum(weights * (fitted - t * solution.distances) ** 2, axis=1) / whole
        for t in np.linspace(0, 3, 30001)
    ]
    # The grid's step of 1e-4 leaves about 1e-8.
    assert solution.proxscal_normalized_raw_stress == pytest.approx(min(losses), abs=1e-7)


def test_parts_of_the_stress_of_one_scale_follow_their_definition():
    data, solution = gappy(conditional=False, model="weighted")
    weights = np.where(data.judged, data.weights * data.source_weights[:, np.newaxis], 0)
    fitted = np.where(data.judged, solution.disparities, 0)
    squares = weights * np.where(data.judged, solution.distances - fitted, 0) ** 2
    assert solution.stress_per_source == pytest.approx(squares.sum(axis=1) / squares.sum(), rel=1e-9)
    assert solution.stress_per_pair == pytest.approx(squares.sum(axis=0) / squares.sum(), rel=1e-9)
    assert solution.stress1**2 == pytest.approx(squares.sum() / np.sum(weights * solution.distances**2), rel=1e-9)
    mean = np.sum(weights * solution.distances) / weights.sum()
    spread = np.sum(weights * (solution.distances - mean) ** 2)
    assert solution.stress2**2 == pytest.approx(squares.sum() / spread, rel=1e-9)


# Lowest stress that an independent program found (its own objective, gradient and spline basis, SciPy's L-BFGS from
# hundreds of starts, perturbation and exchange); the data are in tests/reference.
BEST_KNOWN = [
    ("ekman", "ordinal", 2, 0.023102506),
    ("ekman", "ratio", 2, 0.131199264),
    ("ekman", "ordinal", 1, 0.256381465),
    ("morse", "interval", 2, 0.279270570),
    ("rectangles", "ordinal", 2, 0.088784406),
]


@pytest.mark.parametrize(("name", "level", "n_dims", "best"), BEST_KNOWN)
def test_stress_of_published_data_is_the_best_known(name, level, n_dims, best):
    values = np.loadtxt(REFERENCE / f"{name}.csv", delimiter=",", ndmin=2)
    data = named(values, round((1 + np.sqrt(1 + 8 * values.shape[1])) / 2))
    # Nine digits are printed.
    assert scale(data, n_dims=n_dims, level=level).stress1 == pytest.approx(best, abs=1e-9)
