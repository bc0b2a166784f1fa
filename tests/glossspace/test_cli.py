"""The `gloss` command itself: exit codes, one line for an error, help, what a missing extra says."""

import os
import subprocess
import sys
from importlib.metadata import EntryPoint

import pytest

from glossspace import cli

CORE = ["convert", "distance", "isogloss", "match"]


@pytest.fixture
def commands(monkeypatch):
    """Replace the sub-commands that are installed by those of a test."""

    def install(**values):
        entries = [EntryPoint(name, value, "glossspace.commands") for name, value in values.items()]
        monkeypatch.setattr(
            cli, "entry_points", lambda group, name=None: [e for e in entries if name in (None, e.name)]
        )

    return install


def one_line(text):
    return text.startswith("gloss: ") and text.count("\n") == 1 and text.endswith("\n")


# Stand-ins for sub-commands, found by their names in this module.
def interrupted() -> None:
    """Stop as by Ctrl-C."""
    raise KeyboardInterrupt


def needing_mitsuba() -> None:
    """Import late what is not installed."""
    raise ModuleNotFoundError("No module named 'mitsuba'", name="mitsuba")


def complaining() -> None:
    """Refuse with a message of two lines."""
    from glossspace.errors import GlossError

    raise GlossError("First line\n  [bold]second[/] :smile: line.")


def broken() -> None:
    """Fail by a fault of the program."""
    raise RuntimeError("a bug")


@pytest.fixture(autouse=True)
def importable(monkeypatch):
    monkeypatch.setitem(sys.modules, "glossspace_test_commands", sys.modules[__name__])


HERE = "glossspace_test_commands"


@pytest.mark.parametrize("command", CORE)
@pytest.mark.parametrize("flag", ["--help", "-h"])
def test_each_sub_command_has_help_with_examples(gloss, command, flag):
    code, out, err = gloss(command, flag)
    assert code == 0
    assert err == ""
    assert f"Usage: gloss {command}" in out
    assert f"    gloss {command} " in out.partition("Examples:")[2]
    assert "--json" in out


@pytest.mark.parametrize("words", [[], ["--help"]])
def test_overview_lists_every_sub_command(gloss, commands, words):
    commands(**{name: f"glossspace.commands:{name}" for name in CORE})
    code, out, err = gloss(*words)
    assert code == 0
    assert err == ""
    assert all(name in out for name in CORE)
    assert "gloss convert --rho-d .193" in out


def test_version_needs_no_sub_command(gloss, commands):
    commands(broken="absent_xyz:nothing")
    code, out, _ = gloss("--version")
    assert code == 0
    assert out.strip().split(".")[0].isdecimal()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["nonsense"], "nonsense"),
        (["--nonsense"], "--nonsense"),
        (["convert", "--nonsense", "1"], "--nonsense"),
        (["convert", "--rho-d", "x"], "--rho-d"),
        (["convert", "--rho-d"], "--rho-d"),
        (["distance", "0,0,.1"], "requires an argument"),
        (["distance", "0,0,.1", "0,0,.1", "0,0,.1"], "0,0,.1"),
    ],
)
def test_a_mistake_is_one_line_and_exit_code_2(gloss, commands, words, message):
    commands(**{name: f"glossspace.commands:{name}" for name in CORE})
    code, out, err = gloss(*words)
    assert code == 2
    assert out == ""
    assert one_line(err)
    assert message in err
    assert "--help'" in err


def test_an_error_of_two_lines_is_printed_on_one_and_without_markup(gloss, commands):
    commands(complaining=f"{HERE}:complaining")
    code, _, err = gloss("complaining")
    assert code == 2
    assert err == "gloss: First line [bold]second[/] :smile: line.\n"


def test_an_interrupt_ends_with_130(gloss, commands):
    commands(interrupted=f"{HERE}:interrupted")
    code, out, err = gloss("interrupted")
    assert code == 130
    assert out == ""
    assert one_line(err)
    assert "Interrupted" in err


def test_a_fault_of_the_program_keeps_its_traceback(commands):
    commands(broken=f"{HERE}:broken")
    with pytest.raises(RuntimeError, match="a bug"):
        cli.main(["broken"])


class TestMissingExtra:
    @pytest.mark.parametrize(
        ("room", "extra"),
        [
            ("gloss_stimuli", "stimuli"),
            ("gloss_experiments", "experiments"),
            ("gloss_analysis", "analysis"),
            ("gloss_pipeline", "stimuli,experiments,analysis"),
            ("glossspace", "analysis"),
        ],
    )
    def test_at_run_time(self, gloss, commands, monkeypatch, room, extra):
        monkeypatch.setitem(sys.modules, f"{room}.late", sys.modules[__name__])
        commands(render=f"{room}.late:needing_mitsuba")
        code, out, err = gloss("render")
        assert code == 2
        assert out == ""
        assert err == f"gloss: 'gloss render' needs the package 'mitsuba': pip install 'glossspace[{extra}]'.\n"

    @pytest.fixture
    def hidden_matplotlib(self, monkeypatch):
        for name in [name for name in sys.modules if name.partition(".")[0] == "matplotlib"]:
            monkeypatch.delitem(sys.modules, name)

        class Hide:
            @staticmethod
            def find_spec(name, path=None, target=None):
                if name.partition(".")[0] == "matplotlib":
                    raise ModuleNotFoundError(f"No module named {name!r}", name="matplotlib")

        monkeypatch.setattr(sys, "meta_path", [Hide, *sys.meta_path])

    def test_a_figure_without_matplotlib(self, gloss, hidden_matplotlib, tmp_path):
        code, _, err = gloss("isogloss", ".193,.066,.07", "--figure", str(tmp_path / "a.png"))
        assert code == 2
        assert err == "gloss: 'gloss isogloss' needs the package 'matplotlib': pip install 'glossspace[analysis]'.\n"
        assert list(tmp_path.iterdir()) == []

    def test_when_the_sub_command_is_loaded(self, gloss, commands, monkeypatch):
        def load(self):
            raise ModuleNotFoundError("No module named 'mitsuba'", name="mitsuba")

        commands(render="gloss_stimuli.command:render", convert="gloss_stimuli.command:convert")
        monkeypatch.setattr(EntryPoint, "load", load)
        assert gloss("render") == (
            2, "", "gloss: 'gloss render' needs the package 'mitsuba': pip install 'glossspace[stimuli]'.\n",
        )  # fmt: skip
        code, out, _ = gloss("--help")
        assert code == 0
        assert "glossspace[stimuli]" in out

    def test_a_missing_part_of_our_own_is_a_fault(self, commands, monkeypatch):
        def load(self):
            raise ModuleNotFoundError("No module named 'gloss_stimuli'", name="gloss_stimuli")

        commands(render="gloss_stimuli.command:render")
        monkeypatch.setattr(EntryPoint, "load", load)
        with pytest.raises(ModuleNotFoundError, match="gloss_stimuli"):
            cli.main(["render"])


def run(*words, **environment):
    return subprocess.run(
        [sys.executable, "-c", "from glossspace.cli import main; main()", *words],
        capture_output=True, check=False, env={**os.environ, **environment},
    )  # fmt: skip


def test_as_a_process_it_ends_with_2_and_one_line():
    done = run("convert", "--rho-d", "-1", "--rho-s", "0", "--alpha", ".1", PYTHONIOENCODING="utf-8")
    assert done.returncode == 2
    assert done.stdout == b""
    assert done.stderr.decode() == f"gloss: Invalid rho_d = -1.0. Allowed: 0 to 1.{os.linesep}"


def test_a_terminal_without_unicode_still_gets_the_table():
    done = run("isogloss", ".193,.066,.07", "--radius", ".2", "--n", "4", PYTHONIOENCODING="ascii")
    assert done.returncode == 0, done.stderr
    assert b"0.287017" in done.stdout


@pytest.mark.skipif(os.name != "posix", reason="pipes close differently")
def test_a_reader_that_leaves_is_no_error():
    command = f"'{sys.executable}' -c 'from glossspace.cli import main; main()' isogloss 0,.1,.1 --n 20000 --json"
    done = subprocess.run(
        ["/bin/sh", "-c", f"{{ {command}; echo rc=$? >&2; }} | head -n 1"], capture_output=True, text=True, check=False
    )
    assert done.stdout == "{\n"
    assert done.stderr == "rc=0\n"


def stopping_amid_progress() -> None:
    """Fail by a user's mistake while a progress bar is shown."""
    from glossspace.console import progress_bar
    from glossspace.errors import GlossError

    with progress_bar() as progress:
        progress.add_task("Working", total=3)
        raise GlossError("A mistake.")


def test_an_error_amid_progress_leaves_its_line_alone(gloss, commands):
    commands(stop=f"{HERE}:stopping_amid_progress")
    assert gloss("stop") == (2, "", "gloss: A mistake.\n")


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="a device of Linux")  # noqa: PTH110
@pytest.mark.parametrize("words", [["--help"], ["distance", "--help"], ["distance", ".1,.1,.1", ".1,.1,.2"]])
def test_no_room_for_the_result_is_one_line(words):
    with open("/dev/full", "w") as full:  # noqa: PTH123
        done = subprocess.run(
            [sys.executable, "-c", "from glossspace.cli import main; main()", *words],
            stdout=full, stderr=subprocess.PIPE, text=True, check=False,
        )  # fmt: skip
    assert done.returncode == 2
    assert one_line(done.stderr)
    assert "No space left on device" in done.stderr


@pytest.mark.skipif(os.name != "posix", reason="a pipe that closes early is of POSIX")
@pytest.mark.parametrize("words", [["--help"], ["isogloss", ".193,.066,.07", "--n", "3000"]])
def test_a_reader_that_leaves_early_is_nobodys_error(words):
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(
        [sys.executable, "-c", "from glossspace.cli import main; main()", *words],
        stdout=writing, stderr=subprocess.PIPE, text=True, check=False,
    )  # fmt: skip
    os.close(writing)
    assert (done.returncode, done.stderr) == (0, "")
