"""Confirmatory MDS: the coordinates are given functions of the stimuli, and only the weights of the axes are estimated.

This is how the gloss paper finds that distinctness of image weighs 1.78 times contrast gloss. The objective is the one
of every scaling here (`objective`), so any level and tie rule can be used; ordinal is the default, because a slider
that compresses large differences biases a ratio-level fit upward.
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from scipy.stats import t as student_t

from gloss_analysis.confirmatory.axis_weights import AxisWeights, fit_axis_weights
from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds.diagnostics import all_flat, check_scalable, data_warnings, distinguishes
from gloss_analysis.mds.disparities import Level, Ties
from gloss_analysis.mds.objective import source_distances
from gloss_analysis.mds.problem import make_problem
from glossspace.errors import GlossError

__all__ = ["INTERVALS", "AxisWeights", "ConfirmatoryFit", "Interval", "confirm_axes", "population_interval"]

Interval: TypeAlias = Literal["t", "bootstrap"]
INTERVALS: tuple[Interval, ...] = ("t", "bootstrap")

# Axes whose spread across each other is less than this part of that along them are one axis but for rounding.
_SAME_DIRECTION = 1e-9
_RESAMPLES = 2000


@dataclass(frozen=True)
class ConfirmatoryFit:
    """Axis weights of every participant, of the population they stand for, and of one shared fit.

    Attributes
    ----------
    axes, participants : tuple of str
    individual : tuple of AxisWeights
        One a participant who could be fitted; `participants` names them, and `warnings` the others.
    population_ratio : float
        Geometric mean of the participants' ratios, those at the limit of the search included.
    population_ci95 : tuple of float, or None
        95 % interval of it, on the logarithms (`population_interval`); None with too few participants.
    shared : AxisWeights
        One set of weights for all, each participant at a scale of its own. Descriptive: biased upwards where
        participants differ; `benchmarks/confirm_claims` finds 4 to 12 % for log ratios of standard deviation .15 to .5.
    warnings : tuple of str
    interval : {"t", "bootstrap"}
        Kind of `population_ci95`.
    """

    axes: tuple[str, ...]
    participants: tuple[str, ...]
    individual: tuple[AxisWeights, ...]
    population_ratio: float
    population_ci95: tuple[float, float] | None
    shared: AxisWeights
    warnings: tuple[str, ...]
    interval: Interval = "t"


def confirm_axes(
    data: Dissimilarities,
    coordinates: np.ndarray,
    *,
    axes: tuple[str, ...],
    level: Level = "ordinal",
    ties: Ties = "primary",
    interval: Interval = "t",
    seed: int = 1,
) -> ConfirmatoryFit:
    """Estimate how much each given axis weighs in the judged dissimilarities.

    Parameters
    ----------
    data : Dissimilarities
        m participants, n stimuli.
    coordinates : ndarray, shape (n, n_axes)
        Position of each stimulus along each axis, in the order of `data.stimuli`.
    axes : tuple of str
        Names of the axes.
    level, ties
        See `gloss_analysis.mds.scale`.
    interval : {"t", "bootstrap"}
        Interval of the population's ratio, see `population_interval`.
    seed : int
        Of the bootstrap.

    Returns
    -------
    ConfirmatoryFit

    Raises
    ------
    GlossError
        An unknown interval. Coordinates do not fit the data, are not finite, are the same for all stimuli on an axis,
        or do not tell the axes apart; or no participant's judgements can be fitted.

    Notes
    -----
    With two axes the weights have one free number, the ratio; it is found on a grid over four decades, then refined.
    Where order alone leaves a range of ratios equally good, its middle is taken. With more axes, by Nelder and Mead's
    search on log weights from the best of many points in that range.
    """
    _check_interval(interval)
    coordinates = np.asarray(coordinates, dtype=float)
    if coordinates.shape != (len(data.stimuli), len(axes)):
        raise GlossError(
            f"Coordinates of shape {coordinates.shape} do not fit {len(data.stimuli)} stimuli and {len(axes)} axes."
        )
    if not np.all(np.isfinite(coordinates)):
        raise GlossError("Coordinates must be finite numbers.")
    # Halved, so that coordinates at both ends of the floating-point range do not overflow.
    half = np.ptp(coordinates / 2, axis=0)
    # Not by the standard deviation: that of equal numbers may be a rounding error above 0.
    flat = [name for name, extent in zip(axes, half, strict=True) if extent == 0]
    if flat:
        raise GlossError(
            f"All stimuli have the same coordinate on the axis {flat[0]!r}: its weight cannot be known. Judge stimuli "
            "that differ along it, or leave that axis out."
        )
    # In units of its extent, so that squares neither overflow nor vanish whatever the unit of an axis.
    unit = (coordinates / 2 - (coordinates / 2).min(axis=0)) / half
    singular = np.linalg.svd(unit - unit.mean(axis=0), compute_uv=False)
    if len(singular) < len(axes) or singular[-1] < _SAME_DIRECTION * singular[0]:
        raise GlossError(
            f"The axes {', '.join(axes)} are multiples or sums of each other on these stimuli, so that their weights "
            "cannot be told apart. Leave one out."
        )
    check_scalable(data, level=level, ties=ties)

    remarks = list(data_warnings(data, level=level, ties=ties))
    participants, individual, unseen, unrelated = [], [], [], []
    first, second = data.pairs
    apart = unit[first] != unit[second]
    for name, row in zip(data.participants, data.values, strict=True):
        if not distinguishes(row):
            continue  # data_warnings names this participant
        if not apart[~np.isnan(row)].any(axis=0).all():
            unseen.append(name)
            continue
        one = make_problem(data.of((name,)), level=level, ties=ties)
        participants.append(name)
        individual.append(fit_axis_weights(one, unit, half))
        if all_flat(one, source_distances(unit, individual[-1].weights[np.newaxis] * half / half[0])):
            unrelated.append(name)
    if unseen:
        remarks.append(
            f"Judged no pair that differs along some axis, so that its weight is not known: {_list(unseen)}."
        )
    if unrelated:
        remarks.append(
            "Judgements do not rise with the distances that the axes make, so that the ratio tells nothing, for: "
            f"{_list(unrelated)}. Was the scale reversed? The population's ratio contains theirs; leave these "
            "participants out to see how far it moves."
        )
    if not individual:
        raise GlossError(" ".join(["No participant's axis weights can be fitted.", *remarks]))
    bound = [name for name, fit in zip(participants, individual, strict=True) if fit.at_bound]
    if bound:
        remarks.append(
            f"Judgements follow one axis alone, so that the ratio is only a limit, for: {_list(bound)}. The "
            "population's ratio and interval move with that limit; leave these participants out to see how far."
        )

    logs = np.log([fit.ratio for fit in individual])
    shared = fit_axis_weights(make_problem(data, level=level, ties=ties), unit, half)
    return ConfirmatoryFit(
        axes=axes,
        participants=tuple(participants),
        individual=tuple(individual),
        population_ratio=float(np.exp(logs.mean())),
        population_ci95=population_interval(logs, interval=interval, seed=seed),
        shared=shared,
        warnings=tuple(remarks),
        interval=interval,
    )


def _list(names: list[str]) -> str:
    return ", ".join(names)


def population_interval(logs: np.ndarray, *, interval: Interval = "t", seed: int = 1) -> tuple[float, float] | None:
    """95 % interval of the geometric mean of a population, from the logarithms of a sample of it.

    Parameters
    ----------
    logs : ndarray, shape (m,)
        Logarithms of the ratios of m participants.
    interval : {"t", "bootstrap"}
        Student's interval, exact for normal logarithms; or the studentised bootstrap of 2,000 resamples, which needs no
        normality. A percentile bootstrap is not offered: with nine participants its 95 % interval covers only 90 %.
    seed : int
        Of the bootstrap.

    Returns
    -------
    tuple of float, or None
        None with fewer than two participants, or three for the bootstrap: two different ones, resampled, have mean and
        standard error of the sample itself or no standard error at all.

    Raises
    ------
    GlossError
        An unknown interval.

    Notes
    -----
    The studentised bootstrap (Efron and Tibshirani 1993, chapter 12) takes the quantiles of
    (mean* - mean) / standard error* over resamples in place of those of Student's t. Resamples of one participant
    alone have no standard error and are left out.

    Examples
    --------
    >>> low, high = population_interval(np.log([1.0, 2.0, 4.0]))
    >>> round(low, 3), round(high, 2)
    (0.357, 11.19)
    """
    _check_interval(interval)
    logs = np.asarray(logs, dtype=float)
    m = len(logs)
    if m < 2 or (interval == "bootstrap" and m < 3):
        return None
    error = logs.std(ddof=1) / np.sqrt(m)
    if interval == "t":
        upper = student_t.ppf(0.975, m - 1)
        lower = -upper
    else:
        drawn = logs[np.random.default_rng(seed).integers(m, size=(_RESAMPLES, m))]
        errors = drawn.std(axis=1, ddof=1) / np.sqrt(m)
        # The standard deviation of equal numbers may be a rounding error above 0.
        usable = np.ptp(drawn, axis=1) > 0
        if not usable.any():
            return float(np.exp(logs.mean())), float(np.exp(logs.mean()))
        lower, upper = np.quantile((drawn.mean(axis=1) - logs.mean())[usable] / errors[usable], [0.025, 0.975])
    return float(np.exp(logs.mean() - upper * error)), float(np.exp(logs.mean() - lower * error))


def _check_interval(interval: str) -> None:
    if interval not in INTERVALS:
        raise GlossError(f"Invalid interval = {interval!r}. Allowed: {', '.join(map(repr, INTERVALS))}.")
