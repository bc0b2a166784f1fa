"""Axis weights: bias of the population's ratio and coverage of its 95 % intervals, over simulated studies.

    python benchmarks/confirm.py [--studies N] [--jobs N] [--seed N]

Every study is of the gloss paper's size: the 27 stimuli of Experiment 1, all pairs judged once by nine simulated
observers, whose ratios are log-normal about the paper's 1.78 (standard deviation of the logarithm 0.15). An answer is
100 x**0.85 for a pair at x of the largest distance, with noise of standard deviation 4, on a slider from 0 to 100 that
stops at whole numbers, or at multiples of 5 or 20. All six analyses of a study are of the same answers before rounding.
"""

import argparse
import itertools
import time

import numpy as np
from joblib import Parallel, delayed
from rich.console import Console
from rich.table import Table
from scipy.stats import binomtest

from gloss_analysis.confirmatory.scaling import INTERVALS, confirm_axes, population_interval
from gloss_analysis.design.population import Population
from gloss_analysis.design.simulation import EXPERIMENT_1, drawn_ratios, on_the_slider, wished_answers
from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds.disparities import Level
from gloss_experiments.observers.observer_kinds import MEDIAN_RATIO, SD_LOG_RATIO
from glossspace.console import progress_bar

OBSERVERS = 9
POPULATION = Population(ratio=MEDIAN_RATIO, sd_log_ratio=SD_LOG_RATIO, exponent=0.85, noise_sd=4.0)
LEVELS: tuple[Level, ...] = ("ordinal", "ratio")
STEPS = (1, 5, 20)
CASES = tuple(itertools.product(LEVELS, STEPS))

Outcome = tuple[float, tuple[bool, ...], float]
"""Logarithm of the ratio over the truth, which intervals hold the truth, CPU seconds of the analysis."""


def one_study(seed: np.random.SeedSequence) -> list[Outcome]:
    """Outcome of each of the cases."""
    position = EXPERIMENT_1
    rng = np.random.default_rng(seed)
    wished = wished_answers(position, drawn_ratios(POPULATION, OBSERVERS, rng), POPULATION, rng=rng)[0]
    outcomes = []
    for level, step in CASES:
        data = Dissimilarities(
            tuple(f"stimulus {i}" for i in range(len(position))),
            tuple(f"simulated {k}" for k in range(OBSERVERS)),
            on_the_slider(wished, step),
        )
        start = time.process_time()
        fit = confirm_axes(data, position, axes=("c", "d"), level=level)
        seconds = time.process_time() - start
        logs = np.log([one.ratio for one in fit.individual])
        held = []
        for kind in INTERVALS:
            interval = population_interval(logs, interval=kind, seed=int(seed.generate_state(1)[0]))
            held.append(interval is not None and interval[0] <= MEDIAN_RATIO <= interval[1])
        outcomes.append((float(np.log(fit.population_ratio / MEDIAN_RATIO)), tuple(held), seconds))
    return outcomes


def show(studies: list[list[Outcome]]) -> None:
    n = len(studies)
    columns = ("level", "slider step", "bias, %", "coverage, t, %", "coverage, bootstrap, %", "CPU ms a study")
    table = Table(*columns, title=f"{n} simulated studies: {OBSERVERS} observers, 27 stimuli")
    for (level, step), column in zip(CASES, zip(*studies, strict=True), strict=True):
        logs = np.array([one[0] for one in column])
        error = logs.std(ddof=1) / np.sqrt(n) if n > 1 else np.nan
        covered = np.sum([one[1] for one in column], axis=0)
        table.add_row(
            level, str(step), f"{100 * np.expm1(logs.mean()):+.2f} ± {100 * np.exp(logs.mean()) * error:.2f}",
            *(_share(int(k), n) for k in covered), f"{1000 * np.mean([one[2] for one in column]):.0f}",
        )  # fmt: skip
    Console(width=120).print(table)
    print("Bias is that of the mean logarithm, ± its standard error; brackets are Wilson intervals.")


def _share(k: int, n: int) -> str:
    low, high = binomtest(k, n).proportion_ci(method="wilson")
    return f"{100 * k / n:.1f} [{100 * low:.1f}, {100 * high:.1f}]"


def main() -> None:
    parser = argparse.ArgumentParser(description="Bias and coverage of the population's axis ratio.")
    parser.add_argument("--studies", type=int, default=2000)
    parser.add_argument("--jobs", type=int, default=1, help="processes, -1 for one a core")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    if given.studies < 1:
        parser.error("--studies must be 1 or more.")
    start = time.perf_counter()
    seeds = np.random.SeedSequence(given.seed).spawn(given.studies)
    studies: list[list[Outcome]] = []
    with progress_bar() as progress:
        task = progress.add_task("Studies", total=given.studies)
        for outcome in Parallel(n_jobs=given.jobs, return_as="generator")(map(delayed(one_study), seeds)):
            studies.append(outcome)
            progress.advance(task)
    show(studies)
    spent = sum(one[2] for study in studies for one in study)
    print(f"{spent:.0f} CPU-s of analysis, {time.perf_counter() - start:.0f} s in all.")


if __name__ == "__main__":
    main()
