"""Every example in the docstrings of the experiments runs, and every public function and class says what it is."""

import doctest
import importlib
import inspect
import pkgutil

import pytest

import gloss_experiments

MODULES = [one.name for one in pkgutil.walk_packages(gloss_experiments.__path__, "gloss_experiments.") if not one.ispkg]


@pytest.mark.parametrize("name", MODULES)
def test_docstrings(name):
    module = importlib.import_module(name)
    failed, _ = doctest.testmod(module)
    assert failed == 0
    public = [getattr(module, name) for name in module.__all__]
    assert all(one.__doc__ for one in public if inspect.isclass(one) or inspect.isfunction(one))
