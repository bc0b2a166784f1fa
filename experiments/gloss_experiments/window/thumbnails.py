"""Smaller pictures of stimuli, for overviews: made once, before the session begins."""

from pathlib import Path

from PIL import Image

__all__ = ["thumbnail"]


def thumbnail(path: Path, size: tuple[int, int]) -> Path | Image.Image:
    """The image at `path` in `size`: itself where it has that size, so that its code values are what is shown.

    A smaller one holds the mean code value over the area of each of its pixels. It serves to find and to arrange
    stimuli; judged are those shown at their own size.
    """
    with Image.open(path) as image:
        if image.size == size:
            return path
        return image.resize(size, Image.Resampling.BOX)
