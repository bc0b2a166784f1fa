"""``gloss dataset``: check a dataset, make its data files anew from the journals, export it as BIDS."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path

from cyclopts import App
from rich.progress import TaskID

from glossspace.console import JsonFlag, note, print_json, print_text, progress_bar
from glossspace.errors import GlossError

__all__ = ["dataset"]

dataset = App(
    name="dataset",
    help="Check a dataset against its journals, make its data files anew from them, or export it as BIDS.",
    help_format="plaintext",
    help_epilogue="""
Examples:

    gloss dataset check study/dataset

    gloss dataset rebuild study/dataset

    gloss dataset export-bids study/dataset --out study/bids
""",
)


@dataset.command(help_epilogue="")
def check(folder: Path, /, *, stimuli: Path | None = None, json: JsonFlag = False) -> None:
    """Check a dataset: its own rules, the data against the journals, the order of trials against the protocol.

    Columns and their description agree both ways; names, ranges, duplicates and
    ranks are looked at; each order is drawn anew from the seed in its journal and
    compared; data files are made anew from the journals and compared; pilots stand
    apart; a stimulus had one image in all sessions. Each problem is one line, and
    the exit code is 2 if there is any.

    Examples:

        gloss dataset check study/dataset

        gloss dataset check study/dataset --stimuli study/stimuli/experiment1 --json

    Parameters
    ----------
    folder
        The dataset.
    stimuli
        Folder of the stimulus set that was shown: its images must be those of the sessions.
    """
    from gloss_experiments.datasets.dataset_check import check_dataset
    from glossspace.stimulus_set import read_stimulus_set

    shown = None if stimuli is None else read_stimulus_set(stimuli)
    with _progress("Journals") as on_journal:
        found = check_dataset(folder, stimuli=shown, on_journal=on_journal)
    if json:
        print_json({"dataset": str(folder), "whole": not found.problems} | asdict(found))
    else:
        for problem in found.problems:
            print_text(problem)
        if not found.problems:
            print(
                f"'{folder}' is whole: {found.n_data_files} data files, {found.n_journals} journals, "
                f"{found.n_pilots} pilots."
            )
        for remark in found.remarks:
            note(remark)
    if found.problems:
        n_problems = f"{len(found.problems)} problem{'s' if len(found.problems) > 1 else ''}"
        raise GlossError(f"{n_problems} in the dataset '{folder}'. Each line on stdout says what is to be done.")


@dataset.command(help_epilogue="")
def rebuild(folder: Path, /, *, json: JsonFlag = False) -> None:
    """Make the data files of a dataset anew from its complete journals.

    A data file that is there is compared and never changed. Sessions that are not
    finished are listed and left, and so are journals that cannot be read. The exit
    code is 2 if there is one of these, or a data file that differs from its journal.

    Examples:

        gloss dataset rebuild study/dataset

        gloss dataset rebuild study/dataset --json

    Parameters
    ----------
    folder
        The dataset.
    json
        Print one JSON document and nothing else.
    """
    from gloss_experiments.datasets.rebuild import rebuild_dataset

    with _progress("Sessions") as on_session:
        sessions = rebuild_dataset(folder, on_session=on_session)
    differing = [one for one in sessions if one.outcome == "differs"]
    unreadable = [one for one in sessions if one.outcome == "unreadable"]
    if json:
        rows = [
            asdict(one) | {"journal": str(one.journal), "data": None if one.data is None else str(one.data)}
            for one in sessions
        ]
        print_json({"dataset": str(folder), "sessions": rows})
    else:
        words = {
            "made": "made",
            "same": "there already, the same",
            "differs": "DIFFERS from its journal and was left as it is",
            "unreadable": "NOT READ",
        }
        for one in sessions:
            pilot = " (pilot)" if one.pilot else ""
            unfinished = f"not finished, {one.n_answered} of {one.n_trials} trials: no data file"
            problem = "" if one.problem is None else f" {one.problem}"
            print_text(f"{one.name}{pilot}: {words.get(one.outcome, unfinished)}.{problem}")
    if unreadable:
        raise GlossError(
            f"{len(unreadable)} of {len(sessions)} journals cannot be read, first '{unreadable[0].journal}': "
            f"{unreadable[0].problem} All others were taken."
        )
    if differing:
        raise GlossError(
            f"{len(differing)} data file{'s differ' if len(differing) > 1 else ' differs'} from the journal, first "
            f"'{differing[0].data}'. `gloss dataset check` says where; move it away and run this again to restore it."
        )


@dataset.command(name="export-bids", help_epilogue="")
def export_bids(folder: Path, /, *, out: Path, json: JsonFlag = False) -> None:
    """Export a dataset as BIDS behavioural data. Pilots stay behind.

    Examples:

        gloss dataset export-bids study/dataset --out study/bids

    Parameters
    ----------
    folder
        The dataset; it must be whole.
    out
        Folder to make; it must not exist or be empty.
    """
    from gloss_experiments.datasets.journalled_session import read_session
    from gloss_experiments.datasets.rebuild import journal_files
    from glossspace.dataset.bids import TaskTexts, export_bids

    texts = {}
    for path in journal_files(folder):
        try:
            session = read_session(path)
        except GlossError as error:
            note(f"What its observers read is left out of the export: {error}")
            continue
        words = session.protocol.texts
        texts[session.task] = TaskTexts(description=words.question, instructions=words.instructions)
    exported = export_bids(folder, out, texts=texts)
    if json:
        print_json({"bids": str(exported.folder), "participants": exported.participants, "files": exported.n_files})
    else:
        print(
            f"{exported.n_files} files of {len(exported.participants)} participants in '{exported.folder}' "
            f"(BIDS {exported.bids_version})."
        )


@contextmanager
def _progress(what: str) -> Iterator[Callable[[int, int], None]]:
    with progress_bar() as progress:
        bar: TaskID | None = None

        def show(done: int, total: int) -> None:
            nonlocal bar
            if bar is None:
                bar = progress.add_task(what, total=total)
            progress.update(bar, completed=done)

        yield show
