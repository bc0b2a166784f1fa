"""Run time against error: Mitsuba's stock path tracer beside the coefficient path tracer, on one machine in one run.

    python benchmarks/render.py [--size 64] [--budget-s 25]

For a few stimuli each method renders independent repetitions, doubling its samples until its budget is spent. The error
is the root mean square over the pixels of the standard error, in 8-bit code values and before rounding. Errors fall as
one over the root of time, so "CPU-s to 0.5 codes" extrapolates from the longest run, and the ratios hold for equal
error. The coefficient tracer is charged for a diffuse and a specular pass of its own ("one image"), and for what an
image of Experiment 1 costs it, where 27 share one diffuse and three specular passes ("one of 27").
"""

import argparse
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from gloss_stimuli.mitsuba_scene import mitsuba_scene
from gloss_stimuli.render import display_model, tone_curve
from gloss_stimuli.scene import Scene, read_scene
from gloss_stimuli.tracer import diffuse_exponents, specular_exponents, trace_pass
from gloss_stimuli.variant import use_llvm
from gloss_stimuli.ward_bsdf import register_ward

PAINTS = {"black, sharp": (0.03, 0.099, 0.04), "gray": (0.193, 0.066, 0.07), "white, blurred": (0.767, 0.033, 0.10)}
REPEATS = 8
TARGET = 0.5


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", type=int, default=64, help="width of the images in pixels")
    parser.add_argument("--budget-s", type=float, default=15.0, help="CPU seconds for each method and paint")
    options = parser.parse_args()
    use_llvm()
    register_ward()
    scene = read_scene()
    table = Table(title=f"Time to a mean error of {TARGET} code values, {options.size} x {options.size} pixels")
    for heading in ("paint", "method", "samples", "CPU-s", "error (codes)", "CPU-s to 0.5 codes", "stock / this"):
        table.add_column(heading, justify="left" if heading in ("paint", "method") else "right")
    for label, paint in PAINTS.items():
        stock = measure(scene, stock_renderer(scene, paint, options.size), options.budget_s)
        diffuse, specular = coefficient_renderers(scene, paint, options.size)
        own = measure(scene, lambda n, seed, d=diffuse, s=specular: d(n, seed) + s(n, seed), options.budget_s)
        share = diffuse_share(diffuse, specular)
        shared_cost = share / 27 + (1 - share) * 3 / 27
        needed = [seconds * (error / TARGET) ** 2 for _, seconds, error in (stock, own)]
        row(table, label, "stock path", stock, needed[0], 1.0)
        row(table, "", "coefficients, one image", own, needed[1], needed[0] / needed[1])
        row(table, "", "coefficients, one of 27", own, needed[1] * shared_cost, needed[0] / (needed[1] * shared_cost))
        table.add_section()
    Console(width=120).print(table)


def row(table: Table, paint: str, method: str, run: tuple[int, float, float], needed: float, ratio: float) -> None:
    samples, seconds, error = run
    table.add_row(paint, method, f"{samples}", f"{seconds:.1f}", f"{error:.3f}", f"{needed:.1f}", f"{ratio:.0f}")


def stock_renderer(scene: Scene, paint: tuple[float, float, float], size: int) -> Callable[[int, int], NDArray]:
    import mitsuba as mi

    rho_d, rho_s, alpha = paint
    loaded = mi.load_dict(mitsuba_scene(scene, rho_d=rho_d, rho_s=rho_s, alpha=alpha, size=size))
    path = mi.load_dict({"type": "path", "max_depth": 64, "rr_depth": 5})
    return lambda samples, seed: np.array(mi.render(loaded, integrator=path, spp=samples, seed=seed))[..., 0]


def coefficient_renderers(
    scene: Scene, paint: tuple[float, float, float], size: int
) -> tuple[Callable[[int, int], NDArray], Callable[[int, int], NDArray]]:
    rho_d, rho_s, roughness = paint
    pixels = np.arange(size * size, dtype=np.uint32)

    def renderer(alpha: float | None) -> Callable[[int, int], NDArray]:
        exponents = diffuse_exponents() if alpha is None else specular_exponents()
        monomials = np.array([rho_d**i * rho_s**j for i, j in exponents])

        def render(samples: int, seed: int) -> NDArray:
            own_seed = 2 * seed + (alpha is not None)
            traced = trace_pass(scene, pixels, size=size, samples=samples, seed=own_seed, alpha=alpha)
            return (monomials @ traced).reshape(size, size)

        return render

    return renderer(None), renderer(roughness)


def measure(scene: Scene, render: Callable[[int, int], NDArray], budget_s: float) -> tuple[int, float, float]:
    """Samples a pixel, CPU seconds and error of the largest run that the budget allows."""
    tone, display = tone_curve(scene), display_model(scene)
    render(1, 0)  # compiles
    samples, spent, result = 16, 0.0, (0, 0.0, 0.0)
    while True:
        start = time.process_time()
        images = np.stack([render(samples, seed) for seed in range(REPEATS)]).astype(float)
        seconds = time.process_time() - start
        error = images.std(0, ddof=1) / np.sqrt(REPEATS)
        mean = images.mean(0)
        codes = [display.exact_codes(display.white_cd_m2 * tone(mean + sign * error)) for sign in (-1, 1)]
        result = (samples * REPEATS, seconds, float(np.sqrt(np.mean(((codes[1] - codes[0]) / 2) ** 2))))
        spent += seconds
        if spent + 2 * seconds > budget_s or samples >= 1024:
            return result
        samples *= 2


def diffuse_share(diffuse: Callable[[int, int], NDArray], specular: Callable[[int, int], NDArray]) -> float:
    """Part of the time of an image that its diffuse pass takes."""
    times = []
    for render in (diffuse, specular):
        start = time.process_time()
        render(256, 0)
        times.append(time.process_time() - start)
    return times[0] / sum(times)


if __name__ == "__main__":
    main()
