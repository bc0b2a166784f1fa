"""The spheres of figure 12 of the gloss paper: the same physical gloss on all lightnesses, and the same apparent."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from gloss_stimuli.applied_set import AppliedSet, range_remarks, rounded_stimulus, space_label
from gloss_stimuli.sets import StimulusList
from glossspace.errors import GlossError
from glossspace.metric import PAPER_SPACE, GlossSpace, Paint, match_gloss
from glossspace.stimulus_set import Stimulus

__all__ = ["MATCHED", "PAPER_RHO_DS", "PAPER_WHITE", "matched_spheres"]

MATCHED = "matched"
"""The name of their set and its figure."""

PAPER_WHITE = Paint(0.767, 0.099, 0.04)
"""The white paint of figure 12, which its bottom row matches: c = .058, d = .96."""

PAPER_RHO_DS = (0.767, 0.193, 0.03)
"""The white, gray and black paint of the gloss paper."""


def matched_spheres(
    space: GlossSpace = PAPER_SPACE,
    *,
    reference: Paint = PAPER_WHITE,
    rho_ds: Sequence[float] = PAPER_RHO_DS,
) -> AppliedSet:
    """Paints with the reference's physical gloss, and paints with its apparent gloss (section 5.2 of the gloss paper).

    Parameters
    ----------
    space : GlossSpace
        Whose axis functions make gloss equal.
    reference : Paint
        One paint (rho_d, rho_s, alpha).
    rho_ds : sequence of float
        Diffuse reflectances, one a column of the figure, all different; usually the reference's is among them.

    Returns
    -------
    AppliedSet
        The set `matched`: first a paint of each rho_d with the reference's rho_s and alpha, then one of each with its
        c and d. The table also holds `same_physical` and `same_apparent`, which of the two rows a paint belongs to; the
        reference belongs to both. Where no paint of a lightness is so glossy, the remarks say so.

    Raises
    ------
    GlossError
        A parameter is impossible, or two of `rho_ds` are equal.

    Examples
    --------
    A black paint that looks as glossy as the white one with rho_s = .099 (figure 12).

    >>> matched = matched_spheres()
    >>> matched.table.query("same_apparent")[["rho_d", "rho_s"]].round(4).to_numpy().tolist()
    [[0.767, 0.099], [0.193, 0.0413], [0.03, 0.0132]]
    """
    own = Stimulus.of(*map(float, reference))
    columns = [float(rho_d) for rho_d in rho_ds]
    if not columns or len(set(columns)) < len(columns):
        raise GlossError(f"Invalid diffuse reflectances {columns}. Allowed: one or several different ones, 0 to 1.")
    physical = [Stimulus.of(rho_d, own.rho_s, own.alpha) for rho_d in columns]
    found = match_gloss(reference, rho_d=np.array(columns), out_of_reach="mask", space=space)
    reached = np.isfinite(found.rho_s)
    apparent = [
        own if paint[0] == own.rho_d else rounded_stimulus(*paint) for paint in np.array(found).T[reached].tolist()
    ]
    missing = np.array(columns)[~reached]
    stimuli = tuple(dict.fromkeys([*physical, *apparent]))
    title = f"Physical and apparent gloss of {own.name} on other lightnesses, in the space: {space_label(space)}"
    wanted = StimulusList(MATCHED, title, stimuli)
    paints = Paint(*np.array([(s.rho_d, s.rho_s, s.alpha) for s in stimuli]).T)
    c, d = space.coordinates(paints)
    table = pd.DataFrame(
        {
            "stimulus": [stimulus.name for stimulus in stimuli],
            **paints._asdict(),
            "lightness": [stimulus.lightness for stimulus in stimuli],
            "same_physical": [stimulus in physical for stimulus in stimuli],
            "same_apparent": [stimulus in apparent for stimulus in stimuli],
            "c": c,
            "d": d,
            "distance": space.distance(reference, paints),
        }
    )
    remarks = [
        f"No paint of rho_d = {rho_d:g} is as glossy as the reference: it would reflect more than it receives. Its "
        "place in the lower row stays empty."
        for rho_d in missing
    ]
    return AppliedSet(wanted, table, space, reference, (*remarks, *range_remarks(wanted, space)))
