"""What the stimulus tests share: a working LLVM, scenes written for one test, and a small rendered set."""

from collections.abc import Callable
from pathlib import Path

import pytest

from gloss_stimuli.scene import Scene, read_scene


@pytest.fixture(scope="session")
def llvm() -> None:
    """Mitsuba's LLVM variant, with the Ward plugin registered."""
    from gloss_stimuli.variant import use_llvm
    from gloss_stimuli.ward_bsdf import register_ward

    use_llvm()
    register_ward()


@pytest.fixture
def scene_with() -> Callable[..., Scene]:
    """Make the default scene with some values of some sections replaced: ``scene_with(box={"check_size": 1.0})``."""

    def make(**sections: dict) -> Scene:
        document = read_scene().model_dump(mode="json")
        for name, values in sections.items():
            document[name].update(values)
        return Scene.model_validate(document)

    return make


@pytest.fixture
def few_paints(tmp_path: Path) -> Path:
    """A user's list of three paints with two roughnesses."""
    path = tmp_path / "paints.csv"
    path.write_text("rho_d,rho_s,alpha\n0.03,0.099,0.04\n0.767,0.033,0.04\n0.193,0.066,0.1\n", encoding="utf-8")
    return path
