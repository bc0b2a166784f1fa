"""Make path_blocks.json: block means of stock path tracing, for the exact renderer to be tested against.

    python tests/reference/path_blocks.py --passes 400

Mitsuba's own ``path`` with the Ward plugin renders the shipped scene in independent passes of 16 samples a pixel, for
each of six stimuli that span the range: half an hour on two cores. Kept are the means over 8 × 8 blocks of the image,
over the wall pixels and over the sphere pixels, each with the standard error that the scatter of the passes gives it.
The numbers come from Mitsuba alone.
"""

import argparse
import json
from importlib.metadata import version
from pathlib import Path

import numpy as np

from gloss_stimuli.gloss_ward_bsdf import register_plugins
from gloss_stimuli.mitsuba_scene import load_scene
from gloss_stimuli.passes import sphere_pixels
from gloss_stimuli.path_renderer import INTEGRATOR
from gloss_stimuli.scene import Film, read_scene
from gloss_stimuli.variant import use_llvm
from glossspace.stimulus_set import Stimulus

PAINTS = [
    (0.03, 0.099, 0.01), (0.03, 0.099, 0.19), (0.03, 0.033, 0.10), (0.193, 0.066, 0.07), (0.767, 0.099, 0.04),
    (0.767, 0.033, 0.10),
]  # fmt: skip
SIZE, BLOCKS, SAMPLES_A_PASS = 256, 8, 16


def statistics(image: np.ndarray, walls: np.ndarray, sphere: np.ndarray) -> np.ndarray:
    """The means that are kept, as one vector: blocks row by row, walls, sphere."""
    step = len(image) // BLOCKS
    blocks = image.reshape(BLOCKS, step, BLOCKS, step).mean(axis=(1, 3))
    return np.concatenate([blocks.ravel(), [image.ravel()[walls].mean(), image.ravel()[sphere].mean()]])


def regions(size: int) -> tuple[np.ndarray, np.ndarray]:
    """Wall and sphere pixels of a film of 64 × 64, clear of the outline, as masks of a larger one."""
    scene = read_scene().with_film(Film(width=64, height=64))
    touched = sphere_pixels(scene).reshape(64, 64)
    clear = touched.copy()
    for axis in (0, 1):
        for shift in (-2, -1, 1, 2):
            clear &= np.roll(touched, shift, axis)
    factor = size // 64
    enlarge = np.ones((factor, factor), bool)
    return np.kron(~touched, enlarge).ravel(), np.kron(clear, enlarge).ravel()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--passes", type=int, default=400, help="for each stimulus")
    count_of_passes = parser.parse_args().passes
    use_llvm()
    register_plugins()
    import mitsuba as mi

    scene = read_scene().with_film(Film(width=SIZE, height=SIZE))
    integrator = mi.load_dict(INTEGRATOR)
    walls, sphere = regions(SIZE)
    stimuli = []
    for number, paint in enumerate(PAINTS):
        loaded = load_scene(scene, Stimulus.of(*paint))
        passes = []
        for index in range(count_of_passes):
            seed = number * 2**24 + index
            image = np.array(mi.render(loaded, integrator=integrator, spp=SAMPLES_A_PASS, seed=seed))
            passes.append(statistics(image.reshape(SIZE, SIZE).astype(np.float64), walls, sphere))
        mean, error = np.mean(passes, axis=0), np.std(passes, axis=0, ddof=1) / np.sqrt(len(passes))
        count = BLOCKS * BLOCKS
        stimuli.append(
            {
                "rho_d": paint[0],
                "rho_s": paint[1],
                "alpha": paint[2],
                "samples_per_pixel": len(passes) * SAMPLES_A_PASS,
                "blocks": [float(f"{value:.8g}") for value in mean[:count]],
                "blocks_standard_error": [float(f"{value:.3g}") for value in error[:count]],
                "walls": float(f"{mean[count]:.8g}"),
                "walls_standard_error": float(f"{error[count]:.3g}"),
                "sphere": float(f"{mean[count + 1]:.8g}"),
                "sphere_standard_error": float(f"{error[count + 1]:.3g}"),
            }
        )
        print(paint, "walls", error[count] / mean[count], "sphere", error[count + 1] / mean[count + 1], flush=True)
        del loaded
    document = {
        "source": "Mitsuba's stock path tracer; see path_blocks.py",
        "software": {name: version(name) for name in ("mitsuba", "drjit")},
        "unit": "cd/m2",
        "scene": scene.geometry(),
        "stimuli": stimuli,
    }
    Path(__file__).with_suffix(".json").write_text(json.dumps(document, indent=1) + "\n")


if __name__ == "__main__":
    main()
