"""What makes a dataset whole: the rules of Psych-DS, and those of a psychophysical session."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from glossspace.dataset.schema import (
    DESCRIPTION_FILE,
    OBSERVER_KINDS,
    PILOT_COLUMN,
    PILOTS_FOLDER,
    RATING_COLUMN,
    RATING_MAX,
    RATING_MIN,
    TaskKind,
    file_name_labels,
)
from glossspace.dataset.table import DataFile, data_files, read_data_file, task_kind
from glossspace.errors import GlossError
from glossspace.files import read_json

__all__ = ["checked_tables", "dataset_problems", "validate_dataset"]

Table = tuple[DataFile, TaskKind]


def dataset_problems(folder: str | Path) -> list[str]:
    """Every problem of a dataset, one line each; an empty list where there is none.

    Checked are: the description and its ``variableMeasured`` against the columns, both ways; file names; UTF-8 without
    a byte order mark; the columns of each task; unique ``row_id``; no trial twice; ratings from 0 to 100; that the
    ranks of a ranking are 1 to the number of its stimuli; times and counts; that names, sessions and tasks inside a
    file are those of its name; that no pilot is among the data; and that no participant is both human and simulated.

    Raises
    ------
    GlossError
        There is no such folder.
    """
    return _examined(Path(folder))[1]


def validate_dataset(folder: str | Path) -> None:
    """Return if the dataset is whole.

    Raises
    ------
    GlossError
        Its message is the first problem, on one line, and how many more there are.

    Examples
    --------
    >>> validate_dataset("no-such-folder")
    Traceback (most recent call last):
    ...
    glossspace.errors.GlossError: No dataset folder at 'no-such-folder'. Check the path.
    """
    checked_tables(folder)


def checked_tables(folder: str | Path) -> list[Table]:
    """The data files of a whole dataset with their kinds; the error of `validate_dataset` for any other."""
    tables, problems = _examined(Path(folder))
    if problems:
        n_more = len(problems) - 1
        more = f" ({n_more} more problem{'s' if n_more > 1 else ''} in this dataset.)" if n_more else ""
        raise GlossError(problems[0] + more)
    return tables


def _examined(folder: Path) -> tuple[list[Table], list[str]]:
    if not folder.is_dir():
        raise GlossError(f"No dataset folder at '{folder}'. Check the path.")
    if not (folder / DESCRIPTION_FILE).exists():
        inside = folder / "dataset"
        hint = f"Did you mean '{inside}'?" if (inside / DESCRIPTION_FILE).exists() else "Check the path."
        return [], [f"'{folder}' is no dataset: it holds no {DESCRIPTION_FILE}. {hint}"]
    problems: list[str] = []
    try:
        description = read_json(folder / DESCRIPTION_FILE, what="dataset description")
    except GlossError as error:
        return [], [str(error)]
    tables: list[Table] = []
    all_readable = True
    for path in data_files(folder):
        try:
            tables.append(_read_checked(path))
        except GlossError as error:
            problems.append(str(error))
            all_readable = False
    if not tables and not problems:
        problems.append(f"'{folder}' holds no data file under 'data'; a session that ends writes one.")
    problems += _description_problems(folder / DESCRIPTION_FILE, description, tables if all_readable else None)
    for table, kind in tables:
        problems += _row_problems(table, kind)
        problems += _process_problems(table, kind)
        problems += _pilot_problems(table, folder)
        if kind == "ranking":
            problems += _rank_problems(table)
    problems += _repeated_problems(tables)
    return tables, problems


def _read_checked(path: Path) -> Table:
    labels = file_name_labels(path.name)
    if labels is None or not {"subject", "session", "task"} <= set(labels):
        raise GlossError(
            f"'{path}' is not named as a data file: name it like 'subject-01_session-1_task-pairwise_data.csv', "
            "with letters and digits for the values, or move it out of 'data'."
        )
    table = read_data_file(path)
    return table, task_kind(table)


def _description_problems(path: Path, description: dict[str, Any], tables: list[Table] | None) -> Iterator[str]:
    missing = [
        key for key in ("@context", "@type", "name", "description", "variableMeasured") if key not in description
    ]
    if missing:
        yield f"'{path}' has no '{missing[0]}'; Psych-DS asks for it."
        return
    if description["@type"] != "Dataset":
        yield f"'{path}' says @type '{description['@type']}'; it must be 'Dataset'."
    described = _described_names(description["variableMeasured"])
    if described is None:
        yield f"'{path}': variableMeasured must be a list of names or of objects with a 'name'."
        return
    if tables is None:  # the columns are not all known, so any comparison would mislead
        return
    measured = {name: table.path for table, _ in tables for name in table.header}
    for name in sorted(set(measured) - described):
        yield f"Column '{name}' of '{measured[name]}' is not in variableMeasured of '{path}'; describe it there."
    for name in sorted(described - set(measured)):
        yield f"variableMeasured of '{path}' names '{name}', but no data file has that column; remove it there."


def _described_names(variables: Any) -> set[str] | None:
    if not isinstance(variables, list):
        return None
    names = [item.get("name") if isinstance(item, dict) else item for item in variables]
    return {name for name in names if isinstance(name, str)} if all(isinstance(n, str) for n in names) else None


def _row_problems(table: DataFile, kind: TaskKind) -> Iterator[str]:
    labels = file_name_labels(table.path.name) or {}
    expected = {"participant_id": labels["subject"], "session": labels["session"], "task": labels["task"]}
    for line, row in table.rows:
        where = f"'{table.path}', line {line}"
        for column, value in expected.items():
            if row[column] != value:
                yield f"{where}: {column} '{row[column]}', but the file's name says '{value}'."
        rating = row[RATING_COLUMN[kind]]
        if kind == "ranking" and rating and not _counts_from_1(rating):
            yield f"{where}: rank '{rating}' is not a whole number from 1; leave it empty if the stimulus has no rank."
        elif kind != "ranking" and rating and not _is_rating(rating):
            yield (
                f"{where}: {RATING_COLUMN[kind]} '{rating}' is not a number from {RATING_MIN} to {RATING_MAX}; "
                "correct it, or leave it empty if the trial was not judged."
            )
        for column in ("block", "trial", "repeat"):
            if not _counts_from_1(row[column]):
                yield f"{where}: {column} '{row[column]}' is not a whole number from 1."
        if row["observer"] not in OBSERVER_KINDS:
            yield f"{where}: observer '{row['observer']}'; allowed are 'human' and 'simulated'."
        if not row["row_id"]:
            yield f"{where}: row_id is empty; each row needs its own."
        if not all(row[column] for column in _stimulus_columns(kind)):
            yield f"{where}: no stimulus is named; give the name it has in the stimulus set."


def _process_problems(table: DataFile, kind: TaskKind) -> Iterator[str]:
    """Of the columns that say how an answer came about; files of the first version have only the first of them."""
    for line, row in table.rows:
        where = f"'{table.path}', line {line}"
        for column in ("response_time_s", "first_response_s"):
            if not _is_empty_or_not_negative(row.get(column, "")):
                yield f"{where}: {column} '{row[column]}' is not a time from 0; leave it empty if it is not known."
        for column in ("n_changes", "n_reversals", "dropped_frames"):
            if row.get(column, "") and not (row[column].isascii() and row[column].isdigit()):
                yield f"{where}: {column} '{row[column]}' is not a whole number from 0; leave it empty if unknown."
        timed_out = row.get("timed_out", "")
        if timed_out not in ("", "yes", "no"):
            yield f"{where}: timed_out '{timed_out}'; allowed are 'yes' and 'no'."
        if timed_out == "yes" and row[RATING_COLUMN[kind]]:
            yield f"{where}: the trial timed out, yet it has a {RATING_COLUMN[kind]}; empty one of the two."


def _is_empty_or_not_negative(text: str) -> bool:
    try:
        return text == "" or 0 <= float(text) < math.inf
    except ValueError:
        return False


def _pilot_problems(table: DataFile, folder: Path) -> Iterator[str]:
    """Pilots have a dataset of their own, so that no analysis of the study comes across them."""
    if folder.resolve().name == PILOTS_FOLDER:
        return
    pilots = [line for line, row in table.rows if row.get(PILOT_COLUMN, "") not in ("", "no")]
    if pilots:
        yield (
            f"'{table.path}', line {pilots[0]}: this is a pilot, which is no data of the study; move the file to the "
            f"'data' folder of '{folder / PILOTS_FOLDER}'."
        )


def _rank_problems(table: DataFile) -> Iterator[str]:
    rankings: dict[str, list[tuple[int, str]]] = {}
    for line, row in table.rows:
        rankings.setdefault(row["trial"], []).append((line, row["rank"]))
    for trial, rows in rankings.items():
        ranks = [rank for _, rank in rows]
        # One that was not finished has no rank at all.
        if any(ranks) and all(rank == "" or _counts_from_1(rank) for rank in ranks):
            found = sorted(int(rank) if rank else 0 for rank in ranks)
            if found != list(range(1, len(ranks) + 1)):
                yield (
                    f"'{table.path}', line {rows[0][0]}: the ranks of trial {trial} are "
                    f"{', '.join(rank or 'empty' for rank in ranks)}; each of 1 to {len(ranks)} is given once."
                )


def _counts_from_1(text: str) -> bool:
    return text.isascii() and text.isdigit() and int(text) >= 1


def _is_rating(text: str) -> bool:
    try:
        value = float(text)
    except ValueError:
        return False
    # Python also reads 1_000 and the digits of other scripts; no other program would.
    if "_" in text or not text.isascii():
        return False
    return math.isfinite(value) and RATING_MIN <= value <= RATING_MAX


def _stimulus_columns(kind: TaskKind) -> tuple[str, ...]:
    return ("stimulus_left", "stimulus_right") if kind == "pairwise" else ("stimulus",)


def _repeated_problems(tables: list[Table]) -> Iterator[str]:
    row_ids: dict[str, str] = {}
    trials: dict[tuple[Any, ...], str] = {}
    kinds: dict[str, str] = {}
    for table, kind in tables:
        for line, row in table.rows:
            where = f"'{table.path}', line {line}"
            # The sides do not matter: a pair shown twice is the same trial twice, whichever way round.
            shown = tuple(sorted(row[column] for column in _stimulus_columns(kind)))
            trial = (row["participant_id"], row["session"], row["task"], row["repeat"], shown)
            if row["row_id"] in row_ids:
                yield f"{where}: row_id '{row['row_id']}' is already used in {row_ids[row['row_id']]}; remove one row."
            elif trial in trials:
                yield f"{where}: the trial {' with '.join(shown)} is already in {trials[trial]}; remove one row."
            row_ids.setdefault(row["row_id"], where)
            trials.setdefault(trial, where)
            first = kinds.setdefault(row["participant_id"], row["observer"])
            if row["observer"] != first:
                yield (
                    f"{where}: participant '{row['participant_id']}' is {row['observer']} here and {first} elsewhere; "
                    "give simulated observers a participant of their own."
                )
                kinds[row["participant_id"]] = row["observer"]
