"""Agreement of two configurations, against SciPy, closed forms and exhaustive search."""

import itertools

import numpy as np
import pytest
from scipy.spatial import procrustes
from scipy.spatial.distance import pdist
from scipy.stats import kstest, ortho_group

from gloss_analysis.axes.agreement import agreement
from glossspace.errors import GlossError
from tests.analysis.solutions import solution_of

# Sums of products of some dozens of numbers near 1: what is left is rounding.
ROUNDING = 1e-12


def pair(n=12, p=2, noise=0.5, seed=0):
    rng = np.random.default_rng(seed)
    first = rng.standard_normal((n, p))
    return first, first + noise * rng.standard_normal((n, p))


@pytest.mark.parametrize("p", [1, 2, 3])
def test_procrustes_is_that_of_scipy(p):
    first, second = pair(p=p)
    turned = 3 * second @ ortho_group.rvs(p, random_state=1) + 5 if p > 1 else -3 * second + 5
    found = agreement(first, turned, n_permutations=1)
    assert found.rotated
    assert found.procrustes == pytest.approx(procrustes(first, second)[2], abs=ROUNDING)
    assert found.congruence**2 == pytest.approx(1 - found.procrustes, abs=ROUNDING)


def test_size_counts_in_one_of_the_two():
    first, _ = pair()
    found = agreement(first, 2 * first, n_permutations=1)
    assert found.procrustes == pytest.approx(0, abs=ROUNDING)
    assert found.procrustes_sized == pytest.approx(1 - 2 * 2 / (1 + 4), abs=ROUNDING)  # t = 2 |X|^2, |Y|^2 = 4 |X|^2
    residual = np.sum((first - first.mean(axis=0) - found.matched) ** 2)
    sizes = np.sum((first - first.mean(axis=0)) ** 2) + np.sum(found.matched**2)
    assert found.procrustes_sized == pytest.approx(residual / sizes, abs=ROUNDING)


@pytest.mark.parametrize("rotate", [True, False])
def test_agreement_is_symmetric_and_blind_to_position_order_and_sign(rotate):
    first, second = pair(p=3)
    there = agreement(first, second, rotate=rotate, n_permutations=1)
    back = agreement(second, first, rotate=rotate, n_permutations=1)
    moved = agreement(first, second[:, [2, 0, 1]] * [1, -1, 1] + 4, rotate=rotate, n_permutations=1)
    for other in (back, moved):
        assert other.procrustes == pytest.approx(there.procrustes, abs=ROUNDING)
        assert other.procrustes_sized == pytest.approx(there.procrustes_sized, abs=ROUNDING)
        assert other.distance_congruence == pytest.approx(there.distance_congruence, abs=ROUNDING)
    assert moved.matched == pytest.approx(there.matched, abs=ROUNDING)


def test_without_rotation_the_best_of_all_orders_and_signs_is_taken():
    first, second = pair(p=3, noise=1.5, seed=3)
    found = agreement(first, second, rotate=False, n_permutations=1)
    x, y = first - first.mean(axis=0), second - second.mean(axis=0)
    traces = [
        np.sum(x * (y[:, order] * sign))
        for order in itertools.permutations(range(3))
        for sign in itertools.product([1, -1], repeat=3)
    ]
    expected = max(traces) / (np.linalg.norm(x) * np.linalg.norm(y))
    assert not found.rotated
    assert found.congruence == pytest.approx(expected, abs=ROUNDING)
    assert np.sort(np.abs(found.turn), axis=1).tolist() == [[0, 0, 1]] * 3
    assert y @ found.turn == pytest.approx(found.matched, abs=ROUNDING)


def test_congruence_coefficients_are_cosines():
    first = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    second = np.array([[1.0, 0.5], [-1.0, -0.5], [0.0, 2.0], [0.0, -2.0]])
    found = agreement(first, second, rotate=False, n_permutations=1)
    # Columns (1, -1, 0, 0) and the like: cosines 2 / 2 and 4 / (sqrt(2) sqrt(8.5)).
    assert found.column_congruence == pytest.approx([1.0, 4 / np.sqrt(17)], abs=ROUNDING)
    a, b = pdist(first), pdist(second)
    assert found.distance_congruence == pytest.approx(a @ b / np.sqrt((a @ a) * (b @ b)), abs=ROUNDING)
    empty = agreement(first, second * [1, 0], rotate=False, n_permutations=1)
    assert empty.column_congruence == pytest.approx([1.0, 0.0], abs=ROUNDING)


def test_p_values_are_those_of_all_permutations():
    first, second = pair(n=6, noise=1.0, seed=5)
    found = agreement(first, second, n_permutations=2000, seed=2)
    orders = [list(order) for order in itertools.permutations(range(6))]
    exact = np.mean([procrustes(first, second[order])[2] <= found.procrustes + 1e-12 for order in orders])
    distances = [pdist(first) @ pdist(second[order]) for order in orders]
    exact_distances = np.mean(np.array(distances) >= pdist(first) @ pdist(second) - 1e-12)
    # Four standard errors of a proportion of 2000 draws; b + 1 over B + 1 adds less than .0005.
    for p_value, truth in ((found.procrustes_p, exact), (found.distance_congruence_p, exact_distances)):
        assert 0.001 < truth < 0.9  # a proportion that 2000 draws can tell
        assert p_value == pytest.approx(truth, abs=4 * np.sqrt(truth * (1 - truth) / 2000) + 0.0005)


@pytest.mark.parametrize("rotate", [True, False])
def test_p_values_of_unrelated_configurations_are_uniform(rotate):
    rng = np.random.default_rng(7)
    found = [agreement(*rng.standard_normal((2, 8, 2)), rotate=rotate, n_permutations=99, seed=k) for k in range(120)]
    for name in ("procrustes_p", "distance_congruence_p", "column_congruence_p"):
        # The seed is fixed; .001 keeps one in a thousand such tests from failing for nothing.
        assert kstest([getattr(one, name) for one in found], "uniform").pvalue > 0.001


def test_the_same_configuration_has_the_lowest_p_value():
    first, _ = pair()
    found = agreement(first, first, n_permutations=199)
    assert (found.procrustes_p, found.distance_congruence_p, found.column_congruence_p) == (1 / 200,) * 3
    assert found.procrustes == pytest.approx(0, abs=ROUNDING)


def test_a_seed_fixes_the_permutations():
    first, second = pair(n=6, noise=2.0)
    p_values = [agreement(first, second, seed=seed, n_permutations=50).procrustes_p for seed in (1, 1, 2, 3, 4)]
    assert p_values[0] == p_values[1]
    assert len(set(p_values)) > 1


def test_solutions_are_matched_by_name_and_weighted_ones_not_rotated():
    first, _ = pair(n=5)
    weights = np.array([[1.0, 0.4], [0.4, 1.0]])
    one = solution_of(first, weights, stimuli=("a", "b", "c", "d", "e"))
    other = solution_of(first[::-1], weights, stimuli=("e", "d", "c", "b", "a"))
    found = agreement(one, other)
    assert not found.rotated
    assert found.procrustes == pytest.approx(0, abs=ROUNDING)
    with pytest.raises(GlossError, match="must not be rotated"):
        agreement(one, other, rotate=True)
    identity = solution_of(first, model="identity")
    assert agreement(identity, first).rotated
    with pytest.raises(GlossError, match="10 stimuli are in one of the two solutions only, such as 'a'"):
        agreement(one, identity)


@pytest.mark.parametrize(
    ("first", "second", "options", "message"),
    [
        (np.eye(3), np.eye(3)[:, :2], {}, r"shape \(3, 3\) and \(3, 2\) cannot be compared"),
        (np.eye(2), np.eye(2), {}, "2 stimuli agree in any case"),
        (np.eye(3), np.full((3, 3), 0.1), {}, "second configuration has all stimuli in one place"),
        (np.full((3, 2), np.inf), np.eye(3)[:, :2], {}, "finite table"),
        (np.eye(3), np.eye(3), {"n_permutations": 0}, "Invalid number of permutations = 0"),
        (np.eye(3), np.eye(3), {"seed": -1}, "Invalid seed = -1"),
    ],
)
def test_what_cannot_be_compared_is_refused(first, second, options, message):
    with pytest.raises(GlossError, match=message):
        agreement(first, second, **options)
