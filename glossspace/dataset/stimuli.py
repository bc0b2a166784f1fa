"""``stimuli.csv``: what the judged stimuli were, so that a dataset can be analysed without its images."""

from pathlib import Path

import pandas as pd

from glossspace.dataset.lock import locked
from glossspace.errors import GlossError
from glossspace.files import write_text
from glossspace.stimulus_set import StimulusSet

__all__ = ["STIMULI_FILE", "read_stimuli", "record_stimuli"]

STIMULI_FILE = "stimuli.csv"
_COLUMNS = ["stimulus", "rho_d", "rho_s", "alpha"]


def record_stimuli(folder: str | Path, shown: StimulusSet) -> None:
    """Add the stimuli of a set to those that the dataset knows.

    Raises
    ------
    GlossError
        The dataset knows a stimulus of this name with other parameters.
    """
    path = Path(folder) / STIMULI_FILE
    new = shown.table()[_COLUMNS]
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
                    f"The stimulus {row['stimulus']!r} has {column} {row[f'{column}_new']:g} in '{shown.folder}' but "
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
        The dataset has no such file, or the file lacks a column or holds something that is not a number.
    """
    path = Path(folder) / STIMULI_FILE
    try:
        # As text: pandas' quick parser may miss a number's last bit, and the same stimulus would look like another.
        table = pd.read_csv(path, dtype=str)
    except FileNotFoundError:
        raise GlossError(
            f"The dataset '{folder}' has no {STIMULI_FILE}, so the parameters of its stimuli are not known. "
            "Give them as a table with the columns stimulus, rho_d, rho_s, alpha."
        ) from None
    except (OSError, ValueError) as error:
        raise GlossError(f"Cannot read '{path}': {str(error).strip()}.") from None
    missing = [column for column in _COLUMNS if column not in table.columns]
    if missing:
        raise GlossError(f"'{path}' lacks the column {missing[0]!r}. Expected {', '.join(_COLUMNS)}.")
    try:
        return table[_COLUMNS].astype(dict.fromkeys(_COLUMNS[1:], float))
    except ValueError as error:
        raise GlossError(f"'{path}' holds a value that is not a number: {error}.") from None
