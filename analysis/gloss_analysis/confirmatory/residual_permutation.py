"""Judgements for which a given metric is true: residuals from each participant's own response curve, permuted.

The null that `orthogonality` and `indscal` compare with. A participant's judgements are regressed
monotonely on the distances that the metric predicts: a response curve of his own, such as a slider compresses. What is
left are residuals, which are permuted among pairs of neighbouring predicted distance and added to the curve again.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.optimize import isotonic_regression

from gloss_analysis.judgements.dissimilarity import Dissimilarities

__all__ = ["permuted_residuals"]

# Pairs of a participant among which residuals change places: of neighbouring predicted distance.
_NEIGHBOURS = 20
# Distances this part of the largest apart are one distance.
_SAME_DISTANCE = 1e-9


def permuted_residuals(
    data: Dissimilarities, predicted: np.ndarray, *, n_weights: float = 1.0
) -> Callable[[np.random.Generator], Dissimilarities]:
    """Prepare what draws judgements for which the predicted distances are true.

    Parameters
    ----------
    data : Dissimilarities
        m participants, n stimuli.
    predicted : ndarray, shape (m, n (n - 1) / 2)
        Each participant's distances under the metric that is to be true, in any unit; not all 0.
    n_weights : float
        Free numbers of that metric for each participant, which have taken up part of the noise; 1 / m of one that all
        share.

    Returns
    -------
    callable
        From a random generator to judgements of the same participants, pairs and answers.

    Notes
    -----
    Residuals are enlarged by sqrt(q / (q - f)) for q pairs, f being the steps of the curve and `n_weights`, since a fit
    takes up part of the noise. They are permuted 20 at a time, because the spread of the noise may change along the
    curve. The participant's own answers, ties and all, are dealt out in the order of the sums, so that steps and limits
    of his slider are kept.

    Examples
    --------
    >>> data = Dissimilarities(("a", "b", "c"), ("1",), np.array([[1.0, 3.0, 2.0]]))
    >>> drawn = permuted_residuals(data, np.array([[1.0, 2.0, 3.0]]))(np.random.default_rng(0))
    >>> sorted(drawn.values[0].tolist())
    [1.0, 2.0, 3.0]
    """
    prepared = []
    for row, judged, distance in zip(data.values, data.judged, predicted, strict=True):
        places = np.flatnonzero(judged)
        # Designs have many pairs at one distance, differing in the sign of a difference alone: one point of the curve.
        # Left apart, they would be ranked by their place in the table, for all participants alike.
        steps = np.round(distance[places] / (distance[places].max() * _SAME_DISTANCE))
        _, rank, count = np.unique(steps, return_inverse=True, return_counts=True)
        mean = np.bincount(rank, weights=row[places]) / count
        curve = isotonic_regression(mean, weights=count).x
        free = len(places) - len(np.unique(curve)) - n_weights
        enlarged = (row[places] - curve[rank]) * np.sqrt(len(places) / free if free > 0 else 1.0)
        bounds = np.arange(_NEIGHBOURS, len(places) - _NEIGHBOURS // 2, _NEIGHBOURS)
        prepared.append((places, rank, curve[rank], enlarged, bounds, np.sort(row[places])))

    def drawn(rng: np.random.Generator) -> Dissimilarities:
        values = data.values.copy()
        for row, (places, rank, curve, residuals, bounds, answers) in zip(values, prepared, strict=True):
            # By distance, those of one distance and, later, of one sum in random order.
            order = np.lexsort((rng.random(len(rank)), rank))
            permuted = np.concatenate([rng.permutation(some) for some in np.split(residuals[order], bounds)])
            sums = curve[order] + permuted
            row[places[order][np.lexsort((rng.random(len(sums)), sums))]] = answers
        return replace(data, values=values)

    return drawn
