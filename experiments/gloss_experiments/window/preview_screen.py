"""The preview: all stimuli at once, or page by page, so that an observer knows their range before judging."""

from collections.abc import Mapping, Sequence
from math import ceil
from pathlib import Path

from gloss_experiments.session.state import Continued, Event, SessionState
from gloss_experiments.window.grid import Grid, largest_grid
from gloss_experiments.window.layout import refuse_odd_size
from gloss_experiments.window.quit_question import wants_to_stop
from gloss_experiments.window.stage import LINE_GRAY, Stage
from gloss_experiments.window.thumbnails import thumbnail

__all__ = ["PreviewScreen", "preview_grid"]

# A page's pictures are at least this wide, or as the images are: smaller ones would not show what gloss is like.
SMALLEST_PICTURE_PX = 96
GAP_PX = 16


def preview_grid(n: int, *, image_size: tuple[int, int], area: tuple[int, int]) -> Grid:
    """The grid of one page: that of all `n` pictures, or of as many as are still large enough.

    Parameters
    ----------
    n
        Pictures in all, at least 1.
    image_size, area
        Width and height in pixels.

    Examples
    --------
    >>> preview_grid(27, image_size=(512, 512), area=(1200, 800)).n
    27
    >>> preview_grid(500, image_size=(512, 512), area=(1200, 800)).n  # on each of eight pages
    63
    """
    for pages in range(1, n + 1):
        on_page = ceil(n / pages)
        grid = largest_grid(on_page, image_size=image_size, area=area, gap=GAP_PX, smallest_px=SMALLEST_PICTURE_PX)
        if grid is not None:
            return grid
    return Grid(1, 1, image_size, GAP_PX, 1)  # an image as large as the window: one at a time


class PreviewScreen:
    """Shows the range of stimuli until the observer goes on.

    Pictures stand at their own size where all of them fit; else they are smaller, and their size in per cent stands
    below. They lie in the order in which the trials first show them, which is random: sorted by their parameters they
    would tell the observer which dimensions there are.

    Parameters
    ----------
    stage
        The window and what belongs to it.
    paths
        Image of each stimulus.
    image_size
        Width and height in pixels, of all of them.
    """

    def __init__(self, stage: Stage, paths: Mapping[str, Path], image_size: tuple[int, int]) -> None:
        refuse_odd_size(image_size)
        self._stage = stage
        line = stage.line_px
        self._text = stage.text(stage.protocol.texts.preview, (0, stage.size[1] // 2 - line // 2), vertical="top")
        text_height = 2 * ceil(float(self._text.boundingBox[1]) / 2)
        # Text above; the remark of a simulated session and the size in per cent below.
        self._area = (stage.size[0] - 2 * line, stage.size[1] - text_height - 2 * line - 2 * line)
        self.grid = preview_grid(len(paths), image_size=image_size, area=self._area)
        centre = (0, 2 * round((line - text_height) / 4))
        self.places = self.grid.places(centre, centred=True)
        self._pictures = {name: stage.picture(thumbnail(path, self.grid.picture_size)) for name, path in paths.items()}
        bottom = -stage.size[1] // 2 + stage.protocol.texts.size_px
        right = (stage.size[0] // 2 - line, bottom)
        percent = f"{100 * self.grid.picture_size[0] / image_size[0]:.0f} %"
        self._size_note = stage.text(
            "" if self.grid.picture_size == image_size else percent, right, gray=LINE_GRAY, anchor="right", scale=0.75
        )
        self._page_note = stage.text("", (-right[0], bottom), gray=LINE_GRAY, anchor="left", scale=0.75)
        self._page = 0

    def event(self, state: SessionState) -> Event | None:
        """Show page after page until the observer goes on; None to stop the session here."""
        self._page = 0
        self._stage.begin_anew()
        while True:
            self.draw(state)
            self._stage.flip()
            for key in self._stage.pressed_keys():
                if key == "escape" and wants_to_stop(self._stage):
                    return None
                if key == "left":
                    self._page = max(self._page - 1, 0)
                if key in ("space", "right", "return"):
                    if self._page < len(self._pages(state)) - 1:
                        self._page += 1
                    elif key != "right":
                        return Continued()
            if self._stage.script is not None:
                return Continued()

    def _pages(self, state: SessionState) -> list[Sequence[str]]:
        shown = [name for trial in state.trials for name in trial.stimuli]
        names = list(dict.fromkeys([*shown, *self._pictures]))
        return [names[i : i + self.grid.n] for i in range(0, len(names), self.grid.n)]

    def draw(self, state: SessionState) -> None:
        """Draw the present page into the back buffer."""
        pages = self._pages(state)
        for name, place in zip(pages[self._page], self.places, strict=False):
            self._pictures[name].pos = place
            self._pictures[name].draw()
        self._text.draw()
        self._size_note.draw()
        if len(pages) > 1:
            self._page_note.text = f"{self._page + 1} / {len(pages)}"
            self._page_note.draw()
