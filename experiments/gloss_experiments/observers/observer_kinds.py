"""Which simulated observers there are: the stated population, kinds with a failing, and what each of them looks at."""

import hashlib
from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from gloss_experiments.observers.observer import SimulatedObserver
from glossspace.errors import GlossError
from glossspace.stimulus_set import StimulusSet

__all__ = ["OBSERVER_KINDS", "observer_named", "seen_axes", "simulated_observers"]

# The stated population. The ratio's centre is eq. 5 of the gloss paper; its spread and the two ranges are assumptions,
# wide enough that observers differ and that an analysis which takes the slider as linear goes wrong.
MEDIAN_RATIO = 1.78
SD_LOG_RATIO = 0.15
EXPONENT_RANGE = (0.75, 0.95)
NOISE_SD_RANGE = (3.0, 6.0)

OBSERVER_KINDS: Mapping[str, Mapping[str, Any]] = MappingProxyType(
    {
        "metric": {},
        "compressive": {"exponent": 0.5},
        "wavering": {"criterion_sd": 0.3},
        "lapsing": {"lapse_rate": 0.1},
        "tiring": {"noise_growth": 0.5},
        "drifting": {"criterion_drift": 0.1},
        "middle": {"lapse_rate": 1.0, "lapse_answer": 50},
        "random": {"lapse_rate": 1.0},
        "reversed": {"reversed": True},
        "images": {"sees": "images"},
    }
)
"""The kinds by name, each with what sets it apart from the stated population.

``metric``: the population itself. ``compressive``: half the exponent of a linear slider. ``wavering``: a criterion that
changes from trial to trial by a factor of about 1.35. ``lapsing``: does not look in a tenth of the trials. ``tiring``:
after 200 trials errs twice as much. ``drifting``: after 378 trials gives ratings of about 70 % of the first ones.
``middle``, ``random``: never look. ``reversed``: has the slider the wrong way round. ``images``: knows nothing of the
paints and looks at the pictures.
"""


def simulated_observers(n: int, seed: int, *, kind: str = "metric") -> tuple[SimulatedObserver, ...]:
    """Draw `n` simulated observers of a kind.

    The ratio of weights is log-normal round 1.78 (standard deviation of its logarithm 0.15), the exponent uniform from
    0.75 to 0.95, the noise uniform from 3 to 6 slider units. The ratio of one that sees images is as spread, but round
    1, since its two dimensions are in units of their own. The first observers do not depend on how many are drawn.

    Raises
    ------
    GlossError
        There is no such kind, or `n` or the seed is negative.

    Examples
    --------
    >>> [round(observer.ratio, 2) for observer in simulated_observers(3, seed=1)]  # doctest: +SKIP
    [1.88, 2.02, 1.7]
    >>> simulated_observers(1, seed=1, kind="middle")[0].lapse_answer
    50
    """
    if n < 0 or seed < 0:
        raise GlossError(f"{n} simulated observers of seed {seed} cannot be drawn; both numbers are whole, from 0.")
    children = np.random.SeedSequence(seed).spawn(n)
    return tuple(_drawn(np.random.default_rng(child), kind) for child in children)


def observer_named(participant: str, *, seed: int, kind: str = "metric") -> SimulatedObserver:
    """The simulated observer that stands for `participant` of a study with `seed`, the same in every task.

    Another kind changes what sets that kind apart, and leaves the person's other parameters as they were.

    Raises
    ------
    GlossError
        There is no such kind.

    Examples
    --------
    >>> observer_named("01", seed=0, kind="reversed").reversed
    True
    """
    digest = hashlib.sha256(f"observer {participant}".encode()).digest()
    return _drawn(np.random.default_rng([seed, *digest[:16]]), kind)


def _drawn(rng: np.random.Generator, kind: str) -> SimulatedObserver:
    if kind not in OBSERVER_KINDS:
        raise GlossError(f"No simulated observer of the kind '{kind}'; allowed are {', '.join(OBSERVER_KINDS)}.")
    changes = OBSERVER_KINDS[kind]
    median = MEDIAN_RATIO if changes.get("sees") != "images" else 1.0
    drawn = {
        "weight_c": 1.0,
        "weight_d": float(median * np.exp(SD_LOG_RATIO * rng.standard_normal())),
        "exponent": float(rng.uniform(*EXPONENT_RANGE)),
        "noise_sd": float(rng.uniform(*NOISE_SD_RANGE)),
    }
    return SimulatedObserver(**(drawn | dict(changes)))


def seen_axes(
    observer: SimulatedObserver, stimulus_set: StimulusSet, names: Iterable[str]
) -> dict[str, tuple[float, float]]:
    """What an observer sees of the named stimuli: two numbers for each, which `Judge` takes as axes.

    Returns
    -------
    dict
        ``{stimulus: (c, d)}`` of eqs. 3 and 4 of the gloss paper; or, for an observer that sees images,
        ``(contrast, sharpness)`` as `image_observer.image_axes` measures them.

    Raises
    ------
    GlossError
        An image has to be looked at and cannot be.
    """
    wanted = list(names)
    if observer.sees == "images":
        # Here alone: sessions with other observers need no image library.
        from gloss_experiments.observers.image_observer import image_axes

        return image_axes(stimulus_set, wanted)
    axes = {stimulus.name: (stimulus.c, stimulus.d) for stimulus in stimulus_set.stimuli}
    return {name: axes[name] for name in wanted}
