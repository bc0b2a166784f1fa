"""Spectral parameters of a model at the wavelengths that an instrument asks for."""

import numpy as np
from numpy.typing import ArrayLike

from glossspace.errors import GlossError
from glossspace.metric.validity import FloatArray, as_floats

__all__ = ["as_wavelengths", "at_wavelengths"]


def at_wavelengths(values: ArrayLike, wavelengths_nm: ArrayLike, wanted_nm: ArrayLike) -> FloatArray:
    """Values of a spectrum at other wavelengths, by linear interpolation and never beyond the table.

    Parameters
    ----------
    values : array_like, shape (..., K)
        What was measured at each wavelength, such as an index of refraction or a BRDF.
    wavelengths_nm : array_like, shape (K,)
        The wavelengths in nanometres, ascending.
    wanted_nm : array_like, shape (M,) or ()
        The wavelengths asked for.

    Returns
    -------
    ndarray of float64, shape (..., M) or (...)
        The spectrum there.

    Raises
    ------
    GlossError
        A wavelength lies outside the table, whose range is then named, or the table's are not ascending.

    Examples
    --------
    >>> round(float(at_wavelengths([0.46, 0.26], [580.0, 600.0], 585.0)), 6)
    0.41
    """
    table = as_wavelengths(wavelengths_nm)
    spectrum, wanted = as_floats(values, name="values"), as_floats(wanted_nm, name="wavelengths")
    if spectrum.ndim == 0 or spectrum.shape[-1] != table.size:
        raise GlossError(f"The spectrum of shape {spectrum.shape} does not fit its {table.size} wavelengths.")
    inside = (wanted >= table[0]) & (wanted <= table[-1])
    if not np.all(inside):
        raise GlossError(
            f"Wavelength {float(wanted[~inside].flat[0]):g} nm lies outside the table, which runs from {table[0]:g} to "
            f"{table[-1]:g} nm. Ask for wavelengths within it, or give a longer table."
        )
    if table.size == 1:
        return spectrum[..., np.zeros(wanted.shape, dtype=int)]
    below = np.clip(np.searchsorted(table, wanted, side="right") - 1, 0, table.size - 2)
    share = (wanted - table[below]) / (table[below + 1] - table[below])
    return spectrum[..., below] * (1 - share) + spectrum[..., below + 1] * share


def as_wavelengths(wavelengths_nm: ArrayLike) -> FloatArray:
    """Wavelengths in nanometres, shape (K,).

    Raises
    ------
    GlossError
        They are no ascending list of positive numbers.
    """
    table = as_floats(wavelengths_nm, name="wavelengths")
    usable = table.ndim == 1 and table.size > 0 and np.all(np.isfinite(table) & (table > 0))
    if not usable or np.any(np.diff(table) <= 0):
        raise GlossError(f"Wavelengths must be an ascending list of positive nanometres, but are {table.tolist()}.")
    return table
