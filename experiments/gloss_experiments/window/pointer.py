"""The pointer: its left button as the screens take it, and a scripted mouse that stands in for a hand."""

from collections.abc import Iterable, Iterator
from typing import Protocol

from gloss_experiments.window.layout import Layout

__all__ = ["LeftButton", "Pointer", "ScriptedPointer", "Step", "click_steps", "drag_steps", "rating_steps", "slider_x"]

Step = tuple[tuple[float, float], bool]
"""Where a scripted pointer is in one frame, and whether its left button is down."""


class Pointer(Protocol):
    """What the screen asks of a mouse; PsychoPy's own has it too."""

    units: str

    def getPos(self) -> tuple[float, float]:
        """Position in pixels from the centre of the window."""

    def getPressed(self) -> list[bool]:
        """Whether the left, middle and right buttons are down."""


class LeftButton:
    """The left button as it counts: a press that began before this screen, or this trial, must come up first.

    Attributes
    ----------
    armed
        Whether it has been up since `rearm`.
    down, just_pressed, just_released
        As of the last `look`; False until it is armed.
    """

    def __init__(self, pointer: Pointer) -> None:
        self._pointer = pointer
        self.rearm()

    def rearm(self) -> None:
        """What is held now counts for nothing."""
        self.armed = self.down = self.just_pressed = self.just_released = False

    def look(self) -> None:
        """Look at the button; once a frame."""
        down = bool(self._pointer.getPressed()[0])
        self.armed = self.armed or not down
        down = down and self.armed
        self.just_pressed, self.just_released = down and not self.down, self.down and not down
        self.down = down


def slider_x(rating: int, layout: Layout) -> float:
    """Horizontal position of a rating on the slider, in pixels from the centre of the window."""
    x, width = layout.slider[0], layout.slider_size[0]
    return x + width * (rating / 100 - 0.5)


def rating_steps(rating: int, layout: Layout) -> list[Step]:
    """The movements that set `rating` and confirm it, as a hand would: go there, press, let go, frame by frame."""
    on_slider = (slider_x(rating, layout), float(layout.slider[1]))
    return [(on_slider, False), (on_slider, True), (on_slider, False), *click_steps(layout.button)]


def click_steps(place: tuple[float, float]) -> list[Step]:
    """A click at `place`."""
    return [(place, False), (place, True), (place, False)]


def drag_steps(start: tuple[float, float], end: tuple[float, float]) -> list[Step]:
    """The movements that drag what lies at `start` to `end`."""
    halfway = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
    return [(start, False), (start, True), (halfway, True), (end, True), (end, False)]


class ScriptedPointer:
    """A mouse that moves as it is told, one step a frame; after the last step it stays where it is."""

    units = "pix"

    def __init__(self) -> None:
        self._place: tuple[float, float] = (0.0, 0.0)
        self._down = False
        self._steps: Iterator[Step] = iter(())

    def perform(self, steps: Iterable[Step]) -> None:
        """Begin these steps, and forget any others."""
        self._steps = iter(steps)

    def tick(self) -> None:
        """One frame on."""
        self._place, self._down = next(self._steps, (self._place, False))

    def getPos(self) -> tuple[float, float]:
        """Where the pointer is now."""
        return self._place

    def getPressed(self) -> list[bool]:
        """The left button as scripted; the others are never down."""
        return [self._down, False, False]
