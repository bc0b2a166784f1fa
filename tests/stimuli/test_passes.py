import dataclasses
import math
import os
from pathlib import Path

import numpy as np
import pytest

from gloss_stimuli.passes import PassPlan, sphere_pixels
from gloss_stimuli.quality import QUALITIES, Quality, find_quality
from gloss_stimuli.scene import read_scene
from glossspace.errors import GlossError

TINY = Quality(name="tiny", randomisations=4, diffuse_samples=4, sphere_samples=4, wall_samples=2)


def plan(tmp_path: Path, **changes) -> PassPlan:
    return PassPlan(**{"scene": read_scene(), "size": 8, "quality": TINY, "seed": 1, "cache": tmp_path, **changes})


@pytest.mark.parametrize("size", [4, 33, 128])
def test_sphere_pixels_miss_no_ray_that_meets_the_sphere(scene_with, size: int) -> None:
    scene = scene_with(camera={"target": [0.2, -0.1, 0.1]})
    rng = np.random.default_rng(4)
    x, y = rng.random((2, 200_000)) * size
    right, up, forward = map(np.array, scene.camera.axes())
    half = math.tan(math.radians(scene.camera.field_of_view_deg) / 2)
    rays = forward + ((2 * x / size - 1) * half)[:, None] * right + ((1 - 2 * y / size) * half)[:, None] * up
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    to_center = np.array(scene.sphere.center) - np.array(scene.camera.position)
    meets = (to_center**2).sum() - (rays @ to_center) ** 2 < scene.sphere.radius**2
    pixels = y.astype(int) * size + x.astype(int)
    assert sphere_pixels(scene, size)[pixels[meets]].all()
    if size == 128:  # and few that no ray meets: at most a ring of two pixels
        touched = np.zeros(size * size, bool)
        touched[pixels[meets]] = True
        radius = math.sqrt(touched.sum() / math.pi)
        assert sphere_pixels(scene, size).sum() < math.pi * (radius + 2) ** 2


@pytest.mark.usefixtures("llvm")
def test_a_pass_is_kept_and_found_again(tmp_path: Path) -> None:
    steps = []
    first = plan(tmp_path).coefficients(0.07, step=lambda: steps.append(1))
    assert len(steps) == TINY.randomisations
    file = next(tmp_path.glob("*.npz"))
    os.utime(file, (1, 1))
    again = plan(tmp_path).coefficients(0.07)
    assert file.stat().st_mtime == 1
    assert again.mean.tobytes() == first.mean.tobytes()
    assert again.covariance.tobytes() == first.covariance.tobytes()
    assert again.exponents == first.exponents


@pytest.mark.usefixtures("llvm")
def test_a_damaged_pass_is_made_again(tmp_path: Path) -> None:
    first = plan(tmp_path).coefficients(None)
    file = next(tmp_path.glob("*.npz"))
    file.write_bytes(file.read_bytes()[:-100])
    assert not plan(tmp_path).is_cached(None)
    assert plan(tmp_path).coefficients(None).mean.tobytes() == first.mean.tobytes()
    assert plan(tmp_path).is_cached(None)


def test_the_key_changes_with_everything_that_changes_pixels(tmp_path: Path, scene_with) -> None:
    base = plan(tmp_path)
    changed = [
        plan(tmp_path, seed=2),
        plan(tmp_path, size=10),
        plan(tmp_path, quality=dataclasses.replace(TINY, randomisations=5)),
        plan(tmp_path, quality=dataclasses.replace(TINY, sphere_samples=8)),
        plan(tmp_path, scene=scene_with(light={"luminance_cd_m2": 1.0})),
        plan(tmp_path, scene=scene_with(sphere={"lobe": "duer2006"})),
    ]
    keys = [p.key(0.07) for p in [base, *changed]]
    assert len({*keys, base.key(0.08), base.key(None)}) == len(changed) + 3


def test_the_key_ignores_what_does_not_change_pixels(tmp_path: Path, scene_with) -> None:
    base = plan(tmp_path)
    assert plan(tmp_path / "elsewhere").key(0.07) == base.key(0.07)
    assert plan(tmp_path, scene=scene_with(tone={"slope": 0.9})).key(0.07) == base.key(0.07)
    assert plan(tmp_path, quality=dataclasses.replace(TINY, name="x")).key(None) == base.key(None)
    assert plan(tmp_path, scene=scene_with(sphere={"lobe": "duer2006"})).key(None) == base.key(None)


def test_qualities() -> None:
    assert find_quality("draft") is QUALITIES["draft"]
    with pytest.raises(GlossError, match="Unknown quality 'best'. Allowed are draft and exact"):
        find_quality("best")
