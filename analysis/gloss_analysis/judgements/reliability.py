"""How consistent each participant is: identical pairs, and pairs judged more than once.

Scaling leaves identical pairs out and averages repeats; what they say about the judgements is said here.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

__all__ = ["Reliability", "reliability"]


@dataclass(frozen=True)
class Reliability:
    """Consistency of one participant.

    Attributes
    ----------
    participant_id : str
    n_identical : int
        Judgements of a stimulus with itself.
    identical_mean : float
        Their mean, which should be near 0; NaN without any.
    largest : float
        The participant's largest judgement, to compare with.
    n_repeated_pairs : int
        Pairs of different stimuli that were judged more than once, in either order.
    repeat_sd : float
        Standard deviation of one judgement about the mean of its repeats, pooled over the repeated pairs; NaN without
        any.
    retest_correlation : float
        Product-moment correlation of first and second judgements of repeated pairs; NaN where it is not defined.
    """

    participant_id: str
    n_identical: int
    identical_mean: float
    largest: float
    n_repeated_pairs: int
    repeat_sd: float
    retest_correlation: float


def reliability(table: pd.DataFrame) -> tuple[Reliability, ...]:
    """Consistency of each participant in a long table of judgements.

    Parameters
    ----------
    table : DataFrame
        Columns `participant_id`, `stimulus_a`, `stimulus_b`, `dissimilarity`, in the order of the trials.

    Returns
    -------
    tuple of Reliability
        In the order of the participants' first appearance.

    Examples
    --------
    >>> rows = [("1", "a", "b", 4), ("1", "b", "a", 6), ("1", "a", "c", 9), ("1", "a", "a", 1)]
    >>> columns = ["participant_id", "stimulus_a", "stimulus_b", "dissimilarity"]
    >>> found = reliability(pd.DataFrame(rows, columns=columns))[0]
    >>> found.identical_mean, found.n_repeated_pairs, round(found.repeat_sd, 3)
    (1.0, 1, 1.414)
    """
    judged = pd.DataFrame(
        {
            "participant": table["participant_id"].astype(str),
            "a": table["stimulus_a"].astype(str),
            "b": table["stimulus_b"].astype(str),
            "value": pd.to_numeric(table["dissimilarity"], errors="coerce"),
        }
    ).dropna()
    return tuple(_of(str(name), rows) for name, rows in judged.groupby("participant", sort=False))


def _of(name: str, rows: pd.DataFrame) -> Reliability:
    same = rows["a"] == rows["b"]
    different = rows[~same]
    first = np.where(different["a"] < different["b"], different["a"], different["b"])
    second = np.where(different["a"] < different["b"], different["b"], different["a"])
    repeats = [group.to_numpy() for _, group in different["value"].groupby([first, second], sort=False)]
    repeated = [values for values in repeats if len(values) > 1]
    freedom = sum(len(values) - 1 for values in repeated)
    squares = sum(float(np.sum((values - values.mean()) ** 2)) for values in repeated)
    return Reliability(
        participant_id=name,
        n_identical=int(same.sum()),
        identical_mean=float(rows["value"][same].mean()) if same.any() else np.nan,
        largest=float(rows["value"].max()),
        n_repeated_pairs=len(repeated),
        repeat_sd=float(np.sqrt(squares / freedom)) if freedom else np.nan,
        retest_correlation=_correlation(np.array([values[:2] for values in repeated])),
    )


def _correlation(pairs: np.ndarray) -> float:
    if len(pairs) < 3 or np.any(np.ptp(pairs, axis=0) == 0):
        return np.nan
    return float(np.corrcoef(pairs.T)[0, 1])
