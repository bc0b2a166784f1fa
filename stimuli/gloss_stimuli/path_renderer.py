"""Stock path tracing: Mitsuba's ``path`` with the Ward plugin, for any scene, until its own scatter is small enough.

A picture is the mean of many *passes*. Each pass is one call of Mitsuba that puts one sample into each of k × k cells
of every pixel, with random numbers of its own, so the scatter of the passes gives the variance of their mean without
any assumption about the scene.

The cells are pixels of a film k times as wide and high, and are averaged here. So Mitsuba, whose order of summation
depends on the number of threads, adds no two samples: the same seed gives the same bits for any number. Stratifying
the pixel also makes its edges less noisy.
"""

import hashlib
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.code_error import CodeError, code_error
from gloss_stimuli.content_key import content_key
from gloss_stimuli.gloss_ward_bsdf import register_plugins
from gloss_stimuli.mitsuba_scene import load_scene
from gloss_stimuli.renderer import Rendering, Step
from gloss_stimuli.scene import Scene
from gloss_stimuli.target import ErrorTarget
from gloss_stimuli.tone import ToneCurve
from gloss_stimuli.user_scene import UserScene
from gloss_stimuli.variant import use_llvm
from gloss_stimuli.ward_bsdf import check_paint
from glossspace.display import DisplayModel
from glossspace.errors import GlossError
from glossspace.metric import Paint
from glossspace.stimulus_set import Stimulus

__all__ = ["LARGEST_SAMPLES", "PathRenderer"]

# Fewer passes know their own scatter too badly: of 8, shared by 3 × 3 pixels, it is known to 13 %.
FEWEST_PASSES = 8

# Where the error decides, it is given up at so many samples a pixel. The shipped scene needs over 100,000 for half a
# code value on 99.9 % of its pixels.
LARGEST_SAMPLES = 2**18

# Samples that one pass may hold: about 100 bytes of memory each, and seconds until Ctrl-C is heeded.
LANES = 2**22
LARGEST_SUBPIXELS = 8

# No cut-off: every path ends by Russian roulette, whose survival Mitsuba bounds by .95, so nothing is left out however
# bright the walls. From the fifth bounce on, as is Mitsuba's default: of 2 to 64 it gave the least variance a second.
INTEGRATOR = {"type": "path", "max_depth": -1, "rr_depth": 5}


@dataclass(frozen=True, kw_only=True)
class PathRenderer:
    """Renders stimuli by stock path tracing.

    Attributes
    ----------
    scene : Scene or UserScene
        Its film gives the size of the images.
    target : ErrorTarget
        The error at which an image is finished.
    tone : ToneCurve
    display : DisplayModel
        What turn luminance into the code values in which the target is stated.
    seed : int
        Same seed, same bits, whatever the number of threads.
    samples_per_pixel : int, optional
        Samples to take instead of going on until the target is reached; rounded up to whole passes.

    Raises
    ------
    GlossError
        The number of samples or the seed is out of range.
    """

    scene: Scene | UserScene
    target: ErrorTarget
    tone: ToneCurve
    display: DisplayModel
    seed: int
    samples_per_pixel: int | None = None

    method = "path"

    def __post_init__(self) -> None:
        samples = self.samples_per_pixel
        if samples is not None and not (_is_whole(samples) and 1 <= samples <= LARGEST_SAMPLES):
            raise GlossError(
                f"The number of samples per pixel must be a whole number from 1 to {LARGEST_SAMPLES}, "
                f"but is {samples!r}."
            )
        if not (_is_whole(self.seed) and 0 <= self.seed < 2**32):
            raise GlossError(f"The seed must be a whole number from 0 to {2**32 - 1}, but is {self.seed!r}.")

    @property
    def subpixels(self) -> int:
        """Cells along a pixel's side, k: a power of two, so that usual numbers of samples are met exactly."""
        wanted = LARGEST_SUBPIXELS
        if self.samples_per_pixel is not None:
            wanted = min(wanted, math.isqrt(self.samples_per_pixel // FEWEST_PASSES))
        fitting = math.isqrt(LANES // (self.scene.film.width * self.scene.film.height))
        return 1 << max(0, min(wanted, fitting).bit_length() - 1)

    def key(self, stimulus: Stimulus) -> str:
        """Hash of everything that determines the luminance of a stimulus."""
        sources = ["path_renderer", "mitsuba_scene", "ward_bsdf", "ward_lobe", "glossspace.reflectance.ward_terms"]
        if isinstance(self.scene, UserScene):
            sources += ["gloss_ward_bsdf", "user_scene"]
            scene: dict[str, Any] = self._files
        else:
            scene = self.scene.geometry()
        if self.samples_per_pixel is None:
            # The error decides how many samples are taken, and the tone curve decides the error.
            sources += ["code_error", "target"]
            extent: dict[str, Any] = {
                "target": self.target.to_dict(), "tone": self.tone.to_dict(), "display": self.display.to_dict()
            }  # fmt: skip
        else:
            extent = {"passes": self._fixed_passes}
        return content_key(
            *sources,
            scene=scene, film=[self.scene.film.width, self.scene.film.height], subpixels=self.subpixels, extent=extent,
            paint=[stimulus.rho_d, stimulus.rho_s, stimulus.alpha], seed=self.seed, integrator=INTEGRATOR,
            mitsuba=version("mitsuba"), drjit=version("drjit"),
        )  # fmt: skip

    def steps(self, stimuli: Sequence[Stimulus]) -> int:
        """Number of passes, as far as it is known beforehand.

        Raises
        ------
        GlossError
            A paint is beyond what single precision can draw.
        """
        for stimulus in stimuli:
            check_paint(Paint(stimulus.rho_d, stimulus.rho_s, stimulus.alpha))
        return len(stimuli) * (FEWEST_PASSES if self.samples_per_pixel is None else self._fixed_passes)

    def render(self, stimuli: Sequence[Stimulus], *, step: Step) -> Iterator[Rendering]:
        """Render stimuli one after the other.

        Raises
        ------
        GlossError
            A paint cannot be drawn, Mitsuba cannot load the scene, or an image holds values that are not finite.
        """
        self.steps(stimuli)
        use_llvm()
        register_plugins()
        for stimulus in stimuli:
            yield self._render(stimulus, step)

    def describe(self) -> dict[str, Any]:
        """Parameters for the manifest."""
        described: dict[str, Any] = {
            "integrator": INTEGRATOR,
            "filter": "box",
            "seed": self.seed,
            "samples_per_pixel_and_pass": self.subpixels**2,
            "software": {name: version(name) for name in ("mitsuba", "drjit")},
        }
        if self.samples_per_pixel is None:
            described["largest_samples_per_pixel"] = LARGEST_SAMPLES
        else:
            described["samples_per_pixel_asked_for"] = self.samples_per_pixel
        if isinstance(self.scene, UserScene):
            described["scene_files"] = self._files
        return described

    @cached_property
    def _files(self) -> dict[str, str]:
        """Content of a user's scene, read once: every stimulus is rendered from the same files."""
        assert isinstance(self.scene, UserScene)
        return self.scene.content()

    @property
    def _fixed_passes(self) -> int:
        assert self.samples_per_pixel is not None
        return max(FEWEST_PASSES, math.ceil(self.samples_per_pixel / self.subpixels**2))

    @property
    def _most_passes(self) -> int:
        return max(FEWEST_PASSES, LARGEST_SAMPLES // self.subpixels**2)

    def _render(self, stimulus: Stimulus, step: Step) -> Rendering:
        passes = self._passes(stimulus)
        scatter = _Scatter()
        if self.samples_per_pixel is not None:
            stopped_by = "number of samples"
            for _ in range(self._fixed_passes):
                scatter.add(next(passes))
                step()
        else:
            stopped_by = self._add_until_exact(scatter, passes, step)
        details = {
            "samples_per_pixel": scatter.count * self.subpixels**2,
            "repetitions": scatter.count,
            "stopped_by": stopped_by,
        }
        return Rendering(stimulus, scatter.mean, self._error(scatter), details)

    def _add_until_exact(self, scatter: "_Scatter", passes: Iterator[NDArray[np.float64]], step: Step) -> str:
        """Add passes until the target or the largest number of samples is reached, and say which of them was."""
        planned = announced = FEWEST_PASSES
        needed = 0
        while True:
            while scatter.count < planned:
                scatter.add(next(passes))
                step(more=max(0, needed - announced))
                announced = max(announced, needed)
            needed = min(self._passes_needed(scatter), self._most_passes)
            if needed <= scatter.count:
                for _ in range(announced - scatter.count):
                    step()
                return "error target" if self.target.is_reached(self._error(scatter)) else "largest number of samples"
            # At most twice as many before the estimate is made anew: the first ones know little of rare bright paths.
            planned = min(needed, 2 * scatter.count)

    def _passes_needed(self, scatter: "_Scatter") -> int:
        """Passes that reach the target if the variance falls as their number; those there are, if it is reached."""
        error = self._error(scatter)
        if self.target.is_reached(error):
            return scatter.count
        excess = error.percentile(self.target.fraction) / self.target.max_code_error
        return max(scatter.count + 1, math.ceil(scatter.count * excess**2))

    def _error(self, scatter: "_Scatter") -> CodeError:
        return code_error(scatter.mean, np.sqrt(scatter.variance_of_mean), tone=self.tone, display=self.display)

    def _passes(self, stimulus: Stimulus) -> Iterator[NDArray[np.float64]]:
        """Independent images of a stimulus, without end."""
        import mitsuba as mi

        # Loaded when the scene before is gone: its parts are then numbered alike and need no other compiled kernel.
        loaded = load_scene(self.scene, stimulus, subpixels=self.subpixels)
        integrator = mi.load_dict(INTEGRATOR)
        width, height, k = self.scene.film.width, self.scene.film.height, self.subpixels
        # Every stimulus takes the same random numbers: noise that stimuli share does not tell them apart.
        first = int.from_bytes(hashlib.sha256(f"{self.seed}/path".encode()).digest()[:4], "little")
        index = 0
        while True:
            image = np.array(mi.render(loaded, integrator=integrator, spp=1, seed=(first + index) % 2**32))
            pixels = image.reshape(height, k, width, k).mean(axis=(1, 3), dtype=np.float64)
            if not np.isfinite(pixels).all():
                places = np.argwhere(~np.isfinite(pixels))
                raise GlossError(
                    f"Path tracing {stimulus.name} gave {len(places)} pixels that are not finite, the first at row "
                    f"{places[0, 0]}, column {places[0, 1]}. Look there for a mesh without area, or for a light or a "
                    "texture that is not finite."
                )
            yield pixels
            index += 1


class _Scatter:
    """Mean of images and the variance of that mean, one image at a time (Welford 1962)."""

    def __init__(self) -> None:
        self.count = 0
        self.mean: Any = 0.0
        self._squares: Any = 0.0

    def add(self, image: NDArray[np.float64]) -> None:
        self.count += 1
        difference = image - self.mean
        self.mean = self.mean + difference / self.count
        self._squares = self._squares + difference * (image - self.mean)

    @property
    def variance_of_mean(self) -> NDArray[np.float64]:
        variance: NDArray[np.float64] = self._squares / (self.count * (self.count - 1))
        return variance


def _is_whole(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)
