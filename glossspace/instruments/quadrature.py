"""The double integral of eq. 15 over a source's and a detector's aperture, to an accuracy that it tests itself.

Each term of a sum of models is integrated by itself, with nodes that fit its lobe. The four orders of the rule are
raised one at a time; those that matter are kept, until none does. What raising them changed is added to the result, so
that the error that is reported, the sum of those changes, is that of the rule before them and generous. Of many paints
whose lobes are alike, a few settle the orders for all.
"""

import warnings
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from glossspace.errors import GlossError
from glossspace.instruments.apertures import Aperture
from glossspace.instruments.lobes import LobeShape, components, lobe_shapes, take_channels
from glossspace.instruments.nodes import Orders, first_orders, make_nodes
from glossspace.metric.validity import FloatArray
from glossspace.reflectance.model import ReflectanceModel

__all__ = ["ApertureMean", "QuadratureWarning", "mean_over_apertures", "mean_projection"]

# Where to give up, in evaluations for one lobe: some seconds.
_MOST_NODES = 3_000_000
# Channels that settle the orders for all of their shape.
_PROBES = 12
# Relative error above which nobody should take a result without being told.
_UNSURE = 1e-3
# Error, per steradian, below which that does not matter: so far out in its tail no instrument sees a lobe.
_UNSEEN = 1e-15
_NODES_AT_ONCE = 16_000  # intermediate arrays stay in a core's cache


class QuadratureWarning(UserWarning):
    """A mean over two apertures is not known to a thousandth; `relative_error` says to what."""

    def __init__(self, relative_error: float) -> None:
        super().__init__(f"The quadrature knows the mean over the apertures to ±{100 * relative_error:.2g} % only.")
        self.relative_error = relative_error


@dataclass(frozen=True)
class ApertureMean:
    """A mean over two apertures.

    Attributes
    ----------
    value : ndarray, shape () or (K,)
        Mean of f cosθi cosθr over both solid angles (1/sr).
    relative_error : float
        Estimate of its relative error, for the worst channel.
    n_evaluations : int
        Directions at which the model was evaluated.
    """

    value: FloatArray
    relative_error: float
    n_evaluations: int


@dataclass
class _Term:
    """One lobe of one shape: its rule, and what that gave for the few channels that settle it."""

    model: ReflectanceModel
    few: ReflectanceModel
    channels: NDArray[np.intp]
    shape: LobeShape
    orders: Orders
    value: FloatArray
    change: FloatArray = field(default_factory=lambda: np.zeros(()))


def mean_over_apertures(
    model: ReflectanceModel, source: Aperture, detector: Aperture, *, relative_tolerance: float = 1e-6
) -> ApertureMean:
    """Mean of f cosθi cosθr over the solid angles of a source and a detector: eq. 15 without radiance and area.

    Parameters
    ----------
    model : ReflectanceModel
        Reflectance; its channels, if any, are integrated together.
    source, detector : Aperture
        Parts below the horizon count for nothing. Zero widths give the limit.
    relative_tolerance : float
        Wanted relative error, 1e-12 to .1.

    Returns
    -------
    ApertureMean
        Value, error and cost. The error is above the tolerance only where the model has edges that rules of some
        million nodes do not resolve: a table that is linear between its nodes, V-grooves near the horizon, whose
        attenuation has a kink where one cosine is a third of the other, or a narrow lobe in a long slit.

    Warns
    -----
    QuadratureWarning
        The error is above a thousandth, and above 1e-15 per steradian: far out in its tail a lobe is negligible.

    Raises
    ------
    GlossError
        The tolerance is out of its range, or the model is not finite somewhere in the apertures.

    Examples
    --------
    >>> from glossspace.reflectance import Lambert
    >>> mean = mean_over_apertures(Lambert(1.0), Aperture(0), Aperture(60))
    >>> round(float(mean.value) * np.pi, 6)  # a point source and a point detector: cos 0 cos 60
    0.5
    """
    if not 1e-12 <= relative_tolerance <= 0.1:
        raise GlossError(f"Invalid relative_tolerance = {relative_tolerance!r}. Allowed: 1e-12 to 0.1.")
    swap = detector.solid_angle < source.solid_angle
    outer, inner = (detector, source) if swap else (source, detector)
    terms, cost = [], 0
    for part in components(model):
        for shape, channels in lobe_shapes(part, outer.theta_deg, outer.phi_deg):
            few = take_channels(part, channels[:: max(1, len(channels) // _PROBES)])
            orders = first_orders(outer, inner, shape)
            value, n = _apply(few, outer, inner, shape, orders, swap)
            terms.append(_Term(part, few, channels, shape, orders, value))
            cost += n
    for term in terms:
        # Another term may be all that counts; how much it reflects is known if every channel of both was tried.
        known = all(len(other.channels) == 0 for other in terms)
        of = sum(other.value for other in terms) if known else term.value
        change, n = _refine(term, outer, inner, swap, tolerance=relative_tolerance * np.abs(of))
        term.change, cost = change, cost + n
    error: FloatArray = np.zeros(() if model.channels is None else model.channels)
    for term in terms:
        change = term.change
        if len(term.channels) > np.size(term.value):
            with np.errstate(invalid="ignore", divide="ignore"):
                change = np.nanmax(np.where(term.value != 0, change / np.abs(term.value), 0.0))
            taken = take_channels(term.model, term.channels)
            term.value, n = _apply(taken, outer, inner, term.shape, term.orders, swap)
            change, cost = change * np.abs(term.value), cost + n
        if error.ndim and term.channels.size:
            error[term.channels] += change
        else:
            error = error + change
    value = _total(terms, model.channels)
    with np.errstate(invalid="ignore", divide="ignore"):
        relative = np.where(value != 0, error / np.abs(value), 0.0)
    unsure = float(np.max(np.where(error > _UNSEEN, relative, 0.0)))
    if unsure > _UNSURE:
        warnings.warn(QuadratureWarning(unsure), stacklevel=2)
    return ApertureMean(value, float(np.max(relative)), cost)


def _refine(
    term: _Term, outer: Aperture, inner: Aperture, swap: bool, *, tolerance: FloatArray
) -> tuple[FloatArray, int]:
    """Raise the orders of a term until it stands still. Gives the last changes, summed, and the cost."""
    cost = 0
    while True:
        changes, raised = [], []
        for axis, order in enumerate(term.orders):
            if order == 1:  # an aperture without width
                raised.append(order)
                continue
            higher = order + max(2, order // 3)
            orders = _with(term.orders, axis, higher)
            value, n = _apply(term.few, outer, inner, term.shape, orders, swap)
            cost += n
            changes.append(value - term.value)
            matters = np.any(np.abs(changes[-1]) > tolerance / 4)
            raised.append(higher if matters else order)
        sizes = np.sum([np.abs(change) for change in changes], axis=0) if changes else np.zeros_like(term.value)
        settled = tuple(raised) == term.orders
        if settled or cost > _MOST_NODES:
            term.value = term.value + np.sum(changes, axis=0) if changes else term.value
            return sizes, cost
        term.orders = (raised[0], raised[1], raised[2], raised[3])
        term.value, n = _apply(term.few, outer, inner, term.shape, term.orders, swap)
        cost += n


def _with(orders: Orders, axis: int, order: int) -> Orders:
    changed = list(orders)
    changed[axis] = order
    return changed[0], changed[1], changed[2], changed[3]


def _apply(
    model: ReflectanceModel, outer: Aperture, inner: Aperture, shape: LobeShape, orders: Orders, swap: bool
) -> tuple[FloatArray, int]:
    """One rule: its value and how many pairs of directions it evaluated."""
    nodes = make_nodes(outer, inner, shape, orders)
    per_row = nodes.weight.shape[1] * (model.channels or 1)
    rows = max(1, _NODES_AT_ONCE // per_row)
    total: FloatArray = np.zeros(() if model.channels is None else model.channels)
    for start in range(0, len(nodes.weight), rows):
        part = slice(start, start + rows)
        pair = (nodes.inner[part], nodes.outer[part]) if swap else (nodes.outer[part], nodes.inner[part])
        weight = nodes.weight[part] * nodes.outer[part, :, 2] * nodes.inner[part, :, 2]
        values = model.evaluate(*pair)
        total = total + np.tensordot(weight, values, axes=2)
    if not np.all(np.isfinite(total)):
        raise GlossError(
            f"The reflectance of {model!r:.200} is not a finite number everywhere in the apertures at "
            f"{outer.theta_deg:g} and {inner.theta_deg:g} degrees. A table with gaps is measured outside them only."
        )
    return total, nodes.weight.size


def _total(terms: list[_Term], channels: int | None) -> FloatArray:
    total: FloatArray = np.zeros(() if channels is None else channels)
    for term in terms:
        if total.ndim and term.channels.size:
            total[term.channels] += term.value
        else:
            total = total + term.value
    return total


def mean_projection(aperture: Aperture) -> float:
    """Mean of the cosine from the normal over an aperture's solid angle.

    Examples
    --------
    >>> round(mean_projection(Aperture(60)), 12)  # a point
    0.5
    """
    nodes = make_nodes(aperture, Aperture(0.0), LobeShape(np.inf, np.inf, np.inf), (24, 24, 1, 1))
    return float(np.sum(nodes.weight * nodes.outer[:, :, 2]))
