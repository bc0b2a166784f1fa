"""A gloss space from judgements."""

import numpy as np
import pandas as pd
import pytest

from gloss_analysis.axis_functions.coordinates import axis_coordinates, rated_along
from gloss_analysis.axis_functions.rating_fit import fit_ratings
from gloss_analysis.fit import fit_axis_functions, fit_gloss_space
from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.ratings.magnitude import mean_ratings
from glossspace.errors import GlossError
from glossspace.metric import ContrastForm, GlossSpace, Paint
from tests.analysis.studies import CONTRAST, DOI, EXPERIMENT_1, axis_values, judged_by


def pairs(ratios):
    judged = judged_by(ratios)
    return Dissimilarities(tuple(EXPERIMENT_1["stimulus"]), judged.participants, judged.values)


def same_order(ratio):
    """Lowest and highest weight of d that order the pairs' distances as `ratio` does.

    Two pairs change places where dc1^2 + w^2 dd1^2 = dc2^2 + w^2 dd2^2. Between two such weights all judgements keep
    their order, so that ordinal data cannot tell the weights in between apart.
    """
    first, second = np.triu_indices(len(EXPERIMENT_1), 1)
    squared = (axis_values()[first] - axis_values()[second]) ** 2
    dc, dd = np.moveaxis(squared[:, np.newaxis] - squared, -1, 0)
    crossing = (np.abs(dd) > 1e-15) & (dc * dd < 0)
    weights = np.sqrt(-dc[crossing] / dd[crossing])
    return weights[weights < ratio].max(), weights[weights > ratio].min()


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


def test_order_gives_the_weight_of_the_paper_as_far_as_it_determines_it():
    low, high = same_order(1.78)
    assert high - low == pytest.approx(0.01, abs=1e-4)
    assert low < fit_gloss_space(EXPERIMENT_1, pairs([1.78]), {}).space.weight_d < high


def test_at_ratio_level_nothing_is_left_open():
    fitted = fit_gloss_space(EXPERIMENT_1, pairs([1.78, 1.78]), {}, level="ratio")
    assert fitted.space.weight_d == pytest.approx(1.78, abs=1e-6)
    assert fitted.space.weight_d_ci95 == pytest.approx((1.78, 1.78), abs=1e-6)


def test_ratings_alone_leave_the_weight_of_the_paper(tmp_path):
    fitted = fit_axis_functions(EXPERIMENT_1, {"d": ratings(1)}, provenance={"observers": ["1"]})
    function = fitted.space.axis_functions["d"]
    assert (function.slope, function.intercept) == pytest.approx((50, 10), rel=1e-9)
    assert (fitted.space.weight_c, fitted.space.weight_d, fitted.space.weight_d_ci95) == (1, 1.78, None)
    assert fitted.space.provenance["weight_d_fitted"] is False
    assert fitted.space.provenance["sources"] == ["magnitudes"]
    assert fitted.space.provenance["observers"] == ["1"]
    fitted.space.save(tmp_path / "gloss-space.json")
    assert GlossSpace.load(tmp_path / "gloss-space.json") == fitted.space


def test_nothing_and_unknown_axes_are_refused():
    with pytest.raises(GlossError, match="There are no ratings"):
        fit_axis_functions(EXPERIMENT_1, {})
    with pytest.raises(GlossError, match="Ratings along 'gloss' are not known. Allowed: c or d."):
        fit_axis_functions(EXPERIMENT_1, {"gloss": ratings(0)})


def test_what_ratings_leave_open_is_said():
    table = ratings(0)
    dark = table[EXPERIMENT_1["rho_d"] == 0.03]
    flat = dark.assign(participant_id="2", rating=40.0)
    falling = dark.assign(rating=100 - dark["rating"])
    for rated, expected in (
        (table, ["differ in d too"]),
        (dark, ["differ in d too", "one lightness (rho_d 0.03)"]),
        (falling, ["Was the scale reversed?", "differ in d too", "one lightness"]),
        (pd.concat([dark, flat]), ["participant 2: constant: every rating is 40.", "differ in d too", "one lightness"]),
    ):
        said = fit_axis_functions(EXPERIMENT_1, {"c": rated}).warnings[1:]
        assert len(said) == len(expected)
        assert all(part in one for part, one in zip(expected, said, strict=True))


def test_pairs_of_one_lightness_are_said_and_of_one_c_refused():
    names = EXPERIMENT_1["stimulus"].tolist()
    judged = pairs([1.78, 2.0])
    first, second = judged.pairs

    def among(n):
        return Dissimilarities(tuple(names[:n]), judged.participants, judged.values[:, (first < n) & (second < n)])

    assert any(
        "judged in pairs have one lightness" in one for one in fit_gloss_space(EXPERIMENT_1, among(9), {}).warnings
    )
    assert fit_gloss_space(EXPERIMENT_1, judged, {}).warnings == ()
    with pytest.raises(GlossError, match="have the same c, .*Judge pairs that differ in rho_d and rho_s too"):
        fit_gloss_space(EXPERIMENT_1, among(3), {})


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


class TestAnotherScene:
    """Simulated judgements of a scene whose gloss has other axis functions than the paper's."""

    SPACE = GlossSpace(weight_d=0.9, contrast_form=ContrastForm(exponent=0.6, diffuse_share=0.2))
    PAINTS = pd.concat([EXPERIMENT_1, CONTRAST])

    def judged(self, space):
        names = list(EXPERIMENT_1["stimulus"])
        c, d = axis_coordinates(self.PAINTS, names, space)[["c", "d"]].to_numpy().T
        first, second = np.triu_indices(len(names), 1)
        distance = space.distance_between(c[first], d[first], c[second], d[second])
        return Dissimilarities(tuple(names), ("simulated-1", "simulated-2"), np.tile(distance, (2, 1)))

    def rated(self):
        values = 10 + 200 * self.SPACE.contrast_form.value(CONTRAST["rho_d"], CONTRAST["rho_s"])
        return pd.DataFrame({"participant_id": "simulated-1", "stimulus": CONTRAST["stimulus"], "rating": values})

    def test_its_axis_functions_and_weight_are_found_and_used(self, tmp_path):
        fitted = fit_gloss_space(self.PAINTS, self.judged(self.SPACE), {"c": self.rated()}, level="ratio")
        fitted.space.save(tmp_path / "space.json")
        space = GlossSpace.load(tmp_path / "space.json")
        assert space == fitted.space
        # 1e-4: what the search leaves of the exponent (see test_axis_forms) goes over into the unit of c
        assert space.weight_d == pytest.approx(0.9, rel=1e-4)
        one, other = Paint(0.1, 0.05, 0.05), Paint(0.4, 0.08, 0.09)
        assert space.distance(one, other) == pytest.approx(self.SPACE.distance(one, other), rel=1e-4)
        taken = [row for row in space.provenance["forms"]["c"] if row["taken"]]
        assert [row["free"] for row in taken] == [["exponent", "diffuse_share"]]

    def test_without_pairs_the_paper_s_weight_is_said_to_be_in_other_units(self):
        fitted = fit_axis_functions(self.PAINTS, {"c": self.rated()})
        assert fitted.space.contrast_form.exponent == pytest.approx(0.6, rel=1e-3)
        assert any("these have other units: judge pairs" in warning for warning in fitted.warnings)

    def test_pairs_that_follow_the_paper_keep_its_form_however_curved_the_ratings(self):
        fitted = fit_gloss_space(self.PAINTS, self.judged(GlossSpace()), {"c": self.rated()}, level="ratio")
        assert fitted.space.has_paper_forms
        assert "stress of the judged pairs would rise" in fitted.forms["c"].sentence
        assert fitted.space.weight_d == pytest.approx(1.78, abs=1e-6)

    def test_the_paper_s_forms_can_be_asked_for(self):
        fitted = fit_gloss_space(self.PAINTS, self.judged(self.SPACE), {"c": self.rated()}, forms="paper")
        assert fitted.space.has_paper_forms
        assert len(fitted.forms["c"].candidates) == 1


def test_line_and_intervals_are_those_of_the_form_that_was_taken():
    """Ratings 300 (1 - sqrt(alpha)) - 200 and noise of .2; slope and intercept by polyfit on the form found."""
    rng = np.random.default_rng(3)
    given = 100 - 300 * np.sqrt(DOI["alpha"].to_numpy())
    table = pd.concat(
        pd.DataFrame({"participant_id": str(k), "stimulus": DOI["stimulus"], "rating": given + 0.2 * noise})
        for k, noise in enumerate(rng.standard_normal((5, len(DOI))))
    )
    found = fit_ratings(DOI, {"d": table})
    function, form = found.space.axis_functions["d"], found.space.distinctness_form
    assert form.exponent == pytest.approx(0.5, abs=0.02)  # noise
    rating = mean_ratings(table).set_index("stimulus").loc[DOI["stimulus"], "rating"]
    slope, intercept = np.polyfit(form.value(DOI["alpha"].to_numpy()), rating, 1)
    assert (function.slope, function.intercept) == pytest.approx((slope, intercept), rel=1e-9)  # rounding
    assert function.slope_ci95[0] < slope < function.slope_ci95[1]
    assert function.intercept_ci95[0] < intercept < function.intercept_ci95[1]
