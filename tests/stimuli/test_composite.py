from pathlib import Path

import numpy as np

from gloss_stimuli.composite import composite
from gloss_stimuli.images import write_codes
from glossspace.stimulus_set import Stimulus, StimulusSet


def test_pictures_are_placed_by_their_parameters(tmp_path: Path) -> None:
    paints = [Stimulus.of(0.03, 0.1, 0.04), Stimulus.of(0.8, 0.1, 0.04), Stimulus.of(0.8, 0.1, 0.1)]
    for value, paint in zip((10, 20, 30), paints, strict=True):
        write_codes(tmp_path / f"{paint.name}.png", np.full((8, 8), value, np.uint8))
    entries = [{"name": p.name, "image": f"{p.name}.png"} for p in paints]
    stimuli = StimulusSet(tmp_path, "x", tuple(paints), {"image": {"width": 8, "height": 8}, "stimuli": entries})
    sheet = composite(stimuli, thumbnail=4)
    # White above black, sharp left of blurred, the missing combination black.
    assert sheet[::4, ::4].tolist() == [[20, 30], [10, 0]]
    assert sheet.shape == (8, 8)
