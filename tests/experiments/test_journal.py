import json
import signal
import subprocess
import sys

import pytest

from gloss_experiments.design import Trial
from gloss_experiments.journal import Journal
from gloss_experiments.session import Answer
from glossspace.errors import GlossError

HEADER = {
    "participant": "01",
    "session": "1",
    "seed": 0,
    "protocol_sha256": "p",
    "stimuli_sha256": "s",
    "observer": {"kind": "human"},
}
ANSWERS = [Answer(Trial(i, 1, 1, ("a", "b")), rating=10 * i, response_time_s=0.5) for i in (1, 2, 3)]


@pytest.fixture
def path(tmp_path):
    """Journal of two judged trials."""
    path = tmp_path / "journals" / "one.jsonl"
    with Journal(path) as journal:
        journal.begin(HEADER)
        for answer in ANSWERS[:2]:
            journal.append(answer, mode="screen")
    return path


def test_one_line_a_trial(path):
    lines = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    assert [line["type"] for line in lines] == ["header", "trial", "trial"]
    assert lines[1]["stimuli"] == ["a", "b"]


def test_what_is_written_is_read(path):
    with Journal(path) as journal:
        assert journal.answers == ANSWERS[:2]
        assert not journal.finished
        journal.append(ANSWERS[2], mode="screen")
        journal.finish()
    with Journal(path) as journal:
        assert journal.answers == ANSWERS
        assert journal.finished


@pytest.mark.parametrize("kept", [1, 20, 60])
def test_a_torn_last_line_is_cut_off(path, kept):
    whole = path.read_bytes()
    last = whole.splitlines(keepends=True)[-1]
    path.write_bytes(whole[: -len(last) + kept])
    with Journal(path) as journal:
        assert journal.torn
        assert journal.answers == ANSWERS[:1]
        journal.append(ANSWERS[1], mode="screen")
    assert path.read_bytes() == whole


def test_a_torn_header_begins_anew(path):
    path.write_bytes(path.read_bytes()[:30])
    with Journal(path) as journal:
        assert (journal.torn, journal.header, journal.answers) == (True, None, [])
        journal.begin(HEADER)
    with Journal(path) as journal:
        assert journal.header["participant"] == "01"


@pytest.mark.parametrize(
    ("line", "text", "message"),
    [
        (1, "{}", "line 1 cannot be read .KeyError: 'format'"),
        (1, '{"format": "gloss-journal", "version": 2}', "line 1 cannot be read .*version 2; this version reads"),
        (2, "not json", "line 2 cannot be read .JSONDecodeError"),
        (2, '{"type": "trial", "trial": 2, "block": 1, "repeat": 1, "stimuli": ["a"]}', "trial 2 follows trial 0"),
        (3, "", "line 3 cannot be read"),
    ],
)
def test_a_damaged_journal_is_refused(path, line, text, message):
    lines = path.read_text(encoding="utf-8").splitlines()
    lines[line - 1] = text
    path.write_text("\n".join([*lines, ""]), encoding="utf-8")
    before = path.read_bytes()
    with pytest.raises(GlossError, match=message), Journal(path):
        pass
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    ("key", "value"),
    [("seed", 7), ("protocol_sha256", "q"), ("stimuli_sha256", "t"), ("observer", {"kind": "simulated"})],
)
def test_another_session_is_refused(path, key, value):
    with Journal(path) as journal, pytest.raises(GlossError, match=f"was begun with {key} .*begin anew under another"):
        journal.check({**HEADER, key: value})


def test_another_order_is_refused(path):
    with Journal(path) as journal, pytest.raises(GlossError, match="not in the order that this version draws"):
        journal.check_order((Trial(1, 1, 1, ("b", "a")),))


def test_two_processes_cannot_write_one_session(path):
    code = (
        f"from gloss_experiments.journal import Journal\nwith Journal(__import__('pathlib').Path({str(path)!r})): pass"
    )
    with Journal(path):
        second = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
        assert "Another process is running the session" in second.stderr
        with pytest.raises(GlossError, match="Another process is running the session"), Journal(path):
            pass
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_killed_process_leaves_no_lock(path):
    code = (
        f"import os, signal, pathlib\nfrom gloss_experiments.journal import Journal\n"
        f"with Journal(pathlib.Path({str(path)!r})): os.kill(os.getpid(), signal.SIGKILL)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == -signal.SIGKILL
    with Journal(path) as journal:
        assert journal.answers == ANSWERS[:2]


def test_a_journal_that_never_began_leaves_nothing(tmp_path):
    with Journal(tmp_path / "study" / "journals" / "one.jsonl"):
        pass
    assert list(tmp_path.iterdir()) == []


def test_a_journal_that_cannot_be_made_leaves_nothing(tmp_path):
    with pytest.raises(GlossError, match="Cannot open the journal"), Journal(tmp_path / "study" / "j" / ("a" * 300)):
        pass
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_keeps_what_is_written(path):
    """A limit on the size of files stands in for a full disk: the system takes part of the line, then refuses."""
    resource = pytest.importorskip("resource", reason="Windows has no such limit")
    before = path.read_bytes()
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    try:
        with Journal(path) as journal:
            resource.setrlimit(resource.RLIMIT_FSIZE, (len(before) + 40, hard))
            with pytest.raises(GlossError, match=r"Cannot write to the journal .* The 2 trials judged so far are safe"):
                journal.append(ANSWERS[2], mode="screen")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        signal.signal(signal.SIGXFSZ, handler)
    assert path.read_bytes() == before
    with Journal(path) as journal:
        assert journal.answers == ANSWERS[:2]
