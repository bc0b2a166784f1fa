import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gloss_stimuli.viewing import ViewingGeometry, angle_of_width_deg, round_even, width_of_angle_cm
from glossspace.errors import GlossError

LENGTHS = st.floats(1e-3, 1e4)


def test_the_papers_image_is_8_514_cm_wide() -> None:
    # Gloss paper 3.2.3.2: 3.2 degrees at 60 inches; 2 · 152.4 · tan(1.6°), to the three decimals that are worth saying.
    assert width_of_angle_cm(3.2, distance_cm=60 * 2.54) == pytest.approx(8.514, abs=5e-4)


def test_a_right_angle_is_twice_the_distance_wide() -> None:
    assert width_of_angle_cm(90, distance_cm=50) == pytest.approx(100, rel=1e-15)  # tan 45° = 1, to rounding


@given(st.floats(1e-3, 119), LENGTHS)
def test_angle_and_width_undo_each_other(angle_deg: float, distance_cm: float) -> None:
    width = width_of_angle_cm(angle_deg, distance_cm=distance_cm)
    # A handful of roundings in double precision; tan at 59.5° doubles them.
    assert angle_of_width_deg(width, distance_cm=distance_cm) == pytest.approx(angle_deg, rel=1e-14)


@given(st.floats(0, 1e6))
def test_an_even_size_is_even_and_at_most_a_pixel_away(pixels: float) -> None:
    even = round_even(pixels)
    assert even % 2 == 0
    assert even >= 2
    assert abs(even - max(pixels, 2)) <= 1


@given(LENGTHS, st.floats(0.01, 100), st.floats(0.05, 2))
def test_no_other_even_width_comes_nearer_on_the_screen(distance: float, angle: float, pitch: float) -> None:
    viewing = ViewingGeometry(distance_cm=distance, image_width_deg=angle, pixel_pitch_mm=pitch)
    native = viewing.native_width_px
    assert native is not None
    missed = {px: abs(px * pitch / 10 - viewing.image_width_cm) for px in (native - 2, native, native + 2) if px > 0}
    # 1e-12: at a tie the two differ by the rounding of a product.
    assert missed[native] <= min(missed.values()) + 1e-12 * viewing.image_width_cm


def test_pixels_reach_an_angle_and_the_manifest_says_which() -> None:
    viewing = ViewingGeometry(distance_cm=152.4, image_width_deg=3.2, pixel_pitch_mm=0.2695)
    document = viewing.to_dict(image_width_px=512)
    # 85.138 mm / 0.2695 mm = 315.9 pixels.
    assert document["native_width_px"] == 316
    assert document["native_width_deg"] == pytest.approx(
        math.degrees(2 * math.atan(31.6 * 0.2695 / 2 / 152.4)), rel=1e-14
    )
    assert document["rendered_width_deg"] == pytest.approx(
        math.degrees(2 * math.atan(51.2 * 0.2695 / 2 / 152.4)), rel=1e-14
    )
    assert document["image_width_deg"] == 3.2
    assert document["image_width_cm"] == pytest.approx(8.514, abs=5e-4)


def test_without_a_pitch_nothing_is_said_of_pixels() -> None:
    viewing = ViewingGeometry(distance_cm=152.4, image_width_deg=3.2)
    assert set(viewing.to_dict(image_width_px=512)) == {"distance_cm", "image_width_deg", "image_width_cm"}
    assert viewing.native_width_px is None
    with pytest.raises(GlossError, match=r"not known without pixel_pitch_mm. State it under \[viewing\]"):
        viewing.angle_of_pixels_deg(512)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"distance_cm": 0.0}, "distance_cm must be a finite number above 0, but is 0.0"),
        ({"distance_cm": math.inf}, "distance_cm must be a finite number above 0, but is inf"),
        ({"pixel_pitch_mm": -0.2}, "pixel_pitch_mm must be a finite number above 0, but is -0.2"),
        ({"image_width_deg": 120.0}, "image_width_deg must lie between 0 and 120 degrees, but is 120.0"),
        ({"image_width_deg": math.nan}, "between 0 and 120 degrees, but is nan"),
    ],
)
def test_an_impossible_geometry_is_refused(change: dict[str, float], message: str) -> None:
    with pytest.raises(GlossError, match=message):
        ViewingGeometry(**{"distance_cm": 152.4, "image_width_deg": 3.2, **change})
