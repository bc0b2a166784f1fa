"""Hypotheses about a gloss axis: named functions of the stimuli, which `hypotheses` compares.

The gloss paper (3.3.4) tested three for contrast gloss. The luminance ratio of the reflected patches fitted the ratings
poorly, the difference of their lightness well but not the pairs with large alpha, the form in object space both. For
distinctness of image it tested one; others that the field uses stand beside it here.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from glossspace.errors import GlossError
from glossspace.metric import contrast_gloss, distinctness

__all__ = [
    "HYPOTHESES",
    "HYPOTHESES_C",
    "HYPOTHESES_D",
    "HYPOTHESIS_C",
    "HYPOTHESIS_D",
    "Axis",
    "Hypothesis",
    "with_values",
]

Axis: TypeAlias = Literal["c", "d"]

# Squares of larger numbers, and of smaller than their inverse, come near what a number can hold.
_LARGEST = 1e100


@dataclass(frozen=True)
class Hypothesis:
    """A named function of the stimuli that may be a gloss axis.

    Attributes
    ----------
    name : str
    axis : {"c", "d"}
        The axis that it is meant to be.
    function : callable
        Takes a DataFrame with one row a stimulus, whose columns are those of a stimulus set's table and measurements,
        and returns one number a row. Its unit is free: ratings are regressed on it, and pairs weigh it.

    Examples
    --------
    >>> energy = Hypothesis("specular energy", "c", lambda stimuli: stimuli["rho_s"])
    >>> energy.values(pd.DataFrame({"stimulus": ["a", "b"], "rho_s": [0.033, 0.099]})).tolist()
    [0.033, 0.099]
    """

    name: str
    axis: Axis
    function: Callable[[pd.DataFrame], ArrayLike]

    def values(self, stimuli: pd.DataFrame) -> np.ndarray:
        """Value of each stimulus, shape (n,).

        Raises
        ------
        GlossError
            A column is missing, or the values are not one finite number a stimulus, or too large or small to square.
        """
        try:
            with np.errstate(all="ignore"):  # what is not finite is refused below, with the stimulus's name
                values = np.asarray(self.function(stimuli), dtype=float)
        except KeyError as error:
            raise GlossError(
                f"The hypothesis {self.name!r} needs the column {error.args[0]}, which the stimuli lack; they have "
                f"{', '.join(map(str, stimuli.columns))}. Columns of measured luminance are in `measurements.csv` "
                "beside the images: merge them on `stimulus`."
            ) from None
        if values.shape != (len(stimuli),):
            raise GlossError(
                f"The hypothesis {self.name!r} gives values of shape {values.shape} for {len(stimuli)} stimuli; its "
                "function must return one number for each row."
            )
        if not np.all(np.isfinite(values)):
            lacking = stimuli["stimulus"].to_numpy()[~np.isfinite(values)]
            raise GlossError(
                f"The hypothesis {self.name!r} gives no finite number for the stimulus {lacking[0]} ({len(lacking)} "
                "such). Leave these stimuli out, or measure them."
            )
        largest = np.abs(values).max(initial=0.0)
        if largest > _LARGEST or 0 < largest < 1 / _LARGEST:
            raise GlossError(
                f"The hypothesis {self.name!r} gives numbers up to {largest:g} in size. Allowed: from "
                f"{1 / _LARGEST:g} to {_LARGEST:g}, or 0. Choose another unit, which changes nothing else."
            )
        return values


HYPOTHESIS_C = Hypothesis("object space", "c", lambda stimuli: contrast_gloss(stimuli["rho_d"], stimuli["rho_s"]))
"""The gloss paper's answer for contrast gloss, eq. 4."""

HYPOTHESES_C = (
    Hypothesis("luminance ratio", "c", lambda stimuli: stimuli["displayed_luminance_ratio"]),
    Hypothesis("lightness difference", "c", lambda stimuli: stimuli["displayed_lightness_difference"]),
    HYPOTHESIS_C,
)
"""The gloss paper's three hypotheses for contrast gloss.

The first two are of the patches that a light and a dark check reflect, as measured on the screen; the third is eq. 4.
"""

HYPOTHESIS_D = Hypothesis("1 - alpha", "d", lambda stimuli: distinctness(stimuli["alpha"]))
"""The gloss paper's hypothesis for distinctness of image, eq. 3."""

HYPOTHESES_D = (
    HYPOTHESIS_D,
    Hypothesis("1 - sqrt(alpha)", "d", lambda stimuli: 1 - np.sqrt(stimuli["alpha"])),
    Hypothesis("-log(alpha)", "d", lambda stimuli: -np.log(stimuli["alpha"])),
    Hypothesis("1/alpha", "d", lambda stimuli: 1 / stimuli["alpha"]),
    Hypothesis("edge width", "d", lambda stimuli: -stimuli["displayed_edge_width_visual_deg"]),
)
"""Hypotheses for distinctness of image, all rising with it.

Eq. 3 of the gloss paper; the square root that Burley (2012, Physically-based shading at Disney, section 5.4) found the
more perceptually linear control of roughness; Fechner's law, equal steps for equal ratios of roughness; the inverse
width of the lobe; and minus the width of a reflected edge as measured in the displayed image, the counterpart in image
space of the two for contrast gloss.
"""

HYPOTHESES: dict[Axis, tuple[Hypothesis, ...]] = {"c": HYPOTHESES_C, "d": HYPOTHESES_D}
"""What is known for each axis."""


def with_values(hypotheses: Sequence[Hypothesis], stimuli: pd.DataFrame) -> tuple[list[Hypothesis], dict[str, str]]:
    """Those hypotheses that have a value for every stimulus, and why each of the others has not.

    Examples
    --------
    >>> known, skipped = with_values(HYPOTHESES_D, pd.DataFrame({"stimulus": ["a", "b"], "alpha": [0.04, 0.1]}))
    >>> [hypothesis.name for hypothesis in known]
    ['1 - alpha', '1 - sqrt(alpha)', '-log(alpha)', '1/alpha']
    >>> list(skipped)
    ['edge width']
    """
    usable, skipped = [], {}
    for hypothesis in hypotheses:
        try:
            hypothesis.values(stimuli)
            usable.append(hypothesis)
        except GlossError as error:
            skipped[hypothesis.name] = str(error)
    return usable, skipped
