"""What all tests share: a cache of rendering results that is theirs alone, and how properties are tried.

`make test` tries the same examples of every property each time, so that a commit passes or fails for good. To look for
new ones: `pytest --hypothesis-profile explore`, which draws others, and more, at every run.
"""

from collections.abc import Iterator

import pytest
from hypothesis import settings

settings.register_profile("repeatable", derandomize=True, deadline=None)  # a first example may compile
settings.register_profile("explore", max_examples=1000, deadline=None)
settings.load_profile("repeatable")


@pytest.fixture(scope="session", autouse=True)
def session_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Keep renderers, also those in processes that a test starts, away from the user's own cache folder."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("GLOSSSPACE_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield
