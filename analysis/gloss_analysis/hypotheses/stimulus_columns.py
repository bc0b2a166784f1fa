"""What is known of the stimuli, as columns: their parameters, what was measured in their images, and more."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from glossspace.dataset import read_stimulus_table
from glossspace.errors import GlossError
from glossspace.stimulus_set import read_stimulus_set
from glossspace.user_table import read_user_table

__all__ = ["MEASUREMENTS_FILE", "joined", "read_stimulus_columns"]

MEASUREMENTS_FILE = "measurements.csv"
"""Where a stimulus set keeps what was measured in its images."""

_PARAMETERS = ("rho_d", "rho_s", "alpha")
# Two files may have the same number to other digits; measurements are written to seven.
_SAME = 1e-6


def read_stimulus_columns(paths: Sequence[str | Path]) -> pd.DataFrame:
    """Read stimuli from tables and stimulus sets, and put what each tells of them side by side.

    Parameters
    ----------
    paths : sequence of path
        Each a CSV file with the column `stimulus` and any others, of which those that hold numbers are kept; or the
        folder of a stimulus set, which gives parameters and, where its images were measured, measurements.

    Returns
    -------
    DataFrame
        Column `stimulus` (str), and every column of numbers that some file has; NaN where none tells.

    Raises
    ------
    GlossError
        A file cannot be read, a stimulus has no name or is there twice in one file, its parameters cannot be, or two
        files say different things of one stimulus.

    Examples
    --------
    >>> read_stimulus_columns(["no-such.csv"])
    Traceback (most recent call last):
    ...
    glossspace.errors.GlossError: No stimulus table at 'no-such.csv'. Check the path.
    """
    tables = [table for path in paths for table in _tables(Path(path))]
    if not tables:
        raise GlossError("No file tells what the stimuli are. Give a CSV file or the folder of a stimulus set.")
    return joined(tables)


def joined(tables: Sequence[tuple[str, pd.DataFrame]]) -> pd.DataFrame:
    """Put the columns of several tables of stimuli side by side.

    Parameters
    ----------
    tables : sequence of (str, DataFrame)
        What to call each table in an error message, and its column `stimulus` and columns of numbers.

    Returns
    -------
    DataFrame
        As of `read_stimulus_columns`.

    Raises
    ------
    GlossError
        Two tables give different numbers for one stimulus and column.

    Examples
    --------
    >>> paints = pd.DataFrame({"stimulus": ["a", "b"], "alpha": [0.04, 0.1]})
    >>> joined([("paints", paints), ("rims", pd.DataFrame({"stimulus": ["b"], "rim": [3.0]}))])["rim"].tolist()
    [nan, 3.0]
    """
    together = tables[0][1].set_index("stimulus")
    for source, table in tables[1:]:
        more = table.set_index("stimulus")
        both, columns = together.index.intersection(more.index), together.columns.intersection(more.columns)
        old, new = together.loc[both, columns].to_numpy(dtype=float), more.loc[both, columns].to_numpy(dtype=float)
        differing = np.argwhere(np.abs(old - new) > _SAME * np.maximum(np.abs(old), np.abs(new)))
        if len(differing):
            row, column = differing[0]
            raise GlossError(
                f"{source} gives {columns[column]} = {new[row, column]:g} for the stimulus {both[row]!r}, another file "
                f"{old[row, column]:g}. Leave one of the two out, or rename the column."
            )
        order = [*together.columns, *(name for name in more.columns if name not in together.columns)]
        rows = [*together.index, *(name for name in more.index if name not in together.index)]
        together = together.combine_first(more).loc[rows, order]
    return together.rename_axis("stimulus").reset_index()


def _tables(path: Path) -> list[tuple[str, pd.DataFrame]]:
    if not path.is_dir():
        return [(f"'{path}'", _numbers(path, "stimulus table"))]
    found = [(f"The stimulus set '{path}'", read_stimulus_set(path, verify=False).table())]
    measured = path / MEASUREMENTS_FILE
    if measured.is_file():
        found.append((f"'{measured}'", _numbers(measured, "table of measurements")))
    return found


def _numbers(path: Path, what: str) -> pd.DataFrame:
    table = read_user_table(path, what=what, columns=["stimulus"])
    nameless = table["stimulus"].isna().to_numpy()
    if nameless.any():
        raise GlossError(f"'{path}', line {table.index[nameless][0]}: the stimulus has no name. Fill the cell.")
    twice = table["stimulus"].duplicated().to_numpy()
    if twice.any():
        raise GlossError(
            f"'{path}', line {table.index[twice][0]}: {table['stimulus'][twice].iloc[0]!r} is there already. Remove "
            "one of the two."
        )
    numbers = table.drop(columns="stimulus").apply(pd.to_numeric, errors="coerce")
    # A column of words, such as a remark, is no property of a stimulus that a function could use.
    kept = table[["stimulus"]].join(numbers.loc[:, numbers.notna().any()]).reset_index(drop=True)
    if all(name in table.columns for name in _PARAMETERS):
        checked = read_stimulus_table(path)
        kept = kept.assign(**{name: checked[name] for name in _PARAMETERS})
    return kept
