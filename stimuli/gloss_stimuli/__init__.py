"""The stimulus room: renders painted spheres in a checkerboard box, and writes them down as stimulus sets.

`render_set`, and `check_rendering` before it, are the public surface; Mitsuba is imported only when something is
rendered.
"""

from gloss_stimuli.render import check_rendering, render_set

__all__ = ["check_rendering", "render_set"]
