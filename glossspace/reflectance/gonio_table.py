"""A gonio-spectrophotometer's table of BRDF values: its grid, its gaps, and the rows that it comes from."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import RegularGridInterpolator
from scipy.ndimage import distance_transform_edt

from glossspace.errors import GlossError
from glossspace.metric.validity import FloatArray, as_floats

__all__ = ["FILLS", "as_grid_axis", "grid_from_rows", "with_whole_turn", "without_gaps"]

FILLS = ("refuse", "nearest", "along-exitant", "reciprocal")

Axes = tuple[FloatArray, FloatArray, FloatArray]


def as_grid_axis(values: ArrayLike, *, name: str, last: float) -> FloatArray:
    """At least two ascending angles between 0 and `last` degrees.

    Raises
    ------
    GlossError
        They are not.
    """
    axis = as_floats(values, name=name)
    fits = axis.ndim == 1 and axis.size >= 2 and np.all(np.diff(axis) > 0) and axis[0] >= 0 and axis[-1] <= last
    if not fits:
        raise GlossError(
            f"{name} must be at least two ascending angles between 0 and {last:g} degrees, but is {axis.tolist()}."
        )
    return axis


def with_whole_turn(phi_deg: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Table over azimuths of 0 to 360 degrees: one over 0 to 180 is mirrored at the plane of incidence.

    Raises
    ------
    GlossError
        The azimuths run neither from 0 to 180 nor from 0 to 360.
    """
    if phi_deg[0] == 0 and phi_deg[-1] == 180:
        mirrored = np.flip(values[:, :, :-1], axis=2)
        return np.concatenate([phi_deg, 360 - phi_deg[-2::-1]]), np.concatenate([values, mirrored], axis=2)
    if phi_deg[0] == 0 and phi_deg[-1] == 360:
        return phi_deg, values
    raise GlossError(
        f"phi_deg must run from 0 to 180 (then the other side is its mirror image) or from 0 to 360 degrees, but runs "
        f"from {phi_deg[0]:g} to {phi_deg[-1]:g}. Repeat the first azimuth's values at 360."
    )


def without_gaps(axes: Axes, values: FloatArray, fill: str) -> FloatArray:
    """The table with its NaN filled in the way that is asked for.

    Parameters
    ----------
    axes : tuple of ndarray
        Polar angles of incidence and exitance, and azimuths of half a turn or a whole one, in degrees.
    values : ndarray of float64, shape (I, R, P, K)
        BRDF (1/sr), NaN where nothing was measured.
    fill : str
        ``refuse``; ``nearest``, the node nearest by steps of the grid; ``along-exitant``, linear between the measured
        polar angles of exitance, the last of which is held; or ``reciprocal``, the value of the swapped directions.

    Raises
    ------
    GlossError
        The fill is unknown, there are gaps that it refuses, or it leaves some.
    """
    if fill not in FILLS:
        raise GlossError(f"Unknown way '{fill}' to fill gaps. Allowed are {', '.join(FILLS)}.")
    gaps = np.isnan(values)
    if not gaps.any():
        return values
    filled = values.copy()
    if fill == "nearest" and not gaps.all():
        for channel in range(values.shape[3]):
            if not gaps[..., channel].all():
                nearest = distance_transform_edt(gaps[..., channel], return_distances=False, return_indices=True)
                filled[..., channel] = values[..., channel][tuple(nearest)]
    elif fill == "along-exitant":
        for i, p, k in {(i, p, k) for i, _, p, k in np.argwhere(gaps)}:
            known = ~gaps[i, :, p, k]
            if known.any():
                filled[i, :, p, k] = np.interp(axes[1], axes[1][known], values[i, known, p, k])
    elif fill == "reciprocal":
        filled = np.where(gaps, _swapped(axes, values), values)
    left = np.isnan(filled)
    if left.any():
        i, r, p, _ = np.argwhere(left)[0]
        count = int(left.sum())
        others = [name for name in FILLS[1:] if name != fill]
        raise GlossError(
            f"The table has {count} gap{'s' if count > 1 else ''} among {left.size} values"
            f"{'' if fill == 'refuse' else f' that the fill {fill!r} leaves'}; the first is at incidence "
            f"{axes[0][i]:g}°, exitance {axes[1][r]:g}°, azimuth {axes[2][p]:g}°. Measure them, or fill them by "
            f"{' or '.join(others)}."
        )
    return filled


def _swapped(axes: Axes, values: FloatArray) -> FloatArray:
    """Values at the nodes' swapped directions; NaN outside the table and where a gap takes part."""
    theta_i, theta_o, phi = np.meshgrid(*axes, indexing="ij")
    back = np.stack([theta_o, theta_i, phi if axes[2][-1] == 180 else 360 - phi], axis=-1)
    gaps = np.isnan(values)
    # Separately, since a gap would spoil its neighbours through weights of zero.
    value = RegularGridInterpolator(axes, np.where(gaps, 0.0, values), bounds_error=False)(back)
    missing = RegularGridInterpolator(axes, gaps.astype(float), bounds_error=False)(back)
    return np.where(missing > 1e-9, np.nan, value)


def grid_from_rows(
    theta_incident_deg: ArrayLike, theta_exitant_deg: ArrayLike, phi_deg: ArrayLike, values: ArrayLike
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Table from rows in any order, one for each pair of directions; a pair that is missing becomes a gap.

    Parameters
    ----------
    theta_incident_deg, theta_exitant_deg, phi_deg : array_like, shape (N,)
        Polar angles, and azimuth of exitance minus that of incidence, in degrees.
    values : array_like, shape (N,) or (N, K)
        BRDF (1/sr), at K wavelengths.

    Returns
    -------
    tuple of ndarray
        The three axes of `Tabulated`, and its values (I, R, P) or (I, R, P, K) with NaN in the gaps.

    Raises
    ------
    GlossError
        The columns are not equally long, an angle is not finite, or a pair of directions stands twice.

    Examples
    --------
    >>> *axes, values = grid_from_rows([0, 0, 45, 45], [0, 45, 0, 45], [0, 0, 0, 180], [0.3, 0.2, 0.2, 0.9])
    >>> [axis.tolist() for axis in axes], int(np.isnan(values).sum())
    ([[0.0, 45.0], [0.0, 45.0], [0.0, 180.0]], 4)
    """
    columns = [
        as_floats(column, name=name)
        for name, column in (
            ("theta_incident_deg", theta_incident_deg),
            ("theta_exitant_deg", theta_exitant_deg),
            ("phi_deg", phi_deg),
        )
    ]
    table = as_floats(values, name="values")
    shapes = {column.shape for column in columns} | {table.shape[:1]}
    if len(shapes) > 1 or table.ndim not in (1, 2) or table.size == 0:
        raise GlossError(f"A table needs equally many angles and values, but their shapes are {sorted(shapes)}.")
    if not all(np.isfinite(column).all() for column in columns):
        raise GlossError("A row's angle is not a finite number. Leave out rows without directions.")
    axes, places = zip(*(np.unique(column, return_inverse=True) for column in columns), strict=True)
    size = tuple(axis.size for axis in axes)
    flat = np.ravel_multi_index(places, size)
    first_again = np.setdiff1d(np.arange(flat.size), np.unique(flat, return_index=True)[1])
    if first_again.size:
        angles = ", ".join(f"{column[first_again[0]]:g}°" for column in columns)
        raise GlossError(
            f"The directions {angles} (incidence, exitance, azimuth) stand in more than one row. Average them."
        )
    grid = np.full((*size, *table.shape[1:]), np.nan)
    grid[places] = table
    return axes[0], axes[1], axes[2], grid
