"""The rows of the check of a screen: what was found, what was expected, and whether that lets a session begin."""

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from math import radians, tan
from typing import Literal, TypeAlias

import numpy as np

from gloss_experiments.calibration.lightness import lightness_of_luminance
from gloss_experiments.calibration.record import StoredCalibration
from gloss_experiments.preflight.gamma_table import GammaTable
from gloss_experiments.preflight.screen_facts import ScreenFacts
from gloss_experiments.protocol import Protocol
from gloss_experiments.window.layout import round_even, visual_angle_deg
from glossspace.display import DisplayModel
from glossspace.stimulus_set import StimulusSet

__all__ = ["Row", "judge_rows", "largest_delta_l"]

Verdict: TypeAlias = Literal["ok", "warning", "refused"]

# Two statements of one pixel pitch, or of one frame rate, differ by their rounding only.
_SAME_PITCH = 0.01
_SAME_RATE = 0.02
_SECONDS_A_DAY = 86_400


@dataclass(frozen=True, kw_only=True)
class Row:
    """One thing that was checked.

    Attributes
    ----------
    name, found, expected : str
    verdict : {"ok", "warning", "refused"}
        A warning is what could not be checked.
    """

    name: str
    found: str
    expected: str
    verdict: Verdict

    @property
    def ok(self) -> bool:
        """Whether it lets the session begin."""
        return self.verdict != "refused"


def judge_rows(
    facts: ScreenFacts,
    protocol: Protocol,
    stimulus_set: StimulusSet,
    *,
    calibration: StoredCalibration | None,
    now: datetime,
) -> tuple[Row, ...]:
    """Judge what was found out about a screen, one row for each thing; see `gloss_experiments.preflight.preflight`."""
    return (
        *_size_rows(facts, protocol, calibration),
        *_gamma_rows(facts, protocol),
        *_frame_rows(facts, protocol, calibration),
        *_angle_rows(protocol, stimulus_set, calibration),
        *_calibration_rows(facts, protocol, calibration, now),
        _luminance_row(protocol, stimulus_set, calibration),
    )


def largest_delta_l(images: DisplayModel, screen: DisplayModel) -> tuple[float, int]:
    """Largest difference in lightness, over the 8-bit code values, between two displays; and the code value there.

    L* is relative to the white of `screen`.

    Examples
    --------
    >>> largest_delta_l(DisplayModel(), DisplayModel())
    (0.0, 0)
    >>> change, code = largest_delta_l(DisplayModel(gamma=2.35), DisplayModel(gamma=2.2))
    >>> round(change, 1), code
    (-2.6, 82)
    """
    codes = np.arange(256)
    first, second = (
        lightness_of_luminance(one.luminance(codes * (2**one.bits - 1) / 255), white_cd_m2=screen.white_cd_m2)
        for one in (images, screen)
    )
    difference = first - second
    code = int(np.argmax(np.abs(difference)))
    return float(difference[code]), code


def _row(name: str, found: str, expected: str, good: bool) -> Row:
    return Row(name=name, found=found, expected=expected, verdict="ok" if good else "refused")


def _unknown(name: str, found: str, expected: str, *, refuse: bool = False) -> Row:
    return Row(name=name, found=found, expected=expected, verdict="refused" if refuse else "warning")


def _size_rows(facts: ScreenFacts, protocol: Protocol, calibration: StoredCalibration | None) -> Iterator[Row]:
    found = _size(facts.window_px)
    if protocol.display.fullscreen:
        yield _row("window", found, f"the screen's {_size(facts.screen_px)}", facts.window_px == facts.screen_px)
    else:
        wanted = protocol.display.window_size_px
        yield _row("window", found, f"the protocol's {_size(wanted)}", facts.window_px == wanted)
    yield _row(
        "framebuffer", _size(facts.framebuffer_px), f"{found}, not scaled", facts.framebuffer_px == facts.window_px
    )
    if calibration is not None and calibration.screen.size_px is not None:
        size = calibration.screen.size_px
        yield _row("screen size", _size(facts.screen_px), f"the calibrated {_size(size)}", facts.screen_px == size)


def _gamma_rows(facts: ScreenFacts, protocol: Protocol) -> Iterator[Row]:
    gamma = facts.monitor_gamma
    told = "none" if gamma is None else f"gamma {', '.join(f'{one:g}' for one in gamma)}"
    yield _row("PsychoPy's correction", told, "none: the images hold it", gamma is None)
    table = facts.gamma_table
    expected = "identity: the images hold the correction"
    if isinstance(table, GammaTable):
        off = f"up to {table.deviation_codes:.3g} code values off identity"
        found = "identity" if table.is_identity else f"{off} (`gloss calibrate gamma-table --reset`)"
        yield _row("video card's gamma table", found, expected, table.is_identity)
    else:
        refuse = protocol.checks.unreadable_gamma_table == "refuse"
        yield _unknown("video card's gamma table", f"cannot be read: {table}", expected, refuse=refuse)


def _frame_rows(facts: ScreenFacts, protocol: Protocol, calibration: StoredCalibration | None) -> Iterator[Row]:
    stated = protocol.checks.frame_rate_hz
    calibrated = None if calibration is None else calibration.screen.refresh_hz
    expected = stated if stated is not None else calibrated
    if facts.frame_rate_hz is None:
        wanted = "a steady rate" if expected is None else f"{expected:g} Hz"
        yield _unknown("frame rate", "no steady rate, or a virtual display", wanted, refuse=stated is not None)
        return
    found = f"{facts.frame_rate_hz:.2f} Hz"
    if expected is None:
        yield Row(name="frame rate", found=found, expected="not stated", verdict="ok")
    else:
        yield _row("frame rate", found, f"{expected:g} Hz", abs(facts.frame_rate_hz / expected - 1) <= _SAME_RATE)
    share = facts.n_dropped / max(1, facts.n_frames)
    limit = protocol.checks.dropped_frames
    dropped, most = f"{facts.n_dropped} of {facts.n_frames}", f"at most {100 * limit:g} %"
    if stated is None and share > limit:
        # Pictures that stand still survive a late frame; it is a lab that states its rate that asks for more.
        yield _unknown("dropped frames", dropped, most)
    else:
        yield _row("dropped frames", dropped, most, share <= limit)


def _angle_rows(protocol: Protocol, stimulus_set: StimulusSet, calibration: StoredCalibration | None) -> Iterator[Row]:
    display, checks = protocol.display, protocol.checks
    measured = None if calibration is None else calibration.screen.pixel_pitch_mm
    pitch = display.pixel_pitch_mm if display.pixel_pitch_mm is not None else measured
    wanted = (
        f"{display.image_width_deg:g} degrees at {display.viewing_distance_cm:g} cm, within {100 * checks.angle:g} %"
    )
    if pitch is None:
        yield _unknown("pixel pitch", "not stated", "display.pixel_pitch_mm in the protocol")
        yield _unknown("image width", f"{stimulus_set.image_size[0]} px", wanted)
        return
    if display.pixel_pitch_mm is not None and measured is not None:
        same = abs(display.pixel_pitch_mm / measured - 1) <= _SAME_PITCH
        yield _row("pixel pitch", f"{display.pixel_pitch_mm:g} mm", f"the calibrated {measured:g} mm", same)
    else:
        yield Row(name="pixel pitch", found=f"{pitch:g} mm", expected="stated", verdict="ok")
    width = stimulus_set.image_size[0]
    angle = visual_angle_deg(width, pixel_pitch_mm=pitch, distance_cm=display.viewing_distance_cm)
    good = abs(angle / display.image_width_deg - 1) <= checks.angle
    found = f"{width} px, {angle:.2f} degrees"
    if not good:
        width_mm = 20 * display.viewing_distance_cm * tan(radians(display.image_width_deg) / 2)
        found += f" (render with --size {round_even(width_mm / pitch)})"
    yield _row("image width", found, wanted, good)


def _calibration_rows(
    facts: ScreenFacts, protocol: Protocol, calibration: StoredCalibration | None, now: datetime
) -> Iterator[Row]:
    most = protocol.checks.calibration_max_age_days
    expected = f"at most {most:g} days old"
    if calibration is None:
        refuse = protocol.checks.uncalibrated == "refuse"
        yield _unknown("calibration", "not calibrated", expected, refuse=refuse)
        return
    if calibration.simulated:
        yield _row("calibration", "of a simulated photometer", "of a real screen", False)
    age = (now - calibration.measured_at).total_seconds() / _SECONDS_A_DAY
    when = f"'{calibration.screen.name}', {calibration.measured_at:%Y-%m-%d}"
    # A day's grace: the clocks of two machines, or a date without its hour.
    found = f"{when}, {age:.0f} days old" if age > -1 else f"{when}, in the future"
    yield _row("calibration's age", found, expected, -1 < age <= most)
    known = calibration.screen.edid_sha256
    if known and facts.edid_sha256:
        same = bool(set(known) & set(facts.edid_sha256))
        yield _row("screen's identity (EDID)", "as calibrated" if same else "another screen", "as calibrated", same)


def _luminance_row(protocol: Protocol, stimulus_set: StimulusSet, calibration: StoredCalibration | None) -> Row:
    name, limit = "images' display", protocol.checks.luminance_delta_l
    expected = f"the screen's curve within ΔL* {limit:g}"
    try:
        images = DisplayModel.from_dict(stimulus_set.manifest["display"])
    except (KeyError, TypeError, ValueError):
        return _unknown(name, "not told by the stimulus set", expected)
    curve = "measured" if images.gamma is None else f"gamma {images.gamma:g}"
    found = f"{images.black_cd_m2:.3g} to {images.white_cd_m2:.4g} cd/m², {curve}"
    if calibration is None:
        return _unknown(name, found, expected, refuse=protocol.checks.uncalibrated == "refuse")
    difference, code = largest_delta_l(images, calibration.display)
    return _row(name, f"{found}: ΔL* {difference:+.2f} at code {code}", expected, abs(difference) <= limit)


def _size(pixels: tuple[int, int]) -> str:
    return f"{pixels[0]} x {pixels[1]}"
