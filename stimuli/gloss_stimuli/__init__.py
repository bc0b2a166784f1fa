"""The stimulus room: renders painted spheres in a checkerboard box, and writes them down as stimulus sets.

`render_set` is the public surface; Mitsuba is imported only when something is rendered.
"""

from gloss_stimuli.render import render_set

__all__ = ["render_set"]
