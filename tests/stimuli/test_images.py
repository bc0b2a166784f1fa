import struct
import zlib
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


def test_codes_of_16_bits_come_back(tmp_path: Path) -> None:
    codes = np.arange(0, 65536, 7, dtype=np.uint16)[:9360].reshape(90, 104)
    write_codes(tmp_path / "a.png", codes)
    back = read_codes(tmp_path / "a.png")
    assert back.dtype == np.uint16
    assert (back == codes).all()


@pytest.mark.parametrize(("dtype", "value", "stored"), [(np.uint8, 0xAB, b"\xab"), (np.uint16, 0xABCD, b"\xab\xcd")])
def test_the_file_is_what_the_png_standard_says(tmp_path: Path, dtype: type, value: int, stored: bytes) -> None:
    path = tmp_path / "a.png"
    write_codes(path, np.full((1, 1), value, dtype))
    content = path.read_bytes()
    # ISO/IEC 15948: eight bytes of signature, then IHDR with width, height, bit depth and colour type 0, grayscale.
    width, height, depth, colour = struct.unpack(">IIBB", content[16:26])
    assert (width, height, depth, colour) == (1, 1, 8 * len(stored), 0)
    start = content.index(b"IDAT")
    (length,) = struct.unpack(">I", content[start - 4 : start])
    # A line is its filter, then its pixels, most significant byte first; of a single pixel every filter leaves itself.
    assert zlib.decompress(content[start + 4 : start + 4 + length])[1:] == stored


@pytest.mark.parametrize("codes", [np.ones((2, 2)), np.ones((2, 2), np.int64)])
def test_numbers_that_are_no_codes_are_not_rounded_in_silence(tmp_path: Path, codes: np.ndarray) -> None:
    with pytest.raises(TypeError, match="Code values must be uint8 or uint16, but are (float|int)64"):
        write_codes(tmp_path / "a.png", codes)
    assert list(tmp_path.iterdir()) == []


def test_a_picture_in_colour_holds_no_codes(tmp_path: Path) -> None:
    from PIL import Image

    Image.new("RGB", (2, 2)).save(tmp_path / "a.png")
    with pytest.raises(GlossError, match=r"a\.png' holds no display code values: it must be a grayscale PNG.*'RGB'"):
        read_codes(tmp_path / "a.png")


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
    with pytest.raises(FloatingPointError, match="not finite"):  # as float32 it is infinite
        write_luminance(tmp_path / "a.exr", np.array([[1.0, 1e39]]))
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_is_one_line(tmp_path: Path, monkeypatch) -> None:
    # What OpenEXR 3.4 raises there.
    def full(*_: object) -> None:
        raise RuntimeError('Failed to write pixel data to image file "x.exr". No space left on device.')

    monkeypatch.setattr("OpenEXR.File.write", full)
    with pytest.raises(GlossError, match=r"^Cannot write '.*a\.exr': No space left on device\. Choose another place"):
        write_luminance(tmp_path / "a.exr", np.ones((2, 2)))
    assert list(tmp_path.iterdir()) == []
