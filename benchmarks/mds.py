"""Scaling: CPU time against the stress that is reached, beside majorization, scikit-learn and R's smacof, in one run.

    python benchmarks/mds.py [--quick]

Stress is always Stress-1 of the configuration that a solver returns, computed by this package, since each peer defines
its own. scikit-learn knows neither several participants nor ties; R's smacof is asked where Rscript and the package are
installed. Compilation is charged apart, in a fresh process with an empty cache.
"""

import itertools
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table
from scipy.spatial.distance import pdist, squareform
from sklearn.manifold import MDS

from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds import scale
from gloss_analysis.mds.objective import mean_square_stress
from gloss_analysis.mds.problem import make_problem
from gloss_analysis.mds.smacof import smacof
from gloss_analysis.mds.starts import random_start, torgerson_configuration
from gloss_analysis.uncertainty.bootstrap import bootstrap
from glossspace.metric import contrast_gloss, distinctness

QUICK = "--quick" in sys.argv
R_SCRIPT = Path(__file__).with_name("smacof.R")

Row = tuple[float, float]  # CPU seconds, Stress-1


def study(n_participants: int = 9, seed: int = 0) -> Dissimilarities:
    """Experiment 1 of the gloss paper, judged by simulated participants on an integer slider."""
    paints = np.array(list(itertools.product((0.03, 0.193, 0.767), (0.033, 0.066, 0.099), (0.04, 0.07, 0.10))))
    c, d = contrast_gloss(paints[:, 0], paints[:, 1]), distinctness(paints[:, 2])
    first, second = np.triu_indices(27, 1)
    rng = np.random.default_rng(seed)
    rows = []
    for _ in range(n_participants):
        distance = np.hypot(c[first] - c[second], 1.78 * np.exp(0.15 * rng.standard_normal()) * (d[first] - d[second]))
        answer = 95 * (distance / distance.max()) ** 0.85 + 4 * rng.standard_normal(len(distance))
        rows.append(np.clip(np.round(answer), 0, 100))
    return _named(np.array(rows), 27)


def noisy_space(n: int, m: int, seed: int = 0) -> Dissimilarities:
    """Random points in three dimensions, weighted by each simulated participant, distances with 20 % of noise."""
    rng = np.random.default_rng(seed)
    points = rng.standard_normal((n, 3))
    rows = []
    for _ in range(m):
        distance = pdist(points * rng.uniform(0.5, 1.5, 3))
        rows.append(distance * np.exp(0.2 * rng.standard_normal(len(distance))))
    return _named(np.array(rows), n)


def _named(values: np.ndarray, n: int) -> Dissimilarities:
    return Dissimilarities(
        tuple(f"stimulus {i}" for i in range(n)), tuple(f"simulated {k}" for k in range(len(values))), values
    )


def stress1(data: Dissimilarities, coordinates: np.ndarray, weights: np.ndarray | None = None) -> float:
    weights = np.ones((len(data.participants), coordinates.shape[1])) if weights is None else weights
    return float(np.sqrt(mean_square_stress(make_problem(data), coordinates, weights)))


def timed(function: Callable[[], float]) -> Row:
    """CPU seconds of the process, and the stress that the function returns."""
    start = time.process_time()
    stress = function()
    return time.process_time() - start, stress


def by_majorization(data: Dissimilarities, starts: list[np.ndarray], model: str, tolerance: float) -> float:
    runs = [smacof(data, start=one, model=model, tolerance=tolerance, max_steps=5000) for one in starts]
    return min(run.stress1_by_step[-1] for run in runs)


def by_scikit_learn(data: Dissimilarities, n_starts: int, eps: float) -> float:
    peer = MDS(n_components=2, metric="precomputed", metric_mds=False, n_init=n_starts, init="random", max_iter=3000,
               eps=eps, random_state=0, normalized_stress="auto", n_jobs=1)  # fmt: skip
    return stress1(data, peer.fit(squareform(data.values[0])).embedding_)


def by_r(data: Dissimilarities, n_starts: int) -> Row | None:
    """R's smacof from random starts: the CPU seconds that it reports itself, without starting R; None without it."""
    with tempfile.TemporaryDirectory() as folder:
        np.savetxt(Path(folder) / "data.csv", data.values, delimiter=",")
        command = ["Rscript", str(R_SCRIPT), folder, str(n_starts)]
        try:
            done = subprocess.run(command, capture_output=True, text=True, check=False)
        except FileNotFoundError:
            return None
        if done.returncode:
            return None
        coordinates = np.loadtxt(Path(folder) / "space.csv", delimiter=",", ndmin=2)
        weights = np.loadtxt(Path(folder) / "weights.csv", delimiter=",", ndmin=2)
        return float(done.stdout), stress1(data, coordinates, weights)


def show(title: str, rows: dict[str, Row | None]) -> None:
    table = Table("solver", "CPU seconds", "Stress-1 reached", "CPU, times ours", "stress, times ours", title=title)
    seconds, stress = next(row for row in rows.values() if row is not None)
    for name, row in rows.items():
        if row is None:
            table.add_row(name, "not installed", "", "", "")
            continue
        table.add_row(name, f"{row[0]:.3f}", f"{row[1]:.6f}", f"{row[0] / seconds:.1f}", f"{row[1] / stress:.5f}")
    Console(width=120).print(table)


def three_way() -> None:
    data = study()
    n = 10 if QUICK else 100
    rng = np.random.default_rng(1)
    starts = [random_start(27, 2, rng) for _ in range(n)]
    show(
        f"27 stimuli, 9 participants, weighted, ordinal, primary ties, two dimensions, {n} starts",
        {
            "variable projection": timed(lambda: scale(data, n_dims=2, n_starts=n).stress1),
            "majorization to 1e-6, R's default": timed(lambda: by_majorization(data, starts, "weighted", 1e-6)),
            "majorization to 1e-8": timed(lambda: by_majorization(data, starts[: n // 10], "weighted", 1e-8)),
            "R smacof": by_r(data, n),
        },
    )
    print(f"The third row is of {n // 10} starts.")


def large() -> None:
    n, m = (40, 5) if QUICK else (100, 20)
    data = noisy_space(n, m)
    start = [torgerson_configuration(data, 2)]
    show(
        f"{n} stimuli, {m} participants, weighted, ordinal, one start",
        {
            "variable projection": timed(lambda: scale(data, n_dims=2, n_starts=1).stress1),
            "majorization to 1e-6, R's default": timed(lambda: by_majorization(data, start, "weighted", 1e-6)),
            "R smacof": by_r(data, 1),
        },
    )
    n = 100 if QUICK else 500
    single = noisy_space(n, 1)
    start = [torgerson_configuration(single, 2)]
    show(
        f"{n} stimuli, one participant, ordinal, one start",
        {
            "variable projection": timed(lambda: scale(single, n_dims=2, n_starts=1).stress1),
            "majorization to 1e-6": timed(lambda: by_majorization(single, start, "identity", 1e-6)),
            "scikit-learn, eps 1e-6": timed(lambda: by_scikit_learn(single, 1, 1e-6)),
            "R smacof": by_r(single, 1),
        },
    )


def two_way() -> None:
    data = study(1)
    rng = np.random.default_rng(1)
    starts = [random_start(27, 2, rng) for _ in range(10)]
    rows: dict[str, Row | None] = {}
    for n in (100, 10, 1):
        rows[f"variable projection, {n} starts"] = timed(lambda n=n: scale(data, n_dims=2, n_starts=n).stress1)
    rows["majorization to 1e-9, 10 starts"] = timed(lambda: by_majorization(data, starts, "identity", 1e-9))
    for eps in (1e-3, 1e-6, 1e-9):
        rows[f"scikit-learn, eps {eps:g}, 10 starts"] = timed(lambda eps=eps: by_scikit_learn(data, 10, eps))
    rows["R smacof, 10 starts"] = by_r(data, 10)
    show("27 stimuli, one participant, ordinal: run time against stress", rows)


def huge() -> None:
    n = 300 if QUICK else 2000
    data = noisy_space(n, 1)
    seconds, stress = timed(lambda: scale(data, n_dims=2, n_starts=1).stress1)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"{n} stimuli, one participant, one start: {seconds:.1f} CPU-s, Stress-1 {stress:.5f}, "
          f"peak memory of this process {peak:.0f} MB.")  # fmt: skip


def resampling() -> None:
    data = study()
    solution = scale(data, n_dims=2)
    n = 50 if QUICK else 1000
    start, wall = time.process_time(), time.perf_counter()
    bootstrap(data, solution, n_replicates=n, seed=1, n_jobs=os.cpu_count() or 1)
    print(f"{n} bootstrap replicates of the study: {time.process_time() - start:.1f} CPU-s, "
          f"{time.perf_counter() - wall:.1f} s.")  # fmt: skip


def first_call() -> None:
    """Import and first call in fresh processes, with the kernels compiled before and with none."""
    code = (
        "import time; t = time.perf_counter(); from gloss_analysis.mds import scale; "
        "from gloss_analysis.judgements.square_matrix import from_matrices; u = time.perf_counter(); "
        "scale(from_matrices([[0, 1, 2, 3], [1, 0, 4, 5], [2, 4, 0, 6], [3, 5, 6, 0]]), n_dims=2); "
        "print(u - t, time.perf_counter() - u)"
    )
    with tempfile.TemporaryDirectory() as folder:
        for name in ("nothing compiled", "kernels on disk"):
            environment = os.environ | {"NUMBA_CACHE_DIR": folder}
            done = subprocess.run(
                [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
            )
            imported, called = map(float, done.stdout.split())
            print(f"{name}: import {imported:.2f} s, first call {called:.2f} s")


def main() -> None:
    scale(study(1), n_dims=2, n_starts=1)  # imports and first calls are not what is compared
    scale(study(2), n_dims=2, n_starts=10)
    three_way()
    two_way()
    large()
    resampling()
    huge()
    first_call()


if __name__ == "__main__":
    main()
