"""The same scene as a Mitsuba dictionary: what stock integrators render, and the oracle of the coefficient tracer."""

from typing import Any

import numpy as np

from gloss_stimuli.scene import Scene

__all__ = ["mitsuba_scene"]

# The lamp hangs below the ceiling by this share of the box's height, or both would compete for the same rays.
LAMP_GAP = 1e-5


def mitsuba_scene(scene: Scene, *, rho_d: float, rho_s: float, alpha: float, size: int) -> dict[str, Any]:
    """Dictionary for ``mitsuba.load_dict``: Lambertian checks, a ``ward`` sphere, an area light, a box-filtered film.

    Notes
    -----
    Set a monochromatic variant and call `gloss_stimuli.ward_bsdf.register_ward` first. Pixels come out in cd/m².
    """
    import mitsuba as mi

    transform = mi.ScalarTransform4f
    camera = scene.camera
    described: dict[str, Any] = {
        "type": "scene",
        "sensor": {
            "type": "perspective",
            "fov": camera.field_of_view_deg,
            "near_clip": 1e-3 * scene.sphere.radius,
            "to_world": transform().look_at(origin=camera.position, target=camera.target, up=[0, 1, 0]),
            "film": {
                "type": "hdrfilm",
                "width": size,
                "height": size,
                "rfilter": {"type": "box"},
                "pixel_format": "luminance",
                "component_format": "float32",
            },
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
