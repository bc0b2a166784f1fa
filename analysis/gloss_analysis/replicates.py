"""Many small analyses of drawn or altered judgements, in parallel, with progress."""

from collections.abc import Callable, Iterator, Sequence
from typing import Literal, TypeAlias, TypeVar

import numpy as np
from joblib import Parallel, delayed

__all__ = ["OnStep", "in_parallel", "no_step", "whole_number"]

OnStep: TypeAlias = Callable[[int, int], None]
"""Called with the number of steps done and of all steps, to show progress."""

_Case = TypeVar("_Case")
_Result = TypeVar("_Result")


def no_step(done: int, total: int) -> None:
    """Show no progress."""


def in_parallel(
    one: Callable[[_Case], _Result],
    cases: Sequence[_Case],
    n_jobs: int,
    on_step: OnStep,
    *,
    prefer: Literal["threads", "processes"] = "threads",
) -> Iterator[_Result]:
    """Results of `one` for all cases, in their order.

    In `n_jobs` threads or, for what is Python more than compiled code, processes (joblib); or on a cluster inside a
    block of `gloss_analysis.cluster.workers`. For the last two `one` must be such that cloudpickle can send it.
    """
    # `prefer` is a wish, which such a block overrules; `backend` would be an order.
    results = Parallel(n_jobs=n_jobs, prefer=prefer, return_as="generator")(map(delayed(one), cases))
    for done, result in enumerate(results, start=1):
        on_step(done, len(cases))
        yield result


def whole_number(seed: np.random.SeedSequence) -> int:
    """Seed as a number, for what takes one."""
    return int(seed.generate_state(1)[0])
