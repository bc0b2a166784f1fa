"""Tabulated complex indices of refraction, shipped with their provenance in the head of each file."""

from functools import lru_cache
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from glossspace.errors import GlossError
from glossspace.files import shipped_folder
from glossspace.instruments.standards import require_wavelengths
from glossspace.metric.validity import FloatArray

__all__ = ["index_tables", "refractive_index"]

_FOLDER = shipped_folder(str(Path(__file__)), "data")


def index_tables() -> tuple[str, ...]:
    """Names of the shipped tables.

    Examples
    --------
    >>> index_tables()
    ('copper_hagemann_1974', 'copper_johnson_christy_1972')
    """
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.csv")))


def refractive_index(table: str, wavelengths_nm: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Index n and extinction coefficient k at wavelengths, linear between the rows of a table.

    Parameters
    ----------
    table : str
        One of `index_tables`.
    wavelengths_nm : array_like, shape (K,)
        Ascending, within the table.

    Returns
    -------
    tuple of ndarray, shape (K,)
        n and k.

    Raises
    ------
    GlossError
        The table is unknown, or a wavelength lies outside it; the message gives its range.

    Examples
    --------
    >>> n, k = refractive_index("copper_johnson_christy_1972", [582.1])
    >>> float(n[0]), float(k[0])
    (0.7, 2.704)
    """
    if table not in index_tables():
        raise GlossError(f"Unknown table {table!r} of refractive indices. Allowed: {', '.join(index_tables())}.")
    rows = _read(table)
    known = rows["wavelength_nm"].to_numpy()
    wavelengths = require_wavelengths(wavelengths_nm, known[0], known[-1], what=table)
    n, k = (np.interp(wavelengths, known, rows[name].to_numpy()) for name in ("n", "k"))
    return n, k


@lru_cache
def _read(table: str) -> pd.DataFrame:
    return pd.read_csv(_FOLDER / f"{table}.csv", comment="#")
