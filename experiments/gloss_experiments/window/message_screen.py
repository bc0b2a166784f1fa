"""What is said between trials: instructions, the end of practice, breaks with their progress, thanks, the summary."""

import time
from collections.abc import Sequence
from math import ceil
from typing import Any

from gloss_experiments.session.state import Continued, Event, Phase, SessionState
from gloss_experiments.window.quit_question import wants_to_stop
from gloss_experiments.window.stage import MARKER_GRAY, Stage

__all__ = ["MessageScreen", "minutes_and_seconds"]

PROGRESS_WIDTH_PX = 400


def minutes_and_seconds(seconds: float) -> str:
    """What is left of a rest; a begun second counts whole.

    Examples
    --------
    >>> minutes_and_seconds(89.2)
    '1:30'
    """
    minutes, rest = divmod(max(0, ceil(seconds)), 60)
    return f"{minutes}:{rest:02d}"


class MessageScreen:
    """Shows texts until the observer goes on."""

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        texts, line = stage.protocol.texts, stage.line_px
        self._message = stage.text("", (0, 0))
        self._pause = stage.text("", (0, 2 * line), vertical="bottom")
        self._bar = stage.box((0, -line), (PROGRESS_WIDTH_PX, 6))
        self._done_bar = stage.box((0, -line), (2, 6), fill=MARKER_GRAY, line=None)
        self._progress = stage.text("", (0, -2 * line))
        self._countdown = stage.text("", (0, line))
        self._texts = texts
        self._rest_until_s: float | None = None
        self._refuse_what_does_not_fit()

    def _refuse_what_does_not_fit(self) -> None:
        texts = self._texts
        for key in ("practice_done", "pause", "time_up", "quit_question", "finished", "instructions"):
            text = getattr(texts, key)
            self._stage.write(self._message, f"{text}\n\n{texts.start}" if key == "instructions" else text)
            self._stage.refuse_overflow(self._message, f"texts.{key}")

    def event(self, state: SessionState) -> Event | None:
        """Show what `state` says until the observer goes on; None to stop the session here."""
        rest_s = self._stage.protocol.design.break_min_s
        resting = state.phase is Phase.PAUSE and self._stage.script is None
        self._rest_until_s = time.monotonic() + rest_s if resting else None
        self._stage.begin_anew()
        while True:
            self.draw(state)
            self._stage.flip()
            keys = self._stage.pressed_keys()
            if "escape" in keys and wants_to_stop(self._stage):
                return None
            if ("space" in keys and self._rest_left_s() <= 0) or self._stage.script is not None:
                return Continued()

    def time_up(self) -> bool:
        """Say that the time for the trial is over, until the observer goes on; False to stop the session here.

        It waits for the space bar: trials that pass while nobody is there would be lost.
        """
        self._stage.write(self._message, self._texts.time_up)
        self._stage.begin_anew()
        while True:
            self._message.draw()
            self._stage.flip()
            keys = self._stage.pressed_keys()
            if "escape" in keys and wants_to_stop(self._stage):
                return False
            if "space" in keys:
                return True

    def finish(self, state: SessionState, summary: Sequence[str]) -> None:
        """Thank the observer; the key S shows the experimenter the `summary`, and any other key ends the session."""
        self._stage.begin_anew()
        page = None
        while self._stage.script is None:
            if page is not None:
                page.draw()
            else:
                self.draw(state)
            self._stage.flip()
            keys = self._stage.pressed_keys()
            if summary and page is None and "s" in keys:
                page = self.summary_page(summary)
            elif keys:
                return

    def draw(self, state: SessionState) -> None:
        """Draw what `state` says into the back buffer."""
        texts = self._texts
        if state.phase is Phase.PAUSE:
            self._draw_pause(state)
            return
        message = {
            Phase.READY: f"{texts.instructions}\n\n{texts.start}",
            Phase.PRACTICE_DONE: texts.practice_done,
        }
        self._stage.write(self._message, message.get(state.phase, texts.finished))
        self._message.draw()

    def _rest_left_s(self) -> float:
        return 0.0 if self._rest_until_s is None else self._rest_until_s - time.monotonic()

    def _draw_pause(self, state: SessionState) -> None:
        # The last paragraph says how to go on: it comes once the rest is over.
        rest, _, _ = self._texts.pause.rpartition("\n\n")
        left_s = self._rest_left_s()
        self._stage.write(self._pause, self._texts.pause if left_s <= 0 or not rest else rest)
        self._pause.draw()
        if left_s > 0:
            self._stage.write(self._countdown, minutes_and_seconds(left_s))
            self._countdown.draw()
        done, total = state.progress
        self._bar.draw()
        width = max(2, round(PROGRESS_WIDTH_PX * done / total))
        self._done_bar.width, self._done_bar.pos = width, ((width - PROGRESS_WIDTH_PX) / 2, self._bar.pos[1])
        self._done_bar.draw()
        self._stage.write(self._progress, self._texts.progress.format(done=done, total=total))
        self._progress.draw()

    def summary_page(self, lines: Sequence[str]) -> Any:
        """The experimenter's summary as a text to draw; a long one is smaller, so that all of it is there."""
        height_px = 1.5 * self._texts.size_px * len(lines)
        scale = min(1.0, 0.85 * self._stage.size[1] / height_px)
        return self._stage.text("\n".join(lines), (-self._stage.size[0] // 4, 0), anchor="left", scale=scale)
