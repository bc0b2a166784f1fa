"""The screen: shows the state of a session in a PsychoPy window, and turns mouse and keys into its events."""

import contextlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from gloss_experiments.design import Trial
from gloss_experiments.layout import Layout, arrange, checked_angle_deg
from gloss_experiments.observer import Judge
from gloss_experiments.pointer import Pointer, ScriptedPointer
from gloss_experiments.protocol import Protocol
from gloss_experiments.session import Confirmed, Continued, Event, Phase, RatingChosen, SessionState
from gloss_experiments.window import open_window, own_fonts
from glossspace.errors import GlossError

__all__ = ["Screen", "open_screen"]

# Grays in PsychoPy's -1 to 1: legible, and dim enough not to change the eye's adaptation in a dark room.
TEXT_GRAY = 0.2
LINE_GRAY = -0.3
MARKER_GRAY = 0.5
BUTTON_GRAY = -0.8


@contextlib.contextmanager
def open_screen(protocol: Protocol, images: Mapping[str, Path], *, judge: Judge | None = None) -> Iterator["Screen"]:
    """Open the window of a session, with all images loaded.

    Parameters
    ----------
    protocol
        What to show, and where.
    images
        8-bit PNG of each stimulus, shown pixel for pixel.
    judge
        A simulated observer, which rates with a scripted mouse; None for a person.

    Raises
    ------
    GlossError
        No window can be opened, an image cannot be shown as it is, or a trial does not fit into the window.
    """
    size = _common_size(images)
    if judge is None:
        checked_angle_deg(protocol, size[0])
    with open_window(protocol, simulated=judge is not None) as window:
        layout = arrange(protocol, image_size_px=size, window_size_px=(int(window.size[0]), int(window.size[1])))
        yield Screen(window, protocol, layout, images, judge)


def _common_size(images: Mapping[str, Path]) -> tuple[int, int]:
    sizes: dict[tuple[int, int], Path] = {}
    for path in images.values():
        with Image.open(path) as image:
            if image.mode not in ("L", "RGB"):
                raise GlossError(f"The image '{path}' has mode '{image.mode}'; give an 8-bit PNG, gray or RGB.")
            sizes.setdefault(image.size, path)
    if len(sizes) > 1:
        found = ", ".join(f"{width} x {height} in '{path}'" for (width, height), path in sizes.items())
        raise GlossError(f"The images of a session must have one size, but there are {found}.")
    return next(iter(sizes))


class Screen:
    """An open session window; make one with `open_screen`."""

    def __init__(
        self, window: Any, protocol: Protocol, layout: Layout, images: Mapping[str, Path], judge: Judge | None
    ) -> None:
        from psychopy import core, event, visual

        self.layout = layout
        self._window, self._protocol, self._judge = window, protocol, judge
        self._event, self._wait = event, core.wait
        self._clock = core.Clock()
        self._shown: Trial | None = None
        self._armed = False
        self._pressed_button = False
        self._was_down = False
        self._script = ScriptedPointer(layout) if judge is not None else None
        self._mouse: Pointer = self._script or event.Mouse(visible=True, win=window)

        # No size is given: an image drawn at its own size, about a whole pixel, is shown pixel for pixel.
        self._images = {name: visual.ImageStim(window, image=str(path), units="pix") for name, path in images.items()}
        self._slider = visual.Slider(
            window,
            ticks=(0, 100),
            labels=None,
            pos=layout.slider,
            size=layout.slider_size,
            units="pix",
            granularity=1,
            lineColor=LINE_GRAY,
            markerColor=MARKER_GRAY,
            font=protocol.texts.font,
            labelHeight=protocol.texts.size_px,
        )
        self._slider.mouse = self._mouse
        # The line is thin; a hand that comes near enough means it.
        self._slider.validArea.size = (1.05 * layout.slider_size[0], 3 * layout.slider_size[1])
        self._question = self._text(protocol.texts.question, layout.question)
        self._labels = [
            self._text(text, place)
            for text, place in zip((protocol.slider.low_label, protocol.slider.high_label), layout.labels, strict=True)
        ]
        self._readout = self._text("", layout.readout)
        self._button = visual.Rect(
            window,
            width=layout.button_size[0],
            height=layout.button_size[1],
            pos=layout.button,
            units="pix",
            fillColor=(BUTTON_GRAY,) * 3,
            lineColor=(LINE_GRAY,) * 3,
            colorSpace="rgb",
        )
        self._button_text = self._text(protocol.texts.confirm, layout.button)
        self._message = self._text("", (0, 0))
        # No picture of such a session shall pass for one with a person.
        self._remark = self._text("Simulated observer", (0, -int(window.size[1]) // 2 + protocol.texts.size_px))

    def _text(self, text: str, place: tuple[int, int]) -> Any:
        from psychopy import visual

        texts = self._protocol.texts
        return visual.TextStim(
            self._window,
            text=text,
            pos=place,
            units="pix",
            height=texts.size_px,
            font=texts.font,
            fontFiles=own_fonts(),
            color=(TEXT_GRAY,) * 3,
            colorSpace="rgb",
            wrapWidth=0.8 * float(self._window.size[0]),
        )

    def next_event(self, state: SessionState) -> Event | None:
        """Show `state`, frame by frame, until the observer does something; None when Escape ends the session."""
        if state.phase is not Phase.RATING or state.trial is None:
            return self._message_event(state)
        if self._shown is not state.trial:
            self._begin(state.trial)
        return self._rating_event(state)

    def _message_event(self, state: SessionState) -> Event | None:
        self._event.clearEvents()
        while True:
            self.draw(state)
            self._window.flip()
            keys = self._event.getKeys()
            if "escape" in keys:
                return None
            if "space" in keys or self._script is not None:
                return Continued()

    def finish(self, state: SessionState) -> None:
        """Show a person that the session is complete, until a key is pressed."""
        self._event.clearEvents()
        while self._script is None and not self._event.getKeys():
            self.draw(state)
            self._window.flip()

    def _begin(self, trial: Trial) -> None:
        self._window.flip()
        if self._script is None:
            self._wait(self._protocol.display.blank_s)
        self._slider.reset()
        self._shown = trial
        # A button still held from the last trial must come up first, or it would rate this one.
        self._armed = False
        self._pressed_button = False
        self._event.clearEvents()
        if self._script is not None and self._judge is not None:
            self._script.rate(self._judge.rate(trial))
        self._window.callOnFlip(self._clock.reset)

    def _rating_event(self, state: SessionState) -> Event | None:
        while True:
            if self._script is not None:
                self._script.tick()
            self._armed = self._armed or not self._mouse.getPressed()[0]
            self._slider.readOnly = not self._armed
            self.draw(state)
            self._window.flip()
            keys = self._event.getKeys()
            if "escape" in keys:
                return None
            chosen = self._slider.markerPos
            if chosen is not None and round(chosen) != state.rating:
                return RatingChosen(round(chosen))
            if self._button_released() or "space" in keys:
                return Confirmed(None if self._script is not None else self._clock.getTime())

    def _button_released(self) -> bool:
        """Whether the mouse was pressed on the button and has been let go there."""
        was_pressed, on_button = self._pressed_button, self._button.contains(self._mouse)
        down = self._armed and bool(self._mouse.getPressed()[0])
        self._pressed_button = down and on_button and (was_pressed or not self._was_down)
        self._was_down = down
        return was_pressed and not down and bool(on_button)

    def draw(self, state: SessionState) -> None:
        """Draw `state` into the back buffer."""
        if state.phase is not Phase.RATING or state.trial is None:
            self._draw_message(state)
            return
        if self._script is not None:
            self._remark.draw()
        for name, place in zip(state.trial.stimuli, self.layout.images, strict=True):
            self._images[name].pos = place  # an identical pair is one image drawn at two places
            self._images[name].draw()
        self._question.draw()
        self._slider.draw()
        for label in self._labels:
            label.draw()
        if state.rating is not None:
            self._readout.text = str(state.rating)
            self._readout.draw()
            self._button.draw()
            self._button_text.draw()

    def _draw_message(self, state: SessionState) -> None:
        texts = self._protocol.texts
        message = {
            Phase.READY: f"{texts.instructions}\n\n{texts.start}",
            Phase.PAUSE: f"{texts.pause}\n\n{state.n_answered} / {len(state.trials)}",
        }
        self._message.text = message.get(state.phase, texts.finished)
        self._message.draw()

    def framebuffer(self) -> np.ndarray:
        """What was drawn since the last flip, as 8-bit code values: (height, width, 3), top row first."""
        self._window.movieFrames = []
        self._window.getMovieFrame(buffer="back")
        return np.asarray(self._window.movieFrames.pop().convert("RGB"))
