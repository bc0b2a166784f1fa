"""Kernels of scaling on a line: the best points in a given order.

In a given order every distance is a difference of coordinates with a known sign, also between points that coincide, so
that the objective is smooth and its minimisation a projected descent: a step against the gradient, then monotone
regression of the points in their order. All sources see the same line: the pairs handed over here name stimuli, not
rows of stacked spaces.
"""

from gloss_analysis.mds.compiled import compiled
from gloss_analysis.mds.projection import METRIC, PRIMARY, project, sort_ties

__all__ = ["best_points", "into_order", "line_pulls", "ranked", "settle"]

# A step may grow to this many times the one of majorization, as long as the objective falls.
_LONGEST, _SHORTEST = 16.0, 1e-3
# A descent is given up when this many times its last gain would not bring it to its goal. From `best_points`, the first
# gain was more than half of all that followed in every order of every data set tried.
_HOPE = 3.0


@compiled
def line_pulls(pairs, rank, x, limit, work, pull):
    """Objective of the points `x`, shape (n,), and its derivative in the order `rank` into `pull`; its curvature.

    It stops at the source that brings the objective above `limit`: all later ones could only add to it.

    The curvature is the inverse of the step that majorization takes where data are complete and unweighted (Guttman's
    transform); elsewhere it is of that size. `work`: shape (5, n_pairs). Ties are sorted in place.
    """
    n = len(x)
    pull[:] = 0.0
    value = 0.0
    curvature = 0.0
    for g in range(len(pairs.start) - 1):
        if pairs.share[g] == 0.0:
            continue
        own = slice(pairs.start[g], pairs.start[g + 1])
        distance, fitted, pool = work[0][own], work[1][own], work[2:]
        first, second, weight = pairs.first[own], pairs.second[own], pairs.weight[own]
        total = 0.0
        mass = 0.0
        for q in range(len(distance)):
            d = abs(x[first[q]] - x[second[q]])
            distance[q] = d
            total += weight[q] * d * d
            mass += weight[q]
        if not total > 0.0:
            value += pairs.share[g]
            if value > limit:
                break
            continue
        if pairs.kind == PRIMARY:
            sort_ties(distance, weight, pairs.block[own], first, second)
        if pairs.kind == METRIC and pairs.basis.shape[1] <= 2:
            _onto_line(distance, weight, pairs.basis[own], pairs.gram[g], fitted)
        else:
            project(
                pairs.kind, distance, weight, pairs.block[own], pairs.basis[own],
                pairs.gram[g if pairs.kind == METRIC else 0], fitted, pool,
            )  # fmt: skip
        residual = 0.0
        for q in range(len(distance)):
            r = distance[q] - fitted[q]
            residual += weight[q] * r * r
        loss = residual / total
        value += pairs.share[g] * loss
        if value > limit:
            break
        factor = 2.0 * pairs.share[g] / total
        curvature += factor * max(1.0 - loss, 0.0) * mass * 2.0 / (n - 1)
        for q in range(len(distance)):
            a, b = first[q], second[q]
            force = factor * weight[q] * ((1.0 - loss) * distance[q] - fitted[q])
            if rank[a] < rank[b]:
                force = -force
            pull[a] += force
            pull[b] -= force
    return value, curvature


@compiled
def _onto_line(distance, weight, basis, gram, fitted):
    """Projection onto the non-negative sums of one or two columns, which needs no iteration."""
    two = basis.shape[1] == 2
    u, v = 0.0, 0.0
    for q in range(len(distance)):
        y = weight[q] * distance[q]
        u += basis[q, 0] * y
        if two:
            v += basis[q, 1] * y
    a, b = (u / gram[0, 0] if gram[0, 0] > 0.0 else 0.0), 0.0
    if two and gram[1, 1] > 0.0:
        determinant = gram[0, 0] * gram[1, 1] - gram[0, 1] * gram[0, 1]
        if determinant > 1e-13 * gram[0, 0] * gram[1, 1]:
            both_a = (gram[1, 1] * u - gram[0, 1] * v) / determinant
            both_b = (gram[0, 0] * v - gram[0, 1] * u) / determinant
            if both_a < 0.0:
                a, b = 0.0, v / gram[1, 1]
            elif both_b > 0.0:
                a, b = both_a, both_b
    for q in range(len(distance)):
        fitted[q] = a * basis[q, 0]
        if two:
            fitted[q] += b * basis[q, 1]


@compiled
def into_order(order, x, mean, mass):
    """Monotone regression of the points in their order, in place."""
    top = -1
    for i in range(len(order)):
        y, w = x[order[i]], 1.0
        while top >= 0 and mean[top] > y:
            y = (mean[top] * mass[top] + y * w) / (mass[top] + w)
            w += mass[top]
            top -= 1
        top += 1
        mean[top] = y
        mass[top] = w
    i = 0
    for t in range(top + 1):
        for _ in range(int(mass[t] + 0.5)):
            x[order[i]] = mean[t]
            i += 1


@compiled
def best_points(square, order, x):
    """Points t_i = (sum of D_ij over the j before i, less that over those after) / n of an order, as they come.

    They are the best for the disparities `square` in an order that suits them (Defays 1978).
    """
    n = len(order)
    for i in range(n):
        a = order[i]
        s = 0.0
        for j in range(i):
            s += square[a, order[j]]
        for j in range(i + 1, n):
            s -= square[a, order[j]]
        x[a] = s / n


@compiled
def ranked(order, rank):
    """Place of every stimulus in an order, into `rank`."""
    for i in range(len(order)):
        rank[order[i]] = i


@compiled
def settle(pairs, order, rank, x, steps, relative, limit, goal, work, room):
    """Descend within an order from `x`, in place; value and evaluations.

    It ends when a step lowers the objective by less than `relative` of it, after `steps` evaluations, at once if it
    starts above `limit`, or as soon as its progress would not bring it below `goal`. `room`: work space, shape (5, n).
    """
    pull, trial, trial_pull, mean, mass = room[0], room[1], room[2], room[3], room[4]
    ranked(order, rank)
    into_order(order, x, mean, mass)
    value, curvature = line_pulls(pairs, rank, x, limit, work, pull)
    if value > limit:
        return value, 1
    length = 1.0
    for step in range(1, steps):
        if not curvature > 0.0:
            return value, step
        for i in range(len(x)):
            trial[i] = x[i] - length / curvature * pull[i]
        into_order(order, trial, mean, mass)
        trial_value, trial_curvature = line_pulls(pairs, rank, trial, value, work, trial_pull)
        gain = value - trial_value
        if gain >= 0.0:
            x[:] = trial
            pull[:] = trial_pull
            value, curvature = trial_value, trial_curvature
            if gain <= relative * value and length >= 1.0:
                return value, step + 1
            if value - _HOPE * gain > goal:
                return value, step + 1
            length = min(2.0 * length, _LONGEST)
        else:
            length = 1.0 if length > 1.0 else 0.5 * length
            if length < _SHORTEST:
                return value, step + 1
    return value, steps
