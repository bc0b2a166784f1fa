"""What else the readings tell of a screen: additivity, uniformity, veiling and ambient light, warming up."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from gloss_experiments.calibration.lightness import lightness_of_luminance
from gloss_experiments.calibration.readings import Reading, Readings

__all__ = [
    "Additivity",
    "StrayLight",
    "Uniformity",
    "WarmUp",
    "check_additivity",
    "check_stray_light",
    "check_uniformity",
    "check_warm_up",
]

_Key = TypeVar("_Key")

# Warm is a screen whose luminance stays this near to that of the end (a share), over so many readings at least.
_STABLE = 0.01
_FEWEST_STABLE = 3


@dataclass(frozen=True, kw_only=True)
class Additivity:
    """Whether three channels add up to gray at one code value: ``red + green + blue - 2 black`` against gray."""

    code: int
    sum_cd_m2: float
    gray_cd_m2: float
    error_cd_m2: float
    error_percent: float
    delta_l: float


@dataclass(frozen=True, kw_only=True)
class Uniformity:
    """Gray at the places of the two images, at one code value, against each other and the centre.

    Ratios are None where a position was not measured; ΔL* is that of right less left.
    """

    code: int
    left_cd_m2: float
    right_cd_m2: float
    centre_cd_m2: float | None
    right_over_left: float
    delta_l: float
    full_field_over_centre: float | None


@dataclass(frozen=True, kw_only=True)
class StrayLight:
    """Light that does not come from the code value shown.

    Attributes
    ----------
    veiling_cd_m2, veiling_percent
        How much brighter black is in a white field than on a black screen, and in percent of white: scattered in the
        screen or in the photometer's lens. The worst case: in a session the surround is black.
    ambient_cd_m2, ambient_percent_of_black
        The switched-off screen in the light of the room, and in percent of the black that was measured.
    """

    veiling_cd_m2: float | None
    veiling_percent: float | None
    ambient_cd_m2: float | None
    ambient_percent_of_black: float | None


@dataclass(frozen=True, kw_only=True)
class WarmUp:
    """White while the screen warms up.

    Attributes
    ----------
    minutes, share
        Time of each reading, and its luminance over that of the end: the median of the last three.
    stable_after_min
        From when on every reading is within 1 % of the end, three readings at least; None where that is not reached:
        measure for longer.
    drift_percent
        First reading less the end, in percent of the end.
    """

    minutes: tuple[float, ...]
    share: tuple[float, ...]
    stable_after_min: float | None
    drift_percent: float


def check_additivity(readings: Readings, *, white_cd_m2: float) -> tuple[Additivity, ...]:
    """Compare the sum of the channels with gray, at every code value that all were read at.

    Examples
    --------
    >>> from gloss_experiments.calibration import SimulatedScreen, simulated_readings
    >>> readings = simulated_readings(SimulatedScreen(interaction=-0.02))
    >>> [round(one.error_percent, 2) for one in check_additivity(readings, white_cd_m2=108.0)]
    [1.97, 2.03]
    """
    means = _means((reading.patch.codes, reading) for reading in readings.of("additivity"))
    black = means.get((0, 0, 0))
    if black is None:
        return ()
    found = []
    for code in sorted({max(codes) for codes in means if max(codes) > 0}):
        channels = [means.get(codes) for codes in ((code, 0, 0), (0, code, 0), (0, 0, code))]
        gray = means.get((code, code, code))
        if gray is None or any(one is None for one in channels):
            continue
        total = sum(one for one in channels if one is not None) - 2 * black
        found.append(
            Additivity(
                code=code, sum_cd_m2=total, gray_cd_m2=gray, error_cd_m2=total - gray,
                error_percent=100 * (total - gray) / gray, delta_l=_delta_l(total, gray, white_cd_m2),
            )
        )  # fmt: skip
    return tuple(found)


def check_uniformity(readings: Readings, *, white_cd_m2: float) -> tuple[Uniformity, ...]:
    """Compare gray at the places of the two images, at every code value that both were read at."""
    items = [reading for reading in readings.of("uniformity") if reading.patch.is_gray]
    means = _means(((reading.patch.red, reading.patch.position), reading) for reading in items)
    found = []
    for code in sorted({code for code, _ in means}):
        left, right, centre, full = (means.get((code, place)) for place in ("left", "right", "centre", "full"))
        if left is None or right is None or left <= 0:
            continue
        found.append(
            Uniformity(
                code=code, left_cd_m2=left, right_cd_m2=right, centre_cd_m2=centre, right_over_left=right / left,
                delta_l=_delta_l(right, left, white_cd_m2),
                full_field_over_centre=full / centre if full is not None and centre else None,
            )
        )  # fmt: skip
    return tuple(found)


def check_stray_light(readings: Readings, *, black_cd_m2: float, white_cd_m2: float) -> StrayLight:
    """Find the veiling and the ambient light, each None where it was not measured.

    For veiling, black in a white field (position centre) is compared with black on a black screen (position full), or
    else with the black of the fit.
    """
    means = _means((reading.patch.position, reading) for reading in readings.of("veiling"))
    veiling = None if "centre" not in means else means["centre"] - means.get("full", black_cd_m2)
    off = [reading.luminance_cd_m2 for reading in readings.of("ambient")]
    ambient = math.fsum(off) / len(off) if off else None
    return StrayLight(
        veiling_cd_m2=veiling,
        veiling_percent=None if veiling is None else 100 * veiling / white_cd_m2,
        ambient_cd_m2=ambient,
        ambient_percent_of_black=100 * ambient / black_cd_m2 if ambient is not None and black_cd_m2 > 0 else None,
    )


def check_warm_up(readings: Readings) -> WarmUp | None:
    """When the screen was warm; None where fewer than three readings tell.

    Examples
    --------
    >>> from gloss_experiments.calibration import SimulatedScreen, simulated_readings, standard_patches
    >>> screen = SimulatedScreen(warm_up_share=0.08, warm_up_time_min=10)
    >>> check_warm_up(simulated_readings(screen, standard_patches(warm_up_min=60))).stable_after_min
    25.0
    """
    items = sorted(readings.of("warm_up"), key=lambda reading: reading.minutes or 0.0)
    luminance = np.array([reading.luminance_cd_m2 for reading in items])
    if len(items) < _FEWEST_STABLE or not np.median(luminance[-_FEWEST_STABLE:]) > 0:
        return None
    share = luminance / np.median(luminance[-_FEWEST_STABLE:])  # one reading alone would bring its own noise
    minutes = tuple(reading.minutes or 0.0 for reading in items)
    unstable = np.flatnonzero(np.abs(share - 1) > _STABLE)
    first = int(unstable[-1]) + 1 if unstable.size else 0
    return WarmUp(
        minutes=minutes,
        share=tuple(share.tolist()),
        stable_after_min=minutes[first] if len(items) - first >= _FEWEST_STABLE else None,
        drift_percent=float(100 * (share[0] - 1)),
    )


def _means(items: Iterable[tuple[_Key, Reading]]) -> dict[_Key, float]:
    collected: dict[_Key, list[float]] = {}
    for key, reading in items:
        collected.setdefault(key, []).append(reading.luminance_cd_m2)
    return {key: _mean(values) for key, values in collected.items()}


def _mean(values: Sequence[float]) -> float:
    return math.fsum(values) / len(values)


def _delta_l(a: float, b: float, white_cd_m2: float) -> float:
    first, second = lightness_of_luminance([a, b], white_cd_m2=white_cd_m2)
    return float(first - second)
