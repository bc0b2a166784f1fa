import json
import subprocess
import sys
from pathlib import Path

import pytest

from gloss_stimuli.command import render
from gloss_stimuli.quality import QUALITIES, Quality
from glossspace.stimulus_set import read_stimulus_set

MAIN = "from glossspace.cli import main; main()"


@pytest.fixture
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    quick = Quality(name="draft", randomisations=2, diffuse_samples=2, sphere_samples=2, wall_samples=2)
    monkeypatch.setitem(QUALITIES, "draft", quick)


@pytest.mark.usefixtures("_quick")
def test_json_is_one_document_and_nothing_else(tmp_path: Path, few_paints: Path, capsys) -> None:
    render(stimulus_set=str(few_paints), out=tmp_path / "out", size=8, json=True)
    captured = capsys.readouterr()
    document = json.loads(captured.out)
    stimuli = read_stimulus_set(tmp_path / "out")
    assert document["stimuli"] == [s.name for s in stimuli.stimuli]
    errors = [entry["error_estimate"]["percentile_99_9"] for entry in stimuli.manifest["stimuli"]]
    assert document["worst_code_error_99_9"] == max(errors)
    # What was reached is said to the person, too.
    assert "short of the target" in " ".join(captured.err.split())


@pytest.mark.usefixtures("_quick")
def test_without_json_stdout_is_one_line(tmp_path: Path, few_paints: Path, capsys) -> None:
    render(stimulus_set=str(few_paints), out=tmp_path / "out", size=8)
    assert capsys.readouterr().out == f"3 stimuli of paints in {tmp_path / 'out'}\n"


def test_the_command_line_reports_a_mistake_on_one_line_with_code_2(tmp_path: Path) -> None:
    command = [sys.executable, "-c", MAIN, "render", "--set", "nonsense", "--out", str(tmp_path / "out")]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 2, result.stderr
    assert "Unknown stimulus set 'nonsense'" in " ".join(result.stderr.split())
    assert "Traceback" not in result.stderr
    assert not (tmp_path / "out").exists()


def test_importing_the_room_loads_no_renderer() -> None:
    code = "import sys, gloss_stimuli, gloss_stimuli.command; print({'mitsuba', 'drjit'} & set(sys.modules))"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "set()"
