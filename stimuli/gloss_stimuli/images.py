"""Pictures on disk: linear luminance as OpenEXR, code values as grayscale PNG of 8 or 16 bits."""

import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from glossspace.errors import GlossError
from glossspace.files import whole_file

__all__ = ["read_codes", "read_luminance", "write_codes", "write_luminance"]


def write_luminance(path: str | Path, luminance_cd_m2: NDArray[np.floating[Any]]) -> None:
    """Write luminance (cd/m², shape (H, W)) as the float32 channel Y of an OpenEXR file, whole or not at all.

    Raises
    ------
    FloatingPointError
        A luminance is not finite as float32.
    """
    import OpenEXR

    with np.errstate(over="ignore"):  # told below
        pixels = np.ascontiguousarray(luminance_cd_m2, dtype=np.float32)
    if not np.isfinite(pixels).all():
        raise FloatingPointError(f"'{path}': luminance holds values that are not finite.")
    # Of the lossless kinds ZIP is the cheapest that makes files smaller: a quarter of the time of PIZ.
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with whole_file(path) as temporary:
        try:
            OpenEXR.File(header, {"Y": pixels}).write(str(temporary))
        except RuntimeError as error:  # OpenEXR's word for a full disk
            raise OSError(str(error).rpartition('". ')[2].rstrip(".")) from error


def read_luminance(path: str | Path) -> NDArray[np.float32]:
    """Luminance (cd/m², shape (H, W)) of a file that `write_luminance` made."""
    import OpenEXR

    with OpenEXR.File(str(path), separate_channels=True) as file:
        return np.array(file.channels()["Y"].pixels)


def write_codes(path: str | Path, codes: NDArray[np.unsignedinteger[Any]]) -> None:
    """Write display code values (shape (H, W)) as a grayscale PNG, whole or not at all.

    It has 8 bits if they are uint8, 16 if uint16, and says nothing of a gamma: the values are for a display whose own
    curve is already in them.

    Raises
    ------
    TypeError
        The codes are of another type, from which they would have to be rounded or cut.
    """
    from PIL import Image

    if codes.dtype not in (np.uint8, np.uint16):
        raise TypeError(f"Code values must be uint8 or uint16, but are {codes.dtype}.")
    with whole_file(path) as temporary:
        # Run lengths: half the time of the default on smooth pictures, in files of about the same size.
        Image.fromarray(np.ascontiguousarray(codes)).save(temporary, format="PNG", compress_type=zlib.Z_RLE)


def read_codes(path: str | Path) -> NDArray[np.unsignedinteger[Any]]:
    """Code values (shape (H, W)) of a PNG that `write_codes` made: uint8 or uint16, as they were written.

    Raises
    ------
    GlossError
        It is another kind of picture.
    """
    from PIL import Image

    with Image.open(path) as image:
        if image.mode not in ("L", "I;16"):
            raise GlossError(
                f"'{path}' holds no display code values: it must be a grayscale PNG of 8 or 16 bits, but is of "
                f"Pillow's mode '{image.mode}'."
            )
        return np.array(image)
