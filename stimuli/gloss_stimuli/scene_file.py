"""Any scene file: a box of ours, or a Mitsuba scene of the user's own, told apart by the format that it states."""

from pathlib import Path

from gloss_stimuli.scene import Scene, read_scene
from gloss_stimuli.user_scene import FORMAT, UserScene, read_user_scene
from glossspace.errors import GlossError
from glossspace.files import read_toml

__all__ = ["read_any_scene"]


def read_any_scene(source: str | Path | None = None) -> Scene | UserScene:
    """Read a scene by file or by the name of a shipped one; see `read_scene` and `read_user_scene`.

    Raises
    ------
    GlossError
        The file is missing or damaged, or a value is missing, unknown or out of range.
    """
    if source is not None and _format_of(Path(source)) == FORMAT:
        return read_user_scene(source)
    return read_scene(source)


def _format_of(path: Path) -> object:
    try:
        return read_toml(path, what="scene").get("format")
    except GlossError:
        return None  # what is wrong with it is said by whoever reads it
