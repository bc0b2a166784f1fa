"""A gloss space from judgements."""

import numpy as np
import pandas as pd
import pytest

from gloss_analysis.dissimilarity import Dissimilarities
from gloss_analysis.fit import fit_gloss_space, rated_along
from glossspace.errors import GlossError
from glossspace.metric import GlossSpace
from tests.analysis.studies import EXPERIMENT_1, axis_values, judged_by


def pairs(ratios):
    judged = judged_by(ratios)
    return Dissimilarities(tuple(EXPERIMENT_1["stimulus"]), judged.participants, judged.values)


def ratings(axis):
    values = 10 + 50 * axis_values()[:, axis]
    return pd.DataFrame({"participant_id": "1", "stimulus": EXPERIMENT_1["stimulus"], "repeat": 1, "rating": values})


def test_a_noise_free_study_gives_its_metric_back_and_survives_the_file(tmp_path):
    fitted = fit_gloss_space(EXPERIMENT_1, pairs([1.5, 1.78, 2.1]), {"c": ratings(0), "d": ratings(1)})
    assert fitted.space.weight_d == pytest.approx((1.5 * 1.78 * 2.1) ** (1 / 3), rel=5e-3)  # the play that order leaves
    for axis in ("c", "d"):
        function = fitted.space.axis_functions[axis]
        assert (function.slope, function.intercept) == pytest.approx((50, 10), rel=1e-9)
        assert function.r_squared == pytest.approx(1, abs=1e-12)
    assert fitted.space.stimulus_range == {"rho_d": (0.03, 0.767), "rho_s": (0.033, 0.099), "alpha": (0.04, 0.10)}
    fitted.space.save(tmp_path / "gloss-space.json")
    assert GlossSpace.load(tmp_path / "gloss-space.json") == fitted.space


def test_pairs_alone_give_weights_without_axis_functions():
    assert fit_gloss_space(EXPERIMENT_1, pairs([2.0]), {}).space.axis_functions == {}


def test_a_judged_stimulus_without_parameters_is_named():
    with pytest.raises(GlossError, match="The stimulus 's26' was judged, but its rho_d, rho_s and alpha are not known"):
        fit_gloss_space(EXPERIMENT_1.iloc[:-1], pairs([2.0]), {})


def test_ratings_stand_beside_their_coordinates():
    rated = rated_along(EXPERIMENT_1, ratings(1).sample(frac=1, random_state=0))
    expected = dict(zip(EXPERIMENT_1["stimulus"], axis_values()[:, 1], strict=True))
    assert rated["d"].tolist() == pytest.approx([expected[name] for name in rated["stimulus"]], rel=1e-12)
    assert np.allclose(rated["rating"], 10 + 50 * rated["d"])
