"""Run time against error: stock path tracing, coefficient path tracing and the exact renderer, in one run.

    python benchmarks/render.py [--size 512] [--quick] [--picture FILE]

Each method renders a few paints of Experiment 1, with more work each time. CPU seconds are those of the whole process;
compilation is taken before and given apart. The error is the difference from a reference: the two finest levels of the
exact renderer, with another seed. It is kept in the cache folder, so that a second run is shorter; nothing else is.

Each method is charged twice: for one image alone, and for one of Experiment 1's 27, where those that can share their
work between images do.
"""

import argparse
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rendering.methods import (
    COEFFICIENTS,
    EXACT,
    STOCK,
    USUAL_LEVELS,
    Bench,
    Point,
    coefficient_points,
    compile_exact,
    exact_points,
    image_of,
    solution,
    stock_points,
)
from rendering.report import decline, equal_error_table, plot, run_table
from rich.console import Console
from rich.progress import Progress
from threadpoolctl import threadpool_limits

from gloss_stimuli.cache import cache_folder
from gloss_stimuli.code_error import code_error
from gloss_stimuli.content_key import content_key
from gloss_stimuli.render import tone_curve
from gloss_stimuli.scene import Film, Scene, read_scene
from glossspace.console import progress_bar
from glossspace.files import whole_file
from glossspace.stimulus_set import Stimulus

PICTURE = Path(__file__).with_suffix(".png")
REFERENCE_SEED = 2


@dataclass(frozen=True)
class Effort:
    """What is measured. The three α of Experiment 1 are those of the paints."""

    paints: dict[str, Stimulus]
    levels: tuple[int, ...]
    reference_levels: tuple[int, int]
    randomisations: tuple[int, ...]
    samples: tuple[int, ...]

    @property
    def alphas(self) -> list[float]:
        return sorted({paint.alpha for paint in self.paints.values()})


FULL = Effort(
    paints={
        "black, sharp": Stimulus.of(0.03, 0.099, 0.04),
        "gray": Stimulus.of(0.193, 0.066, 0.07),
        "white, blurred": Stimulus.of(0.767, 0.033, 0.10),
    },
    levels=(0, 1, 2, 3), reference_levels=(3, 4), randomisations=(4, 16), samples=(128, 512),
)  # fmt: skip
QUICK = replace(
    FULL, paints={"gray": FULL.paints["gray"]}, levels=(0, 1), reference_levels=(0, 1), randomisations=(2, 4)
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", type=int, help="width of the images in pixels; 512 if left out")
    parser.add_argument("--quick", action="store_true", help="a smoke run of 32 pixels, whose numbers mean nothing")
    parser.add_argument("--picture", type=Path, help=f"where the plot goes; {PICTURE} if left out, but for --quick")
    options = parser.parse_args()
    scene = read_scene().with_film(Film.parse(options.size or (32 if options.quick else 512)))
    effort = QUICK if options.quick else FULL
    # Idle threads of a linear algebra library would wait in CPU seconds.
    with threadpool_limits(1), progress_bar() as progress:
        compiled_s = {EXACT: compile_exact(scene, effort.alphas)}
        reference, own_error = find_reference(scene, effort, progress)
        bench = Bench(scene, effort.paints, reference, progress)
        compiled_s[STOCK], stock = stock_points(bench, effort.samples)
        compiled_s[COEFFICIENTS], coefficients = coefficient_points(bench, effort.randomisations)
        points = [*stock, *coefficients, *exact_points(bench, effort.levels)]
    console = Console(width=165, highlight=False)
    console.print(run_table(scene, points))
    console.print(equal_error_table(points))
    console.print(*remarks(effort, own_error, points, compiled_s), sep="\n")
    picture = options.picture or (None if options.quick else PICTURE)
    if picture:
        plot(points, picture)
        console.print(f"Plot: {picture}")


def find_reference(scene: Scene, effort: Effort, progress: Progress) -> tuple[dict[str, NDArray[np.float64]], float]:
    """Luminance of each paint, and the largest error that it estimates for itself on 99.9 % of the pixels."""
    paints, levels = effort.paints, effort.reference_levels
    stated = [[paint.rho_d, paint.rho_s, paint.alpha] for paint in paints.values()]
    key = content_key("exact", geometry=scene.geometry(), levels=levels, seed=REFERENCE_SEED, paints=stated)
    file = cache_folder(None, out=Path(tempfile.gettempdir())) / f"benchmark-reference-{key[:32]}.npz"
    if not file.is_file():
        images = []
        for level in progress.track(levels, description="reference"):
            own = solution(scene, level, REFERENCE_SEED, effort.alphas)
            images.append([image_of(scene, paint, own) for paint in paints.values()])
        with whole_file(file) as temporary, temporary.open("wb") as stream:
            np.savez(stream, images=images)
    with np.load(file) as stored:
        first, second = stored["images"]
    tone, display = tone_curve(scene), scene.display.model()
    errors = [
        code_error((one + other) / 2, (one - other) / 2, tone=tone, display=display).percentile(0.999)
        for one, other in zip(first, second, strict=True)
    ]
    return dict(zip(paints, (first + second) / 2, strict=True)), max(errors)


def remarks(effort: Effort, own_error: float, points: list[Point], compiled_s: dict[str, float]) -> Iterable[str]:
    """How the numbers were come by, and what they do not show."""
    levels = effort.reference_levels
    yield (
        f"Reference: exact levels {levels[0]} and {levels[1]}, seed {REFERENCE_SEED}; its own estimate of its error is "
        f"at most {own_error:.2g} codes on 99.9 % of the pixels. So the exact renderer is measured against another "
        "solution of its own kind, whose error adds to that shown. What they may have in common shows in 'mean off' of "
        "stock path, which shares no code with them (± one standard error)."
    )
    yield (
        f"At an error of half a code the exact renderer is charged for {USUAL_LEVELS}, where `gloss render` starts for "
        "it; the other rows compare at the error that each rung has."
    )
    yield (
        "Extrapolated: all CPU-s of path tracing in the second table, from the longest run, for an error that falls "
        f"as CPU-s to the power -0.5. Between the runs measured here it fell with {decline(points)}."
    )
    compiled = ", ".join(f"{name} {seconds:.1f}" for name, seconds in compiled_s.items())
    yield f"Compiling and loading, not charged, in CPU-s (kernels kept by earlier runs are used): {compiled}."


if __name__ == "__main__":
    main()
