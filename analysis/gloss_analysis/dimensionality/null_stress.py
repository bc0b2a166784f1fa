"""Stress of judgements without structure, in the design of a study: what stress says nothing above."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from gloss_analysis.dimensionality.quick_scaling import possible_dims, quick_curve
from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds import Level, Model, Ties
from gloss_analysis.replicates import OnStep, in_parallel, no_step, whole_number
from glossspace.errors import GlossError

__all__ = ["NULL_STARTS", "permuted_stress", "random_stress"]

NULL_STARTS = 3
"""Starts of each fit to judgements without structure."""


def random_stress(
    data: Dissimilarities,
    *,
    dims: Iterable[int] = range(1, 6),
    model: Model = "weighted",
    level: Level = "ordinal",
    ties: Ties = "primary",
    conditional: bool = True,
    n_replicates: int = 20,
    n_starts: int = NULL_STARTS,
    seed: int = 1,
    n_jobs: int = 1,
    on_step: OnStep = no_step,
) -> np.ndarray:
    """Stress-1 of random rankings in the design of `data`: its stimuli, participants, gaps and weights, no ties.

    Parameters
    ----------
    data : Dissimilarities
        Only the design counts.
    dims, model, level, ties, conditional
        See `gloss_analysis.dimensionality.stress_curve.stress_curve`.
    n_replicates : int
        Independent draws.
    n_starts : int
        Starts of each fit; in one dimension always 40, without the search over orders of `scale`. Few raise the stress
        a little, by about .001 for nine participants and 27 stimuli and more in one dimension. Only stress found in the
        same way (`quick_curve`) can be tested against it.
    seed : int
        Fixes draws and starts; the result does not depend on `n_jobs`.
    n_jobs : int
        Threads (joblib), -1 for one a core.
    on_step : callable
        Called with the number of replicates done and of all, to show progress.

    Returns
    -------
    ndarray, shape (n_replicates, n_dimensionalities)
        In the order of the dimensions.

    Raises
    ------
    GlossError
        No replicates, or data or a parameter that `scale` refuses.

    Notes
    -----
    Klahr (1969), Stenson and Knoll (1969) and Spence and Ogilvie (1973) tabulated it for one participant.

    Examples
    --------
    >>> design = Dissimilarities(tuple("abcdefgh"), ("1",), np.arange(28.0)[np.newaxis])
    >>> stress = random_stress(design, dims=(1, 2), model="identity", n_replicates=5)
    >>> stress.shape, bool((stress[:, 1] < stress[:, 0]).all())
    ((5, 2), True)
    """

    def drawn(rng: np.random.Generator) -> Dissimilarities:
        values = np.full(data.values.shape, np.nan)
        for row, judged in zip(values, data.judged, strict=True):
            row[judged] = rng.permutation(np.count_nonzero(judged)) + 1.0
        return replace(data, values=values, trials=None)

    wanted = possible_dims(data, tuple(dims))
    return _null_curves(
        drawn, wanted, model, level, ties, conditional, n_replicates, n_starts, seed, n_jobs, on_step
    )  # fmt: skip


def permuted_stress(
    data: Dissimilarities,
    *,
    dims: Iterable[int] = range(1, 6),
    model: Model = "weighted",
    level: Level = "ordinal",
    ties: Ties = "primary",
    conditional: bool = True,
    n_replicates: int = 20,
    n_starts: int = NULL_STARTS,
    seed: int = 1,
    n_jobs: int = 1,
    on_step: OnStep = no_step,
) -> np.ndarray:
    """Stress-1 after each participant's judgements have been dealt out anew among the pairs that he judged.

    The same values and ties without any structure: what the stress of the data must be below to mean anything.
    Parameters, result and errors are those of `random_stress`; a judgement takes its weight along.

    Examples
    --------
    >>> line = np.abs(np.subtract.outer(np.arange(8.0), np.arange(8.0)))[np.triu_indices(8, 1)]
    >>> data = Dissimilarities(tuple("abcdefgh"), ("1",), line[np.newaxis])
    >>> bool((permuted_stress(data, dims=(1,), model="identity", n_replicates=5) > 0.05).all())
    True
    """

    def drawn(rng: np.random.Generator) -> Dissimilarities:
        values, weights = data.values.copy(), data.weights.copy()
        for k, judged in enumerate(data.judged):
            places = np.flatnonzero(judged)
            taken = rng.permutation(places)
            values[k, places], weights[k, places] = data.values[k, taken], data.weights[k, taken]
        return replace(data, values=values, pair_weights=None if data.pair_weights is None else weights, trials=None)

    wanted = possible_dims(data, tuple(dims))
    return _null_curves(
        drawn, wanted, model, level, ties, conditional, n_replicates, n_starts, seed, n_jobs, on_step
    )  # fmt: skip


def _null_curves(
    drawn: Callable[[np.random.Generator], Dissimilarities],
    dims: Sequence[int],
    model: Model,
    level: Level,
    ties: Ties,
    conditional: bool,
    n_replicates: int,
    n_starts: int,
    seed: int,
    n_jobs: int,
    on_step: OnStep,
) -> np.ndarray:
    if n_replicates < 1:
        raise GlossError(f"Invalid number of replicates = {n_replicates}. Allowed: 1 or more.")

    def one(child: np.random.SeedSequence) -> list[float]:
        curve = quick_curve(
            drawn(np.random.default_rng(child)),
            dims,
            model=model,
            level=level,
            ties=ties,
            conditional=conditional,
            n_starts=n_starts,
            seed=whole_number(child),
        )
        return [fit.stress1 for fit in curve]

    return np.array(list(in_parallel(one, np.random.SeedSequence(seed).spawn(n_replicates), n_jobs, on_step)))
