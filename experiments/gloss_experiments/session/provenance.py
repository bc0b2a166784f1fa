"""What a journal says of the circumstances: versions, system, time, and the hash of the images."""

import hashlib
import json
import platform
from collections.abc import Mapping
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from typing import Any

__all__ = ["circumstances", "images_sha256"]


def images_sha256(hashes: Mapping[str, str]) -> str:
    """One hash of the images of a session, from the hash of each by the name of its stimulus."""
    return hashlib.sha256(json.dumps(dict(sorted(hashes.items()))).encode("utf-8")).hexdigest()


def circumstances(mode: str) -> dict[str, Any]:
    """When, on what and with which versions a part of a session runs."""
    packages = ("glossspace", "numpy") if mode == "headless" else ("glossspace", "numpy", "psychopy")
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
