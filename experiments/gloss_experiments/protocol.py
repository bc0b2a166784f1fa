"""A protocol: everything a lab varies in a session, read from TOML and checked before anything is shown."""

import hashlib
import json
import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from glossspace.errors import GlossError
from glossspace.files import shipped_folder

__all__ = ["Design", "Display", "Protocol", "Slider", "Texts", "read_protocol", "shipped_protocols"]

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Pixels = Annotated[int, Field(ge=1, le=20_000)]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, str_strip_whitespace=True)


class Design(_Part):
    """Which trials there are."""

    repeats: Annotated[int, Field(ge=1, le=1000)] = 1
    include_identical: bool = True
    stimuli: tuple[str, ...] = ()


class Display(_Part):
    """Where the images stand, and at which visual angle."""

    viewing_distance_cm: Positive = 152.4
    image_width_deg: Annotated[float, Field(gt=0, lt=90)] = 3.2
    gap_deg: Annotated[float, Field(ge=0, lt=90)] = 0.8
    blank_s: Annotated[float, Field(ge=0, le=60)] = 0.25
    pixel_pitch_mm: Positive | None = None
    fullscreen: bool = True
    window_size_px: tuple[Pixels, Pixels] = (1280, 1024)


class Slider(_Part):
    """The slider below the images; it always runs from 0 to 100 in whole steps."""

    low_label: str
    high_label: str
    # Narrower than a pixel a step, some ratings could not be reached.
    width_px: Annotated[int, Field(ge=101, le=20_000)] = 640


class Texts(_Part):
    """What the observer reads, in any language that `font` can write."""

    question: str
    instructions: str
    start: str = "Press the space bar to begin."
    pause: str = "You may rest your eyes.\n\nPress the space bar to go on."
    confirm: str = "Confirm"
    finished: str = "This session is complete. Thank you."
    font: str = "Noto Sans"
    size_px: Annotated[int, Field(ge=6, le=400)] = 24


class Protocol(_Part):
    """One session's protocol; `kind` says whether the difference of a pair or the gloss of one stimulus is judged."""

    format: Literal[1]
    name: Annotated[str, Field(pattern="^[a-zA-Z0-9]+$")]
    kind: Literal["pairwise", "magnitude"]
    slider: Slider
    texts: Texts
    design: Design = Design()
    display: Display = Display()

    def sha256(self) -> str:
        """Hash of the protocol's meaning: comments, key order and defaults written out do not change it."""
        canonical = json.dumps(self.model_dump(mode="json"), sort_keys=True, ensure_ascii=False)
        return hashlib.sha256(canonical.encode("utf-8")).hexdigest()


def shipped_protocols() -> dict[str, Path]:
    """The protocols that ship with the package, by name."""
    return {path.stem: path for path in sorted(shipped_folder(__file__, "protocols").glob("*.toml"))}


def read_protocol(source: str | Path) -> Protocol:
    """Read a protocol from a TOML file, or by the name of a shipped one.

    Raises
    ------
    GlossError
        There is none of that name, it is not TOML, or a value is not allowed: the message names the key and the value.

    Examples
    --------
    >>> read_protocol("pairwise").slider.high_label
    '100, large difference'
    """
    shipped = shipped_protocols()
    path = shipped.get(str(source), Path(source))
    try:
        document = tomllib.loads(path.read_text(encoding="utf-8"))
    except (FileNotFoundError, IsADirectoryError):
        raise GlossError(f"No protocol '{source}'. Give a TOML file or one of: {', '.join(shipped)}.") from None
    except (OSError, UnicodeDecodeError) as error:
        raise GlossError(f"Cannot read the protocol '{path}': {error}.") from None
    except tomllib.TOMLDecodeError as error:
        raise GlossError(f"The protocol '{path}' is not valid TOML: {error}.") from None
    try:
        return Protocol.model_validate(document)
    except ValidationError as error:
        raise GlossError(f"The protocol '{path}': {_first_problem(error)}") from None


def _first_problem(error: ValidationError) -> str:
    problem: Any = error.errors()[0]
    key = ".".join(str(part) for part in problem["loc"])
    if problem["type"] == "missing":
        return f"'{key}' is missing; the shipped protocols show every key."
    if problem["type"] == "extra_forbidden":
        return f"unknown key '{key}'; allowed beside it are {_keys_beside(problem['loc'])}."
    return f"{key} = {problem['input']!r} is not allowed: {problem['msg'][0].lower()}{problem['msg'][1:]}."


def _keys_beside(location: tuple[str | int, ...]) -> str:
    model: Any = Protocol
    for part in location[:-1]:
        model = model.model_fields[part].annotation
    return ", ".join(model.model_fields)
