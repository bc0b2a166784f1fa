"""Tables of single ratings (magnitude estimates): a CSV file of any study, told apart by the axis that it varied."""

from pathlib import Path
from typing import Literal, TypeAlias

import numpy as np
import pandas as pd

from gloss_analysis.axis_functions.coordinates import axis_coordinates
from glossspace.errors import GlossError
from glossspace.user_table import read_user_table

__all__ = ["COLUMNS", "LARGEST_RATING", "Axis", "from_rating_table", "read_ratings", "varied_axis"]

Axis: TypeAlias = Literal["c", "d"]
COLUMNS = ("participant_id", "stimulus", "rating")
"""That a table of ratings must have; `repeat` and `axis` are optional."""

_AXES: tuple[Axis, ...] = ("c", "d")
# Squares of larger ratings, and of smaller than their inverse, come near what a number can hold.
LARGEST_RATING = 1e100


def read_ratings(path: str | Path, stimuli: pd.DataFrame) -> dict[Axis, pd.DataFrame]:
    """Read ratings of single stimuli from a CSV file; see `from_rating_table`.

    Parameters
    ----------
    path
        The file, with the columns `participant_id`, `stimulus`, `rating`, and optionally `repeat` and `axis`.
    stimuli : DataFrame
        Columns `stimulus`, `rho_d`, `rho_s`, `alpha`; one row a stimulus.

    Returns
    -------
    dict of {"c", "d"} to DataFrame
        As from `from_rating_table`.

    Raises
    ------
    GlossError
        The file cannot be read (see `read_user_table`), or its content is wrong (see `from_rating_table`).

    Examples
    --------
    >>> read_ratings("no-such.csv", pd.DataFrame())
    Traceback (most recent call last):
    ...
    glossspace.errors.GlossError: No rating table at 'no-such.csv'. Check the path.
    """
    return from_rating_table(read_user_table(path, what="rating table", columns=COLUMNS), stimuli, source=f"'{path}'")


def from_rating_table(
    table: pd.DataFrame, stimuli: pd.DataFrame, *, source: str = "the table"
) -> dict[Axis, pd.DataFrame]:
    """Check ratings of single stimuli, and tell the study of contrast gloss from that of distinctness.

    Parameters
    ----------
    table : DataFrame, shape (n_trials, 3 or more)
        Columns `participant_id`, `stimulus`, `rating`. A trial that was not judged is absent, or its rating is empty.
        The optional column `repeat` (1, 2, ...) counts the trials of one participant and stimulus; without it their
        order does. The optional column `axis` holds c or d, the axis that the study varied, so that one table may hold
        both studies; without it the stimuli tell (see `varied_axis`).
    stimuli : DataFrame, shape (n_stimuli, 4 or more)
        Columns `stimulus`, `rho_d`, `rho_s`, `alpha`.
    source : str
        What to call the table in an error message.

    Returns
    -------
    dict of {"c", "d"} to DataFrame
        For each axis that was varied, `participant_id` (str), `stimulus` (str), `repeat` (int), `rating` (float), in
        the order of the table.

    Raises
    ------
    GlossError
        A column is missing, a name is empty, a rating is negative, beyond 1e100 or not a number, a repeat is no whole
        number from 1 or there twice, an axis is neither c nor d, a rated stimulus is not among `stimuli`, nothing was
        rated, or nothing says which axis the study varied.

    Examples
    --------
    >>> paints = pd.DataFrame({"stimulus": ["a", "b"], "rho_d": 0.03, "rho_s": 0.099, "alpha": [0.04, 0.10]})
    >>> rated = pd.DataFrame({"participant_id": "01", "stimulus": ["a", "b"], "rating": [80, 35]})
    >>> from_rating_table(rated, paints)["d"]["rating"].tolist()
    [80.0, 35.0]
    """
    missing = [column for column in COLUMNS if column not in table.columns]
    if missing:
        raise GlossError(f"{source} lacks the column {missing[0]!r}. Expected the columns {', '.join(COLUMNS)}.")
    _require_names(table, source)
    values = _ratings(table, source)
    judged = values.notna().to_numpy()
    if not judged.any():
        raise GlossError(f"{source} holds no rating.")
    tidy = table[["participant_id", "stimulus"]].astype(str).assign(rating=values.astype(float))[judged]
    axis_coordinates(stimuli, list(dict.fromkeys(tidy["stimulus"])))  # refuses a stimulus that is not known
    if "axis" in table.columns:
        axis = _axes(table, source)[judged]
    else:
        axis = pd.Series(varied_axis(stimuli, list(tidy["stimulus"]), source=source), index=tidy.index)
    tidy = tidy.assign(repeat=_repeats(table, source, tidy, judged, axis))
    columns = ["participant_id", "stimulus", "repeat", "rating"]
    studies = {one: tidy.loc[(axis == one).to_numpy(), columns].reset_index(drop=True) for one in _AXES}
    return {one: study for one, study in studies.items() if len(study)}


def varied_axis(stimuli: pd.DataFrame, names: list[str], *, source: str = "the table") -> Axis:
    """Which axis a study of the named stimuli is about: that whose parameters are not constant over them.

    Parameters
    ----------
    stimuli : DataFrame, shape (n_stimuli, 4 or more)
        Columns `stimulus`, `rho_d`, `rho_s`, `alpha`.
    names : list of str
        The stimuli that were rated.
    source : str
        What to call the ratings in an error message.

    Returns
    -------
    {"c", "d"}
        "c" where alpha is constant and a reflectance is not; "d" where both reflectances are constant and alpha is not.

    Raises
    ------
    GlossError
        All of them vary, or none does.

    Examples
    --------
    >>> paints = pd.DataFrame({"stimulus": ["a", "b"], "rho_d": 0.03, "rho_s": 0.099, "alpha": [0.04, 0.10]})
    >>> varied_axis(paints, ["a", "b"])
    'd'
    """
    rated = stimuli[stimuli["stimulus"].isin(names)]
    reflectances, roughness = (len(rated[columns].drop_duplicates()) > 1 for columns in (["rho_d", "rho_s"], ["alpha"]))
    if reflectances == roughness:
        what = "differ in their reflectances and in alpha" if roughness else "are all of one paint"
        raise GlossError(
            f"{source}: the rated stimuli {what}, so that they do not tell which axis the study varied. Add the column "
            "`axis` with c or d."
        )
    return "d" if roughness else "c"


def _require_names(table: pd.DataFrame, source: str) -> None:
    for column in ("participant_id", "stimulus"):
        nameless = table[column].isna().to_numpy()
        if nameless.any():
            raise GlossError(f"{source}, {_place(table, nameless)}: the {column} is empty. Fill the cell.")


def _ratings(table: pd.DataFrame, source: str) -> pd.Series:
    values = pd.to_numeric(table["rating"], errors="coerce")
    written = table["rating"].notna() & (table["rating"].astype(str).str.strip() != "")
    extreme = (values > LARGEST_RATING) | ((values > 0) & (values < 1 / LARGEST_RATING))
    impossible = ((values.isna() & written) | (values < 0) | extreme).to_numpy()
    if impossible.any():
        raise GlossError(
            f"{source}, {_place(table, impossible)}: rating {str(table['rating'][impossible].iloc[0])!r} is not "
            f"allowed. Allowed: 0, a number from {1 / LARGEST_RATING:g} to {LARGEST_RATING:g}, or an empty "
            "cell for a trial that was not judged."
        )
    return values


def _axes(table: pd.DataFrame, source: str) -> pd.Series:
    unknown = ~table["axis"].isin(_AXES).to_numpy()
    if unknown.any():
        found = table["axis"].astype(object).where(table["axis"].notna(), "")[unknown].iloc[0]
        raise GlossError(f"{source}, {_place(table, unknown)}: axis {str(found)!r} is not allowed. Allowed: c or d.")
    return table["axis"]


def _repeats(
    table: pd.DataFrame, source: str, tidy: pd.DataFrame, judged: np.ndarray, axis: pd.Series
) -> pd.Series | np.ndarray:
    trial = tidy[["participant_id", "stimulus"]].assign(axis=axis)
    if "repeat" not in table.columns:
        return trial.groupby(["participant_id", "stimulus", "axis"]).cumcount() + 1
    written = table["repeat"][judged]
    numbers = pd.to_numeric(written, errors="coerce")
    # A repeat is a count, so that a number as large as this is a slip, and no float is exact beyond it.
    wrong = ~((numbers >= 1) & (numbers < 2**53) & (numbers % 1 == 0)).to_numpy()
    if wrong.any():
        found = written.astype(object).where(written.notna(), "")[wrong].iloc[0]
        raise GlossError(
            f"{source}, {_place(table[judged], wrong)}: repeat {str(found)!r} is not allowed. Allowed: a whole number "
            "from 1."
        )
    again = trial.assign(repeat=numbers).duplicated().to_numpy()
    if again.any():
        first = tidy[again].iloc[0]
        raise GlossError(
            f"{source}, {_place(table[judged], again)}: repeat {int(numbers[again].iloc[0])} of {first['stimulus']!r} "
            f"by participant {first['participant_id']} is there already. Remove or renumber one of the two."
        )
    return numbers.astype(int)


def _place(table: pd.DataFrame, rows: np.ndarray) -> str:
    """Where the first of the marked rows stands: its line in the file, or its number in a table from elsewhere."""
    row = int(np.argmax(rows))
    return f"line {table.index[row]}" if table.index.name == "line" else f"row {row + 1}"
