"""The `gloss` command: finds its sub-commands through entry points and turns errors into one line and an exit code.

Exit codes: 0 done; 1 an error of the program itself; 2 a mistake of the user; 130 interrupted.
"""

import contextlib
import io
import os
import sys
from importlib.metadata import EntryPoint, entry_points, version

from cyclopts import App
from cyclopts.exceptions import CycloptsError

from glossspace.console import ResultConsole, note
from glossspace.errors import GlossError

__all__ = ["main", "make_app"]

# Which extra brings what a sub-command imports, to be named when it is missing.
_EXTRAS = {
    "glossspace": "analysis",  # what the core lacks is matplotlib, for figures
    "gloss_stimuli": "stimuli",
    "gloss_experiments": "experiments",
    "gloss_analysis": "analysis",
    "gloss_pipeline": "stimuli,experiments,analysis",
}

_EPILOGUE = """
Examples:

    gloss convert --rho-d .193 --rho-s .066 --alpha .07 --json

    gloss reproduce --out study

Every sub-command has --help with examples of its own.
"""


def make_app(words: list[str]) -> App:
    """Build the command-line application for `words`, from the entry points of the group ``glossspace.commands``.

    The called sub-command alone is imported, so that converting three numbers does not wait for a renderer; the
    overview imports all, for their one-line descriptions.
    """
    app = App(
        name="gloss",
        help="Psychophysics of surface gloss: stimuli, observer sessions, multidimensional scaling, gloss space.",
        help_format="plaintext",
        help_epilogue=_EPILOGUE,
        version=version("glossspace"),
        console=ResultConsole(),
        # Interrupts are handled in `main`, with the exit code that shells expect.
        suppress_keyboard_interrupt=False,
    )
    commands = sorted(entry_points(group="glossspace.commands"), key=lambda entry: entry.name)
    if words == ["--version"]:
        commands = []
    called = [command for command in commands if words[:1] == [command.name]]
    for command in called or commands:
        try:
            loaded = command.load()
            # A group of sub-commands, such as `gloss calibrate fit`, is an application that has its own name and help.
            if isinstance(loaded, App):
                app.command(loaded)
            else:
                app.command(loaded, name=command.name, help_epilogue="")
        except ModuleNotFoundError as error:
            advice = _install_advice(command, error)
            if called:
                raise GlossError(f"'gloss {command.name}' {advice}") from None
            app.command(lambda: None, name=command.name, help=f"({advice})")
    return app


def main(arguments: list[str] | None = None) -> None:
    """Run the `gloss` command and exit.

    Parameters
    ----------
    arguments : list of str, optional
        The words after ``gloss``; those of the process when left out.
    """
    words = sys.argv[1:] if arguments is None else arguments
    called = entry_points(group="glossspace.commands", name=words[0]) if words else ()
    command: EntryPoint | None = next(iter(called), None)
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # a name that the terminal's encoding lacks must not end the program
    try:
        make_app(words)(words, exit_on_error=False, print_error=False, result_action="return_value")
        sys.stdout.flush()
    except GlossError as error:
        _stop(str(error), code=2)
    except CycloptsError as error:
        usage = f"gloss {command.name} --help" if command else "gloss --help"
        _stop(f"{error} See '{usage}'.", code=2)
    except ModuleNotFoundError as error:
        if command is None:
            raise
        _stop(f"'gloss {command.name}' {_install_advice(command, error)}", code=2)
    except KeyboardInterrupt:
        _stop("Interrupted. What was finished is kept; run the same command again to go on.", code=130)
    except BrokenPipeError:
        # Whoever read our output, such as `head`, left: nobody's error.
        _discard_output()
    except OSError as error:
        # Of files the rooms tell more; what is left is a full disk behind stdout, or a right that is missing.
        _discard_output()
        _stop(f"The system refuses: {error}. Check the disk's space and the permissions.", code=2)


def _install_advice(command: EntryPoint, error: ModuleNotFoundError) -> str:
    room = command.value.partition(".")[0]
    if room not in _EXTRAS or (error.name or "").startswith("gloss"):
        raise error  # a fault of the installation or of ours, not a missing extra
    return f"needs the package {error.name!r}: pip install 'glossspace[{_EXTRAS[room]}]'."


def _discard_output() -> None:
    """Let what Python still holds for stdout go nowhere: it would complain when it flushes at exit."""
    with contextlib.suppress(OSError):  # no file is behind stdout, such as in a test
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _stop(message: str, *, code: int) -> None:
    note(f"gloss: {' '.join(message.split())}")
    sys.exit(code)
