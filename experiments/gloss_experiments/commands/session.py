"""``gloss session``."""

import sys
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.progress import Progress, TaskID

from gloss_experiments.session.run import Mode, SessionResult, run_session
from gloss_experiments.session.summary import summary_lines
from glossspace.console import JsonFlag, Seed, note, print_json, progress_bar
from glossspace.errors import GlossError

__all__ = ["session"]

Flag = Annotated[bool, Parameter(negative="", show_default=False)]


def session(
    protocol: str,
    /,
    *,
    stimuli: Path | None = None,
    dataset: Path | None = None,
    participant: str | None = None,
    session: str | None = None,
    simulate: Flag = False,
    headless: Flag = False,
    observer: str | None = None,
    pilot: Flag = False,
    calibration: Path | None = None,
    override: str | None = None,
    seed: Seed | None = None,
    json: JsonFlag = False,
) -> None:
    """Run an observer session, or what is left of one, into a dataset.

    A session that was interrupted goes on at the next trial when the same command
    is given again; a finished one is left as it is. Escape ends a session; what is
    judged so far is kept. A dialog asks a person for stimuli, dataset or participant
    that are not given.

    Examples:

        gloss session pairwise --stimuli set --dataset data --participant 01

        gloss session a.toml --stimuli set --dataset data --participant 2 --simulate

        gloss session doi --stimuli set --dataset data --participant 03 --headless

        gloss session pairwise --stimuli set --dataset d --participant 5 --headless --observer images

        gloss session ranking --stimuli set --dataset data --participant 04 --pilot

    Parameters
    ----------
    protocol
        A TOML file, the name of a shipped protocol (pairwise, contrast, doi, ranking), or the journal of a session,
        which goes on with the protocol that it began with.
    stimuli
        Folder of the stimulus set, as `gloss render` writes it.
    dataset
        Folder of the dataset (Psych-DS); made if absent.
    participant
        Identifier of the participant: letters and digits.
    session
        Session of the participant: letters and digits; 1 if not given. Where the protocol splits its trials over
        several sessions, the number of this one.
    simulate
        A simulated observer answers, with a scripted mouse in the real window.
    headless
        A simulated observer answers, without a window.
    observer
        Which kind of simulated observer: metric (the default), compressive, wavering, lapsing, tiring, drifting,
        middle, random, reversed, images.
    pilot
        A trial run, kept apart from the data: in the folder pilots of the dataset.
    calibration
        Of the screen, as `gloss calibrate` writes it: a JSON file.
    override
        Why to run although the check of the screen found something off. The reason stands in the journal.
    seed
        Of the study; with participant, session and protocol it fixes the order of the trials and simulated answers.
        Default: 0, or the one that an interrupted session began with.
    """
    if simulate and headless:
        raise GlossError("Give --simulate (a simulated observer in the window) or --headless (without one), not both.")
    mode: Mode = "headless" if headless else "simulate" if simulate else "screen"
    if mode != "screen" and (override is not None or calibration is not None):
        raise GlossError(
            "--calibration and --override are for the check of a person's screen; here nobody sits at one."
        )
    details = _details(
        {
            "stimuli": None if stimuli is None else str(stimuli),
            "dataset": None if dataset is None else str(dataset),
            "participant": participant,
            "session": session,
        },
        mode,
    )
    with progress_bar() as progress:
        bar: TaskID | None = None

        def show(done: int, total: int) -> None:
            nonlocal bar
            if bar is None:
                bar = progress.add_task(f"{protocol}, participant {details['participant']}", total=total)
            progress.update(bar, completed=done)

        result = run_session(
            protocol,
            stimuli=details["stimuli"],
            dataset=details["dataset"],
            participant=details["participant"],
            session=details["session"],
            mode=mode,
            seed=seed,
            observer=observer,
            pilot=pilot,
            calibration=calibration,
            override=override,
            on_preflight=lambda found: progress.console.print(
                found.table(), markup=False, highlight=False, soft_wrap=True
            ),
            on_trial=show,
            on_resume=lambda done, total: _goes_on(progress, done, total, mode),
        )
    _report_remarks(result)
    if json:
        print_json(_document(result))
    else:
        print("\n".join(_summary(result)))


def _details(known: Mapping[str, str | None], mode: Mode) -> dict[str, str]:
    """What a session needs, asked for in a dialog where a person left some of it out."""
    missing = [name for name, value in known.items() if value is None and name != "session"]
    if missing and mode == "screen" and _person_at_terminal():
        # Here alone: the dialog needs a display.
        from gloss_experiments.window.dialog import ask_details

        filled_in = ask_details(known)
        if filled_in is None:
            raise GlossError("The dialog was cancelled; no session was begun.")
        return filled_in
    if missing:
        raise GlossError(f"The option --{missing[0]} is missing; see gloss session --help.")
    return {name: "1" if value is None else value for name, value in known.items()}


def _person_at_terminal() -> bool:
    return sys.stdin.isatty() and sys.stderr.isatty()


def _goes_on(progress: Progress, done: int, total: int, mode: Mode) -> bool:
    if mode != "screen" or not _person_at_terminal():
        return True
    progress.stop()  # it would draw over what is typed
    try:
        print(f"Go on after {done} of {total} trials? [Y/n] ", end="", file=sys.stderr, flush=True)
        return sys.stdin.readline().strip().lower() in ("", "y", "yes")
    finally:
        progress.start()


def _report_remarks(result: SessionResult) -> None:
    if result.torn:
        note("The last line of the journal was torn, as a kill leaves it: it was cut off, and its trial shown again.")
    if result.already_finished:
        under = ", under another protocol than this one" if result.another_protocol else ""
        note(f"This session was finished already{under}; nothing was changed.")
    if result.n_answered > result.n_before > 0:
        note(f"Resumed after {result.n_before} of {result.n_trials} trials.")
    if result.pilot:
        note("A pilot: kept apart from the data of the study, in the folder pilots of the dataset.")


def _summary(result: SessionResult) -> list[str]:
    who = "simulated observer" if result.simulated else "observer"
    done = f"{result.n_answered} of {result.n_trials} trials"
    pilot = "Pilot. " if result.pilot else ""
    lines = [
        f"{pilot}Participant {result.participant_id} ({who}), session {result.session}, task {result.task}: {done}."
    ]
    lines += summary_lines(result.summary)
    if result.data_path is None:
        lines.append(f"Stopped before the end. Run the same command to go on. Journal: {result.journal_path}")
    else:
        lines.append(f"Data: {result.data_path}")
    return lines


def _document(result: SessionResult) -> dict[str, object]:
    return {
        "participant_id": result.participant_id,
        "session": result.session,
        "task": result.task,
        "trials": result.n_trials,
        "judged": result.n_answered,
        "resumed_after": result.n_before,
        "finished": result.data_path is not None,
        "already_finished": result.already_finished,
        "another_protocol": result.another_protocol,
        "simulated": result.simulated,
        "pilot": result.pilot,
        "mode": result.mode,
        "seed": result.seed,
        "data": None if result.data_path is None else str(result.data_path),
        "image_angle_deg": result.image_angle_deg,
        "summary": asdict(result.summary),
        "journal": str(result.journal_path),
    }
