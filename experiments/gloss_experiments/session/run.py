"""Running one session: what is asked for is checked against what is on the disk, run or resumed, and published."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

from gloss_experiments.observers.observer import Judge, SimulatedObserver
from gloss_experiments.observers.observer_kinds import seen_axes
from gloss_experiments.protocol import Protocol
from gloss_experiments.session.drive import Mode, drive, open_presenter
from gloss_experiments.session.journal import Journal
from gloss_experiments.session.plan import SessionPlan, check_beginning, plan_session
from gloss_experiments.session.provenance import circumstances
from gloss_experiments.session.publishing import complete
from gloss_experiments.session.state import Phase, SessionState, start_session
from gloss_experiments.session.summary import SessionSummary, summarise, summary_lines
from glossspace.dataset import record_simulated_observer, record_stimuli
from glossspace.errors import GlossError
from glossspace.stimulus_set import StimulusSet

if TYPE_CHECKING:
    from gloss_experiments.preflight.preflight import Preflight

__all__ = ["Mode", "SessionResult", "run_session"]


@dataclass(frozen=True)
class SessionResult:
    """What a session left.

    Attributes
    ----------
    data_path
        The data file; None where the session was stopped before its end.
    journal_path
        The journal, with every trial answered so far.
    n_trials, n_answered, n_before
        Trials of the session without practice, how many are answered, and how many of those were before this run.
    simulated
        Whether a program answered.
    summary
        What the answers so far say of the observer.
    pilot
        Whether it was a trial run, whose data are kept apart.
    already_finished
        Whether there was nothing left to do.
    another_protocol
        Whether it was finished under another protocol than the one that is asked for now.
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
    summary: SessionSummary
    pilot: bool = False
    already_finished: bool = False
    another_protocol: bool = False
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
    observer: SimulatedObserver | str | None = None,
    pilot: bool = False,
    calibration: str | Path | None = None,
    override: str | None = None,
    on_preflight: Callable[["Preflight"], None] | None = None,
    on_trial: Callable[[int, int], None] | None = None,
    on_resume: Callable[[int, int], bool] | None = None,
) -> SessionResult:
    """Run a session, or what is left of it, and write its data file.

    An interrupted session goes on at the next trial, in the same order; a finished one is left as it is. Data are never
    overwritten.

    Parameters
    ----------
    protocol
        A protocol, a TOML file, or the name of a shipped one: ``"pairwise"``, ``"contrast"``, ``"doi"``, ``"ranking"``.
    stimuli
        A stimulus set or its folder; its files are checked against their hashes.
    dataset
        Folder of the dataset; made if absent.
    participant, session
        Letters and digits. Where the protocol splits its trials over several sessions, `session` says which part.
    mode
        ``"screen"``: a person at the screen. ``"simulate"``: a simulated observer through the real window.
        ``"headless"``: a simulated observer without one. The last two give the same answers.
    seed
        Of the study, 0 by default. With participant, session and protocol it fixes the order of the trials and the
        simulated answers. Without one, an interrupted session keeps its own.
    observer
        The simulated observer, or a kind of `observer_kinds.OBSERVER_KINDS`: the observer of that kind who stands for
        this participant and seed. By default that of the kind ``"metric"``.
    pilot
        A trial run: its journal and data go into a dataset of their own, ``pilots`` inside `dataset`.
    calibration
        Of a person's screen, as `gloss calibrate` writes it; it is compared with the screen and the images.
    override
        Why the session is to run although the check of the screen found something off; recorded in the journal.
    on_preflight
        Called with what the check of a person's screen found, before it lets the session begin or refuses it.
    on_trial
        Called with the number of trials answered and their total, after each; practice trials do not count.
    on_resume
        Called so before an interrupted session goes on; where it returns False, the session is left as it is.

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
    if mode != "screen" and (override is not None or calibration is not None):
        raise GlossError("A calibration and an override are for the check of a person's screen; leave them out here.")
    plan = plan_session(
        protocol,
        stimuli=stimuli,
        dataset=Path(dataset),
        participant=participant,
        session=str(session),
        mode=mode,
        seed=seed,
        observer=observer,
        pilot=pilot,
    )
    with Journal(plan.journal) as journal:
        if journal.header is not None and journal.finished and plan.data.exists():
            return _finished_already(plan, journal, journal.header)
        if journal.header is not None:
            journal.check(plan.fixed())
            journal.check_order(plan.trials)
        design = plan.protocol.design
        before = state = start_session(
            plan.trials,
            n_answered=len(journal.answers),
            preview=design.preview,
            break_every=design.break_every,
        )
        goes_on = state.n_answered == 0 or on_resume is None or on_resume(*state.progress)
        if state.phase is not Phase.DONE and goes_on:
            check = _ScreenCheck(calibration, override, on_preflight)
            state = _run(plan, journal, state, check, on_trial)
        elif state.phase is Phase.DONE:
            complete(plan, journal)
        n_answered, n_trials = state.progress
        return _result(
            plan,
            journal,
            data_path=plan.data if state.phase is Phase.DONE else None,
            n_trials=n_trials,
            n_answered=n_answered,
            n_before=before.progress[0],
        )


def _finished_already(plan: SessionPlan, journal: Journal, header: dict[str, Any]) -> SessionResult:
    """Nothing is left to do, so that a protocol that has changed since does no harm."""
    wanted = plan.fixed()
    begun_with = header.get("protocol_sha256")
    journal.check({**wanted, "protocol_sha256": begun_with})
    complete(plan, journal)
    n_judged = sum(answer.trial.role != "practice" for answer in journal.answers)
    return _result(
        plan,
        journal,
        data_path=plan.data,
        n_trials=n_judged,
        n_answered=n_judged,
        n_before=n_judged,
        already_finished=True,
        another_protocol=begun_with != wanted["protocol_sha256"],
    )


def _result(plan: SessionPlan, journal: Journal, **found: Any) -> SessionResult:
    return SessionResult(
        participant_id=plan.participant,
        session=plan.session,
        task=plan.protocol.name,
        journal_path=plan.journal,
        simulated=plan.observer is not None,
        mode=plan.mode,
        seed=plan.seed,
        summary=summarise(journal.answers),
        pilot=plan.pilot,
        torn=journal.torn,
        image_angle_deg=plan.image_angle_deg(),
        **found,
    )


@dataclass(frozen=True)
class _ScreenCheck:
    """The check of a person's screen, before anything is written or shown."""

    calibration: str | Path | None
    override: str | None
    on_preflight: Callable[["Preflight"], None] | None

    def passed(self, plan: SessionPlan, presenter: Any) -> dict[str, Any] | None:
        """What was found, as the journal keeps it; None for simulated observers. Raises where it refuses."""
        if plan.mode != "screen":
            return None
        # Here alone, so that sessions without a window need nothing of what the check needs.
        from gloss_experiments.preflight.preflight import check_screen

        preflight = check_screen(
            presenter.window,
            plan.protocol,
            plan.stimulus_set,
            refresh_s=presenter.refresh_s,
            calibration=self.calibration,
            override=self.override,
        )
        if self.on_preflight is not None:
            self.on_preflight(preflight)
        preflight.require()
        return preflight.to_dict()


def _run(
    plan: SessionPlan,
    journal: Journal,
    state: SessionState,
    check: _ScreenCheck,
    on_trial: Callable[[int, int], None] | None,
) -> SessionState:
    if journal.header is None:
        check_beginning(plan)
    judge = None
    if plan.observer is not None:
        judge = Judge(plan.observer, seen_axes(plan.observer, plan.stimulus_set, plan.images), plan.judge_seed)
    remark = "Pilot" if plan.pilot else ""
    with open_presenter(plan.protocol, plan.images, judge=judge, mode=plan.mode, remark=remark) as presenter:
        # Written once the window stands: a session that could not begin leaves nothing behind.
        now = {"preflight": check.passed(plan, presenter), **circumstances(plan.mode)}
        if journal.header is not None:
            journal.note("resumed", torn=journal.torn, **now)
        else:
            record_stimuli(plan.dataset, plan.stimulus_set.stimuli, source=str(plan.stimulus_set.folder))
            if plan.observer is not None:
                # Before the header: whenever a kill comes, no simulated answer is without its name in this list.
                record_simulated_observer(plan.dataset, plan.participant, plan.observer.parameters())
            journal.begin({**plan.fixed(), **plan.details(), **now})
        state = drive(state, presenter, journal, mode=plan.mode, on_trial=on_trial)
        if state.phase is Phase.DONE:
            # The data come before the thanks: nobody knows how long those stand there, or how they end.
            complete(plan, journal)
            presenter.finish(state, summary_lines(summarise(journal.answers)))
        return state
