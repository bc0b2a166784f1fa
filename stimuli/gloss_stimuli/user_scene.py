"""Scenes that a Mitsuba user brings: an XML file whose paint is left open, and a TOML file that says how it is shown.

The XML is an ordinary Mitsuba scene. Where the paint's numbers stand it says ``$rho_d``, ``$rho_s`` and ``$alpha``,
which Mitsuba replaces by each stimulus's own::

    <bsdf type="ward">
        <float name="rho_d" value="$rho_d"/>
        <float name="rho_s" value="$rho_s"/>
        <float name="alpha" value="$alpha"/>
    </bsdf>

or ``$lightness``, ``$c`` and ``$d`` in a ``gloss_ward``. ``$width`` and ``$height`` stand for the film's. The TOML file
names the XML and has the sections film, tone, display and viewing of every other scene.
"""

import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, PrivateAttr, ValidationError, model_validator

from gloss_stimuli.scene import Display, Film, Tone, Viewing
from glossspace.errors import GlossError
from glossspace.files import read_toml, sha256_of
from glossspace.stimulus_set import Stimulus

__all__ = ["FORMAT", "UserScene", "read_user_scene"]

FORMAT = "glossspace/mitsuba-scene"

# What a stimulus may set in the XML; the whole of one of the two paints must stand there.
PHYSICAL, PERCEPTUAL, FILM = ("rho_d", "rho_s", "alpha"), ("lightness", "c", "d"), ("width", "height")

# Properties of Mitsuba plugins, and of `gloss_ward`, that name a file.
FILE_PROPERTIES = ("filename", "space")

PARAMETER = re.compile(r"\$([A-Za-z_]\w*)")


class UserScene(BaseModel):
    """What the TOML file says; make one with `read_user_scene`, which knows the folder that `file` is relative to."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    format: Literal["glossspace/mitsuba-scene"]
    version: Literal[1]
    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]+$")]
    file: str
    film: Film = Film(width=512, height=512)
    tone: Tone
    display: Display
    viewing: Viewing

    _folder: Path = PrivateAttr(default_factory=Path)

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        tone = self.tone
        if not tone.minimum_luminance_cd_m2 < tone.adapting_luminance_cd_m2 < tone.maximum_luminance_cd_m2:
            raise ValueError("tone: the adapting luminance must lie between the minimum and the maximum luminance")
        return self

    def with_film(self, film: Film) -> "UserScene":
        """The same scene on another film."""
        return self.model_copy(update={"film": film})

    @property
    def path(self) -> Path:
        """The XML file."""
        return (self._folder / self.file).resolve()

    @cached_property
    def _source(self) -> "_Source":
        return _read_source(self.path)

    @property
    def folders(self) -> tuple[Path, ...]:
        """Where the files that the XML names are looked for: beside it, then where its ``<path>`` and includes lie."""
        return tuple(self._source.folders)

    def parameters(self, stimulus: Stimulus) -> dict[str, str]:
        """Values of the parameters that the XML uses, as Mitsuba takes them."""
        values = {
            **{name: repr(float(getattr(stimulus, name))) for name in (*PHYSICAL, *PERCEPTUAL)},
            **{name: str(getattr(self.film, name)) for name in FILM},
        }
        return {name: value for name, value in values.items() if name in self._source.parameters}

    def content(self) -> dict[str, str]:
        """SHA-256 of the XML and of every file that it refers to, by their names relative to it."""
        folder = self.path.parent
        return {
            (file.relative_to(folder).as_posix() if file.is_relative_to(folder) else str(file)): sha256_of(file)
            for file in sorted(self._source.files)
        }


def read_user_scene(path: str | Path) -> UserScene:
    """Read a user's scene, and check all of its XML that can be checked without Mitsuba.

    Parameters
    ----------
    path : path
        The TOML file.

    Raises
    ------
    GlossError
        A file is missing or damaged, a value is missing, unknown or out of range, or the XML leaves no paint open.
    """
    path = Path(path)
    try:
        scene = UserScene.model_validate(read_toml(path, what="scene"))
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"]) or "scene"
        reason = first["msg"].removeprefix("Value error, ").rstrip(".")
        raise GlossError(f"The scene '{path}' is not valid at '{place}': {reason}.") from None
    scene._folder = path.parent
    if not scene.path.is_file():
        raise GlossError(
            f"The scene '{path}' names the Mitsuba scene '{scene.file}', but there is no file '{scene.path}'. Give "
            "its path relative to the TOML file."
        )
    scene._source.check()
    return scene


@dataclass
class _Source:
    """What an XML scene and its includes refer to."""

    path: Path
    folders: list[Path] = field(default_factory=list)
    defaults: dict[str, str] = field(default_factory=dict)
    parameters: set[str] = field(default_factory=set)
    files: set[Path] = field(default_factory=set)
    elements: list[ElementTree.Element] = field(default_factory=list)

    def find(self, name: str) -> Path | None:
        for folder in self.folders:
            try:
                if (folder / name).is_file():
                    return (folder / name).resolve()
            except OSError:  # longer than a file's name can be, such as the numbers of a matrix
                return None
        return None

    def value(self, text: str) -> str:
        """Attribute value with the XML's own default parameters put in, the longest names first as Mitsuba does."""
        for name in sorted(self.defaults, key=len, reverse=True):
            if name not in (*PHYSICAL, *PERCEPTUAL, *FILM):
                text = text.replace(f"${name}", self.defaults[name])
        return text

    def check(self) -> None:
        """Refuse a scene that a stimulus could not change, or that refers to what is not there."""
        known = {*PHYSICAL, *PERCEPTUAL, *FILM, *self.defaults}
        for name in sorted(self.parameters - known):
            raise GlossError(
                f"The Mitsuba scene '{self.path}' uses the parameter '${name}', which nothing sets. A stimulus sets "
                f"{', '.join('$' + name for name in (*PHYSICAL, *PERCEPTUAL, *FILM))}; give others a <default>."
            )
        if not (self.parameters.issuperset(PHYSICAL) or self.parameters.issuperset(PERCEPTUAL)):
            raise GlossError(
                f"The Mitsuba scene '{self.path}' leaves no paint open, so all stimuli would look the same: give some "
                "BSDF the values $rho_d, $rho_s and $alpha, or $lightness, $c and $d. It uses "
                f"{', '.join(sorted('$' + name for name in self.parameters)) or 'no parameter'}."
            )
        for element in self.elements:
            self._check_element(element)

    def _check_element(self, element: ElementTree.Element) -> None:
        for name in _file_names(element):
            if self.find(self.value(name)) is None:
                raise GlossError(
                    f"The Mitsuba scene '{self.path}' refers to '{self.value(name)}', but there is no such file beside "
                    "it. Give its path relative to the XML file."
                )
        if element.get("type") == "gloss_ward":
            values = {child.get("name"): child.get("value", "") for child in element}
            if "space" in values and any("$" in values.get(axis, "") for axis in ("c", "d")):
                raise GlossError(
                    f"The Mitsuba scene '{self.path}' gives $c or $d to a gloss_ward with a `space`, which wants "
                    "ratings, while a stimulus has the c and d of eqs 3 and 4. Leave out `space`."
                )


def _read_source(path: Path) -> _Source:
    source = _Source(path, folders=[path.parent])
    _read_xml(path, source)
    for element in source.elements:
        for text in element.attrib.values():
            file = source.find(source.value(text))
            if file is not None:
                source.files.add(file)
    return source


def _read_xml(path: Path, source: _Source) -> None:
    if path in source.files:
        return  # included twice, or by itself: Mitsuba says what is wrong with that
    source.files.add(path)
    try:
        root = ElementTree.parse(path).getroot()
    except (ElementTree.ParseError, LookupError, ValueError) as error:  # the latter two: encodings it does not know
        raise GlossError(f"The Mitsuba scene '{path}' is not valid XML: {error}.") from None
    except OSError as error:
        raise GlossError(f"Cannot read the Mitsuba scene '{path}': {error.strerror or error}.") from None
    if path == source.path and root.tag != "scene":
        raise GlossError(f"'{path}' is no Mitsuba scene: its outermost element is <{root.tag}>, not <scene>.")
    source.elements.extend(root.iter())
    for element in root.iter():
        if element.tag == "default":
            source.defaults.setdefault(element.get("name", ""), element.get("value", ""))
        else:
            source.parameters.update(name for text in element.attrib.values() for name in PARAMETER.findall(text))
        if element.tag == "path":
            source.folders.append(path.parent / source.value(element.get("value", "")))
        if element.tag == "include":
            included = source.find(source.value(element.get("filename", "")))
            if included is not None:
                source.folders.append(included.parent)
                _read_xml(included, source)


def _file_names(element: ElementTree.Element) -> Iterator[str]:
    if element.tag == "string" and element.get("name") in FILE_PROPERTIES:
        yield element.get("value", "")
    elif "filename" in element.attrib:
        yield element.attrib["filename"]
