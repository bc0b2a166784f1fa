"""Driving the state machine: the presenter gives the events, and each confirmed trial goes to the journal at once."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Literal
from typing import Protocol as Interface

from gloss_experiments.observers.observer import Judge
from gloss_experiments.protocol import Protocol
from gloss_experiments.session.journal import Journal
from gloss_experiments.session.state import (
    Confirmed,
    Continued,
    Event,
    OrderChosen,
    Phase,
    RatingChosen,
    SessionState,
    advance,
)
from gloss_experiments.window.frames import FrameReport

__all__ = ["HeadlessPresenter", "Mode", "Presenter", "drive", "open_presenter"]

Mode = Literal["headless", "simulate", "screen"]


class Presenter(Interface):
    """Whoever turns the state of a session into the observer's next event: a screen, or a judge without one."""

    def next_event(self, state: SessionState) -> Event | None:
        """The next event; None to stop here."""

    def finish(self, state: SessionState, summary: Sequence[str] = ()) -> None:
        """All trials are answered; the lines of `summary` are for the experimenter."""

    def frame_report(self) -> FrameReport | None:
        """The frames shown so far; None where there is no window."""


@dataclass(frozen=True)
class HeadlessPresenter:
    """A simulated observer without a screen."""

    judge: Judge

    def next_event(self, state: SessionState) -> Event:
        """Go on, rate or rank, confirm."""
        if state.phase is not Phase.RATING or state.trial is None:
            return Continued()
        if state.trial.items:
            return OrderChosen(self.judge.rank(state.trial)) if state.order is None else Confirmed()
        return RatingChosen(self.judge.rate(state.trial)) if state.rating is None else Confirmed()

    def finish(self, state: SessionState, summary: Sequence[str] = ()) -> None:
        """Nobody is there to be thanked."""

    def frame_report(self) -> None:
        """No window, no frames."""


@contextmanager
def open_presenter(
    protocol: Protocol, images: Mapping[str, Path], *, judge: Judge | None, mode: Mode, remark: str = ""
) -> Iterator[Presenter]:
    """The presenter of a mode; `judge` is the simulated observer, None for a person. The window shows `remark`.

    Raises
    ------
    GlossError
        The mode needs a window and none can be opened.
    """
    if mode == "headless" and judge is not None:
        yield HeadlessPresenter(judge)
        return
    # Here alone, so that sessions without a window run where neither PsychoPy nor a display is.
    from gloss_experiments.window.screen import open_screen

    with open_screen(protocol, images, judge=judge, remark=remark) as screen:
        yield screen


def drive(
    state: SessionState,
    presenter: Presenter,
    journal: Journal,
    *,
    mode: Mode,
    on_trial: Callable[[int, int], None] | None = None,
) -> SessionState:
    """Run a session from `state` to its end, or to where the presenter stops it; returns the state reached.

    Raises
    ------
    GlossError
        A rating is not allowed, or the journal cannot be written.
    """
    while state.phase is not Phase.DONE:
        event = presenter.next_event(state)
        if event is None:
            _note_frames(presenter, journal)
            return state
        after = advance(state, event)
        if after.n_answered > state.n_answered and after.last_answer is not None:
            journal.append(after.last_answer, mode=mode)
            if on_trial is not None:
                on_trial(*after.progress)
        state = after
    _note_frames(presenter, journal)
    return state


def _note_frames(presenter: Presenter, journal: Journal) -> None:
    report = presenter.frame_report()
    if report is not None:
        journal.note("frames", **report.to_dict())
