"""What all tests share: a cache of rendering results that is theirs alone, and gone with them."""

from collections.abc import Iterator

import pytest


@pytest.fixture(scope="session", autouse=True)
def session_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Keep renderers, also those in processes that a test starts, away from the user's own cache folder."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("GLOSSSPACE_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield
