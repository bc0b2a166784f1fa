"""``gloss session``."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.progress import TaskID

from gloss_experiments.run import Mode, SessionResult, run_session
from glossspace.console import JsonFlag, Seed, note, print_json, progress_bar
from glossspace.errors import GlossError

__all__ = ["session"]

Flag = Annotated[bool, Parameter(negative="", show_default=False)]


def session(
    protocol: str,
    /,
    *,
    stimuli: Path,
    dataset: Path,
    participant: str,
    session: str = "1",
    simulate: Flag = False,
    headless: Flag = False,
    seed: Seed | None = None,
    json: JsonFlag = False,
) -> None:
    """Run an observer session, or what is left of one, into a dataset.

    A session that was interrupted goes on at the next trial when the same command
    is given again; a finished one is left as it is. Escape ends a session; what is
    judged so far is kept.

    Examples:

        gloss session pairwise --stimuli set --dataset data --participant 01

        gloss session a.toml --stimuli set --dataset data --participant 2 --simulate

        gloss session doi --stimuli set --dataset data --participant 03 --headless

    Parameters
    ----------
    protocol
        A TOML file, or the name of a shipped protocol: pairwise, contrast, doi.
    stimuli
        Folder of the stimulus set, as `gloss render` writes it.
    dataset
        Folder of the dataset (Psych-DS); made if absent.
    participant
        Identifier of the participant: letters and digits.
    session
        Session of the participant: letters and digits.
    simulate
        A simulated observer answers, with a scripted mouse in the real window.
    headless
        A simulated observer answers, without a window.
    seed
        Of the study; with participant, session and protocol it fixes the order of the trials and simulated answers.
        Default: 0, or the one that an interrupted session began with.
    """
    if simulate and headless:
        raise GlossError("Give --simulate (a simulated observer in the window) or --headless (without one), not both.")
    mode: Mode = "headless" if headless else "simulate" if simulate else "screen"
    with progress_bar() as progress:
        bar: TaskID | None = None

        def show(done: int, total: int) -> None:
            nonlocal bar
            if bar is None:
                bar = progress.add_task(f"{protocol}, participant {participant}", total=total)
            progress.update(bar, completed=done)

        result = run_session(
            protocol,
            stimuli=stimuli,
            dataset=dataset,
            participant=participant,
            session=session,
            mode=mode,
            seed=seed,
            on_trial=show,
        )
    _report_remarks(result)
    if json:
        print_json(_document(result))
    else:
        print("\n".join(_summary(result)))


def _report_remarks(result: SessionResult) -> None:
    if result.torn:
        note("The last line of the journal was torn, as a kill leaves it: it was cut off, and its trial shown again.")
    if result.already_finished:
        note("This session was finished already; nothing was changed.")
    elif result.mode == "screen" and result.image_angle_deg is None:
        note("The visual angle of the images was not checked: set display.pixel_pitch_mm in the protocol.")
    if result.n_before and not result.already_finished:
        note(f"Resumed after {result.n_before} of {result.n_trials} trials.")


def _summary(result: SessionResult) -> list[str]:
    who = "simulated observer" if result.simulated else "observer"
    done = f"{result.n_answered} of {result.n_trials} trials"
    lines = [f"Participant {result.participant_id} ({who}), session {result.session}, task {result.task}: {done}."]
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
        "simulated": result.simulated,
        "mode": result.mode,
        "seed": result.seed,
        "data": None if result.data_path is None else str(result.data_path),
        "image_angle_deg": result.image_angle_deg,
        "journal": str(result.journal_path),
    }
