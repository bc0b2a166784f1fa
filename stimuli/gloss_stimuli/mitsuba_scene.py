"""Scenes in Mitsuba: what stock integrators render, and the oracle of the study's own renderers.

A box scene becomes a dictionary. A user's XML goes through Mitsuba's own parser; then its film is replaced by one whose
pixels are plain means of luminance, since any other filter would make neighbouring pixels share their errors.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from gloss_stimuli.scene import Scene
from gloss_stimuli.user_scene import UserScene
from gloss_stimuli.variant import VARIANT
from glossspace.errors import GlossError
from glossspace.stimulus_set import Stimulus

__all__ = ["load_scene", "luminance_film", "mitsuba_scene"]

# The lamp hangs below the ceiling by this share of the box's height, or both would compete for the same rays.
LAMP_GAP = 1e-5


def mitsuba_scene(scene: Scene, *, rho_d: float, rho_s: float, alpha: float, size: int | None = None) -> dict[str, Any]:
    """Dictionary for ``mitsuba.load_dict``: Lambertian checks, a ``ward`` sphere, an area light, a box-filtered film.

    Parameters
    ----------
    scene : Scene
        Its film gives the width and height in pixels.
    rho_d, rho_s, alpha : float
        The sphere's paint.
    size : int, optional
        Width and height of a square film that replaces the scene's.

    Notes
    -----
    Set a monochromatic variant and call `gloss_stimuli.ward_bsdf.register_ward` first. Pixels come out in cd/m².
    """
    import mitsuba as mi

    transform = mi.ScalarTransform4f
    camera = scene.camera
    width, height = (scene.film.width, scene.film.height) if size is None else (size, size)
    described: dict[str, Any] = {
        "type": "scene",
        "sensor": {
            "type": "perspective",
            "fov": camera.field_of_view_deg,
            "fov_axis": "x",
            "near_clip": 1e-3 * scene.sphere.radius,
            "to_world": transform().look_at(origin=camera.position, target=camera.target, up=[0, 1, 0]),
            "film": luminance_film(width, height),
        },
        "sphere": {
            "type": "sphere",
            "center": list(scene.sphere.center),
            "radius": scene.sphere.radius,
            "bsdf": {"type": "ward", "rho_d": rho_d, "rho_s": rho_s, "alpha": alpha, "form": scene.sphere.lobe},
        },
        "light": _light(scene),
    }
    for axis in range(3):
        for side in (0, 1):
            described[f"wall_{'xyz'[axis]}{side}"] = _wall(scene, axis, side)
    return described


def luminance_film(width: int, height: int) -> dict[str, Any]:
    """Film of one channel whose pixels are plain means over their area."""
    return {
        "type": "hdrfilm",
        "width": width,
        "height": height,
        "rfilter": {"type": "box"},
        "pixel_format": "luminance",
        "component_format": "float32",
    }


def _light(scene: Scene) -> dict[str, Any]:
    import mitsuba as mi

    (x, z), (width, depth) = scene.light.center_xz, scene.light.size_xz
    height = scene.box.maximum[1] - LAMP_GAP * (scene.box.maximum[1] - scene.box.minimum[1])
    to_world = np.eye(4)
    to_world[:3] = np.transpose([[width / 2, 0, 0], [0, 0, depth / 2], [0, -1, 0], [x, height, z]])
    return {
        "type": "rectangle",
        "to_world": mi.ScalarTransform4f(to_world),
        "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}},
        "emitter": {"type": "area", "radiance": {"type": "rgb", "value": scene.light.luminance_cd_m2}},
    }


def _wall(scene: Scene, axis: int, side: int) -> dict[str, Any]:
    import mitsuba as mi

    box = scene.box
    low, high = np.array(box.minimum), np.array(box.maximum)
    half, center = (high - low) / 2, (high + low) / 2
    center[axis] = (low, high)[side][axis]
    normal = np.eye(3)[axis] * (1 - 2 * side)
    first, second = np.delete(np.arange(3), axis)
    across, along = np.eye(3)[first] * half[first], np.eye(3)[second] * half[second]
    checks = np.array([2 * half[first], 2 * half[second]]) / box.check_size
    # Two checks to a period of the texture, counted from the corner `minimum` even where u must run backwards.
    repeat = mi.ScalarTransform4f().scale([checks[0] / 2, checks[1] / 2, 1])
    if np.dot(np.cross(across, along), normal) < 0:
        across = -across
        repeat = repeat @ mi.ScalarTransform4f().translate([1, 0, 0]) @ mi.ScalarTransform4f().scale([-1, 1, 1])
    to_world = np.eye(4)
    to_world[:3] = np.transpose([across, along, normal, center])
    return {
        "type": "rectangle",
        "to_world": mi.ScalarTransform4f(to_world),
        "bsdf": {
            "type": "diffuse",
            "reflectance": {
                "type": "checkerboard",
                "color0": {"type": "rgb", "value": box.dark_reflectance},
                "color1": {"type": "rgb", "value": box.light_reflectance},
                "to_uv": repeat,
            },
        },
    }


def load_scene(scene: Scene | UserScene, stimulus: Stimulus, *, subpixels: int = 1) -> Any:
    """Mitsuba scene with the paint of a stimulus.

    Parameters
    ----------
    scene : Scene or UserScene
    stimulus : Stimulus
        The paint of the box's sphere, or the parameters of the user's XML.
    subpixels : int, optional
        The film has this many times the scene's width and height in pixels, of the same view.

    Raises
    ------
    GlossError
        Mitsuba cannot load the user's scene, or it has no light, not one camera, another size or another integrator.

    Notes
    -----
    Set the variant `llvm_ad_mono` and call `gloss_stimuli.gloss_ward_bsdf.register_plugins` first.
    """
    import mitsuba as mi

    film = luminance_film(scene.film.width * subpixels, scene.film.height * subpixels)
    if isinstance(scene, UserScene):
        return _load_user_scene(scene, stimulus, film)
    described = mitsuba_scene(scene, rho_d=stimulus.rho_d, rho_s=stimulus.rho_s, alpha=stimulus.alpha)
    described["sensor"]["film"] = film
    # One after the other, so that every paint of the scene numbers its parts alike and shares one compiled kernel.
    return mi.load_dict(described, parallel=False)


def _load_user_scene(scene: UserScene, stimulus: Stimulus, film: dict[str, Any]) -> Any:
    import mitsuba as mi

    config = mi.parser.ParserConfig(VARIANT)
    config.parallel = False
    try:
        with _files_beside(scene), _two_threads():
            state = mi.parser.parse_file(config, str(scene.path), **scene.parameters(stimulus))
            mi.parser.transform_all(config, state)
            _adapt(scene, state, mi.load_dict(film))
            loaded = mi.parser.instantiate(config, state)
    except RuntimeError as error:
        # The last line of what Mitsuba says of a plugin written in Python is that plugin's own message.
        reason = str(error).strip().rpartition("GlossError: ")[2]
        raise GlossError(
            f"Mitsuba cannot load the scene '{scene.path}' in the variant {VARIANT}, which has luminance as its one "
            f"channel: {' '.join(reason.split())}"
        ) from None
    if not loaded.emitters():
        raise GlossError(
            f"The Mitsuba scene '{scene.path}' has no light, so every image would be black. Add an <emitter>."
        )
    return loaded


@contextmanager
def _files_beside(scene: UserScene) -> Iterator[None]:
    """Make Mitsuba look beside the scene first: in the current folder it might find a file that no hash knows."""
    import mitsuba as mi

    before = mi.file_resolver()
    beside = mi.FileResolver(before)
    for folder in reversed(scene.folders):
        beside.prepend(str(folder))
    mi.set_file_resolver(beside)
    try:
        yield
    finally:
        mi.set_file_resolver(before)


@contextmanager
def _two_threads() -> Iterator[None]:
    """Give Dr.Jit a second thread on a machine of one core: Mitsuba 3.9 waits for it without end to read an EXR."""
    import drjit as dr

    before = dr.thread_count()
    if before < 2:
        dr.set_thread_count(2)
    try:
        yield
    finally:
        if before < 2:
            dr.set_thread_count(before)


def _adapt(scene: UserScene, state: Any, film: Any) -> None:
    """Put our film and sampler in place of the scene's, or say why they do not fit."""
    import mitsuba as mi

    kinds = mi.ObjectType
    sensors = [node for node in state.nodes if node.type == kinds.Sensor]
    if len(sensors) != 1:
        raise GlossError(
            f"The Mitsuba scene '{scene.path}' must have one <sensor>, but has {len(sensors)}. Keep the one to render."
        )
    for node in state.nodes:
        if node.type == kinds.Film:
            _check_film(scene, node.props)
        if node.type == kinds.Integrator and node.props.plugin_name() != "path":
            raise GlossError(
                f"The Mitsuba scene '{scene.path}' asks for the integrator '{node.props.plugin_name()}', but stimuli "
                "are rendered by 'path' without a limit of depth. Remove its <integrator>, if 'path' can render it."
            )
        if node.type == kinds.Integrator and node.props.get("hide_emitters", False):
            raise GlossError(
                f"The integrator of the Mitsuba scene '{scene.path}' hides what emits light, but stimuli show what "
                "lights them. Remove its hide_emitters."
            )
    props = sensors[0].props
    for name in list(props.keys()):
        is_part = props.type(name) == mi.Properties.Type.ResolvedReference
        if is_part and state.nodes[props[name].index()].type in (kinds.Film, kinds.Sampler):
            del props[name]
    props["film"] = film
    props["sampler"] = mi.load_dict({"type": "independent"})


def _check_film(scene: UserScene, props: Any) -> None:
    wanted = {"width": scene.film.width, "height": scene.film.height}
    found = {name: props[name] for name in wanted if name in props}
    cropped = [name for name in props.keys() if name.startswith("crop")]  # noqa: SIM118  # no iterator of its own
    if cropped or any(wanted[name] != size for name, size in found.items()):
        stated = ", ".join(f"{name} {props[name]}" for name in [*found, *cropped])
        raise GlossError(
            f"The film of the Mitsuba scene '{scene.path}' has {stated}, but [film] asks for width {wanted['width']}, "
            f"height {wanted['height']}. Write $width and $height in the XML, without a crop, or the same numbers."
        )
