"""Kernels of scaling on a line: all orders of the stimuli, tried one by one or by dynamic programming."""

import numpy as np

from gloss_analysis.mds.compiled import compiled
from gloss_analysis.mds.kernels import own_pairs
from gloss_analysis.mds.line_order import best_points, settle

__all__ = ["best_order", "follow", "sift"]


@compiled
def _next_order(order, fixed):
    """Make the next order in the dictionary, its first `fixed` places kept; False after the last."""
    n = len(order)
    i = n - 2
    while i >= fixed and order[i] > order[i + 1]:
        i -= 1
    if i < fixed:
        return False
    j = n - 1
    while order[j] < order[i]:
        j -= 1
    order[i], order[j] = order[j], order[i]
    order[i + 1 :] = order[i + 1 :][::-1].copy()
    return True


@compiled
def sift(shared_pairs, square, head, steps, limit, goal, kept):
    """Try all orders that begin with the stimuli `head`, one of each two mirror images; the `kept` best.

    Each starts from the points that suit the disparities `square` and takes up to `steps` evaluations, but one only
    where it starts above `limit`, and no more when it has no hope to come below `goal`.

    Returns
    -------
    values, shape (k,), best first; orders, shape (k, n); points, shape (k, n); orders tried.
    """
    pairs = own_pairs(shared_pairs)
    n, fixed = len(square), len(head)
    order, rank, x = np.empty(n, np.int64), np.empty(n, np.int64), np.empty(n)
    work, room = np.empty((5, len(pairs.first))), np.empty((5, n))
    values, orders, points = np.empty(kept), np.empty((kept, n), np.int64), np.empty((kept, n))
    order[:fixed] = head
    at = fixed
    for i in range(n):
        if not np.any(head == i):
            order[at] = i
            at += 1
    count, tried = 0, 0
    more = True
    while more:
        if order[0] < order[n - 1]:
            best_points(square, order, x)
            value, _ = settle(pairs, order, rank, x, steps, 1e-7, limit, goal, work, room)
            tried += 1
            if count < kept or value < values[count - 1]:
                count = min(count + 1, kept)
                place = count - 1
                while place > 0 and values[place - 1] > value:
                    values[place] = values[place - 1]
                    orders[place] = orders[place - 1]
                    points[place] = points[place - 1]
                    place -= 1
                values[place] = value
                orders[place] = order
                points[place] = x
        more = _next_order(order, fixed)
    return values[:count], orders[:count], points[:count], tried


@compiled
def follow(shared_pairs, orders, points, steps, relative):
    """Descend within each order to its end, from its points and from equally spaced ones; value and points of both.

    Returns
    -------
    values, shape (2 k,); points, shape (2 k, n).
    """
    pairs = own_pairs(shared_pairs)
    k, n = orders.shape
    work, room, rank = np.empty((5, len(pairs.first))), np.empty((5, n)), np.empty(n, np.int64)
    values, ends = np.empty(2 * k), np.empty((2 * k, n))
    for c in range(k):
        ends[2 * c] = points[c]
        for i in range(n):
            ends[2 * c + 1, orders[c, i]] = i - (n - 1) / 2.0
        for s in range(2 * c, 2 * c + 2):
            values[s], _ = settle(pairs, orders[c], rank, ends[s], steps, relative, np.inf, np.inf, work, room)
    return values, ends


@compiled
def best_order(square):
    """Order of the points on a line that fit the disparities `square` best, of all orders.

    t_i of `best_points` depends only on which stimuli come before i, and the stress falls as sum_i t_i^2 rises: so the
    best way to fill the places one after the other is found set by set (Hubert, Arabie and Meulman 2001, chapter 4).
    """
    n = len(square)
    size = 1 << n
    worth, last = np.full(size, -1.0), np.zeros(size, np.int8)
    worth[0] = 0.0
    row = np.empty(n)
    for i in range(n):
        row[i] = np.sum(square[i])
    for chosen in range(size):
        for i in range(n):
            if chosen >> i & 1:
                continue
            s = -row[i]
            for j in range(n):
                if chosen >> j & 1:
                    s += 2.0 * square[i, j]
            value = worth[chosen] + s * s
            larger = chosen | 1 << i
            if value > worth[larger]:
                worth[larger] = value
                last[larger] = i
    order = np.empty(n, np.int64)
    chosen = size - 1
    for place in range(n - 1, -1, -1):
        order[place] = last[chosen]
        chosen ^= 1 << order[place]
    return order
