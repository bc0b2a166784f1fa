"""Frame timing: how long our own code took between two flips, and which frames came late. Times are passed in."""

from dataclasses import dataclass, field
from statistics import median

__all__ = ["FrameRecorder", "FrameReport"]

# A frame that lasts this many refresh periods has missed one.
LATE = 1.5


@dataclass(frozen=True)
class FrameReport:
    """Frames of a trial or of a session.

    Attributes
    ----------
    n_frames
        Frames shown.
    median_work_ms, longest_work_ms
        Time that our own code took from the return of one flip to the call of the next; None without a frame. It is
        wall time, so an upper bound of the processor's time.
    longest_frame_ms, n_dropped
        The longest time between two flips, and how many frames came late; None where no real display was used: a
        virtual one has no refresh to miss.
    """

    n_frames: int
    median_work_ms: float | None
    longest_work_ms: float | None
    longest_frame_ms: float | None
    n_dropped: int | None

    def to_dict(self) -> dict[str, float | int | None]:
        """The numbers, ready for JSON; times in ms, to the microsecond."""
        return {
            key: round(value, 3) if isinstance(value, float) else value for key, value in sorted(vars(self).items())
        }


@dataclass
class FrameRecorder:
    """Records the frames of a session, trial by trial.

    Parameters
    ----------
    refresh_s
        Refresh period of the display; None where it is virtual.

    Examples
    --------
    Three frames at 100 Hz, the last of which comes one period late:

    >>> recorder = FrameRecorder(refresh_s=0.010)
    >>> for called, returned in [(0.002, 0.010), (0.013, 0.020), (0.024, 0.040)]:
    ...     recorder.flipped(called_s=called, returned_s=returned)
    >>> recorder.trial().n_dropped, round(recorder.trial().longest_frame_ms), round(recorder.trial().longest_work_ms)
    (1, 20, 4)
    """

    refresh_s: float | None = None
    _returned_s: float | None = None
    _n_frames: int = 0
    _work_s: list[float] = field(default_factory=list)
    _frame_s: list[float] = field(default_factory=list)
    _session_n_frames: int = 0
    _session_work_s: list[float] = field(default_factory=list)
    _session_frame_s: list[float] = field(default_factory=list)

    def begin_trial(self) -> None:
        """A trial begins: what lies between it and the one before, such as the journal's flush, is in neither."""
        self._session_n_frames += self._n_frames
        self._session_work_s.extend(self._work_s)
        self._session_frame_s.extend(self._frame_s)
        self._n_frames = 0
        self._work_s, self._frame_s = [], []
        self._returned_s = None

    def interrupt(self) -> None:
        """The observer was asked something: the time until the next frame belongs to no frame of the trial."""
        self._returned_s = None

    def flipped(self, *, called_s: float, returned_s: float) -> None:
        """A flip was called at `called_s` and returned at `returned_s`, on one clock."""
        self._n_frames += 1
        if self._returned_s is not None:
            self._work_s.append(called_s - self._returned_s)
            self._frame_s.append(returned_s - self._returned_s)
        self._returned_s = returned_s

    def trial(self) -> FrameReport:
        """The frames of the present trial."""
        return self._report(self._n_frames, self._work_s, self._frame_s)

    def session(self) -> FrameReport:
        """The frames of all trials so far."""
        return self._report(
            self._session_n_frames + self._n_frames,
            self._session_work_s + self._work_s,
            self._session_frame_s + self._frame_s,
        )

    def _report(self, n_frames: int, work_s: list[float], frame_s: list[float]) -> FrameReport:
        real = self.refresh_s is not None and len(frame_s) > 0
        return FrameReport(
            n_frames=n_frames,
            median_work_ms=1000 * median(work_s) if work_s else None,
            longest_work_ms=1000 * max(work_s) if work_s else None,
            longest_frame_ms=1000 * max(frame_s) if real else None,
            n_dropped=sum(value > LATE * self.refresh_s for value in frame_s) if real and self.refresh_s else None,
        )
