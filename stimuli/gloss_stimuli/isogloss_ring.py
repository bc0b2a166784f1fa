"""The ring of figure 11 of the gloss paper: a reference sphere, and spheres at equal gloss distances from it."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from gloss_stimuli.applied_set import AppliedSet, range_remarks, rounded_stimulus, space_label
from gloss_stimuli.sets import StimulusList
from glossspace.errors import GlossError
from glossspace.metric import PAPER_SPACE, GlossSpace, IsoglossContour, Paint, isogloss_contour
from glossspace.stimulus_set import Stimulus

__all__ = ["PAPER_RADII", "PAPER_REFERENCE", "RING", "isogloss_ring"]

RING = "ring"
"""The name of its set and its figure."""

PAPER_REFERENCE = Paint(0.193, 0.066, 0.07)
"""The reference of figure 11: c = .087, d = .93."""

PAPER_RADII = (0.04, 0.08)
"""The gloss distances of its two contours."""


def isogloss_ring(
    space: GlossSpace = PAPER_SPACE,
    *,
    reference: Paint = PAPER_REFERENCE,
    radii: Sequence[float] = PAPER_RADII,
    n: int = 8,
) -> AppliedSet:
    """Paints of the reference's lightness on isogloss contours round it (section 5.1 of the gloss paper).

    Parameters
    ----------
    space : GlossSpace
    reference : Paint
        One paint (rho_d, rho_s, alpha).
    radii : sequence of float
        Gloss distances of the contours in the units of `space`, > 0 and different.
    n : int
        Points on each contour, 3 or more, at equal angles from that of more c alone. With a multiple of 4, points
        mirrored at the axis of c share their roughness, and so the costly part of their rendering.

    Returns
    -------
    AppliedSet
        The set `ring`: the reference first, then each contour. The table also holds `radius` and `angle_deg` (0
        towards more c, 90 towards more d); 0 and NaN for the reference. Points that no paint reaches are left out, and
        the remarks name them.

    Raises
    ------
    GlossError
        A parameter is impossible, two contours are the same, or no point of any contour is a paint.

    Examples
    --------
    >>> ring = isogloss_ring(n=4)
    >>> len(ring.stimuli.stimuli)
    9
    >>> ring.table["distance"].round(3).tolist()
    [0.0, 0.04, 0.04, 0.04, 0.04, 0.08, 0.08, 0.08, 0.08]
    """
    radii = [float(radius) for radius in radii]
    if not radii or len(set(radii)) < len(radii):
        raise GlossError(f"Invalid radii {radii}. Allowed: one gloss distance or several different ones, all > 0.")
    contours = [isogloss_contour(reference, radius=radius, n=n, space=space) for radius in radii]
    rows: list[tuple[Stimulus, float, float]] = [(Stimulus.of(*map(float, reference)), 0.0, float("nan"))]
    for radius, contour in zip(radii, contours, strict=True):
        for point in np.flatnonzero(contour.reachable):
            stimulus = rounded_stimulus(contour.rho_d, float(contour.rho_s[point]), float(contour.alpha[point]))
            rows.append((stimulus, radius, float(contour.angle_deg[point])))
    if len(rows) == 1:
        raise GlossError(
            f"No paint of rho_d = {contours[0].rho_d:g} lies at gloss distance {_listed(radii)} from the reference. "
            "Choose smaller radii or another reference."
        )
    stimuli, radius_of, angle_deg = zip(*rows, strict=True)
    title = f"Gloss distances {_listed(radii)} from {stimuli[0].name}, in the space: {space_label(space)}"
    wanted = StimulusList(RING, title, tuple(stimuli))
    paints = Paint(*np.array([(s.rho_d, s.rho_s, s.alpha) for s in stimuli]).T)
    c, d = space.coordinates(paints)
    table = pd.DataFrame(
        {
            "stimulus": [stimulus.name for stimulus in stimuli],
            **paints._asdict(),
            "radius": radius_of,
            "angle_deg": angle_deg,
            "c": c,
            "d": d,
            "distance": space.distance(reference, paints),
        }
    )
    remarks = (*_left_out(radii, contours), *range_remarks(wanted, space))
    return AppliedSet(wanted, table, space, reference, remarks)


def _left_out(radii: Sequence[float], contours: Sequence[IsoglossContour]) -> list[str]:
    places = [
        f"{angle:g}° at {radius:g}"
        for radius, contour in zip(radii, contours, strict=True)
        for angle in contour.angle_deg[~contour.reachable]
    ]
    if not places:
        return []
    total = sum(len(contour.c) for contour in contours)
    return [
        f"{len(places)} of {total} points are left out, since no paint of rho_d = {contours[0].rho_d:g} reaches them: "
        f"{', '.join(places)}."
    ]


def _listed(values: Sequence[float]) -> str:
    return ", ".join(f"{value:g}" for value in values)
