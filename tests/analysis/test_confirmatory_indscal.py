"""Own weights under one objective: they are the individual fits, the engine agrees, and the test holds its level."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import pdist

from gloss_analysis.axes.indscal_conventions import converted
from gloss_analysis.confirmatory.indscal import confirm_indscal
from gloss_analysis.confirmatory.residual_permutation import permuted_residuals
from gloss_analysis.confirmatory.scaling import confirm_axes
from gloss_analysis.mds import fixed_stimuli, scale
from gloss_analysis.mds.objective import source_distances
from glossspace.errors import GlossError
from tests.analysis.studies import axis_values, judged_by, named

AXES = ("c", "d")
APART = [1.3, 1.5, 1.6, 1.7, 1.78, 1.9, 2.0, 2.2, 2.4]


@settings(max_examples=12, deadline=None)
@given(
    ratios=st.lists(st.floats(0.4, 5), min_size=2, max_size=4),
    exponent=st.floats(0.6, 1.2),
    noise_sd=st.floats(0.5, 6),
    level=st.sampled_from(["ratio", "interval", "ordinal"]),
    seed=st.integers(0, 100),
)
def test_with_fixed_coordinates_the_engine_finds_the_individual_fits(ratios, exponent, noise_sd, level, seed):
    data = judged_by(ratios, exponent=exponent, noise_sd=noise_sd, integers=True, seed=seed)
    own = confirm_indscal(data, axis_values(), axes=AXES, level=level)
    individual = [one.stress1**2 for one in confirm_axes(data, axis_values(), axes=AXES, level=level).individual]
    assert own.stress1 == pytest.approx(np.sqrt(np.mean(individual)), rel=1e-9)  # the same sum
    engine = scale(data, n_dims=2, level=level, restriction=fixed_stimuli(axis_values()), n_starts=10, seed=seed)
    # Neither search is allowed to be beaten by more than where it stops: L-BFGS at 1e-10 of the objective but in dents
    # of the ordinal loss, which the search on a grid looks for and it does not.
    assert own.stress1 <= engine.stress1 * (1 + 1e-8)
    assert engine.stress1 == pytest.approx(own.stress1, rel=1e-3)


def test_weights_are_in_the_convention_of_indscal():
    data = judged_by([1.2, 2.5], noise_sd=2)
    own = confirm_indscal(data, axis_values(), axes=AXES, level="ratio")
    ratios = [one.ratio for one in confirm_axes(data, axis_values(), axes=AXES, level="ratio").individual]
    # Carroll and Chang's (1970) normalisation: coordinates of sum of squares 1, scalar products of sum of squares 1.
    centred = axis_values() - axis_values().mean(axis=0)
    columns = centred / np.sqrt(np.sum(centred**2, axis=0))
    for weights, ratio in zip(own.squared_weights, ratios, strict=True):
        space = columns * np.sqrt(weights)
        assert np.sum((space @ space.T) ** 2) == pytest.approx(1, rel=1e-9)
        seen = pdist(centred * [1, ratio])
        # Distances of that space are those of the fit but for a factor.
        assert pdist(space) / pdist(space)[0] == pytest.approx(seen / seen[0], rel=1e-6)
    assert own.squared_weights == pytest.approx(
        converted(centred, np.column_stack([np.ones(2), ratios]), to="unit_sum_of_squares").squared_weights, rel=1e-6
    )


def test_participants_who_differ_are_told_from_noise_and_those_who_do_not_are_not():
    differ = confirm_indscal(judged_by(APART, noise_sd=4), axis_values(), axes=AXES, n_permutations=19)
    assert differ.p_value == 1 / 20  # no permutation comes near a fifth of the stress
    assert differ.share_taken > 3 * differ.null.max()
    assert "participants weigh the axes differently" in differ.sentences[0]
    assert differ.angles.max() < 10
    alike = confirm_indscal(judged_by([1.78] * 9, noise_sd=4), axis_values(), axes=AXES, n_permutations=19)
    assert alike.null.min() < alike.share_taken < 2 * np.median(alike.null)
    assert "nothing here says" in alike.sentences[0]
    assert "hardly determined" in alike.sentences[1]


def test_permutations_that_take_just_as_much_count():
    """Equal participants without noise: nothing is permuted, own weights take nothing, 0 is as much as 0 and p is 1."""
    found = confirm_indscal(judged_by([1.78] * 2), axis_values(), axes=AXES, level="ratio", n_permutations=2)
    assert found.share_taken == 0
    assert found.p_value == 1


def test_the_p_value_of_equal_participants_is_uniform():
    # 60 studies of four equal participants, nine permutations each: p is 1/10, ..., 1, equally often. Of a uniform
    # p, P(p <= .2) = .2, and 60 studies give 12 of them; 4 to 22 are within 3.2 standard deviations, sqrt(60 .2 .8).
    values = [
        confirm_indscal(
            judged_by([1.78] * 4, noise_sd=5, seed=seed), axis_values(), axes=AXES, level="ratio", n_permutations=9
        ).p_value
        for seed in range(60)
    ]
    assert 4 <= np.sum(np.array(values) <= 0.2) <= 22
    assert np.mean(values) == pytest.approx(0.55, abs=4 * np.sqrt(0.99 / 12 / 60))  # four standard errors


def test_combinations_of_the_axes_find_a_turn():
    # Distances along axes that are the given ones turned by 30 degrees, in units of their standard deviations.
    x = axis_values()
    z = (x - x.mean(axis=0)) / x.std(axis=0)
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    turned = z @ np.array([[c, -s], [s, c]])
    data = named([pdist(turned * [1, weight]) for weight in (0.4, 1.0, 2.5)], 27)
    found = confirm_indscal(data, x, axes=AXES, level="ratio")
    assert found.stress1_combined < 1e-5 < found.stress1  # an exact fit exists; squared stress ends at rounding
    assert found.angles == pytest.approx([30, 30], abs=0.01)  # where the search ends


def test_one_transformation_for_all_needs_participants_on_one_scale():
    data = judged_by([1.2, 2.5], noise_sd=0)
    # judged_by brings each participant's largest judgement to 95, so that sizes differ: own weights must carry it.
    found = confirm_indscal(data, axis_values(), axes=AXES, level="ratio", conditional=False)
    assert found.stress1 < 1e-6 < found.stress1_shared  # an exact fit exists
    weights = np.sqrt(found.squared_weights[:, 1] / found.squared_weights[:, 0]) / np.divide(
        *np.sqrt(np.sum((axis_values() - axis_values().mean(axis=0)) ** 2, axis=0))[::-1]
    )
    assert weights == pytest.approx([1.2, 2.5], rel=1e-4)  # where the search ends
    curved = named(judged_by([1.2, 2.5], exponent=1).values ** np.array([[1.0], [0.5]]), 27)
    own = confirm_indscal(curved, axis_values(), axes=AXES)
    common = confirm_indscal(curved, axis_values(), axes=AXES, conditional=False)
    assert own.stress1 < 1e-3 < common.stress1  # the two curves are no longer one
    with pytest.raises(GlossError, match="The permutation test is of conditional fits"):
        confirm_indscal(curved, axis_values(), axes=AXES, conditional=False, n_permutations=9)


def test_a_single_participant_and_a_single_axis_have_nothing_to_differ_in():
    alone = confirm_indscal(judged_by([1.78], noise_sd=3), axis_values(), axes=AXES, n_permutations=19)
    assert alone.p_value is None
    assert alone.angles is None
    assert alone.share_taken == pytest.approx(0, abs=1e-9)
    line = confirm_indscal(judged_by([1.2, 2.5]), axis_values()[:, :1], axes=("c",), n_permutations=19)
    assert line.p_value is None
    assert line.stress1 == pytest.approx(line.stress1_shared, rel=1e-12)


def test_constant_participants_are_left_out_and_threads_change_nothing():
    values = np.vstack([judged_by([1.5, 2.2], noise_sd=3).values, np.full((1, 351), 50.0)])
    one, two = (
        confirm_indscal(named(values, 27), axis_values(), axes=AXES, n_permutations=5, seed=3, n_jobs=n) for n in (1, 2)
    )
    assert one.participants == ("p0", "p1")
    assert one.null.tolist() == two.null.tolist()
    assert len(one.squared_weights) == 2
    with pytest.raises(GlossError, match="Invalid number of permutations = -1"):
        confirm_indscal(named(values, 27), axis_values(), axes=AXES, n_permutations=-1)


def test_permuted_residuals_keep_the_answers_and_lose_the_metric():
    data = judged_by([1.78, 1.78], noise_sd=6, integers=True)
    predicted = source_distances(axis_values(), np.array([[1.0, 1.78], [1.0, 1.78]]))
    drawn = permuted_residuals(data, predicted)(np.random.default_rng(0))
    assert np.sort(drawn.values, axis=1).tolist() == np.sort(data.values, axis=1).tolist()
    assert not np.array_equal(drawn.values, data.values)
    # Noise of 6 about the same curve: both follow it as closely. Means of 351 squares have a relative standard error of
    # sqrt(2 / 351) = .075; twice four of them.
    off = [np.mean((one - 95 * predicted / predicted.max()) ** 2) for one in (data.values, drawn.values)]
    assert off[1] == pytest.approx(off[0], rel=0.6)
