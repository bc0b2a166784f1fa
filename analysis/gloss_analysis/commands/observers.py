"""What every analysis says of simulated participants."""

from pathlib import Path

from glossspace.console import note

__all__ = ["note_simulated", "simulated_of"]


def simulated_of(source: Path, participants: tuple[str, ...]) -> list[str]:
    """Which participants are simulated, as far as a dataset says so; a plain table does not."""
    from glossspace.dataset import simulated_participants

    known = simulated_participants(source) if source.is_dir() else ()
    return [name for name in participants if name in known]


def note_simulated(simulated: list[str], participants: tuple[str, ...]) -> None:
    """Remark on stderr that, and how many, participants are simulated."""
    if simulated:
        note(
            f"{len(simulated)} of {len(participants)} participants are simulated. They embody an answer: recovering it "
            "tests the software, not the paper."
        )
