"""Nodes of Gauss–Legendre quadrature over a pair of apertures.

One aperture, the smaller, carries a grid of nodes. For each of them the nodes on the other are laid about the point to
which a mirror would send the light, in panels as wide as the lobe, since that is where the reflectance varies. On an
aperture that the horizon cuts, the distance from the horizon is the square of the variable: reflectance times cosine
may rise like the root of that distance.

The lobe of a brushed sample that is turned obliquely is a ridge across the inner aperture. Along one axis its panels
then cover the whole ridge; along the other they lie about it, whose place is computed for each node of the first.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import cast

import numpy as np

from glossspace.instruments.apertures import Aperture
from glossspace.instruments.lobes import LobeShape, Ridge
from glossspace.metric.validity import FloatArray

__all__ = ["Nodes", "Orders", "first_orders", "make_nodes"]

Orders = tuple[int, int, int, int]
"""Gauss–Legendre orders: along and across the outer aperture, along and across each panel of the inner one."""

# A lobe without an end has a first panel of its own width, where its poles are, and panels that grow by this factor.
_GROWTH = 4.0
_PANEL_WITHOUT_REACH = 1.0
# Lobes of one shape differ by up to this factor, by which `LobeShape` rounds.
_ROUNDING = math.sqrt(2)
_NEWTON, _MISSED = 12, 1e-9
_CACHED_NODES = 16_384  # half a megabyte each


@dataclass(frozen=True, eq=False)
class Nodes:
    """Pairs of directions with weights that add to one, each weight including the solid angle but no cosine.

    Attributes
    ----------
    outer : ndarray, shape (n, 1, 3)
        Directions in the outer aperture.
    inner : ndarray, shape (n, m, 3)
        Directions in the inner one.
    weight : ndarray, shape (n, m)
        Weights of the mean over both solid angles.
    """

    outer: FloatArray
    inner: FloatArray
    weight: FloatArray


def make_nodes(outer: Aperture, inner: Aperture, shape: LobeShape, orders: Orders) -> Nodes:
    """Nodes for a lobe of a given shape. Small sets are kept for the next paint with the same shape."""
    if shape.ridge is not None:
        return _nodes(outer, inner, shape, orders)
    n_panels = math.prod(2 * len(_offsets(inner, half, shape)) + 1 for half in _half_widths(outer, shape))
    if math.prod(orders) * n_panels <= _CACHED_NODES:
        return _cached_nodes(outer, inner, shape, orders)
    return _nodes(outer, inner, shape, orders)


def first_orders(outer: Aperture, inner: Aperture, shape: LobeShape) -> Orders:
    """Orders to begin with, from the widths of the apertures in units of the lobe's. The quadrature tests them."""
    halves = _half_widths(outer, shape)
    orders = []
    for extent, half, margin in zip((outer.x_range, outer.y_range), halves, _margins(outer, inner), strict=True):
        # Where all of the lobe is within the inner aperture, whatever the node of the outer one, little varies; and
        # so where the edges that cut its tail are further than the outer aperture is wide.
        width = (extent[1] - extent[0]) / 2
        deep = shape.ridge is None and margin > (
            shape.reach * half if math.isfinite(shape.reach) else max(width, 3 * half)
        )
        widths = 0.8 if deep else min(width / half, 3.0)
        orders.append(1 if extent[0] == extent[1] else 2 + math.ceil(2.5 * widths))
    if shape.ridge is not None:
        free = 1 - _bound_axis(inner, shape.ridge)
        extents = _ridge_extents(outer, shape.ridge)
        halves = (extents[0], halves[1]) if free == 0 else (halves[0], extents[1])
    for extent, half in zip((inner.x_range, inner.y_range), halves, strict=True):
        widest = 7.0 if math.isfinite(shape.reach) else _PANEL_WITHOUT_REACH
        widths = min((extent[1] - extent[0]) / 2 / half, widest)
        orders.append(1 if extent[0] == extent[1] else 4 + math.ceil(3.6 * widths))
    return orders[0], orders[1], orders[2], orders[3]


def _margins(outer: Aperture, inner: Aperture) -> tuple[float, float]:
    """How far the mirror image of the outer aperture stays within the inner one; negative where it does not."""
    x, y = np.meshgrid(outer.x_range, outer.y_range)
    points = inner.mirror_points(outer.directions(x, y)[0])
    margins = [
        -math.inf if np.any(np.isnan(point)) else min(high - float(np.max(point)), float(np.min(point)) - low)
        for point, (low, high) in zip(points, (inner.x_range, inner.y_range), strict=True)
    ]
    return margins[0], margins[1]


def _half_widths(outer: Aperture, shape: LobeShape) -> tuple[float, float]:
    """Half widths of the lobe on the plane of an aperture: twice the half vector's slope, and in projection across."""
    cosine = math.cos(math.radians(min(outer.theta_deg, 89.9)))
    return 2 * shape.in_plane, 2 * shape.across * cosine


def _offsets(inner: Aperture, half: float, shape: LobeShape) -> list[float]:
    """Distances of the panels' edges from the mirror point, ascending, none wider than any aperture needs."""
    if not math.isfinite(half):
        return []
    reach = shape.reach * _ROUNDING if math.isfinite(shape.reach) else _PANEL_WITHOUT_REACH
    diameter = sum(hi - lo for lo, hi in (inner.x_range, inner.y_range))
    offsets = [reach * half]
    while offsets[-1] < diameter:
        offsets.append(offsets[-1] * _GROWTH)
    return offsets[:-1] if len(offsets) > 1 else []


@lru_cache(maxsize=128)
def _cached_nodes(outer: Aperture, inner: Aperture, shape: LobeShape, orders: Orders) -> Nodes:
    return _nodes(outer, inner, shape, orders)


def _nodes(outer: Aperture, inner: Aperture, shape: LobeShape, orders: Orders) -> Nodes:
    x, weight_x = _rule(np.array([outer.x_range]), orders[0], squared=outer.touches_horizon)
    y, weight_y = _rule(np.array([outer.y_range]), orders[1], squared=False)
    directions, density = outer.directions(x[0][:, None], y[0][None, :])
    outer_weight = (weight_x[0][:, None] * weight_y[0][None, :] * density).ravel()
    directions = directions.reshape(-1, 3)

    rules = _crossed_rules if shape.ridge is None else _ridge_rules
    x, y, inner_weight = rules(outer, inner, shape, (orders[2], orders[3]), directions)
    exitant, density = inner.directions(x, y)
    weight = (inner_weight * density).reshape(len(directions), -1)
    weight = weight * outer_weight[:, None] / (_size(outer) * _size(inner))
    nodes = Nodes(directions[:, None, :], exitant.reshape(len(directions), -1, 3), weight)
    for array in (nodes.outer, nodes.inner, nodes.weight):
        array.flags.writeable = False
    return nodes


def _crossed_rules(
    outer: Aperture, inner: Aperture, shape: LobeShape, orders: tuple[int, int], directions: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Points x (n, X, 1) and y (n, 1, Y) of the inner aperture for each direction of the outer; weights (n, X, Y)."""
    points = inner.mirror_points(directions)
    ranges = (inner.x_range, inner.y_range)
    within = all(np.all((p >= lo) & (p <= hi)) for p, (lo, hi) in zip(points, ranges, strict=True))
    rules = []
    for point, extent, half, order, squared in zip(
        points, ranges, _half_widths(outer, shape), orders, (inner.touches_horizon, False), strict=True
    ):
        edges = _edges(point, extent, _offsets(inner, half, shape), over=within and math.isfinite(shape.reach))
        rules.append(_rule(edges, order, squared=squared))
    (x, weight_x), (y, weight_y) = rules
    return x[:, :, None], y[:, None, :], weight_x[:, :, None] * weight_y[:, None, :]


def _ridge_rules(
    outer: Aperture, inner: Aperture, shape: LobeShape, orders: tuple[int, int], directions: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """As `_crossed_rules`, of a ridge: the points along one axis, (n, X, Y), follow it.

    Panels of the other axis end also where the ridge enters and leaves the aperture, and a width before and after.
    """
    ridge = cast(Ridge, shape.ridge)
    bound = _bound_axis(inner, ridge)
    free, ranges, halves = 1 - bound, (inner.x_range, inner.y_range), _half_widths(outer, shape)
    squared = (inner.touches_horizon, False)
    point = inner.mirror_points(directions)[free][:, None]
    near = np.array(_offsets(inner, _ridge_extents(outer, ridge)[free], shape))
    steep = np.array([0.0, *_offsets(inner, halves[free], shape)[:1]])
    gates = _on_ridge(directions, inner, ridge, free, np.array([ranges[bound]]))
    edges = [point + offset for offset in (-near, near)]
    edges += [gates[:, [k]] + sign * steep for k in (0, 1) for sign in (-1, 1)]
    low, high = ranges[free]
    ends = np.broadcast_to([low, high], (len(directions), 2))
    inside = np.concatenate([ends, *edges], axis=1)
    inside = np.sort(np.clip(np.where(np.isfinite(inside), inside, high), low, high), axis=1)
    some_length = np.any(np.diff(inside, axis=1) > 0, axis=0)
    if some_length.any():
        inside = inside[:, np.concatenate([[True], some_length])]
    at, weight = _rule(inside, orders[free], squared=squared[free])
    about = _on_ridge(directions, inner, ridge, bound, at).reshape(-1)
    around = _edges(about, ranges[bound], _offsets(inner, halves[bound], shape), over=False)
    follows, weight_follows = (
        part.reshape(*at.shape, -1) for part in _rule(around, orders[bound], squared=squared[bound])
    )
    at, weights = at[:, :, None], weight[:, :, None] * weight_follows
    if bound == 1:
        return at, follows, weights
    return follows.swapaxes(1, 2), at.swapaxes(1, 2), weights.swapaxes(1, 2)


def _bound_axis(inner: Aperture, ridge: Ridge) -> int:
    """Axis of the inner aperture along which the ridge is the narrower: 0 along theta, 1 across."""
    along, across, _ = inner.frame @ _narrow_axis(ridge)
    return int(abs(across) > abs(along))


def _narrow_axis(ridge: Ridge) -> FloatArray:
    narrow = math.radians(ridge.narrow_deg)
    return np.array([math.cos(narrow), math.sin(narrow), 0.0])


def _ridge_extents(outer: Aperture, ridge: Ridge) -> tuple[float, float]:
    return _half_widths(outer, LobeShape(ridge.in_plane, ridge.across, math.inf))


def _on_ridge(directions: FloatArray, inner: Aperture, ridge: Ridge, axis: int, other: FloatArray) -> FloatArray:
    """Where along an axis half vectors have no slope on the narrow axis, for places `other` (n or 1, m) on the other.

    Newton's iterations; NaN where there is no such place.
    """
    narrow = _narrow_axis(ridge)
    along, centre = inner.frame[axis] @ narrow, inner.frame[1 - axis] @ narrow * other + inner.frame[2] @ narrow
    incident = (directions @ narrow)[:, None]
    at = np.zeros((len(directions), other.shape[1]))
    with np.errstate(all="ignore"):
        for _ in range(_NEWTON):
            length = np.sqrt(1 + other**2 + at**2)
            at = at - (at * along + centre + incident * length) / (along + incident * at / length)
            at = np.clip(at, -2.0, 2.0)
        missed = np.abs(at * along + centre + incident * np.sqrt(1 + other**2 + at**2))
    return np.where(missed < _MISSED, at, np.nan)


def _size(aperture: Aperture) -> float:
    """Integral of the rules' own weights: solid angle, or what is left of it in the limit of zero width."""
    if aperture.solid_angle > 0 and aperture.width_in_plane_deg > 0 and aperture.width_across_deg > 0:
        return aperture.solid_angle
    # A line: its length against d x / (1 + x²)^(3/2), whose integral is x / sqrt(1 + x²); a point: one.
    lengths = [
        hi / math.sqrt(1 + hi * hi) - lo / math.sqrt(1 + lo * lo)
        for lo, hi in (aperture.x_range, aperture.y_range)
        if hi > lo
    ]
    return math.prod(lengths)


def _edges(point: FloatArray, extent: tuple[float, float], offsets: list[float], *, over: bool) -> FloatArray:
    """Edges of the panels about each mirror point, shape (n, panels + 1), ascending; panels without length stay."""
    low, high = extent
    about = np.where(np.isfinite(point), point, high)[:, None]
    near = np.array(offsets)
    if over and offsets:  # what lies beyond the lobe's reach is a billionth of what lies within
        return np.clip(about + np.array([-near[0], near[0]]), low, high)
    inside = np.clip(about + np.concatenate([-near[::-1], near]), low, high)
    inside = inside[:, np.any((inside > low) & (inside < high), axis=0)]
    ends = np.broadcast_to([low, high], (len(point), 2))
    return np.concatenate([ends[:, :1], inside, ends[:, 1:]], axis=1)


def _rule(edges: FloatArray, order: int, *, squared: bool) -> tuple[FloatArray, FloatArray]:
    """Points and weights (n, panels * order) on panels with the given edges; one point of weight one without length.

    With `squared`, the variable is the root of the distance from the last edge.
    """
    last = edges[:, -1:]
    if np.all(last == edges[:, :1]):
        return edges[:, :1].copy(), np.ones_like(last)
    points, weights = _gauss_legendre(order)
    bounds = np.sqrt(np.maximum(last - edges, 0.0)) if squared else edges
    middle, half = (bounds[:, 1:] + bounds[:, :-1]) / 2, (bounds[:, 1:] - bounds[:, :-1]) / 2
    at = (middle[:, :, None] + half[:, :, None] * points).reshape(len(edges), -1)
    weight = (half[:, :, None] * weights).reshape(len(edges), -1)
    return (last - at * at, -2 * at * weight) if squared else (at, weight)


@lru_cache(maxsize=256)
def _gauss_legendre(order: int) -> tuple[FloatArray, FloatArray]:
    points, weights = np.polynomial.legendre.leggauss(order)
    return points, weights
