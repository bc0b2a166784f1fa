"""Small stimulus sets of noise images: real files under a real manifest, without a renderer."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from glossspace.files import sha256_of
from glossspace.stimulus_set import Stimulus, write_manifest


def make_set(folder: Path, *, n: int, size: int) -> Path:
    """The first `n` stimuli of Experiment 1's grid; the images hold every 8-bit code value."""
    folder.mkdir(parents=True, exist_ok=True)
    grid = [(d, s, a) for d in (0.03, 0.193, 0.767) for s in (0.033, 0.066, 0.099) for a in (0.04, 0.07, 0.10)]
    rng = np.random.default_rng(1)
    entries = []
    for rho_d, rho_s, alpha in grid[:n]:
        name = Stimulus.of(rho_d, rho_s, alpha).name
        image, luminance = folder / f"{name}.png", folder / f"{name}.exr"
        Image.fromarray(rng.integers(0, 256, (size, size), dtype=np.uint8)).save(image)
        luminance.write_bytes(b"not read by a session")
        hashes = {"image": sha256_of(image), "luminance": sha256_of(luminance)}
        parameters = {"name": name, "rho_d": rho_d, "rho_s": rho_s, "alpha": alpha}
        entries.append({**parameters, "image": image.name, "luminance": luminance.name, "sha256": hashes})
    manifest = {
        "name": "noise",
        "image": {"width": size, "height": size},
        "viewing": {"image_width_deg": 3.2},
        "display": {},
        "stimuli": entries,
    }
    write_manifest(folder, manifest)
    return folder


@pytest.fixture(scope="session")
def experiment1(tmp_path_factory):
    """Folder of 27 stimuli with the parameters of Experiment 1."""
    return make_set(tmp_path_factory.mktemp("sets") / "experiment1", n=27, size=32)


@pytest.fixture(scope="session")
def small_set(tmp_path_factory):
    """Folder of three stimuli of 256 x 256 pixels."""
    return make_set(tmp_path_factory.mktemp("sets") / "small", n=3, size=256)
