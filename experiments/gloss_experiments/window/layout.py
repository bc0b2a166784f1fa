"""Where everything stands on the screen, in whole pixels from its centre: pure arithmetic, no window."""

from dataclasses import dataclass
from math import atan, degrees

from gloss_experiments.protocol import Protocol
from glossspace.errors import GlossError

__all__ = [
    "Layout",
    "arrange",
    "button_size_px",
    "refuse_odd_size",
    "round_even",
    "visual_angle_deg",
]


@dataclass(frozen=True)
class Layout:
    """Centres ``(x, y)`` in pixels from the centre of the window, y upwards."""

    images: tuple[tuple[int, int], ...]
    question: tuple[int, int]
    slider: tuple[int, int]
    labels: tuple[tuple[int, int], tuple[int, int]]
    readout: tuple[int, int]
    button: tuple[int, int]
    button_size: tuple[int, int]
    slider_size: tuple[int, int]


def round_even(value: float) -> int:
    """The even whole number nearest to `value`: an image of even size about a whole pixel covers whole pixels."""
    return 2 * round(value / 2)


def visual_angle_deg(size_px: int, *, pixel_pitch_mm: float, distance_cm: float) -> float:
    """Visual angle of `size_px` pixels seen from `distance_cm`.

    Examples
    --------
    >>> round(visual_angle_deg(316, pixel_pitch_mm=0.2695, distance_cm=152.4), 2)  # 8.514 cm at 60 inches
    3.2
    """
    return degrees(2 * atan(size_px * pixel_pitch_mm / 10 / 2 / distance_cm))


def button_size_px(text_size_px: int) -> tuple[int, int]:
    """Width and height of a button for texts of this size, both even.

    Examples
    --------
    >>> button_size_px(24)
    (192, 46)
    """
    return round_even(8 * text_size_px), round_even(1.9 * text_size_px)


def refuse_odd_size(image_size_px: tuple[int, int]) -> None:
    """Refuse images that cannot cover whole pixels about a whole pixel.

    Raises
    ------
    GlossError
        Width or height is odd.
    """
    width, height = image_size_px
    if width % 2 or height % 2:
        raise GlossError(
            f"The images are {width} x {height} pixels; both must be even, or the screen blends neighbouring pixels. "
            "Render the set again with an even --size."
        )


def arrange(protocol: Protocol, *, image_size_px: tuple[int, int], window_size_px: tuple[int, int]) -> Layout:
    """Lay out a trial: one or two images, and below them slider, labels, readout and button, together centred.

    Raises
    ------
    GlossError
        It does not fit into the window, or the image has an odd size.
    """
    refuse_odd_size(image_size_px)
    width, height = image_size_px
    line = round_even(1.6 * protocol.texts.size_px)
    gap = round_even(protocol.display.gap_deg / protocol.display.image_width_deg * width)
    n_images = 2 if protocol.kind == "pairwise" else 1
    button_size = button_size_px(protocol.texts.size_px)
    needed = (
        max(n_images * width + (n_images - 1) * gap, protocol.slider.width_px + 2 * line),
        line + height + 6 * line + button_size[1],
    )
    if needed[0] > window_size_px[0] or needed[1] > window_size_px[1]:
        raise GlossError(
            f"The trial needs {needed[0]} x {needed[1]} pixels, but the window has {window_size_px[0]} x "
            f"{window_size_px[1]}. Use a larger screen, or render the stimuli smaller (gloss render --size)."
        )
    top = needed[1] // 2
    image_y = top - 2 * line - height // 2
    slider_y = image_y - height // 2 - 2 * line
    half = (width + gap) // 2
    return Layout(
        images=((-half, image_y), (half, image_y)) if n_images == 2 else ((0, image_y),),
        question=(0, top - line // 2),
        slider=(0, slider_y),
        labels=((-protocol.slider.width_px // 2, slider_y - line), (protocol.slider.width_px // 2, slider_y - line)),
        readout=(0, slider_y - line),
        button=(0, slider_y - 2 * line - button_size[1] // 2),
        button_size=button_size,
        slider_size=(protocol.slider.width_px, max(12, round_even(0.7 * protocol.texts.size_px))),
    )
