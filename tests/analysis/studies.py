"""Simulated judgements with a known answer, for the tests of the analysis."""

import itertools

import numpy as np
import pandas as pd

from gloss_analysis.judgements.dissimilarity import Dissimilarities
from glossspace.metric import contrast_gloss, distinctness

__all__ = ["CONTRAST", "DOI", "EXPERIMENT_1", "RATIOS_OF_SIX", "STIMULI", "axis_values", "judged_by", "named"]

EXPERIMENT_1 = pd.DataFrame(
    [
        (f"s{index}", *paint)
        for index, paint in enumerate(
            itertools.product((0.03, 0.193, 0.767), (0.033, 0.066, 0.099), (0.04, 0.07, 0.10))
        )
    ],
    columns=["stimulus", "rho_d", "rho_s", "alpha"],
)
"""The 27 stimuli of the gloss paper's Experiment 1 (section 3.2.3.1)."""

CONTRAST = pd.DataFrame(
    [
        (f"contrast{index}", rho_d, rho_s, 0.04)
        for index, (rho_d, rho_s) in enumerate(
            itertools.product((0.03, 0.087, 0.193, 0.420, 0.767), (0.017, 0.033, 0.050, 0.066, 0.083, 0.099))
        )
    ],
    columns=["stimulus", "rho_d", "rho_s", "alpha"],
)
"""The grid of the contrast study of Experiment 2 (section 3.3.3), all 30 of it."""

DOI = pd.DataFrame(
    [
        (f"doi{index}", 0.03, 0.099, alpha)
        for index, alpha in enumerate((0.01, 0.028, 0.046, 0.064, 0.082, 0.1, 0.118, 0.136, 0.154, 0.172, 0.19))
    ],
    columns=["stimulus", "rho_d", "rho_s", "alpha"],
)
"""Eleven equal steps of alpha over the range of the distinctness study of Experiment 2."""

STIMULI = EXPERIMENT_1["stimulus"].tolist()[:8]
"""Names of eight of them, for what need not be large."""

# Ratios of weights of six participants who differ.
RATIOS_OF_SIX = [0.8, 1.2, 1.8, 1.8, 2.5, 3.5]


def axis_values() -> np.ndarray:
    """c and d of Experiment 1's stimuli, shape (27, 2)."""
    return np.column_stack(
        [contrast_gloss(EXPERIMENT_1["rho_d"], EXPERIMENT_1["rho_s"]), distinctness(EXPERIMENT_1["alpha"])]
    )


def named(values: np.ndarray, n: int) -> Dissimilarities:
    """Wrap condensed triangles, shape (m, n (n - 1) / 2) or one of them, with made-up names."""
    values = np.atleast_2d(np.asarray(values, dtype=float))
    return Dissimilarities(tuple(f"s{i}" for i in range(n)), tuple(f"p{k}" for k in range(len(values))), values)


def judged_by(
    ratios: list[float], *, exponent: float = 1.0, noise_sd: float = 0.0, seed: int = 0, integers: bool = False
) -> Dissimilarities:
    """Differences of Experiment 1's stimuli, sqrt(dc^2 + (ratio dd)^2), one simulated participant a ratio."""
    rng = np.random.default_rng(seed)
    position = axis_values()
    first, second = np.triu_indices(len(position), 1)
    delta = position[first] - position[second]
    rows = []
    for ratio in ratios:
        distance = np.hypot(delta[:, 0], ratio * delta[:, 1])
        answer = 95 * (distance / distance.max()) ** exponent + noise_sd * rng.standard_normal(len(distance))
        rows.append(np.clip(np.round(answer), 0, 100) if integers else np.maximum(answer, 0))
    return named(np.array(rows), len(position))
