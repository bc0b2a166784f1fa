"""What a participant's judgements are worth, by level of measurement."""

import numpy as np
import pytest

from gloss_analysis.mds.diagnostics import data_warnings, informs
from tests.analysis.studies import named


@pytest.mark.parametrize(
    ("values", "level", "ties", "expected"),
    [
        ([1, 2, 2], "ordinal", "primary", True),
        ([5, 5, 5], "ordinal", "primary", False),  # untied, they fit any configuration
        ([5, 5, 5], "ordinal", "secondary", True),  # they ask for equal distances
        ([0, 0, 0], "ordinal", "secondary", True),  # and order knows no zero
        ([0, 0, 0], "interval", "primary", True),
        ([0, 0, 0], "ratio", "primary", False),  # no configuration fits
        ([5, 5, np.nan], "ratio", "primary", True),
        ([np.nan] * 3, "interval", "primary", False),
    ],
)
def test_what_judgements_say_about_distances(values, level, ties, expected):
    assert informs(np.array(values, dtype=float), level=level, ties=ties) is expected


def test_participants_are_named_by_what_they_lack():
    values = [[1, 2, 3], [5, 5, 5], [np.nan, np.nan, np.nan]]
    remarks = data_warnings(named(values, 3), level="ratio", ties="primary")
    assert [remark.split(":")[0] for remark in remarks] == [
        "These participants judged no pair and are not counted",
        "These participants distinguished no pairs",
    ]
    assert "add nothing" in data_warnings(named(values, 3), level="ordinal", ties="primary")[1]
