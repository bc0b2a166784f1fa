"""How large an image appears: viewing distance and pixel pitch to visual angle, and to a whole, even pixel size."""

import math
from dataclasses import dataclass
from typing import Any

from glossspace.errors import GlossError

__all__ = ["ViewingGeometry", "angle_of_width_deg", "round_even", "width_of_angle_cm"]


def width_of_angle_cm(angle_deg: float, *, distance_cm: float) -> float:
    """Width on a flat screen that appears `angle_deg` wide, straight ahead: ``2 · distance · tan(angle / 2)``.

    Examples
    --------
    >>> round(width_of_angle_cm(3.2, distance_cm=152.4), 3)  # the gloss paper's images, 60 inches away
    8.514
    """
    return 2 * distance_cm * math.tan(math.radians(angle_deg) / 2)


def angle_of_width_deg(width_cm: float, *, distance_cm: float) -> float:
    """Visual angle of a width on a flat screen, straight ahead: the inverse of `width_of_angle_cm`.

    Examples
    --------
    >>> round(angle_of_width_deg(8.514, distance_cm=152.4), 2)
    3.2
    """
    return math.degrees(2 * math.atan(width_cm / 2 / distance_cm))


def round_even(pixels: float) -> int:
    """Nearest even number of pixels, at least 2: a screen centers an even image without resampling it.

    Examples
    --------
    >>> round_even(315.9), round_even(317.0)
    (316, 318)
    """
    return max(2, 2 * math.floor(pixels / 2 + 0.5))


@dataclass(frozen=True, kw_only=True)
class ViewingGeometry:
    """Where the observer sits and how wide an image shall appear.

    Attributes
    ----------
    distance_cm : float
        From the eye to the screen.
    image_width_deg : float
        Wanted visual angle of an image's width.
    pixel_pitch_mm : float, optional
        Distance between the centers of neighbouring pixels; without it nothing is known about pixels.

    Raises
    ------
    GlossError
        A number is out of range.

    Examples
    --------
    >>> viewing = ViewingGeometry(distance_cm=152.4, image_width_deg=3.2, pixel_pitch_mm=0.2695)
    >>> viewing.native_width_px, round(viewing.angle_of_pixels_deg(316), 3)
    (316, 3.201)
    """

    distance_cm: float
    image_width_deg: float
    pixel_pitch_mm: float | None = None

    def __post_init__(self) -> None:
        for name in ("distance_cm", "pixel_pitch_mm"):
            value = getattr(self, name)
            if value is not None and not 0 < value < math.inf:
                raise GlossError(f"{name} must be a finite number above 0, but is {value}.")
        if not 0 < self.image_width_deg < 120:
            raise GlossError(f"image_width_deg must lie between 0 and 120 degrees, but is {self.image_width_deg}.")

    @property
    def image_width_cm(self) -> float:
        """Width on the screen that has the wanted angle."""
        return width_of_angle_cm(self.image_width_deg, distance_cm=self.distance_cm)

    @property
    def native_width_px(self) -> int | None:
        """Even number of pixels whose angle comes nearest to the wanted one; None where the pitch is not known."""
        if self.pixel_pitch_mm is None:
            return None
        return round_even(10 * self.image_width_cm / self.pixel_pitch_mm)

    def angle_of_pixels_deg(self, pixels: float) -> float:
        """Visual angle that this many pixels side by side really reach.

        Raises
        ------
        GlossError
            The pixel pitch is not known.
        """
        if self.pixel_pitch_mm is None:
            raise GlossError(
                "The visual angle of pixels is not known without pixel_pitch_mm. State it under [viewing]."
            )
        return angle_of_width_deg(pixels * self.pixel_pitch_mm / 10, distance_cm=self.distance_cm)

    def to_dict(self, *, image_width_px: int) -> dict[str, Any]:
        """The viewing section of a manifest, for images of this width.

        Where the pixel pitch is known, ``native_width_px`` is the even width that comes nearest to the wanted angle and
        ``native_width_deg`` what it reaches; ``rendered_width_deg`` is what these images reach, drawn pixel for pixel.
        """
        known: dict[str, Any] = {
            "distance_cm": self.distance_cm,
            "image_width_deg": self.image_width_deg,
            "image_width_cm": self.image_width_cm,
        }
        native = self.native_width_px
        if native is not None:
            known |= {
                "pixel_pitch_mm": self.pixel_pitch_mm,
                "native_width_px": native,
                "native_width_deg": self.angle_of_pixels_deg(native),
                "rendered_width_deg": self.angle_of_pixels_deg(image_width_px),
            }
        return known
