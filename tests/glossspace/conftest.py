"""Shared by the tests of the core."""

import pytest

from glossspace import cli


@pytest.fixture
def gloss(capsys):
    """Run the command in this process: give its exit code, stdout and stderr."""

    def run(*words):
        code = 0
        try:
            cli.main(list(words))
        except SystemExit as stop:
            code = stop.code
        return code, *capsys.readouterr()

    return run
