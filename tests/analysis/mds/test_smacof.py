"""The majorization twin: its step against a closed form, and what it refuses."""

import numpy as np
import pytest

from gloss_analysis.mds.smacof import smacof
from glossspace.errors import GlossError
from tests.analysis.studies import named

START = np.array([[0.0, 0.0], [1.0, 0.2], [0.3, 1.0], [1.4, 1.1]])


def test_a_step_is_the_guttman_transform():
    # One step of one source in the identity model, by the definition: x_i <- sum_j dhat_ij (x_i - x_j) / d_ij / n, up
    # to scale (Borg and Groenen 2005, equation 8.25). At ratio level dhat is proportional to delta.
    delta = np.array([1.0, 2.0, 3.0, 2.5, 1.5, 1.0])
    square = np.zeros((4, 4))
    square[np.triu_indices(4, 1)] = delta
    square += square.T
    difference = START[:, np.newaxis] - START
    distance = np.linalg.norm(difference, axis=2) + np.eye(4)
    expected = np.sum((square / distance)[:, :, np.newaxis] * difference, axis=1)
    result = smacof(named(delta, 4), start=START, model="identity", level="ratio", max_steps=1)
    found = result.coordinates
    assert len(result.stress1_by_step) == 2  # before the step and after it
    assert found / np.linalg.norm(found) == pytest.approx(expected / np.linalg.norm(expected), abs=1e-12)


@pytest.mark.parametrize(
    ("values", "start", "message"),
    [
        ([[1, 2, 3, 4, 5, np.nan]], START, "needs complete data"),
        ([[1, 2, 3, 4, 5, 6], [0] * 6], START, "A participant judged all pairs 0"),
        ([[1, 2, 3, 4, 5, 6]], START * [1, 0], "finite and different in every dimension"),
        ([[1, 2, 3, 4, 5, 6]], START[:3], "must place 4 points"),
    ],
)
def test_what_it_cannot_do_is_refused(values, start, message):
    with pytest.raises(GlossError, match=message):
        smacof(named(values, 4), start=start, level="ratio")
