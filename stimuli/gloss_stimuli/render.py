"""The set renderer: from the name of a set to a folder of images with its manifest, resumable at every stimulus."""

import shutil
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from gloss_stimuli.code_error import CodeError, code_error
from gloss_stimuli.composite import write_composite
from gloss_stimuli.display import DisplayModel
from gloss_stimuli.images import write_codes, write_luminance
from gloss_stimuli.passes import METHOD, PassPlan, content_key
from gloss_stimuli.quality import find_quality
from gloss_stimuli.scene import Scene, read_scene
from gloss_stimuli.sets import StimulusList, read_stimulus_list
from gloss_stimuli.tone import ToneCurve, solve_tone_curve
from glossspace.console import note, progress_bar
from glossspace.errors import GlossError
from glossspace.files import check_folder_target, read_json, sha256_of, write_json
from glossspace.stimulus_set import MANIFEST_NAME, Stimulus, StimulusSet, read_stimulus_set, write_manifest

__all__ = ["check_rendering", "display_model", "render_set", "tone_curve"]

# The error a rendering aims at, in code values, on this share of the pixels of every image.
TARGET_CODE_ERROR = 0.5
TARGET_FRACTION = 0.999

SMALLEST_SIZE, LARGEST_SIZE = 2, 4096
LARGEST_SEED = 2**32 - 1


def render_set(
    source: str | Path,
    out: str | Path,
    *,
    size: int = 512,
    quality: str = "draft",
    seed: int = 1,
    cache: str | Path | None = None,
    scene: str | Path | None = None,
) -> StimulusSet:
    """Render a stimulus set into a folder, or finish one that was interrupted.

    Parameters
    ----------
    source : str or path
        ``experiment1``, ``contrast``, ``doi``, or a CSV or TOML file: see `gloss_stimuli.sets.read_stimulus_list`.
    out : path
        The folder to fill: ``images/*.png``, ``luminance/*.exr``, ``manifest.json`` and ``composite.png``.
    size : int, optional
        Width and height in pixels; even, so that a screen can center the image without resampling it.
    quality : str, optional
        ``draft`` or ``exact``.
    seed : int, optional
        Same seed, same bits, whatever the number of threads.
    cache : path, optional
        Folder of coefficient passes, to be shared between sets. Without one they live in `out` until the set is done.
    scene : path, optional
        TOML file of the scene, or the name of a shipped one.

    Returns
    -------
    StimulusSet
        As read from `out`, with every hash verified.

    Raises
    ------
    GlossError
        The set, the scene, the size, the quality or the seed is not valid, or no usable LLVM was found.

    Examples
    --------
    >>> stimuli = render_set("experiment1", "stimuli/experiment1", size=256)  # doctest: +SKIP
    """
    out = Path(out)
    check_rendering(out, size=size, seed=seed)
    if cache is not None:
        check_folder_target(cache)
    wanted = read_stimulus_list(source)
    resolved = read_scene(scene)
    own_cache = out / ".coefficients"
    plan = PassPlan(
        scene=resolved,
        size=size,
        quality=find_quality(quality),
        seed=seed,
        cache=own_cache if cache is None else Path(cache),
    )
    job = _Job(plan, out, tone_curve(resolved), display_model(resolved))
    entries = _render_missing(job, wanted)
    write_manifest(out, _manifest(job, wanted, entries))
    rendered = read_stimulus_set(out)
    write_composite(rendered, out / "composite.png")
    if cache is None:
        shutil.rmtree(own_cache, ignore_errors=True)
    _say_error(wanted, entries)
    return rendered


def check_rendering(out: str | Path, *, size: int, seed: int) -> None:
    """Refuse, before anything is done, what `render_set` would refuse.

    Raises
    ------
    GlossError
        The folder cannot be written to, or the size or the seed is not allowed.
    """
    if isinstance(size, bool) or not isinstance(size, int) or not SMALLEST_SIZE <= size <= LARGEST_SIZE or size % 2:
        raise GlossError(f"The size must be an even number from {SMALLEST_SIZE} to {LARGEST_SIZE}, but is {size}.")
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed <= LARGEST_SEED:
        raise GlossError(f"The seed must be a whole number from 0 to {LARGEST_SEED}, but is {seed}.")
    if Path(out).is_file():
        raise GlossError(f"Cannot render into '{out}': it is a file. Give a folder.")
    check_folder_target(out)


def tone_curve(scene: Scene) -> ToneCurve:
    """The scene's tone curve: one for every stimulus, so that they stay comparable."""
    tone = scene.tone
    return solve_tone_curve(
        adapting=tone.adapting_luminance_cd_m2,
        minimum=tone.minimum_luminance_cd_m2,
        maximum=tone.maximum_luminance_cd_m2,
        slope=tone.slope,
        contrast=display_model(scene).contrast,
    )


def display_model(scene: Scene) -> DisplayModel:
    """The display that the scene file describes."""
    display = scene.display
    return DisplayModel(black_cd_m2=display.black_cd_m2, white_cd_m2=display.white_cd_m2, gamma=display.gamma)


@dataclass(frozen=True)
class _Job:
    """What the stimuli of one rendering share."""

    plan: PassPlan
    out: Path
    tone: ToneCurve
    display: DisplayModel

    def passes(self, stimulus: Stimulus) -> tuple[float | None, ...]:
        """The passes a stimulus is made of; without a specular term its α is not seen."""
        return (None, stimulus.alpha) if stimulus.rho_s > 0 else (None,)

    def key(self, stimulus: Stimulus) -> str:
        """Hash of everything that determines the files of a stimulus."""
        return content_key(
            "tone", "display", "images", "code_error", "render",
            passes=[self.plan.key(alpha) for alpha in self.passes(stimulus)],
            stimulus=asdict(stimulus), tone=self.tone.to_dict(), display=self.display.to_dict(),
        )  # fmt: skip

    def record_path(self, stimulus: Stimulus) -> Path:
        return self.out / "finished" / f"{stimulus.name}.json"

    def finished_entry(self, stimulus: Stimulus) -> dict[str, Any] | None:
        """Manifest entry of a stimulus whose files are there and up to date, else None."""
        path = self.record_path(stimulus)
        if not path.is_file():
            return None
        try:
            record = read_json(path, what="record of a finished stimulus")
            entry: dict[str, Any] = record["entry"]
            if record["key"] != self.key(stimulus):
                return None
            hashes = {kind: sha256_of(self.out / entry[kind]) for kind in ("image", "luminance")}
        except (GlossError, KeyError, OSError):
            return None  # damaged or incomplete: it is made again
        return entry if hashes == entry["sha256"] else None


def _render_missing(job: _Job, wanted: StimulusList) -> list[dict[str, Any]]:
    finished = {stimulus.name: job.finished_entry(stimulus) for stimulus in wanted.stimuli}
    missing = [stimulus for stimulus in wanted.stimuli if finished[stimulus.name] is None]
    if missing:
        # The images are about to differ from what an older manifest says of them.
        (job.out / MANIFEST_NAME).unlink(missing_ok=True)
        alphas = sorted({stimulus.alpha for stimulus in missing if stimulus.rho_s > 0})
        with progress_bar() as progress:
            steps = job.plan.quality.randomisations * (1 + len(alphas)) + len(missing)
            task = progress.add_task(f"Rendering {wanted.name}", total=steps)

            def step() -> None:
                progress.advance(task)

            diffuse = job.plan.coefficients(None, step=step)
            # Ordered by α, so that memory holds the coefficients of one at a time.
            for alpha in [None, *alphas]:
                specular = None if alpha is None else job.plan.coefficients(alpha, step=step)
                for stimulus in missing:
                    if job.passes(stimulus)[-1] == alpha:
                        passes = [diffuse] if specular is None else [diffuse, specular]
                        finished[stimulus.name] = _render_stimulus(job, stimulus, passes)
                        step()
    return [entry for entry in finished.values() if entry is not None]


def _render_stimulus(job: _Job, stimulus: Stimulus, passes: list[Any]) -> dict[str, Any]:
    shape = (job.plan.size, job.plan.size)
    luminance = sum(part.luminance(stimulus.rho_d, stimulus.rho_s) for part in passes).reshape(shape)
    # The passes draw independent numbers, so their variances add.
    variance = sum(part.variance(stimulus.rho_d, stimulus.rho_s) for part in passes).reshape(shape)
    image, exr = f"images/{stimulus.name}.png", f"luminance/{stimulus.name}.exr"
    # What is displayed is what the float32 file holds, so that the one can be checked against the other.
    luminance = luminance.astype(np.float32).astype(np.float64)
    write_luminance(job.out / exr, luminance)
    write_codes(job.out / image, job.display.codes(job.display.white_cd_m2 * job.tone(luminance)))
    error = code_error(luminance, variance, tone=job.tone, display=job.display)
    entry = {
        "name": stimulus.name,
        "rho_d": stimulus.rho_d,
        "rho_s": stimulus.rho_s,
        "alpha": stimulus.alpha,
        "c": stimulus.c,
        "d": stimulus.d,
        "lightness": stimulus.lightness,
        "image": image,
        "luminance": exr,
        "sha256": {"image": sha256_of(job.out / image), "luminance": sha256_of(job.out / exr)},
        "error_estimate": {**error.to_dict(), "reached_target": _reaches_target(error)},
        "clipped_pixels": job.tone.clipped(luminance),
    }
    # Last, since this record is what says that the stimulus is finished.
    write_json(job.record_path(stimulus), {"key": job.key(stimulus), "entry": entry})
    return entry


def _reaches_target(error: CodeError) -> bool:
    return error.percentile_99_9 <= TARGET_CODE_ERROR


def _manifest(job: _Job, wanted: StimulusList, entries: list[dict[str, Any]]) -> dict[str, Any]:
    scene, plan = job.plan.scene, job.plan
    quality = asdict(plan.quality)
    return {
        "name": wanted.name,
        "title": wanted.title,
        "image": {"width": plan.size, "height": plan.size, "bits": 8, "encoding": "display code values"},
        "luminance": {"unit": "cd/m2", "channel": "Y", "type": "float32", "relation": "linear, of the scene"},
        "viewing": {
            "distance_cm": scene.viewing.distance_cm,
            "image_width_deg": scene.viewing.image_width_deg,
            "image_width_cm": scene.viewing.image_width_cm,
        },
        "display": job.display.to_dict(),
        "tone_curve": job.tone.to_dict(),
        "rendering": {
            "method": METHOD,
            "quality": quality.pop("name"),
            "seed": plan.seed,
            **quality,
            "samples_per_pixel": {
                name.removesuffix("_samples"): count * plan.quality.randomisations
                for name, count in quality.items()
                if name.endswith("_samples")
            },
            "target": {"code_error": TARGET_CODE_ERROR, "fraction": TARGET_FRACTION},
            "error_unit": "8-bit code values before rounding, estimated from the scatter of the randomisations",
        },
        "scene": scene.model_dump(mode="json"),
        "software": {name: version(name) for name in ("glossspace", "mitsuba", "drjit", "numpy", "OpenEXR", "pillow")},
        "stimuli": entries,
    }


def _say_error(wanted: StimulusList, entries: list[dict[str, Any]]) -> None:
    """Tell the person at the terminal which error was reached, and that it is short of the target if it is."""
    worst = max(entries, key=lambda entry: entry["error_estimate"]["percentile_99_9"])
    error = worst["error_estimate"]
    verdict = (
        "the target of half a code value is reached"
        if error["reached_target"]
        else "short of the target of half a code value on 99.9 %"
    )
    note(
        f"{wanted.name}: {len(entries)} stimuli by {METHOD}. Estimated error of the worst image ({worst['name']}): "
        f"{error['median']:.2f} code values in the median, {error['percentile_99_9']:.2f} at 99.9 % of its pixels; "
        f"{verdict}."
    )
    clipped = sum(entry["clipped_pixels"] for entry in entries)
    if clipped:
        note(f"{wanted.name}: {clipped} pixels lie outside the tone curve's range and are clipped; see the manifest.")
