from pathlib import Path

import numpy as np
import pytest

from gloss_stimuli.images import read_codes, read_luminance, write_codes, write_luminance
from glossspace.errors import GlossError


def test_luminance_comes_back_bit_for_bit(tmp_path: Path) -> None:
    values = np.random.default_rng(1).lognormal(size=(6, 8)).astype(np.float32)
    write_luminance(tmp_path / "a.exr", values)
    assert read_luminance(tmp_path / "a.exr").tobytes() == values.tobytes()


def test_codes_come_back_and_are_gray_without_a_gamma(tmp_path: Path) -> None:
    from PIL import Image

    codes = np.arange(256, dtype=np.uint8).reshape(16, 16)
    write_codes(tmp_path / "a.png", codes)
    assert (read_codes(tmp_path / "a.png") == codes).all()
    with Image.open(tmp_path / "a.png") as image:
        assert image.mode == "L"
        assert not {"gamma", "srgb", "icc_profile"} & set(image.info)


def test_equal_pixels_make_equal_files(tmp_path: Path) -> None:
    values = np.ones((4, 4), np.float32)
    for name in ("a", "b"):
        write_luminance(tmp_path / f"{name}.exr", values)
        write_codes(tmp_path / f"{name}.png", values.astype(np.uint8))
    assert (tmp_path / "a.exr").read_bytes() == (tmp_path / "b.exr").read_bytes()
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_luminance_that_is_not_finite_is_not_written(tmp_path: Path) -> None:
    with pytest.raises(FloatingPointError, match="not finite"):
        write_luminance(tmp_path / "a.exr", np.array([[1.0, np.nan]]))
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_is_one_line(tmp_path: Path, monkeypatch) -> None:
    # What OpenEXR 3.4 raises there.
    def full(*_: object) -> None:
        raise RuntimeError('Failed to write pixel data to image file "x.exr". No space left on device.')

    monkeypatch.setattr("OpenEXR.File.write", full)
    with pytest.raises(GlossError, match=r"^Cannot write '.*a\.exr': No space left on device\. Choose another place"):
        write_luminance(tmp_path / "a.exr", np.ones((2, 2)))
    assert list(tmp_path.iterdir()) == []
