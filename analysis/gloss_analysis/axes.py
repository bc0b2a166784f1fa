"""What the dimensions of a solution mean: its relation to properties of the stimuli.

A weighted solution has axes of its own, fixed up to order and sign: here they are compared with a property, never
turned. An identity solution may be turned at will: here it is turned towards the properties.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import orthogonal_procrustes
from scipy.optimize import linear_sum_assignment, minimize

from gloss_analysis.dissimilarity import Dissimilarities
from gloss_analysis.mds import MdsSolution
from gloss_analysis.objective import make_problem, stress_and_gradient
from glossspace.errors import GlossError

__all__ = ["PropertyVector", "matched_dimensions", "property_vector", "rotated_to", "rotation_cost", "turned_along"]


@dataclass(frozen=True)
class PropertyVector:
    """The direction of a configuration along which a property of the stimuli rises.

    Attributes
    ----------
    direction : ndarray, shape (n_dims,)
        Unit vector.
    r_squared : float
        Part of the property's variance that position along it explains.
    angle_deg : ndarray, shape (n_dims,)
        Angle to each dimension as a line, 0 to 90.
    """

    direction: np.ndarray
    r_squared: float
    angle_deg: np.ndarray


def property_vector(coordinates: np.ndarray, values: np.ndarray) -> PropertyVector:
    """Fit a property of the stimuli linearly to a configuration (property fitting).

    Parameters
    ----------
    coordinates : ndarray, shape (n, n_dims)
    values : ndarray, shape (n,)
        The property, such as contrast gloss.

    Returns
    -------
    PropertyVector

    Raises
    ------
    GlossError
        The property is the same for all stimuli, is not finite, or has no direction in the configuration.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]])
    >>> fitted = property_vector(square, np.array([0.0, 1.0, 1.0, 2.0]))
    >>> fitted.angle_deg.round(6)
    array([45., 45.])
    """
    centred = np.asarray(values, dtype=float) - np.mean(values)
    # Differences tell, not `centred`: the mean of equal numbers may be a rounding error off.
    if not np.all(np.isfinite(centred)) or np.ptp(values) == 0:
        raise GlossError("Property fitting needs a finite property that differs between the stimuli.")
    x = coordinates - coordinates.mean(axis=0)
    slope, *_ = np.linalg.lstsq(x, centred)
    if np.linalg.norm(x @ slope) <= 1e-12 * np.linalg.norm(centred):  # nothing but rounding
        raise GlossError("The property is not related to the configuration at all, so that it has no direction there.")
    residual = centred - x @ slope
    direction = slope / np.linalg.norm(slope)
    angle = np.degrees(np.arccos(np.clip(np.abs(direction), 0, 1)))
    return PropertyVector(direction, float(1 - residual @ residual / (centred @ centred)), angle)


def matched_dimensions(coordinates: np.ndarray, properties: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which dimension stands for which property, by correlation: the permutation and reflection of a weighted solution.

    Parameters
    ----------
    coordinates, properties : ndarray, shape (n, p)

    Returns
    -------
    order : ndarray of int, shape (p,)
        The dimension matched to each property; every dimension is used once.
    sign : ndarray, shape (p,)
        +1, or -1 where the dimension falls as the property rises.

    Raises
    ------
    GlossError
        A property or a dimension is the same for all stimuli, or is not finite.
    """
    p = coordinates.shape[1]
    columns = np.column_stack([properties, coordinates])
    if not np.all(np.isfinite(columns)) or np.any(np.ptp(columns, axis=0) == 0):
        raise GlossError("Matching needs finite properties and dimensions that differ between the stimuli.")
    correlation = np.corrcoef(columns.T)[:p, p:]
    _, order = linear_sum_assignment(-np.abs(correlation))
    return order, np.where(correlation[np.arange(p), order] < 0, -1.0, 1.0)


def rotated_to(coordinates: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Rotate or reflect an identity solution as near as possible to `target` (orthogonal Procrustes).

    Parameters
    ----------
    coordinates, target : ndarray, shape (n, p)

    Returns
    -------
    ndarray, shape (n, p)
        Distances between points stay as they are.
    """
    x = coordinates - coordinates.mean(axis=0)
    rotation, _ = orthogonal_procrustes(x, target - np.mean(target, axis=0))
    return x @ rotation


def turned_along(coordinates: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Turn a two-dimensional identity solution by property fitting: `first` rises along its first dimension.

    The second dimension then stands upright on it, on the side to which `second` rises. How far the direction of
    `second` leans from it says how far the two properties are from independent.

    Parameters
    ----------
    coordinates : ndarray, shape (n, 2)
    first, second : ndarray, shape (n,)
        Properties of the stimuli.

    Returns
    -------
    ndarray, shape (n, 2)
        Distances between points stay as they are.

    Raises
    ------
    GlossError
        See `property_vector`.
    """
    along = property_vector(coordinates, first).direction
    upright = np.array([-along[1], along[0]])
    if upright @ property_vector(coordinates, second).direction < 0:
        upright = -upright
    return (coordinates - coordinates.mean(axis=0)) @ np.column_stack([along, upright])


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
        The solution is not two-dimensional and weighted.
    """
    if solution.n_dims != 2 or solution.model != "weighted":
        raise GlossError("The cost of a rotation is defined for a weighted solution in two dimensions.")
    problem = make_problem(data, level=solution.level, ties=solution.ties)
    costs = []
    for angle in np.radians(angles_deg):
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        turned = solution.coordinates @ turn

        def loss(theta: np.ndarray, z: np.ndarray = turned) -> tuple[float, np.ndarray]:
            value, _, by_weights = stress_and_gradient(problem, z, theta.reshape(-1, 2))
            return value, by_weights.ravel()

        found = minimize(loss, solution.dimension_weights.ravel(), jac=True, method="L-BFGS-B")
        costs.append(np.sqrt(found.fun))
    return np.array(costs)
