"""Judgements of six simulated participants who differ, and their solution."""

import pytest

from gloss_analysis.mds import scale
from tests.analysis.studies import RATIOS_OF_SIX, judged_by


@pytest.fixture(scope="module")
def noisy():
    data = judged_by(RATIOS_OF_SIX, noise_sd=8, integers=True)
    return data, scale(data, n_dims=2, n_starts=20)
