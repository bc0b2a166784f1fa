"""The glossmeter: run time against error, Gauss–Legendre beside midpoint patches, and many paints at once.

    python benchmarks/glossmeter.py [--paints N] [--quick]

Errors are relative to the same integral at a tolerance of 1e-10. The patches are n × n over source and detector, n⁴
evaluations, as the two papers with virtual glossmeters cut their apertures, but in true angles, so that both methods
tend to the same number. That this number is right, `tests/glossspace/instruments/test_quadrature.py` shows by sampling.
"""

import argparse
import time
from collections.abc import Callable

import numpy as np
from rich.console import Console
from rich.table import Table

from glossspace.console import progress_bar
from glossspace.instruments.apertures import Aperture
from glossspace.instruments.glossmeter import gloss_reading, gloss_units
from glossspace.instruments.quadrature import mean_over_apertures
from glossspace.instruments.standards import GLOSS_ANGLES_DEG, glossmeter_geometry
from glossspace.reflectance import CookTorrance, Ggx, Ward
from glossspace.reflectance.model import ReflectanceModel

ROUGHNESSES = (0.5, 0.2, 0.11, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001)
PATCHES = (2, 4, 8, 16, 24)
MODELS: dict[str, Callable[[float], ReflectanceModel]] = {
    "Ward": lambda width: Ward(1.0, width),
    "Cook-Torrance, paper": lambda width: CookTorrance(1.0, width, 1.5),
    "Cook-Torrance, Beckmann": lambda width: CookTorrance(1.0, width, 1.5, form="beckmann"),
    "GGX": lambda width: Ggx(width, n=1.5),
}


def midpoint_mean(model: ReflectanceModel, source: Aperture, detector: Aperture, n: int) -> float:
    """Mean of f cosθi cosθr by n × n midpoint patches of each aperture."""
    steps = (np.arange(n) + 0.5) / n
    sides = []
    for aperture in (source, detector):
        x, y = (low + (high - low) * steps for low, high in (aperture.x_range, aperture.y_range))
        directions, density = aperture.directions(x[:, None], y[None, :])
        sides.append((directions.reshape(-1, 3), (density * directions[..., 2]).ravel() / density.sum()))
    (incident, weight_i), (exitant, weight_r) = sides
    return float(sum(w * (model.evaluate(i, exitant) @ weight_r) for i, w in zip(incident, weight_i, strict=True)))


def timed(call: Callable[[], object], *, least_s: float) -> float:
    """Seconds of one call in its best run, warm."""
    call()
    best, began = np.inf, time.perf_counter()
    while not np.isfinite(best) or time.perf_counter() - began < least_s:
        start = time.perf_counter()
        call()
        best = min(best, time.perf_counter() - start)
    return best


def accuracy(least_s: float, roughnesses: tuple[float, ...], patches: tuple[int, ...]) -> tuple[Table, float]:
    columns = ("model", "angle", "roughness", "Gauss–Legendre: error", "stated", "nodes", "ms")
    table = Table(*columns, *(f"{n}⁴ patches: error (ms)" for n in patches), title="One reading")
    worst = 0.0
    with progress_bar() as progress:
        task = progress.add_task("Lobes", total=len(MODELS) * len(GLOSS_ANGLES_DEG) * len(roughnesses))
        for name, make in MODELS.items():
            for angle in GLOSS_ANGLES_DEG:
                geometry = glossmeter_geometry(angle)
                pair = geometry.source, geometry.detector
                for width in roughnesses:
                    model = make(width)
                    truth = float(mean_over_apertures(model, *pair, relative_tolerance=1e-10).value)
                    found = mean_over_apertures(model, *pair)
                    seconds = timed(lambda m=model, p=pair: mean_over_apertures(m, *p), least_s=least_s)
                    error = abs(float(found.value) / truth - 1)
                    worst = max(worst, error)
                    cells = []
                    for n in patches:
                        start = time.perf_counter()
                        value = midpoint_mean(model, *pair, n)
                        cells.append(f"{abs(value / truth - 1):.0e} ({1000 * (time.perf_counter() - start):.2g})")
                    table.add_row(
                        name, f"{angle}", f"{width:g}", f"{error:.0e}", f"{found.relative_error:.0e}",
                        f"{found.n_evaluations}", f"{1000 * seconds:.2g}", *cells,
                    )  # fmt: skip
                    progress.advance(task)
    return table, worst


def many_paints(n: int) -> Table:
    rng = np.random.default_rng(1)
    roughness = np.exp(rng.uniform(np.log(0.03), np.log(0.5), n))
    paints = {
        "Ward, alpha .03 to .5": Ward(rng.uniform(0, 1, n), roughness),
        "Beckmann, slope .03 to .5, n 1.3 to 1.7": CookTorrance(
            1.0, roughness, rng.uniform(1.3, 1.7, n), form="beckmann"
        ),
    }
    table = Table("paints", "angle", "seconds for all", "µs a paint", title=f"{n} paints in one call, to 1e-6")
    for name, model in paints.items():
        for angle in GLOSS_ANGLES_DEG:
            start = time.perf_counter()
            gloss_units(model, angle)
            seconds = time.perf_counter() - start
            table.add_row(name, f"{angle}", f"{seconds:.2f}", f"{1e6 * seconds / n:.1f}")
    return table


def main() -> None:
    parser = argparse.ArgumentParser(description="Run time against error of the virtual glossmeter.")
    parser.add_argument("--paints", type=int, default=100_000)
    parser.add_argument("--quick", action="store_true", help="a smoke run, whose times mean nothing")
    given = parser.parse_args()
    if given.paints < 1:
        parser.error("--paints must be 1 or more.")
    console = Console(width=190)
    widths, patches = ((0.5, 0.05), (2, 4)) if given.quick else (ROUGHNESSES, PATCHES)
    table, worst = accuracy(0.0 if given.quick else 0.1, widths, patches)
    console.print(table)
    console.print(f"Largest error of Gauss–Legendre: {worst:.1e}.")
    seconds = timed(lambda: gloss_reading(Ward(0.1, 0.11)), least_s=0.1)
    console.print(f"A whole reading (three angles, three albedos) of Ward's lobe of α = .11: {1000 * seconds:.2g} ms.")
    console.print(many_paints(1000 if given.quick else given.paints))


if __name__ == "__main__":
    main()
