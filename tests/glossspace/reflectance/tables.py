"""Tables of known functions, for tests of what interpolates, fills and samples them."""

import numpy as np

from glossspace.reflectance import Tabulated

AXIS = np.linspace(0, 90, 19)
HALF_TURN = np.linspace(0, 180, 13)


def table_of(function, *, incident=AXIS, exitant=AXIS, phi=HALF_TURN, **options):
    """A table of function(theta_i, theta_o, phi), in degrees."""
    grid = np.meshgrid(incident, exitant, phi, indexing="ij")
    return Tabulated(incident, exitant, phi, function(*grid), **options)


def trilinear(theta_i, theta_o, phi):
    """Linear in each angle, reciprocal, and the same on both sides of the plane of incidence."""
    return 0.1 + 1e-3 * (theta_i + theta_o) + 1e-5 * theta_i * theta_o + 1e-4 * np.minimum(phi % 360, 360 - phi % 360)


def one_way(theta_i, theta_o, phi):
    return 0.1 + 1e-3 * theta_o + 0 * theta_i * phi
