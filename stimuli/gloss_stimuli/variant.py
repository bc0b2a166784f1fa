"""Mitsuba's LLVM variant, made safe: an unusable LLVM gives one clear line, never an abort.

Dr.Jit compiles its kernels with the system's LLVM library. Versions below 19 load, then abort the whole process at the
first minimum ("Cannot select: fmaximum"), which nothing can catch. So a library is tried in a process of its own first.
"""

import importlib.util
import os
import re
import subprocess
import sys
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

from glossspace.errors import GlossError

__all__ = ["LLVM_VARIABLE", "VARIANT", "find_llvm", "use_llvm"]

VARIANT = "llvm_ad_mono"
LLVM_VARIABLE = "DRJIT_LIBLLVM_PATH"
OLDEST_LLVM = 19

# Folders where Linux distributions, Homebrew and the Windows installer put the library.
LIBRARY_PATTERNS = (
    "/usr/lib/*-linux-gnu*/libLLVM*.so*",
    "/usr/lib/llvm-*/lib/libLLVM*.so*",
    "/usr/lib64/libLLVM*.so*",
    "/usr/lib64/llvm*/lib*/libLLVM*.so*",
    "/usr/lib/libLLVM*.so*",
    "/usr/local/lib/libLLVM*.so*",
    "/opt/homebrew/opt/llvm*/lib/libLLVM*.dylib",
    "/usr/local/opt/llvm*/lib/libLLVM*.dylib",
    "C:/Program Files/LLVM/bin/LLVM-C.dll",
)

INSTALL_HINT = (
    "Install LLVM 19 or newer (Debian and Ubuntu: `apt-get install libllvm19`; macOS: `brew install llvm`), "
    f"or set {LLVM_VARIABLE} to the full path of such a library."
)

# The instructions that old versions cannot compile, in a kernel of their own.
PROBE = f"""
import mitsuba as mi
mi.set_variant("{VARIANT}")
import drjit as dr
x = dr.arange(mi.Float, 64)
assert dr.sum(dr.maximum(dr.minimum(x, 9), 4))[0] > 0
print("usable")
"""


def use_llvm() -> None:
    """Set Mitsuba's variant for this process after making sure that LLVM works.

    Raises
    ------
    GlossError
        Mitsuba is not installed, or no usable LLVM was found.
    """
    if importlib.util.find_spec("mitsuba") is None:
        raise GlossError("Rendering needs Mitsuba. Install it with `pip install 'glossspace[stimuli]'`.")
    loaded = sys.modules.get("mitsuba")
    if loaded is not None and loaded.variant() == VARIANT:
        return
    # Found before Mitsuba is imported here, so that nothing has looked for a library yet.
    library = find_llvm()
    if library:
        os.environ[LLVM_VARIABLE] = library
    import mitsuba as mi

    mi.set_variant(VARIANT)


@lru_cache
def find_llvm() -> str:
    """Full path of an LLVM library that works, or "" if Dr.Jit finds one by itself.

    Raises
    ------
    GlossError
        The library named by DRJIT_LIBLLVM_PATH does not work, or none was found.
    """
    chosen = os.environ.get(LLVM_VARIABLE)
    if chosen:
        if _works(chosen):
            return chosen
        raise GlossError(f"The LLVM library that {LLVM_VARIABLE} names does not work: '{chosen}'. {INSTALL_HINT}")
    candidates = _candidates()
    for library in [*candidates, ""]:
        if _works(library):
            return library
    found = f"found only {', '.join(candidates)}" if candidates else "found none"
    raise GlossError(f"Rendering needs a libLLVM that Dr.Jit can use; {found}. {INSTALL_HINT}")


def _candidates() -> list[str]:
    """Libraries of a version that may work, the oldest of them first since it has been tried the longest."""
    versions: dict[str, int] = {}
    for pattern in LIBRARY_PATTERNS:
        root = Path(pattern).anchor
        for path in Path(root).glob(pattern[len(root) :]) if Path(root).is_dir() else ():
            real = path.resolve()
            if real.is_file():
                versions[str(real)] = max(versions.get(str(real), 0), _version(path), _version(real))
    # A library without a version in its name (0) may be anything: it is tried last.
    suitable = [(version == 0, version, name) for name, version in versions.items() if not 0 < version < OLDEST_LLVM]
    return [name for _, _, name in sorted(suitable)]


def _version(path: Path) -> int:
    match = re.search(r"libLLVM[-.](?:so\.)?(\d+)", path.name) or re.search(r"llvm[-@](\d+)", str(path.parent))
    return int(match.group(1)) if match else 0


def _works(library: str) -> bool:
    environment: Mapping[str, str] = {**os.environ, **({LLVM_VARIABLE: library} if library else {})}
    try:
        probe = subprocess.run(
            [sys.executable, "-c", PROBE], env=environment, capture_output=True, text=True, timeout=120, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return False
    # Mitsuba itself failed to load: no LLVM would help, so do not blame LLVM.
    missing = re.search(r"ImportError: (\S+): cannot open shared object file", probe.stderr)
    if missing:
        raise GlossError(
            f"Mitsuba needs the system library {missing.group(1)}, which is not installed. Install the package that "
            "holds it (Debian: `apt-get install libatomic1` for libatomic.so.1)."
        )
    return probe.returncode == 0 and probe.stdout.strip().endswith("usable")
