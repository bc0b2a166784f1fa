"""What commands say to somebody who waits for a fit, of which no part can be counted."""

__all__ = ["FITTING"]

FITTING = (
    "Fitting takes a while. The first call on a machine also compiles the solver, for a quarter of a minute, and keeps "
    "it on disk."
)
