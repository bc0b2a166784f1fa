"""Which screen a calibration belongs to: what the lab says of it, and what the system tells."""

import hashlib
import math
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Self

from glossspace.errors import GlossError

__all__ = ["ScreenIdentity", "connected_edid_sha256"]


@dataclass(frozen=True, kw_only=True)
class ScreenIdentity:
    """A screen, as far as it is known.

    Attributes
    ----------
    name : str
        What the lab calls it.
    size_px : (int, int), optional
        Width and height.
    refresh_hz, pixel_pitch_mm : float, optional
    edid_sha256 : tuple of str
        Hash of the identification (EDID) of every screen that was connected when it was measured: with a single one,
        of this very specimen. Empty where the system does not tell.

    Raises
    ------
    GlossError
        The name is blank, or a number is not allowed.
    """

    name: str
    size_px: tuple[int, int] | None = None
    refresh_hz: float | None = None
    pixel_pitch_mm: float | None = None
    edid_sha256: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not self.name.strip():
            raise GlossError(
                "The screen needs a name. Give the one on its label, such as --screen 'EIZO CG2420 no. 7'."
            )
        for what, value in (("refresh rate", self.refresh_hz), ("pixel pitch", self.pixel_pitch_mm)):
            if value is not None and not 0 < value < math.inf:
                raise GlossError(f"The {what} of the screen is {value}. Allowed: a finite number above 0.")
        if self.size_px is not None and min(self.size_px) < 1:
            raise GlossError(f"The size of the screen is {self.size_px}. Allowed: two whole numbers from 1.")

    def to_dict(self) -> dict[str, Any]:
        """As JSON takes it; `from_dict` makes it again."""
        return asdict(self)

    @classmethod
    def from_dict(cls, document: dict[str, Any]) -> Self:
        """Screen of a stored calibration."""
        size = document.get("size_px")
        return cls(
            name=document["name"],
            size_px=None if size is None else (int(size[0]), int(size[1])),
            refresh_hz=document.get("refresh_hz"),
            pixel_pitch_mm=document.get("pixel_pitch_mm"),
            edid_sha256=tuple(document.get("edid_sha256", ())),
        )


def connected_edid_sha256(folder: str | Path = "/sys/class/drm") -> tuple[str, ...]:
    """SHA-256 of the EDID of every connected screen, sorted; empty where the system is not Linux or tells none."""
    if not sys.platform.startswith("linux"):
        return ()
    found = set()
    for path in Path(folder).glob("*/edid"):
        try:
            content = path.read_bytes()
        except OSError:  # a connector that was unplugged meanwhile, or is not ours to read
            continue
        if content:
            found.add(hashlib.sha256(content).hexdigest())
    return tuple(sorted(found))
