"""A small study on disk: stimulus sets with manifests and tiny images, and a dataset, without rendering or sessions."""

import itertools
from pathlib import Path

import numpy as np
from PIL import Image

from glossspace.dataset import record_simulated_observer, write_session_data
from glossspace.files import sha256_of
from glossspace.stimulus_set import Stimulus, write_manifest

__all__ = ["SETS", "make_study"]

SETS = {
    "experiment1": list(itertools.product((0.03, 0.767), (0.033, 0.099), (0.04, 0.07, 0.10))),
    "contrast": list(itertools.product((0.03, 0.193, 0.767), (0.033, 0.099), (0.04,))),
    "doi": [(0.03, 0.099, alpha) for alpha in (0.01, 0.04, 0.07, 0.10, 0.15)],
}
"""Paints of the three sets, fewer than the gloss paper's."""


def make_study(
    folder: Path, ratios: list[float], *, observer: str = "simulated", measured: bool = True, errors: bool = True
) -> Path:
    """Write a study whose participants judge by sqrt(dc^2 + (ratio dd)^2) with noise, one a ratio.

    Ratings are linear in c and in d, with noise; what is measured in the images is linear in c, c squared and d.
    """
    rng = np.random.default_rng(7)
    for name, paints in SETS.items():
        _make_set(folder / "stimuli" / name, name, [Stimulus.of(*paint) for paint in paints], measured, errors)
    for k, ratio in enumerate(ratios, start=1):
        who = {"participant": f"{k:02d}", "session": "1", "observer": observer}
        stimuli = [Stimulus.of(*paint) for paint in SETS["experiment1"]]
        judged = []
        for a, b in [*itertools.combinations(stimuli, 2), *((one, one) for one in stimuli)]:
            distance = np.hypot(a.c - b.c, ratio * (a.d - b.d))
            value = int(np.clip(round(380 * distance + 1.5 * rng.standard_normal()), 0, 100))
            judged.append({"stimulus_left": a.name, "stimulus_right": b.name, "dissimilarity": value})
        _write(folder, judged, kind="pairwise", task="pairwise", **who)
        for task, slope, axis in (("contrast", 380, "c"), ("doi", 500, "d")):
            rated = []
            for paint in SETS[task] * 2:
                one = Stimulus.of(*paint)
                place = one.c if axis == "c" else one.d - 0.84
                value = int(np.clip(round(slope * place + 1.0 * rng.standard_normal()), 0, 100))
                rated.append({"stimulus": one.name, "rating": value})
            _write(folder, rated, kind="magnitude", task=task, **who)
        if observer == "simulated":
            parameters = {"weight_c": 1.0, "weight_d": ratio, "exponent": 1.0, "noise_sd": 1.5, "ratio": ratio}
            record_simulated_observer(folder / "dataset", f"{k:02d}", parameters)
    return folder


def _write(folder, rows, *, kind, task, **who):
    seen = {}
    trials = []
    for number, row in enumerate(rows, start=1):
        key = tuple(row[column] for column in row if column.startswith("stimulus"))
        seen[key] = seen.get(key, 0) + 1
        place = {"block": seen[key], "trial": number, "repeat": seen[key], "response_time_s": None}
        trials.append(place | row)
    write_session_data(folder / "dataset", trials, kind=kind, task=task, **who)


def _make_set(folder, name, stimuli, measured, errors):
    (folder / "images").mkdir(parents=True)
    (folder / "luminance").mkdir()
    entries = []
    for one in stimuli:
        image, luminance = f"images/{one.name}.png", f"luminance/{one.name}.exr"
        Image.new("L", (8, 8), color=min(255, round(250 * one.c))).save(folder / image)
        (folder / luminance).write_bytes(b"not read by the analysis")
        entry = {"name": one.name, "rho_d": one.rho_d, "rho_s": one.rho_s, "alpha": one.alpha}
        entry |= {"image": image, "luminance": luminance}
        entry["sha256"] = {"image": sha256_of(folder / image), "luminance": sha256_of(folder / luminance)}
        if errors:
            entry["error_estimate"] = {"median": 0.125, "percentile_99_9": 0.375, "reached_target": True}
        entries.append(entry)
    write_manifest(
        folder,
        {
            "name": name,
            "image": {"width": 8, "height": 8},
            "viewing": {"distance_cm": 152.4, "image_width_deg": 3.2},
            "display": {"black_cd_m2": 0.7, "white_cd_m2": 108.0, "gamma": 2.35, "bits": 8},
            "stimuli": entries,
        },
    )
    if measured:
        rows = ["stimulus,displayed_luminance_ratio,displayed_lightness_difference"]
        rows += [f"{one.name},{1 + one.c**2 * one.d**4!r},{90 * one.c * one.d**2!r}" for one in stimuli]
        (folder / "measurements.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
