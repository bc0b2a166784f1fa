"""Optimal transformations, against scikit-learn, non-negative least squares and hand-made cases."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.optimize import nnls
from sklearn.isotonic import IsotonicRegression

from gloss_analysis.mds.disparities import disparities, source_order
from glossspace.errors import GlossError

# Projections are sums and quotients of a handful of numbers of order one: a few roundings of 1e-16.
ROUNDING = 1e-12

distances = arrays(float, 12, elements=st.floats(0.01, 10))
coarse = arrays(float, 12, elements=st.integers(0, 4).map(float))  # an integer slider gives many ties


def test_primary_ties_may_be_untied_and_secondary_may_not():
    # By hand: the two pairs of dissimilarity 2 come out as 2 and 4 and are sorted (primary), or as their mean 3.
    order = source_order(np.array([1.0, 2.0, 2.0, 3.0]))
    d = np.array([1.0, 4.0, 2.0, 5.0])
    assert disparities(d, order, level="ordinal", ties="primary").tolist() == [1, 4, 2, 5]
    assert disparities(d, order, level="ordinal", ties="secondary").tolist() == [1, 3, 3, 5]


@given(distances, coarse)
def test_ordinal_with_secondary_ties_is_isotonic_regression_on_the_dissimilarity(d, delta):
    # scikit-learn averages the responses of equal x values, which is what secondary ties are.
    expected = IsotonicRegression().fit_transform(delta, d)
    found = disparities(d, source_order(delta), level="ordinal", ties="secondary")
    assert found == pytest.approx(expected, rel=ROUNDING)


@given(distances, coarse)
def test_ordinal_with_primary_ties_is_isotonic_regression_in_the_order_of_the_distances(d, delta):
    sequence = np.lexsort((d, delta))
    expected = np.empty(12)
    expected[sequence] = IsotonicRegression().fit_transform(np.arange(12), d[sequence])
    found = disparities(d, source_order(delta), level="ordinal", ties="primary")
    assert found == pytest.approx(expected, rel=ROUNDING)


@given(distances, coarse)
def test_interval_is_the_nearest_line_that_never_goes_below_zero(d, delta):
    rise = delta - delta.min()
    coefficients, _ = nnls(np.column_stack([np.ones(12), rise]), d)
    expected = coefficients[0] + coefficients[1] * rise
    # nnls solves the same projection by an active-set method in double precision.
    assert disparities(d, source_order(delta), level="interval", ties="primary") == pytest.approx(expected, abs=1e-9)


@given(distances, coarse)
def test_ratio_is_the_nearest_multiple(d, delta):
    found = disparities(d, source_order(delta), level="ratio", ties="primary")
    if delta.any():
        factor = np.linalg.lstsq(delta[:, np.newaxis], d)[0][0]
        assert found == pytest.approx(factor * delta, abs=1e-9)  # least squares by another factorisation
    else:
        assert not found.any()


@given(distances, coarse, st.sampled_from(["ratio", "interval", "ordinal"]), st.sampled_from(["primary", "secondary"]))
def test_every_level_is_a_projection_onto_a_cone(d, delta, level, ties):
    order = source_order(delta)
    found = disparities(d, order, level=level, ties=ties)
    assert found @ (d - found) == pytest.approx(0, abs=1e-9)  # the residual is orthogonal: what the objective relies on
    assert disparities(3 * d, order, level=level, ties=ties) == pytest.approx(3 * found, rel=1e-9, abs=1e-12)
    assert np.all(found >= 0)


@pytest.mark.parametrize(
    ("level", "ties", "message"),
    [
        ("nominal", "primary", r"Invalid level = 'nominal'\. Allowed: 'ratio', 'interval', 'spline', 'ordinal'\."),
        ("ordinal", "tertiary", r"Invalid ties = 'tertiary'\. Allowed: 'primary', 'secondary'\."),
    ],
)
def test_unknown_assumptions_are_refused(level, ties, message):
    with pytest.raises(GlossError, match=message):
        disparities(np.ones(3), source_order(np.arange(3.0)), level=level, ties=ties)
