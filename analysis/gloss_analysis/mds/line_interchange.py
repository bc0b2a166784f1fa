"""Kernels of scaling on a line: from one order to its neighbours, by moves and exchanges of stimuli."""

import numpy as np

from gloss_analysis.mds.compiled import compiled
from gloss_analysis.mds.kernels import own_pairs
from gloss_analysis.mds.line_order import best_points, line_pulls, ranked, settle

__all__ = ["climb", "moved", "neighbours"]

# Of the orders next to a line, those best after a few steps are followed to their end.
_FOLLOWED = 3
_ACCEPTED = 1e-9


@compiled
def _pooled(pairs, x, work, square):
    """Mean disparities of the sources as `line_pulls` left them in `work`; the distance where a pair was not judged."""
    n = len(x)
    for i in range(n):
        for j in range(n):
            square[i, j] = abs(x[i] - x[j])
    for g in range(len(pairs.start) - 1):
        start, stop = pairs.start[g], pairs.start[g + 1]
        if pairs.share[g] == 0.0:
            continue
        mass = 0.0
        for q in range(start, stop):
            mass += pairs.weight[q]
        for q in range(start, stop):
            a, b = pairs.first[q], pairs.second[q]
            part = pairs.share[g] * pairs.weight[q] * (stop - start) / mass
            square[a, b] += part * (work[1, q] - work[0, q])
            square[b, a] = square[a, b]


@compiled
def neighbours(square, order, t, moves, promise):
    """All orders one move away, (place, target, 0: carried or 1: exchanged), and what each adds to sum t^2.

    `t`: the `best_points` of `order`. Into `moves`, shape (k, 3), and `promise`, shape (k,); how many.
    """
    n = len(order)
    count = 0
    for place in range(n):
        i = order[place]
        for way in range(-1, 2, 2):
            own, added = t[i], -t[i] * t[i]
            target = place + way
            while 0 <= target < n:
                j = order[target]
                shift = 2.0 * way * square[i, j] / n
                own += shift
                added += (t[j] - shift) ** 2 - t[j] ** 2
                # A step back is the neighbour's step forward.
                if way > 0 or target < place - 1:
                    moves[count, 0], moves[count, 1], moves[count, 2] = place, target, 0
                    promise[count] = added + own * own
                    count += 1
                target += way
        for target in range(place + 2, n):
            j = order[target]
            t_i, t_j = t[i] + 2.0 * square[i, j] / n, t[j] - 2.0 * square[i, j] / n
            added = -t[i] * t[i] - t[j] * t[j]
            for between in range(place + 1, target):
                k = order[between]
                to_i, to_j = 2.0 * square[i, k] / n, 2.0 * square[j, k] / n
                t_i += to_i
                t_j -= to_j
                added += (t[k] - to_i + to_j) ** 2 - t[k] ** 2
            moves[count, 0], moves[count, 1], moves[count, 2] = place, target, 1
            promise[count] = added + t_i * t_i + t_j * t_j
            count += 1
    return count


@compiled
def moved(order, place, target, kind, new):
    """Order with the stimulus of one place carried to another (kind 0), or the two exchanged (1), into `new`."""
    new[:] = order
    if kind == 1:
        new[place], new[target] = order[target], order[place]
    elif place < target:
        new[place:target] = order[place + 1 : target + 1]
        new[target] = order[place]
    else:
        new[target + 1 : place + 1] = order[target:place]
        new[target] = order[place]


@compiled
def _ascend_moves(pairs, order, x, width, steps, limit, work, room, large):
    """Follow the best move as long as one lowers the objective; value, evaluations. `order` and `x` in place."""
    n = len(x)
    rank = np.empty(n, np.int64)
    square, t = np.empty((n, n)), np.empty(n)
    moves, promise = large
    new = np.empty((width, n), np.int64)
    points, worth = np.empty((width, n)), np.empty(width)
    pull = np.empty(n)
    value, spent = settle(pairs, order, rank, x, 20 * steps, 1e-9, np.inf, np.inf, work, room)
    while spent < limit:
        ranked(order, rank)
        line_pulls(pairs, rank, x, np.inf, work, pull)
        _pooled(pairs, x, work, square)
        best_points(square, order, t)
        count = neighbours(square, order, t, moves, promise)
        sequence = np.argsort(-promise[:count], kind="mergesort")
        tried = min(width, count)
        for c in range(tried):
            move = sequence[c]
            moved(order, moves[move, 0], moves[move, 1], moves[move, 2], new[c])
            best_points(square, new[c], points[c])
            worth[c], used = settle(pairs, new[c], rank, points[c], steps, 1e-7, np.inf, np.inf, work, room)
            spent += used
        better = False
        for c in np.argsort(worth[:tried], kind="mergesort")[:_FOLLOWED]:
            reached, used = settle(pairs, new[c], rank, points[c], 20 * steps, 1e-9, np.inf, value, work, room)
            spent += used
            if reached < value * (1.0 - _ACCEPTED):
                value = reached
                order[:] = new[c]
                x[:] = points[c]
                better = True
                break
        if not better:
            break
    return value, spent


@compiled
def climb(shared_pairs, x, kicks, width, steps, limit):
    """Search the order by interchange from the points `x`, shape (n,), then from the best order after each kick.

    Parameters
    ----------
    kicks : ndarray of int, shape (rounds, k, 2)
        Places that stimuli are carried from and to, k of them between two rounds.
    width : int
        How many of the orders one move away are tried: those that the present disparities promise most.
    steps : int
        Evaluations that each is given at first.
    limit : int
        No new sweep begins after so many evaluations.

    Returns
    -------
    value, points, evaluations
    """
    pairs = own_pairs(shared_pairs)
    n = len(x)
    work, room = np.empty((5, len(pairs.first))), np.empty((5, n))
    large = (np.empty(((n - 1) * (3 * n - 2) // 2 + 1, 3), np.int64), np.empty((n - 1) * (3 * n - 2) // 2 + 1))
    order, x = np.argsort(x, kind="mergesort"), x.copy()
    rank, square, pull, other = np.empty(n, np.int64), np.empty((n, n)), np.empty(n), np.empty(n)
    value, spent = _ascend_moves(pairs, order, x, width, steps, limit, work, room, large)
    for r in range(len(kicks)):
        if spent >= limit:
            break
        ranked(order, rank)
        line_pulls(pairs, rank, x, np.inf, work, pull)
        _pooled(pairs, x, work, square)
        kicked = order.copy()
        for c in range(kicks.shape[1]):
            moved(kicked.copy(), kicks[r, c, 0], kicks[r, c, 1], 0, kicked)
        best_points(square, kicked, other)
        reached, used = _ascend_moves(pairs, kicked, other, width, steps, limit - spent, work, room, large)
        spent += used
        if reached < value:
            value = reached
            order[:] = kicked
            x[:] = other
    return value, x, spent
