"""How wide the lobe of a reflectance model is, measured on the model itself, so that any model can be integrated.

The half vector is tilted from the normal in the plane of incidence, towards the normal, and across it. The slope at
which the BRDF has fallen to 1/e is the width of the lobe; where it has fallen to a billionth, the lobe is over. An
anisotropic lobe of Ward's whose axes are oblique to the plane of incidence is a ridge, which both tilts cut crosswise:
its extents along both come from its two roughnesses.
"""

import math
from dataclasses import dataclass, fields, replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from glossspace.metric.validity import FloatArray
from glossspace.reflectance import CookTorrance, Ggx, Lambert, Phong, Sum, Ward
from glossspace.reflectance.model import ReflectanceModel

__all__ = ["LobeShape", "Ridge", "components", "lobe_shapes", "take_channels"]

# From a hundredth of the narrowest roughness that is asked for, to a half vector at 40 degrees.
_SLOPES = np.geomspace(1e-5, math.tan(math.radians(40)), 56)
_OVER = 1e-9
# A Gaussian is over after five widths. Beyond that many, what has fallen to a billionth may still hold a share that
# counts, since the area grows: GGX has a hundred-thousandth of its light there.
_LONGEST_REACH = 12.0
# Below this sine, an axis of an anisotropic lobe counts as in the plane of incidence.
_ALIGNED = 1e-9


@dataclass(frozen=True)
class Ridge:
    """An anisotropic lobe that is oblique to the plane of incidence.

    Attributes
    ----------
    narrow_deg : float
        Azimuth of the narrow axis.
    in_plane, across : float
        Slopes of the half vector to which the lobe extends, whatever the other slope; those of `LobeShape` are at none.
    """

    narrow_deg: float
    in_plane: float
    across: float


@dataclass(frozen=True)
class LobeShape:
    """Widths of a lobe in slopes of the half vector, rounded so that similar lobes share their nodes.

    Attributes
    ----------
    in_plane, across : float
        Slope of the half vector at which the BRDF is 1/e of its value at the mirror direction, rounded down to a power
        of the square root of two; infinite for a model that has no lobe.
    reach : float
        In units of those, where the lobe is over; infinite for one with a long tail.
    ridge : Ridge, optional
        Of an anisotropic lobe whose axes are oblique.
    """

    in_plane: float
    across: float
    reach: float
    ridge: Ridge | None = None


def components(model: ReflectanceModel) -> tuple[ReflectanceModel, ...]:
    """Give the terms of a sum, each of which has a lobe of its own; the model itself if it is no sum."""
    if isinstance(model, Sum):
        return tuple(part for term in model.models for part in components(term))
    return (model,)


def lobe_shapes(model: ReflectanceModel, theta_deg: float, phi_deg: float) -> list[tuple[LobeShape, NDArray[np.intp]]]:
    """Shapes of the lobe of a model, each with the channels that have it.

    Parameters
    ----------
    model : ReflectanceModel
        One lobe, not a sum.
    theta_deg, phi_deg : float
        Where the light comes from.

    Returns
    -------
    list of (LobeShape, ndarray of int)
        One item for a model without channels, whose array is empty.
    """
    theta, phi = math.radians(min(theta_deg, 89.9)), math.radians(phi_deg)
    incident = np.array([math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)])
    outward = np.array([math.cos(phi), math.sin(phi), 0.0])
    sideways = np.array([-math.sin(phi), math.cos(phi), 0.0])
    widths, reaches = [], []
    for tilt in (outward, sideways):
        slopes = np.concatenate([[0.0], _SLOPES])
        half = np.array([0.0, 0.0, 1.0]) + slopes[:, None] * tilt
        half /= np.linalg.norm(half, axis=-1, keepdims=True)
        exitant = 2 * (half @ incident)[:, None] * half - incident
        exitant[:, 2] = np.maximum(exitant[:, 2], 1e-9)
        exitant /= np.linalg.norm(exitant, axis=-1, keepdims=True)
        values = model.evaluate(incident, exitant).reshape(len(slopes), -1)
        relative = values[1:] / np.where(values[0] > 0, values[0], np.inf)
        widths.append(_first_slope_below(relative, math.exp(-1), values[0] > 0))
        over = _first_slope_below(relative, _OVER, values[0] > 0)
        reaches.append(np.where(np.isfinite(over), over / np.where(np.isfinite(widths[-1]), widths[-1], 1.0), np.inf))
    reach = np.maximum(*reaches)
    reach = np.where(reach > _LONGEST_REACH, np.inf, reach)
    rounded = np.stack([*map(_rounded_down, widths), np.ceil(2 * reach) / 2], axis=-1)
    rounded = np.concatenate([rounded, _ridges(model, phi, len(rounded))], axis=-1)
    if model.channels is None:
        return [(_shape(rounded[0]), np.array([], dtype=int))]
    if not _separable(model):
        narrowest = (*rounded[:, :2].min(axis=0), rounded[:, 2].max(), 0.0, 0.0, 0.0)  # no ridge: that is Ward's alone
        return [(_shape(np.array(narrowest)), np.arange(model.channels))]
    shapes, which = np.unique(rounded, axis=0, return_inverse=True)
    return [(_shape(shape), np.flatnonzero(which.ravel() == k)) for k, shape in enumerate(shapes)]


def _rounded_down(width: FloatArray) -> FloatArray:
    return 2.0 ** (np.floor(2 * np.log2(width)) / 2)


def _shape(row: FloatArray) -> LobeShape:
    in_plane, across, reach, *ridge = row.tolist()
    return LobeShape(in_plane, across, reach, Ridge(*ridge) if ridge[1] > 0 else None)


def _ridges(model: ReflectanceModel, phi: float, n: int) -> FloatArray:
    """Attributes of the `Ridge` of each channel, shape (n, 3); zeros where the lobe is none."""
    sine, cosine = math.sin(phi), math.cos(phi)
    if not isinstance(model, Ward) or min(abs(sine), abs(cosine)) < _ALIGNED:
        return np.zeros((n, 3))
    alpha_x, alpha_y = np.broadcast_to(model.alpha, n), np.broadcast_to(cast(FloatArray, model.alpha_y), n)
    narrow_deg = np.where(alpha_y < alpha_x, 90.0, 0.0)
    extents = [_rounded_down(np.hypot(alpha_x * x, alpha_y * y)) for x, y in ((cosine, sine), (sine, cosine))]
    return np.where((alpha_x == alpha_y)[:, None], 0.0, np.stack([narrow_deg, *extents], axis=-1))


def _first_slope_below(relative: FloatArray, level: float, has_peak: Any) -> FloatArray:
    """Slope of each column at which it first falls below `level`; infinite where it never does."""
    below = relative < level
    first = np.argmax(below, axis=0)
    return np.where(below.any(axis=0) & has_peak, _SLOPES[first], np.inf)


def take_channels(model: ReflectanceModel, channels: NDArray[np.intp]) -> ReflectanceModel:
    """Give a term of some of its channels, by their positions; a model that cannot be parted, as it is."""
    if not _separable(model):
        return model
    taken = {
        field.name: getattr(model, field.name)[channels]
        for field in fields(cast(Any, model))
        if np.ndim(getattr(model, field.name)) == 1
    }
    return cast(ReflectanceModel, replace(cast(Any, model), **taken))


def _separable(model: ReflectanceModel) -> bool:
    """Whether the channels are lists of parameters, one for each: not in a table, nor in a model of one's own."""
    return model.channels is not None and type(model) in (CookTorrance, Ggx, Lambert, Phong, Ward)
