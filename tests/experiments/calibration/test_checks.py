"""Additivity, uniformity, stray light and warming up, against what the simulated screen was given."""

import math
from dataclasses import replace

import pytest

from gloss_experiments.calibration import (
    Readings,
    SimulatedScreen,
    check_additivity,
    check_stray_light,
    check_uniformity,
    check_warm_up,
    standard_patches,
)
from glossspace.errors import GlossError
from tests.experiments.calibration.screens import changed, readings_of


def test_a_screen_without_a_fault():
    readings = readings_of()
    assert [one.error_cd_m2 for one in check_additivity(readings, white_cd_m2=108.0)] == pytest.approx(
        [0, 0], abs=1e-12
    )
    assert [one.delta_l for one in check_uniformity(readings, white_cd_m2=108.0)] == [0, 0, 0]
    stray = check_stray_light(readings, black_cd_m2=0.7, white_cd_m2=108.0)
    assert (stray.veiling_cd_m2, stray.ambient_cd_m2) == (0, 0)
    assert check_warm_up(readings) is None, "nothing was read while it warmed up"


def test_additivity():
    """Gray lacks 3 % of what its channels add to black: at white .03 · 107.3 cd/m² of 108 - 3.219."""
    found = check_additivity(readings_of(SimulatedScreen(interaction=-0.03)), white_cd_m2=108.0)
    white = found[-1]
    assert (white.code, white.error_cd_m2) == (255, pytest.approx(3.219, abs=1e-9))
    assert white.error_percent == pytest.approx(100 * 3.219 / 104.781, abs=1e-9)
    assert white.sum_cd_m2 == pytest.approx(108, abs=1e-9)
    # L* of 108 against 104.781: 116 (1 - (104.781/108)^(1/3)).
    assert white.delta_l == pytest.approx(116 * (1 - (104.781 / 108) ** (1 / 3)), abs=1e-9)


def test_uniformity():
    found = check_uniformity(readings_of(SimulatedScreen(left=1.02, right=0.97)), white_cd_m2=108.0)
    assert [one.code for one in found] == [64, 128, 255]
    assert [one.right_over_left for one in found] == pytest.approx([0.97 / 1.02] * 3, rel=1e-12)
    assert found[-1].full_field_over_centre == 1
    assert found[0].full_field_over_centre is None
    # A full field drawn from one power supply is dimmer than a patch in its centre.
    sagging = changed(readings_of(), lambda patch, value: value * (0.9 if patch.position == "full" else 1))
    assert check_uniformity(sagging, white_cd_m2=108.0)[-1].full_field_over_centre == pytest.approx(0.9, rel=1e-12)


def test_stray_light():
    screen = SimulatedScreen(veiling=0.001, ambient_cd_m2=0.07)
    found = check_stray_light(readings_of(screen), black_cd_m2=0.77, white_cd_m2=108.07)
    assert found.veiling_cd_m2 == pytest.approx(0.108, abs=1e-12)
    assert found.ambient_cd_m2 == pytest.approx(0.07, abs=1e-12)
    assert found.ambient_percent_of_black == pytest.approx(100 / 11, abs=1e-9)
    # Black on a black screen as it was read with it, not the fit's.
    assert check_stray_light(readings_of(screen), black_cd_m2=0.8, white_cd_m2=108.07) == replace(
        found, ambient_percent_of_black=pytest.approx(8.75, abs=1e-9)
    )
    nothing = check_stray_light(
        readings_of(patches=standard_patches(purposes=["fit"])), black_cd_m2=0.7, white_cd_m2=108.0
    )
    assert (nothing.veiling_cd_m2, nothing.ambient_cd_m2) == (None, None)


def test_warming_up():
    """8 exp(-t/10) % is below 1 % from t = 10 ln 8 = 20.8 min on, and the next reading is at 25 min."""
    patches = standard_patches(warm_up_min=60)
    found = check_warm_up(readings_of(SimulatedScreen(warm_up_share=0.08, warm_up_time_min=10), patches=patches))
    assert found.stable_after_min == 25
    shuffled = Readings(
        readings_of(SimulatedScreen(warm_up_share=0.08, warm_up_time_min=10), patches=patches).items[::-1], "simulated"
    )
    assert check_warm_up(shuffled) == found, "in whatever order a lab writes them down"
    end = 1 + 0.08 * math.exp(-5.5)  # the median of the last three readings, at 50, 55 and 60 min
    assert found.drift_percent == pytest.approx(100 * (1.08 / end - 1), abs=1e-9)
    slow = check_warm_up(readings_of(SimulatedScreen(warm_up_share=0.4, warm_up_time_min=60), patches=patches))
    assert slow.stable_after_min is None


def test_patches():
    patches = standard_patches(warm_up_min=30)
    assert [one.minutes for one in patches[:8]] == [0, 5, 10, 15, 20, 25, 30, None]
    fit = {one.codes for one in patches if one.purpose == "fit"}
    assert {(0, 0, 0), (255, 255, 255), (255, 0, 0), (0, 255, 0), (0, 0, 255)} <= fit
    assert fit.isdisjoint(one.codes for one in patches if one.purpose == "verify")
    for levels in (9, 10, 33, 64):
        chosen = standard_patches(levels=levels)
        assert len({one.red for one in chosen if one.purpose == "fit" and one.is_gray}) == levels
        assert {(255, 0, 0), (0, 255, 0), (0, 0, 255)} <= {one.codes for one in chosen if one.purpose == "fit"}
        assert sum(one.purpose == "verify" for one in chosen) >= 3
    for mistake, message in (
        ({"levels": 8}, "number of levels 8. Allowed: 9 to 65"),
        ({"warm_up_min": math.nan}, "Invalid warm-up of nan"),
        ({"every_min": 0}, "every 0 min"),
        ({"bits": 12}, "8 or 16 bits, but bits is 12"),
        ({"purposes": ["verifi"]}, "Unknown purpose 'verifi'"),
    ):
        with pytest.raises(GlossError, match=message):
            standard_patches(**mistake)
