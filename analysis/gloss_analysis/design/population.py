"""The population that simulated observers of a planned study are drawn from, stated or taken from a pilot."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from gloss_analysis.confirmatory.scaling import ConfirmatoryFit, confirm_axes
from gloss_analysis.design.information import log_ratio_variance
from gloss_analysis.judgements.dissimilarity import Dissimilarities
from glossspace.errors import GlossError

__all__ = ["PilotPopulation", "Population", "population_like"]

_FEW_PARTICIPANTS = 5
# Slope and exponent of a response curve, and the ratio.
_FITTED = 3
_EXPONENTS = (0.1, 5.0)


@dataclass(frozen=True)
class Population:
    """How observers judge differences: 100 x**exponent and noise, x being a pair's distance over the largest.

    The distance is sqrt(dc² + (w dd)²), the ratio w being each observer's own. Defaults are the gloss paper's ratio and
    assumptions: they spread observers and curve the slider enough that neither can be neglected.

    Attributes
    ----------
    ratio : float
        Median of w, the weight of the second axis over that of the first; > 0.
    sd_log_ratio : float
        Standard deviation of log w, which is normal; 0 to 2.
    exponent : float
        Of the response, .1 to 5. Below 1 the slider compresses large differences.
    noise_sd : float
        Standard deviation of one answer about the response, in hundredths of the slider; 0 to 100.
    slider_step : int
        The slider stops at multiples of it; 1 to 50.
    """

    ratio: float = 1.78
    sd_log_ratio: float = 0.15
    exponent: float = 0.85
    noise_sd: float = 4.0
    slider_step: int = 1

    def __post_init__(self) -> None:
        for name, low, high in (
            ("ratio", 1e-6, 1e6),
            ("sd_log_ratio", 0, 2),
            ("exponent", *_EXPONENTS),
            ("noise_sd", 0, 100),
            ("slider_step", 1, 50),
        ):
            value = getattr(self, name)
            if not (math.isfinite(value) and low <= value <= high):
                raise GlossError(f"Invalid {name} = {value!r} of a population. Allowed: {low:g} to {high:g}.")
        if self.slider_step != int(self.slider_step):
            raise GlossError(f"Invalid slider_step = {self.slider_step!r}. Allowed: a whole number, 1 to 50.")


@dataclass(frozen=True)
class PilotPopulation:
    """A population like the participants of a pilot.

    Attributes
    ----------
    population : Population
    participants : tuple of str
        Whose judgements it rests on.
    warnings : tuple of str
    """

    population: Population
    participants: tuple[str, ...]
    warnings: tuple[str, ...]


def population_like(data: Dissimilarities, coordinates: np.ndarray, *, axes: tuple[str, str]) -> PilotPopulation:
    """Estimate the population that the participants of a pilot come from.

    Parameters
    ----------
    data : Dissimilarities
        Two participants or more.
    coordinates : ndarray, shape (n, 2)
        Of the stimuli on the two axes.
    axes : tuple of str, length 2

    Returns
    -------
    PilotPopulation

    Raises
    ------
    GlossError
        Fewer than two participants can be used, or what `confirm_axes` refuses.

    Notes
    -----
    The ratio is the geometric mean of the participants' own, from ordinal confirmatory scaling. To each participant's
    judgements the curve a x**p is fitted, x being the distance that his own ratio predicts over the largest: p is his
    exponent; what is left, over q - 3 for q pairs, and times the square root of the number of repeats behind a mean, is
    his noise, in hundredths of a. Exponents are averaged, and squares of noise. The spread of the ratios is larger than
    that of the population by their own error, of which `log_ratio_variance` tells the size: it is taken off.

    Examples
    --------
    >>> from gloss_analysis.design.simulation import EXPERIMENT_1, drawn_ratios, simulated_study
    >>> stated, rng = Population(ratio=1.5, noise_sd=3.0), np.random.default_rng(1)
    >>> pilot = simulated_study(EXPERIMENT_1, drawn_ratios(stated, 12, rng), stated, rng=rng)
    >>> found = population_like(pilot, EXPERIMENT_1, axes=("c", "d")).population
    >>> abs(found.noise_sd - 3.0) < 0.2, abs(found.exponent - 0.85) < 0.05
    (True, True)
    """
    if len(axes) != 2:
        raise GlossError(f"A population is about the ratio of two axes, not {len(axes)}: {', '.join(axes)}.")
    fit = confirm_axes(data, coordinates, axes=axes)
    remarks = list(fit.warnings)
    usable = [k for k, one in enumerate(fit.individual) if not one.at_bound]
    names = tuple(fit.participants[k] for k in usable)
    if len(usable) < 2:
        raise GlossError(
            f"{len(usable)} participants of the pilot can be used, and the spread of their ratios needs two. State the "
            "population instead, or add participants."
        )
    found = [_response(data, coordinates, fit, k) for k in usable]
    exponent = float(np.clip(np.mean([one[0] for one in found]), *_EXPONENTS))
    noise = float(np.sqrt(np.mean([one[1] for one in found])))
    logs = np.log([fit.individual[k].ratio for k in usable])
    ratio = float(np.exp(logs.mean()))
    error = _error_of_ratios(data, coordinates, names, ratio, exponent, [one[2] for one in found])
    if not np.isfinite(error):
        remarks.append(
            "The pilot has too few pairs to tell the participants' own error, which is counted to the spread of their "
            "ratios."
        )
        error = 0.0
    spread = logs.var(ddof=1) - error
    if spread <= 0:
        remarks.append("The participants' ratios differ no more than their own error makes them: the spread is 0.")
    if len(usable) < _FEW_PARTICIPANTS:
        remarks.append(
            f"The spread of the ratios rests on {len(usable)} participants and is itself little known. Look also at a "
            "spread half and twice as large."
        )
    return PilotPopulation(
        Population(
            ratio=ratio,
            sd_log_ratio=float(min(np.sqrt(max(spread, 0.0)), 2.0)),
            exponent=exponent,
            noise_sd=min(noise, 100.0),
        ),
        names,
        tuple(remarks),
    )


def _response(
    data: Dissimilarities, coordinates: np.ndarray, fit: ConfirmatoryFit, k: int
) -> tuple[float, float, float]:
    """Exponent of a participant, variance of one of his answers, and of his means, in squared hundredths."""
    row = data.participants.index(fit.participants[k])
    judged = data.judged[row]
    first, second = data.pairs
    delta = coordinates[first] - coordinates[second]
    distance = np.hypot(delta[:, 0], fit.individual[k].ratio * delta[:, 1])
    x, y = (distance / distance.max())[judged], data.values[row, judged]
    unit = y.max()
    y = y / unit

    found = least_squares(
        lambda p: p[0] * x ** p[1] - y, x0=[1.0, 1.0], bounds=([1e-3, _EXPONENTS[0]], [1e3, _EXPONENTS[1]])
    )
    top, exponent = found.x
    variance = 1e4 * 2 * found.cost / max(len(y) - _FITTED, 1) / top**2
    return float(exponent), float(variance * _repeats(data, row)), float(variance)


def _repeats(data: Dissimilarities, row: int) -> float:
    """Harmonic mean number of trials behind a judged pair: the error of means goes with the mean of 1 / repeats."""
    if data.trials is None:
        return 1.0
    counts = np.bincount(data.trials.pair[data.trials.source == row])
    return float(1 / np.mean(1 / counts[counts > 0]))


def _error_of_ratios(
    data: Dissimilarities, coordinates: np.ndarray, names: tuple[str, ...], ratio: float, exponent: float,
    variances: list[float],
) -> float:  # fmt: skip
    first, second = data.pairs
    delta = coordinates[first] - coordinates[second]
    errors = [
        variance * log_ratio_variance(delta, data.judged[data.participants.index(name)], ratio, exponent=exponent)
        for name, variance in zip(names, variances, strict=True)
    ]
    return float(np.mean(errors))
