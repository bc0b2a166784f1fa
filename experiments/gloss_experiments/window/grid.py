"""The largest grid of pictures that fits into an area, in whole pixels: pure arithmetic, no window."""

from dataclasses import dataclass
from math import ceil

from gloss_experiments.window.layout import round_even

__all__ = ["Grid", "largest_grid"]


@dataclass(frozen=True)
class Grid:
    """A grid of cells.

    Attributes
    ----------
    columns, rows
        Its shape; the last row may be shorter, and then stands centred.
    picture_size
        Width and height of a picture: never more than that of the image.
    gap
        Between two pictures.
    n
        Pictures in it.
    """

    columns: int
    rows: int
    picture_size: tuple[int, int]
    gap: int
    n: int

    @property
    def size(self) -> tuple[int, int]:
        """Width and height from edge to edge."""
        width, height = self.picture_size
        return (
            self.columns * width + (self.columns - 1) * self.gap,
            self.rows * height + (self.rows - 1) * self.gap,
        )

    def places(self, centre: tuple[int, int], *, centred: bool = False) -> tuple[tuple[int, int], ...]:
        """Centres of the pictures, row by row from the top left.

        Parameters
        ----------
        centre
            Of the whole grid, y upwards.
        centred
            Whether a shorter last row stands in the middle; else it begins at the left, as a line of text does.
        """
        width, height = self.picture_size
        left, top = centre[0] - self.size[0] // 2 + width // 2, centre[1] + self.size[1] // 2 - height // 2
        found = []
        for i in range(self.n):
            row, column = divmod(i, self.columns)
            in_row = min(self.columns, self.n - row * self.columns)
            shift = (self.columns - in_row) * (width + self.gap) // 2 if centred else 0
            found.append((left + shift + column * (width + self.gap), top - row * (height + self.gap)))
        return tuple(found)


def largest_grid(
    n: int, *, image_size: tuple[int, int], area: tuple[int, int], gap: int, smallest_px: int
) -> Grid | None:
    """The grid of `n` pictures that shows them largest within `area`; None where none is wide enough.

    Pictures keep the proportions of the images and have even sizes, so that they cover whole pixels. They are never
    enlarged.

    Parameters
    ----------
    n
        Pictures, at least 1.
    image_size, area
        Width and height in pixels.
    gap
        Between two pictures, in pixels; even.
    smallest_px
        Least width of a picture, where the images are not smaller themselves.

    Examples
    --------
    27 images of 512 pixels do not fit at their own size on an SXGA screen; two do:

    >>> largest_grid(27, image_size=(512, 512), area=(1200, 900), gap=16, smallest_px=32).picture_size
    (166, 166)
    >>> largest_grid(2, image_size=(512, 512), area=(1200, 900), gap=16, smallest_px=32).picture_size
    (512, 512)
    """
    best: Grid | None = None
    for columns in range(1, n + 1):
        rows = ceil(n / columns)
        columns_needed = ceil(n / rows)
        scale = min(
            1.0,
            (area[0] - (columns_needed - 1) * gap) / (columns_needed * image_size[0]),
            (area[1] - (rows - 1) * gap) / (rows * image_size[1]),
        )
        size = image_size if scale == 1 else (_even_below(scale * image_size[0]), _even_below(scale * image_size[1]))
        if size[0] < min(smallest_px, image_size[0]) or size[1] < 2:
            continue
        if best is None or size[0] > best.picture_size[0]:
            best = Grid(columns_needed, rows, size, gap, n)
    return best


def _even_below(value: float) -> int:
    return round_even(value) if round_even(value) <= value else round_even(value) - 2
