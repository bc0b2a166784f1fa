"""What a PsychoPy window tells of its screen: sizes, gamma, frames."""

import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from gloss_experiments.calibration.screen_identity import connected_edid_sha256
from gloss_experiments.preflight.gamma_table import GammaTable, monitor_gamma, read_gamma_table

__all__ = ["ScreenFacts", "screen_facts"]

_N_FRAMES = 120
# A frame that took half a period longer than it should missed its turn.
_LATE = 1.5


@dataclass(frozen=True, kw_only=True)
class ScreenFacts:
    """What was found out about a window and its screen.

    Attributes
    ----------
    window_px, framebuffer_px, screen_px : (int, int)
        Width and height.
    monitor_gamma : tuple of float or None
        What PsychoPy was told to correct.
    gamma_table : GammaTable or str
        Of the video card; or why it cannot be read.
    frame_rate_hz : float or None
        None on a virtual display, or where there is no steady rate.
    n_frames, n_dropped : int
        Frames shown for the check, and those that came late.
    edid_sha256 : tuple of str
        Of the screens that are connected.
    """

    window_px: tuple[int, int]
    framebuffer_px: tuple[int, int]
    screen_px: tuple[int, int]
    monitor_gamma: tuple[float, ...] | None
    gamma_table: GammaTable | str
    frame_rate_hz: float | None
    n_frames: int
    n_dropped: int
    edid_sha256: tuple[str, ...]


def screen_facts(window: Any, *, refresh_s: float | None) -> ScreenFacts:
    """Find out about the screen of an open PsychoPy window; shows 120 frames of black, except on a virtual display.

    Parameters
    ----------
    window
        Of PsychoPy.
    refresh_s
        Its measured refresh period in seconds; None on a virtual display, or where there is no steady rate.
    """
    screen = window.winHandle.screen
    dropped = 0 if refresh_s is None else _dropped_frames(window, refresh_s)
    return ScreenFacts(
        window_px=_pixels(window.size),
        framebuffer_px=_pixels(getattr(window, "frameBufferSize", window.size)),
        screen_px=(int(screen.width), int(screen.height)),
        monitor_gamma=monitor_gamma(window),
        gamma_table=read_gamma_table(window),
        frame_rate_hz=None if refresh_s is None else 1 / refresh_s,
        n_frames=0 if refresh_s is None else _N_FRAMES,
        n_dropped=dropped,
        edid_sha256=connected_edid_sha256(),
    )


def _dropped_frames(window: Any, period_s: float) -> int:
    window.flip()
    times = [time.perf_counter()]
    for _ in range(_N_FRAMES):
        window.flip()
        times.append(time.perf_counter())
    return int(np.count_nonzero(np.diff(times) > _LATE * period_s))


def _pixels(size: Any) -> tuple[int, int]:
    return int(size[0]), int(size[1])
