"""Starting configurations."""

import numpy as np
import pytest
from scipy.spatial.distance import pdist

from gloss_analysis.mds.starts import torgerson_configuration, torgerson_projections
from tests.analysis.studies import named


def test_classical_scaling_of_equal_steps_on_a_line():
    # Dissimilarities in proportion to their ranks, so that ranks lose nothing: 0, 1, 3 on a line are found exactly.
    found = torgerson_configuration(named([1, 3, 2], 3), 2)
    assert pdist(found) == pytest.approx(np.array([1, 3, 2]) / 3, abs=1e-12)
    assert np.allclose(found[:, 1], 0, atol=1e-7)  # the root of a rounding error of 1e-15


def test_projections_see_the_plane_from_directions_all_around():
    data = named(np.random.default_rng(0).uniform(1, 9, 10), 5)
    plane = torgerson_configuration(data, 2)
    along, across = torgerson_projections(data, 2)
    assert along[:, 0] == pytest.approx(plane[:, 0], abs=1e-12)  # rounding of the rotation
    assert across[:, 0] == pytest.approx(plane[:, 1], abs=1e-12)
