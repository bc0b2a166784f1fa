"""The screen of a pairwise or magnitude trial: one or two images, and the slider below them."""

from collections.abc import Mapping
from typing import Any

from gloss_experiments.design import Trial
from gloss_experiments.observers.observer import Judge
from gloss_experiments.session.state import Confirmed, Event, RatingChosen, SessionState, TimedOut, Trace
from gloss_experiments.window.button import Button
from gloss_experiments.window.layout import Layout
from gloss_experiments.window.pointer import rating_steps
from gloss_experiments.window.quit_question import wants_to_stop
from gloss_experiments.window.slider_path import n_changes, n_reversals
from gloss_experiments.window.stage import LINE_GRAY, MARKER_GRAY, Stage

__all__ = ["RatingScreen", "rating_by_key"]

_STEPS = {"left": -1, "right": 1, "shift+left": -10, "shift+right": 10, "pagedown": -10, "pageup": 10}


def rating_by_key(key: str, *, rating: int | None, typed: str) -> tuple[int | None, str]:
    """The rating after a key, and the digits typed so far.

    Digits write a rating, which needs no marker to start from: a marker put somewhere for the observer would be an
    anchor. The arrow keys move a marker that stands already, by 1, or by 10 with Shift; Page Up and Page Down by 10.

    Parameters
    ----------
    key
        As `Stage.pressed_keys` names it.
    rating
        The present rating; None before the first response.
    typed
        Digits typed just before.

    Examples
    --------
    >>> rating_by_key("3", rating=None, typed="")
    (3, '3')
    >>> rating_by_key("6", rating=3, typed="3")
    (36, '36')
    >>> rating_by_key("9", rating=36, typed="36")  # 369 is no rating: a new number begins
    (9, '9')
    >>> rating_by_key("right", rating=None, typed="")  # no marker yet
    (None, '')
    >>> rating_by_key("shift+right", rating=95, typed="")
    (100, '')
    """
    if len(key) == 1 and key in "0123456789":
        typed = typed + key if typed and typed != "0" and int(typed + key) <= 100 else key
        return int(typed), typed
    if key == "backspace" and len(typed) > 1:
        return int(typed[:-1]), typed[:-1]
    if key in _STEPS and rating is not None:
        return min(max(rating + _STEPS[key], 0), 100), ""
    return rating, ""


class RatingScreen:
    """Shows a trial, and turns mouse and keys into its events.

    Parameters
    ----------
    stage
        The window and what belongs to it.
    layout
        Where everything stands.
    images
        PsychoPy's image of each stimulus.
    judge
        The simulated observer; None for a person.
    """

    def __init__(self, stage: Stage, layout: Layout, images: Mapping[str, Any], judge: Judge | None) -> None:
        from psychopy import visual

        protocol = stage.protocol
        self._stage, self._layout, self._images, self._judge = stage, layout, images, judge
        self._limit_s = protocol.design.time_limit_s
        self.slider = visual.Slider(
            stage.window,
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
        self.slider.mouse = stage.pointer
        # The line is thin; a hand that comes near enough means it.
        self.slider.validArea.size = (1.05 * layout.slider_size[0], 3 * layout.slider_size[1])
        self._question = stage.text(protocol.texts.question, layout.question)
        labels = (protocol.slider.low_label, protocol.slider.high_label)
        self._labels = [stage.text(text, place) for text, place in zip(labels, layout.labels, strict=True)]
        for text, key in zip(
            (self._question, *self._labels), ("texts.question", "slider.low_label", "slider.high_label"), strict=True
        ):
            stage.refuse_overflow(text, key)
        self._readout = stage.text("", layout.readout)
        self._button = Button(stage, protocol.texts.confirm, layout.button, size=layout.button_size)
        top = (0, stage.size[1] // 2 - stage.line_px)
        self._practice = stage.text(protocol.texts.practice, top, gray=LINE_GRAY, vertical="top")
        self._typed = ""
        self._path: list[int] = []
        self._rests: list[int] = []
        self._first_response_s: float | None = None

    def begin(self, trial: Trial) -> None:
        """Clear the slider for `trial`; its clock starts with the first frame that shows it."""
        self.slider.reset()
        self._typed, self._path, self._rests, self._first_response_s = "", [], [], None
        self._button.forget()
        self._rate(trial)
        self._stage.window.callOnFlip(self._stage.clock.start)

    def _rate(self, trial: Trial) -> None:
        if self._stage.script is not None and self._judge is not None:
            self._stage.script.perform(rating_steps(self._judge.rate(trial), self._layout))

    def event(self, state: SessionState, trial: Trial) -> Event | None:
        """Show the trial, frame by frame, until the observer does something; None to stop the session here."""
        stage = self._stage
        while True:
            if stage.script is not None:
                stage.script.tick()
            stage.left_button.look()
            # A button still held from the last trial must come up first, or it would rate this one.
            self.slider.readOnly = not stage.left_button.armed
            self.draw(state, trial)
            stage.flip(recorded=True)
            keys = stage.pressed_keys()
            if "escape" in keys:
                if wants_to_stop(stage):
                    return None
                self._come_back(trial)
                continue
            by_key = self._typed_rating(keys, state.rating)
            if by_key is not None:
                self.slider.markerPos = by_key
                self._rests.append(by_key)
            elif stage.left_button.just_released and self.slider.markerPos is not None:
                self._rests.append(round(self.slider.markerPos))
            shown = None if self.slider.markerPos is None else round(self.slider.markerPos)
            if shown is not None and shown != state.rating:
                self._note_path(shown)
                return RatingChosen(shown)
            # A trial without a response cannot be confirmed, and its button is not there.
            if state.rating is not None and (self._button.clicked() or "space" in keys):
                return Confirmed(self._elapsed_s(), self._trace())
            # A scripted pointer takes as many frames as it takes; it answers as without a window.
            if self._limit_s is not None and stage.script is None and stage.clock.elapsed_s() >= self._limit_s:
                return TimedOut(self._elapsed_s(), self._trace())

    def _come_back(self, trial: Trial) -> None:
        self._button.forget()
        self._typed = ""
        self._rate(trial)

    def _typed_rating(self, keys: list[str], rating: int | None) -> int | None:
        before = rating
        for key in keys:
            rating, self._typed = rating_by_key(key, rating=rating, typed=self._typed)
        return None if rating == before else rating

    def _note_path(self, shown: int) -> None:
        if not self._path:
            self._first_response_s = self._elapsed_s()
        self._path.append(shown)

    def _elapsed_s(self) -> float | None:
        return None if self._stage.script is not None else self._stage.clock.elapsed_s()

    def _trace(self) -> Trace:
        frames = self._stage.frames.trial()
        return Trace(
            first_response_s=self._first_response_s,
            n_changes=n_changes(self._rests),
            n_reversals=n_reversals(self._path),
            lowest=min(self._path, default=None),
            highest=max(self._path, default=None),
            n_frames=frames.n_frames,
            n_dropped=frames.n_dropped,
            longest_frame_ms=frames.longest_frame_ms,
        )

    def draw(self, state: SessionState, trial: Trial) -> None:
        """Draw the trial into the back buffer."""
        for name, place in zip(trial.stimuli, self._layout.images, strict=True):
            self._images[name].pos = place  # an identical pair is one image drawn at two places
            self._images[name].draw()
        self._question.draw()
        self.slider.draw()
        for label in self._labels:
            label.draw()
        if trial.role == "practice":
            self._practice.draw()
        if state.rating is not None:
            self._readout.text = str(state.rating)
            self._readout.draw()
            self._button.draw()
