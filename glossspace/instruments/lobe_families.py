"""The models that gloss readings are traced back to: each has a roughness, and an amplitude that scales its reading.

Readings of unit amplitude are tabulated once over the roughness, for every solver that needs them.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from glossspace.errors import GlossError
from glossspace.instruments.glossmeter import gloss_units
from glossspace.instruments.standards import GLOSS_ANGLES_DEG
from glossspace.metric.validity import FloatArray
from glossspace.reflectance import CookTorrance, Lambert, Ward
from glossspace.reflectance.model import ReflectanceModel

__all__ = ["FAMILIES", "Family", "Material", "diffuse_units", "lobe_family", "require_readings", "unit_readings"]

_GRID = 96
# The table only finds where solutions are; they are then computed at full accuracy.
_TABLE_TOLERANCE = 1e-4


@dataclass(frozen=True)
class Material:
    """What a gloss reading does not tell and must be assumed.

    Attributes
    ----------
    rho_d : float
        Diffuse reflectance, 0 to 1.
    n, k : float
        Index of refraction of the facets; Ward's lobe has none.
    """

    rho_d: float = 0.0
    n: float = 1.5
    k: float = 0.0


@dataclass(frozen=True)
class Family:
    """A lobe with an amplitude and a roughness.

    Attributes
    ----------
    name : str
        Name on the command line.
    amplitude, roughness : str
        What these are called in the model.
    roughness_range : (float, float)
        Where solutions are looked for.
    lobe : callable
        Model of (amplitude, roughness, Material).
    most : callable
        Largest amplitude that a `Material` allows; infinite for the glossmeter paper's Cook–Torrance.
    """

    name: str
    amplitude: str
    roughness: str
    roughness_range: tuple[float, float]
    lobe: Callable[[Any, Any, Material], ReflectanceModel]
    most: Callable[[Material], float]


FAMILIES = {
    family.name: family
    for family in (
        Family("ward", "rho_s", "alpha", (0.002, 0.6), lambda a, r, _: Ward(a, r), lambda m: 1 - m.rho_d),
        Family(
            "beckmann", "scale", "slope", (0.002, 1.0),
            lambda a, r, m: CookTorrance(a, r, m.n, m.k, form="beckmann"), lambda _: 1.0,
        ),
        Family("cook-torrance", "scale", "slope", (0.002, 4.0), lambda a, r, m: CookTorrance(a, r, m.n, m.k),
               lambda _: np.inf),
    )
}  # fmt: skip
"""Families by name: Ward's lobe, Cook–Torrance with Beckmann's distribution, and as the glossmeter paper writes it."""


def lobe_family(name: str) -> Family:
    """Give a family by name.

    Raises
    ------
    GlossError
        There is none of that name.
    """
    if name not in FAMILIES:
        raise GlossError(f"Unknown family {name!r} of lobes. Allowed: {', '.join(FAMILIES)}.")
    return FAMILIES[name]


def require_readings(readings: Mapping[int, float]) -> tuple[FloatArray, tuple[int, ...]]:
    """Turn readings into an array and their angles, in the standards' order.

    Raises
    ------
    GlossError
        There is none, an angle is not one of a glossmeter, or a reading is negative or not finite.
    """
    unknown = [angle for angle in readings if angle not in GLOSS_ANGLES_DEG]
    if unknown or not readings:
        raise GlossError(f"Readings need one to three of the angles 20, 60 and 85; got {list(readings)}.")
    for angle, value in readings.items():
        if not (np.isfinite(value) and value >= 0):
            raise GlossError(f"Invalid reading {value!r} at {angle} degrees. Allowed: finite gloss units, 0 or above.")
    angles = tuple(angle for angle in GLOSS_ANGLES_DEG if angle in readings)
    return np.array([float(readings[angle]) for angle in angles]), angles


@lru_cache(maxsize=64)
def unit_readings(name: str, angle_deg: int, n: float, k: float) -> tuple[FloatArray, FloatArray]:
    """Roughnesses, and the readings of a family's lobe of amplitude one at each."""
    family = lobe_family(name)
    roughness = np.geomspace(*family.roughness_range, _GRID)
    model = family.lobe(1.0, roughness, Material(n=n, k=k))
    return roughness, gloss_units(model, angle_deg, relative_tolerance=_TABLE_TOLERANCE)


def diffuse_units(rho_d: ArrayLike, angle_deg: int) -> FloatArray:
    """Gloss units of the diffuse part alone, which a glossmeter also catches.

    Examples
    --------
    >>> round(float(diffuse_units(0.767, 60)), 2)
    1.91
    """
    return gloss_units(Lambert(rho_d), angle_deg)
