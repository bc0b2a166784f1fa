"""A calibrated display: luminance to code values and back."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["DisplayModel"]


@dataclass(frozen=True, kw_only=True)
class DisplayModel:
    """Display whose luminance is ``black + (white - black) (code / 255)^gamma``.

    The default is the monitor of the gloss paper (3.2.3.2): 0.7 to 108 cd/m² with a gamma of 2.35.

    Attributes
    ----------
    black_cd_m2, white_cd_m2 : float
        Luminance of the smallest and the largest code value.
    gamma : float
        Exponent of the curve between them.

    Examples
    --------
    >>> display = DisplayModel()
    >>> display.codes([0.7, 108.0]).tolist()
    [0, 255]
    """

    black_cd_m2: float = 0.7
    white_cd_m2: float = 108.0
    gamma: float = 2.35

    LARGEST_CODE = 255

    @property
    def contrast(self) -> float:
        """White over black luminance."""
        return self.white_cd_m2 / self.black_cd_m2

    def exact_codes(self, luminance_cd_m2: ArrayLike) -> NDArray[np.float64]:
        """Code values before rounding, for display luminance in cd/m² (any shape); clipped to the display's range."""
        luminance = np.asarray(luminance_cd_m2, dtype=float)
        share = (luminance - self.black_cd_m2) / (self.white_cd_m2 - self.black_cd_m2)
        return self.LARGEST_CODE * np.clip(share, 0.0, 1.0) ** (1 / self.gamma)

    def codes(self, luminance_cd_m2: ArrayLike) -> NDArray[np.uint8]:
        """Nearest 8-bit code values; no dither, so that equal luminances stay equal."""
        return np.floor(self.exact_codes(luminance_cd_m2) + 0.5).astype(np.uint8)

    def luminance(self, codes: ArrayLike) -> NDArray[np.float64]:
        """Displayed luminance (cd/m²) of code values."""
        share = np.asarray(codes, dtype=float) / self.LARGEST_CODE
        return self.black_cd_m2 + (self.white_cd_m2 - self.black_cd_m2) * share**self.gamma

    def to_dict(self) -> dict[str, Any]:
        """Parameters as JSON takes them."""
        return {**asdict(self), "bits": 8}
