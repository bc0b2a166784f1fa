"""How many samples a rendering takes: the named qualities."""

from dataclasses import dataclass

from glossspace.errors import GlossError

__all__ = ["QUALITIES", "Quality", "find_quality"]


@dataclass(frozen=True, kw_only=True)
class Quality:
    """Sampling of one set of coefficient passes. Counts of samples are powers of two (a lattice asks for it).

    Attributes
    ----------
    name : str
        What the user asks for.
    randomisations : int
        Independent repetitions; their scatter is the error estimate.
    diffuse_samples : int
        Paths a pixel and repetition in the diffuse pass, which all stimuli share.
    sphere_samples, wall_samples : int
        The same in a specular pass, for pixels on and off the sphere.
    """

    name: str
    randomisations: int
    diffuse_samples: int
    sphere_samples: int
    wall_samples: int


# Exact repeats draft thirty-two times: longer repetitions would gain little and make an interruption wait for them.
QUALITIES = {
    quality.name: quality
    for quality in (
        Quality(name="draft", randomisations=8, diffuse_samples=256, sphere_samples=64, wall_samples=16),
        Quality(name="exact", randomisations=256, diffuse_samples=256, sphere_samples=64, wall_samples=16),
    )
}


def find_quality(name: str) -> Quality:
    """Quality of that name.

    Raises
    ------
    GlossError
        There is none.
    """
    if name not in QUALITIES:
        raise GlossError(f"Unknown quality '{name}'. Allowed are {' and '.join(QUALITIES)}.")
    return QUALITIES[name]
