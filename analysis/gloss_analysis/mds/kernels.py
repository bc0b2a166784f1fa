"""Kernels of the objective and of its minimisation.

The parameters of a run are one vector: the coordinates that are free, then the transformations that are free. From it
follow the group space Z, each source's space Y_k = Z C_k, the distances in it, and the objective of `objective`. As
P_k is a projection onto a cone, the derivative of |P d|^2 / 2 is P d itself (the envelope theorem), so that the
gradient costs no more than the value.
"""

from typing import NamedTuple

import numpy as np

from gloss_analysis.mds.compiled import compiled
from gloss_analysis.mds.projection import PRIMARY, project, sort_ties

__all__ = [
    "DIAGONAL",
    "FIXED",
    "FULL",
    "Form",
    "Pairs",
    "descend",
    "loss_of_groups",
    "own_pairs",
    "pulls",
    "value_and_gradient",
]

# Transformations C_k: given, diagonal (dimension weights), or any matrix.
FIXED, DIAGONAL, FULL = 0, 1, 2

# Pairs closer than this part of the root mean square distance count as coincident: the direction between them is noise.
_COINCIDENT = 1e-12
_PAIRS_REMEMBERED = 12
_SUFFICIENT = 1e-4


class Pairs(NamedTuple):
    """The judged pairs of all sources, group by group, each group sorted by dissimilarity.

    A group has one transformation: one source where the analysis is matrix-conditional, else all of them.

    Attributes
    ----------
    kind : int
        Kind of projection (see `projection`).
    share : ndarray, shape (n_groups,)
        Part of each group in the objective; they add up to 1.
    start : ndarray of int, shape (n_groups + 1,)
        Where the pairs of each group start.
    first, second : ndarray of int, shape (n_pairs,)
        Rows of the stacked spaces: stimulus + source * n_stimuli.
    weight : ndarray, shape (n_pairs,)
    block : ndarray of int, shape (n_pairs,)
        Pairs of a group with equal dissimilarity share a block.
    basis : ndarray, shape (n_pairs, n_columns)
    gram : ndarray, shape (n_groups, n_columns, n_columns)
        Metric levels only; see `projection`.
    """

    kind: int
    share: np.ndarray
    start: np.ndarray
    first: np.ndarray
    second: np.ndarray
    weight: np.ndarray
    block: np.ndarray
    basis: np.ndarray
    gram: np.ndarray


class Form(NamedTuple):
    """What of a solution is free: Y_k = (base + design B) C_k.

    Attributes
    ----------
    model : int
        Whether the C_k are given (FIXED), diagonal or full.
    transforms : ndarray, shape (m, p, p)
        The given C_k.
    base : ndarray, shape (n, p)
    design : ndarray, shape (n, q), or (0, 0) where all coordinates are free
    """

    model: int
    transforms: np.ndarray
    base: np.ndarray
    design: np.ndarray


@compiled
def pulls(pairs, spaces, work, pull):
    """Objective of the sources' spaces, shape (m n, p), and its derivative by them into `pull`.

    `work`: distances, disparities and three rows of work space, shape (5, n_pairs). Ties are sorted in place: hand over
    pairs of your own (`own_pairs`).
    """
    p = spaces.shape[1]
    pull[:] = 0.0
    value = 0.0
    for g in range(len(pairs.start) - 1):
        if pairs.share[g] == 0.0:
            continue
        distance, fitted, first, second, weight, total = _fit(pairs, g, spaces, work)
        if not total > 0.0:
            value += pairs.share[g]
            continue
        residual = 0.0
        mass = 0.0
        for q in range(len(distance)):
            r = distance[q] - fitted[q]
            residual += weight[q] * r * r
            mass += weight[q]
        loss = residual / total
        value += pairs.share[g] * loss
        # f_k = |d - Pd|^2 / |d|^2 has the derivative 2 (d - Pd - f_k d) / |d|^2.
        factor = 2.0 * pairs.share[g] / total
        nearest = _COINCIDENT * np.sqrt(total / mass)
        if p == 2:
            for q in range(len(distance)):
                d = distance[q]
                force = factor * weight[q] * (1.0 - fitted[q] / d - loss) if d > nearest else 0.0
                a, b = first[q], second[q]
                x, y = force * (spaces[a, 0] - spaces[b, 0]), force * (spaces[a, 1] - spaces[b, 1])
                pull[a, 0] += x
                pull[a, 1] += y
                pull[b, 0] -= x
                pull[b, 1] -= y
        else:
            for q in range(len(distance)):
                d = distance[q]
                if d > nearest:
                    force = factor * weight[q] * (1.0 - fitted[q] / d - loss)
                    a, b = first[q], second[q]
                    for r in range(p):
                        t = force * (spaces[a, r] - spaces[b, r])
                        pull[a, r] += t
                        pull[b, r] -= t
    return value


@compiled
def own_pairs(pairs):
    """Pairs whose ties may be sorted without disturbing another run."""
    if pairs.kind != PRIMARY:
        return pairs
    return Pairs(
        pairs.kind, pairs.share, pairs.start, pairs.first.copy(), pairs.second.copy(), pairs.weight.copy(),
        pairs.block, pairs.basis, pairs.gram,
    )  # fmt: skip


@compiled
def _fit(pairs, g, spaces, work):
    """Distances and disparities of a group in `work`, its rows and weights in their order, and its sum of squares."""
    own = slice(pairs.start[g], pairs.start[g + 1])
    distance, fitted, pool = work[0][own], work[1][own], work[2:]
    first, second, weight = pairs.first[own], pairs.second[own], pairs.weight[own]
    _measure(first, second, spaces, distance)
    total = 0.0
    for q in range(len(distance)):
        total += weight[q] * distance[q] * distance[q]
    if total > 0.0:
        if pairs.kind == PRIMARY:
            sort_ties(distance, weight, pairs.block[own], first, second)
        project(pairs.kind, distance, weight, pairs.block[own], pairs.basis[own], pairs.gram[g], fitted, pool)
    return distance, fitted, first, second, weight, total


@compiled
def _measure(first, second, spaces, distance):
    p = spaces.shape[1]
    if p == 2:
        for q in range(len(distance)):
            a, b = first[q], second[q]
            x, y = spaces[a, 0] - spaces[b, 0], spaces[a, 1] - spaces[b, 1]
            distance[q] = np.sqrt(x * x + y * y)
    else:
        for q in range(len(distance)):
            a, b = first[q], second[q]
            s = 0.0
            for r in range(p):
                t = spaces[a, r] - spaces[b, r]
                s += t * t
            distance[q] = np.sqrt(s)


@compiled
def loss_of_groups(pairs, spaces, work, loss):
    """Stress-1 squared of each group into `loss`; 1 where all its distances are 0. Sorts ties as `pulls` does."""
    for g in range(len(pairs.start) - 1):
        loss[g] = 0.0
        if pairs.start[g] == pairs.start[g + 1]:
            continue
        distance, fitted, _, _, weight, total = _fit(pairs, g, spaces, work)
        if not total > 0.0:
            loss[g] = 1.0
            continue
        residual = 0.0
        for q in range(len(distance)):
            r = distance[q] - fitted[q]
            residual += weight[q] * r * r
        loss[g] = residual / total


@compiled
def _group_space(theta, form, space):
    """Z = base + design @ B, or B itself where the design is empty; how many parameters that took."""
    base, design = form.base, form.design
    n, p = base.shape
    if design.shape[0] == 0:
        space[:] = theta[: n * p].copy().reshape(n, p)
        return n * p
    q = design.shape[1]
    for i in range(n):
        for r in range(p):
            s = base[i, r]
            for c in range(q):
                s += design[i, c] * theta[c * p + r]
            space[i, r] = s
    return q * p


@compiled
def _source_spaces(theta, used, form, space, spaces):
    """Y_k = Z C_k, stacked."""
    model, transforms = form.model, form.transforms
    n, p = space.shape
    m = transforms.shape[0]
    for k in range(m):
        at = used + k * p if model == DIAGONAL else used + k * p * p
        for i in range(n):
            for r in range(p):
                if model == DIAGONAL:
                    spaces[k * n + i, r] = space[i, r] * theta[at + r]
                else:
                    s = 0.0
                    for c in range(p):
                        s += space[i, c] * (theta[at + c * p + r] if model == FULL else transforms[k, c, r])
                    spaces[k * n + i, r] = s


@compiled
def _gradient(theta, used, form, space, pull, gradient):
    """Carry the derivative by the sources' spaces back to the parameters."""
    model, transforms, design = form.model, form.transforms, form.design
    n, p = space.shape
    m = transforms.shape[0]
    by_space = np.zeros((n, p))
    gradient[used:] = 0.0
    for k in range(m):
        at = used + k * p if model == DIAGONAL else used + k * p * p
        for i in range(n):
            for r in range(p):
                g = pull[k * n + i, r]
                if model == DIAGONAL:
                    by_space[i, r] += g * theta[at + r]
                    gradient[at + r] += g * space[i, r]
                else:
                    for c in range(p):
                        if model == FULL:
                            by_space[i, c] += g * theta[at + c * p + r]
                            gradient[at + c * p + r] += g * space[i, c]
                        else:
                            by_space[i, c] += g * transforms[k, c, r]
    if design.shape[0] == 0:
        gradient[: n * p] = by_space.ravel()
        return
    for c in range(design.shape[1]):
        for r in range(p):
            s = 0.0
            for i in range(n):
                s += design[i, c] * by_space[i, r]
            gradient[c * p + r] = s


@compiled
def value_and_gradient(pairs, form, theta, space, spaces, work, pull, gradient):
    """Objective at `theta`, and its gradient into `gradient`; the other arrays are work space."""
    used = _group_space(theta, form, space)
    _source_spaces(theta, used, form, space, spaces)
    value = pulls(pairs, spaces, work, pull)
    _gradient(theta, used, form, space, pull, gradient)
    return value


@compiled
def descend(shared_pairs, form, theta, steps, relative, absolute):
    """Minimise from `theta`, in place, by L-BFGS with backtracking (Liu and Nocedal 1989); value, steps and the end.

    It ends by itself (1) when three steps in a row lower the objective by less than `relative` of it plus `absolute`,
    or when no step lowers it; or at its step limit (0).
    """
    n, p = form.base.shape
    m = form.transforms.shape[0]
    pairs = own_pairs(shared_pairs)
    work = np.empty((5, len(pairs.first)))
    space, spaces, pull = np.empty((n, p)), np.empty((m * n, p)), np.empty((m * n, p))
    size = len(theta)
    gradient, trial_gradient = np.empty(size), np.empty(size)
    moves, changes = np.zeros((_PAIRS_REMEMBERED, size)), np.zeros((_PAIRS_REMEMBERED, size))
    curvature, part = np.zeros(_PAIRS_REMEMBERED), np.zeros(_PAIRS_REMEMBERED)

    value = value_and_gradient(pairs, form, theta, space, spaces, work, pull, gradient)
    kept = 0
    small = 0
    for step in range(steps):
        direction = gradient.copy()
        remembered = min(kept, _PAIRS_REMEMBERED)
        for t in range(remembered):
            slot = (kept - 1 - t) % _PAIRS_REMEMBERED
            part[slot] = np.dot(moves[slot], direction) / curvature[slot]
            direction -= part[slot] * changes[slot]
        if remembered > 0:
            slot = (kept - 1) % _PAIRS_REMEMBERED
            direction *= curvature[slot] / np.dot(changes[slot], changes[slot])
        else:
            steepness = np.sqrt(np.dot(gradient, gradient))
            if not steepness > 0.0:
                return value, step, 1
            direction *= 0.1 * np.sqrt(np.dot(theta, theta)) / steepness
        for t in range(remembered - 1, -1, -1):
            slot = (kept - 1 - t) % _PAIRS_REMEMBERED
            direction += moves[slot] * (part[slot] - np.dot(changes[slot], direction) / curvature[slot])
        slope = np.dot(direction, gradient)
        if not slope > 0.0:
            if kept == 0:
                return value, step, 1
            kept = 0
            continue
        length = 1.0
        lowered = False
        trial = theta
        trial_value = value
        for _ in range(30):
            trial = theta - length * direction
            trial_value = value_and_gradient(pairs, form, trial, space, spaces, work, pull, trial_gradient)
            if trial_value <= value - _SUFFICIENT * length * slope:
                lowered = True
                break
            # The lowest point of the parabola through what is known, within a half and a tenth.
            rise = trial_value - value + length * slope
            shrink = 0.5 * length * slope / rise if rise > 0.0 else 0.5
            length *= max(0.1, min(0.5, shrink))
        if not lowered:
            if kept == 0:
                return value, step, 1
            kept = 0  # the curvature learned on the other side of a kink misleads
            continue
        move = trial - theta
        change = trial_gradient - gradient
        bend = np.dot(move, change)
        if bend > 1e-12 * np.sqrt(np.dot(move, move) * np.dot(change, change)):
            slot = kept % _PAIRS_REMEMBERED
            moves[slot] = move
            changes[slot] = change
            curvature[slot] = bend
            kept += 1
        small = small + 1 if value - trial_value < relative * value + absolute else 0
        theta[:] = trial
        value = trial_value
        gradient[:] = trial_gradient
        if small >= 3:
            return value, step + 1, 1
    return value, steps, 0
