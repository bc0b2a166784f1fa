"""The three methods that are compared: each gives its compilation time, and points of cost and error."""

import itertools
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.progress import Progress

from gloss_stimuli.code_error import code_error
from gloss_stimuli.exact import DIFFUSE_EXPONENTS, LEVELS, SPECULAR_EXPONENTS, solve
from gloss_stimuli.passes import PassPlan
from gloss_stimuli.path_renderer import PathRenderer
from gloss_stimuli.render import tone_curve
from gloss_stimuli.renderer import Rendering
from gloss_stimuli.scene import Film, Scene
from gloss_stimuli.target import find_target
from glossspace.stimulus_set import Stimulus

STOCK, COEFFICIENTS, EXACT = METHODS = ("stock path", "coefficients", "exact")

N_IMAGES = 27  # of Experiment 1
USUAL_LEVELS = "levels 1, 2"  # where `gloss render --quality exact` starts
SEED = 1
# Large enough for every kernel that path tracing needs, and done at once.
COMPILING = Film(width=32, height=32)

Solution = dict[float | None, NDArray[np.float32]]


@dataclass(frozen=True)
class Point:
    """One image: what it cost, and how far it is from the reference.

    Errors are in code values before rounding: of 50, 99 and 99.9 % of the pixels, and what the method itself estimates
    for the last.
    """

    paint: str
    method: str
    effort: str
    cpu_s: float
    cpu_s_of_set: float
    percentiles: tuple[float, float, float]
    estimate: float
    relative_mse: float
    mean_off: float
    mean_off_error: float

    @property
    def error(self) -> float:
        """On 99.9 % of the pixels."""
        return self.percentiles[2]


@dataclass(frozen=True)
class Bench:
    """What all methods share: the scene, the paints, and what the truth is taken to be."""

    scene: Scene
    paints: dict[str, Stimulus]
    reference: dict[str, NDArray[np.float64]]
    progress: Progress

    @property
    def alphas(self) -> list[float]:
        return sorted({paint.alpha for paint in self.paints.values()})

    def point(
        self, paint: str, method: str, effort: str, costs: tuple[float, float], luminance: NDArray, estimate: float
    ) -> Point:
        reference = self.reference[paint]
        error = np.abs(self._codes(luminance) - self._codes(reference))
        median, almost, nearly_all = (float(np.quantile(error, share)) for share in (0.5, 0.99, 0.999))
        difference = luminance - reference
        return Point(
            paint, method, effort, *costs, (median, almost, nearly_all), estimate,
            relative_mse=float(np.mean((difference / reference) ** 2)),
            mean_off=float(difference.mean() / reference.mean()),
            mean_off_error=float(difference.std() / np.sqrt(difference.size) / reference.mean()),
        )  # fmt: skip

    def estimated(self, luminance: NDArray, spread: NDArray) -> float:
        """Error on 99.9 % of the pixels, as the method itself knows it."""
        tone, display = tone_curve(self.scene), self.scene.display.model()
        return code_error(luminance, spread, tone=tone, display=display).percentile(0.999)

    def _codes(self, luminance: NDArray) -> NDArray[np.float64]:
        display = self.scene.display.model()
        return display.exact_codes(display.white_cd_m2 * tone_curve(self.scene)(luminance))


def timed(work: Callable[..., Any], *arguments: Any) -> tuple[float, Any]:
    """CPU seconds of this process with all its threads, and what the work gives."""
    start = time.process_time()
    result = work(*arguments)
    return time.process_time() - start, result


def stock_points(bench: Bench, samples: Sequence[int]) -> tuple[float, list[Point]]:
    """Mitsuba's own path tracer, which renders each image by itself."""
    some_paint = next(iter(bench.paints.values()))
    compile_s, _ = timed(stock_rendering, bench.scene.with_film(COMPILING), some_paint, samples[0])
    points = []
    for count in bench.progress.track(samples, description=STOCK):
        for name, paint in bench.paints.items():
            cpu_s, rendering = timed(stock_rendering, bench.scene, paint, count)
            estimate = rendering.error.percentile(0.999)
            points.append(
                bench.point(name, STOCK, f"{count} samples", (cpu_s, cpu_s), rendering.luminance, estimate)
            )  # fmt: skip
    return compile_s, points


def stock_rendering(scene: Scene, paint: Stimulus, samples: int) -> Rendering:
    renderer = PathRenderer(
        scene=scene, target=find_target("exact"), tone=tone_curve(scene), display=scene.display.model(),
        seed=SEED + samples, samples_per_pixel=samples,
    )  # fmt: skip
    return next(renderer.render([paint], step=lambda *, more=0: None))


def coefficient_points(bench: Bench, randomisations: Sequence[int]) -> tuple[float, list[Point]]:
    """Our path tracer: a diffuse pass for all images and a specular one for each α, repeated so many times."""
    compile_s, _ = timed(coefficient_passes, bench.scene.with_film(COMPILING), 2, bench.alphas[:1])
    points = []
    for count in bench.progress.track(randomisations, description=COEFFICIENTS):
        passes = coefficient_passes(bench.scene, count, bench.alphas)
        shared_s = sum(cpu_s for cpu_s, _ in passes.values()) / N_IMAGES
        for name, paint in bench.paints.items():
            (diffuse_s, diffuse), (specular_s, specular) = passes[None], passes[paint.alpha]
            rho = paint.rho_d, paint.rho_s
            compose_s, luminance = timed(lambda a=diffuse, b=specular, r=rho: a.luminance(*r) + b.luminance(*r))
            spread = np.sqrt(diffuse.variance(*rho) + specular.variance(*rho))
            luminance, spread = (pixels.reshape(shape(bench.scene)) for pixels in (luminance, spread))
            costs = diffuse_s + specular_s + compose_s, shared_s + compose_s
            work, estimate = f"{count} repetitions", bench.estimated(luminance, spread)
            points.append(bench.point(name, COEFFICIENTS, work, costs, luminance, estimate))
    return compile_s, points


def coefficient_passes(scene: Scene, randomisations: int, alphas: Sequence[float]) -> dict[float | None, Any]:
    """CPU seconds and coefficients of each pass."""
    with tempfile.TemporaryDirectory() as cache:
        plan = PassPlan(scene=scene, randomisations=randomisations, seed=SEED + randomisations, cache=Path(cache))
        return {alpha: timed(plan.coefficients, alpha) for alpha in (None, *alphas)}


def compile_exact(scene: Scene, alphas: Sequence[float]) -> float:
    """CPU seconds that a first solution takes more than a second one."""
    first_s, second_s = (timed(solution, scene, 0, SEED, alphas)[0] for _ in range(2))
    return max(0.0, first_s - second_s)


def exact_points(bench: Bench, levels: Sequence[int]) -> list[Point]:
    """The exact renderer: an image is the mean of two neighbouring levels, each solved once for all α."""
    scene = bench.scene
    together_s, alone_s, solutions = {}, {}, {}
    for level in bench.progress.track(levels, description=EXACT):
        together_s[level], solutions[level] = timed(solution, scene, level, SEED, bench.alphas)
        for alpha in bench.alphas:
            others = [one for one in bench.alphas if one != alpha]
            alone_s[level, alpha] = timed(solution, scene, level, SEED, [alpha])[0] if others else together_s[level]
    points = []
    for low, high in itertools.pairwise(levels):
        shared_s = (together_s[low] + together_s[high]) / N_IMAGES
        for name, paint in bench.paints.items():
            low_s, one = timed(image_of, scene, paint, solutions[low])
            high_s, other = timed(image_of, scene, paint, solutions[high])
            compose_s = low_s + high_s
            costs = alone_s[low, paint.alpha] + alone_s[high, paint.alpha] + compose_s, shared_s + compose_s
            luminance, spread = (one + other) / 2, (one - other) / 2
            work, estimate = f"levels {low}, {high}", bench.estimated(luminance, spread)
            points.append(bench.point(name, EXACT, work, costs, luminance, estimate))
    return points


def solution(scene: Scene, level: int, seed: int, alphas: Sequence[float]) -> Solution:
    """Coefficients of the pixels at one level, with the random numbers that `ExactRenderer` would take."""
    return dict(solve(scene, LEVELS[level], (seed, level), alphas))


def image_of(scene: Scene, paint: Stimulus, own: Solution) -> NDArray[np.float64]:
    def polynomial(exponents: Sequence[tuple[int, int]]) -> NDArray[np.float32]:
        return np.array([paint.rho_d**i * paint.rho_s**j for i, j in exponents], dtype=np.float32)

    pixels = polynomial(DIFFUSE_EXPONENTS) @ own[None] + polynomial(SPECULAR_EXPONENTS) @ own[paint.alpha]
    return pixels.reshape(shape(scene)).astype(np.float64)


def shape(scene: Scene) -> tuple[int, int]:
    return scene.film.height, scene.film.width
