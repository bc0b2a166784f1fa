"""Run by test_screens.py in a process of its own, on an X server of its own: prints one JSON document.

``screen_program.py ACTION [WORDS]``; see the functions of these names.
"""

import contextlib
import io
import json
import os
import signal
import subprocess
import sys
import threading
import time
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from gloss_experiments import read_protocol
from gloss_experiments.calibration import Pace, Patch, standard_patches
from gloss_experiments.calibration.patch_window import AimedPhotometer, ManualPhotometer, open_patch_window
from gloss_experiments.preflight.preflight import check_screen
from gloss_experiments.window.window import open_window, refresh_period_s
from glossspace.stimulus_set import read_stimulus_set

PAIRWISE = read_protocol("pairwise")
WINDOWED = PAIRWISE.model_copy(update={"display": PAIRWISE.display.model_copy(update={"fullscreen": False})})


def checked(window, stimuli):
    now = datetime(2026, 1, 1, tzinfo=UTC)
    found = check_screen(window, WINDOWED, read_stimulus_set(stimuli), refresh_s=refresh_period_s(window), now=now)
    return {
        "rows": {row.name: [row.found, row.verdict] for row in found.rows},
        "problems": [row.name for row in found.problems],
        "table": found.table(),
    }


def session_window(stimuli):
    """The window of a session, as it is."""
    with open_window(WINDOWED, simulated=False) as window:
        return checked(window, stimuli)


def saved_monitor(stimuli):
    """The same where a gamma was saved in PsychoPy's Monitor Center under the name that sessions use."""
    from psychopy import monitors

    monitor = monitors.Monitor("glossspace")
    monitor.setGamma(2.2)
    monitor.save()
    again = monitors.Monitor("glossspace")
    assert again.getGamma() == 2.2, "else this proves nothing"
    return session_window(stimuli)


def corrected_window(stimuli, *, kill=False):
    """A window of somebody else, whose Monitor has a gamma: PsychoPy corrects it in the video card."""
    from psychopy import monitors, visual

    monitor = monitors.Monitor("corrected")
    monitor.setGamma(2.2)
    window = visual.Window(
        size=(1280, 1024), monitor=monitor, units="pix", gammaErrorPolicy="ignore", checkTiming=False
    )  # fmt: skip
    found = checked(window, stimuli)
    if kill:
        print(json.dumps(found), flush=True)
        os.kill(os.getpid(), signal.SIGKILL)
    window.close()
    return found


def one_by_one(stimuli):
    """Windows one after the other: of a session, with a saved Monitor, of somebody else, and of a session again."""
    return {
        "fresh": session_window(stimuli),
        "saved_monitor": saved_monitor(stimuli),
        "corrected": corrected_window(stimuli),
        "again": session_window(stimuli),
    }


def killed(stimuli):
    """Somebody else's window, killed while it is open."""
    return corrected_window(stimuli, kill=True)


def gloss(*words):
    """What `gloss calibrate` prints, or its exit code."""
    from glossspace import cli

    printed = io.StringIO()
    try:
        with contextlib.redirect_stdout(printed):
            cli.main(["calibrate", *words, "--json"])
    except SystemExit as stop:
        return stop.code
    return json.loads(printed.getvalue())


def after_the_kill(stimuli, out):
    """A session's window and the command, before and after the table is set back."""
    measuring = ("measure", "--photometer", "simulated", "--screen", "A", "--out", out)
    return {
        "inherited": session_window(stimuli),
        "read": gloss("gamma-table"),
        "measured": gloss(*measuring),
        "reset": gloss("gamma-table", "--reset"),
        "read_again": gloss("gamma-table"),
        "set_back": session_window(stimuli),
    }


def patches():
    """Show every standard patch, and compare the framebuffer with its code values."""
    wrong, lit = [], []
    image, (width, height) = 64, (1280, 1024)
    with open_patch_window(WINDOWED, image_size_px=image, simulated=True) as window:
        for patch in standard_patches():
            if patch.purpose == "ambient":
                continue
            window.show(patch)
            window.draw()
            frame = window.framebuffer()
            window.window.clearBuffer()
            x, y = window._places[patch.position]
            left, top = width // 2 + x - image // 2, height // 2 - y - image // 2
            region = frame if patch.position == "full" else frame[top : top + image, left : left + image]
            if (region != patch.codes).any():
                wrong.append(str(patch))
            around = frame.copy()
            if patch.position == "full":
                continue
            around[top : top + image, left : left + image] = 255 if patch.purpose == "veiling" else 0
            if (around != (255 if patch.purpose == "veiling" else 0)).any():
                lit.append(str(patch))
    return {"wrong": wrong, "lit_around": lit}


def typed():
    """Numbers typed with a real keyboard at a patch: a slip and its correction, nonsense, a number; then Escape."""
    with open_patch_window(WINDOWED, image_size_px=64, simulated=True) as window:
        reader = ManualPhotometer(window, "by hand")
        patch = standard_patches()[5]
        window.show(patch)

        def hand():
            time.sleep(1)
            for key in ("period", "Return", "1", "3", "BackSpace", "2", "comma", "5", "Return"):
                subprocess.run(["xdotool", "key", key], check=True, timeout=20)
                time.sleep(0.1)
            time.sleep(1)
            subprocess.run(["xdotool", "key", "Escape"], check=True, timeout=20)

        thread = threading.Thread(target=hand, daemon=True)
        thread.start()
        first = reader.read(patch, minutes=0.0)
        second = reader.read(patch, minutes=0.0)
        thread.join(timeout=30)
        return {"first": first, "second": second}


def aimed():
    """A photometer that reads by itself: it waits for the space bar where patches stand elsewhere, and there alone."""
    read, keys = [], ["space", "space", "Escape"]

    class Reader:
        name = "LS"

        def read(self, patch, *, minutes):
            read.append(patch.position)
            return 1.0

    with open_patch_window(WINDOWED, image_size_px=64, simulated=True) as window:
        photometer = AimedPhotometer(window, Reader(), Pace(lambda: 0.0, window.wait), 0.1)

        def hand():
            for key in keys:
                time.sleep(2)
                subprocess.run(["xdotool", "key", key], check=True, timeout=20)

        thread = threading.Thread(target=hand, daemon=True)
        thread.start()
        answers, lit = [], []
        for position in ("full", "centre", "left", "left", "right"):
            patch = Patch(purpose="uniformity", position=position, red=64, green=64, blue=64)
            window.show(patch)
            answers.append(photometer.read(patch, minutes=0.0))
            window.draw()
            frame = window.framebuffer()
            window.window.clearBuffer()
            lit.append(int(frame[-150:].max()))
        thread.join(timeout=30)
    return {"read": read, "answers": answers, "lit_below": lit}


def plugin(folder):
    """A photometer that another package registers with PsychoPy, as its plugins do."""
    from psychopy.hardware.photometer import BasePhotometerDevice

    from gloss_experiments.calibration import open_plugin_photometer, plugin_photometers
    from glossspace.errors import GlossError

    class FakeLS(BasePhotometerDevice):
        longName = "a fake"
        OK = True
        answers = iter([-1, None, np.array([12.5]), -1, -1, -1])

        def __init__(self, port):
            self.port = port

        def getLum(self):
            return next(self.answers)

    class Silent(BasePhotometerDevice):
        OK = False

        def __init__(self, port):
            pass

    class Dumb(BasePhotometerDevice):
        getLum = None

        def __init__(self, port):
            pass

    # As a published plugin without entry points: a package that PsychoPy does not see.
    hidden = Path(folder) / "psychopy_gammasci.py"
    hidden.write_text(
        "class S470:\n    def __init__(self, port):\n        pass\n    def getLum(self):\n        return 3.5\n"
    )
    sys.path.insert(0, str(hidden.parent))

    def refusal(act):
        try:
            act()
        except GlossError as error:
            return str(error)
        return None

    patch = standard_patches()[0]
    reader = open_plugin_photometer("FakeLS", port="COM3")
    return {
        "known": sorted(plugin_photometers()),
        "name": reader.name,
        "value": reader.read(patch, minutes=0.0),
        "complains": refusal(lambda: reader.read(patch, minutes=0.0)),
        "unknown": refusal(lambda: open_plugin_photometer("LS100")),
        "silent": refusal(lambda: open_plugin_photometer("Silent", port="COM3")),
        "dumb": refusal(lambda: open_plugin_photometer("Dumb", port="COM3")),
        "hidden": open_plugin_photometer("S470", port="COM3").read(patch, minutes=0.0),
        "no_port": refusal(lambda: open_plugin_photometer("FakeLS")),
    }


def command(out):
    """`gloss calibrate measure` with the simulated photometer; the document that it prints."""
    words = ("measure", "--photometer", "simulated", "--screen", "A", "--out", out)
    return gloss(*words, "--image-size", "256", "--settle", "0")


if __name__ == "__main__":
    actions = (session_window, one_by_one, killed, after_the_kill, patches, typed, aimed, plugin, command)
    action = {one.__name__: one for one in actions}[sys.argv[1]]
    print(json.dumps(action(*map(str, sys.argv[2:]))), flush=True)
