"""The LLVM trap: whatever the library, a clear line and never an abort."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from gloss_stimuli import variant
from glossspace.errors import GlossError

SCRIPT = """
from gloss_stimuli.variant import use_llvm
from glossspace.errors import GlossError
try:
    use_llvm()
except GlossError as error:
    print(error)
    raise SystemExit(2)
"""


def run_with_library(path: str) -> subprocess.CompletedProcess:
    environment = {**os.environ, variant.LLVM_VARIABLE: path}
    return subprocess.run([sys.executable, "-c", SCRIPT], env=environment, capture_output=True, text=True, check=False)


def test_a_library_that_is_none_gives_one_clear_line(tmp_path: Path) -> None:
    fake = tmp_path / "libLLVM-19.so"
    fake.write_bytes(b"this is no library")
    result = run_with_library(str(fake))
    assert result.returncode == 2, result.stderr
    assert result.stdout.count("\n") == 1
    assert "libllvm19" in result.stdout
    assert str(fake) in result.stdout


def test_libraries_too_old_give_one_clear_line() -> None:
    # `make test` brings one on Debian 12: Mesa's drivers, which the window needs, depend on LLVM 15.
    patterns = ("usr/lib/*/libLLVM-1[456].so.1", "usr/lib/llvm-1[456]/lib/libLLVM-1[456].so.1")
    found = [path for pattern in patterns for path in Path("/").glob(pattern)]
    if not found:
        pytest.skip("no LLVM from 14 to 16 is installed")
    for library in found:
        result = run_with_library(str(library))
        assert result.returncode == 2, result.stderr
        assert "libllvm19" in result.stdout
        assert str(library) in result.stdout


def test_a_working_library_is_found() -> None:
    result = subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True, check=False)
    assert (result.returncode, result.stdout) == (0, ""), result.stderr


def test_old_versions_are_not_candidates(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("libLLVM-15.so.1", "libLLVM.so.20.1", "libLLVM-19.so", "libLLVM.so"):
        (tmp_path / name).touch()
    monkeypatch.setattr(variant, "LIBRARY_PATTERNS", (f"{tmp_path}/libLLVM*",))
    names = [Path(name).name for name in variant._candidates()]
    assert names == ["libLLVM-19.so", "libLLVM.so.20.1", "libLLVM.so"]


def test_without_any_library_the_line_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(variant.LLVM_VARIABLE, raising=False)
    monkeypatch.setattr(variant, "_works", lambda library: False)
    monkeypatch.setattr(variant, "_candidates", list)
    with pytest.raises(GlossError, match="found none.*apt-get install libllvm19"):
        variant.find_llvm.__wrapped__()


def test_a_mitsuba_that_does_not_load_is_not_blamed_on_llvm(monkeypatch: pytest.MonkeyPatch) -> None:
    # What a minimal Debian 12 without libatomic1 prints when drjit 1.5 is imported.
    trace = "Traceback ...\nImportError: libatomic.so.1: cannot open shared object file: No such file or directory\n"
    monkeypatch.setattr(
        variant.subprocess, "run", lambda *_, **__: subprocess.CompletedProcess([], 1, stdout="", stderr=trace)
    )
    with pytest.raises(GlossError, match=r"needs the system library libatomic\.so\.1, which is not installed"):
        variant._works("")
