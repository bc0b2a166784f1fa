"""Small sets of stimuli for the tests of the set renderer: how they are made, and what lies in their folders."""

import csv
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.images import read_luminance
from glossspace.stimulus_set import StimulusSet

__all__ = [
    "DRAFT",
    "MESH",
    "NAMES",
    "RENDER",
    "SHIPPED_SCENE",
    "SIZE",
    "exact_codes",
    "files_of",
    "images_of",
    "measurements_of",
    "write_list",
    "write_scene",
]

SIZE = 64
DRAFT = {"size": SIZE, "quality": "draft"}  # as `rendered` is made
NAMES = ["d0.03_s0.099_a0.04", "d0.767_s0.033_a0.04", "d0.193_s0.066_a0.1"]
SHIPPED_SCENE = Path(__file__).parents[2] / "stimuli" / "scenes" / "checkerboard_box.toml"
MESH = Path(__file__).parent / "data" / "mesh_scene" / "scene.toml"
RENDER = "from glossspace.cli import main; main()"


def files_of(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def images_of(stimuli: StimulusSet) -> list[Path]:
    return [path(s.name) for s in stimuli.stimuli for path in (stimuli.image_path, stimuli.luminance_path)]


def exact_codes(stimuli: StimulusSet, name: str) -> NDArray[np.float64]:
    """Code values before rounding, from the luminance file and the numbers of the manifest alone."""
    tone, display = stimuli.manifest["tone_curve"], stimuli.manifest["display"]
    power = (read_luminance(stimuli.luminance_path(name)) / np.float64(tone["adapting_luminance_cd_m2"])) ** (
        tone["exponent"]
    )
    shown = display["white_cd_m2"] * tone["gain"] * (power + 1 / tone["knee"]) / (power + tone["knee"])
    share = (shown - display["black_cd_m2"]) / (display["white_cd_m2"] - display["black_cd_m2"])
    return 255 * np.clip(share, 0, 1) ** (1 / display["gamma"])


def measurements_of(stimuli: StimulusSet) -> list[dict[str, str]]:
    with (stimuli.folder / "measurements.csv").open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def write_list(path: Path, *paints: str) -> Path:
    path.write_text("\n".join(["rho_d,rho_s,alpha", *paints]) + "\n", encoding="utf-8")
    return path


def write_scene(folder: Path, **lines: str) -> Path:
    """The shipped scene with some lines, found by their first word, written anew: ``slope="slope = 0.9"``."""
    text = SHIPPED_SCENE.read_text("utf-8").splitlines()
    for key, line in lines.items():
        (index,) = (k for k, old in enumerate(text) if old.split(" ", 1)[0] == key)
        text[index] = line
    path = folder / "scene.toml"
    path.write_text("\n".join(text), encoding="utf-8")
    return path
