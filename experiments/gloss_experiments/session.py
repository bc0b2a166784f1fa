"""A session as a pure state machine: no clock, no files, no window.

``advance(state, event)`` is all of it. A screen, a simulated observer without a screen and a resumed journal all drive
the same machine, so none of them can reach a state that the others cannot.

::

    READY --Continued--> RATING --RatingChosen--> RATING (with a rating) --Confirmed--> RATING (next trial)
                           ^                                                        --> PAUSE (a block ended)
                           |-------------------------Continued-------------------------- PAUSE
                                                                                    --> DONE (the last trial)
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum

from gloss_experiments.design import Trial
from glossspace.errors import GlossError

__all__ = [
    "Answer",
    "Confirmed",
    "Continued",
    "Event",
    "Phase",
    "RatingChosen",
    "SessionState",
    "advance",
    "checked_rating",
    "start_session",
]


class Phase(Enum):
    """What the observer is to do."""

    READY = "ready"  # read the instructions
    RATING = "rating"  # judge the trial on the screen
    PAUSE = "pause"  # rest between two blocks
    DONE = "done"


@dataclass(frozen=True)
class RatingChosen:
    """The observer put the slider to `rating`, 0 to 100; nothing is final yet."""

    rating: int


@dataclass(frozen=True)
class Confirmed:
    """The observer confirmed the rating, `response_time_s` after the stimuli appeared (None if untimed)."""

    response_time_s: float | None = None


@dataclass(frozen=True)
class Continued:
    """The observer goes on from the instructions or from a pause."""


Event = RatingChosen | Confirmed | Continued


@dataclass(frozen=True)
class Answer:
    """A confirmed judgement."""

    trial: Trial
    rating: int
    response_time_s: float | None = None


@dataclass(frozen=True)
class SessionState:
    """Where a session stands. `rating` is the one chosen but not yet confirmed, None before the first response."""

    trials: tuple[Trial, ...]
    phase: Phase
    n_answered: int = 0
    rating: int | None = None
    last_answer: Answer | None = None

    @property
    def trial(self) -> Trial | None:
        """The trial to judge next; None when all are judged."""
        return self.trials[self.n_answered] if self.n_answered < len(self.trials) else None


def start_session(trials: Sequence[Trial], *, n_answered: int = 0) -> SessionState:
    """The state at the start of a session, or where an interrupted one stopped after `n_answered` trials.

    Raises
    ------
    ValueError
        There are no trials, or fewer than `n_answered`.
    """
    if not trials or not 0 <= n_answered <= len(trials):
        raise ValueError(f"a session needs trials, and n_answered from 0 to {len(trials)}, not {n_answered}")
    phase = Phase.DONE if n_answered == len(trials) else Phase.READY
    return SessionState(tuple(trials), phase, n_answered)


def advance(state: SessionState, event: Event) -> SessionState:
    """The state after `event`.

    An event that means nothing in the present phase, such as the space bar before any response, changes nothing.

    Raises
    ------
    GlossError
        The rating is no whole number from 0 to 100.
    """
    match state.phase, event:
        case (Phase.READY | Phase.PAUSE, Continued()):
            return replace(state, phase=Phase.RATING, rating=None)
        case (Phase.RATING, RatingChosen(rating)):
            return replace(state, rating=checked_rating(rating))
        case (Phase.RATING, Confirmed(response_time_s)) if state.rating is not None and state.trial is not None:
            answer = Answer(state.trial, state.rating, response_time_s)
            after = replace(state, n_answered=state.n_answered + 1, rating=None, last_answer=answer)
            return replace(after, phase=_phase_between(answer.trial, after.trial))
    return state


def _phase_between(answered: Trial, upcoming: Trial | None) -> Phase:
    if upcoming is None:
        return Phase.DONE
    return Phase.RATING if upcoming.block == answered.block else Phase.PAUSE


def checked_rating(value: object) -> int:
    """Return `value` as a rating.

    Raises
    ------
    GlossError
        It is no whole number from 0 to 100.

    Examples
    --------
    >>> checked_rating(40)
    40
    """
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= 100:
        raise GlossError(f"The rating {value!r} is not allowed; it is a whole number from 0 to 100.")
    return value
