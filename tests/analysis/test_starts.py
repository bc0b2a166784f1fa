"""Starting configurations."""

import itertools

import numpy as np
import pytest
from scipy.spatial.distance import pdist

from gloss_analysis.starts import interchanged, torgerson_configuration
from tests.analysis.studies import named


def test_classical_scaling_of_equal_steps_on_a_line():
    # Dissimilarities in proportion to their ranks, so that ranks lose nothing: 0, 1, 3 on a line are found exactly.
    found = torgerson_configuration(named([1, 3, 2], 3), 2)
    assert pdist(found) == pytest.approx(np.array([1, 3, 2]) / 3, abs=1e-12)
    assert np.allclose(found[:, 1], 0, atol=1e-7)  # the root of a rounding error of 1e-15


def test_interchange_makes_every_order_that_is_one_move_away():
    line = np.array([[0.0], [1.0], [3.0], [7.0]])
    lines = interchanged(line, pdist(line))
    expected = set()
    for i, j in itertools.permutations(range(4), 2):
        carried = [x for x in range(4) if x != i]
        expected.add((*carried[:j], i, *carried[j:]))
        exchanged = list(range(4))
        exchanged[i], exchanged[j] = j, i
        expected.add(tuple(exchanged))
    assert len(lines) == len(expected)
    promise = [float(np.sum(points**2)) for points in lines]
    assert promise == sorted(promise, reverse=True)
