"""A calibrated screen as a scene takes it: its luminance table, or the section of a scene file."""

import csv
import io
from pathlib import Path

from gloss_experiments.calibration.record import Calibration
from glossspace.errors import GlossError
from glossspace.files import write_text

__all__ = ["EXPORT_SUFFIXES", "check_luminance_name", "luminance_csv", "scene_section", "write_luminance"]

EXPORT_SUFFIXES = (".csv", ".toml")


def luminance_csv(calibration: Calibration) -> str:
    """The luminance table as CSV; its columns are the keys of a scene's ``[display.measured]``.

    `codes`, and `gray_cd_m2` or `red_cd_m2`, `green_cd_m2` and `blue_cd_m2`.
    """
    columns = calibration.model.table.to_dict()
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*columns.values(), strict=True))
    return stream.getvalue()


def scene_section(calibration: Calibration) -> str:
    """The section ``[display]`` of a scene file, in TOML: put it where the scene has its own.

    Examples
    --------
    >>> from gloss_experiments.calibration import ScreenIdentity, SimulatedScreen, calibrate, simulated_readings
    >>> found = calibrate(simulated_readings(SimulatedScreen()), screen=ScreenIdentity(name="a simulated one"))
    >>> print(*scene_section(found).splitlines()[:4], sep="\\n")  # doctest: +ELLIPSIS
    # The screen 'a simulated one', SIMULATED, measured with simulated on ...
    # Chosen: gain-offset-gamma of gray, ...
    [display]
    bits = 8
    """
    # A line break in the name would end the comment.
    name, photometer = (
        " ".join(text.split()) for text in (calibration.screen.name, calibration.readings.photometer)
    )  # fmt: skip
    said = "SIMULATED, " if calibration.simulated else ""
    lines = [
        f"# The screen '{name}', {said}measured with {photometer} on {calibration.measured_at:%Y-%m-%d}.",
        f"# {calibration.reason()}",
        "[display]",
        f"bits = {calibration.bits}",
        "",
        "[display.measured]",
    ]
    for key, values in calibration.model.table.to_dict().items():
        lines.append(f"{key} = [{', '.join(map(repr, values))}]")
    return "\n".join(lines) + "\n"


def check_luminance_name(path: str | Path) -> None:
    """Refuse a name that tells no format, before long work.

    Raises
    ------
    GlossError
        Its suffix is neither .csv nor .toml.
    """
    if Path(path).suffix.lower() not in EXPORT_SUFFIXES:
        raise GlossError(
            f"Invalid luminance file '{path}'. Allowed: a file name that ends in {' or '.join(EXPORT_SUFFIXES)}."
        )


def write_luminance(calibration: Calibration, path: str | Path) -> None:
    """Write `luminance_csv` or `scene_section`, by the suffix of the file, whole or not at all.

    Raises
    ------
    GlossError
        See `check_luminance_name`; or the file cannot be written.
    """
    check_luminance_name(path)
    is_table = Path(path).suffix.lower() == EXPORT_SUFFIXES[0]
    write_text(path, luminance_csv(calibration) if is_table else scene_section(calibration))
