"""What gloss is: the metric of the gloss space, and the files that the rooms share."""

from glossspace.errors import GlossError

__all__ = ["GlossError"]
