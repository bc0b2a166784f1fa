"""The spheres of figure 12: same physical gloss, same apparent gloss."""

import numpy as np
import pytest

from gloss_stimuli.matched_spheres import matched_spheres
from glossspace.errors import GlossError
from glossspace.metric import ContrastForm, GlossSpace, Paint


def test_the_papers_spheres():
    # Section 5.2: rho_s = .099, alpha = .04 on white, gray and black; then c = .057 (truncated, .0578), d = .96. Eq. 7.
    matched = matched_spheres()
    physical = matched.table[matched.table["same_physical"]]
    assert physical[["rho_d", "rho_s", "alpha"]].to_numpy().tolist() == [
        [0.767, 0.099, 0.04], [0.193, 0.099, 0.04], [0.03, 0.099, 0.04]
    ]  # fmt: skip
    apparent = matched.table[matched.table["same_apparent"]].sort_values("rho_d", ascending=False)
    c = np.cbrt(0.099 + 0.767 / 2) - np.cbrt(0.767 / 2)
    for rho_d, row in zip((0.767, 0.193, 0.03), apparent.itertuples(), strict=True):
        assert (row.rho_d, row.alpha) == (rho_d, 0.04)
        # six digits of rho_s
        assert row.rho_s == pytest.approx((c + np.cbrt(rho_d / 2)) ** 3 - rho_d / 2, rel=5e-6)
        assert row.distance == pytest.approx(0, abs=1e-6)
    assert apparent["c"].to_numpy() == pytest.approx(0.0578, abs=5e-5)
    assert len(matched.stimuli.stimuli) == 5  # the white one is in both rows
    # black looks glossiest, white least: what the top row shows
    assert physical["c"].is_monotonic_increasing
    assert matched.remarks == ()


def test_a_space_with_another_form_matches_by_its_own():
    space = GlossSpace(contrast_form=ContrastForm(exponent=1.0))  # c = rho_s: nothing to be changed
    matched = matched_spheres(space)
    assert [s.rho_s for s in matched.stimuli.stimuli] == [0.099] * 3
    assert matched.table["same_apparent"].all()


def test_a_lightness_that_cannot_be_so_glossy_is_said():
    # White reaches c = cbrt(.233 + .3835) - cbrt(.3835) = .125; black with rho_s = .099 has .238.
    matched = matched_spheres(reference=Paint(0.03, 0.099, 0.04))
    assert matched.remarks == (
        "No paint of rho_d = 0.767 is as glossy as the reference: it would reflect more than it receives. Its place in "
        "the lower row stays empty.",
    )
    assert set(matched.table.loc[matched.table["same_apparent"], "rho_d"]) == {0.193, 0.03}


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"rho_ds": []}, "Invalid diffuse reflectances"),
        ({"rho_ds": [0.2, 0.2]}, "one or several different ones"),
        ({"rho_ds": [0.95]}, "rho_d \\+ rho_s must be at most 1"),
        ({"rho_ds": [float("nan")]}, "rho_d must be a finite number"),
        ({"reference": Paint(0.767, 0.099, -1.0)}, "alpha must be above 0"),
    ],
)
def test_mistakes(options, message):
    with pytest.raises(GlossError, match=message):
        matched_spheres(**options)
