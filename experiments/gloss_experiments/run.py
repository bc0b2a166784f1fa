"""Running one session: the state machine, driven by a person or a simulated observer, journalled trial by trial."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args
from typing import Protocol as Interface

from gloss_experiments.design import design_trials, session_seed
from gloss_experiments.journal import Journal, journal_path
from gloss_experiments.observer import Judge, SimulatedObserver, observer_named
from gloss_experiments.protocol import Protocol, read_protocol
from gloss_experiments.provenance import circumstances, images_sha256
from gloss_experiments.session import (
    Answer,
    Confirmed,
    Continued,
    Event,
    Phase,
    RatingChosen,
    SessionState,
    advance,
    start_session,
)
from glossspace.dataset import (
    data_path,
    read_simulated_observers,
    record_simulated_observer,
    update_description,
    write_session_data,
)
from glossspace.dataset.schema import checked_label
from glossspace.dataset.write import Row
from glossspace.errors import GlossError
from glossspace.stimulus_set import StimulusSet, read_stimulus_set

__all__ = ["Mode", "SessionResult", "run_session"]

Mode = Literal["headless", "simulate", "screen"]


@dataclass(frozen=True)
class SessionResult:
    """What a session left.

    Attributes
    ----------
    data_path
        The data file; None where the session was stopped before its end.
    journal_path
        The journal, with every trial judged so far.
    n_trials, n_answered, n_before
        Trials of the session, how many are judged, and how many of those were judged before this run.
    simulated
        Whether a program answered.
    already_finished
        Whether there was nothing left to do.
    torn
        Whether the last line of the journal was torn by a kill and its trial shown again.
    """

    participant_id: str
    session: str
    task: str
    data_path: Path | None
    journal_path: Path
    n_trials: int
    n_answered: int
    n_before: int
    simulated: bool
    mode: Mode
    seed: int
    already_finished: bool = False
    torn: bool = False


class Presenter(Interface):
    """Whoever turns the state of a session into the observer's next event: a screen, or a judge without one."""

    def next_event(self, state: SessionState) -> Event | None:
        """The next event; None to stop here."""

    def finish(self, state: SessionState) -> None:
        """All trials are judged."""


@dataclass(frozen=True)
class HeadlessPresenter:
    """A simulated observer without a screen."""

    judge: Judge

    def next_event(self, state: SessionState) -> Event:
        """Go on, rate, confirm."""
        if state.phase is not Phase.RATING or state.trial is None:
            return Continued()
        return RatingChosen(self.judge.rate(state.trial)) if state.rating is None else Confirmed()

    def finish(self, state: SessionState) -> None:
        """Nobody is there to be thanked."""


def run_session(
    protocol: str | Path | Protocol,
    *,
    stimuli: str | Path | StimulusSet,
    dataset: str | Path,
    participant: str,
    session: str | int = "1",
    mode: Mode = "headless",
    seed: int | None = None,
    observer: SimulatedObserver | None = None,
    on_trial: Callable[[int, int], None] | None = None,
) -> SessionResult:
    """Run a session, or what is left of it, and write its data file.

    An interrupted session goes on at the next trial, in the same order; a finished one is left as it is. Data are never
    overwritten.

    Parameters
    ----------
    protocol
        A protocol, a TOML file, or the name of a shipped one: ``"pairwise"``, ``"contrast"``, ``"doi"``.
    stimuli
        A stimulus set or its folder; its files are checked against their hashes.
    dataset
        Folder of the dataset; made if absent.
    participant, session
        Letters and digits.
    mode
        ``"screen"``: a person at the screen. ``"simulate"``: a simulated observer through the real window.
        ``"headless"``: a simulated observer without one. The last two give the same answers.
    seed
        Of the study, 0 by default. With participant, session and protocol it fixes the order of the trials and the
        simulated answers. Without one, an interrupted session keeps its own.
    observer
        The simulated observer; by default the one drawn for this participant and seed.
    on_trial
        Called with the number of trials judged and their total, after each.

    Raises
    ------
    GlossError
        Something given is wrong, the session was begun with something else, or another process runs it.

    Examples
    --------
    >>> run_session("pairwise", stimuli="set", dataset="study", participant="01").n_trials  # doctest: +SKIP
    378
    """
    if mode not in get_args(Mode):
        raise GlossError(f"Unknown mode '{mode}'; allowed are {', '.join(get_args(Mode))}.")
    if mode == "screen" and observer is not None:
        raise GlossError("A simulated observer was given, but mode 'screen' is for a person; use 'simulate'.")
    protocol = protocol if isinstance(protocol, Protocol) else read_protocol(protocol)
    participant = checked_label(participant, what="participant")
    session = checked_label(session, what="session")
    stimulus_set = stimuli if isinstance(stimuli, StimulusSet) else read_stimulus_set(stimuli)
    dataset = Path(dataset)
    if dataset.exists() and not dataset.is_dir():
        raise GlossError(f"The dataset '{dataset}' is a file; give a folder, which is made if absent.")

    journal = Journal(journal_path(dataset, participant=participant, session=session, task=protocol.name))
    data = data_path(dataset, participant=participant, session=session, task=protocol.name)
    if data.exists() and not journal.path.exists():
        raise GlossError(
            f"The data file '{data}' exists without its journal: the session is finished and is never run again. "
            "Give the participant another session number."
        )
    seed = _study_seed(seed, journal.path)
    order_seed = session_seed(seed, participant=participant, session=session, task=protocol.name)
    trials = design_trials(protocol, [stimulus.name for stimulus in stimulus_set.stimuli], seed=order_seed)
    if mode != "screen":
        observer = observer or observer_named(participant, seed=seed)
    _keep_people_and_programs_apart(dataset, participant, observer)
    header = {
        "participant": participant,
        "session": session,
        "task": protocol.name,
        "seed": seed,
        "n_trials": len(trials),
        "protocol_sha256": protocol.sha256(),
        "stimulus_set": stimulus_set.name,
        "stimuli_sha256": images_sha256(stimulus_set, trials),
        "observer": {"kind": "human"} if observer is None else {"kind": "simulated", **observer.parameters()},
        "protocol": protocol.model_dump(mode="json"),
        **circumstances(mode),
    }
    with journal:
        n_before = len(journal.answers)
        resumed = journal.header is not None and not journal.finished
        journal.begin(header)
        journal.check_order(trials)
        state = start_session(trials, n_answered=n_before)
        finished_before = state.phase is Phase.DONE and data.exists()
        if not finished_before:
            if resumed:
                journal.note("resumed", torn=journal.torn, **circumstances(mode))
            state = _run(state, journal, protocol, stimulus_set, observer, order_seed, mode, on_trial)
        if state.phase is Phase.DONE:
            journal.finish()
            _publish(journal.answers, dataset, data, protocol, participant, session, observer)
    return SessionResult(
        participant_id=participant,
        session=session,
        task=protocol.name,
        data_path=data if state.phase is Phase.DONE else None,
        journal_path=journal.path,
        n_trials=len(trials),
        n_answered=state.n_answered,
        n_before=n_before,
        simulated=observer is not None,
        mode=mode,
        seed=seed,
        already_finished=finished_before,
        torn=journal.torn,
    )


def _study_seed(seed: int | None, path: Path) -> int:
    if seed is not None:
        if seed < 0:
            raise GlossError(f"The seed {seed} is not allowed; it is a whole number from 0.")
        return seed
    if not path.exists():
        return 0
    with Journal(path) as journal:
        return int(journal.header["seed"]) if journal.header else 0


def _keep_people_and_programs_apart(dataset: Path, participant: str, observer: SimulatedObserver | None) -> None:
    known = read_simulated_observers(dataset)
    simulated_before = known is not None and participant in set(known["participant_id"])
    if observer is None and simulated_before:
        raise GlossError(f"Participant '{participant}' of '{dataset}' is simulated; give a person another identifier.")
    if observer is not None and not simulated_before and list((dataset / "journals").glob(f"subject-{participant}_*")):
        raise GlossError(
            f"Participant '{participant}' of '{dataset}' is a person; give a simulated observer another identifier."
        )
    if observer is not None:
        # Before the journal: whatever moment a kill comes, no simulated answer exists without its name in this list.
        record_simulated_observer(dataset, participant, observer.parameters())


def _run(
    state: SessionState,
    journal: Journal,
    protocol: Protocol,
    stimulus_set: StimulusSet,
    observer: SimulatedObserver | None,
    order_seed: int,
    mode: Mode,
    on_trial: Callable[[int, int], None] | None,
) -> SessionState:
    names = {name for trial in state.trials for name in trial.stimuli}
    judge = None
    if observer is not None:
        axes = {stimulus.name: (stimulus.c, stimulus.d) for stimulus in stimulus_set.stimuli if stimulus.name in names}
        judge = Judge(observer, axes, order_seed)
    if state.phase is Phase.DONE:  # killed after the last trial, before the data file
        return state
    with _presenter(protocol, stimulus_set, names, judge, mode) as presenter:
        while state.phase is not Phase.DONE:
            event = presenter.next_event(state)
            if event is None:
                break
            after = advance(state, event)
            if after.n_answered > state.n_answered and after.last_answer is not None:
                journal.append(after.last_answer, mode=mode)
                if on_trial is not None:
                    on_trial(after.n_answered, len(after.trials))
            state = after
        if state.phase is Phase.DONE:
            presenter.finish(state)
    return state


@contextmanager
def _presenter(
    protocol: Protocol, stimulus_set: StimulusSet, names: set[str], judge: Judge | None, mode: Mode
) -> Iterator[Presenter]:
    if mode == "headless":
        assert judge is not None  # every mode but "screen" has an observer
        yield HeadlessPresenter(judge)
        return
    from gloss_experiments.screen import open_screen

    images = {name: stimulus_set.image_path(name) for name in sorted(names)}
    with open_screen(protocol, images, judge=judge) as screen:
        yield screen


def _publish(
    answers: list[Answer],
    dataset: Path,
    data: Path,
    protocol: Protocol,
    participant: str,
    session: str,
    observer: SimulatedObserver | None,
) -> None:
    if data.exists():
        update_description(dataset)  # the kill may have come between the data file and its description
        return
    write_session_data(
        dataset,
        [_row(answer, protocol) for answer in answers],
        kind=protocol.kind,
        participant=participant,
        session=session,
        task=protocol.name,
        observer="human" if observer is None else "simulated",
    )


def _row(answer: Answer, protocol: Protocol) -> Row:
    trial = answer.trial
    row: Row = {"block": trial.block, "trial": trial.number, "repeat": trial.repeat}
    time_s = answer.response_time_s
    row["response_time_s"] = None if time_s is None else round(time_s, 3)
    if protocol.kind == "pairwise":
        left, right = trial.stimuli
        return row | {"stimulus_left": left, "stimulus_right": right, "dissimilarity": answer.rating}
    return row | {"stimulus": trial.stimuli[0], "rating": answer.rating}
