"""A button on the screen: pressed with the mouse, or marked and pressed with a key."""

from typing import Any

from gloss_experiments.window.layout import button_size_px
from gloss_experiments.window.stage import BUTTON_GRAY, LINE_GRAY, MARKER_GRAY, Stage

__all__ = ["Button"]


class Button:
    """A button about `place`; it counts as clicked where the mouse was pressed on it and has been let go on it."""

    def __init__(self, stage: Stage, text: str, place: tuple[int, int], *, size: tuple[int, int] | None = None) -> None:
        self._stage = stage
        size = size or button_size_px(stage.protocol.texts.size_px)
        self._box: Any = stage.box(place, size, fill=BUTTON_GRAY)
        self._text = stage.text(text, place)
        self._pressed = False

    def draw(self, *, marked: bool = False) -> None:
        """Draw it; a `marked` one has a brighter outline."""
        self._box.lineColor = (MARKER_GRAY if marked else LINE_GRAY,) * 3
        self._box.draw()
        self._text.draw()

    def clicked(self) -> bool:
        """Whether the mouse has just been let go on it, having been pressed on it. Ask once a frame."""
        left, on_it = self._stage.left_button, bool(self._box.contains(self._stage.pointer))
        if left.just_pressed:
            self._pressed = on_it
        clicked = self._pressed and left.just_released and on_it
        if left.just_released:
            self._pressed = False
        return clicked

    def forget(self) -> None:
        """A press that has begun counts no more."""
        self._pressed = False
