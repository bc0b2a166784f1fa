"""The exact renderer: a sphere in a checkerboard box, solved rather than sampled.

A Lambertian box, a convex sphere, one light, and three numbers that vary. So the irradiance of the walls is a smooth
field, an image is a polynomial in ρd and ρs, and what the sphere mirrors is a band-limited function of where it is
seen. In the order of the light:

==============  ======================================================================================
Module          What happens there
==============  ======================================================================================
`room`          the scene as cells of walls, a sphere and a light; rays among them
`nodes`         where the walls' irradiance is unknown
`direct`        from the light to walls and sphere
`exchange`      from wall to wall
`sphere`        what the sphere hides, receives and returns diffusely
`lobe`          Ward's lobe
`specular`      what the sphere mirrors to the walls
`fields`        all of it together: a coefficient of ρd^i ρs^j for each order
`textures`      the fields as they are seen, true up to the edges
`camera`        the eye
`film`          what each pixel sees
`lobe_light`    the light's image in the sphere
`lobe_table`    the room's image in the sphere, for lobes wider than a pixel
`lobe_pixels`   the same for narrower lobes
`solution`      the coefficients of every pixel
`levels`        how finely
`scope`         which scenes this holds for
`compiled`      how kernels are compiled and run
==============  ======================================================================================
"""

from gloss_stimuli.exact.levels import LEVELS, Level
from gloss_stimuli.exact.scope import levels_within, why_not_exact
from gloss_stimuli.exact.solution import DIFFUSE_EXPONENTS, SPECULAR_EXPONENTS, solve

__all__ = ["DIFFUSE_EXPONENTS", "LEVELS", "SPECULAR_EXPONENTS", "Level", "levels_within", "solve", "why_not_exact"]
