"""Names for results: the hash of everything that determines them, so that what is unchanged is never made again."""

import hashlib
import json
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

__all__ = ["content_key"]


def content_key(*sources: str, **content: Any) -> str:
    """Hash of values as JSON takes them, and of the code of the named modules.

    A plain name is a module or sub-package of this room; one with dots, such as ``glossspace.display``, a module of the
    core.
    """
    document = json.dumps([content, [_source_hash(name) for name in sources]], sort_keys=True, allow_nan=False)
    return hashlib.sha256(document.encode()).hexdigest()


@lru_cache
def _source_hash(name: str) -> str:
    here = Path(__file__).parent
    if "." in name:
        spec = find_spec(name)
        assert spec is not None
        assert spec.origin is not None
        files = [Path(spec.origin)]
    else:
        files = sorted((here / name).glob("*.py")) or [here / f"{name}.py"]
    digest = hashlib.sha256()
    for file in files:
        digest.update(file.read_bytes())
    return digest.hexdigest()
