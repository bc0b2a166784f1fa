"""What gloss is, in numbers: the perceptual axes, their inverses, the distance, and what follows from them.

`glossspace.metric` is the whole public surface; each module behind it holds one concept.
"""

from glossspace.metric.axes import (
    Appearance,
    Paint,
    contrast_gloss,
    diffuse_reflectance,
    distinctness,
    from_physical,
    lightness,
    roughness_alpha,
    specular_reflectance,
    to_physical,
)
from glossspace.metric.envelope import fixed_energy_contrast_gloss, max_contrast_gloss
from glossspace.metric.forms import ContrastForm, DistinctnessForm
from glossspace.metric.isogloss import IsoglossContour, isogloss_contour
from glossspace.metric.matching import match_gloss
from glossspace.metric.space import PAPER_SPACE, AxisFunction, GlossSpace
from glossspace.metric.validity import PAPER_ALPHA_LIMIT, within_paper_range

__all__ = [
    "PAPER_ALPHA_LIMIT",
    "PAPER_SPACE",
    "Appearance",
    "AxisFunction",
    "ContrastForm",
    "DistinctnessForm",
    "GlossSpace",
    "IsoglossContour",
    "Paint",
    "contrast_gloss",
    "diffuse_reflectance",
    "distinctness",
    "fixed_energy_contrast_gloss",
    "from_physical",
    "isogloss_contour",
    "lightness",
    "match_gloss",
    "max_contrast_gloss",
    "roughness_alpha",
    "specular_reflectance",
    "to_physical",
    "within_paper_range",
]
