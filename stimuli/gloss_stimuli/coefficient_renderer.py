"""The coefficient path tracer as the set renderer sees it: randomisations are multiplied until an image is good enough.

It holds for every box scene, also where the exact renderer does not: a sphere that nearly touches a wall, a light
beside one.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from gloss_stimuli.code_error import code_error
from gloss_stimuli.coefficients import Coefficients
from gloss_stimuli.content_key import content_key
from gloss_stimuli.passes import PassPlan
from gloss_stimuli.renderer import Rendering, Step, alphas_of, passes_of
from gloss_stimuli.scene import Scene
from gloss_stimuli.target import ErrorTarget
from gloss_stimuli.tone import ToneCurve
from glossspace.display import DisplayModel
from glossspace.stimulus_set import Stimulus

__all__ = ["RANDOMISATIONS", "CoefficientRenderer"]

RANDOMISATIONS = (8, 32, 128, 512)
"""Independent repetitions of each pass, from the first attempt to the last."""


@dataclass(frozen=True, kw_only=True)
class CoefficientRenderer:
    """Renders any `Scene`.

    Attributes
    ----------
    scene : Scene
    target : ErrorTarget
    tone, display
        What an error in code values is measured with.
    seed : int
        Same seed, same bits, whatever the number of threads.
    cache : Path
        Folder of finished passes.
    """

    scene: Scene
    target: ErrorTarget
    tone: ToneCurve
    display: DisplayModel
    seed: int
    cache: Path

    method = "coefficients"

    def key(self, stimulus: Stimulus) -> str:
        """Hash of everything that determines the luminance of a stimulus."""
        return content_key(
            "code_error", "target", "coefficient_renderer",
            passes=[self._plan(RANDOMISATIONS[0]).key(alpha) for alpha in passes_of(stimulus)],
            target=self.target.to_dict(), tone=self.tone.to_dict(), display=self.display.to_dict(),
            paint=[stimulus.rho_d, stimulus.rho_s],
        )  # fmt: skip

    def steps(self, stimuli: Sequence[Stimulus]) -> int:
        """Number of steps if the first attempt is good enough."""
        return RANDOMISATIONS[0] * (1 + len(alphas_of(stimuli))) + len(stimuli)

    def describe(self) -> dict[str, Any]:
        """Parameters for the manifest."""
        plan = self._plan(RANDOMISATIONS[0])
        return {
            "seed": self.seed,
            "samples_a_randomisation": {
                "diffuse": plan.diffuse_samples, "sphere": plan.sphere_samples, "wall": plan.wall_samples
            },
            "software": {name: version(name) for name in ("mitsuba", "drjit", "numpy")},
        }  # fmt: skip

    def render(self, stimuli: Sequence[Stimulus], *, step: Step) -> Iterator[Rendering]:
        """Render stimuli, those that are easily exact first, and by α among them."""
        waiting = list(stimuli)
        for attempt, randomisations in enumerate(RANDOMISATIONS):
            plan = self._plan(randomisations)
            if attempt:
                step(more=1 + randomisations * (1 + len(alphas_of(waiting))))
            diffuse = plan.coefficients(None, step=step)
            failed = []
            # Ordered by α, so that memory holds the coefficients of one at a time.
            for alpha in [None, *alphas_of(waiting)]:
                specular = None if alpha is None else plan.coefficients(alpha, step=step)
                for stimulus in waiting:
                    if passes_of(stimulus)[-1] == alpha:
                        rendering = self._compose(stimulus, plan, diffuse, specular)
                        if randomisations == RANDOMISATIONS[-1] or self.target.is_reached(rendering.error):
                            step()
                            yield rendering
                        else:
                            failed.append(stimulus)
            if not failed:
                return
            waiting = failed

    def _plan(self, randomisations: int) -> PassPlan:
        return PassPlan(scene=self.scene, randomisations=randomisations, seed=self.seed, cache=self.cache)

    def _compose(
        self, stimulus: Stimulus, plan: PassPlan, diffuse: Coefficients, specular: Coefficients | None
    ) -> Rendering:
        passes = [diffuse] if specular is None else [diffuse, specular]
        shape = (self.scene.film.height, self.scene.film.width)
        luminance = sum(part.luminance(stimulus.rho_d, stimulus.rho_s) for part in passes)
        # The passes draw independent numbers, so their variances add.
        variance = sum(part.variance(stimulus.rho_d, stimulus.rho_s) for part in passes)
        luminance, spread = np.reshape(luminance, shape), np.sqrt(np.reshape(variance, shape))
        error = code_error(luminance, spread, tone=self.tone, display=self.display)
        white = diffuse.luminance(1.0, 0.0).reshape(shape)
        return Rendering(stimulus, luminance, error, {"randomisations": plan.randomisations}, white)
