"""Simulated observers: programs that answer as the gloss paper's metric says, with compression and noise on the slider.

They embody the answer that an analysis of their data recovers: recovering it tests the software, never the paper.
Everything they touch says that they are simulated.
"""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from itertools import combinations
from math import hypot

import numpy as np

from gloss_experiments.design import Trial

__all__ = ["Judge", "SimulatedObserver", "observer_named", "simulated_observers"]

# The stated population. The ratio's centre is eq. 5 of the gloss paper; its spread and the two ranges are assumptions,
# wide enough that observers differ and that an analysis which takes the slider as linear goes wrong.
MEDIAN_RATIO = 1.78
SD_LOG_RATIO = 0.15
EXPONENT_RANGE = (0.75, 0.95)
NOISE_SD_RANGE = (3.0, 6.0)


@dataclass(frozen=True)
class SimulatedObserver:
    """The parameters of one simulated observer.

    Parameters
    ----------
    weight_c, weight_d
        Weights of contrast gloss and distinctness-of-image gloss. Their ratio alone matters, since the slider is scaled
        to the range of the stimuli.
    exponent
        Of the response: the slider reads ``100 x**exponent`` where x, 0 to 1, is the difference over the largest in the
        set. Below 1 it compresses large differences.
    noise_sd
        Standard deviation of the error on the slider, in its units.
    """

    weight_c: float
    weight_d: float
    exponent: float
    noise_sd: float

    @property
    def ratio(self) -> float:
        """``weight_d / weight_c``, 1.78 in the paper."""
        return self.weight_d / self.weight_c

    def parameters(self) -> dict[str, float]:
        """The parameters and the ratio, ready for JSON."""
        return {**asdict(self), "ratio": self.ratio}


def simulated_observers(n: int, seed: int) -> tuple[SimulatedObserver, ...]:
    """Draw `n` simulated observers from the stated population.

    The ratio of weights is log-normal round 1.78 (standard deviation of its logarithm 0.15), the exponent uniform from
    0.75 to 0.95, the noise uniform from 3 to 6 slider units. The first observers do not depend on how many are drawn.

    Examples
    --------
    >>> [round(observer.ratio, 2) for observer in simulated_observers(3, seed=1)]  # doctest: +SKIP
    [1.88, 2.02, 1.7]
    """
    return tuple(_drawn(np.random.default_rng(child)) for child in np.random.SeedSequence(seed).spawn(n))


def observer_named(participant: str, *, seed: int) -> SimulatedObserver:
    """The simulated observer that stands for `participant` of a study with `seed`, the same in every task."""
    return _drawn(np.random.default_rng([seed, *_bytes_of(f"observer {participant}")]))


def _drawn(rng: np.random.Generator) -> SimulatedObserver:
    return SimulatedObserver(
        weight_c=1.0,
        weight_d=float(MEDIAN_RATIO * np.exp(SD_LOG_RATIO * rng.standard_normal())),
        exponent=float(rng.uniform(*EXPONENT_RANGE)),
        noise_sd=float(rng.uniform(*NOISE_SD_RANGE)),
    )


def _bytes_of(text: str) -> bytes:
    return hashlib.sha256(text.encode("utf-8")).digest()[:16]


@dataclass(frozen=True)
class Judge:
    """A simulated observer in one session: it knows the axes of the stimuli, and the range it was shown beforehand.

    Parameters
    ----------
    observer
        Its parameters.
    axes
        ``{stimulus: (c, d)}`` for every stimulus of the session.
    seed
        Of the session. The error in a trial depends on the seed and the trial's number alone, so a session that was
        killed and resumed gives the answers of an unbroken one.
    """

    observer: SimulatedObserver
    axes: Mapping[str, tuple[float, float]]
    seed: int
    _largest: float = field(init=False)
    _range: tuple[float, float] = field(init=False)

    def __post_init__(self) -> None:
        # The dataclass is frozen: these two are worked out once, not with every one of 378 trials.
        levels = [self._level(name) for name in self.axes]
        differences = [self._difference(a, b) for a, b in combinations(self.axes, 2)]
        object.__setattr__(self, "_largest", max(differences, default=0.0))
        object.__setattr__(self, "_range", (min(levels, default=0.0), max(levels, default=0.0)))

    def rate(self, trial: Trial) -> int:
        """The rating of a trial, 0 to 100: of the pair's difference, or of the single stimulus's glossiness."""
        fraction = self._fraction(trial.stimuli)
        error = np.random.default_rng([self.seed, trial.number]).standard_normal() * self.observer.noise_sd
        return int(np.clip(np.rint(100 * fraction**self.observer.exponent + error), 0, 100))

    def _fraction(self, stimuli: Sequence[str]) -> float:
        if len(stimuli) == 2:
            return self._difference(*stimuli) / self._largest if self._largest > 0 else 0.0
        low, high = self._range
        return (self._level(stimuli[0]) - low) / (high - low) if high > low else 0.5

    def _difference(self, a: str, b: str) -> float:
        (c_a, d_a), (c_b, d_b) = self.axes[a], self.axes[b]
        return hypot(self.observer.weight_c * (c_a - c_b), self.observer.weight_d * (d_a - d_b))

    def _level(self, name: str) -> float:
        c, d = self.axes[name]
        return self.observer.weight_c * c + self.observer.weight_d * d
