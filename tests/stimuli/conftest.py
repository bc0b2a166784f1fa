"""What the stimulus tests share: a working LLVM, scenes written for one test, and a small set rendered once."""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from gloss_stimuli.render import render_set
from gloss_stimuli.scene import Scene, read_scene
from glossspace.stimulus_set import StimulusSet, read_stimulus_set


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


@pytest.fixture(scope="session")
def few_paints(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A user's list of three paints with two roughnesses."""
    path = tmp_path_factory.mktemp("lists") / "paints.csv"
    path.write_text("rho_d,rho_s,alpha\n0.03,0.099,0.04\n0.767,0.033,0.04\n0.193,0.066,0.1\n", encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def rendered(few_paints: Path, tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    """`few_paints` by the exact method, as ``size=64, quality="draft"`` makes it; nobody changes its files.

    64 pixels are the least on which the reflected checks are measured. Its coefficients stay in the tests' own cache.
    """
    return render_set(few_paints, tmp_path_factory.mktemp("rendered") / "out", size=64, quality="draft")


@pytest.fixture
def own_copy(rendered: StimulusSet, tmp_path: Path) -> StimulusSet:
    """`rendered` in a folder that one test may do to as it likes."""
    return read_stimulus_set(shutil.copytree(rendered.folder, tmp_path / "out"))


@pytest.fixture(scope="session")
def rendered_alone(tmp_path_factory: pytest.TempPathFactory) -> tuple[StimulusSet, set[str]]:
    """The last of `few_paints` alone, from another process with one thread more and an empty cache, and its imports."""
    from gloss_stimuli.exact.compiled import thread_count

    folder = tmp_path_factory.mktemp("alone")
    (folder / "one.csv").write_text("rho_d,rho_s,alpha\n0.193,0.066,0.1\n", encoding="utf-8")
    code = (
        "import sys; from gloss_stimuli import render_set; "
        "render_set('one.csv', 'out', size=64, quality='draft', cache='cache'); print(*sys.modules)"
    )
    environment = {**os.environ, "NUMBA_NUM_THREADS": str(thread_count() + 1)}
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return read_stimulus_set(folder / "out"), set(done.stdout.split())


@pytest.fixture
def _nothing_is_solved(monkeypatch: pytest.MonkeyPatch) -> None:
    def solve(*arguments: object, **options: object) -> None:
        raise AssertionError("nothing should be solved")

    from gloss_stimuli import exact_renderer

    monkeypatch.setattr(exact_renderer, "solve", solve)


@pytest.fixture(scope="session")
def finer(few_paints: Path, tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    """The same set from another seed, and from the two levels above those of `rendered`'s."""
    out = tmp_path_factory.mktemp("finer") / "out"
    return render_set(few_paints, out, size=64, seed=2, max_code_error=0.99, fraction=0.9)
