"""X servers for tests: Xvfb, whose screen has no gamma table, and Xorg with the dummy driver, whose screen has one."""

import json
import os
import shutil
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import pytest

PROGRAM = Path(__file__).parent / "screen_program.py"

_XORG_CONF = """
Section "Device"
  Identifier "dummy"
  Driver "dummy"
  VideoRam 65536
EndSection
Section "Monitor"
  Identifier "monitor"
  HorizSync 5.0-1000.0
  VertRefresh 5.0-200.0
  Modeline "1280x1024" 108.00 1280 1328 1440 1688 1024 1025 1028 1066
EndSection
Section "Screen"
  Identifier "screen"
  Device "dummy"
  Monitor "monitor"
  DefaultDepth 24
  SubSection "Display"
    Depth 24
    Modes "1280x1024"
    Virtual 1280 1024
  EndSubSection
EndSection
Section "ServerFlags"
  Option "AutoAddDevices" "false"
  Option "AutoAddGPU" "false"
EndSection
"""


def require_tools(*tools):
    for tool in tools:
        if shutil.which(tool) is None:
            pytest.fail(f"'{tool}' is missing: 'make test' installs it as root (see tools/set_up.sh)")


@contextmanager
def xorg_dummy(folder):
    """Start Xorg with the dummy driver, and give its display; its gamma table begins as identity."""
    require_tools("Xorg")
    if os.getuid() != 0:
        pytest.skip("Xorg takes a configuration file from root alone")
    (folder / "xorg.conf").write_text(_XORG_CONF)
    read_end, write_end = os.pipe()
    command = ["Xorg", "-displayfd", str(write_end), "-noreset", "-nolisten", "tcp", "-sharevts", "-novtswitch"]
    command += ["-config", str(folder / "xorg.conf"), "-logfile", str(folder / "xorg.log")]
    with (folder / "xorg.out").open("wb") as output:
        server = subprocess.Popen(command, pass_fds=[write_end], stdout=output, stderr=output)
    os.close(write_end)
    try:
        with os.fdopen(read_end) as stream:
            number = stream.readline().strip()  # empty where the server ended instead
        assert number, (folder / "xorg.out").read_text(errors="replace")[-2000:]
        yield f":{number}"
    finally:
        server.terminate()
        server.wait(timeout=30)


def run_program(*words, home, display=None, killed=False):
    """Run screen_program.py on `display`, or in an Xvfb of its own, and give the document that it prints."""
    command = [sys.executable, "-W", "ignore", str(PROGRAM), *map(str, words)]
    environment = {**os.environ, "HOME": str(home)}
    if display is None:
        require_tools("xvfb-run", "xauth", "xdotool")
        command = ["xvfb-run", "-a", "-s", "-screen 0 1280x1024x24", *command]
    else:
        environment["DISPLAY"] = display
    done = subprocess.run(command, capture_output=True, text=True, timeout=240, check=False, env=environment)
    assert done.returncode == (-9 if killed else 0), done.stderr[-3000:]
    return json.loads(done.stdout)
