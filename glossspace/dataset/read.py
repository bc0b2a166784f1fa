"""Readers: from a whole dataset to the tables that analyses take."""

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from glossspace.dataset.schema import TaskKind
from glossspace.dataset.validate import checked_tables
from glossspace.errors import GlossError

__all__ = ["read_dissimilarities", "read_magnitudes", "read_rankings", "simulated_participants", "tasks_of"]


def read_dissimilarities(folder: str | Path) -> pd.DataFrame:
    """All judged differences between pairs, of all participants.

    Parameters
    ----------
    folder
        The dataset. It is validated first.

    Returns
    -------
    DataFrame
        Columns ``participant_id`` (str), ``stimulus_a``, ``stimulus_b`` (str, in alphabetical order whichever side each
        was on), ``dissimilarity`` (float, 0–100). Identical pairs are included, and zero is data. A pair that a
        participant judged several times is there once, with the mean; a pair that was not judged is absent.

    Raises
    ------
    GlossError
        The dataset is not whole, or has no pairwise task.

    Examples
    --------
    >>> read_dissimilarities("study").groupby("participant_id").size()  # doctest: +SKIP
    participant_id
    01    378
    """
    rows = [
        (row["participant_id"], *sorted((row["stimulus_left"], row["stimulus_right"])), float(row["dissimilarity"]))
        for table, kind in checked_tables(folder)
        if kind == "pairwise"
        for _, row in table.rows
        if row["dissimilarity"]
    ]
    if not rows:
        raise GlossError(f"The dataset '{folder}' holds no judged pair; run 'gloss session pairwise' into it.")
    keys = ["participant_id", "stimulus_a", "stimulus_b"]
    table = pd.DataFrame(rows, columns=[*keys, "dissimilarity"])
    return table.groupby(keys, as_index=False, sort=True)["dissimilarity"].mean()


def read_magnitudes(folder: str | Path, task: str) -> pd.DataFrame:
    """All ratings of single stimuli in one task, of all participants.

    Parameters
    ----------
    folder
        The dataset. It is validated first.
    task
        The task's name, such as ``"contrast"`` or ``"doi"``.

    Returns
    -------
    DataFrame
        Columns ``participant_id`` (str), ``stimulus`` (str), ``repeat`` (int, from 1, over all sessions of a
        participant), ``rating`` (float, 0–100), sorted by the first three. A trial that was not judged is absent.

    Raises
    ------
    GlossError
        The dataset is not whole, or has no magnitude task of that name.

    Examples
    --------
    >>> read_magnitudes("study", "doi").groupby("stimulus")["rating"].mean()  # doctest: +SKIP
    """
    tables = [table for table, kind in checked_tables(folder) if kind == "magnitude"]
    rows: list[tuple[str | int | float, ...]] = [
        (row["participant_id"], row["stimulus"], row["session"], int(row["repeat"]), float(row["rating"]))
        for table in tables
        for _, row in table.rows
        if row["task"] == task and row["rating"]
    ]
    if not rows:
        there = sorted({row["task"] for table in tables for _, row in table.rows}) or ["none"]
        raise GlossError(
            f"The dataset '{folder}' holds no rating of the task '{task}'; its magnitude tasks are: {', '.join(there)}."
        )
    return _with_repeats_counted_on(rows, "rating", within=["participant_id", "stimulus"])[
        ["participant_id", "stimulus", "repeat", "rating"]
    ]


def read_rankings(folder: str | Path, task: str) -> pd.DataFrame:
    """All ranks of one ranking task, of all participants.

    Parameters
    ----------
    folder
        The dataset. It is validated first.
    task
        The task's name, such as ``"ranking"``.

    Returns
    -------
    DataFrame
        Columns ``participant_id`` (str), ``stimulus`` (str), ``rank`` (int, from 1 at the end labelled low),
        ``repeat`` (int, from 1, over all sessions of a participant), ``reference`` (str, what the set was ranked
        round), sorted by participant, stimulus and repeat. A ranking that was not finished is absent.

    Raises
    ------
    GlossError
        The dataset is not whole, or has no ranking task of that name.

    Examples
    --------
    >>> read_rankings("study", "ranking").groupby("stimulus")["rank"].mean()  # doctest: +SKIP
    """
    tables = [table for table, kind in checked_tables(folder) if kind == "ranking"]
    rows: list[tuple[str | int | float, ...]] = [
        (
            *(row["participant_id"], row["stimulus"], row["session"], int(row["repeat"])),
            *(int(row["rank"]), row["reference"]),
        )
        for table in tables
        for _, row in table.rows
        if row["task"] == task and row["rank"]
    ]
    if not rows:
        there = sorted({row["task"] for table in tables for _, row in table.rows}) or ["none"]
        raise GlossError(
            f"The dataset '{folder}' holds no rank of the task '{task}'; its ranking tasks are: {', '.join(there)}."
        )
    # A ranking stays together, also where the stimuli of the sessions are not the same.
    table = _with_repeats_counted_on(rows, "rank", "reference", within=["participant_id"])
    return table[["participant_id", "stimulus", "rank", "repeat", "reference"]]


def _with_repeats_counted_on(
    rows: list[tuple[str | int | float, ...]], *answers: str, within: Sequence[str]
) -> pd.DataFrame:
    """The rows in order; where somebody had two sessions, the repeats of the second count on, `within` whose those are.

    So (participant, stimulus, repeat) is a key.
    """
    table = pd.DataFrame(rows, columns=["participant_id", "stimulus", "session", "repeat", *answers])
    table["length"] = table["session"].str.len()  # session 10 comes after session 9
    showing = ["length", "session", "repeat"]
    table = table.sort_values(["participant_id", "stimulus", *showing], ignore_index=True)
    if table.groupby("participant_id")["session"].nunique().max() > 1:
        showings = table[[*within, *showing]].drop_duplicates().sort_values([*within, *showing], ignore_index=True)
        showings["place"] = showings.groupby(list(within)).cumcount() + 1
        table["repeat"] = table.merge(showings, on=[*within, *showing], how="left")["place"]
    return table


def tasks_of(folder: str | Path) -> dict[str, TaskKind]:
    """The tasks of a dataset, each with its kind: ``"pairwise"``, ``"magnitude"`` or ``"ranking"``.

    Raises
    ------
    GlossError
        The dataset is not whole.

    Examples
    --------
    >>> tasks_of("study")  # doctest: +SKIP
    {'contrast': 'magnitude', 'doi': 'magnitude', 'pairwise': 'pairwise'}
    """
    kinds = {row["task"]: kind for table, kind in checked_tables(folder) for _, row in table.rows}
    return dict(sorted(kinds.items()))


def simulated_participants(folder: str | Path) -> tuple[str, ...]:
    """Identifiers of the participants whose rows say that a program answered, sorted.

    Raises
    ------
    GlossError
        The dataset is not whole.

    Examples
    --------
    >>> simulated_participants("study")  # doctest: +SKIP
    ('01', '02')
    """
    rows = (row for table, _ in checked_tables(folder) for _, row in table.rows)
    return tuple(sorted({row["participant_id"] for row in rows if row["observer"] == "simulated"}))
