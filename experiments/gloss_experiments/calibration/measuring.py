"""Measuring: patch after patch is shown and read, and every reading is on the disk before the next patch."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from gloss_experiments.calibration.patches import Patch
from gloss_experiments.calibration.photometer import Photometer
from gloss_experiments.calibration.readings import Reading, Readings, read_readings, write_readings
from glossspace.errors import GlossError

__all__ = ["Pace", "measure", "readings_so_far", "simulated_pace"]


@dataclass(frozen=True)
class Pace:
    """The time of a measurement.

    Attributes
    ----------
    minutes
        Gives the minutes since it began.
    wait
        Waits so many seconds.
    """

    minutes: Callable[[], float]
    wait: Callable[[float], None]


def simulated_pace(begin_min: float = 0.0) -> Pace:
    """A clock that jumps instead of waiting, for a simulated photometer."""
    now = [begin_min]

    def wait(seconds: float) -> None:
        now[0] += seconds / 60

    return Pace(lambda: now[0], wait)


def readings_so_far(path: str | Path, patches: Sequence[Patch], *, photometer: str) -> tuple[Reading, ...]:
    """The readings of a measurement that was stopped: the beginning of `patches`; none where there is no file.

    Raises
    ------
    GlossError
        The file holds other patches or another photometer's readings.
    """
    path = Path(path)
    if not path.exists():
        return ()
    readings = read_readings(path)
    done = tuple(reading.patch for reading in readings.items)
    expected = tuple(patches[: len(done)])
    same = [
        (a.purpose, a.position, a.codes) == (b.purpose, b.position, b.codes)
        for a, b in zip(done, expected, strict=False)
    ]
    if len(done) > len(patches) or not all(same) or readings.photometer != photometer:
        raise GlossError(
            f"'{path}' holds the readings of another measurement (photometer '{readings.photometer}', {len(done)} "
            "patches). Give another name, or fit it with `gloss calibrate fit`."
        )
    return readings.items


def measure(
    patches: Sequence[Patch],
    *,
    show: Callable[[Patch], None],
    photometer: Photometer,
    pace: Pace,
    path: str | Path,
    settle_s: float = 1.0,
    on_reading: Callable[[int, int, Patch], None] | None = None,
) -> Readings | None:
    """Show every patch and read it; a measurement that was stopped goes on.

    Parameters
    ----------
    patches : sequence of Patch
    show
        Shows a patch.
    photometer : Photometer
    pace : Pace
    path : path
        CSV file of the readings, written whole after each.
    settle_s : float
        Between showing and reading.
    on_reading
        Called after each with the number of those done, of all, and the patch.

    Returns
    -------
    Readings or None
        All of them; None where the photometer stopped the measurement: what was read is in the file.

    Raises
    ------
    GlossError
        See `readings_so_far`; or the file cannot be written, or the photometer fails.
    """
    items = list(readings_so_far(path, patches, photometer=photometer.name))
    # The screen stayed on meanwhile: its clock goes on where it was, at least.
    begin_min = (items[-1].minutes or 0.0) if items else 0.0
    for patch in patches[len(items) :]:
        if patch.minutes is not None:
            pace.wait(max(0.0, 60 * (patch.minutes - begin_min - pace.minutes())))
        show(patch)
        pace.wait(settle_s)
        minutes = begin_min + pace.minutes()
        luminance = photometer.read(patch, minutes=minutes)
        if luminance is None:
            return None
        items.append(Reading(patch=patch, luminance_cd_m2=luminance, minutes=round(minutes, 2)))
        write_readings(path, Readings(tuple(items), photometer.name))
        if on_reading is not None:
            on_reading(len(items), len(patches), patch)
    return Readings(tuple(items), photometer.name)
