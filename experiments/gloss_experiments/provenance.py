"""What a journal says of the circumstances: versions, system, time, and the hash of the images."""

import hashlib
import json
import platform
from collections.abc import Iterable
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from gloss_experiments.design import Trial
from glossspace.files import sha256_of
from glossspace.stimulus_set import StimulusSet

__all__ = ["circumstances", "images_sha256"]


def images_sha256(stimulus_set: StimulusSet, trials: Iterable[Trial]) -> str:
    """One hash of all images that the trials show."""
    names = sorted({name for trial in trials for name in trial.stimuli})
    hashes = {name: sha256_of(stimulus_set.image_path(name)) for name in names}
    return hashlib.sha256(json.dumps(hashes).encode("utf-8")).hexdigest()


def circumstances(mode: str) -> dict[str, Any]:
    """When, on what and with which versions a part of a session runs."""
    packages = ["glossspace", "numpy", *(["psychopy"] if mode != "headless" else [])]
    return {
        "mode": mode,
        "time": datetime.now(UTC).isoformat(timespec="seconds"),
        "versions": {"python": platform.python_version(), **{name: _version(name) for name in packages}},
        "system": platform.platform(),
    }


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None
