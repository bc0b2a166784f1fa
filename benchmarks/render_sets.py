"""What stimulus sets cost by the exact renderer, and whether the targets of the project are met, in one run.

    python benchmarks/render_sets.py [--size 512] [--paints 66] [--quick]

All in fresh folders. First the command `gloss render --set experiment1` runs in a process of its own, with every kernel
compiled from nothing. Then this process, with those kernels on disk but no coefficients, renders one set after the
other; what a set shares with those before it comes from the cache folder. CPU seconds are those of all threads and
include measurements and files; those of the first set count from the start of Python.
"""

import argparse
import itertools
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

Paint = tuple[float, float, float]

EXPERIMENT1 = tuple(itertools.product((0.03, 0.193, 0.767), (0.033, 0.066, 0.099), (0.04, 0.07, 0.1)))
DOI_ALPHAS = (0.01, 0.025, 0.04, 0.055, 0.07, 0.085, 0.10, 0.12, 0.145, 0.17, 0.19)
NEW_ALPHA = (0.193, 0.066, 0.05)
NEW_REFLECTANCES = (0.3, 0.05, 0.07)
NARROW_LOBE = (0.03, 0.099, 0.01)
KERNELS_ALONE = "(kernels of narrow lobes, a draft)"
MANY = 1000
FULL_SIZE, QUICK_SIZE = 512, 64
MEGABYTE = 10**6
COMMAND = "import sys; from glossspace.cli import main; main(sys.argv[1:])"


@dataclass(frozen=True)
class Cost:
    """What one step took; `errors` are its images' own estimates on 99.9 % of the pixels, in codes.

    `target` is what the issue asks for, and `is_met` whether that is reached; None where nothing is asked.
    """

    step: str
    images: int
    cpu_s: float
    wall_s: float
    errors: tuple[float, ...]
    peak_bytes: int
    target: str = ""
    is_met: bool | None = None

    def judged(self, target: str, is_met: bool) -> "Cost":
        return replace(self, target=target, is_met=is_met)

    def at_most(self, seconds: float) -> "Cost":
        return self.judged(f"{seconds:g} CPU-s", self.cpu_s <= seconds)


@dataclass(frozen=True)
class Workplace:
    """Where it all happens."""

    folder: Path
    size: int
    quality: str

    def render(self, step: str, paints: str | Sequence[Paint], name: str, *, since_python: bool = False) -> Cost:
        """Render a shipped set, or a list of paints, into the sub-folder `name`, in this process."""
        cpu_before, wall_before = 0.0 if since_python else time.process_time(), time.perf_counter()
        from gloss_stimuli.render import render_set

        source, out = self._listed(paints, name), self.folder / name
        render_set(source, out, size=self.size, quality=self.quality, cache=self.folder / "cache")
        cpu_s, wall_s = time.process_time() - cpu_before, time.perf_counter() - wall_before
        errors = errors_in(out)
        peak = peak_bytes(resource.getrusage(resource.RUSAGE_SELF))
        return Cost(step, len(errors), cpu_s, wall_s, errors, peak)

    def command(self, step: str, paints: str | Sequence[Paint], name: str, *, quality: str | None = None) -> Cost:
        """The same by the command `gloss render`, in a process of its own and without any coefficients."""
        out = self.folder / name
        words = ["render", "--set", str(self._listed(paints, name)), "--size", str(self.size), "--out", str(out)]
        words += ["--quality", quality or self.quality, "--cache", str(self.folder / f"{name}-cache")]
        start = time.perf_counter()
        process = subprocess.Popen([sys.executable, "-c", COMMAND, *words], stdout=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)  # what Popen.wait would not tell: the time and memory of this child
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode:
            raise SystemExit(f"`gloss {' '.join(words)}` ended with code {process.returncode}.")
        wall_s = time.perf_counter() - start
        errors = errors_in(out)
        return Cost(step, len(errors), used.ru_utime + used.ru_stime, wall_s, errors, peak_bytes(used))

    def _listed(self, paints: str | Sequence[Paint], name: str) -> str | Path:
        if isinstance(paints, str):
            return paints
        file = self.folder / f"{name}.csv"
        file.write_text("rho_d,rho_s,alpha\n" + "".join(f"{d},{s},{alpha}\n" for d, s, alpha in paints))
        return file


def errors_in(folder: Path) -> tuple[float, ...]:
    entries = json.loads((folder / "manifest.json").read_text())["stimuli"]
    return tuple(entry["error_estimate"]["percentile_99_9"] for entry in entries)


def peak_bytes(used: resource.struct_rusage) -> int:
    """Largest memory that a process has had so far; Linux counts it in KiB, macOS in bytes."""
    return used.ru_maxrss * (1 if sys.platform == "darwin" else 1024)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", type=int, help=f"width of the images in pixels; {FULL_SIZE} if left out")
    parser.add_argument("--paints", type=int, default=66, help=f"how many paints stand for {MANY}, at least 1")
    parser.add_argument("--quick", action="store_true", help="a smoke run: small drafts, fewer sets, nothing judged")
    options = parser.parse_args()
    size = options.size or (QUICK_SIZE if options.quick else FULL_SIZE)
    with tempfile.TemporaryDirectory(prefix="gloss-benchmark-") as folder:
        if options.quick:
            costs = list(quick_run(Workplace(Path(folder), size, "draft")))
        else:
            costs = list(full_run(Workplace(Path(folder), size, "exact"), options.paints))
    show(costs, size, is_judged=size == FULL_SIZE and not options.quick)


def full_run(work: Workplace, n_paints: int) -> Iterator[Cost]:
    # Before anything imports numba, which reads it then.
    os.environ["NUMBA_CACHE_DIR"] = str(work.folder / "kernels")
    yield work.command("Experiment 1, from nothing compiled", "experiment1", "nothing").at_most(60)
    # So that compiling what only narrower lobes take is not charged to the DOI set.
    yield work.command(KERNELS_ALONE, [NARROW_LOBE], "narrow", quality="draft")
    first = work.render("Experiment 1, kernels on disk", "experiment1", "experiment1", since_python=True)
    yield first.at_most(30)
    contrast = work.render("+ contrast", "contrast", "contrast")
    share = contrast.cpu_s / first.cpu_s
    yield contrast.judged(f"10 % of Experiment 1; is {100 * share:.1f} %", share < 0.1)
    yield work.render("+ DOI", "doi", "doi").at_most(90)
    yield work.render("+ one α, one paint", [NEW_ALPHA], "alpha")
    yield work.render("+ one (ρd, ρs) of an old α", [NEW_REFLECTANCES], "reflectances").at_most(1)
    # All 28 are looked at, one is rendered.
    yield work.render("   the same, added to the 27", [*EXPERIMENT1, NEW_REFLECTANCES], "experiment1")
    many = work.render(f"+ {n_paints} paints of DOI's {len(DOI_ALPHAS)} α", many_paints(n_paints), "many")
    yield many
    if n_paints < MANY:
        times = MANY / n_paints
        step = f"   {MANY:,} such, extrapolated"
        yield replace(many, step=step, images=MANY, cpu_s=times * many.cpu_s, wall_s=times * many.wall_s)


def quick_run(work: Workplace) -> Iterator[Cost]:
    yield work.render("Experiment 1", "experiment1", "experiment1", since_python=True)
    yield work.render("+ contrast", "contrast", "contrast")
    yield work.render("+ one (ρd, ρs) of an old α", [NEW_REFLECTANCES], "reflectances")


def many_paints(count: int) -> list[Paint]:
    rng = np.random.default_rng(1)
    rho_d, rho_s = rng.uniform(0.03, 0.767, count), rng.uniform(0.017, 0.099, count)
    alphas = np.resize(DOI_ALPHAS, count)
    return [(round(d, 4), round(s, 4), float(alpha)) for d, s, alpha in zip(rho_d, rho_s, alphas, strict=True)]


def show(costs: Sequence[Cost], size: int, *, is_judged: bool) -> None:
    table = Table("", title=f"Cost of growing sets, {size} x {size} pixels")
    headings = "images", "CPU-s", "seconds", "CPU-s\nan image", "worst error,\nestimated", "peak memory\nso far, MB"
    for heading in headings:
        table.add_column(heading, justify="right")
    table.add_column("target: at most")
    table.add_column("reached")
    for cost in costs:
        table.add_row(
            cost.step, f"{cost.images}", f"{cost.cpu_s:.2f}", f"{cost.wall_s:.2f}", f"{cost.cpu_s / cost.images:.2f}",
            f"{max(cost.errors):.2f}", f"{cost.peak_bytes / MEGABYTE:.0f}", cost.target,
            verdict(cost.is_met) if is_judged else "",
        )  # fmt: skip
    console = Console(width=150, highlight=False)
    console.print(table)
    console.print("Errors are in code values on 99.9 % of the pixels, as each image estimates its own.")
    if not is_judged:
        target = f"{FULL_SIZE} x {FULL_SIZE} pixels of quality 'exact'"
        console.print(f"The targets are for {target}: none is judged here.")
        return
    worst = max(error for cost in costs if cost.step != KERNELS_ALONE for error in cost.errors)
    console.print(f"Half a code on 99.9 % of the pixels of every image: {verdict(worst <= 0.5)} (worst {worst:.2g}).")
    peak = max(cost.peak_bytes for cost in costs) / MEGABYTE
    console.print(f"Memory below 1 GB: {verdict(peak < 1000)} (peak of all of it {peak:.0f} MB).")


def verdict(is_met: bool | None) -> str:
    return "" if is_met is None else "met" if is_met else "missed"


if __name__ == "__main__":
    main()
