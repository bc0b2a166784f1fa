"""Solutions of resampled judgements laid upon the solution of all: what no data fix must not count as uncertainty.

A weighted solution is fixed up to order and sign of its dimensions, the others up to rotation. Points and participants'
transformations move together, so that all distances stay as they are but for one scale a participant.
"""

import numpy as np
from scipy.linalg import orthogonal_procrustes
from scipy.optimize import linear_sum_assignment

from gloss_analysis.mds import Model
from gloss_analysis.mds.conventions import group_conventions

__all__ = ["aligned", "procrustes_distance"]


def aligned(
    coordinates: np.ndarray,
    transforms: np.ndarray,
    target: np.ndarray,
    *,
    model: Model,
    conditional: bool = True,
) -> tuple[np.ndarray, np.ndarray]:
    """Bring a solution to the conventions of its model, then as near to `target` as the model allows.

    Parameters
    ----------
    coordinates, target : ndarray, shape (n, p)
    transforms : ndarray, shape (m, p, p)
        One a participant who counts in the average.
    model : {"weighted", "identity", "generalised"}
        Weighted: dimensions are permuted and reflected, matched by correlation. Else rotated and reflected (orthogonal
        Procrustes).
    conditional : bool
        Whether each participant has a scale of its own. If not, sizes of participants' spaces are part of the
        transformations and stay.

    Returns
    -------
    coordinates : ndarray, shape (n, p)
        Centred, total mean square 1.
    transforms : ndarray, shape (m, p, p)

    Examples
    --------
    >>> target = np.array([[2.0, 0.0], [0.0, 1.0], [-2.0, -1.0]])
    >>> moved, _ = aligned(-target[:, ::-1], np.eye(2)[np.newaxis], target, model="weighted")
    >>> bool(np.allclose(moved / moved[0, 0], target / target[0, 0]))
    True
    """
    counted = np.ones(len(transforms), dtype=bool)
    if conditional or model == "identity":
        z, c = group_conventions(coordinates, transforms, counted, model=model)
    else:
        z, c = _of_average_participant(coordinates, transforms)
    if model == "weighted":
        order, sign = _matched(z, target)
        return z[:, order] * sign, c[:, order][:, :, order]
    # Of a participant at Z C, who may be turned at will, Z R needs R' C R.
    rotation, _ = orthogonal_procrustes(z, target - target.mean(axis=0))
    return z @ rotation, rotation.T @ c @ rotation


def procrustes_distance(a: np.ndarray, b: np.ndarray) -> float:
    """How much two configurations differ after moving, scaling, rotating and reflecting: sqrt(1 - r^2), from 0 to 1.

    Parameters
    ----------
    a, b : ndarray, shape (n, p)

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]])
    >>> procrustes_distance(square, 3 - 2 * square[:, ::-1]) < 1e-7
    True
    """
    x, y = a - a.mean(axis=0), b - b.mean(axis=0)
    size = np.linalg.norm(x) * np.linalg.norm(y)
    if size == 0:
        return 1.0
    r = np.linalg.svd(x.T @ y / size, compute_uv=False).sum()
    return float(np.sqrt(max(1 - r**2, 0.0)))


def _of_average_participant(coordinates: np.ndarray, transforms: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    group = np.sqrt(np.mean(np.einsum("kcr,kcr->kc", transforms, transforms), axis=0))
    group = np.where(group > 0, group, 1.0)
    z = (coordinates - coordinates.mean(axis=0)) * group
    size = np.sqrt(np.sum(np.mean(z**2, axis=0)))
    return z / (size if size > 0 else 1.0), np.abs(transforms / group[:, np.newaxis])


def _matched(z: np.ndarray, target: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    x = target - target.mean(axis=0)
    size = np.outer(np.linalg.norm(x, axis=0), np.linalg.norm(z, axis=0))
    # A dimension on which all points coincide is like no other, and takes the place that is left.
    correlation = np.divide(x.T @ z, size, out=np.zeros(size.shape), where=size > 0)
    _, order = linear_sum_assignment(-np.abs(correlation))
    return order, np.where(correlation[np.arange(len(order)), order] < 0, -1.0, 1.0)
