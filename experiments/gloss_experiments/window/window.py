"""Opening a PsychoPy window, or saying in one line why there is none. PsychoPy is imported here alone, and lazily."""

import contextlib
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from gloss_experiments.protocol import Protocol
from glossspace.errors import GlossError

__all__ = ["open_window", "own_fonts", "refresh_period_s"]

_DEBIAN_PACKAGES = "libgl1 libglu1-mesa libgl1-mesa-dri libx11-6 libxext6 libxxf86vm1 libxinerama1"


@contextlib.contextmanager
def open_window(protocol: Protocol, *, simulated: bool) -> Iterator[Any]:
    """Open a black window in pixel units, and close it in the end.

    Raises
    ------
    GlossError
        There is no display, PsychoPy or a system library is missing, or the display scales pixels.
    """
    if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
        raise GlossError(
            "No display for the session's window (DISPLAY is not set). Run it on a desktop, use --headless, or for "
            "--simulate: apt-get install xvfb xauth, then put 'xvfb-run -a -s \"-screen 0 1280x1024x24\"' before it."
        )
    # PsychoPy prints as it pleases, and stdout belongs to the result.
    with contextlib.redirect_stdout(sys.stderr):
        window = _opened(protocol, simulated=simulated)
        try:
            _refuse_scaled_pixels(window)
            yield window
        finally:
            window.close()


def _opened(protocol: Protocol, *, simulated: bool) -> Any:
    try:
        from psychopy import logging

        logging.console.setLevel(logging.CRITICAL)
        from psychopy import monitors, visual
    except ModuleNotFoundError as error:
        raise GlossError(
            f"The session's window needs the Python package '{error.name}'. Install it with: "
            "pip install 'glossspace[experiments]'."
        ) from None
    except Exception as error:
        raise _no_window(error) from None
    try:
        monitor = monitors.Monitor("glossspace")
        # A calibration of that name may lie in the user's folder, and its gamma would be applied: a new one has none.
        # The images are encoded for the display already, and must not be corrected again.
        monitor.newCalib("of this session", distance=protocol.display.viewing_distance_cm)
        return visual.Window(
            size=protocol.display.window_size_px,
            fullscr=protocol.display.fullscreen and not simulated,
            units="pix",
            color=(-1, -1, -1),
            colorSpace="rgb",
            monitor=monitor,
            gammaErrorPolicy="ignore",
            winType="pyglet",
            allowGUI=not protocol.display.fullscreen and not simulated,
            checkTiming=False,
            waitBlanking=not simulated,
        )
    except Exception as error:
        raise _no_window(error) from None


def _no_window(error: Exception) -> GlossError:
    reason = str(error).splitlines()[0] if str(error) else type(error).__name__
    return GlossError(
        f"The session's window cannot be opened ({reason}). Check the display and the graphics driver; on Debian: "
        f"apt-get install {_DEBIAN_PACKAGES}."
    )


def _refuse_scaled_pixels(window: Any) -> None:
    logical, physical = tuple(window.size), tuple(getattr(window, "frameBufferSize", window.size))
    if tuple(map(int, logical)) != tuple(map(int, physical)):
        raise GlossError(
            f"The display scales its pixels (window {logical}, framebuffer {physical}), so images would be resampled. "
            "Set its scale to 100 %."
        )


def own_fonts() -> list[str]:
    """The font files that PsychoPy brings, so that no session looks for one in the network."""
    import psychopy

    return sorted(str(path) for path in (Path(psychopy.__file__).parent / "assets" / "fonts").glob("NotoSans-R*.ttf"))


def refresh_period_s(window: Any) -> float | None:
    """Measured refresh period of the display, in seconds; None where it is virtual, or keeps no steady rate.

    A virtual display, or one without a graphics card, is told by its renderer: frames that it misses mean nothing.
    """
    from pyglet.gl import gl_info

    renderer = str(gl_info.get_renderer()).lower()
    if any(name in renderer for name in ("llvmpipe", "softpipe", "swrast", "software rasterizer")):
        return None
    rate_hz = window.getActualFrameRate(nIdentical=10, nMaxFrames=90, nWarmUpFrames=10, threshold=1)
    return None if rate_hz is None else 1 / float(rate_hz)
