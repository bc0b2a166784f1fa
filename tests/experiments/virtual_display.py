"""Runs a program on a virtual display of its own: PsychoPy keeps a window system of its own, and Qt another."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parent


def on_a_virtual_display(program, *words, home=None):
    """What a program of this folder prints as JSON; `home` is where PsychoPy keeps its settings."""
    for tool in ("xvfb-run", "xauth", "xdotool"):
        if shutil.which(tool) is None:
            pytest.fail(f"'{tool}' is missing: apt-get install xvfb xauth xdotool ('make test' does it as root)")
    command = ["xvfb-run", "-a", "-s", "-screen 0 1280x1024x24"]
    command += [sys.executable, str(FOLDER / program), *map(str, words)]
    environment = os.environ | ({} if home is None else {"HOME": str(home), "APPDATA": str(home)})
    result = subprocess.run(command, capture_output=True, text=True, timeout=240, check=False, env=environment)
    assert result.returncode == 0, result.stderr[-3000:]
    return json.loads(result.stdout.splitlines()[-1])
