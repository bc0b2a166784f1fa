"""The half vector between two directions, and mirroring at one: what every microfacet lobe is written in."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from glossspace.metric.validity import FloatArray
from glossspace.reflectance.model import as_directions, over_channels

__all__ = ["HalfVector", "half_vector", "mirrored", "mirrored_at_slopes"]

# Directions closer to the horizon than this count as at it: squares of their cosines would leave double precision.
_HORIZON = 1e-100


@dataclass(frozen=True)
class HalfVector:
    """Cosines of pairs of directions and of their half vector; one wherever the pair is not above the horizon.

    With channels, each array has a last axis of one.

    Attributes
    ----------
    above : ndarray of bool
        Whether both directions are above the horizon.
    unknown : ndarray of bool
        Whether a direction has NaN.
    cos_i, cos_o : ndarray of float64
        Cosines of incidence and exitance.
    x, y, z : ndarray of float64
        The sum i + o, which is the half vector times 2 (h·i).
    half_dot_i : ndarray of float64
        Cosine between the half vector and either direction.
    cos2_delta : ndarray of float64
        Squared cosine between the half vector and the normal.
    """

    above: NDArray[np.bool_]
    unknown: NDArray[np.bool_]
    cos_i: FloatArray
    cos_o: FloatArray
    x: FloatArray
    y: FloatArray
    z: FloatArray
    half_dot_i: FloatArray
    cos2_delta: FloatArray

    def reflected(self, value: FloatArray) -> FloatArray:
        """The value above the horizon, zero at and below it, NaN where a direction has NaN."""
        return np.where(self.above, value, np.where(self.unknown, np.nan, 0.0))[()]


def half_vector(incident: ArrayLike, exitant: ArrayLike, channels: int | None = None) -> HalfVector:
    """Half vectors of pairs of unit directions (..., 3) that broadcast.

    Raises
    ------
    GlossError
        A direction is not of unit length.
    """
    i, o = as_directions(incident, name="incident"), as_directions(exitant, name="exitant")
    total = i + o
    unknown = np.asarray(np.isnan(total).any(axis=-1))
    above = np.asarray((i[..., 2] > _HORIZON) & (o[..., 2] > _HORIZON) & ~unknown)
    x, y, z = (np.where(above, total[..., axis], default) for axis, default in ((0, 0.0), (1, 0.0), (2, 2.0)))
    length2 = x * x + y * y + z * z
    arrays = (
        np.where(above, i[..., 2], 1.0),
        np.where(above, o[..., 2], 1.0),
        x,
        y,
        z,
        0.5 * np.sqrt(length2),  # |i + o| = 2 h·i for unit vectors
        z * z / length2,
    )
    return HalfVector(
        over_channels(above, channels), over_channels(unknown, channels), *(over_channels(a, channels) for a in arrays)
    )


def mirrored(incident: FloatArray, half: FloatArray) -> FloatArray:
    """Unit directions (..., 3) that leave facets of unit normals `half` when light comes from `incident`."""
    return 2 * np.sum(incident * half, axis=-1, keepdims=True) * half - incident


def mirrored_at_slopes(incident: FloatArray, slope_x: FloatArray, slope_y: FloatArray) -> FloatArray:
    """Unit directions (..., 3) that leave facets of slopes (p, q) = (hx/hz, hy/hz) when light comes from `incident`."""
    slopes = np.stack([slope_x, slope_y, np.ones_like(slope_x)], axis=-1)
    return mirrored(incident, slopes / np.linalg.norm(slopes, axis=-1, keepdims=True))
