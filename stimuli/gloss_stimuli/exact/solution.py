"""One solution of a scene: from its fields to the coefficients of every pixel, at one level of fineness, for one seed.

Luminance is the polynomial ``Σ C_ij ρd^i ρs^j`` of the paint. A wall pixel's coefficients are the fields themselves
times the check's ρ/π. A sphere pixel adds one more meeting: ρd/π times the irradiance there, and ρs times the mirrored
room.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.exact.camera import Camera, build_camera, outline_radius_pixels
from gloss_stimuli.exact.fields import Fields, FieldSolver
from gloss_stimuli.exact.film import FilmMap, map_film, sphere_irradiance
from gloss_stimuli.exact.levels import Level
from gloss_stimuli.exact.lobe_light import light_in_pixels
from gloss_stimuli.exact.lobe_pixels import radiance_of_pixels
from gloss_stimuli.exact.lobe_table import look_up, make_table, table_points
from gloss_stimuli.exact.room import Room, build_room
from gloss_stimuli.exact.textures import patch_texture, refined, sphere_texture, wall_texture
from gloss_stimuli.scene import Scene

__all__ = ["DIFFUSE_EXPONENTS", "SPECULAR_EXPONENTS", "solve"]

DIFFUSE_EXPONENTS = ((0, 0), (1, 0), (2, 0), (3, 0), (4, 0))
SPECULAR_EXPONENTS = ((0, 1), (1, 1), (0, 2), (2, 1), (1, 2), (0, 3))

# A lobe wider than this part of the normal's turn across a pixel leaves the light's image smooth between samples.
SMOOTH_LIGHT = 0.5
# Smaller films are solved on one this wide or high, and averaged: many edges may run through one of their pixels.
SMALLEST_FILM = 384
# Wall textures are splined to this many times their texels before pixels look them up linearly.
REFINEMENT = 3
# Pixels mapped, and roughnesses solved, at once: they bound memory.
BAND_PIXELS = 1 << 18
BATCH = 12


def solve(
    scene: Scene,
    level: Level,
    seed: Sequence[int],
    alphas: Sequence[float],
    *,
    step: Callable[[], None] = lambda: None,
) -> Iterator[tuple[float | None, NDArray[np.float32]]]:
    """Solve a scene once; give the coefficients of its pixels, one roughness after the other.

    Parameters
    ----------
    scene : Scene
    level : Level
        How finely.
    seed : sequence of int
        Of everything drawn at random.
    alphas : sequence of float
        Roughnesses. Each comes out the same alone and in company.
    step : callable, optional
        Called after the fields, and after each roughness.

    Yields
    ------
    tuple of (float or None, array of float32)
        None and the coefficients of `DIFFUSE_EXPONENTS`, shape (5, P), first; then each α and those of
        `SPECULAR_EXPONENTS`, shape (6, P).
    """
    fields_seed, lobe_seed = np.random.SeedSequence(list(seed)).spawn(2)
    finer = -(-SMALLEST_FILM // max(scene.film.width, scene.film.height))
    camera = build_camera(scene)
    camera = camera._replace(width=finer * camera.width, height=finer * camera.height)
    room = build_room(scene, width_over_gap=level.width_over_gap)
    solver = FieldSolver(room, level, fields_seed, scene.sphere.lobe)
    diffuse = solver.diffuse
    films = _map_films(room, camera, level)
    view = _View(room, camera, level, solver, films, scene.sphere.lobe, lobe_seed)
    batches = [alphas[start : start + BATCH] for start in range(0, len(alphas), BATCH)] or [[]]
    for number, batch in enumerate(batches):
        specular = [solver.specular(alpha) for alpha in batch]
        # Where a texture's light comes from costs far more to find than to add up, so all fields go together.
        columns = np.hstack([diffuse.walls, *(field.walls for field in specular)])
        textures = wall_texture(room, solver.nodes, level, columns, solver.light_at_nodes)
        own = textures[..., : diffuse.walls.shape[1]]
        if number == 0:
            yield None, _averaged(view.diffuse(diffuse, own), scene, finer)
        step()
        patches = patch_texture(room, own[..., :3], level.patch_texels)  # of higher order nothing is seen in the sphere
        first = diffuse.walls.shape[1]
        for index, (alpha, field) in enumerate(zip(batch, specular, strict=True)):
            image = view.specular(alpha, field, patches, textures[..., first + 3 * index :][..., :3])
            yield alpha, _averaged(image, scene, finer)
            step()


def _map_films(room: Room, camera: Camera, level: Level) -> list[tuple[NDArray[np.int64], FilmMap]]:
    films = []
    count = camera.width * camera.height
    for start in range(0, count, BAND_PIXELS):
        pixels = np.arange(start, min(start + BAND_PIXELS, count))
        films.append((pixels, _mapped(room, camera, level, pixels)))
    return films


def _mapped(room: Room, camera: Camera, level: Level, pixels: NDArray[np.int64]) -> FilmMap:
    return map_film(
        room, camera, pixels, texels=REFINEMENT * level.texels, lines=level.lines, wall_side=level.wall_side,
        sphere_side=level.sphere_side,
    )  # fmt: skip


@dataclass(frozen=True)
class _View:
    """What the pixels of one solution need."""

    room: Room
    camera: Camera
    level: Level
    solver: FieldSolver
    films: list[tuple[NDArray[np.int64], FilmMap]]
    form: str
    lobe_seed: np.random.SeedSequence

    def diffuse(self, fields: Fields, texture: NDArray[np.float64]) -> NDArray[np.float32]:
        """Coefficients of `DIFFUSE_EXPONENTS`; the last wall field goes on as a geometric series."""
        on_sphere = sphere_texture(self.room, self.solver.nodes, self.level, fields.walls, with_light=True)
        q = fields.returned
        rows = []
        for _, film in self.films:
            walls = _looked_up(film, texture)
            walls[0] += film.light * self.room.box.light_luminance
            sphere = sphere_irradiance(self.camera, film, on_sphere).T / np.pi
            rows.append(
                [
                    walls[0],
                    walls[1] + sphere[0],
                    walls[2] + sphere[1],
                    walls[3] + sphere[2],
                    q * walls[3] + sphere[3],
                ]
            )
        return _image(rows)

    def specular(
        self, alpha: float, fields: Fields, patches: NDArray[np.float64], texture: NDArray[np.float64]
    ) -> NDArray[np.float32]:
        """Coefficients of `SPECULAR_EXPONENTS`; the last wall fields go on as geometric series.

        Of two meetings of two kinds there are two orders, of three there are three: hence 3/2.
        """
        room, camera, level = self.room, self.camera, self.level
        own = patch_texture(room, texture, level.patch_texels)
        mirrored = self._mirrored(alpha, np.concatenate([patches, own], axis=3).astype(np.float32))
        on_sphere = sphere_texture(room, self.solver.nodes, level, fields.walls, with_light=False)
        q_d, q_s = self.solver.diffuse.returned, fields.returned
        rows = []
        for (_, film), radiance in zip(self.films, mirrored, strict=True):
            walls = _looked_up(film, texture)
            sphere = sphere_irradiance(camera, film, on_sphere).T / np.pi
            s00, s10, s20, s01, s11, s02 = radiance.T
            rows.append(
                [
                    walls[0] + s00,
                    walls[1] + sphere[0] + s10,
                    walls[2] + s01,
                    1.5 * q_d * walls[1] + sphere[1] + s20,
                    1.5 * q_s * walls[1] + sphere[2] + s11,
                    q_s * walls[2] + s02,
                ]
            )
        return _image(rows)

    def _mirrored(self, alpha: float, patches: NDArray[np.float32]) -> Iterator[NDArray[np.float64]]:
        """Radiance of the mirrored room in the pixels of each map: from a table, or pixel by pixel if that is less."""
        room, camera, level = self.room, self.camera, self.level
        outline = outline_radius_pixels(camera)
        lobe: dict[str, Any] = {"alpha": alpha, "form": self.form}
        rng = np.random.default_rng(self.lobe_seed)
        disc = min(np.pi * outline**2, camera.width * camera.height)
        if table_points(alpha, level.table_spacing) * level.table_samples <= disc * level.pixel_samples:
            table = make_table(
                room, camera, patches, rng, spacing=level.table_spacing, samples=level.table_samples,
                light_points=level.light_points, **lobe,
            )  # fmt: skip
            for _, film in self.films:
                yield look_up(table, film.sphere_start, film.x, film.y, film.weight)
            return
        smooth = alpha * outline >= SMOOTH_LIGHT
        for pixels, film in self.films:
            seen = (film.sphere_start, film.x, film.y, film.weight)
            radiance = radiance_of_pixels(
                room, camera, pixels, *seen, patches, rng, samples=level.pixel_samples, with_light=not smooth, **lobe
            )
            if smooth:
                radiance[:, 0] += light_in_pixels(room, camera, *seen, points=level.light_points, **lobe)
            yield radiance


def _averaged(image: NDArray[np.float32], scene: Scene, finer: int) -> NDArray[np.float32]:
    """Coefficients on the scene's own film, shape (M, P), from one that is `finer` times as wide and high."""
    if finer == 1:
        return image
    film = scene.film
    blocks = image.reshape(len(image), film.height, finer, film.width, finer)
    averaged: NDArray[np.float32] = blocks.mean(axis=(2, 4), dtype=np.float64).astype(np.float32)
    return averaged.reshape(len(image), -1)


def _looked_up(film: FilmMap, texture: NDArray[np.float64]) -> NDArray[np.float64]:
    """Luminance of the walls in each pixel, shape (K, P), from their irradiance at the texels."""
    fine = refined(texture, REFINEMENT)
    found: NDArray[np.float64] = (film.walls @ fine.reshape(-1, fine.shape[-1])).T
    return found


def _image(bands: list[list[NDArray[np.float64]]]) -> NDArray[np.float32]:
    image = np.hstack([np.stack(rows) for rows in bands]).astype(np.float32)
    if not np.isfinite(image).all():
        raise FloatingPointError(f"The exact renderer made {np.count_nonzero(~np.isfinite(image))} values not finite.")
    return image
