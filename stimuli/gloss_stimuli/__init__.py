"""The stimulus room: renders painted spheres in a checkerboard box, and writes them down as stimulus sets.

`render_set`, and `check_rendering` before it, are the public surface, and for a gloss space `render_isogloss_ring` and
`render_matched_spheres`; Mitsuba is imported only when something is rendered.
"""

from gloss_stimuli.apply import render_isogloss_ring, render_matched_spheres
from gloss_stimuli.render import check_rendering, render_set

__all__ = ["check_rendering", "render_isogloss_ring", "render_matched_spheres", "render_set"]
