"""How the kernels of the scaling are compiled."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from glossspace.compiled import compiler

__all__ = ["compiled"]

compiled: Callable[[Any], Any] = compiler(Path(__file__).parent)
"""Decorator of a kernel."""
