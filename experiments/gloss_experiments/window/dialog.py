"""PsychoPy's dialog, which asks for the details of a session that the command line left out.

Qt aborts the process where a library of the system is missing, and nothing in Python can catch that. So the dialog runs
in a process of its own, which also keeps Qt away from the session's window.
"""

import json
import os
import subprocess
import sys
from collections.abc import Mapping

from glossspace.errors import GlossError

__all__ = ["ask_details"]

_DEBIAN_PACKAGES = (
    "libegl1 libglib2.0-0 libfontconfig1 libdbus-1-3 libxkbcommon-x11-0 libxcb-cursor0 libxcb-icccm4 libxcb-keysyms1 "
    "libxcb-shape0 libxi6"
)
_WAY_OUT = "Or give the details on the command line; gloss session --help lists them."


def ask_details(known: Mapping[str, str | None], *, title: str = "gloss session") -> dict[str, str] | None:
    """Ask for what is not known, in a dialog.

    Parameters
    ----------
    known
        ``{detail: value}``; the dialog shows the known ones, and asks for those that are None. All must be filled in.
    title
        Of the dialog.

    Returns
    -------
    dict or None
        ``{detail: value}`` for all of them, in their order; None where the dialog was cancelled.

    Raises
    ------
    GlossError
        There is no display, or the dialog cannot be shown for want of a Python package or a system library.

    Examples
    --------
    >>> ask_details({"participant": None, "session": "1"})  # doctest: +SKIP
    {'participant': '07', 'session': '1'}
    """
    has_no_display = sys.platform.startswith("linux") and not (
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY") or os.environ.get("QT_QPA_PLATFORM")
    )
    if has_no_display:
        raise GlossError(f"No display for the dialog that asks for {_missing(known)} (DISPLAY is not set). {_WAY_OUT}")
    result = subprocess.run(
        [sys.executable, "-m", "gloss_experiments.window.dialog"],
        input=json.dumps({"known": dict(known), "title": title}),
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    if result.returncode != 0:
        reason = _reason(result.stderr)
        raise GlossError(
            f"The dialog that asks for {_missing(known)} cannot be shown{reason}. On Debian: apt-get install "
            f"{_DEBIAN_PACKAGES}. {_WAY_OUT}"
        )
    answer: dict[str, str] | None = json.loads(result.stdout.splitlines()[-1])
    return answer


def _missing(known: Mapping[str, str | None]) -> str:
    return ", ".join(detail for detail, value in known.items() if value is None) or "nothing"


def _reason(stderr: str) -> str:
    """What Qt or Python said: the line that names a library or a package, else the last one."""
    lines = [line.strip() for line in stderr.splitlines() if line.strip()]
    told = [line for line in lines if "needed" in line or "No module named" in line or "cannot open shared" in line]
    chosen = (told or lines[-1:] or [""])[0]
    return f" ({chosen.rstrip('.')})" if chosen else ""


def _show(known: Mapping[str, str | None], title: str) -> dict[str, str] | None:
    from psychopy import gui

    dialog = gui.Dlg(title=title, alwaysOnTop=True)
    for detail, value in known.items():
        if value is None:
            dialog.addField(detail, "", label=detail, required=True)
        else:
            dialog.addFixedField(detail, label=detail, initial=value)
    filled_in = dialog.show()
    return None if filled_in is None else {detail: str(filled_in[detail]).strip() for detail in known}


if __name__ == "__main__":
    request = json.load(sys.stdin)
    print(json.dumps(_show(request["known"], request["title"])))
