"""All that a session needs, checked before anything is written."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from gloss_experiments.design import Trial, chosen_stimuli, session_seed, session_trials
from gloss_experiments.observers.observer import SimulatedObserver
from gloss_experiments.observers.observer_kinds import observer_named
from gloss_experiments.protocol import Protocol, read_protocol
from gloss_experiments.session.drive import Mode
from gloss_experiments.session.journal import journal_path
from gloss_experiments.session.journal_content import read_journal
from gloss_experiments.session.provenance import images_sha256
from gloss_experiments.window.layout import visual_angle_deg
from glossspace.dataset import data_path, read_simulated_observers
from glossspace.dataset.schema import PILOTS_FOLDER, checked_label
from glossspace.errors import GlossError
from glossspace.files import sha256_of
from glossspace.stimulus_set import StimulusSet, read_stimulus_set

__all__ = ["SessionPlan", "check_beginning", "plan_session"]


@dataclass(frozen=True)
class SessionPlan:
    """A session to run.

    Attributes
    ----------
    dataset
        Where it is written: the study's dataset, or the pilots' inside it.
    seed, judge_seed
        Of the study; and of the simulated answers of this session.
    trials
        Those of practice first.
    observer
        None for a person.
    journal, data
        Paths of the two files.
    """

    protocol: Protocol
    stimulus_set: StimulusSet
    dataset: Path
    participant: str
    session: str
    mode: Mode
    pilot: bool
    seed: int
    judge_seed: int
    trials: tuple[Trial, ...]
    observer: SimulatedObserver | None
    journal: Path
    data: Path

    @cached_property
    def images(self) -> dict[str, Path]:
        """The images of the stimuli that the protocol chooses."""
        names = chosen_stimuli(self.protocol, _names(self.stimulus_set))
        return {name: self.stimulus_set.image_path(name) for name in names}

    @cached_property
    def image_hashes(self) -> dict[str, str]:
        """SHA-256 of each image, in the order from which the random order of the trials starts."""
        return {name: sha256_of(path) for name, path in self.images.items()}

    def image_angle_deg(self) -> float | None:
        """Visual angle of an image on the screen, where it is known; whether it is right, the preflight says."""
        display = self.protocol.display
        if self.mode != "screen" or display.pixel_pitch_mm is None:
            return None
        return visual_angle_deg(
            self.stimulus_set.image_size[0],
            pixel_pitch_mm=display.pixel_pitch_mm,
            distance_cm=display.viewing_distance_cm,
        )

    def fixed(self) -> dict[str, Any]:
        """What makes two runs parts of the same session."""
        simulated = {} if self.observer is None else self.observer.parameters()
        return {
            "participant": self.participant,
            "session": self.session,
            "task": self.protocol.name,
            "seed": self.seed,
            "protocol_sha256": self.protocol.sha256(),
            "stimuli_sha256": images_sha256(self.image_hashes),
            "observer": {"kind": "human" if self.observer is None else "simulated", **simulated},
        }

    def details(self) -> dict[str, Any]:
        """What the header of its journal says beside that."""
        return {
            "pilot": self.pilot,
            "n_trials": sum(trial.role != "practice" for trial in self.trials),
            "n_practice": sum(trial.role == "practice" for trial in self.trials),
            "image_angle_deg": self.image_angle_deg(),
            "stimulus_set": self.stimulus_set.name,
            "stimulus_sha256": self.image_hashes,
            "paints": {
                stimulus.name: {"rho_d": stimulus.rho_d, "rho_s": stimulus.rho_s, "alpha": stimulus.alpha}
                for stimulus in self.stimulus_set.stimuli
                if stimulus.name in self.images
            },
            "protocol": self.protocol.model_dump(mode="json"),
        }


def plan_session(
    protocol: str | Path | Protocol,
    *,
    stimuli: str | Path | StimulusSet,
    dataset: Path,
    participant: str,
    session: str,
    mode: Mode,
    seed: int | None,
    observer: SimulatedObserver | str | None,
    pilot: bool,
) -> SessionPlan:
    """Plan a session; the parameters are those of `run_session`.

    Raises
    ------
    GlossError
        Something given is wrong, or does not go with what is on the disk.
    """
    protocol = protocol if isinstance(protocol, Protocol) else read_protocol(protocol)
    participant = checked_label(participant, what="participant")
    session = checked_label(session, what="session")
    stimulus_set = stimuli if isinstance(stimuli, StimulusSet) else read_stimulus_set(stimuli)
    if dataset.exists() and not dataset.is_dir():
        raise GlossError(f"The dataset '{dataset}' is a file; give a folder, which is made if absent.")
    dataset = dataset / PILOTS_FOLDER if pilot else dataset
    journal = journal_path(dataset, participant=participant, session=session, task=protocol.name)
    data = data_path(dataset, participant=participant, session=session, task=protocol.name)
    if data.exists() and not journal.exists():
        raise GlossError(
            f"The data file '{data}' exists without its journal: the session is finished and is never run again. "
            "Give the participant another session number."
        )
    if seed is None:
        seed = _seed_begun_with(journal, protocol)
    if mode == "screen":
        simulated = None
    elif isinstance(observer, SimulatedObserver):
        simulated = observer
    else:
        simulated = observer_named(participant, seed=seed, kind="metric" if observer is None else observer)
    return SessionPlan(
        protocol=protocol,
        stimulus_set=stimulus_set,
        dataset=dataset,
        participant=participant,
        session=session,
        mode=mode,
        pilot=pilot,
        seed=seed,
        judge_seed=session_seed(seed, participant=participant, session=session, task=protocol.name),
        trials=session_trials(protocol, _names(stimulus_set), seed=seed, participant=participant, session=session),
        observer=simulated,
        journal=journal,
        data=data,
    )


def check_beginning(plan: SessionPlan) -> None:
    """Check that a session that is about to begin goes with the others of the dataset.

    Raises
    ------
    GlossError
        A person and a program would share a name, or the parts of a design would not make up a whole.
    """
    _keep_people_and_programs_apart(plan)
    _check_against_other_parts(plan)


def _names(stimulus_set: StimulusSet) -> list[str]:
    return [stimulus.name for stimulus in stimulus_set.stimuli]


def _seed_begun_with(path: Path, protocol: Protocol) -> int:
    # Only read: opening it would cut off a torn line, and the session that goes on would not know of it.
    header = read_journal(path).header if path.exists() else None
    if header is not None:
        return _seed_in(header, path)
    others = _headers_of_other_parts(path, protocol)
    return next((_seed_in(header, other) for other, header in others.items()), 0)


def _seed_in(header: dict[str, Any], path: Path) -> int:
    seed = header.get("seed")
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise GlossError(f"The header of the journal '{path}' has no valid 'seed'. Restore it from a backup.")
    return seed


def _headers_of_other_parts(path: Path, protocol: Protocol) -> dict[Path, dict[str, Any]]:
    """Headers of the journals of this participant's other sessions, where one design is split over them."""
    if protocol.design.sessions == 1:
        return {}
    subject, _, task = path.stem.split("_")
    others = sorted(set(path.parent.glob(f"{subject}_session-*_{task}.jsonl")) - {path})
    headers = {other: read_journal(other).header for other in others}
    return {other: header for other, header in headers.items() if header is not None}


def _check_against_other_parts(plan: SessionPlan) -> None:
    wanted = plan.fixed()
    for path, header in _headers_of_other_parts(plan.journal, plan.protocol).items():
        for key in ("seed", "protocol_sha256", "stimuli_sha256"):
            if header.get(key) != wanted[key]:
                raise GlossError(
                    f"Session {header['session']} of participant '{plan.participant}' ('{path}') had another {key}: "
                    "the sessions would not make up the design that is split over them. Go back to what it was, "
                    "or give another participant."
                )
        # Not in journals of the first version. The hash over all images, compared above, is the same in any order.
        images = header.get("stimulus_sha256")
        if isinstance(images, dict) and list(images) != list(plan.image_hashes):
            raise GlossError(
                f"Session {header['session']} of participant '{plan.participant}' ('{path}') had the stimuli of the "
                "set in another order, from which its random order was drawn: the sessions would not make up the "
                "design that is split over them. Go back to that stimulus set, or give another participant."
            )


def _keep_people_and_programs_apart(plan: SessionPlan) -> None:
    known = read_simulated_observers(plan.dataset)
    simulated_before = known is not None and plan.participant in set(known["participant_id"])
    who = f"Participant '{plan.participant}' of '{plan.dataset}'"
    if plan.observer is None and simulated_before:
        raise GlossError(f"{who} is simulated; give a person another identifier.")
    others = (path for path in plan.journal.parent.glob(f"subject-{plan.participant}_*") if path != plan.journal)
    if plan.observer is not None and not simulated_before and any(others):
        raise GlossError(f"{who} is a person; give a simulated observer another identifier.")
