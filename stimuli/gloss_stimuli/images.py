"""Pictures on disk: linear luminance as OpenEXR, code values as grayscale PNG."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from glossspace.files import whole_file

__all__ = ["read_codes", "read_luminance", "write_codes", "write_luminance"]


def write_luminance(path: str | Path, luminance_cd_m2: NDArray[np.floating]) -> None:
    """Write luminance (cd/m², shape (H, W)) as the float32 channel Y of an OpenEXR file, whole or not at all."""
    import OpenEXR

    pixels = np.ascontiguousarray(luminance_cd_m2, dtype=np.float32)
    if not np.isfinite(pixels).all():
        raise FloatingPointError(f"'{path}': luminance holds values that are not finite.")
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


def write_codes(path: str | Path, codes: NDArray[np.uint8]) -> None:
    """Write display code values (shape (H, W)) as an 8-bit grayscale PNG, whole or not at all.

    The file says nothing of a gamma: the values are for a display whose own curve is already in them.
    """
    from PIL import Image

    with whole_file(path) as temporary:
        Image.fromarray(np.ascontiguousarray(codes, dtype=np.uint8)).save(temporary, format="PNG", optimize=False)


def read_codes(path: str | Path) -> NDArray[np.uint8]:
    """Code values (shape (H, W)) of a PNG that `write_codes` made."""
    from PIL import Image

    with Image.open(path) as image:
        return np.array(image, dtype=np.uint8)
