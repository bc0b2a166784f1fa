from pathlib import Path

import numpy as np

from gloss_stimuli.composite import composite
from gloss_stimuli.images import write_codes
from glossspace.stimulus_set import Stimulus, StimulusSet


def written(folder: Path, paints: dict[Stimulus, np.ndarray]) -> StimulusSet:
    """A set of pictures on disk."""
    for paint, codes in paints.items():
        write_codes(folder / f"{paint.name}.png", codes)
    height, width = next(iter(paints.values())).shape
    entries = [{"name": p.name, "image": f"{p.name}.png"} for p in paints]
    return StimulusSet(folder, "x", tuple(paints), {"image": {"width": width, "height": height}, "stimuli": entries})


def test_pictures_are_placed_by_their_parameters(tmp_path: Path) -> None:
    paints = [Stimulus.of(0.03, 0.1, 0.04), Stimulus.of(0.8, 0.1, 0.04), Stimulus.of(0.8, 0.1, 0.1)]
    stimuli = written(
        tmp_path, {p: np.full((8, 8), value, np.uint8) for value, p in zip((10, 20, 30), paints, strict=True)}
    )
    sheet = composite(stimuli, thumbnail=4)
    # White above black, sharp left of blurred, the missing combination black.
    assert sheet[::4, ::4].tolist() == [[20, 30], [10, 0]]
    assert sheet.shape == (8, 8)


def test_columns_are_ordered_by_gloss_then_by_roughness(tmp_path: Path) -> None:
    # Fig. 4 of the gloss paper: three groups of rho_s, three alpha in each.
    paints = {
        Stimulus.of(0.193, rho_s, alpha): np.full((2, 2), int(1000 * rho_s + 100 * alpha), np.uint8)
        for alpha in (0.1, 0.04, 0.07)
        for rho_s in (0.099, 0.033, 0.066)
    }
    sheet = composite(written(tmp_path, paints), thumbnail=2)
    assert sheet[:1, ::2].tolist() == [[37, 40, 43, 70, 73, 76, 103, 106, 109]]


def test_pictures_that_are_not_square_keep_their_shape(tmp_path: Path) -> None:
    paint = Stimulus.of(0.5, 0.1, 0.04)
    codes = np.repeat(np.repeat(np.array([[10, 20, 30]], np.uint8), 4, axis=0), 4, axis=1)
    sheet = composite(written(tmp_path, {paint: codes}), thumbnail=3)
    assert sheet.tolist() == [[10, 20, 30]]


def test_a_film_of_two_lines_is_still_shown(tmp_path: Path) -> None:
    codes = np.full((2, 64), 7, np.uint8)
    assert composite(written(tmp_path, {Stimulus.of(0.5, 0.1, 0.04): codes}), thumbnail=8).tolist() == [[7] * 32]


def test_sixteen_bits_are_shown_in_eight(tmp_path: Path) -> None:
    codes = np.array([[0, 257 * 128], [257 * 128 + 100, 65535]], np.uint16)
    sheet = composite(written(tmp_path, {Stimulus.of(0.5, 0.1, 0.04): codes}), thumbnail=2)
    assert sheet.dtype == np.uint8
    assert sheet.tolist() == [[0, 128], [128, 255]]


def test_paints_that_share_nothing_follow_one_another(tmp_path: Path) -> None:
    # Ten paints on the diagonal of a table of a hundred places.
    paints = {Stimulus.of(0.01 * k, 0.01 * k, 0.01 * k): np.full((2, 2), k, np.uint8) for k in range(1, 11)}
    sheet = composite(written(tmp_path, paints), thumbnail=2)
    assert sheet[::2, ::2].tolist() == [[10, 9, 8, 7], [6, 5, 4, 3], [2, 1, 0, 0]]
