"""The screen: shows the state of a session in a PsychoPy window, and turns mouse and keys into its events."""

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from gloss_experiments.design import Trial
from gloss_experiments.observers.observer import Judge
from gloss_experiments.protocol import Protocol
from gloss_experiments.session.state import Event, Phase, SessionState, TimedOut
from gloss_experiments.window.frames import FrameRecorder, FrameReport
from gloss_experiments.window.layout import Layout, arrange
from gloss_experiments.window.message_screen import MessageScreen
from gloss_experiments.window.preview_screen import PreviewScreen
from gloss_experiments.window.ranking_layout import RankingLayout, arrange_ranking
from gloss_experiments.window.ranking_screen import RankingScreen
from gloss_experiments.window.rating_screen import RatingScreen
from gloss_experiments.window.stage import Stage
from gloss_experiments.window.window import open_window, refresh_period_s
from glossspace.errors import GlossError

__all__ = ["Screen", "open_screen"]


@contextlib.contextmanager
def open_screen(
    protocol: Protocol, images: Mapping[str, Path], *, judge: Judge | None = None, remark: str = ""
) -> Iterator["Screen"]:
    """Open the window of a session, with all images loaded.

    Parameters
    ----------
    protocol
        What to show, and where.
    images
        8-bit PNG of each stimulus, shown pixel for pixel.
    judge
        A simulated observer, which rates with a scripted mouse; None for a person.
    remark
        What the lower edge of every screen says, such as that the session is a pilot.

    Raises
    ------
    GlossError
        No window can be opened, an image cannot be shown as it is, or a trial does not fit into the window.
    """
    size = _common_size(images)
    with open_window(protocol, simulated=judge is not None) as window:
        frames = FrameRecorder(None if judge is not None else refresh_period_s(window))
        stage = Stage(window, protocol, simulated=judge is not None, remark=remark, frames=frames)
        yield Screen(stage, images, image_size=size, judge=judge)


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
    """An open session window with a screen for each kind of state; make one with `open_screen`."""

    def __init__(
        self, stage: Stage, images: Mapping[str, Path], *, image_size: tuple[int, int], judge: Judge | None
    ) -> None:
        protocol = stage.protocol
        self._stage = stage
        self._shown: Trial | None = None
        self._messages = MessageScreen(stage)
        self._preview = PreviewScreen(stage, images, image_size) if protocol.design.preview else None
        pictures = {name: stage.picture(path) for name, path in images.items()}
        self.layout: Layout | RankingLayout
        self._trial_screen: RatingScreen | RankingScreen
        if protocol.kind == "ranking":
            self.layout = arrange_ranking(
                protocol, image_size_px=image_size, window_size_px=stage.size, n_items=len(images) - 1
            )
            self._trial_screen = RankingScreen(stage, self.layout, pictures, images, judge)
        else:
            self.layout = arrange(protocol, image_size_px=image_size, window_size_px=stage.size)
            self._trial_screen = RatingScreen(stage, self.layout, pictures, judge)
        _upload(stage, pictures)

    @property
    def window(self) -> Any:
        """PsychoPy's window."""
        return self._stage.window

    @property
    def refresh_s(self) -> float | None:
        """Measured refresh period of the display, in seconds; None where it is virtual or not steady."""
        return self._stage.frames.refresh_s

    def next_event(self, state: SessionState) -> Event | None:
        """Show `state`, frame by frame, until the observer does something; None when Escape ends the session."""
        if state.phase is Phase.PREVIEW and self._preview is not None:
            return self._preview.event(state)
        if state.phase is not Phase.RATING or state.trial is None:
            return self._messages.event(state)
        if self._shown is not state.trial:
            self._begin(state.trial)
        event = self._trial_screen.event(state, state.trial)
        if isinstance(event, TimedOut) and not self._messages.time_up():
            return None
        return event

    def _begin(self, trial: Trial) -> None:
        self._stage.blank(self._stage.protocol.display.blank_s)
        self._shown = trial
        self._stage.begin_anew()
        self._stage.frames.begin_trial()
        self._trial_screen.begin(trial)

    def finish(self, state: SessionState, summary: Sequence[str] = ()) -> None:
        """Thank a person, until a key is pressed; the key S shows the experimenter the lines of `summary`."""
        self._messages.finish(state, summary)

    def frame_report(self) -> FrameReport:
        """The frames of all trials shown so far."""
        return self._stage.frames.session()

    def draw(self, state: SessionState) -> None:
        """Draw `state` into the back buffer."""
        if state.phase is Phase.PREVIEW and self._preview is not None:
            self._preview.draw(state)
        elif state.phase is Phase.RATING and state.trial is not None:
            self._trial_screen.draw(state, state.trial)
        else:
            self._messages.draw(state)

    def framebuffer(self) -> np.ndarray:
        """What was drawn since the last flip, as 8-bit code values: (height, width, 3), top row first."""
        return self._stage.framebuffer()


def _upload(stage: Stage, pictures: Mapping[str, Any]) -> None:
    # Drawn once, so that the driver holds them: else the first trial of each stimulus would show it a frame late.
    for picture in pictures.values():
        picture.draw()
    stage.window.clearBuffer()
