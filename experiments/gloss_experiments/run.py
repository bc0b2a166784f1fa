"""Running one session: what is asked for is checked against what is on the disk, run or resumed, and published."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

from gloss_experiments.design import Trial, design_trials, session_seed
from gloss_experiments.drive import Mode, drive, open_presenter
from gloss_experiments.journal import Journal, journal_path
from gloss_experiments.layout import checked_angle_deg
from gloss_experiments.observer import Judge, SimulatedObserver, observer_named
from gloss_experiments.protocol import Protocol, read_protocol
from gloss_experiments.provenance import circumstances, images_sha256
from gloss_experiments.session import Answer, Phase, SessionState, start_session
from glossspace.dataset import (
    data_path,
    read_simulated_observers,
    record_simulated_observer,
    record_stimuli,
    update_description,
    write_session_data,
)
from glossspace.dataset.schema import checked_label
from glossspace.dataset.write import Row
from glossspace.errors import GlossError
from glossspace.stimulus_set import StimulusSet, read_stimulus_set

__all__ = ["Mode", "SessionResult", "run_session"]


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
    image_angle_deg
        Visual angle of an image on the screen; None where no screen was used or the protocol lacks its pixel pitch.
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
    image_angle_deg: float | None = None


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
    if seed is not None and seed < 0:
        raise GlossError(f"The seed {seed} is not allowed; it is a whole number from 0.")
    plan = _plan(protocol, stimuli, Path(dataset), participant, str(session), mode, seed, observer)
    with Journal(plan.journal) as journal:
        if journal.header is not None:
            journal.check(plan.fixed())
            journal.check_order(plan.trials)
        n_before = len(journal.answers)
        state = start_session(plan.trials, n_answered=n_before)
        already_finished = state.phase is Phase.DONE and plan.data.exists()
        if state.phase is not Phase.DONE:
            state = _run(plan, journal, state, on_trial)
        if state.phase is Phase.DONE:
            journal.finish()
            _publish(plan, journal.answers)
        return SessionResult(
            participant_id=plan.participant,
            session=plan.session,
            task=plan.protocol.name,
            data_path=plan.data if state.phase is Phase.DONE else None,
            journal_path=plan.journal,
            n_trials=len(plan.trials),
            n_answered=state.n_answered,
            n_before=n_before,
            simulated=plan.observer is not None,
            mode=mode,
            seed=plan.seed,
            already_finished=already_finished,
            torn=journal.torn,
            image_angle_deg=plan.image_angle_deg(),
        )


@dataclass(frozen=True)
class _Plan:
    """All that a session needs, checked: made before anything is written."""

    protocol: Protocol
    stimulus_set: StimulusSet
    dataset: Path
    participant: str
    session: str
    mode: Mode
    seed: int
    order_seed: int
    trials: tuple[Trial, ...]
    observer: SimulatedObserver | None
    journal: Path
    data: Path

    def images(self) -> dict[str, Path]:
        """The images that the trials show."""
        names = sorted({name for trial in self.trials for name in trial.stimuli})
        return {name: self.stimulus_set.image_path(name) for name in names}

    def image_angle_deg(self) -> float | None:
        """Visual angle of an image on the screen, where it is known."""
        on_screen = self.mode == "screen"
        return checked_angle_deg(self.protocol, self.stimulus_set.image_size[0]) if on_screen else None

    def fixed(self) -> dict[str, Any]:
        """What makes two runs parts of the same session."""
        simulated = {} if self.observer is None else self.observer.parameters()
        return {
            "participant": self.participant,
            "session": self.session,
            "task": self.protocol.name,
            "seed": self.seed,
            "protocol_sha256": self.protocol.sha256(),
            "stimuli_sha256": images_sha256(self.images()),
            "observer": {"kind": "human" if self.observer is None else "simulated", **simulated},
        }


def _plan(
    protocol: str | Path | Protocol,
    stimuli: str | Path | StimulusSet,
    dataset: Path,
    participant: str,
    session: str,
    mode: Mode,
    seed: int | None,
    observer: SimulatedObserver | None,
) -> _Plan:
    protocol = protocol if isinstance(protocol, Protocol) else read_protocol(protocol)
    participant = checked_label(participant, what="participant")
    session = checked_label(session, what="session")
    stimulus_set = stimuli if isinstance(stimuli, StimulusSet) else read_stimulus_set(stimuli)
    if dataset.exists() and not dataset.is_dir():
        raise GlossError(f"The dataset '{dataset}' is a file; give a folder, which is made if absent.")
    journal = journal_path(dataset, participant=participant, session=session, task=protocol.name)
    data = data_path(dataset, participant=participant, session=session, task=protocol.name)
    if data.exists() and not journal.exists():
        raise GlossError(
            f"The data file '{data}' exists without its journal: the session is finished and is never run again. "
            "Give the participant another session number."
        )
    if seed is None:
        seed = _seed_begun_with(journal)
    order_seed = session_seed(seed, participant=participant, session=session, task=protocol.name)
    trials = design_trials(protocol, [stimulus.name for stimulus in stimulus_set.stimuli], seed=order_seed)
    if mode != "screen":
        observer = observer or observer_named(participant, seed=seed)
    return _Plan(
        protocol, stimulus_set, dataset, participant, session, mode, seed, order_seed, trials, observer, journal, data
    )


def _seed_begun_with(path: Path) -> int:
    if not path.exists():
        return 0
    with Journal(path) as journal:
        return int(journal.header["seed"]) if journal.header else 0


def _run(
    plan: _Plan, journal: Journal, state: SessionState, on_trial: Callable[[int, int], None] | None
) -> SessionState:
    if journal.header is None:
        _keep_people_and_programs_apart(plan)
    images = plan.images()
    judge = None
    if plan.observer is not None:
        axes = {stimulus.name: (stimulus.c, stimulus.d) for stimulus in plan.stimulus_set.stimuli}
        judge = Judge(plan.observer, {name: axes[name] for name in images}, plan.order_seed)
    with open_presenter(plan.protocol, images, judge=judge, mode=plan.mode) as presenter:
        # Written once the window stands: a session that could not begin leaves nothing behind.
        if journal.header is not None:
            journal.note("resumed", torn=journal.torn, **circumstances(plan.mode))
        else:
            record_stimuli(plan.dataset, plan.stimulus_set)
            if plan.observer is not None:
                # Before the header: whenever a kill comes, no simulated answer is without its name in this list.
                record_simulated_observer(plan.dataset, plan.participant, plan.observer.parameters())
            details = {
                "n_trials": len(plan.trials),
                "image_angle_deg": plan.image_angle_deg(),
                "stimulus_set": plan.stimulus_set.name,
                "protocol": plan.protocol.model_dump(mode="json"),
            }
            journal.begin({**plan.fixed(), **details, **circumstances(plan.mode)})
        return drive(state, presenter, journal, mode=plan.mode, on_trial=on_trial)


def _keep_people_and_programs_apart(plan: _Plan) -> None:
    known = read_simulated_observers(plan.dataset)
    simulated_before = known is not None and plan.participant in set(known["participant_id"])
    who = f"Participant '{plan.participant}' of '{plan.dataset}'"
    if plan.observer is None and simulated_before:
        raise GlossError(f"{who} is simulated; give a person another identifier.")
    others = (path for path in plan.journal.parent.glob(f"subject-{plan.participant}_*") if path != plan.journal)
    if plan.observer is not None and not simulated_before and any(others):
        raise GlossError(f"{who} is a person; give a simulated observer another identifier.")


def _publish(plan: _Plan, answers: list[Answer]) -> None:
    if plan.data.exists():
        update_description(plan.dataset)  # a kill may have come between the data file and its description
        return
    write_session_data(
        plan.dataset,
        [_row(answer, plan.protocol) for answer in answers],
        kind=plan.protocol.kind,
        participant=plan.participant,
        session=plan.session,
        task=plan.protocol.name,
        observer="human" if plan.observer is None else "simulated",
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
