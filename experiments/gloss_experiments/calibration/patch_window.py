"""The window that shows the patches, pixel for pixel as images are shown, and takes numbers typed at it."""

import contextlib
import math
import time
from collections.abc import Iterator
from typing import Any

import numpy as np

from gloss_experiments.calibration.measuring import Pace
from gloss_experiments.calibration.patches import Patch
from gloss_experiments.calibration.photometer import Photometer
from gloss_experiments.protocol import Protocol
from gloss_experiments.window.layout import arrange
from gloss_experiments.window.window import open_window, refresh_period_s

__all__ = ["ManualPhotometer", "PatchWindow", "open_patch_window"]

_DIM_GRAY = -0.5
_DIGITS = {str(digit): str(digit) for digit in range(10)} | {f"num_{digit}": str(digit) for digit in range(10)}
_SIGNS = {"period": ".", "num_decimal": ".", "comma": ".", "num_separator": "."}
_ENTER = ("return", "enter", "num_enter")


@contextlib.contextmanager
def open_patch_window(protocol: Protocol, *, image_size_px: int, simulated: bool = False) -> Iterator["PatchWindow"]:
    """Open the window of a measurement; `protocol` says where the images stand, and `image_size_px` their size.

    Raises
    ------
    GlossError
        No window can be opened, or the images do not fit into it.
    """
    with open_window(protocol, simulated=simulated) as window:
        yield PatchWindow(window, protocol, image_size_px)


class PatchWindow:
    """An open window; make one with `open_patch_window`."""

    def __init__(self, window: Any, protocol: Protocol, image_size_px: int) -> None:
        from psychopy import event, visual

        self.window = window
        self._event, self._visual = event, visual
        size = (int(window.size[0]), int(window.size[1]))
        layout = arrange(protocol, image_size_px=(image_size_px, image_size_px), window_size_px=size)
        places = layout.images if len(layout.images) == 2 else layout.images * 2
        self._places = {"left": places[0], "right": places[1], "centre": (0, places[0][1]), "full": (0, 0)}
        self._image_size = (image_size_px, image_size_px)
        # Even, or the screen would blend neighbouring pixels; a row that it leaves is as black as the surround.
        self._full_size = (size[0] // 2 * 2, size[1] // 2 * 2)
        self._text = visual.TextStim(
            window, text="", pos=(0, -size[1] // 2 + 2 * protocol.texts.size_px), height=protocol.texts.size_px,
            color=(_DIM_GRAY,) * 3, font=protocol.texts.font, units="pix", wrapWidth=size[0] * 0.8,
        )  # fmt: skip
        self._shown: list[Any] = []

    @property
    def screen_size_px(self) -> tuple[int, int]:
        """Width and height of the screen that the window is on."""
        screen = self.window.winHandle.screen
        return int(screen.width), int(screen.height)

    def refresh_hz(self) -> float | None:
        """Measured refresh rate; None on a virtual display."""
        period_s = refresh_period_s(self.window)
        return None if period_s is None else round(1 / period_s, 2)

    def show(self, patch: Patch) -> None:
        """Show one patch, and nothing else: every text would light the screen."""
        self._shown = self._stimuli(patch)
        self._text.text = ""
        if patch.purpose == "ambient":
            self._text.text = "Switch the screen off, read it, switch it on again."
        self.draw()
        self.window.flip()

    def draw(self) -> None:
        """Draw what is shown into the back buffer."""
        for stimulus in self._shown:
            stimulus.draw()
        if self._text.text:
            self._text.draw()

    def wait(self, seconds: float) -> None:
        """Keep what is shown for so many seconds; a window that does not answer would be dimmed by some desktops."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.draw()
            self.window.flip()
            time.sleep(0.005)  # where flips do not wait for the screen, the processor may rest
            self._event.getKeys()

    def message(self, text: str) -> bool:
        """Show a text until the space bar is pressed; False for Escape."""
        self._shown, self._text.text = [], text
        place = self._text.pos
        self._text.pos = (0, 0)
        try:
            return self._space_pressed()
        finally:
            self._text.pos = place

    def _space_pressed(self) -> bool:
        """Draw until the space bar is pressed; False for Escape."""
        self._event.clearEvents()
        while True:
            self.draw()
            self.window.flip()
            keys = self._event.getKeys()
            if "escape" in keys:
                return False
            if "space" in keys:
                return True

    def aim(self) -> bool:
        """Keep the patch and a line below it until the photometer is aimed and the space bar pressed; False for Escape.

        The line is gone before anything is read.
        """
        self._text.text = "Aim the photometer at this patch, then press the space bar."
        goes_on = self._space_pressed()
        self._text.text = ""
        self.draw()
        self.window.flip()
        return goes_on

    def typed_number(self) -> float | None:
        """A number typed at the patch, ended by Enter; None for Escape.

        Nothing but the patch is lit until the first digit is typed, so the reading is of the patch alone.
        """
        typed = ""
        self._event.clearEvents()
        while True:
            for key in self._event.getKeys():
                if key == "escape":
                    return None
                if key in _ENTER:
                    number = _number(typed)
                    if number is not None:
                        return number
                    typed = ""
                elif key == "backspace":
                    typed = typed[:-1]
                elif len(typed) < 12:
                    typed += _DIGITS.get(key, _SIGNS.get(key, ""))
            self._text.text = f"{typed} cd/m²" if typed else self._text.text if not self._shown else ""
            self.draw()
            self.window.flip()

    def framebuffer(self) -> np.ndarray:
        """What was drawn since the last flip, as 8-bit code values: (height, width, 3), top row first."""
        self.window.movieFrames = []
        self.window.getMovieFrame(buffer="back")
        return np.asarray(self.window.movieFrames.pop().convert("RGB"))

    def _stimuli(self, patch: Patch) -> list[Any]:
        if patch.purpose == "ambient":
            return []
        around = []
        if patch.purpose == "veiling" and patch.position == "centre":
            around = [self._image((255, 255, 255), "full")]
        return [*around, self._image(patch.codes, patch.position)]

    def _image(self, codes: tuple[int, int, int], position: str) -> Any:
        from PIL import Image

        # An image at its own size, about a whole pixel: the code values reach the screen as they are.
        size = self._full_size if position == "full" else self._image_size
        picture = Image.new("RGB", size, codes)
        return self._visual.ImageStim(self.window, image=picture, size=size, pos=self._places[position], units="pix")


class ManualPhotometer:
    """Somebody who reads an instrument and types its number at the patch."""

    def __init__(self, window: PatchWindow, name: str) -> None:
        self._window = window
        self.name = name

    def read(self, patch: Patch, *, minutes: float) -> float | None:
        """The number typed; None for Escape."""
        return self._window.typed_number()


class AimedPhotometer:
    """A photometer that reads by itself, once somebody has aimed it at the place of a patch."""

    def __init__(self, window: PatchWindow, photometer: Photometer, pace: Pace, settle_s: float) -> None:
        self._window, self._photometer, self._pace, self._settle_s = window, photometer, pace, settle_s
        self._place: str | None = None
        self.name = photometer.name

    def read(self, patch: Patch, *, minutes: float) -> float | None:
        """Read the patch; where it stands elsewhere than the one before, after asking to aim. None for Escape."""
        place = "centre" if patch.position == "full" else patch.position
        if place != self._place:
            if not self._window.aim():
                return None
            self._pace.wait(self._settle_s)
            self._place = place
        return self._photometer.read(patch, minutes=minutes)


def _number(typed: str) -> float | None:
    try:
        number = float(typed)
    except ValueError:
        return None
    return number if 0 <= number < math.inf else None
