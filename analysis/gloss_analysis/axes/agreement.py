"""How far two configurations of the same stimuli agree, and whether further than chance.

With both configurations X and Y centred, Y is first brought as near to X as it may be: by rotation and reflection R
(orthogonal Procrustes), or, where the axes of a weighted solution mean something, by order and sign of its dimensions
only. Both maximise t = tr(X' Y R) over what is allowed. Then

    procrustes         1 - t^2 / (|X|^2 |Y|^2)         1 - R^2 at the best common size: size is free
    procrustes_sized   1 - 2 t / (|X|^2 + |Y|^2)       |X - Y R|^2 over its largest value: size counts
    congruence         t / (|X| |Y|)                   Tucker's coefficient of all coordinates together

are symmetric in X and Y and lie between 0 and 1. Tucker's coefficient of two vectors is a.b / (|a| |b|). Of distances,
which are positive, it is high for any two configurations: hence the tests, which permute the stimuli of Y.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import pdist, squareform

from gloss_analysis.axes.orientation import is_rotatable
from gloss_analysis.axes.property_fitting import centred_points
from gloss_analysis.mds import MdsSolution
from glossspace.errors import GlossError

__all__ = ["Agreement", "agreement"]

# A permutation that changes nothing, as of stimuli in the same place, must count as equal in spite of rounding.
_ROUNDING = 1e-12


@dataclass(frozen=True)
class Agreement:
    """How far a second configuration agrees with a first one.

    Attributes
    ----------
    rotated : bool
        Whether the second was rotated; if not, only order and sign of its dimensions were chosen.
    turn : ndarray, shape (p, p)
        Rotation and reflection, or signed permutation, that brings the second to the first.
    matched : ndarray, shape (n, p)
        The second configuration centred and turned, in its own size and the first one's order of stimuli.
    column_congruence : ndarray, shape (p,)
        Tucker's coefficient of each dimension of the first with the matched one; 0 for an empty dimension.
    congruence : float
        Tucker's coefficient of all coordinates together.
    distance_congruence : float
        Tucker's coefficient of the distances of all pairs.
    procrustes, procrustes_sized : float
        Parts of the sums of squares that do not agree, with the size of the second free and as it is; see the module.
    column_congruence_p : float
        P value of the mean of the column congruences.
    procrustes_p : float
        P value of both Procrustes statistics and of the congruence: permuting stimuli orders all three alike.
    distance_congruence_p : float
        P value of the congruence of distances.
    n_permutations : int
    seed : int
    """

    rotated: bool
    turn: np.ndarray
    matched: np.ndarray
    column_congruence: np.ndarray
    congruence: float
    distance_congruence: float
    procrustes: float
    procrustes_sized: float
    column_congruence_p: float
    procrustes_p: float
    distance_congruence_p: float
    n_permutations: int
    seed: int


def agreement(
    first: "np.ndarray | MdsSolution",
    second: "np.ndarray | MdsSolution",
    *,
    rotate: bool | None = None,
    n_permutations: int = 999,
    seed: int = 1,
) -> Agreement:
    """Compare two configurations of the same stimuli in the same number of dimensions.

    Parameters
    ----------
    first, second : ndarray, shape (n, p), or MdsSolution
        Of two solutions the stimuli are matched by name and their group spaces compared; otherwise rows are matched by
        their place.
    rotate : bool, optional
        Whether the second may be rotated, or only its dimensions exchanged and reflected. By default it may be unless
        one of the two is a weighted solution, whose axes mean something.
    n_permutations : int
        B, the number of random orders of the stimuli. A P value is (b + 1) / (B + 1), where b of them agree at least as
        well as the true order; it cannot be lower than 1 / (B + 1).
    seed : int
        Of the permutations.

    Returns
    -------
    Agreement

    Raises
    ------
    GlossError
        Stimuli or dimensions differ, there are fewer than 3 stimuli, a configuration is a single place or not finite,
        rotation of a weighted solution is asked for, or B or the seed is not allowed.

    Examples
    --------
    >>> square = np.array([[1.0, 2.0], [1.0, -2.0], [-1.0, 2.0], [-1.0, -2.0]])
    >>> turned = agreement(square, square @ np.array([[0.6, -0.8], [0.8, 0.6]]))
    >>> bool(turned.procrustes_sized < 1e-12)
    True
    """
    if n_permutations < 1:
        raise GlossError(f"Invalid number of permutations = {n_permutations}. Allowed: 1 or more, such as 999.")
    if seed < 0:
        raise GlossError(f"Invalid seed = {seed}. Allowed: 0 or more.")
    may_rotate = _may_rotate(first, second, rotate)
    x, y = _matched_by_name(first, second)
    turn = _turn(x.T @ y, may_rotate)
    matched = y @ turn
    distances_x, distances_y = pdist(x), pdist(y)
    columns = _congruence_of_columns(x, matched)
    trace, size_x, size_y = np.sum(x * matched), np.linalg.norm(x), np.linalg.norm(y)
    fitting = trace / (size_x * size_y)
    distance_fitting = _congruence(distances_x, distances_y)
    exceeding = np.zeros(3)
    square = squareform(distances_y)
    pairs = np.triu_indices(len(x), 1)
    rng = np.random.default_rng(seed)
    for _ in range(n_permutations):
        order = rng.permutation(len(y))
        drawn = y[order] @ _turn(x.T @ y[order], may_rotate)
        of_distances = _congruence(distances_x, square[order[pairs[0]], order[pairs[1]]])
        by_chance = (np.mean(_congruence_of_columns(x, drawn)), np.sum(x * drawn) / (size_x * size_y), of_distances)
        exceeding += np.array(by_chance) >= np.array([np.mean(columns), fitting, distance_fitting]) - _ROUNDING
    column_p, procrustes_p, distance_p = ((exceeding + 1) / (n_permutations + 1)).tolist()
    return Agreement(
        rotated=may_rotate,
        turn=turn,
        matched=matched,
        column_congruence=columns,
        congruence=float(fitting),
        distance_congruence=distance_fitting,
        # Rounding may bring a perfect fit below 0.
        procrustes=float(max(1 - fitting**2, 0.0)),
        procrustes_sized=float(max(1 - 2 * trace / (size_x**2 + size_y**2), 0.0)),
        column_congruence_p=column_p,
        procrustes_p=procrustes_p,
        distance_congruence_p=distance_p,
        n_permutations=n_permutations,
        seed=seed,
    )


def _may_rotate(first: "np.ndarray | MdsSolution", second: "np.ndarray | MdsSolution", rotate: bool | None) -> bool:
    fixed = [one for one in (first, second) if isinstance(one, MdsSolution) and not is_rotatable(one)]
    # In one dimension there is nothing but a reflection.
    fixed = [one for one in fixed if one.n_dims > 1]
    if fixed and rotate:
        raise GlossError(
            "A weighted solution must not be rotated: its axes are fixed up to order and sign. Give rotate=False, or "
            "the coordinates alone to compare them in spite of that."
        )
    return not fixed if rotate is None else bool(rotate)


def _matched_by_name(
    first: "np.ndarray | MdsSolution", second: "np.ndarray | MdsSolution"
) -> tuple[np.ndarray, np.ndarray]:
    x, y = (one.coordinates if isinstance(one, MdsSolution) else one for one in (first, second))
    if isinstance(first, MdsSolution) and isinstance(second, MdsSolution):
        alone = sorted(set(first.stimuli) ^ set(second.stimuli))
        if alone:
            raise GlossError(
                f"{len(alone)} stimuli are in one of the two solutions only, such as {alone[0]!r}. Give the "
                "coordinates of those they share."
            )
        y = y[[second.stimuli.index(name) for name in first.stimuli]]
    x, y = centred_points(x, "configuration"), centred_points(y, "configuration")
    if x.shape != y.shape:
        raise GlossError(
            f"Configurations of shape {x.shape} and {y.shape} cannot be compared. Give the same stimuli in the same "
            "number of dimensions."
        )
    if len(x) < 3:
        raise GlossError(f"{len(x)} stimuli agree in any case. Give 3 or more.")
    for which, points in (("first", x), ("second", y)):
        # Differences tell, not the centred values: the mean of equal numbers may be a rounding error off.
        if np.all(np.ptp(points, axis=0) == 0):
            raise GlossError(f"The {which} configuration has all stimuli in one place. Give one in which they differ.")
    return x, y


def _turn(products: np.ndarray, rotate: bool) -> np.ndarray:
    """Orthogonal matrix R, or signed permutation, that maximises tr(products R), where products = X' Y."""
    if rotate:
        left, _, right = np.linalg.svd(products)
        return np.asarray((left @ right).T)
    rows, columns = linear_sum_assignment(-np.abs(products))
    turn = np.zeros(products.shape)
    turn[columns, rows] = np.where(products[rows, columns] < 0, -1.0, 1.0)
    return turn


def _congruence(a: np.ndarray, b: np.ndarray) -> float:
    sizes = np.linalg.norm(a) * np.linalg.norm(b)
    return float(a @ b / sizes) if sizes > 0 else 0.0


def _congruence_of_columns(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return np.array([_congruence(a, b) for a, b in zip(x.T, y.T, strict=True)])
