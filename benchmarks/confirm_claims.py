"""What the documentation claims of axis ratios, measured: shared ratios, intervals, compression, the test of INDSCAL.

    python benchmarks/confirm_claims.py [--studies N] [--jobs N] [--seed N] [--figure FILE]

Simulated studies of the gloss paper's size, as in `confirm.py`: 27 stimuli, all pairs judged once by nine simulated
observers with ratios log-normal about 1.78, a slider of whole numbers, noise of standard deviation 4. Unless it is what
varies, the standard deviation of the logarithm of the ratios is 0.15 and the slider's exponent .85.
"""

import argparse
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from joblib import Parallel, delayed
from rich.console import Console
from rich.progress import Progress
from rich.table import Table
from scipy.stats import binomtest

from gloss_analysis.confirmatory.indscal import confirm_indscal
from gloss_analysis.confirmatory.scaling import ConfirmatoryFit, confirm_axes, population_interval
from gloss_analysis.design.population import Population
from gloss_analysis.design.simulation import EXPERIMENT_1, drawn_ratios, simulated_study
from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds.disparities import Level
from glossspace.console import progress_bar

OBSERVERS = 9
TRUTH = Population().ratio
AXES = ("c", "d")
SPREADS = (0.0, 0.15, 0.3, 0.5)
EXPONENTS = (1.0, 0.85, 0.7, 0.55, 0.4)
LEVELS: tuple[Level, ...] = ("ratio", "interval", "spline", "ordinal")
RESAMPLES = 2000
# p is 1/40 at best; .05 is two of them.
PERMUTATIONS = 39
KINDS = ("t", "studentised", "percentile")

_Result = TypeVar("_Result")

# Number of observers, and where the stimuli lie. On a grid many pairs are equally far apart.
_GRID = np.array([(c, d) for c in (0.0, 0.3, 1.0) for d in (0.0, 0.2, 0.5, 0.56)])
DESIGNS: dict[str, Callable[[np.random.Generator], tuple[int, np.ndarray]]] = {
    "Experiment 1": lambda rng: (OBSERVERS, EXPERIMENT_1),
    "12 at random": lambda rng: (5, rng.uniform(size=(12, 2))),
    "12 on a grid": lambda rng: (5, _GRID),
}


def study(seed: np.random.SeedSequence, population: Population) -> Dissimilarities:
    rng = np.random.default_rng(seed)
    return simulated_study(EXPERIMENT_1, drawn_ratios(population, OBSERVERS, rng), population, rng=rng)


def fitted(seed: np.random.SeedSequence, population: Population, level: Level) -> ConfirmatoryFit:
    return confirm_axes(study(seed, population), EXPERIMENT_1, axes=AXES, level=level)


def percentile_interval(logs: np.ndarray, seed: int) -> tuple[float, float]:
    """95 % interval of the geometric mean by the percentile bootstrap, which the program does not offer."""
    drawn = logs[np.random.default_rng(seed).integers(len(logs), size=(RESAMPLES, len(logs)))]
    low, high = np.exp(np.quantile(drawn.mean(axis=1), [0.025, 0.975]))
    return float(low), float(high)


def held(logs: np.ndarray, truth: float, seed: int) -> list[bool]:
    """Which intervals of these logarithms hold the truth, in the order of `KINDS`."""
    intervals = (
        population_interval(logs),
        population_interval(logs, interval="bootstrap", seed=seed),
        percentile_interval(logs, seed),
    )
    return [one is not None and one[0] <= truth <= one[1] for one in intervals]


def spread_out(seed: np.random.SeedSequence, sd: float) -> tuple[float, float, list[bool]]:
    """Logarithms of shared and population ratio over the truth, and which intervals hold it."""
    fit = fitted(seed, Population(sd_log_ratio=sd), "ordinal")
    logs = np.log([one.ratio for one in fit.individual])
    number = int(seed.generate_state(1)[0])
    return np.log(fit.shared.ratio / TRUTH), np.log(fit.population_ratio / TRUTH), held(logs, TRUTH, number)


def ideal(seed: np.random.SeedSequence) -> list[bool]:
    """Which intervals hold the mean of nine normal logarithms known without error."""
    logs = np.random.default_rng(seed).standard_normal(OBSERVERS)
    return held(logs, 1.0, int(seed.generate_state(1)[0]))


def compressed(seed: np.random.SeedSequence, exponent: float) -> list[float]:
    """Logarithm of the population's ratio over the truth, at each level, of one and the same study."""
    population = Population(exponent=exponent)
    return [float(np.log(fitted(seed, population, level).population_ratio / TRUTH)) for level in LEVELS]


def told_apart(seed: np.random.SeedSequence, design: str, population: Population) -> bool:
    """Whether the permutation test of own weights says that observers differ."""
    rng = np.random.default_rng(seed)
    n_observers, places = DESIGNS[design](rng)
    ratios = drawn_ratios(population, n_observers, rng)
    data = simulated_study(places, ratios, population, rng=rng)
    number = int(seed.generate_state(1)[0])
    found = confirm_indscal(data, places, axes=AXES, n_permutations=PERMUTATIONS, seed=number)
    return found.p_value is not None and found.p_value <= 0.05


def over_studies(
    one: Callable[..., _Result], case: tuple[Any, ...], n: int, seed: int, jobs: int, progress: Progress, what: str
) -> list[_Result]:
    task = progress.add_task(what, total=n)
    seeds = np.random.SeedSequence(seed).spawn(n)  # the same studies in every case, but for what varies
    results = []
    for result in Parallel(n_jobs=jobs, return_as="generator")(delayed(one)(child, *case) for child in seeds):
        results.append(result)
        progress.advance(task)
    return results


def bias(logs: np.ndarray) -> str:
    error = logs.std(ddof=1) / np.sqrt(len(logs)) if len(logs) > 1 else np.nan
    return f"{100 * np.expm1(logs.mean()):+.1f} ± {100 * np.exp(logs.mean()) * error:.1f}"


def share(of: np.ndarray) -> str:
    low, high = binomtest(int(of.sum()), len(of)).proportion_ci(method="wilson")
    return f"{100 * of.mean():.1f} [{100 * low:.1f}, {100 * high:.1f}]"


def draw(biases: dict[float, np.ndarray], path: Path) -> None:
    """Bias over the exponent, one line a level."""
    from gloss_analysis.figures.style import new_figure, tidy
    from glossspace.files import whole_file

    figure = new_figure(5.0, 3.6)
    axes = figure.add_subplot()
    for k, (level, marker) in enumerate(zip(LEVELS, "osDv", strict=True)):
        axes.plot(EXPONENTS, [100 * np.expm1(biases[e][:, k].mean()) for e in EXPONENTS], marker=marker, label=level)
    axes.axhline(0, color="black", lw=0.8)
    axes.set(xlabel="exponent of the slider (1: no compression)", ylabel="bias of the weight of d, %")
    axes.set_title("simulated observers", fontsize=9)
    axes.invert_xaxis()
    axes.legend(frameon=False, fontsize=8)
    tidy(axes)
    with whole_file(path) as temporary:
        figure.savefig(temporary, dpi=170)


def intervals(given: argparse.Namespace, progress: Progress) -> Table:
    """Shared and population ratio, and coverage of three intervals; that of ideal samples too, which cost little."""
    n, run = given.studies, (given.seed, given.jobs, progress)
    columns = ("sd of log ratio", "bias of shared, %", "bias of population, %", *(f"{k}, %" for k in KINDS))
    table = Table(*columns, title=f"{n} simulated studies, ordinal: bias, and coverage of 95 % intervals")
    for sd in SPREADS:
        found = over_studies(spread_out, (sd,), n, *run, f"Spread {sd:g}")
        shared, population = (np.array([one[k] for one in found]) for k in (0, 1))
        covered = np.array([one[2] for one in found]).T
        table.add_row(f"{sd:g}", bias(shared), bias(population), *(share(one) for one in covered))
    samples = np.array(over_studies(ideal, (), 20 * n, *run, "Ideal samples"))
    table.add_row(f"{20 * n} samples alone", "", "", *(share(one) for one in samples.T))
    return table


def compression(given: argparse.Namespace, progress: Progress) -> Table:
    """Bias over the exponent of the slider, at each level."""
    n, run = given.studies // 4, (given.seed, given.jobs, progress)
    biases = {e: np.array(over_studies(compressed, (e,), n, *run, f"Exponent {e:g}")) for e in EXPONENTS}
    if given.figure is not None:
        draw(biases, given.figure)
    table = Table("exponent", *(f"{level}, %" for level in LEVELS), title=f"Bias over compression, {n} studies")
    for exponent, logs in biases.items():
        table.add_row(f"{exponent:g}", *(bias(one) for one in logs.T))
    return table


def indscal(given: argparse.Namespace, progress: Progress) -> Table:
    """How often the test of own weights says that observers differ, where they do not and where they do."""
    n, run = given.studies, (given.seed, given.jobs, progress)
    table = Table("design", "noise", "sd of log ratio", "studies", "said to differ, %", title="Test of own weights")
    cases = [("Experiment 1", 4.0, sd, n // 4) for sd in SPREADS[:2]]
    cases += [(design, noise, 0.0, n) for design in ("12 at random", "12 on a grid") for noise in (5.0, 15.0)]
    for design, noise, sd, count in cases:
        population = Population(sd_log_ratio=sd, noise_sd=noise)
        found = over_studies(told_apart, (design, population), count, *run, f"{design}, {noise:g}, {sd:g}")
        table.add_row(design, f"{noise:g}", f"{sd:g}", f"{count}", share(np.array(found)))
    return table


def main() -> None:
    parser = argparse.ArgumentParser(description="Claims about axis ratios, over simulated studies.")
    parser.add_argument("--studies", type=int, default=1000)
    parser.add_argument("--jobs", type=int, default=1, help="processes, -1 for one a core")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--figure", type=Path, help="a file for a picture of bias over compression")
    given = parser.parse_args()
    if given.studies < 4:
        parser.error("--studies must be 4 or more.")
    start = time.perf_counter()
    console = Console(width=130)
    for part in (intervals, compression, indscal):
        with progress_bar() as progress:
            table = part(given, progress)
        console.print(table)
    print("Bias is that of the mean logarithm, ± its standard error; brackets are Wilson intervals.")
    print(f"{time.perf_counter() - start:.0f} s in all.")


if __name__ == "__main__":
    main()
