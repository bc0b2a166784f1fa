"""How firmly the judgements fix a solution: bootstrap, jackknife, alignment."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import t as student_t

from gloss_analysis.judgements.dissimilarity import Dissimilarities, Trials
from gloss_analysis.mds import scale
from gloss_analysis.uncertainty.alignment import aligned
from gloss_analysis.uncertainty.bootstrap import bootstrap
from gloss_analysis.uncertainty.ellipses import ellipse
from gloss_analysis.uncertainty.jackknife import jackknife
from gloss_analysis.uncertainty.refitting import geometric_mean_ratio, refitted, weight_ratio
from glossspace.errors import GlossError
from tests.analysis.studies import RATIOS_OF_SIX, judged_by, named


@pytest.fixture(scope="module")
def resampled(noisy):
    return bootstrap(*noisy, n_replicates=200, n_jobs=2)


def repeated(noise_sd, *, n_repeats=4, seed=0, ratios=(1.0, 1.8)):
    """Judgements with trials behind them."""
    rounds = [judged_by(list(ratios), noise_sd=noise_sd, seed=seed + one) for one in range(n_repeats)]
    m, n_pairs = rounds[0].values.shape
    source, pair = (axis.ravel() for axis in np.indices((m, n_pairs)))
    value = np.concatenate([one.values.ravel() for one in rounds])
    trials = Trials(np.tile(source, n_repeats), np.tile(pair, n_repeats), value, np.ones(len(value)))
    return replace(rounds[0], values=np.mean([one.values for one in rounds], axis=0), trials=trials)


def test_participants_who_agree_without_noise_leave_no_uncertainty():
    data = judged_by([1.8, 1.8, 1.8, 1.8])
    found = bootstrap(data, scale(data, n_dims=2, level="ratio", model="identity", n_starts=5), n_replicates=30)
    # The solver ends within 1e-9 of its objective, so that points are known to about its root.
    assert max(one.semi_axes.max() for one in found.ellipses()) < 1e-3
    assert found.stress_interval()[1] < 1e-4


def test_ellipses_hold_95_per_cent_of_the_replicates(resampled):
    held = [one.contains(resampled.coordinates[:, i]).mean() for i, one in enumerate(resampled.ellipses())]
    # Ellipses of a normal law, of replicates from six participants, which are no normal law.
    assert np.mean(held) == pytest.approx(0.95, abs=0.03)


def test_an_ellipse_is_that_of_the_covariance():
    turn = np.array([[np.cos(0.5), np.sin(0.5)], [-np.sin(0.5), np.cos(0.5)]])
    drawn = np.random.default_rng(0).standard_normal((200000, 2)) * [3.0, 1.0] @ turn + [1.0, 2.0]
    found = ellipse("s", drawn)
    # 200,000 draws know standard deviations and means to .2 per cent, and the quantile of chi2(2) is -2 ln .05.
    assert found.semi_axes == pytest.approx(np.sqrt(-2 * np.log(0.05)) * np.array([3.0, 1.0]), rel=0.01)
    assert found.centre == pytest.approx([1.0, 2.0], abs=0.03)
    assert found.angle_deg == pytest.approx(np.degrees(0.5), abs=0.3)
    assert found.contains(drawn).mean() == pytest.approx(0.95, abs=0.003)
    point = ellipse("s", np.ones((3, 2)))
    assert point.contains(np.array([[1.0, 1.0], [1.0, 1.1]])).tolist() == [True, False]


def test_replicates_lie_about_the_solution(noisy, resampled):
    _, solution = noisy
    assert resampled.n_degenerate == 0
    assert resampled.coordinates.shape == (200, 27, 2)
    # A replicate that kept its dimensions in another order or sign would be about 1 away. The farthest are of draws of
    # participants who weight dimensions alike, so that the axes may turn.
    away = np.abs(resampled.coordinates - solution.coordinates).mean(axis=(1, 2))
    assert np.quantile(away, 0.95) < 0.2
    assert away.max() < 0.6
    intervals = resampled.coordinate_intervals()
    inside = (intervals[..., 0] <= solution.coordinates) & (solution.coordinates <= intervals[..., 1])
    assert inside.mean() > 0.9
    assert resampled.stress_interval()[0] < solution.stress1 < resampled.stress_interval()[1]


def test_weights_are_those_of_the_participants_drawn(resampled):
    absent = resampled.draws == 0
    assert np.array_equal(np.isnan(resampled.dimension_weights).all(axis=2), absent)
    assert np.array_equal(resampled.draws.sum(axis=1), np.full(200, 6))
    # The conventions of a solution, each participant counted as often as drawn.
    square = np.where(absent[..., np.newaxis], 0.0, resampled.dimension_weights) ** 2
    mean = np.einsum("bm,bmp->bp", resampled.draws, square) / 6
    assert mean == pytest.approx(np.ones((200, 2)), abs=1e-9)


def test_the_group_ratio_is_found_with_its_uncertainty(noisy, resampled):
    data, solution = noisy
    whole = geometric_mean_ratio(weight_ratio(solution.coordinates, solution.dimension_weights, 0, 1), np.ones(6))
    low, high = resampled.ratio_interval()
    assert low < whole < high
    # A spread of .53 in log ratio among six participants makes a standard error of .22, and the interval this wide.
    assert np.log(high / low) == pytest.approx(2 * 1.96 * np.std(np.log(RATIOS_OF_SIX)) / np.sqrt(6), rel=0.35)
    left = jackknife(data, solution).ratio_interval()
    # The t quantile of five degrees of freedom, 2.57, and the variance's correction make it longer.
    assert np.log(left[1] / left[0]) > np.log(high / low)
    assert left[0] < whole < left[1]


def test_replicates_are_as_good_as_a_full_search(noisy, resampled):
    data, _ = noisy
    for drawn, stress in zip(resampled.draws[:8], resampled.stress1, strict=False):
        rows = np.repeat(np.arange(6), drawn)
        again = scale(data.take(rows, [str(k) for k in range(6)]), n_dims=2, n_starts=20).stress1
        # Local minima round the solution differ in the fourth digit.
        assert stress == pytest.approx(again, abs=5e-4)


def test_the_same_seed_gives_the_same_for_any_number_of_threads(noisy):
    for function, settings in ((bootstrap, {"n_replicates": 6}), (jackknife, {})):
        one, two = (function(*noisy, **settings, seed=3, n_jobs=n_jobs) for n_jobs in (1, 2))
        assert np.array_equal(one.coordinates, two.coordinates)
        assert np.array_equal(one.dimension_weights, two.dimension_weights, equal_nan=True)
    assert not np.array_equal(
        bootstrap(*noisy, n_replicates=6, seed=3).stress1, bootstrap(*noisy, n_replicates=6, seed=4).stress1
    )


@pytest.mark.parametrize(
    ("model", "n_dims", "conditional"),
    [
        ("identity", 2, True), ("identity", 3, False), ("generalised", 2, True), ("weighted", 2, False),
        ("weighted", 1, True),
    ],
)  # fmt: skip
def test_every_model_is_resampled(noisy, model, n_dims, conditional):
    data, _ = noisy
    solution = scale(data, n_dims=n_dims, model=model, conditional=conditional, n_starts=20)
    told = []
    found = bootstrap(data, solution, n_replicates=20, on_step=lambda *at: told.append(at))
    assert told == [(one, 20) for one in range(1, 21)]
    # Noise of a tenth moves points by about a tenth of the configuration's size, which is 1; more in a third dimension
    # that nothing fixes.
    moved = np.abs(found.coordinates - solution.coordinates).mean()
    assert moved < (0.15 if n_dims < 3 else 0.4)
    assert jackknife(data, solution).influence.max() < 0.4


def test_redrawn_trials_vary_as_much_as_their_noise():
    extents = []
    for noise_sd in (2.0, 8.0):
        data = repeated(noise_sd)
        found = bootstrap(data, scale(data, n_dims=2, n_starts=5), n_replicates=40, resample="trials")
        extents.append(np.mean([one.semi_axes for one in found.ellipses()]))
        assert "shows about 87 % of the standard error" in found.warnings[0]  # sqrt(3 / 4)
        assert np.all(found.draws == 1)
    # Four times the noise, but order alone answers less than in proportion.
    assert extents[1] > 2 * extents[0]


@pytest.mark.parametrize("rule", ["mean", "weighted"])
def test_the_share_of_the_standard_error_that_is_told_is_that_of_a_sum_of_means(rule):
    """A third of the pairs judged four times, the others once; any linear estimate is a sum of the pairs' means.

    Of a mean of k trials of variance 1 the variance is 1 / k, and (k - 1) / k**2 over redrawings (Efron and Tibshirani
    1993, chapter 5). Weighted by their repeats, pairs add k**2 times as much.
    """
    one = judged_by([1.0, 1.8], noise_sd=5)
    n_pairs = one.values.shape[1]
    counts = np.where(np.arange(n_pairs) % 3 == 0, 4, 1)
    pair = np.tile(np.repeat(np.arange(n_pairs), counts), 2)
    source = np.repeat([0, 1], counts.sum())
    noise = np.random.default_rng(1).standard_normal(len(pair))
    trials = Trials(source, pair, one.values[source, pair] + 20 + noise, np.ones(len(pair)))
    values, weights = trials.summarised(2, n_pairs, rule)
    data = replace(one, values=values, pair_weights=weights if rule == "weighted" else None, trials=trials)
    found = bootstrap(data, scale(data, n_dims=2, n_starts=1), n_replicates=2, resample="trials")
    adds = np.where(counts == 4, 16, 1) if rule == "weighted" else np.ones(n_pairs)
    shown = np.sqrt(np.sum(adds * (counts - 1) / counts**2) / np.sum(adds / counts))
    assert found.warnings[0].startswith(f"Redrawing 2.0 judgements a pair shows about {100 * shown:.0f} % of")


def test_trials_are_redrawn_with_their_weights(monkeypatch):
    """Two trials a pair, 0 and 30 above a value, of weights 1 and 2: means of 0, 30, or 60 / 3 = 20 half the time."""
    given = []

    def spied(data, *rest):
        given.append(data)
        return refitted(data, *rest)

    monkeypatch.setattr("gloss_analysis.uncertainty.bootstrap.refitted", spied)
    one = judged_by([1.0, 1.8])
    source, pair = (axis.ravel() for axis in np.indices(one.values.shape))
    low = one.values.ravel()
    trials = Trials(
        np.tile(source, 2), np.tile(pair, 2), np.concatenate([low, low + 30]), np.repeat([1.0, 2.0], len(low))
    )
    values, weights = trials.summarised(*one.values.shape, "weighted")
    data = replace(one, values=values, pair_weights=weights, trials=trials)
    bootstrap(data, scale(data, n_dims=2, n_starts=1), n_replicates=4, resample="trials")
    raised = np.array([(drawn.values - one.values) / 10 for drawn in given])
    for value, weight, share in ((0, 2, 0.25), (2, 3, 0.5), (3, 4, 0.25)):
        here = np.abs(raised - value) < 1e-9
        # 2808 cells: four standard errors of a share of a half.
        assert here.mean() == pytest.approx(share, abs=4 * 0.5 / np.sqrt(raised.size))
        assert {*np.array([drawn.weights for drawn in given])[here]} == {weight}


def test_weights_have_intervals(resampled):
    low, high = np.moveaxis(resampled.weight_intervals(), -1, 0)
    one = resampled.dimension_weights[:, 2, 1]
    assert low[2, 1] == pytest.approx(np.quantile(one[~np.isnan(one)], 0.025))
    assert high[2, 1] == pytest.approx(np.quantile(one[~np.isnan(one)], 0.975))
    own = resampled.solution.dimension_weights
    # The interval is of the weights themselves: nearly all of the solution's own lie inside.
    assert np.mean((low <= own) & (own <= high)) > 0.8


def test_redrawn_trials_vary_as_much_as_new_ones():
    data = repeated(8.0)
    solution = scale(data, n_dims=2, n_starts=5)
    found = bootstrap(data, solution, n_replicates=60, resample="trials")
    new = []
    for seed in range(100, 400, 10):
        fresh = scale(repeated(8.0, seed=seed), n_dims=2, n_starts=3)
        new.append(aligned(fresh.coordinates, fresh.transforms, solution.coordinates, model="weighted")[0])
    shown, true = found.coordinates.std(axis=0).mean(), np.std(new, axis=0).mean()
    # Of four repeats .87 is expected; noise upon noise of the solution that is resampled adds to it.
    assert 0.7 < shown / true < 1.4


def test_trials_are_summarised_as_the_values_were():
    data = repeated(8.0, n_repeats=3)
    median, _ = data.trials.summarised(*data.values.shape, "median")
    solution = scale(data, n_dims=2, n_starts=3)
    of_median = scale(replace(data, values=median), n_dims=2, n_starts=3)
    by_median = bootstrap(replace(data, values=median), of_median, n_replicates=3, resample="trials")
    by_mean = bootstrap(data, solution, n_replicates=3, resample="trials")
    assert not np.array_equal(by_median.stress1, by_mean.stress1)
    raised = replace(data, values=data.values + 1)
    of_raised = scale(raised, n_dims=2, n_starts=3)
    with pytest.raises(GlossError, match="no means or medians of the trials"):
        bootstrap(raised, of_raised, n_replicates=3, resample="trials")


def test_participants_who_count_more_count_more_in_every_replicate(noisy):
    """Drawn twice with a weight of 4 is as good as being there twice with that weight."""
    data, _ = noisy
    own = replace(data, source_weights=np.array([1.0, 4.0, 1.0, 0.5, 2.0, 1.0]))
    counts = np.array([2, 1, 1, 2])
    rows = np.array([0, 1, 3, 4])
    repeated = own.take(np.repeat(rows, counts), list("abcdef"))
    full = scale(repeated, n_dims=2, level="ratio", n_starts=10)
    solution = scale(own, n_dims=2, level="ratio", n_starts=10)
    found = refitted(own.take(rows), counts, solution, rows, np.random.default_rng(0))
    # Searches end within 1e-9 of their objective.
    assert found.stress1 == pytest.approx(full.stress1, rel=1e-6)
    plain = refitted(data.take(rows), counts, solution, rows, np.random.default_rng(0))
    assert plain.stress1 != pytest.approx(full.stress1, rel=1e-3)


def test_who_judged_nothing_is_never_drawn(noisy):
    data, _ = noisy
    values = data.values.copy()
    values[1] = np.nan
    gap = replace(data, values=values)
    solution = scale(gap, n_dims=2, n_starts=5)
    found = bootstrap(gap, solution, n_replicates=10)
    assert np.all(found.draws[:, 1] == 0)
    assert np.all(found.draws.sum(axis=1) == 5)
    assert "p1" not in jackknife(gap, solution).participants


def test_degenerate_replicates_are_counted():
    data = judged_by([1.0, 2.0], noise_sd=5)
    found = bootstrap(data, scale(data, n_dims=2, n_starts=5), n_replicates=40)
    # Half of all draws of two from two hold one participant twice; 40 fair coins fall within 8 to 32.
    assert 8 <= found.n_degenerate <= 32
    assert len(found.stress1) == 40 - found.n_degenerate
    assert f"{found.n_degenerate} of 40 replicates were left out" in found.warnings[1]


def test_the_coverage_that_is_told_is_that_of_a_mean():
    found = bootstrap(
        *((data := judged_by([1.8] * 9)), scale(data, n_dims=1, model="identity", n_starts=1)), n_replicates=2
    )
    covered = 2 * student_t.cdf(1.96 * np.sqrt(8 / 9), 8) - 1
    assert covered == pytest.approx(0.90, abs=0.005)
    assert "9 participants covers about 90 %" in found.warnings[0]


def test_ratios_of_one_dimension_alone_are_limited():
    weights = np.array([[0.0, 1.0], [1.0, 0.0], [0.0, 0.0], [np.nan, np.nan], [1.0, 2.0]])
    ratio = weight_ratio(np.array([[1.0, 1.0], [-1.0, -1.0]]), weights, 0, 1)
    assert ratio == pytest.approx([1000, 0.001, np.nan, np.nan, 2], nan_ok=True)
    assert geometric_mean_ratio(ratio, np.array([1, 1, 1, 0, 2])) == pytest.approx(4**0.25)


def test_wrong_questions_are_refused(noisy):
    data, solution = noisy
    with pytest.raises(GlossError, match="Allowed: 'observers', 'trials'"):
        bootstrap(data, solution, resample="pairs")
    with pytest.raises(GlossError, match="No participant judged a pair twice"):
        bootstrap(data, solution, resample="trials")
    with pytest.raises(GlossError, match="Allowed: 2 or more"):
        bootstrap(data, solution, n_replicates=1)
    with pytest.raises(GlossError, match="not those of the data"):
        bootstrap(data.take([0, 1, 2]), solution)
    alone = judged_by([1.8])
    of_one = scale(alone, n_dims=2, n_starts=2)
    with pytest.raises(GlossError, match="too few to draw from"):
        bootstrap(alone, of_one)
    with pytest.raises(GlossError, match="too few to leave one out"):
        jackknife(alone, of_one)
    shared = scale(data, n_dims=2, model="generalised", conditional=False, n_starts=1)
    with pytest.raises(GlossError, match="cannot be aligned"):
        jackknife(data, shared)
    same = bootstrap(data, scale(data, n_dims=2, model="identity", n_starts=2), n_replicates=2)
    with pytest.raises(GlossError, match="no weights of dimensions"):
        same.ratio_interval()
    with pytest.raises(GlossError, match="from 0 to 1"):
        same.ellipses(0, 2)
    with pytest.raises(GlossError, match="above 0 and below 1"):
        same.stress_interval(level=95)
    line = bootstrap(data, scale(data, n_dims=1, n_starts=2), n_replicates=2)
    with pytest.raises(GlossError, match="one dimension only"):
        line.ellipses()


def test_replicates_that_determine_nothing_are_refused():
    # Each participant judged one half of a chain: only both together link the stimuli.
    values = np.full((2, 6), np.nan)
    values[0, [0, 3]] = [1.0, 2.0]
    values[1, [3, 5]] = [2.0, 1.0]
    data = named(values, 4)
    solution = scale(data, n_dims=1, n_starts=2)
    lonely = Dissimilarities(data.stimuli, data.participants, data.values, source_weights=np.array([1.0, 1.0]))
    found = bootstrap(lonely, solution, n_replicates=20)
    assert 0 < found.n_degenerate < 20
