"""A session as a pure state machine: no clock, no files, no window.

``advance(state, event)`` is all of it. A screen, a simulated observer without a screen and a resumed journal all drive
the same machine, so none of them can reach a state that the others cannot.

::

    READY --Continued--> PREVIEW (where there is one) --Continued--> RATING

    RATING --RatingChosen, OrderChosen--> RATING (with a rating, or an order)
    RATING --Confirmed, TimedOut--------> RATING         the next trial
                                      --> PRACTICE_DONE  the last practice trial --Continued--> RATING
                                      --> PAUSE          a block ended, or a break is due --Continued--> RATING
                                      --> DONE           the last trial
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
    "OrderChosen",
    "Phase",
    "RatingChosen",
    "SessionState",
    "TimedOut",
    "Trace",
    "advance",
    "checked_order",
    "checked_rating",
    "start_session",
]


class Phase(Enum):
    """What the observer is to do."""

    READY = "ready"  # read the instructions
    PREVIEW = "preview"  # look at the range of stimuli
    PRACTICE_DONE = "practice_done"  # practice is over, the real trials begin
    RATING = "rating"  # judge the trial on the screen
    PAUSE = "pause"  # rest: between two blocks, or because a break is due
    DONE = "done"


@dataclass(frozen=True)
class Trace:
    """How an answer came about: the path of the slider, and the frames of the trial.

    Attributes
    ----------
    first_response_s
        Time from the stimuli to the first response; None if there was none or nobody timed it.
    n_changes
        How often the slider came to rest at another value, or an item at another rank; the first response counts.
    n_reversals
        How often the slider changed its direction.
    lowest, highest
        Of the slider's values; None where it was not moved, and in a ranking.
    n_frames
        Frames shown.
    n_dropped, longest_frame_ms
        Frames that came late, and the longest time between two; None where no real display was used.
    """

    first_response_s: float | None = None
    n_changes: int = 0
    n_reversals: int = 0
    lowest: int | None = None
    highest: int | None = None
    n_frames: int = 0
    n_dropped: int | None = None
    longest_frame_ms: float | None = None


@dataclass(frozen=True)
class RatingChosen:
    """The observer put the slider to `rating`, 0 to 100; nothing is final yet."""

    rating: int


@dataclass(frozen=True)
class OrderChosen:
    """The observer arranged all items of a ranking, the lowest rank first; nothing is final yet."""

    order: tuple[str, ...]


@dataclass(frozen=True)
class Confirmed:
    """The observer confirmed the answer, `response_time_s` after the stimuli appeared (None if untimed)."""

    response_time_s: float | None = None
    trace: Trace | None = None


@dataclass(frozen=True)
class TimedOut:
    """The time limit of the trial passed before the observer confirmed an answer: what was chosen is not one."""

    response_time_s: float | None = None
    trace: Trace | None = None


@dataclass(frozen=True)
class Continued:
    """The observer goes on from the instructions, the preview, the end of practice or a pause."""


Event = RatingChosen | OrderChosen | Confirmed | TimedOut | Continued


@dataclass(frozen=True)
class Answer:
    """A confirmed judgement, or none where the time limit passed: a rating of 0 to 100, or the order of a ranking."""

    trial: Trial
    rating: int | None
    response_time_s: float | None = None
    order: tuple[str, ...] | None = None
    trace: Trace | None = None
    timed_out: bool = False


@dataclass(frozen=True)
class SessionState:
    """Where a session stands.

    Attributes
    ----------
    trials
        All trials, those of practice first.
    n_answered
        How many of them are answered.
    rating, order
        What is chosen but not yet confirmed; None before the first response.
    last_answer
        The answer that `advance` made last.
    preview
        Whether the range of stimuli is shown after the instructions.
    break_every
        A break is due after so many trials without a pause; 0 for never.
    """

    trials: tuple[Trial, ...]
    phase: Phase
    n_answered: int = 0
    rating: int | None = None
    order: tuple[str, ...] | None = None
    last_answer: Answer | None = None
    preview: bool = False
    break_every: int = 0

    @property
    def trial(self) -> Trial | None:
        """The trial to judge next; None when all are judged."""
        return self.trials[self.n_answered] if self.n_answered < len(self.trials) else None

    @property
    def progress(self) -> tuple[int, int]:
        """How many trials are done, and of how many; practice does not count."""
        n_practice = sum(trial.role == "practice" for trial in self.trials)
        return max(0, self.n_answered - n_practice), len(self.trials) - n_practice


def start_session(
    trials: Sequence[Trial], *, n_answered: int = 0, preview: bool = False, break_every: int = 0
) -> SessionState:
    """The state at the start of a session, or where an interrupted one stopped after `n_answered` trials.

    Raises
    ------
    ValueError
        There are no trials, or fewer than `n_answered`.
    """
    if not trials or not 0 <= n_answered <= len(trials):
        raise ValueError(f"a session needs trials, and n_answered from 0 to {len(trials)}, not {n_answered}")
    phase = Phase.DONE if n_answered == len(trials) else Phase.READY
    return SessionState(tuple(trials), phase, n_answered, preview=preview, break_every=break_every)


def advance(state: SessionState, event: Event) -> SessionState:
    """The state after `event`.

    An event that means nothing in the present phase, such as the space bar before any response, changes nothing.

    Raises
    ------
    GlossError
        The rating is no whole number from 0 to 100, or the order is not one of the items of the trial.
    """
    match state.phase, event:
        case (Phase.READY, Continued()) if state.preview:
            return replace(state, phase=Phase.PREVIEW)
        case (Phase.READY | Phase.PREVIEW | Phase.PRACTICE_DONE | Phase.PAUSE, Continued()):
            return replace(state, phase=Phase.RATING, rating=None, order=None)
        case (Phase.RATING, RatingChosen(rating)) if state.trial is not None and not state.trial.items:
            return replace(state, rating=checked_rating(rating))
        case (Phase.RATING, OrderChosen(order)) if state.trial is not None and state.trial.items:
            return replace(state, order=checked_order(order, state.trial))
        case (Phase.RATING, Confirmed(time_s, trace)) if state.rating is not None or state.order is not None:
            return _answered(state, rating=state.rating, order=state.order, time_s=time_s, trace=trace)
        case (Phase.RATING, TimedOut(time_s, trace)):
            return _answered(state, rating=None, order=None, time_s=time_s, trace=trace, timed_out=True)
    return state


def _answered(
    state: SessionState,
    *,
    rating: int | None,
    order: tuple[str, ...] | None,
    time_s: float | None,
    trace: Trace | None,
    timed_out: bool = False,
) -> SessionState:
    trial = state.trials[state.n_answered]
    answer = Answer(trial, rating, time_s, order, trace, timed_out)
    after = replace(state, n_answered=state.n_answered + 1, rating=None, order=None, last_answer=answer)
    return replace(after, phase=_phase_between(trial, after))


def _phase_between(answered: Trial, after: SessionState) -> Phase:
    upcoming = after.trial
    if upcoming is None:
        return Phase.DONE
    if answered.role == "practice":
        return Phase.RATING if upcoming.role == "practice" else Phase.PRACTICE_DONE
    if upcoming.block != answered.block or _break_is_due(answered, after):
        return Phase.PAUSE
    return Phase.RATING


def _break_is_due(answered: Trial, after: SessionState) -> bool:
    # Counted within the block, since one block's end is a pause already.
    in_block = sum(trial.block == answered.block and trial.role != "practice" for trial in after.trials)
    rest = sum(trial.block == answered.block for trial in after.trials[after.n_answered :])
    return after.break_every > 0 and (in_block - rest) % after.break_every == 0


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


def checked_order(order: Sequence[str], trial: Trial) -> tuple[str, ...]:
    """Return `order` as an order of the items of a ranking.

    Raises
    ------
    GlossError
        It leaves out an item, repeats one, or holds another.

    Examples
    --------
    >>> checked_order(["dull", "glossy"], Trial(1, 1, 1, ("reference", "glossy", "dull")))
    ('dull', 'glossy')
    """
    if sorted(order) != sorted(trial.items):
        raise GlossError(
            f"The order {', '.join(order)} is not allowed; it names each of {', '.join(trial.items)} once."
        )
    return tuple(order)
