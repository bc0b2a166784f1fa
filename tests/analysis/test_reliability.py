"""Consistency of participants, against sums done by hand."""

import numpy as np
import pandas as pd
import pytest

from gloss_analysis.judgements.reliability import reliability

COLUMNS = ["participant_id", "stimulus_a", "stimulus_b", "dissimilarity"]


def test_identical_pairs_and_repeats_in_either_order():
    rows = [
        ("7", "a", "b", 4), ("7", "b", "a", 6), ("7", "a", "c", 9), ("7", "c", "a", 11), ("7", "b", "c", 1),
        ("7", "c", "b", 5), ("7", "a", "a", 0), ("7", "b", "b", 3), ("3", "a", "b", 2), ("3", "a", "c", np.nan),
    ]  # fmt: skip
    seven, three = reliability(pd.DataFrame(rows, columns=COLUMNS))
    assert (seven.participant_id, three.participant_id) == ("7", "3")
    assert (seven.n_identical, seven.identical_mean, seven.largest) == (2, 1.5, 11)
    assert seven.n_repeated_pairs == 3
    # Squares about the means: 2, 2 and 8, with one degree of freedom each.
    assert seven.repeat_sd == pytest.approx(2)
    assert seven.retest_correlation == pytest.approx(np.corrcoef([4, 9, 1], [6, 11, 5])[0, 1], rel=1e-12)
    assert three.n_repeated_pairs == 0
    assert np.isnan([three.repeat_sd, three.retest_correlation, three.identical_mean]).all()
