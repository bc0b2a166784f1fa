"""Coefficient passes and their cache: stimuli of a scene share the diffuse pass, those of one α the specular one."""

import contextlib
import hashlib
import math
import os
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.coefficients import COVARIANCE_TERMS, Coefficients, average
from gloss_stimuli.content_key import content_key
from gloss_stimuli.scene import Scene
from gloss_stimuli.tracer import diffuse_exponents, specular_exponents, trace_pass
from gloss_stimuli.variant import use_llvm
from glossspace.files import whole_file

__all__ = ["PassPlan", "sphere_pixels"]


@dataclass(frozen=True, kw_only=True)
class PassPlan:
    """How the coefficients of a scene are made, and where they are kept.

    Attributes
    ----------
    scene : Scene
        Only its geometry, light and camera matter here.
    randomisations : int
        Independent repetitions; their scatter is the error estimate.
    seed : int
        Same seed, same bits.
    cache : Path
        Folder of finished passes.
    diffuse_samples : int
        Paths a pixel and repetition in the diffuse pass, which all stimuli share; a power of two.
    sphere_samples, wall_samples : int
        The same in a specular pass, for pixels on and off the sphere.
    """

    scene: Scene
    randomisations: int
    seed: int
    cache: Path
    diffuse_samples: int = 256
    sphere_samples: int = 64
    wall_samples: int = 16

    def key(self, alpha: float | None) -> str:
        """Hash of everything that determines the coefficients of the pass for `alpha` (None: the diffuse pass)."""
        samples = [self.diffuse_samples] if alpha is None else [self.sphere_samples, self.wall_samples]
        geometry = self.scene.geometry()
        if alpha is None:
            geometry["sphere"].pop("lobe")
        return content_key(
            "tracer", "lattice", "ward_lobe", "glossspace.reflectance.ward_terms", "coefficients", "passes",
            geometry=geometry, seed=self.seed, alpha=alpha, samples=samples, randomisations=self.randomisations,
            mitsuba=version("mitsuba"), drjit=version("drjit"),
        )  # fmt: skip

    def is_cached(self, alpha: float | None) -> bool:
        """Whether the pass is finished and its file readable."""
        return self._load(alpha) is not None

    def coefficients(self, alpha: float | None, *, step: Callable[[], None] = lambda: None) -> Coefficients:
        """Coefficients of one pass, from the cache or traced now.

        Parameters
        ----------
        alpha : float or None
            Roughness of a specular pass; None for the diffuse pass.
        step : callable, optional
            Called after each randomisation, for a progress display.
        """
        cached = self._load(alpha)
        if cached is not None:
            with contextlib.suppress(OSError):
                os.utime(self._path(alpha))  # used now: the cache drops what was used longest ago
            for _ in range(self.randomisations):
                step()
            return cached
        use_llvm()
        traced = average(self._exponents(alpha), self._randomisations(alpha, step))
        with whole_file(self._path(alpha)) as temporary, temporary.open("wb") as stream:
            np.savez(stream, mean=traced.mean, covariance=traced.covariance)
        return traced

    def _randomisations(self, alpha: float | None, step: Callable[[], None]) -> Iterator[NDArray[np.float32]]:
        on_sphere = sphere_pixels(self.scene)
        everywhere = np.ones_like(on_sphere)
        regions = (
            [(everywhere, self.diffuse_samples)]
            if alpha is None
            else [(on_sphere, self.sphere_samples), (~on_sphere, self.wall_samples)]
        )
        for index in range(self.randomisations):
            # Every α takes the same random numbers: noise that stimuli share does not tell them apart.
            seed = _child_seed(self.seed, "diffuse" if alpha is None else "specular", index)
            image = np.empty((len(self._exponents(alpha)), on_sphere.size), dtype=np.float32)
            for region, samples in regions:
                pixels = np.flatnonzero(region).astype(np.uint32)
                if pixels.size:
                    image[:, pixels] = trace_pass(self.scene, pixels, samples=samples, seed=seed, alpha=alpha)
            step()
            yield image

    def _exponents(self, alpha: float | None) -> tuple[tuple[int, int], ...]:
        return diffuse_exponents() if alpha is None else specular_exponents()

    def _path(self, alpha: float | None) -> Path:
        return self.cache / f"coefficients-{self.key(alpha)[:32]}.npz"

    def _load(self, alpha: float | None) -> Coefficients | None:
        exponents = self._exponents(alpha)
        terms = min(len(exponents), COVARIANCE_TERMS)
        try:
            # Opened here: numpy leaves a damaged file open.
            with self._path(alpha).open("rb") as stream, np.load(stream, allow_pickle=False) as stored:
                mean, covariance = stored["mean"], stored["covariance"]
        except (OSError, EOFError, KeyError, ValueError, zipfile.BadZipFile):
            return None  # absent or damaged: it is made again
        pixels = self.scene.film.width * self.scene.film.height
        if mean.shape != (len(exponents), pixels) or covariance.shape != (terms * (terms + 1) // 2, pixels):
            return None
        return Coefficients(exponents, mean, covariance)


def sphere_pixels(scene: Scene) -> NDArray[np.bool_]:
    """Pixels (shape (H W,), row-major) that the sphere's outline touches or fills; never one too few."""
    right, up, forward = (np.array(axis) for axis in scene.camera.axes())
    width, height = scene.film.width, scene.film.height
    half_width = math.tan(math.radians(scene.camera.field_of_view_deg) / 2)
    across = (2 * np.arange(width) + 1 - width) / width * half_width
    down = (2 * np.arange(height) + 1 - height) / width * half_width
    rays = forward + across[None, :, None] * right - down[:, None, None] * up
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    to_sphere = np.subtract(scene.sphere.center, scene.camera.position)
    distance = float(np.linalg.norm(to_sphere))
    angle = np.arccos(np.clip(rays @ (to_sphere / distance), -1, 1))
    # Half a pixel's diagonal is at most this angle, since tangent-plane lengths only shrink when seen from the eye.
    margin = math.sqrt(2) * half_width / width
    return (angle <= math.asin(scene.sphere.radius / distance) + margin).ravel()


def _child_seed(seed: int, purpose: str, index: int) -> int:
    digest = hashlib.sha256(f"{seed}/{purpose}/{index}".encode()).digest()
    return int.from_bytes(digest[:8], "little")
