import math
import os
from pathlib import Path

import numpy as np
import pytest

from gloss_stimuli.passes import PassPlan, sphere_pixels
from gloss_stimuli.scene import Film, Scene, read_scene

SMALL = read_scene().with_film(Film(width=8, height=8))


def plan(cache: Path, scene: Scene = SMALL, **changes) -> PassPlan:
    few = {"randomisations": 4, "diffuse_samples": 4, "sphere_samples": 4, "wall_samples": 2}
    return PassPlan(scene=scene, cache=cache, **{"seed": 1, **few, **changes})


@pytest.mark.parametrize(("width", "height"), [(4, 4), (34, 34), (128, 128), (128, 40), (20, 128)])
def test_sphere_pixels_miss_no_ray_that_meets_the_sphere(scene_with, width: int, height: int) -> None:
    scene = scene_with(camera={"target": [0.2, -0.1, 0.1]}, film={"width": width, "height": height})
    rng = np.random.default_rng(4)
    x, y = rng.random((2, 200_000)) * [[width], [height]]
    right, up, forward = map(np.array, scene.camera.axes())
    half = math.tan(math.radians(scene.camera.field_of_view_deg) / 2)
    # Square pixels: the field of view spans the width, whatever the height.
    across, down = (2 * x - width) / width * half, (2 * y - height) / width * half
    rays = forward + across[:, None] * right - down[:, None] * up
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    to_center = np.array(scene.sphere.center) - np.array(scene.camera.position)
    meets = (to_center**2).sum() - (rays @ to_center) ** 2 < scene.sphere.radius**2
    pixels = y.astype(int) * width + x.astype(int)
    found = sphere_pixels(scene)
    assert found.shape == (width * height,)
    assert found[pixels[meets]].all()
    if width == height == 128:  # and few that no ray meets: at most a ring of two pixels
        touched = np.zeros(width * height, bool)
        touched[pixels[meets]] = True
        radius = math.sqrt(touched.sum() / math.pi)
        assert found.sum() < math.pi * (radius + 2) ** 2


@pytest.mark.usefixtures("llvm")
def test_a_pass_is_kept_and_found_again(tmp_path: Path) -> None:
    steps = []
    first = plan(tmp_path).coefficients(0.07, step=lambda: steps.append(1))
    assert len(steps) == 4
    file = next(tmp_path.glob("*.npz"))
    os.utime(file, (1, 1))
    written = file.stat().st_ino
    again = plan(tmp_path).coefficients(0.07, step=lambda: steps.append(1))
    assert len(steps) == 8
    assert file.stat().st_ino == written  # a file that is written anew is another one
    assert file.stat().st_mtime > 1  # used now: the cache drops the oldest
    assert again.mean.tobytes() == first.mean.tobytes()
    assert again.covariance.tobytes() == first.covariance.tobytes()
    assert again.exponents == first.exponents


@pytest.mark.usefixtures("llvm")
@pytest.mark.parametrize("kept", [-100, 0])
def test_a_damaged_pass_is_made_again(tmp_path: Path, kept: int) -> None:
    first = plan(tmp_path).coefficients(None)
    file = next(tmp_path.glob("*.npz"))
    file.write_bytes(file.read_bytes()[:kept])
    assert not plan(tmp_path).is_cached(None)
    assert plan(tmp_path).coefficients(None).mean.tobytes() == first.mean.tobytes()
    assert plan(tmp_path).is_cached(None)


def test_the_key_changes_with_everything_that_changes_pixels(tmp_path: Path, scene_with) -> None:
    base = plan(tmp_path)
    film = {"width": 8, "height": 8}
    changed = [
        plan(tmp_path, seed=2),
        plan(tmp_path, read_scene().with_film(Film(width=8, height=10))),
        plan(tmp_path, randomisations=5),
        plan(tmp_path, sphere_samples=8),
        plan(tmp_path, wall_samples=8),
        plan(tmp_path, scene_with(film=film, light={"luminance_cd_m2": 1.0})),
        plan(tmp_path, scene_with(film=film, sphere={"lobe": "duer2006"})),
    ]
    keys = [p.key(0.07) for p in [base, *changed]]
    assert len({*keys, base.key(0.08), base.key(None)}) == len(changed) + 3


def test_the_key_ignores_what_does_not_change_pixels(tmp_path: Path, scene_with) -> None:
    base, film = plan(tmp_path), {"width": 8, "height": 8}
    assert plan(tmp_path / "elsewhere").key(0.07) == base.key(0.07)
    assert plan(tmp_path, scene_with(film=film, tone={"slope": 0.9})).key(0.07) == base.key(0.07)
    # The diffuse pass knows no lobe, a specular one no samples of the diffuse.
    assert plan(tmp_path, scene_with(film=film, sphere={"lobe": "duer2006"})).key(None) == base.key(None)
    assert plan(tmp_path, sphere_samples=8, wall_samples=8).key(None) == base.key(None)
    assert plan(tmp_path, diffuse_samples=8).key(0.07) == base.key(0.07)
