"""The range that the gloss paper vouches for."""

import numpy as np
import pytest

from glossspace.errors import GlossError
from glossspace.metric import PAPER_ALPHA_LIMIT, within_paper_range


def test_the_limit_is_that_of_section_4():
    """Section 4: "the alpha value should not be much larger than 0.2"."""
    assert PAPER_ALPHA_LIMIT == 0.2
    assert within_paper_range([0.01, 0.2, np.nextafter(0.2, 1), 0.3, 5, np.nan]).tolist() == [
        True, True, False, False, False, False,
    ]  # fmt: skip


@pytest.mark.parametrize("alpha", [0.0, -1.0, np.inf])
def test_impossible_roughness_is_refused(alpha):
    with pytest.raises(GlossError, match=f"^Invalid alpha = {alpha}"):
        within_paper_range([0.1, alpha])
