"""A simulated session through the real window: how long until the first trial, and what a frame costs.

    python benchmarks/session_window.py [--size PIXELS] [--stimuli DIR]

The 378 pairs of Experiment 1 and their practice trials, 27 images loaded beforehand. Where no display is set it starts
itself on a virtual one (xvfb-run), where the processor draws too and does not wait for a refresh.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from rich.console import Console
from rich.table import Table

from gloss_experiments import run_session
from gloss_experiments.window.screen import Screen


def rendered(folder: Path, size: int) -> Path:
    arguments = ["--set", "experiment1", "--quality", "draft", "--size", str(size), "--out", str(folder / "set")]
    program = "import sys; from glossspace.cli import main; sys.exit(main())"
    subprocess.run([sys.executable, "-c", program, "render", *arguments], check=True)
    return folder / "set"


def measured(stimuli: Path, folder: Path) -> Table:
    marks: dict[str, float] = {}
    screens: list[Screen] = []
    made, begun = Screen.__init__, Screen._begin

    def make(screen: Screen, *positional: object, **named: object) -> None:
        marks["window"], cpu_s = time.perf_counter(), time.process_time()
        made(screen, *positional, **named)  # type: ignore[arg-type]
        marks["loading_cpu"] = time.process_time() - cpu_s
        screens.append(screen)

    def begin(screen: Screen, trial: object) -> None:
        marks.setdefault("first trial", time.perf_counter())
        begun(screen, trial)  # type: ignore[arg-type]

    Screen.__init__, Screen._begin = make, begin  # type: ignore[method-assign,assignment]
    marks["begin"] = time.perf_counter()
    result = run_session("pairwise", stimuli=stimuli, dataset=folder / "dataset", participant="01", mode="simulate")
    marks["end"] = time.perf_counter()
    frames = screens[0].frame_report()
    table = Table(title="A simulated session through the real window", show_header=False)
    table.add_column("")
    table.add_column("", justify="right")
    rows = {
        "checks, PsychoPy and the window (s)": marks["window"] - marks["begin"],
        "from the window to the first trial (s)": marks["first trial"] - marks["window"],
        "of that, our processor's time (s)": marks["loading_cpu"],
        f"{result.n_trials} trials, and those of practice (s)": marks["end"] - marks["first trial"],
        "own work between two flips, median (ms)": frames.median_work_ms or 0.0,
        "own work between two flips, longest (ms)": frames.longest_work_ms or 0.0,
        "frames a second": frames.n_frames / (marks["end"] - marks["first trial"]),
    }
    for name, value in rows.items():
        table.add_row(name, f"{value:.2f}")
    return table


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--size", type=int, default=512, help="width of an image")
    parser.add_argument("--stimuli", type=Path, help="a set to show in place of one that is rendered for this")
    arguments = parser.parse_args()
    if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
        if shutil.which("xvfb-run") is None:
            sys.exit("No display, and no xvfb-run to make a virtual one: apt-get install xvfb xauth")
        command = ["xvfb-run", "-a", "-s", "-screen 0 1280x1024x24", sys.executable, *sys.argv]
        sys.exit(subprocess.run(command, check=False).returncode)
    with tempfile.TemporaryDirectory() as folder:
        stimuli = arguments.stimuli or rendered(Path(folder), arguments.size)
        Console().print(measured(stimuli, Path(folder)))


if __name__ == "__main__":
    main()
