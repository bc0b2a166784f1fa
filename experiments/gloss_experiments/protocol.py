"""A protocol: everything a lab varies in a session, read from TOML and checked before anything is shown."""

import hashlib
import json
import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator, model_validator

from glossspace.errors import GlossError
from glossspace.files import shipped_folder
from glossspace.user_table import read_user_table

__all__ = ["Checks", "Design", "Display", "Kind", "Protocol", "Slider", "Texts", "read_protocol", "shipped_protocols"]

Kind = Literal["pairwise", "magnitude", "ranking"]
# Strict, since pydantic else takes `practice = true` as 1.
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False, strict=True)]
Pixels = Annotated[int, Field(ge=1, le=20_000, strict=True)]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, str_strip_whitespace=True)


class Design(_Part):
    """Which trials there are, and what comes round them."""

    repeats: Annotated[int, Field(ge=1, le=1000, strict=True)] = 1
    include_identical: bool = True
    stimuli: tuple[str, ...] = ()
    # An incomplete design: these pairs alone. A protocol file names a CSV file here, which `read_protocol` reads.
    pairs: tuple[tuple[str, str], ...] = ()
    reference: str | None = None
    sessions: Annotated[int, Field(ge=1, le=1000, strict=True)] = 1
    preview: bool = False
    practice: Annotated[int, Field(ge=0, le=1000, strict=True)] = 0
    catch_trials: Annotated[int, Field(ge=0, le=1000, strict=True)] = 0
    break_every: Annotated[int, Field(ge=0, le=100_000, strict=True)] = 0
    break_min_s: Annotated[float, Field(ge=0, le=3600, strict=True)] = 0.0
    time_limit_s: Annotated[float, Field(gt=0, le=3600, strict=True)] | None = None

    @model_validator(mode="after")
    def _pairs_stand_alone(self) -> "Design":
        if self.pairs and self.stimuli:
            raise ValueError("design.pairs names the stimuli already; leave design.stimuli empty")
        known: set[frozenset[str]] = set()
        for a, b in self.pairs:
            if frozenset((a, b)) in known:
                raise ValueError(f"design.pairs has {a} with {b} twice; remove one")
            known.add(frozenset((a, b)))
        return self


class Display(_Part):
    """Where the images stand, and at which visual angle."""

    viewing_distance_cm: Positive = 152.4
    image_width_deg: Annotated[float, Field(gt=0, lt=90, strict=True)] = 3.2
    gap_deg: Annotated[float, Field(ge=0, lt=90, strict=True)] = 0.8
    blank_s: Annotated[float, Field(ge=0, le=60, strict=True)] = 0.25
    pixel_pitch_mm: Positive | None = None
    fullscreen: bool = True
    window_size_px: tuple[Pixels, Pixels] = (1280, 1024)


class Slider(_Part):
    """The slider below the images, from 0 to 100 in whole steps; its labels also stand at the ends of a ranking."""

    low_label: str
    high_label: str
    # Narrower than a pixel a step, some ratings could not be reached.
    width_px: Annotated[int, Field(ge=101, le=20_000, strict=True)] = 640


class Texts(_Part):
    """What the observer reads, in any language that `font` can write."""

    question: str
    instructions: str
    start: str = "Press the space bar to begin."
    preview: str = "These are the objects that you will see.\n\nPress the space bar to go on."
    practice: str = "Practice"
    practice_done: str = "Practice is over.\n\nPress the space bar to begin."
    pause: str = "You may rest your eyes.\n\nPress the space bar to go on."
    progress: str = "{done} of {total}"
    time_up: str = "The time for this one is over.\n\nPress the space bar to go on."
    quit_question: str = "Stop here?"
    quit_yes: str = "Stop"
    quit_no: str = "Go on"
    confirm: str = "Confirm"
    finished: str = "This session is complete. Thank you."
    font: str = "Noto Sans"
    size_px: Annotated[int, Field(ge=6, le=400, strict=True)] = 24

    @field_validator("progress")
    @classmethod
    def _progress_can_be_filled_in(cls, text: str) -> str:
        try:
            text.format(done=1, total=2)
        except (LookupError, ValueError):
            raise ValueError("in braces it may hold {done} and {total} alone") from None
        return text


class Checks(_Part):
    """What the check of the screen before a session lets pass; see `gloss_experiments.preflight.preflight`."""

    # Largest error of the images' visual angle, as a share.
    angle: Annotated[float, Field(gt=0, le=1, strict=True)] = 0.02
    # Largest L* by which the screen may differ from the one that the images were made for, over all code values.
    luminance_delta_l: Annotated[float, Field(gt=0, le=100, strict=True)] = 1.5
    calibration_max_age_days: Annotated[float, Field(gt=0, le=36_500, strict=True)] = 30.0
    # Where it is stated, the screen must have it, and drop no more than this share of its frames.
    frame_rate_hz: Annotated[float, Field(ge=10, le=1000, strict=True)] | None = None
    dropped_frames: Annotated[float, Field(ge=0, lt=1, strict=True)] = 0.02
    # A screen without a calibration, or a gamma table that cannot be read: a row that warns, or one that refuses.
    uncalibrated: Literal["warn", "refuse"] = "warn"
    unreadable_gamma_table: Literal["warn", "refuse"] = "warn"


class Protocol(_Part):
    """One session's protocol.

    `kind` says what is judged: the difference of a pair, the gloss of one stimulus, or the ranks of a set round a
    reference.
    """

    format: Literal[1]
    name: Annotated[str, Field(pattern="^[a-zA-Z0-9]+$")]
    kind: Kind
    slider: Slider
    texts: Texts
    design: Design = Design()
    display: Display = Display()
    checks: Checks = Checks()

    @model_validator(mode="after")
    def _design_is_of_the_kind(self) -> "Protocol":
        design, ranking = self.design, self.kind == "ranking"
        if ranking and design.reference is None:
            raise ValueError("a ranking needs design.reference, the stimulus that the others are ranked round")
        if not ranking and design.reference is not None:
            raise ValueError(f"design.reference belongs to a ranking, and this protocol is {self.kind}; remove it")
        if self.kind != "pairwise" and design.pairs:
            raise ValueError(f"design.pairs belongs to a pairwise protocol, and this one is {self.kind}; remove it")
        if ranking and design.catch_trials:
            raise ValueError("a ranking has no catch trials; set design.repeats to have it done again")
        return self

    def sha256(self) -> str:
        """Hash of what an observer meets: comments, key order and defaults written out do not change it.

        Nor do the tolerances of the checks before a session. Keys that came after the first version count where they
        are not at their default, so that a session begun with that version goes on with this one.
        """
        meaning = self.model_dump(mode="json", exclude={"checks"})
        chosen = self.model_dump(mode="json", exclude_defaults=True)
        for part, first in _FIRST_KEYS.items():
            meaning[part] = {
                key: value for key, value in meaning[part].items() if key in first or key in chosen.get(part, {})
            }
        canonical = json.dumps(meaning, sort_keys=True, ensure_ascii=False)
        return hashlib.sha256(canonical.encode("utf-8")).hexdigest()


_FIRST_KEYS = {
    "design": {"repeats", "include_identical", "stimuli"},
    "texts": {"question", "instructions", "start", "pause", "confirm", "finished", "font", "size_px"},
}


def shipped_protocols() -> dict[str, Path]:
    """The protocols that ship with the package, by name."""
    return {path.stem: path for path in sorted(shipped_folder(__file__, "protocols").glob("*.toml"))}


def read_protocol(source: str | Path) -> Protocol:
    """Read a protocol from a TOML file, by the name of a shipped one, or from the journal of a session (.jsonl).

    Raises
    ------
    GlossError
        There is none of that name, it is not TOML or no journal, or a value is not allowed: the message names the key
        and the value.

    Examples
    --------
    >>> read_protocol("pairwise").slider.high_label
    '100, large difference'
    """
    shipped = shipped_protocols()
    path = shipped.get(str(source), Path(source))
    try:
        text = path.read_text(encoding="utf-8")
        document = _in_journal(text, path) if path.suffix == ".jsonl" else tomllib.loads(text)
    except (FileNotFoundError, IsADirectoryError):
        raise GlossError(f"No protocol '{source}'. Give a TOML file or one of: {', '.join(shipped)}.") from None
    except (OSError, UnicodeDecodeError) as error:
        raise GlossError(f"Cannot read the protocol '{path}': {error}.") from None
    except tomllib.TOMLDecodeError as error:
        raise GlossError(f"The protocol '{path}' is not valid TOML: {error}.") from None
    try:
        return Protocol.model_validate(_with_pairs_read(document, path.parent))
    except ValidationError as error:
        raise GlossError(f"The protocol '{path}': {_first_problem(error)}") from None


def _in_journal(text: str, path: Path) -> dict[str, Any]:
    """The protocol that a session began with stands in the header of its journal."""
    try:
        document = json.loads(text.partition("\n")[0])["protocol"]
    except (ValueError, KeyError, TypeError):
        document = None
    if not isinstance(document, dict):
        raise GlossError(f"'{path}' is no journal of a session: its first line holds no protocol.")
    return document


def _with_pairs_read(document: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The document with the pairs themselves where it names their file, so that a journal holds the whole design."""
    design = document.get("design")
    if not isinstance(design, dict) or not isinstance(design.get("pairs"), str):
        return document
    path = folder / design["pairs"]
    table = read_user_table(path, what="list of pairs", columns=["stimulus_a", "stimulus_b"])
    lines: dict[frozenset[str], int] = {}
    pairs: list[tuple[str, str]] = []
    for line, a, b in zip(table.index, table["stimulus_a"], table["stimulus_b"], strict=True):
        where = f"The list of pairs '{path}', line {line}"
        if not isinstance(a, str) or not isinstance(b, str):
            raise GlossError(f"{where}: a stimulus is missing. Fill the cell, or remove the line.")
        if frozenset((a, b)) in lines:
            raise GlossError(
                f"{where}: {a} with {b} is in line {lines[frozenset((a, b))]} already. Remove one of them."
            )
        lines[frozenset((a, b))] = line
        pairs.append((a, b))
    if not pairs:
        raise GlossError(f"The list of pairs '{path}' holds no pair. Give one pair a line.")
    return document | {"design": design | {"pairs": pairs}}


def _first_problem(error: ValidationError) -> str:
    problem: Any = error.errors()[0]
    key = ".".join(str(part) for part in problem["loc"])
    if problem["type"] == "missing":
        return f"'{key}' is missing; the shipped protocols show every key."
    if problem["type"] == "extra_forbidden":
        return f"unknown key '{key}'; allowed beside it are {_keys_beside(problem['loc'])}."
    if problem["type"] == "value_error" and not isinstance(problem["input"], str):  # of several keys together
        return f"{problem['ctx']['error']}."
    reason = problem["msg"].removeprefix("Value error, ")
    return f"{key} = {problem['input']!r} is not allowed: {reason[0].lower()}{reason[1:]}."


def _keys_beside(location: tuple[str | int, ...]) -> str:
    model: Any = Protocol
    for part in location[:-1]:
        model = model.model_fields[part].annotation
    return ", ".join(model.model_fields)
