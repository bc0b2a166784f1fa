"""PsychoPy's dialog for session details: it works with real keys, and where it cannot be shown one line says why."""

import sys

import pytest

from gloss_experiments.window.dialog import ask_details
from glossspace.errors import GlossError
from tests.experiments.virtual_display import on_a_virtual_display


def test_details_are_typed_into_the_dialog():
    filled_in, cancelled = on_a_virtual_display("dialog_program.py")
    # "07" stays a text: as a number it would be another participant.
    assert filled_in == {"participant": "07", "session": "1", "protocol": "doi"}
    assert cancelled is None


def test_an_abort_of_qt_is_one_line_that_names_the_packages(monkeypatch):
    """Qt aborts its process where no platform plugin can be loaded, as for a name that none has."""
    monkeypatch.setenv("QT_QPA_PLATFORM", "nonesuch")
    with pytest.raises(GlossError, match="asks for participant cannot be shown .* apt-get install .*libxcb-cursor0"):
        ask_details({"participant": None, "session": "1"})


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="elsewhere a display needs no variable")
def test_without_a_display_the_way_out_is_the_command_line(monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(GlossError, match="No display for the dialog that asks for participant .*on the command line"):
        ask_details({"participant": None, "session": "1"})
