"""A simulated screen under a simulated photometer; whatever they give is called simulated."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gloss_experiments.calibration.patches import Patch, standard_patches
from gloss_experiments.calibration.readings import Reading, Readings
from glossspace.errors import GlossError

__all__ = ["SIMULATED", "SimulatedPhotometer", "SimulatedScreen", "simulated_readings"]

SIMULATED = "simulated"


@dataclass(frozen=True, kw_only=True)
class SimulatedScreen:
    """A screen of known parameters; the default is the gloss paper's, without a fault.

    Attributes
    ----------
    black_cd_m2, white_cd_m2 : float
        Luminance of black, without ambient light, and of white.
    gamma, offset : tuple of float
        Of red, green and blue.
    shares : tuple of float
        Of the channels in the luminance of white above black (ITU-R BT.709).
    ambient_cd_m2 : float
        Light of the room that the screen reflects; it is in every reading, as before a telephotometer.
    veiling : float
        Share of the surround's luminance that strays into a patch.
    interaction : float
        What gray lacks (negative) or has beyond the sum of its channels, as a share.
    left, right : float
        Luminance at the places of the images, over that of the centre.
    warm_up_share, warm_up_time_min : float
        How much brighter the cold screen is, and the time constant of its decay.
    bits : int
        Of the code values.

    Raises
    ------
    GlossError
        A number is not allowed.
    """

    black_cd_m2: float = 0.7
    white_cd_m2: float = 108.0
    gamma: tuple[float, float, float] = (2.35, 2.35, 2.35)
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    shares: tuple[float, float, float] = (0.2126, 0.7152, 0.0722)
    ambient_cd_m2: float = 0.0
    veiling: float = 0.0
    interaction: float = 0.0
    left: float = 1.0
    right: float = 1.0
    warm_up_share: float = 0.0
    warm_up_time_min: float = 15.0
    bits: int = 8

    def __post_init__(self) -> None:
        if not 0 <= self.black_cd_m2 < self.white_cd_m2 < math.inf:
            raise GlossError(f"A simulated screen of {self.black_cd_m2} to {self.white_cd_m2} cd/m2 cannot be.")
        if not all(0 < one < 10 for one in self.gamma) or not all(-0.9 < one < 0.9 for one in self.offset):
            raise GlossError(f"A simulated screen of gamma {self.gamma} and offset {self.offset} cannot be.")

    def luminance(self, patch: Patch, *, minutes: float = 0.0) -> float:
        """Luminance of a patch (cd/m²) so many minutes after switching on, without a photometer's error."""
        if patch.purpose == "ambient":
            return self.ambient_cd_m2
        added = self._added(patch.codes)
        surround = self.white_cd_m2 if patch.purpose == "veiling" and patch.position == "centre" else 0.0
        place = {"left": self.left, "right": self.right}.get(patch.position, 1.0)
        warmth = 1 + self.warm_up_share * math.exp(-minutes / self.warm_up_time_min)
        return place * warmth * (self.black_cd_m2 + added) + self.veiling * surround + self.ambient_cd_m2

    def _added(self, codes: tuple[int, int, int]) -> float:
        top = 2**self.bits - 1
        total = 0.0
        for code, gamma, offset, share in zip(codes, self.gamma, self.offset, self.shares, strict=True):
            raised = max(0.0, (1 - offset) * code / top + offset) ** gamma
            foot = max(0.0, offset) ** gamma
            total += share * (self.white_cd_m2 - self.black_cd_m2) * (raised - foot) / (1 - foot)
        return total * (1 + self.interaction) if min(codes) > 0 else total


@dataclass
class SimulatedPhotometer:
    """A photometer before a simulated screen: it errs by a share of the reading, and by a digit.

    Attributes
    ----------
    screen : SimulatedScreen
    noise : float
        Standard deviation of its error, as a share of the reading.
    digit_cd_m2 : float
        Standard deviation of its error that does not depend on the reading.
    seed : int
        Of that error.
    """

    screen: SimulatedScreen
    noise: float = 0.0
    digit_cd_m2: float = 0.0
    seed: int = 1
    name: str = SIMULATED

    def __post_init__(self) -> None:
        for what, value in (("noise", self.noise), ("digit_cd_m2", self.digit_cd_m2)):
            if not 0 <= value < math.inf:
                raise GlossError(f"The {what} of a simulated photometer is {value}. Allowed: a number from 0 on.")
        self._random = np.random.default_rng(self.seed)

    def read(self, patch: Patch, *, minutes: float) -> float:
        """Read the patch that is shown."""
        true = self.screen.luminance(patch, minutes=minutes)
        share, digit = self._random.normal(size=2)
        return max(0.0, float(true * (1 + self.noise * share) + self.digit_cd_m2 * digit))


def simulated_readings(
    screen: SimulatedScreen,
    patches: Sequence[Patch] | None = None,
    *,
    noise: float = 0.0,
    digit_cd_m2: float = 0.0,
    seed: int = 1,
) -> Readings:
    """Readings of all patches (by default the standard ones) of a simulated screen.

    A warm-up patch is read at its time, the others when the screen is warm.
    """
    patches = standard_patches(bits=screen.bits) if patches is None else patches
    photometer = SimulatedPhotometer(screen, noise=noise, digit_cd_m2=digit_cd_m2, seed=seed)
    items = []
    for patch in patches:
        reading = photometer.read(patch, minutes=math.inf if patch.minutes is None else patch.minutes)
        items.append(Reading(patch=patch, luminance_cd_m2=reading, minutes=patch.minutes))
    return Readings(tuple(items), photometer.name)
