"""The one exception a user's mistake raises.

A library caller catches it as the ``ValueError`` it is; the command line prints its message on one line and exits with
code 2, without a traceback.
"""


class GlossError(ValueError):
    """A mistake in what the user gave: its message says what was wrong, the value, what is allowed, and the way out."""
