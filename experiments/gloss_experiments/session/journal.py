"""The journal of a session: one flushed line a trial, so that a kill at any moment loses at most the trial on screen.

A journal is a file of JSON lines. The first is the header: what the session is, with the seed and the hashes that fix
its order and its images. Then comes one line a trial, those of practice and catch trials too, and a last one when the
session is finished. Lines are appended, never changed. The operating system holds a lock on the file while a session
writes it.
"""

import contextlib
import json
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from io import FileIO
from pathlib import Path
from types import TracebackType
from typing import Any

from gloss_experiments.design import Trial
from gloss_experiments.session.journal_content import FORMAT, VERSION, parse_journal
from gloss_experiments.session.state import Answer
from glossspace.dataset.lock import try_lock
from glossspace.errors import GlossError

__all__ = ["FORMAT", "Journal", "journal_path"]

# What must not change between the two parts of an interrupted session, and how the user undoes a change.
_FIXED = {
    "participant": "this is another participant's session",
    "session": "this is another session",
    "seed": "give the seed the session began with, or none",
    "protocol_sha256": "the protocol was changed; to go on with the one the session began with, give its journal in "
    "place of the protocol: gloss session '{journal}' with the same options",
    "stimuli_sha256": "the images were changed; go back to the stimulus set the session began with",
    "observer": "an observer cannot change within a session",
}
_WAY_OUT = "or begin anew under another session number"


def journal_path(dataset: str | Path, *, participant: str, session: str, task: str) -> Path:
    """Path of the journal of one session, beside the data that are made from it."""
    return Path(dataset) / "journals" / f"subject-{participant}_session-{session}_task-{task}.jsonl"


@dataclass
class Journal:
    """An open, locked journal; use it in a ``with`` statement.

    Attributes
    ----------
    header
        The header on the disk, None in a new journal.
    answers
        The trials answered so far, those of practice first.
    finished
        Whether the session is complete.
    torn
        Whether the last line was torn by a kill or a crash, and has been cut off.
    """

    path: Path
    header: dict[str, Any] | None = None
    answers: list[Answer] = field(default_factory=list)
    finished: bool = False
    torn: bool = False
    _made_folders: list[Path] = field(default_factory=list, repr=False)
    _stream: FileIO = field(init=False, repr=False)

    def __enter__(self) -> "Journal":
        try:
            return self._opened()
        except OSError as error:
            self._remove_made_folders()
            raise GlossError(
                f"Cannot open the journal '{self.path}': {error.strerror or error}. Give a dataset folder that can be "
                "written to."
            ) from None

    def _opened(self) -> "Journal":
        self._made_folders = [folder for folder in self.path.parents[:2] if not folder.exists()]
        self.path.parent.mkdir(parents=True, exist_ok=True)
        new = not self.path.exists()
        # Unbuffered: what the system has not taken is never written later, behind the back of an error.
        self._stream = self.path.open("a+b", buffering=0)
        try:
            if not try_lock(self._stream):
                raise GlossError(
                    f"Another process is running the session of '{self.path}'. Let it end, then try again."
                )
            if not _is_still_at(self.path, self._stream):
                raise GlossError(f"The journal '{self.path}' was removed while it was opened; run the command again.")
            if new:
                for folder in (self.path.parent, *(made.parent for made in self._made_folders)):
                    _flush_folder(folder)
            self._load()
        except BaseException:
            self._stream.close()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.header is not None:
            self._stream.close()
            return
        # A session that could not begin leaves nothing behind. Where an open file can be removed, it is removed under
        # its lock; Windows cannot, and there refuses to remove one that another process has opened meanwhile.
        with contextlib.suppress(OSError):
            if os.name == "posix":
                self.path.unlink(missing_ok=True)
            self._stream.close()
            if os.name != "posix":
                self.path.unlink(missing_ok=True)
            self._remove_made_folders()

    def _remove_made_folders(self) -> None:
        with contextlib.suppress(OSError):  # they hold something by now, or were never made
            for folder in self._made_folders:
                folder.rmdir()

    def begin(self, header: Mapping[str, Any]) -> None:
        """Write the header of a new journal.

        Raises
        ------
        GlossError
            It cannot be written.
        """
        line = {"type": "header", "format": FORMAT, "version": VERSION, **header}
        self._append(line)
        self.header = line

    def check(self, wanted: Mapping[str, Any]) -> None:
        """Check that the session on the disk is the one that is `wanted`.

        Raises
        ------
        GlossError
            It was begun with another seed, protocol or observer, or with other images.
        """
        begun = self.header or {}
        for key, advice in _FIXED.items():
            if begun.get(key) != wanted.get(key):
                raise GlossError(
                    f"The session in '{self.path}' was begun with {key} {_short(begun.get(key))}, "
                    f"but {_short(wanted.get(key))} is asked for: {advice.format(journal=self.path)}, {_WAY_OUT}."
                )

    def append(self, answer: Answer, *, mode: str) -> None:
        """Write one trial, answered or timed out, and flush it to the disk.

        Raises
        ------
        GlossError
            The disk is full or gone: what was written before stays.
        """
        self._append(
            {
                "type": "trial",
                "trial": answer.trial.number,
                "block": answer.trial.block,
                "repeat": answer.trial.repeat,
                "role": answer.trial.role,
                "stimuli": list(answer.trial.stimuli),
                "rating": answer.rating,
                "order": None if answer.order is None else list(answer.order),
                "response_time_s": answer.response_time_s,
                "timed_out": answer.timed_out,
                "trace": None if answer.trace is None else asdict(answer.trace),
                "mode": mode,
            }
        )
        self.answers.append(answer)

    def note(self, kind: str, **details: Any) -> None:
        """Write a line that is no trial, such as a resumption with the versions of then."""
        self._append({"type": kind, **details})

    def finish(self) -> None:
        """Mark the session as complete."""
        if not self.finished:
            self._append({"type": "finished", "n_trials": len(self.answers)})
            self.finished = True

    def check_order(self, trials: tuple[Trial, ...]) -> None:
        """Check that what was judged is the beginning of `trials`.

        Raises
        ------
        GlossError
            Another order: another version of this program or of numpy drew it.
        """
        judged = tuple(answer.trial for answer in self.answers)
        if judged != trials[: len(judged)]:
            raise GlossError(
                f"The trials in '{self.path}' are not in the order that this version draws from their seed. "
                f"Resume it with the versions in its header, {_WAY_OUT}."
            )

    def _append(self, line: dict[str, Any]) -> None:
        end = self._stream.seek(0, os.SEEK_END)
        content = json.dumps(line, ensure_ascii=False, allow_nan=False).encode("utf-8") + b"\n"
        try:
            while content:
                content = content[self._stream.write(content) :]
            os.fsync(self._stream.fileno())
        except OSError as error:
            with contextlib.suppress(OSError):  # else the torn line is cut off when the session is resumed
                self._stream.truncate(end)
            raise GlossError(
                f"Cannot write to the journal '{self.path}': {error.strerror or error}. The {len(self.answers)} trials "
                "judged so far are safe in it. Make room on the disk, then run the same command to go on."
            ) from None

    def _load(self) -> None:
        self._stream.seek(0)
        content = parse_journal(self._stream.read(), path=self.path)
        if content.torn:
            self._stream.truncate(content.n_whole_bytes)
        self.header, self.answers = content.header, content.answers
        self.finished, self.torn = content.finished, content.torn


def _is_still_at(path: Path, stream: FileIO) -> bool:
    # Between opening and locking it, another process may have removed its empty journal, and this one with it.
    try:
        return os.path.samestat(path.stat(), os.fstat(stream.fileno()))
    except FileNotFoundError:
        return False


def _short(value: object) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else text[:12] + "…"


def _flush_folder(folder: Path) -> None:
    """Make the new file's name last through a power cut, where the system lets a folder be flushed (not Windows)."""
    if os.name != "posix":
        return
    descriptor = os.open(folder, os.O_RDONLY)
    with contextlib.suppress(OSError):  # some network file systems refuse; the file itself is flushed all the same
        os.fsync(descriptor)
    os.close(descriptor)
