"""The set renderer: from the name of a set to a folder of images with its manifest, resumable at every stimulus."""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from gloss_stimuli.cache import cache_folder, trim_cache
from gloss_stimuli.composite import write_composite
from gloss_stimuli.content_key import content_key
from gloss_stimuli.images import write_codes, write_luminance
from gloss_stimuli.measurements import FILE_NAME, find_patches, measure, write_measurements
from gloss_stimuli.method import Method, choose_renderer
from gloss_stimuli.mirrored_checks import PatchGeometry
from gloss_stimuli.renderer import Renderer, Rendering
from gloss_stimuli.scene import Film, Scene
from gloss_stimuli.scene_file import read_any_scene
from gloss_stimuli.set_manifest import set_manifest
from gloss_stimuli.sets import StimulusList, read_stimulus_list
from gloss_stimuli.target import DEFAULT_TARGET, ErrorTarget, find_target
from gloss_stimuli.tone import ToneCurve, solve_tone_curve
from gloss_stimuli.user_scene import UserScene
from glossspace.console import note, progress_bar
from glossspace.display import DisplayModel
from glossspace.errors import GlossError
from glossspace.files import check_folder_target, read_json, sha256_of, write_json
from glossspace.stimulus_set import MANIFEST_NAME, Stimulus, StimulusSet, read_stimulus_set, write_manifest

__all__ = ["check_rendering", "render_set", "tone_curve"]

LARGEST_SEED = 2**32 - 1


def render_set(
    source: str | Path,
    out: str | Path,
    *,
    size: str | int | None = None,
    quality: str = DEFAULT_TARGET,
    max_code_error: float | None = None,
    fraction: float | None = None,
    method: Method = "auto",
    samples_per_pixel: int | None = None,
    seed: int = 1,
    cache: str | Path | None = None,
    scene: str | Path | None = None,
) -> StimulusSet:
    """Render a stimulus set into a folder, or finish one that was interrupted.

    Parameters
    ----------
    source : str or path
        ``experiment1``, ``contrast``, ``contrast30``, ``doi``, or a CSV or TOML file: see
        `gloss_stimuli.sets.read_stimulus_list`.
    out : path
        The folder to fill: ``images/*.png``, ``luminance/*.exr``, ``manifest.json``, ``measurements.csv`` and
        ``composite.png``.
    size : int or str, optional
        Width and height in pixels, such as 512 or ``640x480``; even, so that a screen can center the image without
        resampling it. Default: the scene's film.
    quality : str, optional
        ``exact`` (half a code value on 99.9 % of the pixels) or ``draft`` (two on 99 %): names of two error targets.
    max_code_error, fraction : float, optional
        Another target: the error in 8-bit code values, and the share of the pixels of every image that stay within it.
    method : {"auto", "exact", "coefficients", "path"}, optional
        See `gloss_stimuli.method`.
    samples_per_pixel : int, optional
        For ``path`` alone: samples to take, whatever the error.
    seed : int, optional
        Same seed, same bits, whatever the number of threads.
    cache : path, optional
        Folder of what stimuli and sets share. Default: the user's cache folder; see `gloss_stimuli.cache`.
    scene : path, optional
        TOML file of the scene, or the name of a shipped one.

    Returns
    -------
    StimulusSet
        As read from `out`, with every hash verified.

    Raises
    ------
    GlossError
        The set, the scene, the size, the target, the method or the seed is not valid, or a renderer lacks what it
        needs.

    Examples
    --------
    >>> stimuli = render_set("experiment1", "stimuli/experiment1", size=256)  # doctest: +SKIP
    """
    out = Path(out)
    check_rendering(out, size=size, seed=seed)
    wanted = read_stimulus_list(source)
    resolved = read_any_scene(scene)
    if size is not None:
        resolved = resolved.with_film(Film.parse(size))
    target = find_target(quality, max_code_error=max_code_error, fraction=fraction)
    tone, display = tone_curve(resolved), resolved.display.model()
    folder = cache_folder(cache, out=out)
    renderer, reason = choose_renderer(
        resolved, method=method, target=target, tone=tone, display=display, seed=seed, cache=folder,
        samples_per_pixel=samples_per_pixel,
    )  # fmt: skip
    job = _Job(resolved, renderer, reason, target, tone, display, out)
    finished = _render_missing(job, wanted)
    write_measurements(out / FILE_NAME, [finished[stimulus.name]["measurements"] for stimulus in wanted.stimuli])
    entries = [finished[stimulus.name]["entry"] for stimulus in wanted.stimuli]
    manifest = set_manifest(
        wanted, resolved, entries, renderer=renderer, reason=reason, target=target, tone=tone, display=display,
        patches=job.patches, measurements_sha256=sha256_of(out / FILE_NAME),
    )  # fmt: skip
    write_manifest(out, manifest)
    rendered = read_stimulus_set(out)
    write_composite(rendered, out / "composite.png")
    trim_cache(folder)
    _say_error(job, wanted, entries)
    return rendered


def check_rendering(out: str | Path, *, size: str | int | None, seed: int) -> None:
    """Refuse, before anything is done, what `render_set` would refuse.

    Raises
    ------
    GlossError
        The folder cannot be written to, or the size or the seed is not allowed.
    """
    if size is not None:
        Film.parse(size)
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed <= LARGEST_SEED:
        raise GlossError(f"The seed must be a whole number from 0 to {LARGEST_SEED}, but is {seed}.")
    if Path(out).is_file():
        raise GlossError(f"Cannot render into '{out}': it is a file. Give a folder.")
    check_folder_target(out)
    try:
        str(out).encode()
    except UnicodeEncodeError:
        raise GlossError(f"Cannot render into {str(out)!r}: its name is not valid in UTF-8. Choose another.") from None


def tone_curve(scene: Scene | UserScene) -> ToneCurve:
    """The scene's tone curve: one for every stimulus, so that they stay comparable."""
    tone = scene.tone
    return solve_tone_curve(
        adapting=tone.adapting_luminance_cd_m2,
        minimum=tone.minimum_luminance_cd_m2,
        maximum=tone.maximum_luminance_cd_m2,
        slope=tone.slope,
        contrast=scene.display.model().contrast,
    )


@dataclass(frozen=True)
class _Job:
    """What the stimuli of one rendering share."""

    scene: Scene | UserScene
    renderer: Renderer
    reason: str
    target: ErrorTarget
    tone: ToneCurve
    display: DisplayModel
    out: Path

    @property
    def patches(self) -> PatchGeometry | None:
        """Where the picture is measured; a scene of the user's own has no checks to measure."""
        return find_patches(self.scene) if isinstance(self.scene, Scene) else None

    def key(self, stimulus: Stimulus) -> str:
        """Hash of everything that determines the files of a stimulus."""
        return content_key(
            "tone", "glossspace.display", "glossspace.luminance_table", "images", "code_error", "render",
            "measurements", "mirrored_checks", "mirror", "edge_width",
            luminance=self.renderer.key(stimulus), target=self.target.to_dict(), stimulus=asdict(stimulus),
            tone=self.tone.to_dict(), display=self.display.to_dict(), viewing=self.scene.viewing.model_dump(),
        )  # fmt: skip

    def record_path(self, stimulus: Stimulus) -> Path:
        return self.out / "finished" / f"{stimulus.name}.json"

    def finished(self, stimulus: Stimulus) -> dict[str, Any] | None:
        """Manifest entry and measurements of a stimulus whose files are there and up to date, else None."""
        path = self.record_path(stimulus)
        if not path.is_file():
            return None
        try:
            record = read_json(path, what="record of a finished stimulus")
            entry, seal = record["entry"], content_key(entry=record["entry"], measurements=record["measurements"])
            if (record["key"], record["seal"]) != (self.key(stimulus), seal):
                return None
            hashes = {kind: sha256_of(self.out / entry[kind]) for kind in entry["sha256"]}
        except (GlossError, KeyError, TypeError, ValueError, OSError):
            return None  # damaged or incomplete: it is made again
        return record if hashes == entry["sha256"] else None


def _render_missing(job: _Job, wanted: StimulusList) -> dict[str, dict[str, Any]]:
    finished = {stimulus.name: job.finished(stimulus) for stimulus in wanted.stimuli}
    missing = [stimulus for stimulus in wanted.stimuli if finished[stimulus.name] is None]
    if missing:
        patches = job.patches
        with progress_bar() as progress:
            total = job.renderer.steps(missing)
            task = progress.add_task(f"Rendering {wanted.name} ({job.renderer.method})", total=total)

            def step(*, more: int = 0) -> None:
                nonlocal total
                total += more
                progress.update(task, advance=1, total=total)

            for rendering in job.renderer.render(missing, step=step):
                # An image is about to differ from what an older manifest says of it.
                (job.out / MANIFEST_NAME).unlink(missing_ok=True)
                finished[rendering.stimulus.name] = _write_stimulus(job, rendering, patches)
    return {name: record for name, record in finished.items() if record is not None}


def _write_stimulus(job: _Job, rendering: Rendering, patches: PatchGeometry | None) -> dict[str, Any]:
    stimulus = rendering.stimulus
    # What is displayed is what the float32 file holds, so that the one can be checked against the other.
    luminance = rendering.luminance.astype(np.float32).astype(np.float64)
    files = {"image": f"images/{stimulus.name}.png", "luminance": f"luminance/{stimulus.name}.exr"}
    write_luminance(job.out / files["luminance"], luminance)
    shown = job.display.white_cd_m2 * job.tone(luminance)
    write_codes(job.out / files["image"], job.display.codes(shown, bits=8))
    if job.display.bits > 8:
        files["image_high_bit"] = f"images-{job.display.bits}-bit/{stimulus.name}.png"
        write_codes(job.out / files["image_high_bit"], job.display.codes(shown))
    entry = {
        "name": stimulus.name,
        "rho_d": stimulus.rho_d,
        "rho_s": stimulus.rho_s,
        "alpha": stimulus.alpha,
        "c": stimulus.c,
        "d": stimulus.d,
        "lightness": stimulus.lightness,
        **files,
        "sha256": {kind: sha256_of(job.out / file) for kind, file in files.items()},
        "error_estimate": {
            **rendering.error.to_dict(),
            "fraction_within_target": float(f"{rendering.error.within(job.target.max_code_error):.6f}"),
            "reached_target": job.target.is_reached(rendering.error),
        },
        "rendering": rendering.details,
        "clipped_pixels": job.tone.clipped(luminance),
    }
    measurements = measure(
        patches, stimulus, luminance, rendering.white_luminance, tone=job.tone, display=job.display
    )  # fmt: skip
    seal = content_key(entry=entry, measurements=measurements)
    record = {"key": job.key(stimulus), "seal": seal, "entry": entry, "measurements": measurements}
    # Last, since this record is what says that the stimulus is finished.
    write_json(job.record_path(stimulus), record)
    return record


def _say_error(job: _Job, wanted: StimulusList, entries: list[dict[str, Any]]) -> None:
    """Tell the person at the terminal the method, the error that was reached, and whether it is short of the target."""
    worst = max(entries, key=lambda entry: entry["error_estimate"]["percentile_99_9"])
    error, target = worst["error_estimate"], job.target
    goal = f"{target.max_code_error:g} code values on {100 * target.fraction:g} % of the pixels"
    short = [entry["name"] for entry in entries if not entry["error_estimate"]["reached_target"]]
    verdict = f"The target, {goal}, is reached."
    if short:
        more = f" and {len(short) - 3} more" if len(short) > 3 else ""
        verdict = f"Short of the target, {goal}: {', '.join(short[:3])}{more}."
    counted = "1 stimulus" if len(entries) == 1 else f"{len(entries)} stimuli"
    note(
        f"{wanted.name}: {counted} by the method '{job.renderer.method}' ({job.reason}). Estimated error of the "
        f"worst image ({worst['name']}): {error['median']:.2g} code values in the median, "
        f"{error['percentile_99_9']:.2g} at 99.9 % of its pixels. {verdict}"
    )
    clipped = sum(entry["clipped_pixels"] for entry in entries)
    if clipped:
        note(f"{wanted.name}: {clipped} pixels lie outside the tone curve's range and are clipped; see the manifest.")
