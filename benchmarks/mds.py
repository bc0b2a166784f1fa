"""Scaling: CPU time against the stress that is reached, beside majorization and scikit-learn, in one run.

    python benchmarks/mds.py

Three-way: 27 stimuli, 9 simulated participants, ordinal, two dimensions, the same random starts for both solvers.
Two-way: one participant, where scikit-learn's non-metric MDS does something comparable. Its own stress is defined
otherwise, so the Stress-1 of its configuration is computed by this package.
"""

import itertools
import time
from collections.abc import Callable

import numpy as np
from rich.console import Console
from rich.table import Table
from sklearn.manifold import MDS

from gloss_analysis.dissimilarity import Dissimilarities
from gloss_analysis.mds import scale
from gloss_analysis.objective import make_problem, source_distances, stress_of_sources
from gloss_analysis.smacof import smacof
from gloss_analysis.starts import random_start
from glossspace.metric import contrast_gloss, distinctness

N_STARTS = 10


def simulated_judgements(n_participants: int, seed: int = 0) -> Dissimilarities:
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
    names = tuple(f"stimulus {i}" for i in range(27))
    return Dissimilarities(names, tuple(f"simulated {k}" for k in range(n_participants)), np.array(rows))


def stress1(data: Dissimilarities, coordinates: np.ndarray, weights: np.ndarray) -> float:
    problem = make_problem(data, level="ordinal", ties="primary")
    return float(np.sqrt(np.mean(stress_of_sources(problem, source_distances(problem, coordinates, weights)) ** 2)))


def timed(function: Callable[[], float]) -> tuple[float, float]:
    """CPU seconds and the stress that the function returns."""
    start = time.process_time()
    stress = function()
    return time.process_time() - start, stress


def by_majorization(data: Dissimilarities, model: str, tolerance: float) -> float:
    rng = np.random.default_rng(1)
    runs = [
        smacof(data, start=random_start(27, 2, rng), model=model, tolerance=tolerance, max_steps=5000)
        for _ in range(N_STARTS)
    ]
    return min(run.stress1_by_step[-1] for run in runs)


def by_scikit_learn(data: Dissimilarities) -> float:
    square = np.zeros((27, 27))
    square[data.pairs] = data.values[0]
    peer = MDS(n_components=2, metric="precomputed", metric_mds=False, n_init=N_STARTS, init="random", max_iter=3000,
               eps=1e-9, random_state=0, normalized_stress="auto")  # fmt: skip
    return stress1(data, peer.fit(square + square.T).embedding_, np.ones((1, 2)))


def show(title: str, rows: dict[str, tuple[float, float]]) -> None:
    table = Table("solver", "CPU seconds", "Stress-1 reached", "CPU, times ours", "stress, times ours", title=title)
    seconds, stress = next(iter(rows.values()))
    for name, (own_seconds, own_stress) in rows.items():
        table.add_row(
            name,
            f"{own_seconds:.2f}",
            f"{own_stress:.5f}",
            f"{own_seconds / seconds:.1f}",
            f"{own_stress / stress:.4f}",
        )
    Console().print(table)


def main() -> None:
    scale(simulated_judgements(1), n_dims=2, n_starts=1)  # imports and first calls are not what is compared
    study, single = simulated_judgements(9), simulated_judgements(1)
    show(
        f"27 stimuli, 9 participants, weighted ordinal, {N_STARTS} starts",
        {
            "variable projection": timed(lambda: scale(study, n_dims=2, n_starts=N_STARTS).stress1),
            "majorization to 1e-6": timed(lambda: by_majorization(study, "weighted", 1e-6)),
            "majorization to 1e-8": timed(lambda: by_majorization(study, "weighted", 1e-8)),
        },
    )
    show(
        f"27 stimuli, one participant, ordinal, {N_STARTS} starts",
        {
            "variable projection": timed(lambda: scale(single, n_dims=2, model="identity", n_starts=N_STARTS).stress1),
            "majorization to 1e-9": timed(lambda: by_majorization(single, "identity", 1e-9)),
            "scikit-learn": timed(lambda: by_scikit_learn(single)),
        },
    )


if __name__ == "__main__":
    main()
