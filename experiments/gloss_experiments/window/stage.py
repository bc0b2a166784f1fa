"""The stage of a session: its window, texts and grays, pointer, keys and frames, which all its screens share."""

import time
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from gloss_experiments.protocol import Protocol
from gloss_experiments.window.frames import FrameRecorder
from gloss_experiments.window.pointer import LeftButton, Pointer, ScriptedPointer
from gloss_experiments.window.trial_clock import TrialClock
from gloss_experiments.window.window import own_fonts
from gloss_experiments.window.writing import language_style, protocol_texts, require_font, written
from glossspace.errors import GlossError

__all__ = ["BUTTON_GRAY", "FAINT_GRAY", "LINE_GRAY", "MARKER_GRAY", "TEXT_GRAY", "Stage"]

# Grays in PsychoPy's -1 to 1: legible, and dim enough not to change the eye's adaptation in a dark room.
TEXT_GRAY = 0.2
LINE_GRAY = -0.3
MARKER_GRAY = 0.5
FAINT_GRAY = -0.6
BUTTON_GRAY = -0.8
# Share of the window's width that a text may take.
_WIDEST = 0.8


class Stage:
    """An open window and what belongs to it.

    Parameters
    ----------
    window
        PsychoPy's window, in pixel units.
    protocol
        Its texts, their font and size.
    simulated
        Whether a scripted pointer answers.
    remark
        What the lower edge of every screen says, such as that a session is a pilot.
    frames
        Where the frames are recorded.

    Raises
    ------
    GlossError
        The protocol's font is not here, or lacks signs of its texts.
    """

    def __init__(
        self, window: Any, protocol: Protocol, *, simulated: bool, remark: str = "", frames: FrameRecorder | None = None
    ) -> None:
        from psychopy import core, event

        self.window, self.protocol = window, protocol
        self._event, self._wait = event, core.wait
        self.size = (int(window.size[0]), int(window.size[1]))
        self.line_px = 2 * round(0.8 * protocol.texts.size_px)
        require_font(window, protocol)
        self._style = language_style(protocol_texts(protocol))
        self.script = ScriptedPointer() if simulated else None
        self.pointer: Pointer = self.script or event.Mouse(visible=True, win=window)
        self.left_button = LeftButton(self.pointer)
        self.clock = TrialClock()
        self.frames = frames or FrameRecorder()
        self._close_asked = False
        # The window's own close button asks as Escape does: PsychoPy would close the window under the session.
        window.winHandle.on_close = self._on_close
        # No picture of such a session shall pass for one with a person.
        remark = " · ".join(filter(None, ("Simulated observer" if simulated else "", remark)))
        self._remark = self.text(remark, (0, -self.size[1] // 2 + protocol.texts.size_px)) if remark else None

    def _on_close(self) -> bool:
        self._close_asked = True
        return True  # handled: pyglet does nothing more

    def text(
        self,
        text: str,
        place: tuple[int, int],
        *,
        gray: float = TEXT_GRAY,
        anchor: str = "center",
        vertical: str = "center",
        scale: float = 1.0,
    ) -> Any:
        """A text in the protocol's font. `place` is its centre, or the edge that `anchor` and `vertical` name."""
        from psychopy import visual

        texts = self.protocol.texts
        stim = visual.TextStim(
            self.window,
            text="",
            pos=place,
            units="pix",
            height=scale * texts.size_px,
            font=texts.font,
            fontFiles=own_fonts(),
            color=(gray,) * 3,
            colorSpace="rgb",
            anchorHoriz=anchor,
            anchorVert=vertical,
            alignText=anchor,
            wrapWidth=_WIDEST * self.size[0],
            languageStyle=self._style,
        )
        self.write(stim, text)
        return stim

    def write(self, stim: Any, text: str) -> None:
        """Let a text of this stage say something else."""
        width_px = _WIDEST * self.size[0]
        stim.text = written(text, font=self.protocol.texts.font, height_px=stim.height, width_px=width_px)

    def refuse_overflow(self, text: Any, key: str) -> None:
        """Refuse a centred text that goes beyond the window.

        Raises
        ------
        GlossError
            It does; `key` names it in the protocol.
        """
        over = [
            abs(place) + extent / 2 > size / 2
            for place, extent, size in zip(text.pos, text.boundingBox, self.size, strict=True)
        ]
        if any(over):
            width, height = self.size
            raise GlossError(
                f"{key} does not fit into the window of {width} x {height} pixels: '{_beginning(text.text)}'. "
                "Shorten it, or lower texts.size_px."
            )

    def picture(self, image: Path | Image.Image) -> Any:
        """An image at its own size: about a whole pixel it is shown pixel for pixel. Its `pos` says where."""
        from psychopy import visual

        return visual.ImageStim(self.window, image=str(image) if isinstance(image, Path) else image, units="pix")

    def box(
        self,
        place: tuple[int, int],
        size: tuple[int, int],
        *,
        fill: float | None = None,
        line: float | None = LINE_GRAY,
    ) -> Any:
        """A rectangle about `place`."""
        from psychopy import visual

        return visual.Rect(
            self.window,
            width=size[0],
            height=size[1],
            pos=place,
            units="pix",
            fillColor=None if fill is None else (fill,) * 3,
            lineColor=None if line is None else (line,) * 3,
            colorSpace="rgb",
        )

    def flip(self, *, recorded: bool = False) -> None:
        """Show what was drawn; `recorded` where the frame belongs to a trial."""
        if self._remark is not None:
            self._remark.draw()
        called_s = time.perf_counter()
        self.window.flip()
        if recorded:
            self.frames.flipped(called_s=called_s, returned_s=time.perf_counter())

    def blank(self, seconds: float) -> None:
        """Show nothing for so long; the window stays alive. A scripted pointer does not wait."""
        self.window.flip()
        if self.script is None:
            self._wait(seconds)

    def pressed_keys(self) -> list[str]:
        """Keys pressed since the last call: ``"space"``, ``"left"``, ``"shift+left"``, ``"7"``, ``"escape"`` …"""
        pressed = self._event.getKeys(modifiers=True)
        keys = [("shift+" if modifiers["shift"] else "") + name.removeprefix("num_") for name, modifiers in pressed]
        if self._close_asked:
            self._close_asked = False
            keys.append("escape")
        return ["return" if key == "enter" else key for key in keys]

    def begin_anew(self) -> None:
        """Forget keys pressed so far, and wait for the button to come up before a press counts."""
        self._event.clearEvents()
        self.left_button.rearm()

    def framebuffer(self) -> np.ndarray:
        """What was drawn since the last flip, as 8-bit code values: (height, width, 3), top row first."""
        self.window.movieFrames = []
        self.window.getMovieFrame(buffer="back")
        return np.asarray(self.window.movieFrames.pop().convert("RGB"))


def _beginning(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= 40 else line[:39] + "…"
