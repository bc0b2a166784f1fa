"""Whatever the data: a finite solution or a refusal in words, never a crash and never NaN."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import pdist

from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds import LEVELS, MODELS, TIES, scale
from gloss_analysis.mds.diagnostics import check_scalable
from glossspace.errors import GlossError
from tests.analysis.studies import named

ASSUMPTIONS = [(level, "primary") for level in LEVELS] + [("ordinal", "secondary")]


@st.composite
def judgements(draw):
    n, m = draw(st.integers(3, 7)), draw(st.integers(1, 4))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    shape = (m, n * (n - 1) // 2)
    kind = draw(st.sampled_from(["integers", "binary", "reals", "tiny", "huge", "near", "zeros"]))
    values = {
        "integers": lambda: rng.integers(0, 6, shape).astype(float),
        "binary": lambda: rng.integers(0, 2, shape).astype(float),
        "reals": lambda: rng.uniform(0, 10, shape),
        "tiny": lambda: 1e-12 * rng.uniform(0, 1, shape),
        "huge": lambda: 1e12 * rng.uniform(0, 1, shape),
        "near": lambda: 1 + 1e-12 * rng.integers(0, 100, shape),
        "zeros": lambda: np.where(rng.uniform(size=shape) < 0.8, 0.0, rng.uniform(0, 1, shape)),
    }[kind]()
    values[rng.uniform(size=shape) < draw(st.sampled_from([0.0, 0.0, 0.2, 0.5]))] = np.nan
    if draw(st.booleans()):
        values[rng.integers(m)] = draw(st.sampled_from([0.0, 5.0, np.nan]))
    weights = 10 ** rng.uniform(-3, 3, shape) if draw(st.booleans()) else None
    own = rng.uniform(0, 2, m) if draw(st.booleans()) else None
    return Dissimilarities(tuple(map(str, range(n))), tuple(map(str, range(m))), values, weights, own)


@settings(max_examples=120, deadline=None)
@given(
    judgements(),
    st.integers(1, 4),
    st.sampled_from(MODELS),
    st.sampled_from(ASSUMPTIONS),
    st.booleans(),
    st.sampled_from([1, 12]),
)
def test_a_solution_is_finite_and_its_numbers_agree(data, n_dims, model, assumed, conditional, n_starts):
    level, ties = assumed
    try:
        solution = scale(
            data, n_dims=n_dims, model=model, level=level, ties=ties, conditional=conditional, n_starts=n_starts
        )
    except GlossError:
        # Only for one of these two reasons.
        if n_dims <= len(data.stimuli) - 1:
            with pytest.raises(GlossError, match="."):
                check_scalable(data, level=level, ties=ties)
        return
    for values in (solution.coordinates, solution.dimension_weights, solution.transforms, solution.distances):
        assert np.all(np.isfinite(values))
    assert 0 <= solution.stress1 <= 1
    assert np.array_equal(np.isnan(solution.disparities), ~data.judged)
    assert np.all(solution.disparities[data.judged] >= 0)
    if conditional:
        mean = solution.source_shares @ solution.source_stress1**2
        assert solution.stress1**2 == pytest.approx(mean, rel=1e-6, abs=1e-12)  # two ways of adding up
    assert np.all(np.isfinite([solution.tucker_phi, solution.proxscal_normalized_raw_stress]))
    assert np.all(np.isfinite(solution.stress_per_point))
    assert solution.stress_per_pair.sum() == pytest.approx(1) or solution.stress_per_pair.sum() == 0
    assert solution.best_hits >= 1


@settings(max_examples=25, deadline=None)
@given(
    st.sampled_from([np.sqrt, np.log1p, np.exp, lambda x: 1e12 * x, lambda x: 1e-12 * x, lambda x: x**3]),
    st.integers(0, 1000),
    st.sampled_from(TIES),
    st.sampled_from([1, 2, 3]),
)
def test_ordinal_solutions_know_ranks_alone(function, seed, ties, n_dims):
    values = np.random.default_rng(seed).integers(1, 30, size=(2, 21)).astype(float)
    plain, rescaled = (scale(named(v, 7), n_dims=n_dims, ties=ties, n_starts=12) for v in (values, function(values)))
    assert rescaled.stress1 == plain.stress1
    assert np.array_equal(rescaled.coordinates, plain.coordinates)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 1000), st.sampled_from(ASSUMPTIONS), st.sampled_from(MODELS))
def test_names_and_order_of_stimuli_do_not_matter(seed, assumed, model):
    level, ties = assumed
    rng = np.random.default_rng(seed)
    n = 6
    square = np.zeros((2, n, n))
    first, second = np.triu_indices(n, 1)
    square[:, first, second] = rng.integers(1, 20, (2, 15))
    square += np.swapaxes(square, 1, 2)
    shuffle = rng.permutation(n)
    shuffled = square[:, shuffle][:, :, shuffle]
    one, other = (
        scale(named(m[:, first, second], n), n_dims=2, model=model, level=level, ties=ties) for m in (square, shuffled)
    )
    # Other starts meet other local minima; among six stimuli a hundred starts and exchanges find the same.
    assert other.stress1 == pytest.approx(one.stress1, rel=1e-5, abs=1e-7)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize(("level", "ties"), ASSUMPTIONS)
def test_three_stimuli(model, level, ties):
    solution = scale(named([[3, 4, 5], [3, 3, 5]], 3), n_dims=2, model=model, level=level, ties=ties)
    assert np.all(np.isfinite(solution.coordinates))
    # Two triangles differ by more than weights or scales: the identity model must compromise, at metric levels.
    if model == "generalised":
        assert solution.stress1 < 1e-5


def test_zero_is_data_and_not_a_gap():
    # Two stimuli that nobody can tell apart belong together; as a gap, their distance would be free.
    z = np.random.default_rng(0).standard_normal((6, 2))
    z[1] = z[0]
    solution = scale(named(pdist(z), 6), n_dims=2, level="ratio")
    assert solution.stress1 < 1e-6
    assert solution.distances[0, 0] < 1e-5 * solution.distances.max()


def test_observers_with_nothing_in_common_are_refused_and_both_groups_named():
    values = np.full((2, 15), np.nan)
    first, second = np.triu_indices(6, 1)
    values[0, (first < 3) & (second < 3)] = [1, 2, 3]
    values[1, (first > 2) & (second > 2)] = [3, 2, 1]
    with pytest.raises(GlossError, match="links the stimuli s0, s1, s2 with s3, s4, s5"):
        scale(named(values, 6), n_dims=2)


@pytest.mark.parametrize("value", [-1.0, np.inf, -np.inf])
def test_impossible_values_are_refused(value):
    values = np.arange(1.0, 7.0)
    values[2] = value
    with pytest.raises(GlossError, match="is not allowed"):
        scale(named(values, 4), n_dims=1)


@pytest.mark.parametrize(
    ("weights", "own"),
    [([[1, 1, -1, 1, 1, 1]], None), ([[1, 1, np.nan, 1, 1, 1]], None), (None, [np.inf]), (None, [-1])],
)
def test_impossible_weights_are_refused(weights, own):
    data = named(np.arange(1.0, 7.0), 4)
    data = replace(
        data,
        pair_weights=None if weights is None else np.array(weights, dtype=float),
        source_weights=None if own is None else np.array(own, dtype=float),
    )
    with pytest.raises(GlossError, match="[Ww]eight .* is not allowed"):
        scale(data, n_dims=2)
