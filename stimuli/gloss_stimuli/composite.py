"""The composite picture of a set, as in the gloss paper's fig. 4: a row for each ρd, a column for each ρs and α."""

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.images import read_codes, write_codes
from glossspace.stimulus_set import Stimulus, StimulusSet

__all__ = ["composite", "write_composite"]

# A table emptier than this share says little and grows with the square of the set; its pictures follow one another.
LEAST_SHARE_FILLED = 0.5

# The ratio of the largest code values of 16 and 8 bits, 65535 / 255.
CODES_OF_16_BITS_IN_ONE_OF_8 = 257


def composite(stimuli: StimulusSet, *, thumbnail: int = 128) -> NDArray[np.uint8]:
    """Sheet of thumbnails: white paints above gray above black, weak gloss left of strong, sharp left of blurred.

    A set that would leave more than half of such a table empty, such as a list of paints that share no parameters, is
    shown in that same order, row by row, on a sheet about as wide as high.

    Parameters
    ----------
    stimuli : StimulusSet
        What to show.
    thumbnail : int, optional
        Largest width and height of one picture in pixels; a picture is reduced by a whole factor.

    Returns
    -------
    array of uint8, shape (rows × height, columns × width)
        Code values; places without a stimulus are black.
    """
    width, height = stimuli.image_size
    factor = min(-(-max(width, height) // thumbnail), width, height)
    width, height = width // factor, height // factor
    places = _places(stimuli.stimuli, width=width, height=height)
    rows, columns = (1 + max(place[axis] for place in places.values()) for axis in (0, 1))
    sheet = np.zeros((rows * height, columns * width), dtype=np.uint8)
    for name, (row, column) in places.items():
        thumb = _reduced(read_codes(stimuli.image_path(name)), factor, width=width, height=height)
        sheet[row * height : (row + 1) * height, column * width : (column + 1) * width] = thumb
    return sheet


def write_composite(stimuli: StimulusSet, path: str | Path, *, thumbnail: int = 128) -> None:
    """Write `composite` of a set as a PNG."""
    write_codes(path, composite(stimuli, thumbnail=thumbnail))


def _places(stimuli: tuple[Stimulus, ...], *, width: int, height: int) -> dict[str, tuple[int, int]]:
    """Row and column of each stimulus."""
    columns = sorted({(s.rho_s, s.alpha) for s in stimuli})
    rows = sorted({s.rho_d for s in stimuli}, reverse=True)
    if len(stimuli) >= LEAST_SHARE_FILLED * len(rows) * len(columns):
        return {s.name: (rows.index(s.rho_d), columns.index((s.rho_s, s.alpha))) for s in stimuli}
    across = math.ceil(math.sqrt(len(stimuli) * height / width))
    ordered = sorted(stimuli, key=lambda s: (-s.rho_d, s.rho_s, s.alpha))
    return {s.name: divmod(index, across) for index, s in enumerate(ordered)}


def _reduced(codes: NDArray[np.unsignedinteger], factor: int, *, width: int, height: int) -> NDArray[np.uint8]:
    blocks = codes[: height * factor, : width * factor].reshape(height, factor, width, factor).mean(axis=(1, 3))
    if codes.dtype == np.uint16:
        blocks /= CODES_OF_16_BITS_IN_ONE_OF_8
    return np.floor(blocks + 0.5).astype(np.uint8)
