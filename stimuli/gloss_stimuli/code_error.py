"""How far an image may be from the truth, in 8-bit code values, from the scatter of independent randomisations."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.tone import ToneCurve
from glossspace.display import DisplayModel

__all__ = ["CodeError", "code_error"]

# Pixels of equal share that stand for the whole image; the last holds the worst 1/8192, well beyond 99.9 %.
QUANTILES = 8192


@dataclass(frozen=True)
class CodeError:
    """Estimated distribution over the pixels of the error, in code values before rounding.

    Attributes
    ----------
    sigmas : array, shape (Q,)
        Standard deviations of the error, each of an equal share of the pixels, ascending.
    shares : array, shape (Q,)
        The share of the pixels that each stands for; they add to 1.
    """

    sigmas: NDArray[np.float64]
    shares: NDArray[np.float64]

    def within(self, limit: float) -> float:
        """Fraction of the pixels whose error is expected to stay below `limit` code values."""
        from scipy.special import erf

        return float(self.shares @ erf(limit / (np.sqrt(2) * self.sigmas)))

    def percentile(self, fraction: float) -> float:
        """Error, in code values, that this fraction of the pixels is expected to stay below."""
        from scipy.optimize import brentq

        return float(brentq(lambda limit: self.within(limit) - fraction, 0.0, 10 * self.sigmas[-1], xtol=1e-6))

    def to_dict(self) -> dict[str, float]:
        """The figures of a manifest, rounded to what an estimate can know."""
        figures = {
            "median": self.percentile(0.5),
            "percentile_99": self.percentile(0.99),
            "percentile_99_9": self.percentile(0.999),
            "fraction_within_half_code": self.within(0.5),
        }
        return {key: float(f"{value:.4g}") for key, value in figures.items()}


def code_error(
    luminance: NDArray[np.float64], spread: NDArray[np.float64], *, tone: ToneCurve, display: DisplayModel
) -> CodeError:
    """Error estimate of an image.

    Each pixel's error is taken as normal with the variance of its 3 × 3 neighbourhood: a handful of randomisations
    know a single pixel's variance badly, and it changes slowly.

    Parameters
    ----------
    luminance, spread : array, shape (H, W)
        Scene luminance and the standard deviation of its error (cd/m²). The sign of `spread` is of no account.
    tone, display
        What turns it into code values.
    """
    from scipy.ndimage import uniform_filter

    def codes(value: NDArray[np.float64]) -> NDArray[np.float64]:
        return display.exact_codes(display.white_cd_m2 * tone(np.maximum(value, 0.0)))

    # A secant over one standard deviation each side, since the curve is steep near black.
    sigma = (codes(luminance + spread) - codes(luminance - spread)) / 2
    # Shared with neighbours in code values: in luminance a bright check would lend its scatter to the dark one beside.
    sigma = np.sqrt(np.maximum(uniform_filter(sigma**2, 3, mode="nearest"), 0.0))
    ordered = np.sort(sigma, axis=None)
    edges = np.linspace(0, ordered.size, min(QUANTILES, ordered.size) + 1).astype(int)
    counts = np.diff(edges)
    # At least 1e-9 codes, so that a noiseless image divides by something.
    sigmas = np.maximum(np.add.reduceat(ordered, edges[:-1]) / counts, 1e-9)
    return CodeError(sigmas, counts / ordered.size)
