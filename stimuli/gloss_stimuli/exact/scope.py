"""Which scenes the exact renderer holds for; anything else is better traced."""

import math
from collections.abc import Sequence

from gloss_stimuli.exact.levels import LEVELS, Level
from gloss_stimuli.exact.room import build_room
from gloss_stimuli.scene import Scene

__all__ = ["levels_within", "why_not_exact"]

# Unknowns of the walls: their exchange matrix takes four bytes for each pair.
MOST_NODES = 10_000
# The sphere's nearest wall, in radii, below which what it hides is no longer smooth on any affordable grid.
SMALLEST_GAP = 0.1
# Distance of the light from the walls beside it, in checks.
LIGHT_MARGIN = 0.2
# Opposite walls must be this many checks apart: cells that face each other are summed as points.
NARROWEST = 1.5
# Thinnest cell, in checks: splines through the nodes of a wall do not bear slivers beside whole checks.
THINNEST = 0.02
# Estimated part of the sphere's light that returns to it: images are series in it, cut off after the fourth order.
LARGEST_RETURN = 0.06
# Mean reflectance of the checks above which reflections die away too slowly to be summed.
BRIGHTEST = 0.95


def why_not_exact(scene: Scene) -> str | None:
    """Reason why a scene is beyond the exact renderer, or None if it is not.

    Examples
    --------
    >>> from gloss_stimuli.scene import read_scene
    >>> why_not_exact(read_scene()) is None
    True
    """
    box, sphere, light = scene.box, scene.sphere, scene.light
    gaps = [
        min(center - low, high - center) - sphere.radius
        for center, low, high in zip(sphere.center, box.minimum, box.maximum, strict=True)
    ]
    if min(gaps) < SMALLEST_GAP * sphere.radius:
        return f"the sphere is {min(gaps):g} from a wall, nearer than {SMALLEST_GAP:g} of its radius"
    extent = min(high - low for low, high in zip(box.minimum, box.maximum, strict=True))
    if extent < NARROWEST * box.check_size:
        return f"the box is only {extent / box.check_size:.3g} checks wide, fewer than {NARROWEST:g}"
    beside = min(
        min(center - size / 2 - low, high - center - size / 2)
        for center, size, low, high in zip(
            light.center_xz, light.size_xz, box.minimum[::2], box.maximum[::2], strict=True
        )
    )
    if beside < LIGHT_MARGIN * box.check_size:
        return f"the light is {beside:g} from a wall, nearer than {LIGHT_MARGIN:g} of a check"
    mean = (box.dark_reflectance + box.light_reflectance) / 2
    if mean > BRIGHTEST:
        return f"the checks reflect {mean:g} of the light on average, more than {BRIGHTEST:g}"
    returned = _returned(scene)
    if returned > LARGEST_RETURN:
        return f"the sphere is so large that about {returned:.2f} of its light returns, more than {LARGEST_RETURN:g}"
    checks = sum(
        2 * (high[a] - low[a]) / box.check_size * (high[b] - low[b]) / box.check_size
        for low, high in [(box.minimum, box.maximum)]
        for a, b in ((0, 1), (1, 2), (2, 0))
    )
    if checks * LEVELS[0].nodes ** 2 > MOST_NODES:
        return f"its walls have about {checks:.3g} checks: they are too small for the box"
    room = build_room(scene, width_over_gap=LEVELS[0].width_over_gap)
    thinnest = float((room.cell_high - room.cell_low).min()) / box.check_size
    if thinnest < THINNEST:
        return f"a wall or the light cuts a check to {thinnest:.2g} of its width, less than {THINNEST:g}"
    if levels_within(scene, LEVELS) < 3:
        return f"its walls have more than {MOST_NODES} unknowns: the checks are too small for the box"
    return None


def levels_within(scene: Scene, levels: Sequence[Level]) -> int:
    """Number of levels, from the coarsest on, whose unknowns fit into memory."""
    for number, level in enumerate(levels):
        nodes = len(build_room(scene, width_over_gap=level.width_over_gap).cell_wall) * level.nodes**2
        if nodes > MOST_NODES:
            return number
    return len(levels)


def _returned(scene: Scene) -> float:
    """Chance that light leaving the sphere meets it again, were the walls uniform: they see it as areas compare."""
    x, y, z = (high - low for low, high in zip(scene.box.minimum, scene.box.maximum, strict=True))
    view = 4 * math.pi * scene.sphere.radius**2 / (2 * (x * y + y * z + z * x))
    mean = (scene.box.dark_reflectance + scene.box.light_reflectance) / 2
    return mean * view / (1 - mean * (1 - view))
