"""Permutation tests of ranks against scipy's exact ones, against enumeration, and against textbooks."""

import itertools

import numpy as np
import pytest
from scipy.stats import kendalltau, permutation_test, rankdata, spearmanr

from gloss_analysis.ranking.contour_ranks import contour_test, levels_of
from gloss_analysis.ranking.rank_agreement import agreement_of_participants, joint_test
from gloss_analysis.ranking.rank_permutation import concordance, orders_of, products_under, sums_under

SEED = np.random.SeedSequence(1)


def ranks_of(rng, m, n):
    return np.array([rng.permutation(n) + 1.0 for _ in range(m)])


def test_few_things_are_permuted_in_all_orders_and_many_at_random():
    few, many = orders_of(4, 24, SEED), orders_of(4, 23, SEED)
    assert few.exhaustive
    assert {tuple(order) for order in few.places} == set(itertools.permutations(range(4)))
    assert not many.exhaustive
    assert many.places.shape == (23, 4)
    assert (np.sort(orders_of(2000, 99, SEED).places) == np.arange(2000)).all()  # 2000! overflows a float


def test_products_and_sums_by_their_definitions(monkeypatch):
    rng = np.random.default_rng(2)
    matrix, others = rng.normal(size=(4, 4)), rng.normal(size=(2, 4, 4))
    orders = orders_of(4, 24, SEED)
    monkeypatch.setattr("gloss_analysis.ranking.rank_permutation._CHUNK", 80)  # five orders at a time
    products, sums = products_under(orders, matrix, others), sums_under(orders, matrix[0], others[0, :3])
    for row, order in enumerate(orders.places):
        for k in range(2):
            expected = sum(matrix[order[i], order[j]] * others[k, i, j] for i in range(4) for j in range(4))
            assert products[row, k] == pytest.approx(expected)
        assert sums[row] == pytest.approx(
            [sum(matrix[0, order[i]] * others[0, k, i] for i in range(4)) for k in range(3)]
        )


@pytest.mark.parametrize("n", [4, 7])
def test_exact_p_of_tau_is_scipys(n):
    # scipy counts inversions by a recursion; here all n! orders are listed.
    ranks = ranks_of(np.random.default_rng(n), 6, n)
    found = agreement_of_participants("abcdef", ranks, np.arange(n), 9999, SEED)
    for one, row in zip(found, ranks, strict=True):
        expected = kendalltau(np.arange(n), row, method="exact")
        assert one.tau_b == pytest.approx(expected.statistic)
        assert one.tau_b_p == pytest.approx(expected.pvalue)


def test_exact_p_with_ties_by_scipys_permutation_test():
    levels, row = np.array([0, 1, 1, 2, 3, 3]), np.array([1.0, 2.0, 4.0, 3.0, 6.0, 5.0])
    (one,) = agreement_of_participants(["a"], row[None], levels, 999, SEED)
    for found, p, statistic in ((one.tau_b, one.tau_b_p, kendalltau), (one.spearman, one.spearman_p, spearmanr)):
        exact = permutation_test(
            (row,), lambda y, s=statistic: s(levels, y).statistic, permutation_type="pairings", n_resamples=np.inf
        )
        assert found == pytest.approx(exact.statistic)
        # scipy doubles the smaller tail, which is that of both sides where the distribution is symmetrical, as here:
        # turning all ranks round turns the sign
        assert p == pytest.approx(exact.pvalue)


def test_random_permutations_approach_the_exact_p():
    n, n_permutations = 12, 9999
    row = np.array([2, 1, 5, 3, 9, 4, 12, 6, 8, 7, 11, 10.0])[::-1][np.argsort([3, 8, 1, 9, 0, 5, 2, 11, 4, 10, 6, 7])]
    (one,) = agreement_of_participants(["a"], row[None], np.arange(n), n_permutations, SEED)
    exact = kendalltau(np.arange(n), row, method="exact").pvalue
    assert 0.01 < exact < 0.99
    # four standard errors of a binomial proportion
    assert one.tau_b_p == pytest.approx(exact, abs=4 * np.sqrt(exact * (1 - exact) / n_permutations))


def test_all_participants_together_are_one_if_there_is_one():
    rng = np.random.default_rng(5)
    orders = orders_of(6, 720, SEED)
    levels = np.array([0, 1, 1, 2, 3, 4])
    for row in ranks_of(rng, 5, 6):
        agreement = agreement_of_participants(["a"], row[None], levels, 720, SEED)
        mean, p = joint_test(agreement, row[None], levels, orders)
        assert (mean, p) == pytest.approx((agreement[0].tau_b, agreement[0].tau_b_p))


def test_participants_who_share_an_order_of_no_meaning_do_not_make_it_significant():
    # Twenty participants who all give the same ranks are as good as one: the stimuli are what is drawn.
    row = np.array([2.0, 1.0, 4.0, 3.0])
    ranks = np.tile(row, (20, 1))
    agreement = agreement_of_participants([str(k) for k in range(20)], ranks, np.arange(4), 99, SEED)
    _, p = joint_test(agreement, ranks, np.arange(4), orders_of(4, 99, SEED))
    assert p == pytest.approx(kendalltau(np.arange(4), row, method="exact").pvalue)


def test_partial_rankings_count_by_what_was_ranked():
    nan = np.nan
    ranks = np.array([[1, nan, 3, 2, 4.0], [1, 2, 3, 4, 5]])
    first, second = agreement_of_participants("ab", ranks, np.arange(5), 999, SEED)
    expected = kendalltau([0, 2, 3, 4], [1, 3, 2, 4], method="exact")
    assert (first.n_stimuli, first.tau_b, first.tau_b_p) == pytest.approx((4, expected.statistic, expected.pvalue))
    assert first.tau_b_others == pytest.approx(expected.statistic)
    assert (second.n_stimuli, second.tau_b) == (5, pytest.approx(1))


def kendalls_w_with_ties(ranks):
    """W = 12 S / (m^2 (n^3 - n) - m T), T = sum of t^3 - t over groups of ties (Kendall & Gibbons 1990, chapter 6)."""
    m, n = ranks.shape
    ties = sum((count**3 - count) for row in ranks for count in np.unique(row, return_counts=True)[1])
    totals = ranks.sum(axis=0)
    return 12 * np.square(totals - totals.mean()).sum() / (m**2 * (n**3 - n) - m * ties)


def test_concordance_with_and_without_ties():
    rng = np.random.default_rng(3)
    for _ in range(5):
        ranks = np.array([rankdata(rng.integers(0, 4, 9)) for _ in range(4)])
        assert concordance(ranks, 99, SEED)[0] == pytest.approx(kendalls_w_with_ties(ranks))
    whole = ranks_of(rng, 5, 7)
    mean_rho = np.mean([spearmanr(whole[a], whole[b]).statistic for a, b in itertools.combinations(range(5), 2)])
    assert concordance(whole, 99, SEED)[0] == pytest.approx((4 * mean_rho + 1) / 5)  # Kendall & Gibbons, eq. 6.6
    assert concordance(np.tile(whole[0], (3, 1)), 99, SEED)[0] == pytest.approx(1)


def test_p_of_concordance_by_enumeration():
    ranks = np.array([[1.0, 2, 3], [1, 3, 2], [2, 1, 3]])
    squares = [
        np.square(np.sum(combination, axis=0) - 6).sum()
        for combination in itertools.product(itertools.permutations([1, 2, 3]), repeat=3)
    ]
    exact = np.mean(np.array(squares) >= np.square(ranks.sum(axis=0) - 6).sum())
    _, p = concordance(ranks, 9999, SEED)
    assert p == pytest.approx(exact, abs=4 * np.sqrt(exact * (1 - exact) / 9999))  # four standard errors


def test_ranks_without_meaning_are_rarely_significant():
    # 200 simulated studies: 5 % at .05, and with the binomial's 99.9 % point no more than 21. With 99 permutations the
    # p values are multiples of .01, so that the level is exact.
    rng = np.random.default_rng(7)
    distances, angle = np.repeat([0.02, 0.04, 0.06], 4), np.tile([0.0, 30, 60, 90], 3)
    counts = np.zeros(2)
    for seed in np.random.SeedSequence(11).spawn(200):
        found = contour_test(
            distances, angle, ranks_of(rng, 4, 12).mean(axis=0), tolerance=0.004, orders=orders_of(12, 99, seed),
            seed=seed,
        )  # fmt: skip
        counts += found.p_value <= 0.05, found.direction.p_value <= 0.05
    assert (counts <= 21).all()
    assert (counts >= 1).all()


def test_direction_along_contours_by_enumeration():
    distances, angle = np.array([0.0, 0.04, 0.04, 0.08, 0.08, 0.08]), np.array([np.nan, 0, 90, 0, 45, 90])
    ranks = np.array([1.0, 2, 3, 4, 5, 6])
    found = contour_test(distances, angle, ranks, tolerance=0.004, orders=orders_of(6, 720, SEED), seed=SEED)
    # pairs: 3 - 2; 5 - 4, 6 - 4, 6 - 5
    assert found.direction.n_pairs == 4
    assert found.direction.lead == pytest.approx(np.mean([1, 1, 2, 1]))
    # Of the 2! 3! ways to give the ranks along contours, this one and its reverse are the most extreme.
    assert found.direction.p_value == pytest.approx(2 / 12)
    assert (found.n_pairs, found.within, found.level.tolist()) == (4, pytest.approx(5 / 4), [0, 1, 1, 2, 2, 2])


def test_the_observed_ranks_count_among_the_random_ones():
    # (b + 1) / (n + 1) (Phipson and Smyth 2010); no order of eight does as well as full agreement of six.
    w, p = concordance(np.tile(np.arange(8.0), (6, 1)), 99, SEED)
    assert (w, p) == (1.0, 1 / 100)


def test_exact_p_of_spearman_where_levels_are_unevenly_tied():
    """All 720 orders by scipy's rho: ranks of tied levels are midranks, which the numbers of the levels are not."""
    levels, row = np.array([0, 0, 0, 0, 1, 2]), np.array([1.0, 2.0, 3.0, 5.0, 6.0, 4.0])
    (one,) = agreement_of_participants(["a"], row[None], levels, 999, SEED)
    every = np.abs([spearmanr(levels, order).statistic for order in itertools.permutations(row)])
    assert one.spearman_p == np.mean(every >= abs(spearmanr(levels, row).statistic) - 1e-9)  # rounding


def test_exact_p_of_the_mean_tau_where_rankings_are_partial_or_tied():
    """All 120 orders by scipy's tau-b: each participant counts by a tau of his own, not by his number of pairs."""
    nan, levels = np.nan, np.arange(5.0)
    ranks = np.array([[1, 2, 3, 4, 5.0], [2, 1, 2, nan, 2], [3, nan, nan, 2, 1]])

    def mean_tau(order):
        known = [np.isfinite(row) for row in ranks]
        return np.mean([kendalltau(order[k], row[k]).statistic for k, row in zip(known, ranks, strict=True)])

    agreement = agreement_of_participants("abc", ranks, np.arange(5), 999, SEED)
    mean, p = joint_test(agreement, ranks, np.arange(5), orders_of(5, 999, SEED))
    every = np.abs([mean_tau(np.array(order)) for order in itertools.permutations(levels)])
    assert (mean, p) == pytest.approx((mean_tau(levels), np.mean(every >= abs(mean_tau(levels)) - 1e-9)))  # rounding


def test_a_contour_spans_no_more_than_the_tolerance_however_near_its_neighbours_are():
    assert levels_of(np.array([0.0, 0.003, 0.006, 0.009, 0.013]), 0.004).tolist() == [0, 0, 1, 1, 2]


def test_differences_within_and_between_contours_by_hand():
    # Contours {1, 4} and {2, 9}: within 3 and 7; between |1-2|, |1-9|, |4-2|, |4-9|.
    found = contour_test(
        np.array([0.1, 0.1, 0.2, 0.2]), np.full(4, 45.0), np.array([1.0, 4, 2, 9]), tolerance=0.004,
        orders=orders_of(4, 99, SEED), seed=SEED,
    )  # fmt: skip
    assert (found.n_pairs, found.within, found.between) == (2, 5.0, 4.0)
