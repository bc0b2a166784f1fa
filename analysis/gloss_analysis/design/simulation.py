"""Simulated studies: judgements of observers drawn from a stated population."""

import itertools

import numpy as np

from gloss_analysis.design.population import Population
from gloss_analysis.judgements.dissimilarity import Dissimilarities
from glossspace.metric import contrast_gloss, distinctness

__all__ = ["EXPERIMENT_1", "EXPERIMENT_1_PAINTS", "drawn_ratios", "on_the_slider", "simulated_study", "wished_answers"]


EXPERIMENT_1_PAINTS = np.array(list(itertools.product((0.03, 0.193, 0.767), (0.033, 0.066, 0.099), (0.04, 0.07, 0.10))))
"""rho_d, rho_s, alpha of the 27 stimuli of the gloss paper's Experiment 1 (section 3.2.3.1), shape (27, 3)."""

EXPERIMENT_1 = np.column_stack(
    [contrast_gloss(EXPERIMENT_1_PAINTS[:, 0], EXPERIMENT_1_PAINTS[:, 1]), distinctness(EXPERIMENT_1_PAINTS[:, 2])]
)
"""Their c and d, shape (27, 2)."""


def drawn_ratios(population: Population, n_observers: int, rng: np.random.Generator) -> np.ndarray:
    """Ratios of simulated observers, shape (m,)."""
    return np.asarray(population.ratio * np.exp(population.sd_log_ratio * rng.standard_normal(n_observers)))


def wished_answers(
    coordinates: np.ndarray,
    ratios: np.ndarray,
    population: Population,
    *,
    n_repeats: int = 1,
    rng: np.random.Generator,
) -> np.ndarray:
    """Where simulated observers would put a slider that had no steps and no ends.

    Parameters
    ----------
    coordinates : ndarray, shape (n, 2)
        Of the stimuli on two axes.
    ratios : ndarray, shape (m,)
        The observers' own.
    population : Population
        Response and noise.
    n_repeats : int
        How often, r, they judge every pair.
    rng : Generator

    Returns
    -------
    ndarray, shape (r, m, n (n - 1) / 2)
        In hundredths of the slider. Observers know the range of the stimuli: the largest difference of all pairs,
        judged or not, is 100.
    """
    first, second = np.triu_indices(len(coordinates), 1)
    delta = coordinates[first] - coordinates[second]
    distance = np.hypot(delta[:, 0], ratios[:, np.newaxis] * delta[:, 1])
    relative = distance / distance.max(axis=1, keepdims=True)
    noise = rng.standard_normal((n_repeats, *relative.shape))
    return np.asarray(100 * relative**population.exponent + population.noise_sd * noise)


def on_the_slider(wished: np.ndarray, step: int) -> np.ndarray:
    """Answers on a slider from 0 to 100 that stops at multiples of `step`.

    Examples
    --------
    >>> on_the_slider(np.array([-3.0, 12.4, 104.0]), 5).tolist()
    [0.0, 10.0, 100.0]
    """
    return np.clip(step * np.round(wished / step), 0, 100)


def simulated_study(
    coordinates: np.ndarray,
    ratios: np.ndarray,
    population: Population,
    *,
    n_repeats: int = 1,
    kept: np.ndarray | None = None,
    rng: np.random.Generator,
) -> Dissimilarities:
    """Mean judgements of simulated observers.

    Parameters
    ----------
    coordinates, ratios, population, n_repeats, rng
        See `wished_answers`.
    kept : ndarray of bool, shape (n (n - 1) / 2,), optional
        The pairs that are judged; all by default. The same `rng` gives the same answers to a pair whatever the others.

    Returns
    -------
    Dissimilarities
        With stimuli and simulated observers named by number.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> population = Population()
    >>> simulated_study(EXPERIMENT_1, drawn_ratios(population, 9, rng), population, rng=rng).values.shape
    (9, 351)
    """
    wished = wished_answers(coordinates, ratios, population, n_repeats=n_repeats, rng=rng)
    values = on_the_slider(wished, population.slider_step).mean(axis=0)
    if kept is not None:
        values[:, ~kept] = np.nan
    return Dissimilarities(
        tuple(f"stimulus {i}" for i in range(len(coordinates))),
        tuple(f"simulated {k}" for k in range(len(ratios))),
        values,
    )
