"""The data file of a complete session, made from its answers."""

from gloss_experiments.session.journal import Journal
from gloss_experiments.session.plan import SessionPlan
from gloss_experiments.session.trial_rows import trial_rows
from glossspace.dataset import update_description, write_session_data
from glossspace.errors import GlossError

__all__ = ["complete"]


def complete(plan: SessionPlan, journal: Journal) -> None:
    """Mark the session as complete, and write its data file where there is none yet.

    Raises
    ------
    GlossError
        The data file cannot be written; the message says where the answers are safe.
    """
    journal.finish()
    try:
        if plan.data.exists():
            update_description(plan.dataset)  # a kill may have come between the data file and its description
        else:
            _write_data(plan, journal)
    except GlossError as error:
        raise GlossError(
            f"{error} The {len(journal.answers)} answers are safe in the journal '{plan.journal}': once this is put "
            "right, the same command writes the data file."
        ) from None


def _write_data(plan: SessionPlan, journal: Journal) -> None:
    simulated = plan.observer is not None
    write_session_data(
        plan.dataset,
        trial_rows(journal.answers, kind=plan.protocol.kind, simulated=simulated),
        kind=plan.protocol.kind,
        participant=plan.participant,
        session=plan.session,
        task=plan.protocol.name,
        observer="simulated" if simulated else "human",
        pilot=plan.pilot,
    )
