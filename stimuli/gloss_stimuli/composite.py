"""The composite picture of a set, as in the gloss paper's fig. 4: a row for each ρd, a column for each ρs and α."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gloss_stimuli.images import read_codes, write_codes
from glossspace.stimulus_set import StimulusSet

__all__ = ["composite", "write_composite"]


def composite(stimuli: StimulusSet, *, thumbnail: int = 128) -> NDArray[np.uint8]:
    """Sheet of thumbnails: white paints above gray above black, weak gloss left of strong, sharp left of blurred.

    Parameters
    ----------
    stimuli : StimulusSet
        What to show.
    thumbnail : int, optional
        Largest width of one picture in pixels; a picture is reduced by a whole factor.

    Returns
    -------
    array of uint8, shape (rows × width, columns × width)
        Code values; combinations that the set lacks are black.
    """
    columns = sorted({(s.rho_s, s.alpha) for s in stimuli.stimuli})
    rows = sorted({s.rho_d for s in stimuli.stimuli}, reverse=True)
    size = stimuli.image_size[0]
    factor = -(-size // thumbnail)
    width = size // factor
    sheet = np.zeros((len(rows) * width, len(columns) * width), dtype=np.uint8)
    for stimulus in stimuli.stimuli:
        top = rows.index(stimulus.rho_d) * width
        left = columns.index((stimulus.rho_s, stimulus.alpha)) * width
        codes = read_codes(stimuli.image_path(stimulus.name))[: width * factor, : width * factor]
        blocks = codes.reshape(width, factor, width, factor).mean(axis=(1, 3))
        sheet[top : top + width, left : left + width] = np.floor(blocks + 0.5)
    return sheet


def write_composite(stimuli: StimulusSet, path: str | Path, *, thumbnail: int = 128) -> None:
    """Write `composite` of a set as a PNG."""
    write_codes(path, composite(stimuli, thumbnail=thumbnail))
