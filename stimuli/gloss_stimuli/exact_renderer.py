"""The exact renderer as the set renderer sees it: solutions of growing fineness, until two of them agree.

Each level of fineness is an independent solution: other random numbers *and* other grids. An image is the mean of two
neighbouring levels, and half their difference is its error, so the estimate knows of discretisation as well as of
noise. An image that is not good enough takes the next level. Coefficients are kept on disk by content, a file for each
level and α.
"""

import contextlib
import os
import zipfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.code_error import code_error
from gloss_stimuli.content_key import content_key
from gloss_stimuli.exact import DIFFUSE_EXPONENTS, LEVELS, SPECULAR_EXPONENTS, levels_within, solve
from gloss_stimuli.renderer import Rendering, Step, alphas_of, passes_of
from gloss_stimuli.scene import Scene
from gloss_stimuli.target import ErrorTarget
from gloss_stimuli.tone import ToneCurve
from glossspace.display import DisplayModel
from glossspace.errors import GlossError
from glossspace.files import whole_file
from glossspace.stimulus_set import Stimulus

__all__ = ["ExactRenderer"]

# Targets as loose as this start on the lowest step of the ladder; half a code value is never reached there.
LOOSE_CODE_ERROR = 1.0
# Luminance below zero by no more than this part of the brightest pixel's is rounding.
SMALLEST_ROUNDING = 1e-4

Pair = tuple[NDArray[np.float32], NDArray[np.float32]]


@dataclass(frozen=True, kw_only=True)
class ExactRenderer:
    """Renders a `Scene` within the scope of `gloss_stimuli.exact`.

    Attributes
    ----------
    scene : Scene
    target : ErrorTarget
    tone, display
        What an error in code values is measured with.
    seed : int
        Same seed, same bits, whatever the number of threads.
    cache : Path
        Folder of finished coefficients.
    """

    scene: Scene
    target: ErrorTarget
    tone: ToneCurve
    display: DisplayModel
    seed: int
    cache: Path

    method = "exact"

    def key(self, stimulus: Stimulus) -> str:
        """Hash of everything that determines the luminance of a stimulus."""
        # Which level serves depends on the target, and on what turns luminance into code values.
        return content_key(
            "code_error", "target", "exact_renderer",
            coefficients=[self._key(0, alpha) for alpha in passes_of(stimulus)], target=self.target.to_dict(),
            tone=self.tone.to_dict(), display=self.display.to_dict(), paint=[stimulus.rho_d, stimulus.rho_s],
        )  # fmt: skip

    def steps(self, stimuli: Sequence[Stimulus]) -> int:
        """Number of steps if the first two levels are good enough."""
        return 2 * (1 + len(alphas_of(stimuli))) + len(stimuli)

    def describe(self) -> dict[str, Any]:
        """Parameters for the manifest."""
        return {"seed": self.seed, "software": _software()}

    def render(self, stimuli: Sequence[Stimulus], *, step: Step) -> Iterator[Rendering]:
        """Render stimuli, those that are easily exact first, and by α among them."""
        waiting = list(stimuli)
        first = 0 if self.target.max_code_error >= LOOSE_CODE_ERROR else 1
        last = levels_within(self.scene, LEVELS) - 2  # of which the next one is the finest
        for level in range(first, last + 1):
            alphas = alphas_of(waiting)
            for one in (level, level + 1) if level == first else (level + 1,):
                self._complete(one, alphas, step)
            diffuse = self._pair(level, None)
            whites = [_polynomial(DIFFUSE_EXPONENTS, one, 1.0, 0.0) for one in diffuse]
            white = self._shaped((whites[0] + whites[1]) / 2)
            failed = []
            for alpha in [None, *alphas]:
                specular = None if alpha is None else self._pair(level, alpha)
                for stimulus in waiting:
                    if passes_of(stimulus)[-1] == alpha:
                        rendering = self._compose(stimulus, level, diffuse, specular, white)
                        if level == last or self.target.is_reached(rendering.error):
                            step()
                            yield rendering
                        else:
                            failed.append(stimulus)
            if not failed:
                return
            waiting = failed
            step(more=2 + len(alphas_of(waiting)))

    def _compose(
        self, stimulus: Stimulus, level: int, diffuse: Pair, specular: Pair | None, white: NDArray[np.float64]
    ) -> Rendering:
        paint = (stimulus.rho_d, stimulus.rho_s)
        solutions = [_polynomial(DIFFUSE_EXPONENTS, one, *paint) for one in diffuse]
        if specular is not None:
            mirrored = [_polynomial(SPECULAR_EXPONENTS, one, *paint) for one in specular]
            solutions = [own + one for own, one in zip(solutions, mirrored, strict=True)]
        luminance = self._shaped((solutions[0] + solutions[1]) / 2)
        brightest = float(luminance.max(initial=0.0))
        if luminance.min() < -SMALLEST_ROUNDING * brightest:
            raise GlossError(
                f"The exact renderer fails on the scene '{self.scene.name}': it gave {stimulus.name} a luminance of "
                f"{luminance.min():g} cd/m2. Use --method coefficients, and please report the scene."
            )
        luminance = np.maximum(luminance, 0.0)  # rounding may leave a hair below
        spread = self._shaped((solutions[0] - solutions[1]) / 2)
        error = code_error(luminance, spread, tone=self.tone, display=self.display)
        return Rendering(stimulus, luminance, error, {"levels": [level, level + 1]}, white)

    def _shaped(self, pixels: NDArray[np.floating]) -> NDArray[np.float64]:
        return pixels.reshape(self.scene.film.height, self.scene.film.width).astype(np.float64)

    def _complete(self, level: int, alphas: Sequence[float], step: Step) -> None:
        """Make sure that the coefficients of a level are on disk."""
        from threadpoolctl import threadpool_limits

        missing = [alpha for alpha in [None, *alphas] if self._load(level, alpha) is None]
        for _ in range(1 + len(alphas) - len(missing)):
            step()
        if not missing:
            return
        wanted = [alpha for alpha in missing if alpha is not None]
        # Its own threads do the work; a linear algebra library with threads of its own may round differently for each
        # number.
        try:
            with threadpool_limits(1):
                for alpha, coefficients in solve(self.scene, LEVELS[level], (self.seed, level), wanted):
                    if alpha in missing:
                        with whole_file(self._path(level, alpha)) as temporary, temporary.open("wb") as stream:
                            np.savez(stream, coefficients=coefficients)
                        step()
        except FloatingPointError as error:
            raise GlossError(
                f"The exact renderer fails on the scene '{self.scene.name}': {error} Use --method coefficients, "
                "and please report the scene."
            ) from error

    def _pair(self, level: int, alpha: float | None) -> Pair:
        for one in (level, level + 1):
            with contextlib.suppress(OSError):
                os.utime(self._path(one, alpha))  # used now: the cache drops what was used longest ago
            if self._load(one, alpha) is None:  # another rendering has just dropped it
                self._complete(one, [] if alpha is None else [alpha], lambda **_: None)
        first, second = self._load(level, alpha), self._load(level + 1, alpha)
        if first is None or second is None:
            raise GlossError(f"Finished coefficients vanish from '{self.cache}'. Use a --cache of your own.")
        return first, second

    def _load(self, level: int, alpha: float | None) -> NDArray[np.float32] | None:
        try:
            # Opened here: numpy leaves a damaged file open.
            with self._path(level, alpha).open("rb") as stream, np.load(stream, allow_pickle=False) as stored:
                coefficients: NDArray[np.float32] = stored["coefficients"]
        except (OSError, EOFError, KeyError, ValueError, zipfile.BadZipFile):
            return None  # absent or damaged: it is made again
        film = self.scene.film
        terms = len(DIFFUSE_EXPONENTS if alpha is None else SPECULAR_EXPONENTS)
        fitting = coefficients.shape == (terms, film.width * film.height) and coefficients.dtype == np.float32
        return coefficients if fitting and np.isfinite(coefficients).all() else None

    def _path(self, level: int, alpha: float | None) -> Path:
        return self.cache / f"exact-{self._key(level, alpha)[:32]}.npz"

    def _key(self, level: int, alpha: float | None) -> str:
        return content_key(
            "exact",
            "scene",
            "ward_lobe",
            geometry=self.scene.geometry(),
            seed=self.seed,
            level=level,
            alpha=alpha,
            software=_software(),
        )


def _software() -> dict[str, str]:
    return {name: version(name) for name in ("numba", "llvmlite", "numpy", "scipy")}


def _polynomial(
    exponents: Sequence[tuple[int, int]], coefficients: NDArray[np.float32], rho_d: float, rho_s: float
) -> NDArray[np.float32]:
    # Term by term: a product of matrices would round differently for each number of its threads.
    total = np.zeros(coefficients.shape[1], dtype=np.float32)
    for (i, j), row in zip(exponents, coefficients, strict=True):
        total += np.float32(rho_d**i * rho_s**j) * row
    return total
