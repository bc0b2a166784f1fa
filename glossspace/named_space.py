"""How a person names a gloss space on the command line, and what is remarked on it."""

from pathlib import Path

from glossspace.console import note
from glossspace.metric import PAPER_SPACE, GlossSpace

__all__ = ["named_space", "note_simulated_space"]


def named_space(text: str) -> GlossSpace:
    """Load the gloss space that a person named: a file, or "paper" where no file has that name.

    Raises
    ------
    GlossError
        The file is missing or no gloss space; see `GlossSpace.load`.
    """
    return PAPER_SPACE if text == "paper" and not Path(text).exists() else GlossSpace.load(text)


def note_simulated_space(space: GlossSpace) -> None:
    """Remark on stderr that a space rests on simulated participants, as far as its file says so."""
    observers = space.provenance.get("observers")
    names = observers if isinstance(observers, list | tuple) else [observers]
    simulated = [name for name in names if "simulated" in str(name)]
    if simulated:
        note(
            f"The space '{space.name}' rests on simulated participants ({len(simulated)} of {len(names)}). They embody "
            "an answer: what they say of gloss was put into them."
        )
