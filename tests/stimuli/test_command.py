import json
import subprocess
import sys
from pathlib import Path

import pytest

from gloss_stimuli import exact_renderer
from gloss_stimuli.command import render
from gloss_stimuli.exact import LEVELS
from glossspace import cli
from glossspace.stimulus_set import StimulusSet, read_stimulus_set

MAIN = "from glossspace.cli import main; main()"
# As the fixture `rendered` is made, so that its coefficients serve here.
DRAFT = {"size": "64", "quality": "draft"}


def test_json_is_one_document_and_nothing_else(few_paints: Path, rendered: StimulusSet, tmp_path: Path, capsys) -> None:
    render(stimulus_set=str(few_paints), out=tmp_path / "out", json=True, **DRAFT)
    captured = capsys.readouterr()
    document = json.loads(captured.out)
    stimuli = read_stimulus_set(tmp_path / "out")
    assert document == {
        "set": "paints",
        "folder": str(tmp_path / "out"),
        "manifest": str(tmp_path / "out" / "manifest.json"),
        "stimuli": [s.name for s in rendered.stimuli],
        "method": "exact",
        "target": {"max_code_error": 2.0, "fraction": 0.99},
        "worst_code_error_99_9": max(e["error_estimate"]["percentile_99_9"] for e in stimuli.manifest["stimuli"]),
        "reached_target": True,
        "clipped_pixels": 0,
    }
    # What was reached is said to the person, too.
    assert "is reached" in " ".join(captured.err.split())


@pytest.mark.usefixtures("rendered")
def test_a_target_that_was_not_reached_is_in_the_document(
    few_paints: Path, tmp_path: Path, capsys, monkeypatch
) -> None:
    monkeypatch.setattr(exact_renderer, "LEVELS", LEVELS[:2])
    render(
        stimulus_set=str(few_paints), out=tmp_path / "out", size="64", max_code_error=1.0, fraction=0.99999999999,
        json=True,
    )  # fmt: skip
    captured = capsys.readouterr()
    document = json.loads(captured.out)
    assert document["target"] == {"max_code_error": 1.0, "fraction": 0.99999999999}
    assert document["reached_target"] is False
    assert "Short of the target" in " ".join(captured.err.split())


@pytest.mark.usefixtures("rendered")
def test_without_json_stdout_is_one_line(few_paints: Path, tmp_path: Path, capsys) -> None:
    render(stimulus_set=str(few_paints), out=tmp_path / "out", **DRAFT)
    assert capsys.readouterr().out == f"3 stimuli of paints in {tmp_path / 'out'}\n"


def test_words_of_the_command_line_are_the_options_of_the_function(tmp_path: Path, monkeypatch) -> None:
    class Stop(Exception):
        pass

    def render_set(source: str, out: Path, **options: object) -> None:
        assert (source, out) == ("doi", tmp_path / "out")
        assert options == {
            "size": "640x480", "quality": "draft", "max_code_error": 0.25, "fraction": 0.9, "method": "path",
            "samples_per_pixel": 64, "seed": 7, "cache": tmp_path / "cache", "scene": "checkerboard_box",
        }  # fmt: skip
        raise Stop

    monkeypatch.setattr("gloss_stimuli.render.render_set", render_set)
    words = (
        f"render --set doi --out {tmp_path}/out --size 640x480 --quality draft --max-code-error .25 --fraction .9 "
        f"--method path --spp 64 --seed 7 --cache {tmp_path}/cache --scene checkerboard_box"
    )
    with pytest.raises(Stop):
        cli.main(words.split())


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("--set nonsense", "Unknown stimulus set 'nonsense'"),
        ("--set doi --size 513", "The size must be an even number from 2 to 4096, but is 513"),
        ("--set doi --quality best", "--quality"),
        ("--set doi --fraction 1.5", "fraction must lie between 0 and 1, both excluded, but is 1.5"),
        ("--set doi --max-code-error nan", "Must be a finite number"),
        ("--set doi --method radiosity", "--method"),
        ("--set doi --spp 1.5", "'1.5' is not a whole number"),
        ("--set doi --spp 16", "(--spp) is for --method path alone"),
        ("--set doi --seed -1", "--seed"),
        ("--set doi --scene kitchen", "No scene 'kitchen'"),
    ],
)
def test_a_mistake_is_one_line_and_code_2(tmp_path: Path, capsys, words: str, message: str) -> None:
    with pytest.raises(SystemExit) as stop:
        cli.main(["render", *words.split(), "--out", str(tmp_path / "out")])
    assert stop.value.code == 2
    captured = capsys.readouterr()
    assert message in captured.err
    assert captured.err.count("\n") == 1
    assert captured.out == ""
    assert not (tmp_path / "out").exists()


def test_a_process_of_its_own_ends_with_code_2(tmp_path: Path) -> None:
    command = [sys.executable, "-c", MAIN, "render", "--set", "nonsense", "--out", str(tmp_path / "out")]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 2, result.stderr
    assert "Unknown stimulus set 'nonsense'" in " ".join(result.stderr.split())
    assert "Traceback" not in result.stderr


def test_importing_the_room_loads_no_renderer() -> None:
    code = "import sys, gloss_stimuli, gloss_stimuli.command; print({'mitsuba', 'drjit', 'numba'} & set(sys.modules))"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "set()"


def test_rendering_exactly_loads_no_mitsuba(rendered_alone: tuple[StimulusSet, set[str]]) -> None:
    stimuli, modules = rendered_alone
    assert stimuli.manifest["rendering"]["method"] == "exact"
    assert "numba" in modules
    assert {"mitsuba", "drjit"} & modules == set()
