"""Contracts between the rooms: imports, what a bare import may load, docstrings that run."""

import doctest
import importlib
import inspect
import pkgutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from importlinter.cli import lint_imports

import glossspace

ROOT = Path(__file__).parents[2]
MODULES = [
    "glossspace", *(module.name for module in pkgutil.walk_packages(glossspace.__path__, prefix="glossspace.")),
]  # fmt: skip


def test_imports_run_one_way_and_fences_hold(capsys):
    code = lint_imports(config_filename=str(ROOT / "pyproject.toml"), no_cache=True)
    assert code == 0, capsys.readouterr().out


@pytest.mark.parametrize("module", ["glossspace", "glossspace.metric"])
def test_a_bare_import_loads_nothing_heavy(module):
    fence = ["colour", "matplotlib", "mitsuba", "psychopy", "cyclopts", "pandas", "rich"]
    code = f"import sys, {module}; print(*[name for name in {fence} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


@pytest.mark.parametrize("name", MODULES)
def test_examples_of_docstrings(name):
    module = importlib.import_module(name)
    with np.printoptions(legacy=False):
        failed, _ = doctest.testmod(module)
    assert failed == 0


@pytest.mark.parametrize("name", MODULES)
def test_public_names_exist_and_are_documented(name):
    module = importlib.import_module(name)
    assert module.__doc__
    for public in getattr(module, "__all__", []):
        value = getattr(module, public)
        if inspect.isclass(value) or inspect.isfunction(value):
            assert value.__doc__, public
