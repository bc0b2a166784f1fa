"""The screen of a ranking: items are dragged into an order round a reference, or put there with keys."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from gloss_experiments.design import Trial
from gloss_experiments.observers.observer import Judge
from gloss_experiments.session.state import Confirmed, Event, OrderChosen, SessionState, TimedOut, Trace
from gloss_experiments.window.button import Button
from gloss_experiments.window.pointer import Step, click_steps, drag_steps
from gloss_experiments.window.quit_question import wants_to_stop
from gloss_experiments.window.ranking_board import RankingBoard
from gloss_experiments.window.ranking_layout import RankingLayout
from gloss_experiments.window.stage import FAINT_GRAY, LINE_GRAY, MARKER_GRAY, Stage
from gloss_experiments.window.thumbnails import thumbnail

__all__ = ["RankingScreen", "ranking_steps"]


def ranking_steps(order: tuple[str, ...], items: tuple[str, ...], layout: RankingLayout) -> list[Step]:
    """The movements of a hand that drags `items`, as they lie at the start, into `order`, and confirms it."""
    steps: list[Step] = []
    for rank, item in enumerate(order):
        steps += drag_steps(layout.waiting[items.index(item)], layout.ranks[rank])
    return steps + click_steps(layout.button)


class RankingScreen:
    """Shows a ranking, and turns mouse and keys into its events.

    Above stand the reference and, beside it, the marked item, both at their own size; below, the items that wait, and
    the places of the order. Every item must be placed before the order can be confirmed.

    Parameters
    ----------
    stage
        The window and what belongs to it.
    layout
        Where everything stands.
    images
        PsychoPy's image of each stimulus at its own size.
    paths
        The files of the images.
    judge
        The simulated observer; None for a person.
    """

    def __init__(
        self,
        stage: Stage,
        layout: RankingLayout,
        images: Mapping[str, Any],
        paths: Mapping[str, Path],
        judge: Judge | None,
    ) -> None:
        protocol = stage.protocol
        self._stage, self._layout, self._images, self._judge = stage, layout, images, judge
        self._limit_s = protocol.design.time_limit_s
        self._pictures = {name: stage.picture(thumbnail(path, layout.picture_size)) for name, path in paths.items()}
        self._question = stage.text(protocol.texts.question, layout.question)
        self._low = stage.text(protocol.slider.low_label, layout.low_label, anchor="left")
        self._high = stage.text(protocol.slider.high_label, layout.high_label, anchor="right")
        self._button = Button(stage, protocol.texts.confirm, layout.button, size=layout.button_size)
        self._cells = [stage.box(place, layout.picture_size, line=FAINT_GRAY) for place in layout.ranks]
        scale = min(0.75, 0.4 * layout.picture_size[1] / protocol.texts.size_px)
        self._numbers = [
            stage.text(str(rank), place, gray=FAINT_GRAY, scale=scale)
            for rank, place in enumerate(layout.ranks, start=1)
        ]
        width, height = layout.picture_size
        self._mark = stage.box((0, 0), (width + layout.gap - 2, height + layout.gap - 2), line=MARKER_GRAY)
        corner = (layout.low_label[0], layout.high_label[1])
        self._practice = stage.text(protocol.texts.practice, corner, gray=LINE_GRAY, anchor="left")
        self.board = RankingBoard(())
        self._marked = ""
        self._held = False
        self._pointer_was = (0.0, 0.0)
        self._n_changes = 0
        self._first_response_s: float | None = None

    def begin(self, trial: Trial) -> None:
        """Lay the items of `trial` out, none of them placed; its clock starts with the first frame that shows it."""
        self.board = RankingBoard(trial.stimuli[1:])
        self._marked, self._held = self.board.items[0], False
        self._n_changes, self._first_response_s = 0, None
        self._button.forget()
        self._rank(trial)
        self._stage.window.callOnFlip(self._stage.clock.start)

    def _rank(self, trial: Trial) -> None:
        if self._stage.script is not None and self._judge is not None:
            order = self._judge.rank(trial)
            self._stage.script.perform(ranking_steps(order, self.board.items, self._layout))

    def event(self, state: SessionState, trial: Trial) -> Event | None:
        """Show the ranking, frame by frame, until the order is complete or confirmed; None to stop here."""
        stage = self._stage
        while True:
            if stage.script is not None:
                stage.script.tick()
            stage.left_button.look()
            before = self.board
            self._follow_the_mouse()
            self.draw(state, trial)
            stage.flip(recorded=True)
            keys = stage.pressed_keys()
            if "escape" in keys:
                if wants_to_stop(stage):
                    return None
                self._come_back(trial)
                continue
            for key in keys:
                self._follow_key(key)
            if self.board != before:
                self._n_changes += 1
                if self._first_response_s is None:
                    self._first_response_s = self._elapsed_s()
                if self.board.complete:
                    return OrderChosen(self.board.placed)
            confirmed = self._button.clicked() or "space" in keys
            # An order that was complete, and from which an item was taken back, is none.
            if confirmed and self.board.complete and state.order is not None:
                return Confirmed(self._elapsed_s(), self._trace())
            if self._limit_s is not None and stage.script is None and stage.clock.elapsed_s() >= self._limit_s:
                return TimedOut(self._elapsed_s(), self._trace())

    def _come_back(self, trial: Trial) -> None:
        self._button.forget()
        self._held = False
        if self._stage.script is not None:
            self.board = RankingBoard(self.board.items)  # the script begins again
        self._rank(trial)

    def _follow_the_mouse(self) -> None:
        left, place = self._stage.left_button, tuple(self._stage.pointer.getPos())
        item = self._item_at((float(place[0]), float(place[1])))
        moved = place != self._pointer_was
        self._pointer_was = (float(place[0]), float(place[1]))
        if left.just_pressed and item is not None:
            self._marked, self._held = item, True
        elif self._held and left.just_released:
            self._held = False
            self._drop((float(place[0]), float(place[1])))
        elif not self._held and moved and item is not None:
            self._marked = item

    def _drop(self, place: tuple[float, float]) -> None:
        """Let the held item go: over the order it takes that rank, over the waiting ones it loses it."""
        rank = self._layout.rank_at(place)
        if rank is not None:
            self.board = self.board.place(self._marked, rank)
        elif self._layout.waiting_at(place) is not None:
            self.board = self.board.take_back(self._marked)

    def _item_at(self, place: tuple[float, float]) -> str | None:
        rank = self._layout.placed_at(place)
        if rank is not None and rank < len(self.board.placed):
            return self.board.placed[rank]
        index = self._layout.waiting_at(place)
        item = None if index is None or index >= len(self.board.items) else self.board.items[index]
        return None if item in self.board.placed else item

    def _follow_key(self, key: str) -> None:
        walk = (*self.board.waiting, *self.board.placed)
        index = walk.index(self._marked)
        if key in ("left", "right"):
            self._marked = walk[(index + (1 if key == "right" else -1)) % len(walk)]
        elif key in ("shift+left", "shift+right"):
            self.board = self.board.move(self._marked, 1 if key == "shift+right" else -1)
        elif key in ("backspace", "delete"):
            self.board = self.board.take_back(self._marked)
        elif key == "return" and self._marked not in self.board.placed:
            self.board = self.board.place(self._marked, len(self.board.placed))
            waiting = self.board.waiting
            # The next one that waits is marked, so that Return alone can place them all.
            self._marked = waiting[min(index, len(waiting) - 1)] if waiting else self._marked

    def _elapsed_s(self) -> float | None:
        return None if self._stage.script is not None else self._stage.clock.elapsed_s()

    def _trace(self) -> Trace:
        frames = self._stage.frames.trial()
        return Trace(
            first_response_s=self._first_response_s,
            n_changes=self._n_changes,
            n_frames=frames.n_frames,
            n_dropped=frames.n_dropped,
            longest_frame_ms=frames.longest_frame_ms,
        )

    def draw(self, state: SessionState, trial: Trial) -> None:
        """Draw the ranking into the back buffer."""
        self._draw_at(self._images[trial.stimuli[0]], self._layout.reference)
        self._draw_at(self._images[self._marked], self._layout.candidate)
        for text in (self._question, self._low, self._high):
            text.draw()
        if trial.role == "practice":
            self._practice.draw()
        for rank in range(len(self.board.placed), len(self.board.items)):
            self._cells[rank].draw()
            self._numbers[rank].draw()
        places = self._places()
        target = self._layout.rank_at(self._pointer_was) if self._held else None
        if target is not None:  # where it would come to lie
            n_others = len(self.board.placed) - (self._marked in self.board.placed)
            self._draw_at(self._mark, self._layout.ranks[min(target, n_others)])
        for item, place in places.items():
            self._draw_at(self._pictures[item], place)
        # Once more, since what is held lies above the others.
        self._draw_at(self._mark, places[self._marked])
        self._draw_at(self._pictures[self._marked], places[self._marked])
        if self.board.complete and state.order is not None:
            self._button.draw()

    def _places(self) -> dict[str, tuple[int, int]]:
        """Where each item's picture lies; that of a held one moves with the pointer."""
        places = dict(zip(self.board.items, self._layout.waiting, strict=False))
        places |= dict(zip(self.board.placed, self._layout.ranks, strict=False))
        if self._held:
            x, y = self._pointer_was
            places[self._marked] = (round(x), round(y))
        return places

    @staticmethod
    def _draw_at(picture: Any, place: tuple[int, int]) -> None:
        picture.pos = place
        picture.draw()
