"""Regions in which points of a picture lie, as ellipses."""

from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

__all__ = ["Ellipse", "ellipse"]


@dataclass(frozen=True)
class Ellipse:
    """Region of a point in the plane of two dimensions.

    Attributes
    ----------
    stimulus : str
    centre : ndarray, shape (2,)
        Mean of the replicates.
    semi_axes : ndarray, shape (2,)
        The longer first.
    angle_deg : float
        Direction of the longer, from the first dimension towards the second, above -90 to 90.
    """

    stimulus: str
    centre: np.ndarray
    semi_axes: np.ndarray
    angle_deg: float

    def contains(self, points: np.ndarray) -> np.ndarray:
        """Which of the points, shape (k, 2), lie within; bool, shape (k,)."""
        angle = np.radians(self.angle_deg)
        axes = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        along = (np.asarray(points, dtype=float) - self.centre) @ axes
        # An ellipse without extent holds the points at its place only.
        part = np.divide(along, self.semi_axes, out=np.where(along == 0, 0.0, np.inf), where=self.semi_axes > 0)
        return np.sum(part**2, axis=1) <= 1


def ellipse(stimulus: str, points: np.ndarray, *, level: float = 0.95) -> Ellipse:
    """Ellipse of constant density that holds part `level` of a normal distribution with the covariance of `points`.

    Parameters
    ----------
    stimulus : str
    points : ndarray, shape (k, 2)
        Two or more.
    level : float
        Above 0 and below 1.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> drawn = rng.standard_normal((1000, 2)) * [1, 3]
    >>> found = ellipse("s1", drawn)
    >>> bool(80 < abs(found.angle_deg) <= 90), round(float(found.contains(drawn).mean()), 1)
    (True, 0.9)
    """
    values, vectors = np.linalg.eigh(np.cov(np.asarray(points, dtype=float).T))
    x, y = vectors[:, 1]
    angle = np.degrees(np.arctan2(y, x))
    half_turn = -180.0 if angle > 90 else 180.0 if angle <= -90 else 0.0
    semi_axes = np.sqrt(chi2.ppf(level, 2) * np.maximum(values[::-1], 0.0))
    return Ellipse(stimulus, np.mean(points, axis=0), semi_axes, float(angle + half_turn))
