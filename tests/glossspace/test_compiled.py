"""How kernels are kept on disk, with a small package of its own."""

import importlib
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

COMPILED = """
from pathlib import Path

from glossspace.compiled import compiler

compiled = compiler(Path(__file__).parent)
"""
INNER = """
from {name}.compiled import compiled

@compiled
def factor(x: float) -> float:
    return x * {value}
"""
OUTER = """
from {name}.compiled import compiled
from {name}.inner import factor

@compiled
def doubled(x: float) -> float:
    return 2 * factor(x)
"""


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[float | None], float]]:
    """Import afresh a package of two kernels, one of which calls the other, with another factor if one is given."""
    name = f"kernels_of_{tmp_path.name}".replace("-", "_")
    folder = tmp_path / name
    folder.mkdir()
    (folder / "__init__.py").touch()
    (folder / "compiled.py").write_text(COMPILED, encoding="utf-8")
    (folder / "outer.py").write_text(OUTER.format(name=name), encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)

    def run(factor: float | None = None) -> float:
        if factor is not None:
            (folder / "inner.py").write_text(INNER.format(name=name, value=factor), encoding="utf-8")
        for loaded in [module for module in sys.modules if module.split(".")[0] == name]:
            del sys.modules[loaded]
        importlib.invalidate_caches()
        return float(importlib.import_module(f"{name}.outer").doubled(1.0))

    run.folder = folder
    yield run
    for loaded in [module for module in sys.modules if module.split(".")[0] == name]:
        del sys.modules[loaded]


def kernels(folder: Path) -> dict[str, int]:
    return {path.name: path.stat().st_mtime_ns for path in folder.glob("*.nb[ic]")}


def test_a_changed_source_drops_the_kernels_that_call_it(package: Callable) -> None:
    cache = package.folder / "__pycache__"
    assert package(3.0) == 6.0
    kept = kernels(cache)
    assert any(name.startswith("outer.doubled") for name in kept)
    assert package() == 6.0
    assert kernels(cache) == kept  # nothing has changed, so nothing is compiled again
    assert package(5.0) == 10.0
    assert package() == 10.0


def test_numba_alone_would_keep_them(package: Callable) -> None:
    # If this fails numba follows calls by itself, and the cache needs no help.
    cache = package.folder / "__pycache__"
    assert package(3.0) == 6.0
    stale = {path: path.read_bytes() for path in cache.glob("outer.doubled*")}
    assert package(5.0) == 10.0
    for path in cache.glob("outer.doubled*"):
        path.unlink()
    for path, content in stale.items():
        path.write_bytes(content)
    assert package() == 6.0


def test_kernels_kept_elsewhere_are_dropped_too(
    package: Callable, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    elsewhere = tmp_path / "elsewhere"
    other = elsewhere / "others_0123"
    other.mkdir(parents=True)
    (other / "kernel.nbi").touch()
    monkeypatch.setattr("numba.core.config.CACHE_DIR", str(elsewhere))
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(elsewhere))
    assert package(3.0) == 6.0
    assert not kernels(package.folder / "__pycache__")
    assert package(5.0) == 10.0
    assert package(7.0) == 14.0
    (folder,) = elsewhere.glob(f"{package.folder.name}_*")
    kept = kernels(folder)
    assert kept
    assert package() == 14.0
    assert kernels(folder) == kept  # nothing has changed, so nothing is compiled again
    assert (other / "kernel.nbi").is_file()


def test_a_folder_that_cannot_be_written_to_does_not_matter(
    package: Callable, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (package.folder / "__pycache__").write_text("a file, so no folder can be made here", encoding="utf-8")
    monkeypatch.setattr("numba.core.config.CACHE_DIR", str(tmp_path / "elsewhere"))
    assert package(3.0) == 6.0
