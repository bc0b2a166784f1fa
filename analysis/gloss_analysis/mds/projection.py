"""Kernels of the optimal transformations: the projection of one group's distances onto its admissible disparities.

They do what `disparities` does, on pairs that are sorted by dissimilarity and without allocating. `disparities` is the
readable twin, and their test.
"""

import numpy as np

from gloss_analysis.mds.compiled import compiled

__all__ = ["METRIC", "PRIMARY", "SECONDARY", "UNTIED", "project", "sort_ties"]

# Kinds of projection: monotone with ties that may be untied, tied, or absent, which is the fastest; and onto the cone
# of a few columns (ratio, interval, spline).
PRIMARY, SECONDARY, UNTIED, METRIC = 0, 1, 2, 3

# Insertion sort is the fastest for what is nearly sorted; a block that needs more shifts an element is sorted afresh.
_SHIFTS = 8


@compiled
def project(kind, distance, weight, block, basis, gram, fitted, pool):
    """Disparities of the pairs of one group, sorted by dissimilarity, into `fitted`.

    `distance`, `weight`, `block`, `fitted`: shape (n_pairs,); under PRIMARY, pairs of a block are sorted by distance.
    `basis`: shape (n_pairs, n_columns); `gram`: its weighted Gram matrix over these pairs. `pool`: work space of three
    rows.
    """
    if kind in (PRIMARY, UNTIED):
        _monotone(distance, weight, fitted, pool)
    elif kind == SECONDARY:
        _tied_monotone(distance, weight, block, fitted, pool)
    else:
        _onto_columns(distance, weight, basis, gram, fitted)


@compiled
def _monotone(distance, weight, fitted, pool):
    """Weighted monotone regression by pooling adjacent violators (Kruskal 1964)."""
    mean, mass, end = pool[0], pool[1], pool[2]
    n = len(distance)
    # The topmost pool is kept out of the arrays: most comparisons are with it.
    below = 0
    y, w = distance[0], weight[0]
    for q in range(1, n):
        next_y, next_w = distance[q], weight[q]
        if next_y > y:
            mean[below], mass[below], end[below] = y, w, q
            below += 1
            y, w = next_y, next_w
            continue
        y = (y * w + next_y * next_w) / (w + next_w)
        w += next_w
        while below > 0 and mean[below - 1] >= y:
            below -= 1
            y = (y * w + mean[below] * mass[below]) / (w + mass[below])
            w += mass[below]
    mean[below], end[below] = y, n
    q = 0
    for t in range(below + 1):
        while q < end[t]:
            fitted[q] = mean[t]
            q += 1


@compiled
def _tied_monotone(distance, weight, block, fitted, pool):
    """Monotone regression of the means of the blocks."""
    mean, mass, end = pool[0], pool[1], pool[2]
    n = len(distance)
    top = -1
    q = 0
    while q < n:
        tie = block[q]
        y = 0.0
        w = 0.0
        while q < n and block[q] == tie:
            y += weight[q] * distance[q]
            w += weight[q]
            q += 1
        y /= w
        while top >= 0 and mean[top] >= y:
            total = mass[top] + w
            y = (mean[top] * mass[top] + y * w) / total
            w = total
            top -= 1
        top += 1
        mean[top] = y
        mass[top] = w
        end[top] = q
    q = 0
    for t in range(top + 1):
        while q < end[t]:
            fitted[q] = mean[t]
            q += 1


@compiled
def _onto_columns(distance, weight, basis, gram, fitted):
    n = gram.shape[0]
    moment = np.zeros(n)
    for q in range(len(distance)):
        y = weight[q] * distance[q]
        for c in range(n):
            moment[c] += basis[q, c] * y
    coefficient = _non_negative(gram, moment)
    for q in range(len(distance)):
        y = 0.0
        for c in range(n):
            y += basis[q, c] * coefficient[c]
        fitted[q] = y


@compiled
def _non_negative(gram, moment):
    """Non-negative least squares of a few columns, given their Gram matrix (Lawson and Hanson 1974, chapter 23)."""
    n = len(moment)
    x = np.zeros(n)
    free = np.zeros(n, np.bool_)
    scale = 0.0
    for c in range(n):
        scale = max(scale, abs(moment[c]))
    for _ in range(3 * n + 3):
        best, chosen = 1e-13 * scale, -1
        for c in range(n):
            if not free[c]:
                slope = moment[c]
                for k in range(n):
                    slope -= gram[c, k] * x[k]
                if slope > best:
                    best, chosen = slope, c
        if chosen < 0:
            break
        free[chosen] = True
        while True:
            z = _solve_free(gram, moment, free)
            step, blocking = 1.0, -1
            for c in range(n):
                if free[c] and z[c] <= 0.0:
                    part = x[c] / (x[c] - z[c]) if x[c] > z[c] else 0.0
                    if part < step or blocking < 0:
                        step, blocking = part, c
            if blocking < 0:
                x = z
                break
            for c in range(n):
                x[c] += step * (z[c] - x[c])
            x[blocking] = 0.0
            free[blocking] = False
    return x


@compiled
def _solve_free(gram, moment, free):
    """Solve the normal equations of the free columns by Cholesky; a column that adds nothing new gets zero."""
    n = len(moment)
    z = np.zeros(n)
    index = np.flatnonzero(free)
    k = len(index)
    lower = np.zeros((k, k))
    usable = np.ones(k, np.bool_)
    for i in range(k):
        for j in range(i + 1):
            s = gram[index[i], index[j]]
            for t in range(j):
                s -= lower[i, t] * lower[j, t]
            if i == j:
                usable[i] = s > 1e-13 * gram[index[i], index[i]]
                lower[i, i] = np.sqrt(s) if usable[i] else 1.0
            else:
                lower[i, j] = s / lower[j, j] if usable[j] else 0.0
    y = np.zeros(k)
    for i in range(k):
        s = moment[index[i]]
        for t in range(i):
            s -= lower[i, t] * y[t]
        y[i] = s / lower[i, i] if usable[i] else 0.0
    for i in range(k - 1, -1, -1):
        s = y[i]
        for t in range(i + 1, k):
            s -= lower[t, i] * y[t]
        y[i] = s / lower[i, i] if usable[i] else 0.0
    for i in range(k):
        z[index[i]] = y[i]
    return z


@compiled
def sort_ties(distance, weight, block, first, second):
    """Sort the pairs of each block by distance, in place: what untied monotone regression needs.

    From one step of a minimisation to the next the order hardly changes, so insertion is tried first.
    """
    n = len(distance)
    q = 0
    while q < n:
        end = q + 1
        while end < n and block[end] == block[q]:
            end += 1
        if end - q > 1:
            left = _SHIFTS * (end - q)
            for i in range(q + 1, end):
                d, w, a, b = distance[i], weight[i], first[i], second[i]
                j = i
                while j > q and distance[j - 1] > d:
                    distance[j], weight[j] = distance[j - 1], weight[j - 1]
                    first[j], second[j] = first[j - 1], second[j - 1]
                    j -= 1
                distance[j], weight[j], first[j], second[j] = d, w, a, b
                left -= i - j
                if left < 0:
                    break
            if left < 0:
                _sort_afresh(distance[q:end], weight[q:end], first[q:end], second[q:end])
        q = end


@compiled
def _sort_afresh(distance, weight, first, second):
    order = np.argsort(distance, kind="mergesort")
    distance[:], weight[:], first[:], second[:] = distance[order], weight[order], first[order], second[order]
