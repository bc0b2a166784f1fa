"""Square matrices of dissimilarities, in memory or in a CSV file."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from gloss_analysis.judgements.dissimilarity import COLUMNS, Dissimilarities
from glossspace.errors import GlossError

__all__ = ["check_enough", "from_matrices", "from_square_table"]

# The two triangles of a symmetric matrix may differ by what writing them as text loses.
_ROUNDING = 1e-9


def from_matrices(
    matrices: Any,
    *,
    stimuli: Sequence[str] | None = None,
    participants: Sequence[str] | None = None,
    weights: Any = None,
    source_weights: Any = None,
    source: str = "the matrix",
) -> Dissimilarities:
    """Arrange square matrices of dissimilarities, one a participant, as condensed triangles.

    Parameters
    ----------
    matrices : array_like, shape (n, n) or (m, n, n)
        Symmetric, >= 0; NaN where a pair was not judged, in one triangle or in both. The diagonal is not used.
    stimuli, participants : sequence of str, optional
        Their names; numbers from 1 by default.
    weights : array_like, shape (n, n) or (m, n, n), optional
        Of the pairs, symmetric, >= 0.
    source_weights : array_like, shape (m,), optional
        Of the participants, >= 0.
    source : str
        What to call the matrices in an error message.

    Returns
    -------
    Dissimilarities

    Raises
    ------
    GlossError
        A matrix is not square or not symmetric, holds a negative or infinite number, or names do not fit.

    Examples
    --------
    >>> from_matrices([[0, 1, 2], [1, 0, 4], [2, 4, 0]]).values
    array([[1., 2., 4.]])
    """
    cube = _cube(matrices, source)
    m, n, _ = cube.shape
    stimuli = tuple(map(str, stimuli if stimuli is not None else range(1, n + 1)))
    participants = tuple(map(str, participants if participants is not None else range(1, m + 1)))
    for names, count, what in ((stimuli, n, "stimuli"), (participants, m, "participants")):
        if len(names) != count or len(set(names)) != count:
            raise GlossError(f"{source} has {count} {what}, not {len(names)} different names for them.")
    check_enough(stimuli, source)
    pair_weights = None
    if weights is not None:
        weight_cube = _cube(weights, "the weights")
        if weight_cube.shape not in ((1, n, n), (m, n, n)):
            raise GlossError(f"Weights of shape {np.shape(weights)} do not fit. Allowed: {(n, n)} or {(m, n, n)}.")
        triangles = _triangles(weight_cube, stimuli, "the weights")
        pair_weights = np.broadcast_to(triangles, (m, triangles.shape[1]))
    own = None if source_weights is None else np.asarray(source_weights, dtype=float)
    return Dissimilarities(stimuli, participants, _triangles(cube, stimuli, source), pair_weights, own)


def from_square_table(table: pd.DataFrame, source: str) -> Dissimilarities:
    """Arrange a matrix that was read from a CSV file: names in the header and, if it wants, in the first column.

    Raises
    ------
    GlossError
        It is not square, its rows are in another order than its columns, or see `from_matrices`.
    """
    names = list(table.columns)
    labelled = len(names) == len(table) + 1
    if labelled and _is_number(names[0]):
        raise GlossError(
            f"{source} has numbers where names are expected: its first line must name the stimuli, as 'a,b,c' or, with "
            f"a column of names, ',a,b,c'; it begins with {names[0]!r}."
        )
    if labelled:
        rows = list(table.iloc[:, 0].fillna(""))
        names = names[1:]
        if rows != names:
            place = next(i for i, pair in enumerate(zip(rows, names, strict=True)) if pair[0] != pair[1])
            raise GlossError(
                f"{source}: row {place + 1} of the matrix is that of {rows[place]!r}, but column {place + 1} that of "
                f"{names[place]!r}. Give rows and columns in the same order."
            )
        table = table.iloc[:, 1:]
    if len(names) != len(table):
        hint = " Save it as CSV with commas, in UTF-8." if len(names) == 1 else ""
        raise GlossError(
            f"{source} lacks the column {COLUMNS[0]!r}. Expected the columns {', '.join(COLUMNS)}, or a square matrix; "
            f"found {len(table)} rows below {len(names)} names: {', '.join(names)[:120]}.{hint}"
        )
    cells = table.to_numpy()
    numbers = table.apply(pd.to_numeric, errors="coerce").to_numpy(dtype=float)
    unreadable = np.argwhere(np.isnan(numbers) & table.notna().to_numpy())
    if len(unreadable):
        i, j = unreadable[0]
        raise GlossError(
            f"{source}, line {table.index[i]}: dissimilarity {cells[i, j]!r} is not allowed. Allowed: a finite number "
            ">= 0, or an empty cell for a pair that was not judged."
        )
    return from_matrices(numbers, stimuli=names, source=source)


def check_enough(stimuli: Sequence[str], source: str) -> int:
    """Refuse fewer than three stimuli; return how many there are."""
    n = len(stimuli)
    if n < 3:
        count = {0: "no stimuli", 1: "1 stimulus"}.get(n, f"{n} stimuli")
        raise GlossError(f"{source} holds {count}. Scaling needs at least 3.")
    return n


def _cube(matrices: Any, source: str) -> np.ndarray:
    try:
        cube: np.ndarray = np.ma.filled(np.ma.asarray(matrices, dtype=float), np.nan)
    except (TypeError, ValueError):
        raise GlossError(f"{source} must be numbers, of shape (n, n) or (m, n, n).") from None
    cube = cube[np.newaxis] if cube.ndim == 2 else cube
    if cube.ndim != 3 or cube.shape[1] != cube.shape[2]:
        raise GlossError(f"{source} must be square, of shape (n, n) or (m, n, n), not {np.shape(matrices)}.")
    return cube


def _triangles(cube: np.ndarray, stimuli: Sequence[str], source: str) -> np.ndarray:
    first, second = np.triu_indices(cube.shape[1], 1)
    upper, lower = cube[:, first, second], cube[:, second, first]
    both = np.where(np.isnan(upper), lower, upper)
    mirrored = np.where(np.isnan(lower), upper, lower)
    impossible = np.argwhere((both < 0) | np.isinf(both) | (mirrored < 0) | np.isinf(mirrored))
    if len(impossible):
        k, pair = impossible[0]
        value = both[k, pair] if both[k, pair] < 0 or np.isinf(both[k, pair]) else mirrored[k, pair]
        raise GlossError(
            f"{source}: {value:g} for the stimuli {stimuli[first[pair]]} and {stimuli[second[pair]]} is not allowed. "
            "Allowed: a finite number >= 0, or nothing (NaN) for a pair that was not judged."
        )
    unequal = np.argwhere(np.abs(both - mirrored) > _ROUNDING * np.maximum(both, mirrored))
    if len(unequal):
        k, pair = unequal[0]
        i, j = first[pair], second[pair]
        raise GlossError(
            f"{source} is not symmetric: {cube[k, i, j]:.12g} in row {i + 1}, column {j + 1}, but "
            f"{cube[k, j, i]:.12g} in row {j + 1}, column {i + 1}. Average the two triangles, or leave one of "
            "them empty."
        )
    return both


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
