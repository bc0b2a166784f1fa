"""``gloss calibrate``: what to measure, measuring it, fitting the readings, and the video card's gamma table."""

from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Literal

import pandas as pd
from cyclopts import App, Parameter

from gloss_experiments.commands.measure import measure
from glossspace.console import FiniteNumber, JsonFlag, WholeNumber, note, print_json, print_table
from glossspace.errors import GlossError

__all__ = ["calibrate", "fit", "gamma_table", "measure", "patches"]

Flag = Annotated[bool, Parameter(negative="", show_default=False)]

calibrate = App(
    name="calibrate",
    help="Calibrate the screen of the observers, and check its gamma table.",
    help_epilogue="""
Examples:

    gloss calibrate patches

    gloss calibrate measure --photometer manual --screen "EIZO no. 7" --out screen.json

    gloss calibrate fit readings.csv --screen "EIZO no. 7" --out screen.json

    gloss calibrate gamma-table

Each of them has --help with examples of its own.
""",
)


@calibrate.command(help_epilogue="")
def patches(
    *,
    levels: WholeNumber = 17,
    warm_up: FiniteNumber = 0.0,
    bits: Literal[8, 16] = 8,
    csv: Flag = False,
    json: JsonFlag = False,
) -> None:
    """List the patches of a calibration: what to show, where, and what for.

    Examples:

        gloss calibrate patches

        gloss calibrate patches --csv > readings.csv

    Parameters
    ----------
    levels
        Levels of gray that the curve is fitted to, 9 to 65.
    warm_up
        Also white every five minutes for so many minutes.
    bits
        Of the screen's code values.
    csv
        Print the table that `gloss calibrate fit` reads, its luminance_cd_m2 left for you to fill in.
    """
    from gloss_experiments.calibration import standard_patches

    wanted = standard_patches(bits=bits, levels=levels, warm_up_min=warm_up)
    rows = pd.DataFrame(
        [(p.purpose, p.position, *p.codes, p.minutes) for p in wanted],
        columns=["purpose", "position", "red", "green", "blue", "minutes"],
    )
    if csv and json:
        raise GlossError("Give --csv or --json, not both.")
    if csv:
        rows.insert(5, "luminance_cd_m2", "")
        print(rows.to_csv(index=False, lineterminator="\n"), end="")
    elif json:
        print_json([{**row, "meaning": p.meaning} for row, p in zip(rows.to_dict("records"), wanted, strict=True)])
    else:
        print_table(rows.drop(columns="minutes") if rows["minutes"].isna().all() else rows)
        for purpose, meaning in dict.fromkeys((p.purpose, p.meaning) for p in wanted):
            note(f"{purpose}: {meaning}.")
        note("Left and right are the places of the two images; full is the whole screen. All others are black.")


@calibrate.command(help_epilogue="")
def fit(
    readings: Path,
    /,
    *,
    screen: str,
    out: Path,
    luminance: Path | None = None,
    figure: Path | None = None,
    photometer: str | None = None,
    date: str | None = None,
    bits: Literal[8, 16] = 8,
    size: str | None = None,
    refresh: FiniteNumber | None = None,
    pixel_pitch: FiniteNumber | None = None,
    json: JsonFlag = False,
) -> None:
    """Fit a screen's curve to photometer readings, judge it, and keep it.

    Gain-offset-gamma and a monotone interpolation are fitted, each to gray and to
    the channels, as far as they were measured; the one that best predicts the
    verification patches, which no fit has seen, is kept.

    Examples:

        gloss calibrate fit readings.csv --screen "EIZO no. 7" --out screen.json

        gloss calibrate fit r.csv --screen EIZO --out s.json --luminance luminance.csv

        gloss calibrate fit r.csv --screen EIZO --out s.json --figure curve.png --json

    Parameters
    ----------
    readings
        A CSV file with the columns purpose (fit, verify, additivity, uniformity, veiling, warm_up, ambient), position
        (centre, left, right, full), red, green, blue, luminance_cd_m2 and, where known, minutes, x, y, photometer.
    screen
        What the lab calls this very screen.
    out
        The calibration (JSON).
    luminance
        Also write the luminance table: .csv has the columns that a scene's [display.measured] takes, .toml is the
        [display] section itself, to be put into a scene.
    figure
        Also draw the curve and its residuals (PNG, SVG or PDF).
    photometer
        What the readings were made with, where the table does not tell.
    date
        When, as in 2026-03-31; today by default.
    bits
        Of the code values.
    size
        Of the screen in pixels, as in 1920x1200; a session then asks for the same.
    refresh
        Its refresh rate in Hz; likewise.
    pixel_pitch
        Distance between the centres of its pixels in mm; likewise.
    """
    from gloss_experiments.calibration import ScreenIdentity, read_readings
    from gloss_experiments.calibration import calibrate as calibrate_screen
    from gloss_experiments.calibration.outcome import check_targets, keep, report

    check_targets(out, luminance, figure)
    table = read_readings(readings, bits=bits, photometer=photometer)
    identity = ScreenIdentity(
        name=screen,
        size_px=None if size is None else _size(size),
        refresh_hz=refresh,
        pixel_pitch_mm=pixel_pitch,
    )
    if date is None:
        note("Taken as measured today; else give --date.")
    found = calibrate_screen(table, screen=identity, bits=bits, measured_at=None if date is None else _day(date))
    keep(found, out, luminance, figure)
    report(found, out, json=json)


calibrate.command(measure, help_epilogue="")


@calibrate.command(name="gamma-table", help_epilogue="")
def gamma_table(*, reset: Flag = False, json: JsonFlag = False) -> None:
    """Read the video card's gamma table, which must be identity: the images hold the correction.

    A program that was killed leaves its table in the card.

    Examples:

        gloss calibrate gamma-table

        gloss calibrate gamma-table --reset

    Parameters
    ----------
    reset
        Set it to identity.
    """
    from gloss_experiments.preflight.gamma_table import read_gamma_table, reset_gamma_table
    from gloss_experiments.protocol import read_protocol
    from gloss_experiments.window.window import open_window

    shown = read_protocol("pairwise")
    small = shown.model_copy(update={"display": shown.display.model_copy(update={"fullscreen": False})})
    with open_window(small, simulated=False) as window:
        found = reset_gamma_table(window) if reset else read_gamma_table(window)
    if isinstance(found, str):
        raise GlossError(f"The gamma table of the video card cannot be read: {found}. A virtual display has none.")
    if json:
        print_json(
            {"identity": found.is_identity, "deviation_codes": found.deviation_codes, "entries": found.values.shape[1]}
        )
        return
    state = "identity" if found.is_identity else f"up to {found.deviation_codes:.3g} code values off identity"
    print(f"Gamma table of the video card: {state} ({found.values.shape[1]} entries).")
    if not found.is_identity:
        note("Set it to identity with --reset, and switch off night light and colour management.")


def _day(text: str) -> datetime:
    try:
        day = datetime.fromisoformat(text)
    except ValueError:
        raise GlossError(f"Invalid --date '{text}'. Allowed: a day as in 2026-03-31.") from None
    return day if day.tzinfo else day.replace(tzinfo=UTC)


def _size(text: str) -> tuple[int, int]:
    width, _, height = text.lower().partition("x")
    if not (width.strip().isdecimal() and height.strip().isdecimal()):
        raise GlossError(f"Invalid --size '{text}'. Allowed: width and height in pixels, as in 1920x1200.")
    return int(width), int(height)
