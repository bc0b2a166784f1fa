"""The gamma table (LUT) of the video card: read, compared with identity, and set back to it.

Images are encoded for the display, so nothing behind them may correct gamma again: the table must be identity. A
program that was killed leaves its table in the card, and the next window inherits it without a word.
"""

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from glossspace.errors import GlossError

__all__ = ["GammaTable", "monitor_gamma", "read_gamma_table", "reset_gamma_table"]

# Below half a code value every 8-bit code comes out as itself.
_LARGEST_DEVIATION_CODES = 0.5
_CODES = 255


@dataclass(frozen=True)
class GammaTable:
    """The table of a video card, as read.

    Attributes
    ----------
    values : ndarray, shape (3, n)
        What red, green and blue of each of n inputs are turned into, 0 to 1.
    """

    values: NDArray[np.float64]

    @property
    def deviation_codes(self) -> float:
        """Largest deviation from identity, in 8-bit code values.

        Systems write identity in three ways, n entries from 0 to 1, from 1/n to 1, or from 0 to (n - 1)/n: the nearest
        one counts.

        Examples
        --------
        >>> GammaTable(np.tile(np.linspace(0, 1, 256), (3, 1))).deviation_codes
        0.0
        >>> GammaTable(np.tile(np.linspace(0, 1, 256) ** (1 / 2.2), (3, 1))).deviation_codes > 70
        True
        """
        n = self.values.shape[1]
        identities = (np.linspace(0, 1, n), np.arange(1, n + 1) / n, np.arange(n) / n)
        return float(min(np.abs(self.values - identity).max() for identity in identities) * _CODES)

    @property
    def is_identity(self) -> bool:
        """Whether every 8-bit code value comes out as itself."""
        return self.deviation_codes < _LARGEST_DEVIATION_CODES


def read_gamma_table(window: Any) -> GammaTable | str:
    """Read the gamma table of the screen that a PsychoPy window is on.

    Returns
    -------
    GammaTable or str
        The table; or, where the system does not give one, why not. A virtual display such as Xvfb has none.
    """
    try:
        ramp = window.backend.getGammaRamp()
    except OSError as error:
        # PsychoPy names the system's function in its long advice.
        function = re.search(r"\((\w+)\) failed", str(error))
        return f"{function[1]} failed" if function else str(error).split(". ")[0].strip() or "the system refuses"
    except Exception as error:  # of a back end that knows no table
        return f"{type(error).__name__}: {error}"
    if ramp is None:
        return "PsychoPy takes this for a virtual machine"
    values = np.asarray(ramp, dtype=float)
    if values.ndim != 2 or values.shape[0] != 3 or values.shape[1] < 2:
        return f"the system gave a table of shape {values.shape}"
    if not np.isfinite(values).all() or values.min() < 0 or values.max() > 1:
        return f"the system gave values from {values.min():g} to {values.max():g}, not 0 to 1"
    return GammaTable(values)


def monitor_gamma(window: Any) -> tuple[float, ...] | None:
    """The gamma that a PsychoPy window was told to correct, by itself or by its Monitor; None if it corrects none."""
    for gamma in (getattr(window, "gamma", None), window.monitor.getGamma()):
        if gamma is None:
            continue
        values = np.atleast_1d(np.asarray(gamma, dtype=float)).ravel()
        if (values != 1).any():
            return tuple(values.tolist())
    grid = window.monitor.getGammaGrid()
    if grid is not None:
        gammas = np.atleast_2d(np.asarray(grid, dtype=float))[:, 2]
        if (gammas != 1).any():
            return tuple(gammas.tolist())
    return None


def reset_gamma_table(window: Any) -> GammaTable:
    """Set the gamma table to identity and read it back.

    Raises
    ------
    GlossError
        The system does not let it be read or set.
    """
    before = read_gamma_table(window)
    if isinstance(before, str):
        raise GlossError(f"The gamma table of the video card cannot be read ({before}), so it cannot be set.")
    from psychopy.visual.backends.gamma import setGammaRamp

    backend = window.backend
    identity = np.tile(np.linspace(0, 1, before.values.shape[1]), (3, 1))
    try:
        # Not through the window, which would put the old table back when it closes.
        setGammaRamp(backend.screenID, identity, xDisplay=backend.xDisplay, gammaErrorPolicy="raise")
    except OSError as error:
        raise GlossError(f"The gamma table of the video card cannot be set: {error}") from None
    after = read_gamma_table(window)
    if isinstance(after, str) or not after.is_identity:
        raise GlossError(
            "The gamma table of the video card did not take identity. Switch off night light and colour management."
        )
    return after
