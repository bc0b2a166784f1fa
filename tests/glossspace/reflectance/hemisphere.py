"""Independent integration over exitant directions, for albedos and densities of lobes that are not narrow."""

import numpy as np


def over_hemisphere(function, *, count=300):
    """∫ function(exitant) dω by Gauss and Legendre's rule in cosθ and the midpoint rule in azimuth."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    phi = (np.arange(2 * count) + 0.5) * np.pi / count
    cosine, phi = np.meshgrid((nodes + 1) / 2, phi, indexing="ij")
    sine = np.sqrt(1 - cosine**2)
    exitant = np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine], axis=-1)
    return float(np.sum(function(exitant) * weights[:, None] / 2) * np.pi / count)


def random_directions(count, seed, largest_deg=85.0):
    """Unit directions spread evenly over cosθ, up to an angle from the normal."""
    generator = np.random.default_rng(seed)
    cosine = generator.uniform(np.cos(np.radians(largest_deg)), 1, count)
    phi = generator.uniform(0, 2 * np.pi, count)
    sine = np.sqrt(1 - cosine**2)
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine], axis=-1)
