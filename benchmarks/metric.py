"""Error and run time of contrast gloss c against the naive difference of eq. 4.

Run `python benchmarks/metric.py`. Error is the largest relative one against mpmath over paints of one rho_s/rho_d;
times are the best of several runs in one process, so that their ratios can be compared between machines.
"""

import timeit
from collections.abc import Callable

import mpmath
import numpy as np
from rich.console import Console
from rich.table import Table

from glossspace.metric import contrast_gloss
from glossspace.metric.validity import FloatArray

N_EXACT = 200
N_TIMED = 1_000_000
REPEATS = 7


def naive(rho_d: FloatArray, rho_s: FloatArray) -> FloatArray:
    """Eq. 4 as printed."""
    return np.cbrt(rho_s + rho_d / 2) - np.cbrt(rho_d / 2)


def stable_unchecked(rho_d: FloatArray, rho_s: FloatArray) -> FloatArray:
    """The formula of `contrast_gloss` alone: what its checks and its exact black cost is the difference."""
    surface, reflected = np.cbrt(rho_d / 2), np.cbrt(rho_s + rho_d / 2)
    return rho_s / (reflected**2 + reflected * surface + surface**2)


def largest_error(function: Callable[..., FloatArray], rho_d: FloatArray, rho_s: FloatArray) -> float:
    # 60 digits: the roots agree in at most 20, and 40 are left for the difference.
    with mpmath.workdps(60):
        worst = mpmath.mpf(0)
        for d, s, value in zip(rho_d, rho_s, function(rho_d, rho_s), strict=True):
            half = mpmath.mpf(float(d)) / 2
            exact = mpmath.cbrt(mpmath.mpf(float(s)) + half) - mpmath.cbrt(half)
            worst = max(worst, abs(mpmath.mpf(float(value)) / exact - 1))
        return float(worst)


def main() -> None:
    random = np.random.default_rng(1)
    console = Console()

    errors = Table("rho_s / rho_d", "naive", "glossspace", title="Largest relative error of c")
    for ratio in (1e1, 1e0, 1e-2, 1e-4, 1e-8, 1e-12, 1e-16, 1e-20):
        rho_d = random.uniform(0.01, 1, N_EXACT) / (1 + ratio)
        paints = rho_d, ratio * rho_d
        errors.add_row(f"{ratio:.0e}", *(f"{largest_error(f, *paints):.1e}" for f in (naive, contrast_gloss)))
    console.print(errors)

    rho_d = random.uniform(0, 0.9, N_TIMED)
    rho_s = random.uniform(0, 0.1, N_TIMED)
    functions = {"naive": naive, "stable, unchecked": stable_unchecked, "glossspace": contrast_gloss}
    seconds = {
        name: min(timeit.repeat(lambda f=function: f(rho_d, rho_s), number=1, repeat=REPEATS))
        for name, function in functions.items()
    }
    times = Table("", "ns per paint", "times naive", title=f"Run time, {N_TIMED:,} paints")
    for name, best in seconds.items():
        times.add_row(name, f"{best / N_TIMED * 1e9:.0f}", f"{best / seconds['naive']:.2f}")
    console.print(times)


if __name__ == "__main__":
    main()
