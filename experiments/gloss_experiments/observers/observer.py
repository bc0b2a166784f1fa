"""Simulated observers: programs that answer from the gloss paper's metric or from the images, with human failings.

Those that go by the metric embody the answer that an analysis of their data recovers: recovering it tests the software,
never the paper. Everything they touch says that they are simulated. What kinds there are stands in `observer_kinds`,
how they answer a trial in `Judge`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from itertools import combinations
from math import exp, hypot, isfinite
from typing import Any, Literal

import numpy as np

from gloss_experiments.design import Trial
from glossspace.errors import GlossError

__all__ = ["Judge", "SimulatedObserver"]

_WEIGHTS = {
    "paint": {"weight_c": "weight_c", "weight_d": "weight_d"},
    "images": {"weight_c": "weight_contrast", "weight_d": "weight_sharpness"},
}


@dataclass(frozen=True)
class SimulatedObserver:
    """The parameters of one simulated observer.

    The two dimensions are multiplied by their weights, and a difference is Euclidean in them (eq. 5 of the gloss paper
    with weights of one's own). With x that difference over the largest in the session, or the gloss of a single
    stimulus on the range of the session, the answer to trial number t is ::

        rating = 100 (x / k)**exponent + e        k = exp(criterion_drift t / 100 + criterion_sd z)

    where e is normal with a standard deviation of ``noise_sd (1 + noise_growth t / 100)`` and z standard normal.

    Parameters
    ----------
    weight_c, weight_d
        Weights of contrast gloss and distinctness-of-image gloss, not negative, not both 0. Their ratio alone matters,
        since the slider is scaled to the range of the stimuli.
    exponent
        Of the response, above 0. Below 1 it compresses large differences.
    noise_sd
        Standard deviation of the error on the slider, in its units.
    criterion_sd
        Standard deviation of the logarithm of the criterion k, the difference that is called 100, from trial to trial.
    criterion_drift
        Fatigue: by how much the logarithm of the criterion rises with each hundred trials; ratings shrink.
    noise_growth
        Fatigue: by which share of `noise_sd` the error grows with each hundred trials.
    lapse_rate
        Share of the trials, 0 to 1, in which the observer does not look.
    lapse_answer
        What is answered then, 0 to 100; None for any number of the slider, or any order of a ranking. In a ranking a
        number stands for leaving the items as they lie.
    reversed
        Whether the slider is used the wrong way round.
    sees
        ``"paint"``: the axes c and d of the paper, from the stimuli's parameters. ``"images"``: the contrast and
        sharpness of the reflections in their images (`image_observer`); the weights are those of these two.

    Raises
    ------
    GlossError
        A parameter is out of its range.
    """

    weight_c: float
    weight_d: float
    exponent: float
    noise_sd: float
    criterion_sd: float = 0.0
    criterion_drift: float = 0.0
    noise_growth: float = 0.0
    lapse_rate: float = 0.0
    lapse_answer: int | None = None
    reversed: bool = False
    sees: Literal["paint", "images"] = "paint"

    def __post_init__(self) -> None:
        for name in ("weight_c", "weight_d", "exponent", "noise_sd", "criterion_sd", "noise_growth", "criterion_drift"):
            value = getattr(self, name)
            if not isfinite(value) or (value < 0 and name != "criterion_drift"):
                raise GlossError(f"{name} of a simulated observer is {value}; allowed are finite numbers from 0.")
        if self.exponent == 0 or self.weight_c == self.weight_d == 0:
            raise GlossError("A simulated observer needs an exponent above 0, and one weight above 0.")
        if not 0 <= self.lapse_rate <= 1:
            raise GlossError(f"lapse_rate of a simulated observer is {self.lapse_rate}; it is a share from 0 to 1.")
        if self.lapse_answer is not None and not 0 <= self.lapse_answer <= 100:
            raise GlossError(f"lapse_answer of a simulated observer is {self.lapse_answer}; it is a number to 100.")

    @property
    def ratio(self) -> float | None:
        """``weight_d / weight_c``, 1.78 in the paper; None for one that sees images, whose dimensions are its own."""
        return self.weight_d / self.weight_c if self.sees == "paint" and self.weight_c > 0 else None

    def parameters(self) -> dict[str, Any]:
        """The parameters and the ratio, ready for JSON; failings that the observer lacks are left out.

        Examples
        --------
        >>> SimulatedObserver(1.0, 1.5, exponent=0.8, noise_sd=4.0, lapse_rate=0.1).parameters()
        {'weight_c': 1.0, 'weight_d': 1.5, 'exponent': 0.8, 'noise_sd': 4.0, 'lapse_rate': 0.1, 'ratio': 1.5}
        """
        usual = SimulatedObserver(1.0, 1.0, 1.0, 0.0)
        always = ("weight_c", "weight_d", "exponent", "noise_sd")
        names = _WEIGHTS[self.sees]
        document: dict[str, Any] = {
            names.get(name, name): value
            for name, value in asdict(self).items()
            if name in always or value != getattr(usual, name)
        }
        return document if self.ratio is None else {**document, "ratio": self.ratio}


@dataclass(frozen=True)
class Judge:
    """A simulated observer in one session: it knows the axes of the stimuli, and the range it was shown beforehand.

    Parameters
    ----------
    observer
        Its parameters.
    axes
        ``{stimulus: (c, d)}`` for every stimulus of the session, or what the observer sees in their place; see
        `observer_kinds.seen_axes`.
    seed
        Of the session. What is random in a trial depends on the seed and the trial's number alone, so a session that
        was killed and resumed gives the answers of an unbroken one.
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
        rng = self._rng(trial)
        rating = self._response(self._fraction(trial.stimuli), trial, rng)
        lapses, anything = rng.random() < self.observer.lapse_rate, int(rng.integers(0, 101))
        if lapses:
            return anything if self.observer.lapse_answer is None else self.observer.lapse_answer
        return int(np.clip(np.rint(100 - rating if self.observer.reversed else rating), 0, 100))

    def rank(self, trial: Trial) -> tuple[str, ...]:
        """The items of a ranking by their apparent difference from the reference, the smallest first.

        Each item has an error of its own, as a rating of it would.
        """
        reference, *items = trial.stimuli
        rng = self._rng(trial)
        fractions = [self._relative(self._difference(reference, item)) for item in items]
        apparent = [self._response(fraction, trial, rng) for fraction in fractions]
        lapses, anyhow = rng.random() < self.observer.lapse_rate, rng.permutation(len(items))
        if lapses:
            return tuple(items[i] for i in anyhow) if self.observer.lapse_answer is None else tuple(items)
        order = np.argsort(apparent, kind="stable")
        return tuple(items[i] for i in (order[::-1] if self.observer.reversed else order))

    def _rng(self, trial: Trial) -> np.random.Generator:
        # Practice trials are counted on their own, and must not share their errors with the first real ones.
        return np.random.default_rng([self.seed, trial.number, *([1] if trial.role == "practice" else [])])

    def _response(self, fraction: float, trial: Trial, rng: np.random.Generator) -> float:
        observer, hundreds = self.observer, trial.number / 100
        error = rng.standard_normal() * observer.noise_sd * (1 + observer.noise_growth * hundreds)
        criterion = exp(observer.criterion_drift * hundreds + observer.criterion_sd * rng.standard_normal())
        return float(100 * (fraction / criterion) ** observer.exponent + error)

    def _fraction(self, stimuli: Sequence[str]) -> float:
        if len(stimuli) == 2:
            return self._relative(self._difference(*stimuli))
        low, high = self._range
        return (self._level(stimuli[0]) - low) / (high - low) if high > low else 0.5

    def _relative(self, difference: float) -> float:
        return difference / self._largest if self._largest > 0 else 0.0

    def _difference(self, a: str, b: str) -> float:
        (c_a, d_a), (c_b, d_b) = self.axes[a], self.axes[b]
        return hypot(self.observer.weight_c * (c_a - c_b), self.observer.weight_d * (d_a - d_b))

    def _level(self, name: str) -> float:
        c, d = self.axes[name]
        return self.observer.weight_c * c + self.observer.weight_d * d
