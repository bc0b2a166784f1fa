"""The stimulus-set contract: a folder of images with a ``manifest.json`` that says what each one shows.

Whoever renders writes it; sessions and analyses read it. All meet in the files, so none imports another.
"""

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from glossspace.errors import GlossError
from glossspace.files import read_json, sha256_of, write_json
from glossspace.metric import contrast_gloss, distinctness, lightness

__all__ = [
    "MANIFEST_FORMAT",
    "MANIFEST_NAME",
    "MANIFEST_VERSION",
    "Stimulus",
    "StimulusSet",
    "read_stimulus_set",
    "stimulus_name",
    "write_manifest",
]

MANIFEST_NAME = "manifest.json"
MANIFEST_FORMAT = "glossspace/stimulus-set"
MANIFEST_VERSION = 1

# What every stimulus of a manifest must state; more may stand beside it.
FILE_KINDS = ("image", "luminance")
STIMULUS_FIELDS = ("name", "rho_d", "rho_s", "alpha", *FILE_KINDS, "sha256")


def stimulus_name(rho_d: float, rho_s: float, alpha: float) -> str:
    """Name of a stimulus: its parameters with as many digits as tell them apart from every other.

    Examples
    --------
    >>> stimulus_name(0.193, 0.066, 0.07)
    'd0.193_s0.066_a0.07'
    """
    d, s, a = (np.format_float_positional(value, trim="-") for value in (rho_d, rho_s, alpha))
    return f"d{d}_s{s}_a{a}"


@dataclass(frozen=True)
class Stimulus:
    """One painted sphere: diffuse and specular reflectance, and roughness, of Ward's model.

    Raises
    ------
    GlossError
        A parameter is not a finite number, a reflectance is negative, both add to more than 1, or alpha is not above 0.

    Examples
    --------
    >>> gray = Stimulus.of(0.193, 0.066, 0.07)
    >>> gray.name, round(gray.c, 5), round(gray.d, 2)
    ('d0.193_s0.066_a0.07', 0.08702, 0.93)
    """

    name: str
    rho_d: float
    rho_s: float
    alpha: float

    def __post_init__(self) -> None:
        for field in ("rho_d", "rho_s", "alpha"):
            value = getattr(self, field)
            is_number = isinstance(value, int | float) and not isinstance(value, bool)
            # By comparison, since a whole number of 400 digits overflows where it is converted.
            if not is_number or not abs(value) <= sys.float_info.max:
                raise GlossError(f"{field} must be a finite number, but is {value!r}.")
        for field in ("rho_d", "rho_s"):
            if getattr(self, field) < 0:
                raise GlossError(f"{field} must be at least 0, but is {getattr(self, field):g}.")
        if self.alpha <= 0:
            raise GlossError(f"alpha must be above 0, but is {self.alpha:g}.")
        if self.rho_d + self.rho_s > 1:
            total = f"{self.rho_d:g} + {self.rho_s:g} = {self.rho_d + self.rho_s:g}"
            raise GlossError(f"rho_d + rho_s must be at most 1, but {total}: no paint reflects more than it receives.")

    @classmethod
    def of(cls, rho_d: float, rho_s: float, alpha: float) -> "Stimulus":
        """Stimulus with these parameters under its standard name."""
        d, s, a = (float(value) + 0.0 for value in (rho_d, rho_s, alpha))  # + 0.0 turns a negative zero
        return cls(stimulus_name(d, s, a), d, s, a)

    @property
    def c(self) -> float:
        """Contrast gloss, eq. 4 of the gloss paper."""
        return float(contrast_gloss(self.rho_d, self.rho_s))

    @property
    def d(self) -> float:
        """Distinctness-of-image gloss, eq. 3 of the gloss paper."""
        return float(distinctness(self.alpha))

    @property
    def lightness(self) -> float:
        """CIELAB lightness L* (0–100) of the diffuse reflectance."""
        return float(lightness(self.rho_d))


@dataclass(frozen=True)
class StimulusSet:
    """A stimulus set on disk; make one with `read_stimulus_set`.

    Attributes
    ----------
    folder : Path
        Where the manifest and the images lie.
    name : str
        Name of the set.
    stimuli : tuple of Stimulus
        In the order of the manifest.
    manifest : dict
        The manifest as read.
    """

    folder: Path
    name: str
    stimuli: tuple[Stimulus, ...]
    manifest: dict[str, Any]

    def table(self) -> pd.DataFrame:
        """One row a stimulus, with the columns stimulus, rho_d, rho_s, alpha, c, d and lightness (L*, 0–100)."""
        columns = ["stimulus", "rho_d", "rho_s", "alpha", "c", "d", "lightness"]
        rows = [(s.name, s.rho_d, s.rho_s, s.alpha, s.c, s.d, s.lightness) for s in self.stimuli]
        return pd.DataFrame(rows, columns=columns)

    def image_path(self, name: str) -> Path:
        """8-bit grayscale PNG of display code values, for the screen."""
        return self.folder / self._entry(name)["image"]

    def luminance_path(self, name: str) -> Path:
        """OpenEXR of linear scene luminance (cd/m²), for science."""
        return self.folder / self._entry(name)["luminance"]

    @property
    def image_size(self) -> tuple[int, int]:
        """Width and height of every image in pixels."""
        image = self.manifest["image"]
        return int(image["width"]), int(image["height"])

    @property
    def visual_angle_deg(self) -> float:
        """Visual angle that the width of an image must have on the screen."""
        return float(self.manifest["viewing"]["image_width_deg"])

    @cached_property
    def _entries(self) -> dict[str, dict[str, Any]]:
        return {entry["name"]: entry for entry in self.manifest["stimuli"]}

    def _entry(self, name: str) -> dict[str, Any]:
        if name not in self._entries:
            raise GlossError(f"The stimulus set '{self.name}' in '{self.folder}' has no stimulus '{name}'.")
        return self._entries[name]


def read_stimulus_set(folder: str | Path, *, verify: bool = True) -> StimulusSet:
    """Read a stimulus set and, unless told otherwise, check that no file has changed since it was rendered.

    Parameters
    ----------
    folder : path
        The folder that holds ``manifest.json``.
    verify : bool, optional
        Compare the SHA-256 of every listed file with the manifest's. Missing files are found either way.

    Returns
    -------
    StimulusSet

    Raises
    ------
    GlossError
        The folder or a file is missing, the manifest is damaged or of a newer version, or a hash does not match.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise GlossError(f"No stimulus set at '{folder}': the folder does not exist. Render one with `gloss render`.")
    path = folder / MANIFEST_NAME
    if not path.is_file():
        raise GlossError(
            f"No stimulus set in '{folder}': it holds no {MANIFEST_NAME}. Finish its rendering with `gloss render`."
        )
    manifest = read_json(path, what="stimulus manifest")
    if manifest.get("format") != MANIFEST_FORMAT:
        raise GlossError(
            f"'{path}' is no stimulus manifest: its format is {manifest.get('format')!r}, not '{MANIFEST_FORMAT}'."
        )
    version = manifest.get("version")
    if not isinstance(version, int) or isinstance(version, bool) or version < 1:
        raise GlossError(f"The stimulus manifest '{path}' has no valid version: {version!r}. Render the set again.")
    if version > MANIFEST_VERSION:
        raise GlossError(
            f"The stimulus manifest '{path}' is of version {version}, but this program reads up to {MANIFEST_VERSION}. "
            "Install a newer glossspace."
        )
    stimuli = tuple(_read_stimulus(entry, path) for entry in _section(manifest, "stimuli", list, path))
    for key, kind in (("name", str), ("image", dict), ("viewing", dict), ("display", dict)):
        _section(manifest, key, kind, path)
    for section, keys in (("image", ("width", "height")), ("viewing", ("image_width_deg",))):
        for key in keys:
            _require_positive(manifest[section].get(key), f"{section}.{key}", path)
    names = [stimulus.name for stimulus in stimuli]
    for name in names:
        if names.count(name) > 1:
            raise GlossError(f"The stimulus manifest '{path}' lists the stimulus '{name}' twice. Render the set again.")
    for entry in manifest["stimuli"]:
        _check_files(folder, entry, path, verify=verify)
    return StimulusSet(folder, manifest["name"], stimuli, manifest)


def write_manifest(folder: str | Path, manifest: dict[str, Any]) -> Path:
    """Write ``manifest.json``, whole or not at all; format and version are put at its head.

    Returns
    -------
    Path
        The file written.
    """
    path = Path(folder) / MANIFEST_NAME
    write_json(path, {"format": MANIFEST_FORMAT, "version": MANIFEST_VERSION, **manifest})
    return path


def _section(manifest: dict[str, Any], key: str, kind: type, path: Path) -> Any:
    value = manifest.get(key)
    if not isinstance(value, kind) or (key == "stimuli" and not value):
        raise GlossError(f"The stimulus manifest '{path}' has no valid '{key}'. Render the set again.")
    return value


def _require_positive(value: Any, key: str, path: Path) -> None:
    if isinstance(value, bool) or not isinstance(value, int | float) or not value > 0:
        raise GlossError(f"The stimulus manifest '{path}' has no valid '{key}': {value!r}. Render the set again.")


def _read_stimulus(entry: Any, path: Path) -> Stimulus:
    missing = [field for field in STIMULUS_FIELDS if not isinstance(entry, dict) or field not in entry]
    if missing:
        raise GlossError(f"A stimulus of the manifest '{path}' lacks {_listed(missing)}. Render the set again.")
    if not isinstance(entry["name"], str) or not entry["name"].strip():
        raise GlossError(f"A stimulus of the manifest '{path}' has no valid name: {entry['name']!r}. Render it again.")
    try:
        return Stimulus(entry["name"], entry["rho_d"], entry["rho_s"], entry["alpha"])
    except GlossError as error:
        raise GlossError(f"The stimulus '{entry['name']}' of the manifest '{path}' cannot be: {error}") from None


def _check_files(folder: Path, entry: dict[str, Any], path: Path, *, verify: bool) -> None:
    hashes = entry["sha256"] if isinstance(entry["sha256"], dict) else {}
    # Beside what every stimulus has, whatever else the manifest holds a hash of, such as an image of 16 bits.
    for kind in dict.fromkeys((*FILE_KINDS, *hashes)):
        if not isinstance(entry.get(kind), str):
            raise GlossError(
                f"The manifest '{path}' names no file for the {kind} of '{entry['name']}'. Render the set again."
            )
        file = folder / entry[kind]
        if not file.is_file():
            raise GlossError(
                f"The {kind} of '{entry['name']}' is missing: there is no '{file}'. Render the set again or restore it."
            )
        recorded = hashes.get(kind)
        if not isinstance(recorded, str):
            raise GlossError(
                f"The manifest '{path}' holds no hash for the {kind} of '{entry['name']}'. Render the set again."
            )
        if verify and sha256_of(file) != recorded:
            raise GlossError(
                f"The hash does not match its {kind}: '{file}' was changed after the manifest '{path}' was written. "
                "Render the set again or restore the file."
            )


def _listed(names: Sequence[str]) -> str:
    return ", ".join(f"'{name}'" for name in names)
