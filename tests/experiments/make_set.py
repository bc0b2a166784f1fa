"""A small stimulus set of noise images: real files under a real manifest, without a renderer."""

from pathlib import Path

import numpy as np
from PIL import Image

from glossspace.files import sha256_of
from glossspace.stimulus_set import Stimulus, write_manifest


def make_set(folder: Path, *, n: int = 27, size: int = 64) -> Path:
    """The first `n` stimuli of a 3 x 3 x 3 grid like Experiment 1's; every pixel of an image is another code value."""
    folder.mkdir(parents=True, exist_ok=True)
    grid = [(d, s, a) for d in (0.03, 0.193, 0.767) for s in (0.033, 0.066, 0.099) for a in (0.04, 0.07, 0.10)]
    rng = np.random.default_rng(1)
    entries = []
    for rho_d, rho_s, alpha in grid[:n]:
        stimulus = Stimulus.of(rho_d, rho_s, alpha)
        image, luminance = folder / f"{stimulus.name}.png", folder / f"{stimulus.name}.exr"
        Image.fromarray(rng.integers(0, 256, (size, size), dtype=np.uint8)).save(image)
        luminance.write_bytes(b"not read by a session")
        entries.append(
            {
                "name": stimulus.name,
                "rho_d": rho_d,
                "rho_s": rho_s,
                "alpha": alpha,
                "image": image.name,
                "luminance": luminance.name,
                "sha256": {"image": sha256_of(image), "luminance": sha256_of(luminance)},
            }
        )
    manifest = {
        "name": "noise",
        "image": {"width": size, "height": size},
        "viewing": {"image_width_deg": 3.2},
        "display": {},
        "stimuli": entries,
    }
    write_manifest(folder, manifest)
    return folder
