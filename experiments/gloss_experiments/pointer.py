"""A scripted mouse: it stands in for the real one, so that a simulated observer goes through the real window."""

from collections.abc import Iterator
from typing import Protocol

from gloss_experiments.layout import Layout

__all__ = ["Pointer", "ScriptedPointer", "slider_x"]


class Pointer(Protocol):
    """What the screen asks of a mouse; PsychoPy's own has it too."""

    units: str

    def getPos(self) -> tuple[float, float]:
        """Position in pixels from the centre of the window."""

    def getPressed(self) -> list[bool]:
        """Whether the left, middle and right buttons are down."""


def slider_x(rating: int, layout: Layout) -> float:
    """Horizontal position of a rating on the slider, in pixels from the centre of the window."""
    x, width = layout.slider[0], layout.slider_size[0]
    return x + width * (rating / 100 - 0.5)


class ScriptedPointer:
    """A mouse that rates and confirms one trial at a time, as a hand would: go there, press, let go, frame by frame."""

    units = "pix"

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self._place: tuple[float, float] = (0.0, 0.0)
        self._down = False
        self._steps: Iterator[tuple[tuple[float, float], bool]] = iter(())

    def rate(self, rating: int) -> None:
        """Begin the movements that set `rating` and confirm it."""
        on_slider = (slider_x(rating, self._layout), float(self._layout.slider[1]))
        on_button = (float(self._layout.button[0]), float(self._layout.button[1]))
        self._steps = iter(
            [(on_slider, False), (on_slider, True), (on_slider, False), (on_button, True), (on_button, False)]
        )

    def tick(self) -> None:
        """One frame on."""
        self._place, self._down = next(self._steps, (self._place, False))

    def getPos(self) -> tuple[float, float]:
        """Where the pointer is now."""
        return self._place

    def getPressed(self) -> list[bool]:
        """The left button as scripted; the others are never down."""
        return [self._down, False, False]
