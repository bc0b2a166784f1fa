"""How stress falls with the number of dimensions (figures 3 and 5 of the gloss paper)."""

from collections.abc import Callable, Iterable

from gloss_analysis.judgements.dissimilarity import Dissimilarities
from gloss_analysis.mds import MdsSolution, Model, scale
from gloss_analysis.mds.disparities import Level, Ties

__all__ = ["stress_curve"]


def stress_curve(
    data: Dissimilarities,
    *,
    dims: Iterable[int] = range(1, 6),
    model: Model = "weighted",
    level: Level = "ordinal",
    ties: Ties = "primary",
    conditional: bool = True,
    n_starts: int = 30,
    seed: int = 1,
    n_jobs: int = 1,
    on_solution: Callable[[MdsSolution], None] = lambda solution: None,
) -> tuple[MdsSolution, ...]:
    """Scale in each number of dimensions, from the fewest up.

    Each solution, with an empty dimension added, is a start for the next, so that stress does not rise with the number
    of dimensions by more than the solver's tolerance. Numbers that the data have no room for, more than n - 1, are left
    out.

    Parameters
    ----------
    data, model, level, ties, conditional, n_starts, seed, n_jobs
        See `gloss_analysis.mds.scale`.
    dims : iterable of int
        Numbers of dimensions.
    on_solution : callable
        Called with each solution as it is found, to show progress.

    Returns
    -------
    tuple of MdsSolution
        In the order of their dimensions.
    """
    solutions: list[MdsSolution] = []
    for n_dims in sorted({p for p in dims if p <= len(data.stimuli) - 1} or set(dims)):
        solutions.append(
            scale(
                data,
                n_dims=n_dims,
                model=model,
                level=level,
                ties=ties,
                conditional=conditional,
                n_starts=n_starts,
                seed=seed,
                initial=solutions[-1:],
                n_jobs=n_jobs,
            )
        )
        on_solution(solutions[-1])
    return tuple(solutions)
