"""Property fitting: in which direction of a configuration a property of the stimuli rises, and how closely."""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.stats import f as f_distribution

from glossspace.errors import GlossError

__all__ = ["PropertyVector", "centred_points", "property_vector", "property_vectors"]


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
        The property is the same for all stimuli, is not finite, has not one value a stimulus, or has no direction in
        the configuration.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]])
    >>> fitted = property_vector(square, np.array([0.0, 1.0, 1.0, 2.0]))
    >>> fitted.angle_deg.round(6).tolist()
    [45.0, 45.0]
    """
    x, values = centred_points(coordinates, "configuration"), np.asarray(values, dtype=float)
    if values.shape != (len(x),):
        raise GlossError(f"A property of shape {values.shape} does not fit {len(x)} stimuli. Give one value for each.")
    # Differences tell, not the centred values: the mean of equal numbers may be a rounding error off.
    if not np.all(np.isfinite(values)) or np.ptp(values) == 0:
        raise GlossError("Property fitting needs a finite property that differs between the stimuli.")
    centred = (values - values.mean()) / np.ptp(values)
    slope, *_ = np.linalg.lstsq(x, centred)
    if np.linalg.norm(x @ slope) <= 1e-12 * np.linalg.norm(centred):  # nothing but rounding
        raise GlossError("The property is not related to the configuration at all, so that it has no direction there.")
    residual = centred - x @ slope
    direction = slope / np.linalg.norm(slope)
    angle = np.degrees(np.arccos(np.clip(np.abs(direction), 0, 1)))
    return PropertyVector(direction, float(1 - residual @ residual / (centred @ centred)), angle)


def property_vectors(coordinates: np.ndarray, properties: pd.DataFrame) -> pd.DataFrame:
    """Fit several properties of the stimuli to a configuration of any number of dimensions, each by itself.

    Parameters
    ----------
    coordinates : ndarray, shape (n, n_dims)
    properties : DataFrame, n rows
        One column a property, rows in the order of `coordinates`.

    Returns
    -------
    DataFrame
        One row a property, with its name as index, and the columns `r_squared`; `p_value`, of the F test of the
        regression on all dimensions, which takes the configuration as given (NaN where n - 1 dimensions or more leave
        nothing to test); `direction_1` ..., the unit vector; `angle_1_deg` ..., its angle to each dimension as a line,
        0 to 90; and `angle_to_NAME_deg`, its angle to the direction of each property, 0 to 180.

    Raises
    ------
    GlossError
        See `property_vector`; the message names the property. Or names are not unique.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]])
    >>> table = property_vectors(square, pd.DataFrame({"c": [0.0, 0.0, 1.0, 1.0], "d": [0.0, 1.0, 1.0, 2.0]}))
    >>> table["angle_to_d_deg"].round(6).to_dict()
    {'c': 45.0, 'd': 0.0}
    """
    names = [str(name) for name in properties.columns]
    if not names or len(set(names)) < len(names):
        raise GlossError(f"Properties need names that differ, not {names}. Rename the columns.")
    fitted = []
    for place, name in enumerate(names):
        try:
            fitted.append(property_vector(coordinates, properties.iloc[:, place].to_numpy(dtype=float)))
        except GlossError as error:
            raise GlossError(f"Property {name!r}: {error}") from None
        except (TypeError, ValueError):
            raise GlossError(f"Property {name!r} holds something else than numbers. Remove or recode it.") from None
    n, p = np.shape(coordinates)
    r_squared = np.array([one.r_squared for one in fitted])
    directions = np.array([one.direction for one in fitted])
    columns = {"r_squared": r_squared, "p_value": _regression_p_value(r_squared, n, p)}
    columns |= {f"direction_{r + 1}": directions[:, r] for r in range(p)}
    columns |= {f"angle_{r + 1}_deg": np.array([one.angle_deg[r] for one in fitted]) for r in range(p)}
    columns |= {
        f"angle_to_{name}_deg": _angle_between_deg(directions, one.direction)
        for name, one in zip(names, fitted, strict=True)
    }
    return pd.DataFrame(columns, index=pd.Index(names, name="property"))


def _regression_p_value(r_squared: np.ndarray, n: int, p: int) -> np.ndarray:
    left = n - p - 1
    if left < 1:
        return np.full(len(r_squared), np.nan)
    with np.errstate(divide="ignore"):  # a perfect fit has an infinite F
        ratio = (r_squared / p) / (np.maximum(1 - r_squared, 0.0) / left)
    return np.asarray(f_distribution.sf(ratio, p, left))


def _angle_between_deg(directions: np.ndarray, other: np.ndarray) -> np.ndarray:
    # By the chord: the arc cosine is blind to angles below 1e-8.
    return np.degrees(
        2 * np.arctan2(np.linalg.norm(directions - other, axis=1), np.linalg.norm(directions + other, axis=1))
    )


def centred_points(points: np.ndarray, what: str) -> np.ndarray:
    """Points, shape (n, p), as finite numbers with their centre at the origin; `what` names them in the error."""
    points = np.asarray(points, dtype=float)
    if points.ndim != 2 or points.size == 0 or not np.all(np.isfinite(points)):
        raise GlossError(f"A {what} must be a finite table, stimuli by dimensions, not of shape {points.shape}.")
    return np.asarray(points - points.mean(axis=0))
