"""How many dimensions the judgements have: known answers, and that nothing is found where nothing is."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import rankdata, spearmanr
from sklearn.manifold import MDS

from gloss_analysis.dimensionality.held_out import HeldOut, _spearman, cross_validated_stress
from gloss_analysis.dimensionality.null_stress import permuted_stress, random_stress
from gloss_analysis.dimensionality.study import recommend_dimensions, study_dimensionality
from gloss_analysis.mds import scale
from glossspace.errors import GlossError
from tests.analysis.studies import judged_by, named

QUICK = {"dims": (1, 2, 3), "n_starts": 5, "n_replicates": 19, "n_jobs": 2}


def noise(n, m, seed):
    return named(np.random.default_rng(seed).uniform(size=(m, n * (n - 1) // 2)), n)


@pytest.fixture(scope="module")
def two_dimensional():
    return study_dimensionality(judged_by([1.2, 3.0], noise_sd=8, integers=True), **QUICK)


def test_two_dimensions_are_recommended_for_judgements_of_two(two_dimensional):
    recommended = two_dimensional.recommendation
    assert recommended.n_dims == 2
    assert recommended.agreed
    # 1 / 20 is the smallest p of 19 replicates.
    assert recommended.p_structure == pytest.approx(0.05)
    assert "2 dimensions recommended" in recommended.reasons[0]


def test_stress_of_permuted_judgements_is_far_above_that_of_the_data(two_dimensional):
    # Noise of 8 on a scale of 100 leaves a third of the stress that judgements without structure have.
    assert two_dimensional.permuted[:, 1].min() > 2 * two_dimensional.stress1[1]
    assert two_dimensional.random.shape == two_dimensional.permuted.shape == (19, 3)


@pytest.mark.parametrize("noise_sd", [0.0, 20.0])
def test_one_dimension_is_recommended_for_judgements_of_one(noise_sd):
    # A ratio of 0 leaves the first axis alone.
    study = study_dimensionality(judged_by([0.0], noise_sd=noise_sd), **QUICK)
    assert study.recommendation.n_dims == 1


def test_two_dimensions_are_recommended_in_strong_noise():
    # Stress of judgements left out goes on falling here with every dimension: it must not decide.
    study = study_dimensionality(judged_by([1.5, 2.5], noise_sd=20), **QUICK)
    assert np.all(np.diff(study.held_out.mean_stress1) < 0)
    assert study.recommendation.n_dims == 2


def test_nothing_is_recommended_for_noise():
    # Two tests would have to err together, each at 5 %: among three draws that is improbable.
    found = [study_dimensionality(noise(10, 2, seed), **QUICK).recommendation for seed in range(3)]
    assert [one.n_dims for one in found] == [None] * 3
    assert "cannot be told from permuted ones" in found[0].reasons[0]
    assert min(one.p_overall for one in found) >= 0.05


def test_the_test_of_structure_holds_its_level():
    # Of 40 draws of noise, 2 should be called structured at 5 %; more than 7 have a probability of .1 %.
    rows = [random_stress(noise(8, 1, 0), dims=(2,), n_replicates=20, seed=seed)[:, 0] for seed in range(40)]
    hits = sum(row[0] < row[1:].min() for row in rows)
    assert hits <= 7


@pytest.mark.parametrize(("n", "p"), [(10, 2), (12, 2), (12, 3), (20, 2), (20, 3)])
def test_random_stress_is_that_of_published_simulations(n, p):
    # Spence (1979): a formula for the mean of Stress-1 of random rankings in units of .001. Its error is some .01, and
    # it was fitted to simulations with one start, whose minima are a little too high.
    published = (-524.25 + 33.80 * p - 2.54 * n - 307.26 * np.log(p) + 588.35 * np.sqrt(np.log(n))) / 1000
    mean = random_stress(noise(n, 1, 0), dims=(p,), model="identity", n_replicates=20).mean()
    assert published - 0.04 < mean < published + 0.01


def test_random_stress_is_that_of_an_independent_program():
    n, rng = 10, np.random.default_rng(0)
    theirs = []
    for _ in range(6):
        square = np.zeros((n, n))
        square[np.triu_indices(n, 1)] = rng.permutation(n * (n - 1) // 2) + 1.0
        program = MDS(
            n_components=2, metric_mds=False, metric="precomputed", normalized_stress=True, n_init=8, max_iter=1000,
            eps=1e-8, random_state=1, init="random",
        )  # fmt: skip
        theirs.append(program.fit(square + square.T).stress_)
    ours = random_stress(noise(n, 1, 0), dims=(2,), model="identity", n_replicates=40, n_starts=20)[:, 0]
    # Four standard errors of the difference of two means.
    error = np.sqrt(np.var(theirs, ddof=1) / 6 + np.var(ours, ddof=1) / 40)
    assert np.mean(theirs) == pytest.approx(ours.mean(), abs=4 * error)


def test_random_and_permuted_judgements_keep_the_design():
    data = judged_by([1.0, 2.0], noise_sd=5, integers=True)
    values = data.values.copy()
    values[0, ::3] = np.nan
    gaps = replace(data, values=values)
    few = {"dims": (2,), "n_replicates": 2}
    # Gaps leave less to contradict, ties that may be untied too: stress falls with both.
    assert random_stress(gaps, **few).mean() < random_stress(data, **few).mean()
    assert permuted_stress(data, **few).mean() < random_stress(data, **few).mean()


def test_every_step_is_told():
    told = []
    study_dimensionality(noise(6, 1, 0), dims=(1, 2), n_starts=1, n_replicates=19, on_step=lambda *at: told.append(at))
    assert told == [(done, told[0][1]) for done in range(1, told[0][1] + 1)]


def test_results_do_not_depend_on_the_number_of_threads():
    data = judged_by([1.0, 2.0], noise_sd=10)
    few = {"dims": (1, 2), "n_starts": 2}
    one, two = (cross_validated_stress(data, **few, n_jobs=n_jobs) for n_jobs in (1, 2))
    assert np.array_equal(one.stress1, two.stress1)
    assert np.array_equal(one.rank_correlation, two.rank_correlation)
    for function in (random_stress, permuted_stress):
        one, two = (function(data, **few, n_replicates=3, n_jobs=n_jobs) for n_jobs in (1, 2))
        assert np.array_equal(one, two)


@pytest.mark.parametrize("level", ["ratio", "interval", "spline", "ordinal"])
@pytest.mark.parametrize("conditional", [True, False])
def test_exact_judgements_left_out_are_predicted(level, conditional):
    found = cross_validated_stress(
        judged_by([1.0, 2.0]), dims=(2,), level=level, conditional=conditional, n_folds=3, n_starts=3
    )
    # Linear levels predict up to the solver's accuracy; a curve through two thirds of the order leaves some room.
    assert found.mean_stress1[0] < (1e-4 if level in ("ratio", "interval") else 0.02)
    assert found.mean_rank_correlation[0] > 0.999


def test_judgements_left_out_are_followed_a_little_less_well_than_those_fitted():
    data = judged_by([1.5], noise_sd=10)
    found = cross_validated_stress(data, dims=(2,), model="identity", level="ratio", n_folds=2, n_starts=3)
    assert found.stress1.shape == (2, 1)
    # Judgements left out are followed less well than those fitted, but not by much with 175 judgements for 27 points.
    fitted = scale(data, n_dims=2, model="identity", level="ratio", n_starts=3).stress1
    assert np.all(found.stress1 > fitted)
    assert np.all(found.stress1 < 2 * fitted)


def test_folds_that_leave_no_link_are_told():
    # Along a chain every judgement is the only link of its two halves.
    values = np.full((1, 10), np.nan)
    values[0, [0, 4, 7, 9]] = [1.0, 2.0, 3.0, 4.0]
    found = cross_validated_stress(named(values, 5), dims=(1,), n_folds=4)
    assert np.isnan(found.stress1).all()
    assert np.isnan(found.mean_stress1).all()
    assert len(found.warnings) == 4
    assert "Fold 1 of 4 could not be fitted: No judged pair links" in found.warnings[0]
    undecided = recommend_dimensions((1,), np.array([0.1]), np.full((19, 1), 0.5), found)
    assert undecided.n_dims == 1
    assert "Prediction decides nothing" in undecided.reasons[2]


def held_out(dims, correlation, spread=0.01):
    rows = np.array(correlation) + spread * np.array([[-1.0], [0.0], [1.0]])
    return HeldOut(dims, np.zeros_like(rows), rows, ())


def test_disagreement_is_told():
    dims, permuted = (1, 2, 3), np.tile([0.5, 0.4, 0.3], (19, 1))
    # The fall from 2 to 3 is steeper than the permuted .1, but prediction is worse there.
    split = recommend_dimensions(dims, np.array([0.3, 0.25, 0.05]), permuted, held_out(dims, [0.5, 0.9, 0.7]))
    assert (split.n_dims, split.agreed) == (2, False)
    assert "no number meets all criteria" in split.reasons[0]
    # Here the fall of stress asks for fewer than prediction does.
    mild = recommend_dimensions(dims, np.array([0.2, 0.15, 0.12]), permuted, held_out(dims, [0.5, 0.9, 0.7]))
    assert (mild.n_dims, mild.agreed) == (2, True)
    assert any("prediction asks for 2, the fall of stress for 1" in reason for reason in mild.reasons)


def test_what_does_not_belong_together_is_refused():
    permuted = np.full((19, 2), 0.5)
    with pytest.raises(GlossError, match="do not belong together"):
        recommend_dimensions((1, 2, 3), np.zeros(3), permuted, held_out((1, 2), [0.1, 0.2]))
    with pytest.raises(GlossError, match="Allowed: 19 or more"):
        recommend_dimensions((1, 2), np.zeros(2), permuted[:5], held_out((1, 2), [0.1, 0.2]))
    with pytest.raises(GlossError, match="Allowed: 19 or more"):
        study_dimensionality(noise(6, 1, 0), n_replicates=5)
    with pytest.raises(GlossError, match="Allowed: 2 or more"):
        cross_validated_stress(noise(6, 1, 0), n_folds=1)
    with pytest.raises(GlossError, match="Allowed: 1 or more"):
        random_stress(noise(6, 1, 0), n_replicates=0)
    with pytest.raises(GlossError, match="Allowed: 1 to 5 for 6 stimuli"):
        permuted_stress(noise(6, 1, 0), dims=(6, 7))


def test_rank_correlation_is_spearmans():
    rng = np.random.default_rng(0)
    a, b = rankdata(rng.integers(0, 5, 30)), rng.uniform(size=30)
    assert _spearman(a, b) == pytest.approx(spearmanr(a, b).statistic, abs=1e-12)
    assert np.isnan(_spearman(np.ones(3), np.arange(3.0)))
