"""Which paints two gloss spaces have in common, by the ranges of the stimuli that were judged."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from glossspace.metric.space import GlossSpace
from glossspace.metric.validity import conserves_energy

__all__ = ["PARAMETERS", "RangeOverlap", "Spans", "common_spans", "overlap", "paints", "reflectances"]

PARAMETERS = ("rho_d", "rho_s", "alpha")
"""What describes a paint."""

Spans: TypeAlias = Mapping[str, tuple[float, float]]
"""Lowest and highest value of each parameter."""

# The gloss paper's Experiment 1 (section 3.2.3.1): where two spaces are compared that tell no range.
_USUAL = {"rho_d": (0.03, 0.767), "rho_s": (0.033, 0.099), "alpha": (0.04, 0.1)}


@dataclass(frozen=True)
class RangeOverlap:
    """One parameter of the paints that were judged.

    Attributes
    ----------
    parameter : str
    a, b : (low, high) or None
        None where the space does not tell.
    common : (low, high) or None
        What both cover, or the one that tells; None where they have nothing in common, or neither tells.
    share : float or None
        Length of the common part over that of both together; None unless both tell.
    """

    parameter: str
    a: tuple[float, float] | None
    b: tuple[float, float] | None
    common: tuple[float, float] | None
    share: float | None


def overlap(parameter: str, a: GlossSpace, b: GlossSpace) -> RangeOverlap:
    """Set the ranges of one parameter in two spaces side by side."""
    ours, theirs = a.stimulus_range.get(parameter), b.stimulus_range.get(parameter)
    if ours is None or theirs is None:
        return RangeOverlap(parameter, ours, theirs, ours or theirs, None)
    low, high = max(ours[0], theirs[0]), min(ours[1], theirs[1])
    if low > high:
        return RangeOverlap(parameter, ours, theirs, None, 0.0)
    whole = max(ours[1], theirs[1]) - min(ours[0], theirs[0])
    return RangeOverlap(parameter, ours, theirs, (low, high), (high - low) / whole if whole > 0 else 1.0)


def common_spans(ranges: tuple[RangeOverlap, ...], remarks: list[str]) -> Spans | None:
    """Ranges that hold the paints of both spaces, or None; appends to `remarks` what is not known or was assumed."""
    apart = [one.parameter for one in ranges if one.share is not None and one.common is None]
    if apart:
        remarks.append(
            f"The judged paints have no {' and no '.join(apart)} in common: neither distances nor slopes are compared."
        )
        return None
    for name, of in (("a", [one.a for one in ranges]), ("b", [one.b for one in ranges])):
        if None in of:
            unknown = ", ".join(one.parameter for one, span in zip(ranges, of, strict=True) if span is None)
            remarks.append(f"The range of judged paints in {name} is not known ({unknown}).")
    assumed = [one.parameter for one in ranges if one.common is None]
    if assumed:
        remarks.append(f"Of {', '.join(assumed)} neither range is known: that of the gloss paper's stimuli is taken.")
    grid = {one.parameter: one.common or _USUAL[one.parameter] for one in ranges}
    if not len(reflectances(grid, 2)[0]):
        remarks.append("The common range holds no possible paint (rho_d + rho_s > 1): only the weights are compared.")
        return None
    return grid


def reflectances(grid: Spans, n: int) -> tuple[np.ndarray, np.ndarray]:
    """All possible combinations of n values of rho_d and of rho_s."""
    rho_d, rho_s = (one.ravel() for one in np.meshgrid(*(_values(grid[name], n) for name in ("rho_d", "rho_s"))))
    possible = conserves_energy(rho_d, rho_s)
    return rho_d[possible], rho_s[possible]


def paints(grid: Spans, n: int) -> np.ndarray:
    """All possible paints of the grid, one a row."""
    rho_d, rho_s = reflectances(grid, n)
    alphas = _values(grid["alpha"], n)
    return np.column_stack([np.tile(rho_d, len(alphas)), np.tile(rho_s, len(alphas)), np.repeat(alphas, len(rho_d))])


def _values(span: tuple[float, float], n: int) -> np.ndarray:
    return np.unique(np.linspace(*span, n))
