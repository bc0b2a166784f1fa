"""The ring of figure 11: which paints it holds, and what it says of those it cannot hold."""

import numpy as np
import pytest

from gloss_stimuli.isogloss_ring import isogloss_ring
from glossspace.errors import GlossError
from glossspace.metric import ContrastForm, GlossSpace, Paint

# rho_s and alpha are rounded to six digits: an error of at most 5e-7 in each. dc/drho_s is below 2 on these grays, and
# d counts less than 4 times.
ROUNDED = 2e-6


def test_the_papers_ring():
    # Section 5.1: c = .087, d = .93; dc = .04 and dd = .04 / 1.78 (printed .22) for the inner contour. Eqs 3 and 7 give
    # the paints of the points at 3, 12, 9 and 6 o'clock.
    ring = isogloss_ring(n=4)
    c = np.cbrt(0.066 + 0.193 / 2) - np.cbrt(0.193 / 2)
    expected = [(0.066, 0.07)]
    for radius in (0.04, 0.08):
        for towards_c, towards_d in ((radius, 0), (0, radius), (-radius, 0), (0, -radius)):
            rho_s = (c + towards_c + np.cbrt(0.193 / 2)) ** 3 - 0.193 / 2
            expected.append((rho_s, 0.07 - towards_d / 1.78))
    assert [(s.rho_s, s.alpha) for s in ring.stimuli.stimuli] == [pytest.approx(one, abs=5e-7) for one in expected]
    assert {s.rho_d for s in ring.stimuli.stimuli} == {0.193}
    assert ring.table["c"][0] == pytest.approx(0.087, abs=5e-4)  # as printed
    assert ring.table["d"][0] == pytest.approx(0.93)
    assert ring.table["angle_deg"].tolist()[1:] == [0, 90, 180, 270] * 2
    assert ring.remarks == ()


@pytest.mark.parametrize(
    "space", [GlossSpace(), GlossSpace(weight_d=3.5), GlossSpace(contrast_form=ContrastForm(exponent=0.5, offset=0.01))]
)
def test_every_paint_lies_on_its_contour(space):
    ring = isogloss_ring(space, reference=Paint(0.193, 0.05, 0.08), radii=[0.03, 0.05], n=12)
    own = space.coordinates(ring.reference)
    for stimulus, row in zip(ring.stimuli.stimuli, ring.table.itertuples(), strict=True):
        c, d = space.coordinates(Paint(stimulus.rho_d, stimulus.rho_s, stimulus.alpha))
        apart = np.array([space.weight_c * (c - own[0]), space.weight_d * (d - own[1])])
        assert np.hypot(*apart) == pytest.approx(row.radius, abs=ROUNDED)
        assert row.distance == pytest.approx(row.radius, abs=ROUNDED)
        if row.radius:
            angle = np.degrees(np.arctan2(apart[1], apart[0])) % 360
            # an error of ROUNDED sideways, at the smaller radius
            assert (angle - row.angle_deg + 180) % 360 - 180 == pytest.approx(0, abs=np.degrees(ROUNDED / 0.03))
    assert len(ring.stimuli.stimuli) == 25


def test_points_mirrored_at_the_axis_of_c_share_their_roughness():
    # Per contour four beside the reference's own, which 3 and 9 o'clock have: 12, 6, and two pairs between.
    ring = isogloss_ring(n=8)
    assert len(ring.stimuli.stimuli) == 17
    assert len({s.alpha for s in ring.stimuli.stimuli}) == 1 + 2 * 4


def test_points_that_no_paint_reaches_are_left_out_and_said():
    ring = isogloss_ring(reference=Paint(0.193, 0.01, 0.02), n=4)
    # c = .0154 there, so that c - .04 < 0; d = .98, so that d + .04 / 1.78 > 1.
    assert len(ring.stimuli.stimuli) == 1 + 8 - 4
    assert ring.remarks[0] == (
        "4 of 8 points are left out, since no paint of rho_d = 0.193 reaches them: 90° at 0.04, 180° at 0.04, 90° at "
        "0.08, 180° at 0.08."
    )
    assert set(ring.table["angle_deg"][1:]) == {0, 270}


def test_a_paint_at_the_limit_of_energy_stays_a_paint():
    # c of a paint that reflects everything, .0333... beyond the reference's: rounding rho_s upwards would be too much.
    limit = 1 - np.cbrt(0.5 / 2) + (np.cbrt(0.5 + 0.25) - 1)
    own = np.cbrt(0.3 + 0.25) - np.cbrt(0.25)
    ring = isogloss_ring(reference=Paint(0.5, 0.3, 0.1), radii=[(limit - own) * (1 - 1e-9)], n=4)
    assert ring.stimuli.stimuli[1].rho_s == pytest.approx(0.5, abs=1e-6)
    assert all(s.rho_d + s.rho_s <= 1 for s in ring.stimuli.stimuli)


def test_what_lies_beyond_the_paper_or_the_study_is_said():
    space = GlossSpace(name="ours", stimulus_range={"rho_s": (0.017, 0.099), "alpha": (0.01, 0.19)})
    ring = isogloss_ring(space, reference=Paint(0.193, 0.066, 0.15), radii=[0.1], n=4)
    left_out, rough, beyond = ring.remarks
    assert left_out.startswith("1 of 4 points are left out")  # c = .087 - .1
    assert rough == "alpha is above 0.2, beyond what the gloss paper covers: d0.193_s0.066_a0.20618."
    assert beyond.startswith("2 of 4 paints lie beyond the stimuli that 'ours' was fitted to, where it extrapolates: ")


def test_a_space_of_simulated_observers_is_called_so():
    space = GlossSpace(name="ours", provenance={"observers": ["01 (simulated)"]})
    assert isogloss_ring(space).stimuli.title.endswith("in the space: ours (simulated observers)")
    assert "simulated" not in isogloss_ring().stimuli.title


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"radii": []}, r"Invalid radii \[\]"),
        ({"radii": [0.04, 0.04]}, "Allowed: one gloss distance or several different ones"),
        ({"radii": [0.0]}, "Invalid radius = 0.0"),
        ({"radii": [float("nan")]}, "Invalid radius"),
        ({"n": 2}, "Invalid n = 2"),
        ({"radii": [10.0], "n": 3}, "No paint of rho_d = 0.193 lies at gloss distance 10 from the reference"),
        ({"radii": [1e-9]}, "Two paints of the set are the same to 6 digits"),
        ({"reference": Paint(0.9, 0.2, 0.07)}, "at most 1"),
        ({"reference": Paint(0.193, 0.066, 0.0)}, "alpha"),
    ],
)
def test_mistakes(options, message):
    with pytest.raises(GlossError, match=message):
        isogloss_ring(**options)
