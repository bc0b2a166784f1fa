"""The axis ratio is the lowest point of stress, by brute force along the one dimension, with stress computed anew."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import isotonic_regression, nnls

from gloss_analysis.confirmatory.scaling import confirm_axes
from tests.analysis.studies import axis_values, named

AXES = ("c", "d")
RATIOS = np.geomspace(0.01, 100, 1001)
"""A thousand ratios over four decades, the range of the search, of axes of equal spread: neighbours .9 % apart."""


def squared_stress(distance, judged, level, ties):
    """Kruskal's Stress-1 squared of one participant at the best scale, from its definition: 1 - |P d|^2 / |d|^2."""
    if level == "ratio":
        fitted = judged * (judged @ distance) / (judged @ judged)
    elif level == "interval":
        # Admissible are rising lines that are not negative: combinations of 1 and judged - least, no part negative.
        base = np.column_stack([np.ones_like(judged), judged - judged.min()])
        fitted = base @ nnls(base, distance)[0]
    elif ties == "primary":
        order = np.lexsort((distance, judged))
        fitted = np.empty_like(distance)
        fitted[order] = isotonic_regression(distance[order]).x
    else:
        _, place, count = np.unique(judged, return_inverse=True, return_counts=True)
        means = np.bincount(place, weights=distance) / count
        fitted = isotonic_regression(means, weights=count).x[place]
    return np.sum((distance - fitted) ** 2) / np.sum(distance**2)


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    n=st.integers(5, 9),
    truth=st.floats(0.3, 8),
    noise=st.floats(0, 30),
    step=st.sampled_from([1, 5, 20]),
    level_and_ties=st.sampled_from(
        [("ratio", "primary"), ("interval", "primary"), ("ordinal", "primary"), ("ordinal", "secondary")]
    ),
)
def test_no_ratio_of_a_dense_grid_has_a_lower_stress(seed, n, truth, noise, step, level_and_ties):
    level, ties = level_and_ties
    rng = np.random.default_rng(seed)
    position = axis_values()[rng.permutation(27)[:n]]
    first, second = np.triu_indices(n, 1)
    delta = np.abs(position[first] - position[second])
    if np.any(np.ptp(position, axis=0) == 0):
        return  # refused: an axis on which nothing differs
    ideal = np.hypot(delta[:, 0], truth * delta[:, 1])
    answers = 95 * ideal / ideal.max() + noise * rng.standard_normal((2, len(ideal)))
    judged = np.clip(step * np.round(answers / step), 0, 100)
    if np.any(np.ptp(judged, axis=1) == 0):
        return  # left out: a participant who distinguished no pairs
    ratios = RATIOS * position[:, 0].std() / position[:, 1].std()
    fit = confirm_axes(named(judged, n), position, axes=AXES, level=level, ties=ties)
    curves = np.array(
        [
            [squared_stress(np.hypot(delta[:, 0], ratio * delta[:, 1]), row, level, ties) for ratio in ratios]
            for row in judged
        ]
    )
    slack = 1e-9  # rounding, and where golden section stops
    for row, one, curve in zip(judged, fit.individual, curves, strict=True):
        assert one.stress1**2 <= curve.min() + slack
        own = squared_stress(np.hypot(delta[:, 0], one.ratio * delta[:, 1]), row, level, ties)
        assert one.stress1**2 == pytest.approx(own, abs=slack)
    assert fit.shared.stress1**2 <= curves.mean(axis=0).min() + slack
