"""Shared by the tests of the core."""

import pytest
from hypothesis import settings

from glossspace import cli

# A first call imports colour-science, and machines that test share their cores: no time limit for one example.
settings.register_profile("glossspace", deadline=None)
settings.load_profile("glossspace")


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
