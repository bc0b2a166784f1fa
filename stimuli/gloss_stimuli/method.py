"""Which renderer a scene gets: the exact one wherever the scene allows it, and why not where it does not."""

from pathlib import Path
from typing import Any, Literal, TypeAlias, get_args

from gloss_stimuli.renderer import Renderer
from gloss_stimuli.scene import Scene
from gloss_stimuli.target import ErrorTarget
from gloss_stimuli.tone import ToneCurve
from gloss_stimuli.user_scene import UserScene
from glossspace.display import DisplayModel
from glossspace.errors import GlossError

__all__ = ["METHODS", "Method", "choose_renderer"]

Method: TypeAlias = Literal["auto", "exact", "coefficients", "path"]
METHODS: tuple[Method, ...] = get_args(Method)


def choose_renderer(
    scene: Scene | UserScene,
    *,
    method: Method,
    target: ErrorTarget,
    tone: ToneCurve,
    display: DisplayModel,
    seed: int,
    cache: Path,
    samples_per_pixel: int | None = None,
) -> tuple[Renderer, str]:
    """The renderer of a scene, and a few words on why it is this one.

    Parameters
    ----------
    scene : Scene or UserScene
    method : {"auto", "exact", "coefficients", "path"}
        "auto" takes the exact renderer if the scene is within its scope, else coefficient path tracing for a box, and
        path tracing for a scene of the user's own.
    target, tone, display, seed, cache
        See the renderers.
    samples_per_pixel : int, optional
        For "path": samples to take instead of going on until the target is reached.

    Raises
    ------
    GlossError
        There is no such method, the scene is beyond the one asked for, or samples were asked of another than "path".
    """
    from gloss_stimuli.exact import why_not_exact

    if method not in METHODS:
        raise GlossError(f"Unknown method '{method}'. Allowed are {', '.join(METHODS)}.")
    obstacle = "it is a Mitsuba scene" if isinstance(scene, UserScene) else why_not_exact(scene)
    if method == "exact" and obstacle:
        raise GlossError(
            f"The exact renderer does not hold for the scene '{scene.name}': {obstacle}. Use --method auto."
        )
    if method == "coefficients" and isinstance(scene, UserScene):
        raise GlossError(
            f"Coefficient path tracing renders boxes only, but '{scene.name}' is a Mitsuba scene. Use --method path."
        )
    chosen = method
    if method == "auto":
        chosen = "exact" if obstacle is None else "path" if isinstance(scene, UserScene) else "coefficients"
    reason = "asked for" if method != "auto" else "a box within its scope" if obstacle is None else obstacle
    if samples_per_pixel is not None and chosen != "path":
        raise GlossError(
            f"The number of samples (--spp) is for --method path alone; the method here is '{chosen}', which goes on "
            "until the target is reached: give --max-code-error and --fraction."
        )
    common: dict[str, Any] = {"target": target, "tone": tone, "display": display, "seed": seed}
    if chosen == "path":
        from gloss_stimuli.path_renderer import PathRenderer

        return PathRenderer(scene=scene, samples_per_pixel=samples_per_pixel, **common), reason
    assert isinstance(scene, Scene)
    if chosen == "exact":
        from gloss_stimuli.exact_renderer import ExactRenderer

        return ExactRenderer(scene=scene, cache=cache, **common), reason
    from gloss_stimuli.coefficient_renderer import CoefficientRenderer

    return CoefficientRenderer(scene=scene, cache=cache, **common), reason
