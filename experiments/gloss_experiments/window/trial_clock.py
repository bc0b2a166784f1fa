"""The clock of a trial, which stands still while the observer is asked something else."""

import contextlib
import time
from collections.abc import Callable, Iterator

__all__ = ["TrialClock"]


class TrialClock:
    """Seconds since the stimuli appeared, less the time of interruptions.

    Parameters
    ----------
    now
        Seconds on a clock that never goes back.

    Examples
    --------
    >>> clock = TrialClock(iter([10.0, 12.0, 15.0, 16.5]).__next__)
    >>> clock.start()  # at 10
    >>> with clock.paused():  # from 12 to 15
    ...     pass
    >>> clock.elapsed_s()  # at 16.5
    3.5
    """

    def __init__(self, now: Callable[[], float] = time.perf_counter) -> None:
        self._now = now
        self._began_s = 0.0

    def start(self) -> None:
        """The stimuli appear now."""
        self._began_s = self._now()

    def elapsed_s(self) -> float:
        """Seconds since then."""
        return self._now() - self._began_s

    @contextlib.contextmanager
    def paused(self) -> Iterator[None]:
        """What happens within is not counted."""
        begin = self._now()
        try:
            yield
        finally:
            self._began_s += self._now() - begin
