"""``gloss calibrate measure``: the patches are shown, read and fitted in one go."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter
from rich.progress import Progress

from glossspace.console import FiniteNumber, JsonFlag, Seed, WholeNumber, note, print_json, progress_bar
from glossspace.errors import GlossError
from glossspace.files import check_file_target

if TYPE_CHECKING:
    from gloss_experiments.calibration import Patch, Photometer
    from gloss_experiments.calibration.patch_window import PatchWindow
    from gloss_experiments.protocol import Protocol

__all__ = ["measure"]

Flag = Annotated[bool, Parameter(negative="", show_default=False)]

_INSTRUCTIONS = {
    True: (
        "Aim the photometer at each patch.\n\n"
        "Type each reading in cd/m² and press Enter. Escape stops; nothing is lost.\n\nPress the space bar to begin."
    ),
    False: (
        "The photometer reads by itself. Where it must be aimed anew, a line below the patch says so.\n\n"
        "Press the space bar to begin."
    ),
}


def measure(
    *,
    photometer: str,
    screen: str,
    out: Path,
    port: str | None = None,
    instrument: str | None = None,
    readings: Path | None = None,
    protocol: str = "pairwise",
    image_size: WholeNumber = 512,
    levels: WholeNumber = 17,
    warm_up: FiniteNumber = 0.0,
    settle: FiniteNumber = 1.0,
    pixel_pitch: FiniteNumber | None = None,
    luminance: Path | None = None,
    figure: Path | None = None,
    windowless: Flag = False,
    seed: Seed = 1,
    json: JsonFlag = False,
) -> None:
    """Show the patches of a calibration, read each, and fit the readings.

    Every reading is on the disk before the next patch is shown. Escape stops; the
    same command goes on at the next patch.

    Examples:

        gloss calibrate measure --photometer manual --screen "EIZO 7" --out s.json

        gloss calibrate measure --photometer LS100 --port COM3 --screen A --out s.json

        gloss calibrate measure --photometer simulated --screen A --out s.json

    Parameters
    ----------
    photometer
        manual: type each number at its patch. simulated: no instrument at all. Else the class of a PsychoPy plugin,
        such as LS100, CS100A, PR655, S470, ColorCAL.
    screen
        What the lab calls this very screen.
    out
        The calibration (JSON).
    port
        Serial port of a plugin's photometer.
    instrument
        With a manual photometer: what it is, such as "Minolta LS-110 no. 3".
    readings
        The readings (CSV); by default OUT with .csv in place of its suffix.
    protocol
        Whose images' places the patches take: a TOML file or the name of a shipped one.
    image_size
        Width of an image in pixels.
    levels
        Levels of gray that the curve is fitted to, 9 to 65.
    warm_up
        First show white and read it every five minutes, for so many minutes.
    settle
        Seconds between showing and reading.
    pixel_pitch
        Distance between the centres of the pixels in mm; by default the protocol's.
    luminance
        Also write the luminance table; see `gloss calibrate fit`.
    figure
        Also draw the curve and its residuals (PNG, SVG or PDF).
    windowless
        With the simulated photometer: show nothing.
    seed
        Of the simulated photometer.
    """
    from gloss_experiments.calibration import (
        ScreenIdentity,
        calibrate,
        connected_edid_sha256,
        simulated_pace,
        standard_patches,
    )
    from gloss_experiments.calibration.measuring import Pace, readings_so_far
    from gloss_experiments.calibration.measuring import measure as measure_patches
    from gloss_experiments.calibration.outcome import check_targets, keep, report
    from gloss_experiments.calibration.patch_window import AimedPhotometer
    from gloss_experiments.protocol import read_protocol

    if windowless and photometer != "simulated":
        raise GlossError("--windowless shows nothing, so only --photometer simulated can read it.")
    if instrument is not None and photometer != "manual":
        raise GlossError("--instrument names what you read by hand: it needs --photometer manual.")
    if not 0 <= settle <= 600:
        raise GlossError(f"Invalid --settle {settle:g}. Allowed: 0 to 600 seconds.")
    if image_size < 2 or image_size % 2:
        raise GlossError(f"Invalid --image-size {image_size}. Allowed: an even number of pixels from 2.")
    check_targets(out, luminance, figure)
    table = out.with_suffix(".csv") if readings is None else readings
    if table.resolve() in {path.resolve() for path in (out, luminance) if path is not None}:
        raise GlossError(f"The readings cannot go to '{table}', which is another output. Give --readings another name.")
    check_file_target(table)
    plan = read_protocol(protocol)
    pitch = plan.display.pixel_pitch_mm if pixel_pitch is None else pixel_pitch
    ScreenIdentity(name=screen, pixel_pitch_mm=pitch)  # a bad name or pitch is said before an hour of measuring
    reads_by_itself = photometer not in ("manual", "simulated")
    wanted = standard_patches(levels=levels, warm_up_min=warm_up)
    if reads_by_itself:
        wanted = tuple(patch for patch in wanted if patch.purpose != "ambient")
        note("Ambient light is left out, since nobody can switch the screen off in time: read it by hand.")
    with _photometer_and_window(photometer, port, instrument, plan, image_size, windowless, seed) as (reader, window):
        readings_so_far(table, wanted, photometer=reader.name)
        begin = time.monotonic()
        if window is None or photometer == "simulated":
            # Where no warm-up is wanted, the simulated screen has been on for long.
            pace = simulated_pace(0.0 if warm_up else 600.0)
        else:
            pace = Pace(lambda: (time.monotonic() - begin) / 60, window.wait)
            if reads_by_itself:
                reader = AimedPhotometer(window, reader, pace, settle)
        _warn_of_gamma_table(window)
        told = window is None or photometer == "simulated" or window.message(_INSTRUCTIONS[photometer == "manual"])
        found = None
        if told:
            with progress_bar() as progress:
                found = measure_patches(
                    wanted,
                    show=(lambda patch: None) if window is None else window.show,
                    photometer=reader,
                    pace=pace,
                    path=table,
                    settle_s=settle,
                    on_reading=_Bar(progress, len(wanted)).show,
                )
        identity = ScreenIdentity(
            name=screen,
            size_px=None if window is None else window.screen_size_px,
            refresh_hz=None if window is None else window.refresh_hz(),
            pixel_pitch_mm=pitch,
            edid_sha256=() if photometer == "simulated" else connected_edid_sha256(),
        )
    if found is None:
        note(f"Stopped before the end. The readings so far are in '{table}'; run the same command to go on.")
        if json:
            print_json({"finished": False, "readings": str(table)})
        return
    note(f"Readings: {table}")
    calibration = calibrate(found, screen=identity)
    keep(calibration, out, luminance, figure)
    report(calibration, out, json=json)


class _Bar:
    """Progress of a measurement."""

    def __init__(self, progress: Progress, total: int) -> None:
        self._progress, self._task = progress, progress.add_task("Patches", total=total)

    def show(self, done: int, total: int, patch: "Patch") -> None:
        self._progress.update(self._task, completed=done, total=total, description=f"Patches ({patch.purpose})")


@contextmanager
def _photometer_and_window(
    photometer: str,
    port: str | None,
    instrument: str | None,
    protocol: "Protocol",
    image_size: int,
    windowless: bool,
    seed: int,
) -> Iterator[tuple["Photometer", "PatchWindow | None"]]:
    from gloss_experiments.calibration import SimulatedPhotometer, SimulatedScreen, open_plugin_photometer

    if photometer == "simulated":
        # Faults of the size that a good screen has, so that every check finds something.
        screen = SimulatedScreen(
            ambient_cd_m2=0.02, veiling=2e-4, interaction=-0.004, left=1.006, right=0.994, warm_up_share=0.06
        )
        reader: Photometer = SimulatedPhotometer(screen, noise=0.003, digit_cd_m2=0.002, seed=seed)
        if windowless:
            yield reader, None
            return
    from gloss_experiments.calibration.patch_window import ManualPhotometer, open_patch_window

    if photometer not in ("simulated", "manual"):
        reader = open_plugin_photometer(photometer, port=port)
    with open_patch_window(protocol, image_size_px=image_size, simulated=photometer == "simulated") as window:
        if photometer == "manual":
            reader = ManualPhotometer(window, instrument or "read by hand")
        yield reader, window


def _warn_of_gamma_table(window: "PatchWindow | None") -> None:
    from gloss_experiments.preflight.gamma_table import GammaTable, read_gamma_table

    if window is None:
        return
    table = read_gamma_table(window.window)
    if isinstance(table, GammaTable) and not table.is_identity:
        raise GlossError(
            f"The video card's gamma table is {table.deviation_codes:.3g} code values off identity, so the screen "
            "would be measured through it. Set it back with `gloss calibrate gamma-table --reset`."
        )
    if isinstance(table, str):
        note(f"The video card's gamma table cannot be read ({table}): it was not checked.")
