"""Figure 11 of the gloss paper."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from glossspace.errors import GlossError
from glossspace.metric import PAPER_SPACE, GlossSpace, Paint, isogloss_contour

GRAY = Paint(0.193, 0.066, 0.07)

paints = st.builds(
    lambda rho_d, share, alpha: Paint(rho_d, share * (1 - rho_d), alpha),
    st.floats(0, 1), st.floats(0, 1), st.floats(1e-3, 0.5),
)  # fmt: skip
radii = st.floats(1e-3, 2)


@pytest.mark.parametrize("radius", [0.04, 0.08])
def test_radii_of_figure_11(radius):
    """Section 5.1: dc = 0.04 against dd = 0.04/1.78 = 0.0225 (printed 0.22, a misprint)."""
    contour = isogloss_contour(GRAY, radius=radius, n=4)
    c, d = PAPER_SPACE.coordinates(GRAY)
    # 1e-15: one rounding of a number near 1
    assert contour.c - c == pytest.approx([radius, 0, -radius, 0], abs=1e-15)
    assert contour.d - d == pytest.approx([0, radius / 1.78, 0, -radius / 1.78], abs=1e-15)
    assert round(0.04 / 1.78, 4) == 0.0225
    assert contour.reachable.all()


@given(paints, radii, st.floats(0, 1), st.floats(0.1, 10), st.floats(0.1, 10))
def test_every_paint_of_the_contour_has_the_stated_distance(reference, radius, rho_d, weight_c, weight_d):
    space = GlossSpace(weight_c=weight_c, weight_d=weight_d)
    contour = isogloss_contour(reference, radius=radius, rho_d=rho_d, n=24, space=space)
    real = contour.reachable
    again = space.distance(reference, Paint(contour.rho_d, contour.rho_s[real], contour.alpha[real]))
    # Coordinates near 1 round to 1e-16; times a weight of 10, over a radius of 1e-3: 1e-12.
    assert again == pytest.approx(radius, rel=1e-11)


@given(paints, radii, st.floats(0, 1))
def test_unreachable_is_exactly_where_no_paint_exists(reference, radius, rho_d):
    contour = isogloss_contour(reference, radius=radius, rho_d=rho_d, n=24)
    # Eqs 7 and 8 as printed: is the paint they ask for possible?
    half = rho_d / 2
    rho_s = (contour.c + np.cbrt(half)) ** 3 - half
    excess = np.maximum.reduce([-contour.c, contour.d - 1, rho_d + rho_s - 1])
    clear = np.abs(excess) > 1e-9  # a point on a border may fall either side by rounding
    np.testing.assert_array_equal(contour.reachable[clear], (excess < 0)[clear])
    np.testing.assert_array_equal(np.isfinite(contour.rho_s) & np.isfinite(contour.alpha), contour.reachable)


def test_each_border_of_the_space_is_marked():
    mirror_side = isogloss_contour(GRAY, radius=0.2, n=4)
    assert mirror_side.reachable.tolist() == [True, False, False, True]  # d = 1.04; c = -.11
    white = isogloss_contour(Paint(0.767, 0.22, 0.07), radius=0.04, n=4)
    assert white.reachable.tolist() == [False, True, True, True]  # rho_d + rho_s > 1


@pytest.mark.parametrize("rho_d", [0.0, 0.193, 1.0])
def test_a_paint_without_gloss_keeps_its_twelve_and_six_o_clock(rho_d):
    """On the border c = 0 the cosine of 90 and 270 degrees must be zero, not minus 1e-16."""
    contour = isogloss_contour(Paint(rho_d, 0.0, 0.07), radius=0.04, n=4)
    assert contour.reachable.tolist() == [rho_d < 1, True, False, True]
    assert contour.rho_s[[1, 3]].tolist() == [0, 0]


def test_a_perfect_mirror_is_no_paint():
    contour = isogloss_contour(Paint(0.0, 0.5, 0.5), radius=0.5, n=4, space=GlossSpace(weight_d=1.0))
    assert contour.d[1] == 1  # alpha = 0: Ward's lobe has no width
    assert not contour.reachable[1]


def test_roughness_beyond_the_paper_is_flagged():
    contour = isogloss_contour(Paint(0.193, 0.066, 0.19), radius=0.04, n=4)
    assert contour.within_paper_range.tolist() == [True, True, True, False]
    assert contour.alpha[3] == pytest.approx(0.19 + 0.04 / 1.78, rel=1e-14)
    assert not isogloss_contour(GRAY, radius=0.2, n=4).within_paper_range[1]  # no paint at all


def test_another_lightness_keeps_the_coordinates():
    own, black = isogloss_contour(GRAY, radius=0.04), isogloss_contour(GRAY, radius=0.04, rho_d=0.03)
    np.testing.assert_array_equal(own.c, black.c)
    np.testing.assert_array_equal(own.d, black.d)
    assert own.rho_d == 0.193
    assert black.rho_d == 0.03
    assert np.all(black.rho_s < own.rho_s)


def test_default_is_one_point_a_degree():
    np.testing.assert_array_equal(isogloss_contour(GRAY, radius=0.04).angle_deg, np.arange(360))


def test_nan_gives_nan_and_nothing_reachable():
    contour = isogloss_contour(Paint(0.193, np.nan, 0.07), radius=0.04, n=4)
    assert np.isnan(contour.c).all()
    assert not contour.reachable.any()
    assert not isogloss_contour(GRAY, radius=0.04, rho_d=np.nan, n=4).reachable.any()


def test_a_huge_radius_reaches_nothing_but_rough_paints():
    contour = isogloss_contour(GRAY, radius=1e200, n=8)
    assert contour.reachable.tolist() == [False] * 6 + [True, False]
    assert not contour.within_paper_range.any()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"radius": 0}, r"^Invalid radius = 0\.0\. Allowed: finite and > 0\.$"),
        ({"radius": -1}, r"^Invalid radius = -1\.0\."),
        ({"radius": np.inf}, r"^Invalid radius = inf\."),
        ({"radius": np.nan}, r"^Invalid radius = nan\."),
        ({"radius": "wide"}, r"^radius must be a number"),
        ({"radius": [0.04, 0.08]}, r"^One contour needs one value of radius, but got 2\."),
        ({"radius": 1e308, "space": GlossSpace(weight_d=0.1)}, r"^Invalid radius = 1e\+308\."),
        ({"n": 2}, r"^Invalid n = 2\. Allowed: a whole number of points, 3 to 1000000\.$"),
        ({"n": 10**12}, r"^Invalid n = 1000000000000\."),
        ({"n": 4.5}, r"^Invalid n = 4\.5\."),
        ({"n": True}, r"^Invalid n = True\."),
        ({"rho_d": -0.1}, r"^Invalid rho_d = -0\.1\."),
        ({"rho_d": 1.1}, r"^Invalid rho_d = 1\.1\."),
        ({"reference": Paint([0.1, 0.2], 0.1, 0.1)}, r"^One contour needs one value of rho_d, but got 2\."),
        ({"reference": Paint(0.1, 0.95, 0.1)}, r"^Invalid rho_d \+ rho_s = "),
        ({"reference": Paint(0.1, 0.1, 0.0)}, r"^Invalid alpha = 0\.0\."),
    ],
    ids=repr,
)
def test_impossible_input_is_refused_by_value(options, message):
    with pytest.raises(GlossError, match=message):
        isogloss_contour(**{"reference": GRAY, "radius": 0.04, **options})
