"""The gloss paper's whole study: stimuli, sessions of simulated observers, analysis, report."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np

from gloss_analysis.report import write_report
from gloss_analysis.study.analysis import StudyAnalysis, analyse_study
from gloss_analysis.study.folder import (
    STIMULUS_SETS,
    dataset_folder,
    gloss_space_file,
    read_study,
    report_file,
    stimulus_folder,
)
from gloss_experiments import run_session, simulated_observers
from gloss_stimuli import check_rendering, render_isogloss_ring, render_matched_spheres, render_set
from glossspace.errors import GlossError
from glossspace.files import read_json, write_json

__all__ = ["Quality", "Reproduction", "reproduce_study"]

Quality: TypeAlias = Literal["draft", "exact"]

N_OBSERVERS = 9
"""As many as took part in the gloss paper's experiments."""

RING_POINTS = 4
"""Spheres on each contour of the isogloss ring: four need four roughnesses that no other set has, eight need eight."""

_FORMAT, _VERSION = "glossspace/study", 1

# Which stimulus set each session shows.
_SESSIONS = {"pairwise": "experiment1", "contrast": "contrast", "doi": "doi"}


@dataclass(frozen=True)
class Reproduction:
    """What a reproduction made, and where.

    Attributes
    ----------
    report, gloss_space, dataset : Path
    analysis : StudyAnalysis
    """

    report: Path
    gloss_space: Path
    dataset: Path
    analysis: StudyAnalysis


def reproduce_study(
    study: Path,
    *,
    quality: Quality = "exact",
    size: int = 512,
    seed: int = 1,
    n_jobs: int = 1,
    on_step: Callable[[str], None] = lambda step: None,
) -> Reproduction:
    """Run the gloss paper's study with nine simulated observers, from reflectance to a fitted gloss space.

    Run again after an interruption, it goes on where it was: finished stimuli and sessions are not made again. The
    fitted space is applied as in section 5 of the gloss paper: `stimuli/ring` and `stimuli/matched` hold the spheres of
    its figures 11 and 12, and the figures. They are made again if the space is another.

    Parameters
    ----------
    study : Path
        The folder to fill; see `gloss_analysis.study.folder` for its layout.
    quality : {"draft", "exact"}
        Error target of the images; see `gloss_stimuli.render_set`.
    size : int
        Width and height of the images in pixels, even.
    seed : int
        Of images, observers, sessions and random starts.
    n_jobs : int
        Processes for the analysis; the result does not depend on it.
    on_step : callable
        Called with a few words before each part, to show progress.

    Returns
    -------
    Reproduction

    Raises
    ------
    GlossError
        A setting is not allowed; the folder holds a study with other settings, or anybody's data; a part is broken.
    """
    check_rendering(study, size=size, seed=seed)  # first, since a claim with settings that cannot be would stay
    _claim(study, {"quality": quality, "size": size, "seed": seed})
    image_seed, observer_seed, session_seed = (
        int(child.generate_state(1)[0]) for child in np.random.SeedSequence(seed).spawn(3)
    )

    # Sets with a roughness in common share its solution; it lies here so that the study can be finished elsewhere.
    cache = study / "stimuli" / "coefficients"
    for name in STIMULUS_SETS:
        on_step(f"Stimuli: {name}")
        render_set(name, stimulus_folder(study, name), size=size, quality=quality, seed=image_seed, cache=cache)

    observers = simulated_observers(N_OBSERVERS, observer_seed)
    seeds = np.random.SeedSequence(session_seed).generate_state(N_OBSERVERS * len(_SESSIONS)).reshape(N_OBSERVERS, -1)
    on_step(f"Sessions: {N_OBSERVERS} simulated observers")
    for number, (observer, own_seeds) in enumerate(zip(observers, seeds, strict=True), start=1):
        for (protocol, stimuli), one_seed in zip(_SESSIONS.items(), own_seeds, strict=True):
            run_session(
                protocol,
                stimuli=stimulus_folder(study, stimuli),
                dataset=dataset_folder(study),
                participant=f"{number:02d}",
                session="1",
                mode="headless",
                seed=int(one_seed),
                observer=observer,
            )

    analysis = analyse_study(read_study(study), seed=seed, n_jobs=n_jobs, on_step=on_step)
    space = analysis.fit.space
    space.save(gloss_space_file(study))
    on_step("The fitted space applied: an isogloss ring, matched spheres")
    rendering: dict[str, Any] = {"size": size, "quality": quality, "seed": image_seed, "cache": cache}
    render_isogloss_ring(stimulus_folder(study, "ring"), space=space, n=RING_POINTS, **rendering)
    render_matched_spheres(stimulus_folder(study, "matched"), space=space, **rendering)
    on_step("Report")
    write_report(analysis, report_file(study))
    return Reproduction(report_file(study), gloss_space_file(study), dataset_folder(study), analysis)


def _claim(study: Path, settings: dict[str, object]) -> None:
    """Note the settings of a new study; refuse to mix them with those of an old one."""
    path = study / "study.json"
    if not path.exists():
        for folder in (study / "stimuli", dataset_folder(study)):
            if folder.exists():  # perhaps the answers of people: no place for simulated ones
                raise GlossError(f"'{study}' holds '{folder.name}', but no study of this command. Use another --out.")
        write_json(path, {"format": _FORMAT, "version": _VERSION, **settings})
        return
    known = read_json(path, what="study description")
    if (known.get("format"), known.get("version")) != (_FORMAT, _VERSION):
        raise GlossError(
            f"'{path}' has format {known.get('format')!r}, version {known.get('version')!r}; this version reads "
            f"{_FORMAT!r}, version {_VERSION}. Use another --out, or the glossspace that wrote it."
        )
    differing = [
        f"{key} {known.get(key)!r} instead of {value!r}" for key, value in settings.items() if known.get(key) != value
    ]
    if differing:
        raise GlossError(
            f"'{study}' holds a study made with {', '.join(differing)}. Use another --out, or its settings."
        )
