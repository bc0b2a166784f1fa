"""Models, conditionality, weights and restrictions: known answers, nesting, equivalences."""

import numpy as np
import pytest
from scipy.spatial import procrustes
from scipy.spatial.distance import pdist

from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds import external_variables, fixed_stimuli, scale
from gloss_analysis.mds.objective import source_distances
from glossspace.errors import GlossError
from tests.analysis.studies import judged_by, named

LEVELS = ["ratio", "interval", "spline", "ordinal"]


def seen_through(matrices, n=12, seed=0):
    """Distances of random points as each source sees them."""
    z = np.random.default_rng(seed).standard_normal((n, 2))
    return z, named([pdist(z @ c) for c in matrices], n)


def test_turned_weights_need_the_generalised_model():
    turn = np.array([[np.cos(0.6), -np.sin(0.6)], [np.sin(0.6), np.cos(0.6)]])
    matrices = [np.diag([1.0, 2.0]), np.diag([2.0, 1.0]), turn @ np.diag([2.5, 1.0]), np.array([[1.0, 0.8], [0, 1]])]
    z, data = seen_through(matrices)
    weighted = scale(data, n_dims=2, level="ratio")
    generalised = scale(data, n_dims=2, level="ratio", model="generalised")
    assert weighted.stress1 > 0.02  # no choice of axes serves all four
    assert generalised.stress1 < 1e-6  # an exact fit exists; squared stress ends at rounding
    for k, c in enumerate(matrices):
        own = generalised.coordinates @ generalised.transforms[k]
        # Each source's own space is found, up to position, rotation and size.
        assert procrustes(z @ c, own)[2] < 1e-9


def test_conventions_of_a_generalised_solution():
    solution = scale(judged_by([1.0, 2.0, 3.0], noise_sd=4), n_dims=2, model="generalised")
    z, c = solution.coordinates, solution.transforms
    assert z.mean(axis=0) == pytest.approx([0, 0], abs=1e-12)
    assert c == pytest.approx(np.swapaxes(c, 1, 2), abs=1e-12)
    assert np.mean(c @ np.swapaxes(c, 1, 2), axis=0) == pytest.approx(np.eye(2), abs=1e-9)
    spread = z.T @ z / len(z)
    assert spread[0, 1] == pytest.approx(0, abs=1e-9)
    assert spread[0, 0] >= spread[1, 1]
    own = np.array([np.sum(np.mean((z @ one) ** 2, axis=0)) for one in c])
    assert own == pytest.approx(np.ones(3), rel=1e-9)
    assert solution.dimension_weights == pytest.approx(np.linalg.norm(c, axis=2), rel=1e-12)
    assert solution.distances == pytest.approx(source_distances(z, c), rel=1e-12)


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("n_dims", [2, 3])
def test_a_richer_model_and_a_freer_level_fit_no_worse(level, n_dims):
    data = judged_by([0.8, 1.8, 3.2], noise_sd=8, integers=True, seed=3)
    data = Dissimilarities(data.stimuli[:10], data.participants, data.values[:, np.max(data.pairs, axis=0) < 10])
    stress = [scale(data, n_dims=n_dims, model=model, level=level).stress1 for model in
              ("identity", "weighted", "generalised")]  # fmt: skip
    assert stress[1] <= stress[0] * (1 + 1e-6)  # the solver's tolerance
    assert stress[2] <= stress[1] * (1 + 1e-6)
    freer = LEVELS[LEVELS.index(level) :]
    assert scale(data, n_dims=n_dims, level=freer[-1]).stress1 <= stress[1] * (1 + 1e-6)


def test_unconditional_analysis_compares_judgements_between_participants():
    # The same line seen at two sizes: judged on one scale, the second participant's judgements are twice the first's.
    rng = np.random.default_rng(5)
    z = rng.standard_normal((8, 2))
    data = named([pdist(z), 2 * pdist(z)], 8)
    solution = scale(data, n_dims=2, level="ratio", conditional=False)
    assert solution.stress1 < 1e-6
    size = np.linalg.norm(solution.distances, axis=1)
    assert size[1] / size[0] == pytest.approx(2, rel=1e-6)
    # Without weights nothing can carry the size: half of it is missed. With d the same for both and disparities b and
    # 2 b times d, f = 1 - (1 + 2)^2 / (2 (1 + 4)) = 1/10.
    alike = scale(data, n_dims=2, level="ratio", conditional=False, model="identity")
    assert alike.stress1**2 == pytest.approx(0.1, rel=1e-6)
    assert scale(data, n_dims=2, level="ratio", model="identity").stress1 < 1e-6


def test_one_participant_makes_all_models_alike():
    data = named(np.random.default_rng(3).uniform(1, 9, 45), 10)
    solutions = [scale(data, n_dims=2, model=model) for model in ("identity", "weighted", "generalised")]
    for solution in solutions[1:]:
        assert solution.stress1 == pytest.approx(solutions[0].stress1, rel=1e-9)
        assert solution.dimension_weights == pytest.approx(np.ones((1, 2)))


def test_a_source_of_weight_two_counts_like_two():
    values = np.random.default_rng(1).integers(1, 30, size=(2, 28)).astype(float)
    names, participants = tuple("abcdefgh"), ("1", "2")
    double = Dissimilarities(names, participants, values, source_weights=np.array([2.0, 1.0]))
    twice = named(values[[0, 0, 1]], 8)
    assert scale(double, n_dims=2).stress1 == pytest.approx(scale(twice, n_dims=2).stress1, rel=1e-6)
    without = Dissimilarities(names, participants, values, source_weights=np.array([0.0, 1.0]))
    alone = scale(named(values[1], 8), n_dims=2)
    assert scale(without, n_dims=2).stress1 == pytest.approx(alone.stress1, rel=1e-6)


def test_weights_over_six_decades_choose_the_pairs_that_fit():
    # One pair is wrong. With weight 1e-6 it costs next to nothing, and the points come back.
    z = np.random.default_rng(2).standard_normal((8, 2))
    values = pdist(z)
    values[3] *= 5
    weights = np.where(np.arange(28) == 3, 1e-6, 1.0)
    data = Dissimilarities(tuple("abcdefgh"), ("1",), values[np.newaxis], pair_weights=weights[np.newaxis])
    solution = scale(data, n_dims=2, level="ratio")
    assert procrustes(z, solution.coordinates)[2] < 1e-9
    unweighted = scale(named(values, 8), n_dims=2, level="ratio")
    assert procrustes(z, unweighted.coordinates)[2] > 1e-3


def test_pairs_of_weight_zero_count_as_not_judged():
    values = np.random.default_rng(4).uniform(1, 9, 28)
    dropped = np.isin(np.arange(28), [3, 9, 20])
    weights = np.where(dropped, 0.0, 1.0)
    weighted = Dissimilarities(tuple("abcdefgh"), ("1",), values[np.newaxis], pair_weights=weights[np.newaxis])
    gaps = named(np.where(dropped, np.nan, values), 8)
    one, other = scale(weighted, n_dims=2), scale(gaps, n_dims=2)
    assert one.stress1 == other.stress1
    assert np.isnan(one.disparities[0, dropped]).all()


def test_fixed_stimuli_stay_and_the_others_find_their_places():
    z = np.random.default_rng(7).standard_normal((9, 2)) * [3.0, 1.0] + 10
    known = z.copy()
    known[5:] = np.nan
    for model in ("identity", "weighted"):
        solution = scale(named(pdist(z), 9), n_dims=2, level="ratio", model=model, restriction=fixed_stimuli(known))
        assert np.array_equal(solution.coordinates[:5], z[:5])
        # An exact fit exists; squared stress ends near 1e-12, and coordinates are known to its root.
        assert solution.coordinates == pytest.approx(z, abs=1e-4)
        assert solution.stress1 < 1e-5
    all_fixed = scale(judged_by([1.0, 2.0]), n_dims=2, restriction=fixed_stimuli(_c_and_d()), model="weighted")
    assert np.array_equal(all_fixed.coordinates, _c_and_d())
    ratio = all_fixed.dimension_weights[:, 1] / all_fixed.dimension_weights[:, 0]
    # Judged without noise along these axes with ratios 1 and 2; order fixes them to a per cent or so.
    assert ratio == pytest.approx([1.0, 2.0], rel=0.02)


def _c_and_d():
    from tests.analysis.studies import axis_values

    return axis_values()


def test_external_variables_restrict_the_coordinates():
    rng = np.random.default_rng(8)
    variables = rng.standard_normal((12, 3))
    z = variables @ np.array([[1.0, 0.2], [0.0, 1.5], [0.0, 0.0]])
    solution = scale(named(pdist(z), 12), n_dims=2, level="ratio", restriction=external_variables(variables))
    assert solution.stress1 < 1e-6
    assert procrustes(z, solution.coordinates)[2] < 1e-9
    # The solution is a linear function of the variables, whatever the data.
    noise = scale(named(rng.uniform(1, 2, 66), 12), n_dims=2, restriction=external_variables(variables))
    centred = variables - variables.mean(axis=0)
    fitted = centred @ np.linalg.lstsq(centred, noise.coordinates)[0]
    assert fitted == pytest.approx(noise.coordinates, abs=1e-9)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: fixed_stimuli(np.array([[0.0, np.nan], [1.0, 1.0]])), "Give finite numbers for all dimensions"),
        (lambda: fixed_stimuli(np.array([[0.0, np.inf], [1.0, 1.0]])), "Give finite numbers for all dimensions"),
        (lambda: external_variables(np.array([1.0, np.nan, 2.0])), "must be finite and differ"),
        (lambda: external_variables(np.ones((4, 2))), "must be finite and differ"),
    ],
)
def test_impossible_restrictions_are_refused(make, message):
    with pytest.raises(GlossError, match=message):
        make()


def test_restrictions_that_do_not_fit_the_data_are_refused():
    data = named(np.arange(1.0, 11.0), 5)
    with pytest.raises(GlossError, match=r"Fixed coordinates of shape \(4, 2\) do not fit 5 stimuli in 2 dimensions"):
        scale(data, n_dims=2, restriction=fixed_stimuli(np.zeros((4, 2))))
    with pytest.raises(GlossError, match="1 external variables span 1 dimensions, too few for 2"):
        scale(data, n_dims=2, restriction=external_variables(np.arange(5.0)))
    with pytest.raises(GlossError, match="External variables for 4 stimuli do not fit 5"):
        scale(data, n_dims=2, restriction=external_variables(np.random.default_rng(0).standard_normal((4, 2))))


REFERENCE_RECTANGLES = np.column_stack([np.repeat([3, 4.25, 5.5, 6.75], 4), np.tile([0.5, 1.25, 2, 2.75], 4)])
"""Width and height of sixteen rectangles, as in Borg and Leutner's (1983) study."""


@pytest.mark.parametrize("model", ["identity", "weighted", "generalised"])
@pytest.mark.parametrize("conditional", [True, False])
@pytest.mark.parametrize("offset", [0.0, 50.0])
def test_fixed_stimuli_stay_where_they_are_in_every_analysis(model, conditional, offset):
    rng = np.random.default_rng(11)
    data = named(rng.uniform(1, 9, (3, 28)), 8)
    known = rng.standard_normal((8, 2)) + offset
    known[4:] = np.nan
    assumed = {"n_dims": 2, "model": model, "conditional": conditional, "level": "interval"}
    solution = scale(data, **assumed, restriction=fixed_stimuli(known))
    assert np.array_equal(solution.coordinates[:4], known[:4])
    assert np.all(np.abs(solution.coordinates - offset) < 100)  # the free ones do not run away
    assert solution.restricted
    # Where the whole stands changes nothing.
    moved = scale(data, **assumed, restriction=fixed_stimuli(known - offset))
    assert moved.stress1 == pytest.approx(solution.stress1, rel=1e-6)
    assert moved.dimension_weights == pytest.approx(solution.dimension_weights, rel=1e-3)


def test_one_participant_may_weight_the_dimensions_of_fixed_stimuli():
    # Held in place, points have a shape; judged with the second dimension three times as wide.
    z = REFERENCE_RECTANGLES[:, [0, 1]]
    data = named(pdist(z * [1.0, 3.0]), 16)
    identity, weighted = (
        scale(data, n_dims=2, level="ratio", model=model, restriction=fixed_stimuli(z))
        for model in ("identity", "weighted")
    )
    assert identity.stress1 > 0.05
    assert weighted.stress1 < 1e-6
    assert weighted.dimension_weights[0, 1] / weighted.dimension_weights[0, 0] == pytest.approx(3, rel=1e-5)


def test_a_stimulus_fixed_at_the_origin_stays_there():
    known = np.full((6, 2), np.nan)
    known[0] = 0
    solution = scale(named(np.arange(1.0, 16), 6), n_dims=2, restriction=fixed_stimuli(known))
    assert np.array_equal(solution.coordinates[0], [0, 0])
    with pytest.raises(GlossError, match="All stimuli are fixed on one point"):
        scale(named(np.arange(1.0, 16), 6), n_dims=2, restriction=fixed_stimuli(np.ones((6, 2))))


@pytest.mark.parametrize(("seed", "level"), [(0, "interval"), (1, "ordinal"), (2, "ratio")])
def test_a_line_on_one_scale_is_found_as_by_many_more_starts(seed, level):
    data = named(np.random.default_rng(seed).uniform(1, 9, (3, 28)), 8)
    for model in ("identity", "weighted"):
        usual, more = (
            scale(data, n_dims=1, model=model, level=level, conditional=False, n_starts=n, seed=5).stress1
            for n in (100, 2000)
        )
        assert usual <= more * (1 + 1e-6)  # the solver's tolerance


def test_two_distinct_values_are_no_reason_to_turn_a_spline_round():
    rng = np.random.default_rng(0)
    data = named(np.vstack([rng.integers(0, 2, 15), rng.uniform(0, 9, 15)]).astype(float), 6)
    stress = {level: scale(data, n_dims=2, level=level).stress1 for level in ("interval", "spline")}
    assert stress["spline"] <= stress["interval"] * (1 + 1e-6)
