"""Stimulus sets that a gloss space makes: what is in them, and where their paints lie in the space."""

from collections import Counter
from dataclasses import dataclass

import pandas as pd

from gloss_stimuli.sets import StimulusList
from glossspace.errors import GlossError
from glossspace.metric import PAPER_ALPHA_LIMIT, GlossSpace, Paint
from glossspace.stimulus_set import Stimulus

__all__ = ["AppliedSet", "range_remarks", "rounded_stimulus", "space_label"]

# Of rho_s and alpha: names of stimuli stay readable, and gloss distances right to 1e-5, a hundredth of what is visible.
SIGNIFICANT_DIGITS = 6


@dataclass(frozen=True)
class AppliedSet:
    """A stimulus set made from a gloss space.

    Attributes
    ----------
    stimuli : StimulusList
        Name, title and paints, without repeats.
    table : DataFrame
        One row a stimulus, in their order: `stimulus`, `rho_d`, `rho_s`, `alpha`; `c`, `d` and `distance` from the
        reference in the space; and what else the set knows of its stimuli.
    space : GlossSpace
    reference : Paint
    remarks : tuple of str
        What was left out, and what lies beyond what the space vouches for.
    """

    stimuli: StimulusList
    table: pd.DataFrame
    space: GlossSpace
    reference: Paint
    remarks: tuple[str, ...]


def rounded_stimulus(rho_d: float, rho_s: float, alpha: float) -> Stimulus:
    """Stimulus of a computed paint: rho_s and alpha to six significant digits, rho_d as it is.

    Raises
    ------
    GlossError
        There is no such paint.

    Examples
    --------
    >>> rounded_stimulus(0.193, 0.06600000001, 0.0699999999999999).name
    'd0.193_s0.066_a0.07'
    """
    rho_s, alpha = (float(f"{value:.{SIGNIFICANT_DIGITS}g}") for value in (rho_s, alpha))
    # A paint at the limit of energy stays on it, whichever way its digits were rounded.
    on_limit = 0 <= rho_d <= 1 < rho_d + rho_s < 1 + 10.0**-SIGNIFICANT_DIGITS
    return Stimulus.of(rho_d, 1 - rho_d if on_limit else rho_s, alpha)


def space_label(space: GlossSpace) -> str:
    """Name of a space, and whether it rests on simulated observers, as far as its file says so.

    Examples
    --------
    >>> space_label(GlossSpace(name="ours", provenance={"observers": ["01 (simulated)"]}))
    'ours (simulated observers)'
    """
    observers = space.provenance.get("observers")
    names = observers if isinstance(observers, list | tuple) else [observers]
    simulated = any("simulated" in str(name) for name in names)
    return f"{space.name} (simulated observers)" if simulated else space.name


def range_remarks(stimuli: StimulusList, space: GlossSpace) -> list[str]:
    """Which paints lie beyond the roughness that the gloss paper covers, or beyond the stimuli of the space's study.

    Raises
    ------
    GlossError
        Two of the stimuli are the same paint.
    """
    names = [stimulus.name for stimulus in stimuli.stimuli]
    for name, count in Counter(names).items():
        if count > 1:
            raise GlossError(
                f"Two paints of the set are the same to {SIGNIFICANT_DIGITS} digits: {name}. Choose larger distances, "
                "fewer points, or values that differ."
            )
    rough = [s.name for s in stimuli.stimuli if s.alpha > PAPER_ALPHA_LIMIT]
    beyond = [
        s.name
        for s in stimuli.stimuli
        if any(not low <= getattr(s, key, low) <= high for key, (low, high) in space.stimulus_range.items())
    ]
    remarks = []
    if rough:
        remarks.append(f"alpha is above {PAPER_ALPHA_LIMIT:g}, beyond what the gloss paper covers: {', '.join(rough)}.")
    if beyond:
        remarks.append(
            f"{len(beyond)} of {len(names)} paints lie beyond the stimuli that '{space.name}' was fitted to, where it "
            f"extrapolates: {', '.join(beyond)}."
        )
    return remarks
