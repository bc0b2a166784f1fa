"""Ratings of single stimuli, told apart by which of any given axes their study varied."""

from pathlib import Path

import numpy as np
import pandas as pd

from gloss_analysis.ratings.rating_table import LARGEST_RATING
from glossspace.dataset import read_magnitudes, tasks_of
from glossspace.errors import GlossError
from glossspace.user_table import read_user_table

__all__ = ["read_axis_ratings"]


def read_axis_ratings(
    path: str | Path, stimuli: tuple[str, ...], coordinates: np.ndarray, *, axes: tuple[str, ...]
) -> dict[str, pd.DataFrame]:
    """Read magnitude estimates along given axes, from a table or a dataset folder.

    Parameters
    ----------
    path
        A CSV file with the columns `participant_id`, `stimulus`, `rating`, and optionally `axis` with the name of one
        of the axes; or a dataset folder, whose magnitude tasks are studies of one axis each.
    stimuli : tuple of str, length n
        Those whose coordinates are known; others may have been rated too.
    coordinates : ndarray, shape (n, p)
    axes : tuple of str, length p
        Without a column `axis`, the axis is the one along which the rated stimuli among these differ.

    Returns
    -------
    dict of str to DataFrame
        For each axis that was rated, `participant_id` (str), `stimulus` (str), `rating` (float).

    Raises
    ------
    GlossError
        The file or dataset cannot be read or holds no ratings, a rating is negative or no number, an axis is not known,
        or nothing tells which axis a study varied.

    Examples
    --------
    >>> read_axis_ratings("no-such.csv", ("a",), np.zeros((1, 1)), axes=("c",))
    Traceback (most recent call last):
    ...
    glossspace.errors.GlossError: No rating table at 'no-such.csv'. Check the path.
    """
    path = Path(path)
    known = pd.DataFrame(coordinates, index=list(stimuli), columns=list(axes))
    found: dict[str, pd.DataFrame] = {}
    for source, table in _studies(path):
        if "axis" in table.columns:
            parts = {str(name): rows for name, rows in table.groupby("axis", sort=False, dropna=False)}
            unknown = [name for name in parts if name not in axes]
            if unknown:
                raise GlossError(f"{source}: axis {unknown[0]!r} is not known. Allowed: {', '.join(axes)}.")
        else:
            parts = {_varied(known, set(table["stimulus"]), source): table}
        for axis, rows in parts.items():
            if axis in found:
                raise GlossError(
                    f"{source} and another study both varied {axis}. Give one table with the column axis, or a table "
                    "of one of the two."
                )
            found[axis] = rows[["participant_id", "stimulus", "rating"]].reset_index(drop=True)
    return found


def _studies(path: Path) -> list[tuple[str, pd.DataFrame]]:
    if path.is_dir():
        tasks = [task for task, kind in tasks_of(path).items() if kind == "magnitude"]
        if not tasks:
            raise GlossError(f"The dataset '{path}' holds no magnitude estimates. Run 'gloss session' into it.")
        return [(f"The task {task!r} of '{path}'", read_magnitudes(path, task)) for task in tasks]
    table = read_user_table(path, what="rating table", columns=("participant_id", "stimulus", "rating"))
    for column in ("participant_id", "stimulus"):
        nameless = table[column].isna().to_numpy()
        if nameless.any():
            raise GlossError(f"'{path}', line {table.index[nameless][0]}: the {column} is empty. Fill the cell.")
    values = pd.to_numeric(table["rating"], errors="coerce")
    usable = (values == 0) | ((values >= 1 / LARGEST_RATING) & (values <= LARGEST_RATING))
    wrong = (table["rating"].notna() & ~usable).to_numpy()
    if wrong.any():
        raise GlossError(
            f"'{path}', line {table.index[wrong][0]}: rating {table['rating'][wrong].iloc[0]!r} is not allowed. "
            f"Allowed: 0, a number from {1 / LARGEST_RATING:g} to {LARGEST_RATING:g}, or an empty "
            "cell for a trial that was not judged."
        )
    judged = values.notna()
    if not judged.any():
        raise GlossError(f"'{path}' holds no rating.")
    return [(f"'{path}'", table.assign(rating=values)[judged])]


def _varied(known: pd.DataFrame, rated: set[str], source: str) -> str:
    both = known[known.index.isin(rated)]
    if both.empty:
        raise GlossError(
            f"{source}: none of the rated stimuli was judged in pairs, so that there is nothing to compare. Rate some "
            "that were, under the same names."
        )
    differing = [str(axis) for axis in known.columns if np.ptp(both[axis]) > 0]
    if len(differing) != 1:
        along = f"along {' and '.join(differing)}" if differing else "along none of the axes"
        raise GlossError(
            f"{source}: the {len(both)} rated stimuli whose coordinates are known differ {along}, so that they do not "
            "tell which axis the study varied. Give a table with the column axis."
        )
    return differing[0]
