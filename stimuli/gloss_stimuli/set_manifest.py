"""What the manifest of a set says beside its stimuli: everything that is needed to make the files again."""

from collections.abc import Sequence
from importlib.metadata import version
from typing import Any

from gloss_stimuli.measurements import COLUMNS, FILE_NAME
from gloss_stimuli.mirrored_checks import PatchGeometry
from gloss_stimuli.renderer import Renderer
from gloss_stimuli.scene import Scene
from gloss_stimuli.sets import StimulusList
from gloss_stimuli.target import ErrorTarget
from gloss_stimuli.tone import ToneCurve
from gloss_stimuli.user_scene import UserScene
from glossspace.display import DisplayModel

__all__ = ["set_manifest"]


def set_manifest(
    wanted: StimulusList,
    scene: Scene | UserScene,
    entries: Sequence[dict[str, Any]],
    *,
    renderer: Renderer,
    reason: str,
    target: ErrorTarget,
    tone: ToneCurve,
    display: DisplayModel,
    patches: PatchGeometry | None,
    measurements_sha256: str,
) -> dict[str, Any]:
    """Manifest of a rendered set, as `glossspace.stimulus_set.write_manifest` takes it."""
    film = scene.film
    described = renderer.describe()
    software = {name: version(name) for name in ("glossspace", "OpenEXR", "pillow")} | described.pop("software", {})
    return {
        "name": wanted.name,
        "title": wanted.title,
        "image": {"width": film.width, "height": film.height, "bits": 8, "encoding": "display code values"},
        "luminance": {"unit": "cd/m2", "channel": "Y", "type": "float32", "relation": "linear, of the scene"},
        "viewing": scene.viewing.geometry().to_dict(image_width_px=film.width),
        "display": display.to_dict() | {"quantisation_error": display.quantisation_error(bits=8).to_dict()},
        "tone_curve": tone.to_dict(),
        "rendering": {
            "method": renderer.method,
            "reason": reason,
            "target": target.to_dict(),
            "error_unit": "8-bit code values before rounding, estimated from independent randomisations",
            **described,
        },
        "measurements": {
            "file": FILE_NAME,
            "sha256": measurements_sha256,
            "columns": COLUMNS,
            "patches": None if patches is None else patches.to_dict(),
        },
        "scene": scene.model_dump(mode="json"),
        "software": software,
        "stimuli": list(entries),
    }
