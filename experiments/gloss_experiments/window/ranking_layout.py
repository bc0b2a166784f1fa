"""Where everything stands in a ranking, in whole pixels from the window's centre: pure arithmetic, no window."""

from dataclasses import dataclass
from math import hypot

from gloss_experiments.protocol import Protocol
from gloss_experiments.window.grid import largest_grid
from gloss_experiments.window.layout import button_size_px, refuse_odd_size, round_even
from glossspace.errors import GlossError

__all__ = ["RankingLayout", "arrange_ranking"]

# A picture narrower than this can neither be told from others nor taken with the mouse.
SMALLEST_PICTURE_PX = 32


@dataclass(frozen=True)
class RankingLayout:
    """Centres ``(x, y)`` in pixels from the centre of the window, y upwards.

    Attributes
    ----------
    reference, candidate
        Of the two images at their own size: the reference, and the item that is marked or held.
    waiting
        Of the items not placed yet, in their starting order.
    ranks
        Of the places in the order, the lowest rank first.
    picture_size
        Of an item among the others: the images' own size where that fits, else the largest even one that does.
    low_label, high_label
        Of the left edge of the first label, above the first rank, and the right edge of the last, below the last.
    """

    question: tuple[int, int]
    reference: tuple[int, int]
    candidate: tuple[int, int]
    waiting: tuple[tuple[int, int], ...]
    ranks: tuple[tuple[int, int], ...]
    picture_size: tuple[int, int]
    gap: int
    low_label: tuple[int, int]
    high_label: tuple[int, int]
    button: tuple[int, int]
    button_size: tuple[int, int]

    def waiting_at(self, place: tuple[float, float]) -> int | None:
        """Which place of a waiting item holds the point `place`; None for none."""
        return self._at(place, self.waiting)

    def rank_at(self, place: tuple[float, float]) -> int | None:
        """Which rank, from 0, is meant by a drop at `place`: the nearest within reach of the order's rows."""
        nearest = min(range(len(self.ranks)), key=lambda i: hypot(*_difference(place, self.ranks[i])))
        lefts, heights = [x for x, _ in self.ranks], [y for _, y in self.ranks]
        reach = (self.picture_size[0] + self.gap, self.picture_size[1] // 2 + self.gap)
        within_x = min(lefts) - reach[0] <= place[0] <= max(lefts) + reach[0]
        within_y = min(heights) - reach[1] <= place[1] <= max(heights) + reach[1]
        return nearest if within_x and within_y else None

    def _at(self, place: tuple[float, float], cells: tuple[tuple[int, int], ...]) -> int | None:
        for i, cell in enumerate(cells):
            dx, dy = _difference(place, cell)
            if abs(dx) <= self.picture_size[0] / 2 and abs(dy) <= self.picture_size[1] / 2:
                return i
        return None

    def placed_at(self, place: tuple[float, float]) -> int | None:
        """Which rank's picture holds the point `place`; None for none."""
        return self._at(place, self.ranks)


def _difference(a: tuple[float, float], b: tuple[int, int]) -> tuple[float, float]:
    return a[0] - b[0], a[1] - b[1]


def arrange_ranking(
    protocol: Protocol, *, image_size_px: tuple[int, int], window_size_px: tuple[int, int], n_items: int
) -> RankingLayout:
    """Lay out a ranking: two images at their own size, the waiting items below them, and the order below those.

    Raises
    ------
    GlossError
        It does not fit into the window, or the image has an odd size.
    """
    refuse_odd_size(image_size_px)
    width, height = image_size_px
    line = round_even(1.6 * protocol.texts.size_px)
    between = round_even(protocol.display.gap_deg / protocol.display.image_width_deg * width)
    button_size = button_size_px(protocol.texts.size_px)
    gap = 8
    space = round_even(line / 2)
    # Question; images; the waiting; the low label; the ranks; the button; the lower edge, with its remark.
    fixed = (line + space // 2) + (height + space) + (gap + line) + (gap + button_size[1]) + line
    area = (window_size_px[0] - 2 * line, (window_size_px[1] - fixed) // 2)
    grid = None
    if 2 * width + between <= window_size_px[0] and area[1] > 0:
        grid = largest_grid(n_items, image_size=image_size_px, area=area, gap=gap, smallest_px=SMALLEST_PICTURE_PX)
    if grid is None:
        raise GlossError(
            f"The ranking of {n_items} images of {width} x {height} pixels does not fit into the window of "
            f"{window_size_px[0]} x {window_size_px[1]}. Use a larger screen, name fewer stimuli in the protocol, or "
            "render them smaller (gloss render --size)."
        )
    top = round_even((fixed + 2 * grid.size[1]) / 2)
    image_y = top - line - space // 2 - height // 2
    waiting_y = image_y - height // 2 - space - grid.size[1] // 2
    low_y = waiting_y - grid.size[1] // 2 - gap - line // 2
    ranks_y = low_y - line // 2 - grid.size[1] // 2
    below_y = ranks_y - grid.size[1] // 2 - gap - button_size[1] // 2
    half = (width + between) // 2
    return RankingLayout(
        question=(0, top - line // 2),
        reference=(-half, image_y),
        candidate=(half, image_y),
        waiting=grid.places((0, waiting_y)),
        ranks=grid.places((0, ranks_y)),
        picture_size=grid.picture_size,
        gap=gap,
        low_label=(-grid.size[0] // 2, low_y),
        high_label=(grid.size[0] // 2, below_y),
        button=(0, below_y),
        button_size=button_size,
    )
