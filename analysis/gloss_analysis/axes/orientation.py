"""What the dimensions of a solution mean: its relation to properties of the stimuli.

A weighted solution has axes of its own, fixed up to order and sign: here they are compared with a property, never
turned. An identity or generalised solution may be turned at will: towards properties, or towards a target.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.linalg import null_space
from scipy.optimize import linear_sum_assignment

from gloss_analysis.axes.property_fitting import centred_points, property_vector
from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds import MdsSolution
from gloss_analysis.mds.descent import descend_all
from gloss_analysis.mds.kernels import DIAGONAL
from gloss_analysis.mds.problem import make_problem
from gloss_analysis.mds.restriction import Restriction
from glossspace.errors import GlossError

__all__ = ["is_rotatable", "matched_dimensions", "oriented", "rotated_to", "rotation_cost", "turned_along"]


def matched_dimensions(coordinates: np.ndarray, properties: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which dimension stands for which property, by correlation: the permutation and reflection of a weighted solution.

    Parameters
    ----------
    coordinates : ndarray, shape (n, p)
    properties : ndarray, shape (n, q)
        No more than there are dimensions.

    Returns
    -------
    order : ndarray of int, shape (q,)
        The dimension matched to each property; every dimension is used once at most.
    sign : ndarray, shape (q,)
        +1, or -1 where the dimension falls as the property rises.

    Raises
    ------
    GlossError
        A property or a dimension is the same for all stimuli, or is not finite; or there are too many properties.
    """
    coordinates, properties = np.asarray(coordinates, dtype=float), np.asarray(properties, dtype=float)
    if properties.ndim != 2 or len(properties) != len(coordinates) or properties.shape[1] > coordinates.shape[1]:
        raise GlossError(
            f"Properties of shape {properties.shape} cannot be matched with a configuration of shape "
            f"{coordinates.shape}. Give one row for each stimulus, and no more properties than dimensions."
        )
    q = properties.shape[1]
    columns = np.column_stack([properties, coordinates])
    if not np.all(np.isfinite(columns)) or np.any(np.ptp(columns, axis=0) == 0):
        raise GlossError("Matching needs finite properties and dimensions that differ between the stimuli.")
    correlation = np.corrcoef(columns.T)[:q, q:]
    _, order = linear_sum_assignment(-np.abs(correlation))
    return order, np.where(correlation[np.arange(q), order] < 0, -1.0, 1.0)


def rotated_to(coordinates: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Rotate or reflect an identity solution as near as possible to `target` (orthogonal Procrustes).

    Parameters
    ----------
    coordinates : ndarray, shape (n, p)
    target : ndarray, shape (n, q), q <= p
        Neither its position nor its size matters. With fewer dimensions than the solution it counts as flat in the
        others (zeros); those are then the principal axes of what is left.

    Returns
    -------
    ndarray, shape (n, p)
        Centred; distances between points stay as they are.

    Raises
    ------
    GlossError
        The target has another number of stimuli, more dimensions, values that are not finite, or a single place.
    """
    x = centred_points(coordinates, "configuration")
    return x @ _rotation_to(x, target)


def turned_along(coordinates: np.ndarray, *properties: np.ndarray) -> np.ndarray:
    """Turn an identity solution by property fitting: the first property rises along its first dimension.

    The second dimension stands upright on it, on the side to which the second property rises, and so on. How far the
    direction of the second property leans from it says how far the two are from independent. Dimensions for which no
    property is left are the principal axes of the rest.

    Parameters
    ----------
    coordinates : ndarray, shape (n, p)
    *properties : ndarray, shape (n,)
        Properties of the stimuli. One that rises in the direction of those before it settles nothing.

    Returns
    -------
    ndarray, shape (n, p)
        Centred; distances between points stay as they are.

    Raises
    ------
    GlossError
        See `property_vector`.
    """
    x = centred_points(coordinates, "configuration")
    return x @ _rotation_along(x, properties)


def is_rotatable(solution: MdsSolution) -> bool:
    """Whether turning the group space changes no distance: unless participants weight its dimensions differently."""
    weights = solution.dimension_weights
    alike = bool(np.all(np.ptp(weights, axis=1) <= 1e-9 * weights.max(axis=1)))
    return solution.n_dims > 1 and (solution.model != "weighted" or alike)


def oriented(
    solution: MdsSolution, *, target: np.ndarray | None = None, properties: Sequence[np.ndarray] | None = None
) -> MdsSolution:
    """Turn a whole solution towards a target (`rotated_to`) or properties (`turned_along`).

    Parameters
    ----------
    solution : MdsSolution
        Of the identity or generalised model, or weighted with weights that are all alike.
    target : ndarray, shape (n, q), q <= p
    properties : sequence of ndarray, shape (n,)
        Either these or a target.

    Returns
    -------
    MdsSolution
        With coordinates and, in the generalised model, participants' matrices turned; distances and stress as before.

    Raises
    ------
    GlossError
        The axes of the solution are fixed by the data, or not exactly one of target and properties is given.
    """
    if not is_rotatable(solution):
        raise GlossError(
            f"The axes of this {solution.model} solution in {solution.n_dims} dimensions are fixed up to order and "
            "sign. Compare them with the properties (`matched_dimensions`), or scale with the identity model."
        )
    if (target is None) == (properties is None):
        raise GlossError("Give either a target or properties to turn a solution towards.")
    x = solution.coordinates - solution.coordinates.mean(axis=0)
    rotation = _rotation_to(x, target) if target is not None else _rotation_along(x, properties or ())
    if solution.model != "generalised":
        return replace(solution, coordinates=x @ rotation)
    transforms = rotation.T @ solution.transforms @ rotation
    weights = np.linalg.norm(transforms, axis=2)
    return replace(solution, coordinates=x @ rotation, transforms=transforms, dimension_weights=weights)


def _rotation_to(x: np.ndarray, target: np.ndarray) -> np.ndarray:
    towards = centred_points(target, "target")
    if len(towards) != len(x) or towards.shape[1] > x.shape[1]:
        raise GlossError(
            f"A target of shape {towards.shape} does not fit a configuration of shape {x.shape}. Allowed: one row for "
            f"each stimulus, and 1 to {x.shape[1]} dimensions."
        )
    if np.all(np.ptp(target, axis=0) == 0):
        raise GlossError("The target has all stimuli in one place. Give one in which they differ.")
    left, _, right = np.linalg.svd(x.T @ towards, full_matrices=False)
    return _completed(x, left @ right)


def _rotation_along(x: np.ndarray, properties: Sequence[np.ndarray]) -> np.ndarray:
    axes = np.empty((x.shape[1], 0))
    for values in properties:
        direction = property_vector(x, values).direction
        upright = direction - axes @ (axes.T @ direction)
        if np.linalg.norm(upright) > 1e-9:  # less is rounding
            axes = np.column_stack([axes, upright / np.linalg.norm(upright)])
    return _completed(x, axes)


def _completed(x: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """Orthonormal `axes`, shape (p, q), with the principal axes of the rest, shape (p, p)."""
    rest = null_space(axes.T) if axes.shape[1] else np.eye(len(axes))
    _, vectors = np.linalg.eigh((x @ rest).T @ (x @ rest))
    added = rest @ vectors[:, ::-1]
    seen = x @ added
    farthest = seen[np.argmax(np.abs(seen), axis=0), np.arange(added.shape[1])]
    return np.hstack([axes, added * np.where(farthest < 0, -1.0, 1.0)])


def rotation_cost(data: Dissimilarities, solution: MdsSolution, angles_deg: np.ndarray) -> np.ndarray:
    """Stress of a two-dimensional weighted solution after turning its axes, participants' weights fitted anew.

    The rise shows how firmly the data fix the axes: none at all when all participants weight both dimensions alike.

    Parameters
    ----------
    data : Dissimilarities
        What the solution was fitted to.
    solution : MdsSolution
        Two dimensions, weighted.
    angles_deg : ndarray, shape (k,)
        Turns of the axes.

    Returns
    -------
    ndarray, shape (k,)
        Stress-1 after each turn.

    Raises
    ------
    GlossError
        The solution is not two-dimensional and weighted, or not one of these data.
    """
    if (data.stimuli, data.participants) != (solution.stimuli, solution.participants):
        raise GlossError("The solution has other stimuli or participants than the data. Give what it was fitted to.")
    if solution.n_dims != 2 or solution.model != "weighted":
        raise GlossError("The cost of a rotation is defined for a weighted solution in two dimensions.")
    problem = make_problem(data, level=solution.level, ties=solution.ties, conditional=solution.conditional)
    nothing_free = np.empty((len(data.stimuli), 0))
    costs = []
    for angle in np.radians(angles_deg):
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        turned = Restriction(solution.coordinates @ turn, nothing_free)
        start = (solution.coordinates @ turn, solution.transforms)
        (found,) = descend_all(problem, [start], model=DIAGONAL, steps=1000, restriction=turned)
        costs.append(np.sqrt(found.value))
    return np.array(costs)
