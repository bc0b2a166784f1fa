"""``stimuli.csv``: what the judged stimuli were, so that a dataset can be analysed without its images."""

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from glossspace.dataset.lock import locked
from glossspace.errors import GlossError
from glossspace.files import write_text
from glossspace.stimulus_set import Stimulus
from glossspace.user_table import read_user_table

__all__ = ["STIMULI_FILE", "read_stimuli", "read_stimulus_table", "record_stimuli"]

STIMULI_FILE = "stimuli.csv"
_COLUMNS = ["stimulus", "rho_d", "rho_s", "alpha"]


def record_stimuli(folder: str | Path, shown: Sequence[Stimulus], *, source: str) -> None:
    """Add stimuli to those that the dataset knows; an error message calls their `source` by that name.

    Raises
    ------
    GlossError
        The dataset knows a stimulus of this name with other parameters.
    """
    path = Path(folder) / STIMULI_FILE
    new = pd.DataFrame([(one.name, one.rho_d, one.rho_s, one.alpha) for one in shown], columns=_COLUMNS)
    with locked(Path(folder) / ".dataset.lock"):
        if not path.exists():
            write_text(path, new.to_csv(index=False, lineterminator="\n"))
            return
        known = read_stimuli(folder)
        both = known.merge(new, on="stimulus", suffixes=("", "_new"))
        for column in _COLUMNS[1:]:
            differing = both[both[column] != both[f"{column}_new"]]
            if not differing.empty:
                row = differing.iloc[0]
                raise GlossError(
                    f"The stimulus {row['stimulus']!r} has {column} {row[f'{column}_new']:g} in '{source}' but "
                    f"{row[column]:g} in '{path}'. Rename the stimulus, or use another dataset."
                )
        if not set(new["stimulus"]) <= set(known["stimulus"]):
            merged = pd.concat([known, new]).drop_duplicates("stimulus")
            write_text(path, merged.to_csv(index=False, lineterminator="\n"))


def read_stimuli(folder: str | Path) -> pd.DataFrame:
    """Parameters of the stimuli that the sessions of a dataset have shown.

    Returns
    -------
    DataFrame
        Columns ``stimulus`` (str), ``rho_d``, ``rho_s``, ``alpha``; one row a stimulus.

    Raises
    ------
    GlossError
        The dataset has no such file, or it is damaged; see `read_stimulus_table`.
    """
    path = Path(folder) / STIMULI_FILE
    if not path.exists():
        raise GlossError(
            f"The dataset '{folder}' has no {STIMULI_FILE}, so the parameters of its stimuli are not known. "
            "Give them as a CSV file (`--stimuli`) with the columns stimulus, rho_d, rho_s, alpha."
        )
    return read_stimulus_table(path)


def read_stimulus_table(path: str | Path) -> pd.DataFrame:
    """Parameters of stimuli from any CSV file with the columns stimulus, rho_d, rho_s and alpha; others are left out.

    Returns
    -------
    DataFrame
        As from `read_stimuli`.

    Raises
    ------
    GlossError
        The file is missing, empty or no such table, a stimulus has no name or is there twice, or its parameters cannot
        be.
    """
    table = read_user_table(path, what="stimulus table", columns=_COLUMNS)
    lines: dict[str, int] = {}
    for line, row in zip(table.index, table[_COLUMNS].itertuples(index=False), strict=True):
        where = f"The stimulus table '{path}', line {line}"
        if pd.isna(row.stimulus):
            raise GlossError(f"{where}: the stimulus has no name. Fill the cell.")
        if row.stimulus in lines:
            raise GlossError(
                f"{where}: {row.stimulus!r} is already in line {lines[row.stimulus]}. Remove one of the two."
            )
        lines[row.stimulus] = line
        try:
            # By Python: pandas' quick parser may miss a number's last bit, and the stimulus look like another.
            Stimulus(row.stimulus, float(row.rho_d), float(row.rho_s), float(row.alpha))
        except GlossError as error:
            raise GlossError(f"{where}: the stimulus {row.stimulus!r} cannot be: {error}") from None
        except ValueError as error:
            raise GlossError(
                f"{where}: the stimulus {row.stimulus!r} has no valid numbers: {error}. Allowed: rho_d, rho_s and "
                "alpha with a decimal point, such as 0.193."
            ) from None
    if table.empty:
        raise GlossError(f"The stimulus table '{path}' holds no stimulus. Add a row for each.")
    return table[_COLUMNS].astype(dict.fromkeys(_COLUMNS[1:], float)).reset_index(drop=True)
