"""Photometers: what a measurement asks of one, and those that PsychoPy's plugins drive."""

import contextlib
import importlib
import importlib.util
import math
import sys
from typing import Any
from typing import Protocol as Interface

import numpy as np

from gloss_experiments.calibration.patches import Patch
from glossspace.errors import GlossError

__all__ = ["Photometer", "PluginPhotometer", "open_plugin_photometer", "plugin_photometers"]

# PsychoPy keeps its photometers in packages of their own; where each one's class is.
_HOMES = {
    "LS100": "psychopy_minolta",
    "CS100A": "psychopy_minolta",
    "PR650": "psychopy_photoresearch",
    "PR655": "psychopy_photoresearch",
    "S470": "psychopy_gammasci",
    "ColorCAL": "psychopy_crs.colorcal",
}
# It reads the pixels of the window, not light.
_NO_PHOTOMETER = "ScreenBufferPhotometerDevice"
_ATTEMPTS = 3


class Photometer(Interface):
    """Whatever reads the luminance of the patch that is shown."""

    @property
    def name(self) -> str:
        """What the calibration calls it; a simulated one begins with "simulated"."""

    def read(self, patch: Patch, *, minutes: float) -> float | None:
        """Luminance in cd/m² of `patch`, so many minutes after the beginning; None to stop the measurement."""


class PluginPhotometer:
    """A photometer that a PsychoPy class drives; make one with `open_plugin_photometer`."""

    def __init__(self, device: Any, name: str) -> None:
        self._device = device
        self.name = name

    def read(self, patch: Patch, *, minutes: float) -> float:
        """Measure once.

        Raises
        ------
        GlossError
            Three times in a row it gave no luminance.
        """
        error: object = None
        for _ in range(_ATTEMPTS):
            try:
                luminance = self._device.getLum()
                # Drivers say -1 or None where the instrument complains, and some give an array of one.
                value = math.nan if luminance is None else float(np.asarray(luminance, dtype=float).item())
            except Exception as caught:  # serial ports fail in ways of their own
                error = caught
                continue
            if 0 <= value < math.inf:
                return value
            error = f"it gave {luminance}"
        raise GlossError(
            f"The photometer {self.name} cannot read the patch '{patch}' ({error}). Check its cable, battery and "
            "range, then run the command again: it goes on here."
        )


def plugin_photometers() -> dict[str, type]:
    """The photometer classes of PsychoPy and its installed plugins, by name.

    A plugin is a package with entry points into ``psychopy.hardware``, such as psychopy-minolta;
    ``psychopy.plugins.activatePlugins`` finds them, ``psychopy.hardware.photometer`` lists their classes. Some
    published plugins (psychopy-photoresearch 0.0.3, psychopy-gammasci 0.0.1, psychopy-crs 0.0.2) lack entry points, so
    that PsychoPy does not see them: they are looked for by name.

    Raises
    ------
    GlossError
        PsychoPy is not installed.
    """
    try:
        # PsychoPy prints as it pleases, and stdout belongs to the result.
        with contextlib.redirect_stdout(sys.stderr):
            from psychopy import logging, plugins

            logging.console.setLevel(logging.CRITICAL)
            plugins.activatePlugins()
            from psychopy.hardware import photometer
    except ModuleNotFoundError as error:
        raise GlossError(
            f"A photometer plugin needs the Python package '{error.name}'. Install it with: "
            "pip install 'glossspace[experiments]'."
        ) from None
    found = {name: one for name, one in photometer.getAllPhotometers().items() if name != _NO_PHOTOMETER}
    for name, module in _HOMES.items():
        if name not in found and importlib.util.find_spec(module.partition(".")[0]) is not None:
            found[name] = getattr(importlib.import_module(module), name)
    return found


def open_plugin_photometer(name: str, *, port: str | None = None) -> PluginPhotometer:
    """Connect to a photometer of a PsychoPy plugin.

    Parameters
    ----------
    name : str
        Its class: LS100, CS100A, PR650, PR655, S470, ColorCAL, or that of another plugin.
    port : str, optional
        Serial port, such as ``"COM3"`` or ``"/dev/ttyUSB0"``.

    Raises
    ------
    GlossError
        No installed plugin has it, or it does not answer.
    """
    found = plugin_photometers()
    if name not in found:
        package = _HOMES.get(name, "").partition(".")[0].replace("_", "-")
        advice = f"Install its plugin: pip install {package}." if package else "Install the plugin that brings it."
        known = ", ".join(["manual", "simulated", *sorted(found)])
        raise GlossError(f"No photometer '{name}'. There are: {known}. {advice}")
    try:
        device = found[name]() if port is None else found[name](port)
    except Exception as error:  # drivers raise what they please
        raise GlossError(_no_answer(name, port, error)) from None
    if not callable(getattr(device, "getLum", None)):
        raise GlossError(f"The photometer {name} gives no luminance (it has no getLum). Read it by hand: manual.")
    if getattr(device, "OK", True) is False:
        raise GlossError(_no_answer(name, port, "it does not answer"))
    return PluginPhotometer(device, str(getattr(device, "longName", name)))


def _no_answer(name: str, port: str | None, reason: object) -> str:
    where = "without a port" if port is None else f"at port '{port}'"
    return (
        f"The photometer {name} cannot be opened {where} ({reason}). Switch it on in its remote mode, and give the "
        "serial port it is plugged into with --port."
    )
