"""Section 5.2 and figure 12 of the gloss paper."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from glossspace.errors import GlossError
from glossspace.metric import PAPER_SPACE, Paint, contrast_gloss, match_gloss

WHITE = Paint(0.767, 0.099, 0.04)


def test_bottom_row_of_figure_12():
    """White, gray and black with the c of the white sphere: eq. 7 by hand with c = .0578."""
    matched = match_gloss(WHITE, rho_d=[0.767, 0.193, 0.03])
    c = contrast_gloss(*WHITE[:2])
    by_hand = [(c + np.cbrt(rho_d / 2)) ** 3 - rho_d / 2 for rho_d in (0.767, 0.193, 0.03)]
    # The plain form of eq. 7 cancels at most one digit here.
    assert matched.rho_s == pytest.approx(by_hand, rel=1e-13)
    assert matched.alpha.tolist() == [0.04] * 3


@given(st.floats(0, 1), st.floats(0, 1), st.floats(1e-3, 1), st.floats(0, 1))
def test_a_match_looks_the_same_or_is_out_of_reach(rho_d, share, alpha, target):
    reference = Paint(rho_d, share * (1 - rho_d), alpha)
    matched = match_gloss(reference, rho_d=target, out_of_reach="mask")
    highest = contrast_gloss(target, 1 - target)
    c = contrast_gloss(*reference[:2])
    if np.isnan(matched.rho_s):
        assert np.isnan(matched.alpha)
        assert c > highest
        with pytest.raises(GlossError, match="is out of reach for rho_d = "):
            match_gloss(reference, rho_d=target)
    else:
        assert c <= highest + 1e-4  # rho_s may exceed by 1e-12, whose cube root is 1e-4
        assert matched == match_gloss(reference, rho_d=target)
        assert matched.alpha == alpha
        # On black rho_s = c^3 underflows below 1e-100.
        assert contrast_gloss(*matched[:2]) == pytest.approx(c, rel=1e-12, abs=1e-100)
        assert PAPER_SPACE.distance(reference, matched) == pytest.approx(0, abs=1e-12)


@given(st.floats(0, 1), st.floats(0, 1))
def test_a_paint_matches_itself_up_to_the_envelope(rho_d, share):
    reference = Paint(rho_d, share * (1 - rho_d), 0.07)
    # c of black resolves rho_s to 1e-12; where it underflows, absolutely
    assert match_gloss(reference, rho_d=rho_d).rho_s == pytest.approx(reference.rho_s, rel=1e-12, abs=1e-300)
    full = Paint(rho_d, 1 - rho_d, 0.07)
    assert match_gloss(full, rho_d=rho_d).rho_s == pytest.approx(1 - rho_d, rel=1e-12)


def test_the_caller_chooses_mask_or_error():
    black = Paint(0.03, 0.099, 0.04)
    masked = match_gloss(black, rho_d=[0.03, 0.193, 0.9, np.nan], out_of_reach="mask")
    assert masked.rho_d == pytest.approx([0.03, 0.193, 0.9, np.nan], nan_ok=True)
    assert np.isfinite(masked.rho_s).tolist() == [True, True, False, False]
    assert np.isfinite(masked.alpha).tolist() == [
        True,
        True,
        False,
        True,
    ]  # of an unknown lightness alpha is still known
    with pytest.raises(
        GlossError,
        match=r"^Contrast gloss c = 0\.238\d+ is out of reach for rho_d = 0\.9, which allows at most 0\.0530\d+\. "
        r"Choose a darker paint",
    ):
        match_gloss(black, rho_d=[0.03, 0.193, 0.9, np.nan])


def test_references_and_targets_broadcast():
    references = Paint(np.array([[0.767], [0.193]]), np.array([[0.099], [0.066]]), 0.04)
    matched = match_gloss(references, rho_d=[0.03, 0.1, 0.2])
    assert [value.shape for value in matched] == [(2, 3)] * 3
    assert matched.rho_s[0, 0] == match_gloss(WHITE, rho_d=0.03).rho_s


def test_scalars_give_floats():
    assert all(isinstance(value, float) for value in match_gloss(WHITE, rho_d=0.03))
    assert all(isinstance(value, float) for value in match_gloss(WHITE, rho_d=0.03, out_of_reach="mask"))


@pytest.mark.parametrize(
    ("reference", "options", "message"),
    [
        (WHITE, {"rho_d": -0.1}, r"^Invalid rho_d = -0\.1\."),
        (WHITE, {"rho_d": 1.5, "out_of_reach": "mask"}, r"^Invalid rho_d = 1\.5\."),
        (
            WHITE,
            {"rho_d": 0.1, "out_of_reach": "clip"},
            r"^Invalid out_of_reach = 'clip'\. Allowed: 'raise' and 'mask'",
        ),
        (WHITE._replace(alpha=0), {"rho_d": 0.1}, r"^Invalid alpha = 0\.0\."),
        (WHITE._replace(rho_s=0.5), {"rho_d": 0.1}, r"^Invalid rho_d \+ rho_s = 1\.267\."),
        (WHITE._replace(alpha=[0.1, 0.2]), {"rho_d": [0.1, 0.2, 0.3]}, r"wanted_rho_d \(3,\)"),
        (WHITE, {"rho_d": None}, r"^wanted_rho_d must be a number"),
    ],
    ids=repr,
)
def test_impossible_input_is_refused_by_value(reference, options, message):
    with pytest.raises(GlossError, match=message):
        match_gloss(reference, **options)
