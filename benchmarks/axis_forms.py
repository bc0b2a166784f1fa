"""Axis functions with free numbers: how often they are taken, and what their intervals cover, over simulated studies.

    python benchmarks/axis_forms.py [--studies N] [--jobs N] [--seed N]

Every study has nine simulated observers who rate the gloss paper's contrast study (30 paints) and distinctness study
(11 roughnesses) three times. A rating is a line of the true form of the axis, with a slope and an intercept of the
observer's own and noise of standard deviation 6 on a scale of 100. What one would fit instead is a cubic polynomial, of
log rho_s / (rho_d + .05) for c and of alpha for d.
"""

import argparse
import itertools
import time

import numpy as np
import pandas as pd
from joblib import Parallel, delayed
from rich.console import Console
from rich.table import Table
from scipy.stats import binomtest

from gloss_analysis.axis_functions.axis_forms import choose_form
from gloss_analysis.ratings.magnitude import mean_ratings
from gloss_analysis.ratings.polynomials import fit_polynomials
from glossspace.console import progress_bar
from glossspace.metric import ContrastForm, DistinctnessForm

OBSERVERS, REPEATS, NOISE_SD = 9, 3, 6.0
CONTRAST = pd.DataFrame(
    itertools.product((0.03, 0.087, 0.193, 0.420, 0.767), (0.017, 0.033, 0.050, 0.066, 0.083, 0.099), (0.04,)),
    columns=["rho_d", "rho_s", "alpha"],
).assign(stimulus=[f"contrast {k}" for k in range(30)])
DOI = pd.DataFrame(
    itertools.product((0.03,), (0.099,), np.linspace(0.01, 0.19, 11)), columns=["rho_d", "rho_s", "alpha"]
).assign(stimulus=[f"doi {k}" for k in range(11)])
CASES = (
    ("c", CONTRAST, ContrastForm()),
    ("c", CONTRAST, ContrastForm(exponent=0.6)),
    ("c", CONTRAST, ContrastForm(exponent=0.5, diffuse_share=0.1)),
    ("d", DOI, DistinctnessForm()),
    ("d", DOI, DistinctnessForm(exponent=0.5)),
)

Outcome = tuple[str, bool, float, float, float]
"""Free numbers taken, whether the exponent's interval holds the truth, its error, error of cubic over ours, CPU s."""


def ratings(stimuli: pd.DataFrame, form: ContrastForm | DistinctnessForm, rng: np.random.Generator) -> pd.DataFrame:
    columns = ("rho_d", "rho_s") if isinstance(form, ContrastForm) else ("alpha",)
    values = form.value(*(stimuli[column] for column in columns))
    unit = (values - values.min()) / np.ptp(values)
    rows = []
    for observer in range(OBSERVERS):
        slope, intercept = rng.uniform(60, 85), rng.uniform(3, 12)
        for repeat in range(REPEATS):
            rating = intercept + slope * unit + NOISE_SD * rng.standard_normal(len(unit))
            names = {"participant_id": f"simulated {observer}", "repeat": repeat, "stimulus": stimuli["stimulus"]}
            rows.append(pd.DataFrame(names | {"rating": rating}))
    return pd.concat(rows)


def one_study(seed: np.random.SeedSequence) -> list[Outcome]:
    """Outcome of each of the cases."""
    rng = np.random.default_rng(seed)
    outcomes = []
    for axis, stimuli, true in CASES:
        table = ratings(stimuli, true, rng)
        start = time.process_time()
        choice = choose_form(axis, stimuli, table)
        seconds = time.process_time() - start
        # The simplest candidate that contains the truth.
        free = tuple(name for name, value in vars(true).items() if value != vars(type(true)())[name]) or ("exponent",)
        right = next(one for one in choice.candidates if one.free == free)
        interval = right.ci95.get("exponent", (np.nan, np.nan))
        means = mean_ratings(table).merge(stimuli, on="stimulus")
        physical = np.log(means["rho_s"] / (means["rho_d"] + 0.05)) if axis == "c" else means["alpha"]
        cubic = fit_polynomials(physical, means["rating"], orders=(3,))[0]
        outcomes.append(
            (
                ", ".join(choice.chosen.free) or "paper's form",
                bool(interval[0] <= true.exponent <= interval[1]),
                float(np.log(right.form.exponent / true.exponent)),
                cubic.leave_one_out_error / choice.chosen.leave_one_out_error,
                seconds,
            )
        )
    return outcomes


def show(studies: list[list[Outcome]]) -> None:
    n = len(studies)
    columns = ("true form", "taken, %", "exponent covered, %", "its bias, %", "cubic's error / ours", "CPU ms")
    table = Table(*columns, title=f"{n} simulated studies: {OBSERVERS} observers, {REPEATS} repeats")
    for (axis, _, true), column in zip(CASES, zip(*studies, strict=True), strict=True):
        taken = pd.Series([one[0] for one in column]).value_counts()
        logs = np.array([one[2] for one in column])
        low, high = binomtest(sum(one[1] for one in column), n).proportion_ci(method="wilson")
        table.add_row(
            f"{axis} = {true.text}", "; ".join(f"{100 * count / n:.0f} {name}" for name, count in taken.items()),
            f"{100 * np.mean([one[1] for one in column]):.1f} [{100 * low:.1f}, {100 * high:.1f}]",
            f"{100 * np.expm1(logs.mean()):+.1f}", f"{np.median([one[3] for one in column]):.2f}",
            f"{1000 * np.mean([one[4] for one in column]):.0f}",
        )  # fmt: skip
    Console(width=150).print(table)
    print("Covered: by the 95 % interval of the simplest candidate that contains the truth; brackets are Wilson's.")


def main() -> None:
    parser = argparse.ArgumentParser(description="Choice of axis functions over simulated studies.")
    parser.add_argument("--studies", type=int, default=60)
    parser.add_argument("--jobs", type=int, default=1, help="processes, -1 for one a core")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    if given.studies < 2:
        parser.error("--studies must be 2 or more.")
    seeds = np.random.SeedSequence(given.seed).spawn(given.studies)
    studies: list[list[Outcome]] = []
    with progress_bar() as progress:
        task = progress.add_task("Studies", total=given.studies)
        for outcome in Parallel(n_jobs=given.jobs, return_as="generator")(map(delayed(one_study), seeds)):
            studies.append(outcome)
            progress.advance(task)
    show(studies)


if __name__ == "__main__":
    main()
