import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from gloss_experiments.design import Trial, session_trials
from gloss_experiments.protocol import Protocol
from gloss_experiments.session.journal import Journal
from gloss_experiments.session.state import Answer, Trace
from glossspace.errors import GlossError

HEADER = {
    "participant": "01",
    "session": "1",
    "seed": 0,
    "protocol_sha256": "p",
    "stimuli_sha256": "s",
    "observer": {"kind": "human"},
}
# A trial's line, as it is written.
WRITTEN = {
    **{"type": "trial", "trial": 1, "block": 1, "repeat": 1, "role": "judged", "stimuli": ["a", "b"], "rating": 5},
    **{"order": None, "response_time_s": 0.5, "timed_out": False, "trace": None, "mode": "screen"},
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
    assert lines[1]["mode"] == "screen"
    with Journal(path) as journal:
        journal.append(ANSWERS[2], mode="simulate")
    assert json.loads(path.read_text(encoding="utf-8").splitlines()[-1])["mode"] == "simulate", "as it was answered"


def test_what_is_written_is_read(path):
    with Journal(path) as journal:
        assert journal.answers == ANSWERS[:2]
        assert not journal.finished
        journal.append(ANSWERS[2], mode="screen")
        journal.finish()
    with Journal(path) as journal:
        assert journal.answers == ANSWERS
        assert journal.finished


def test_every_kind_of_answer_is_read_as_it_was_written(tmp_path):
    trace = Trace(0.7, n_changes=4, n_reversals=1, lowest=10, highest=80, n_frames=90, n_dropped=2, longest_frame_ms=33)
    ranking = Trial(3, 1, 1, ("reference", "a", "b"))
    answers = [
        Answer(Trial(1, 1, 1, ("a", "b"), "practice"), 10, 1.5),
        Answer(Trial(2, 1, 1, ("b", "a"), "practice"), None, 2.0, timed_out=True),
        Answer(Trial(1, 1, 1, ("a", "b")), 20, 1.25, trace=trace),
        Answer(Trial(2, 3, 1, ("b", "a"), "catch"), 30, trace=Trace()),
        Answer(ranking, None, 60.5, order=("b", "a")),
        Answer(Trial(4, 2, 2, ranking.stimuli), None, 60.5, trace=trace, timed_out=True),
    ]
    with Journal(tmp_path / "one.jsonl") as journal:
        journal.begin(HEADER)
        for answer in answers:
            journal.append(answer, mode="screen")
    with Journal(tmp_path / "one.jsonl") as journal:
        assert journal.answers == answers


@pytest.mark.parametrize("task", ["pairwise", "contrast"])
def test_a_journal_of_the_first_version_goes_on(tmp_path, task):
    """The files were written by the first released version, before practice, catch trials and traces were there."""
    old = Path(__file__).parent / "data" / f"version1_{task}.jsonl"
    path = tmp_path / old.name
    path.write_bytes(old.read_bytes())
    with Journal(path) as journal:
        header = journal.header
        assert (header["version"], len(journal.answers), journal.finished) == (1, 12, False)
        protocol = Protocol.model_validate(header["protocol"])
        assert protocol.sha256() == header["protocol_sha256"], "new keys at their defaults do not count"
        grid = [(d, s, a) for d in (0.03, 0.193, 0.767) for s in (0.033, 0.066, 0.099) for a in (0.04, 0.07, 0.1)]
        names = [f"d{d}_s{s}_a{a}" for d, s, a in grid]
        trials = session_trials(protocol, names, seed=header["seed"], participant="03", session="1")
        journal.check_order(trials)
        journal.append(Answer(trials[12], rating=50), mode="headless")
    with Journal(path) as journal:
        assert journal.answers[12] == Answer(trials[12], rating=50)
    assert path.read_bytes().startswith(old.read_bytes()), "what was written stays"


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
        (1, '{"format": "gloss-journal", "version": 3}', "line 1 cannot be read .*version 3; this version reads"),
        (2, "not json", "line 2 cannot be read .JSONDecodeError"),
        (2, '{"type": "trial", "trial": 2, "block": 1, "repeat": 1, "stimuli": ["a"]}', "trial 2 follows trial 0"),
        (3, "", "line 3 cannot be read"),
        (
            2,
            '{"type": "trial", "trial": 1, "block": 1, "repeat": 1, "stimuli": ["a"], "role": "x"}',
            "the role 'x' is none",
        ),
        (
            2,
            '{"type": "trial", "trial": 1, "block": 1, "repeat": 1, "stimuli": ["a"], "rating": null}',
            "rating None is not allowed",
        ),
        *(
            (2, json.dumps(WRITTEN | change), message)
            for change, message in (
                ({"stimuli": "ab"}, "the stimuli 'ab' are no list of names"),
                ({"stimuli": [1, 2]}, r"the stimuli \[1, 2\] are no list of names"),
                ({"timed_out": None}, "timed_out None is neither true nor false"),
                ({"response_time_s": "1.5"}, "the response time '1.5' is no time"),
                ({"response_time_s": -0.5}, "the response time -0.5 is no time"),
                ({"trace": {"n_changes": "two"}}, "n_changes 'two' is no number"),
            )
        ),
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
    imports = "from pathlib import Path\nfrom gloss_experiments.session.journal import Journal\n"
    code = f"{imports}with Journal(Path({str(path)!r})): pass"
    with Journal(path):
        second = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
        assert "Another process is running the session" in second.stderr
        with pytest.raises(GlossError, match="Another process is running the session"), Journal(path):
            pass
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_killed_process_leaves_no_lock(path):
    code = (
        f"import os, signal, pathlib\nfrom gloss_experiments.session.journal import Journal\n"
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


@pytest.mark.skipif(os.name != "posix", reason="folders can be flushed there alone")
def test_each_line_is_on_the_disk_before_the_next_trial(tmp_path, monkeypatch):
    """What has been written is flushed, and before it the names of the new file and of the folders made for it."""
    flushed = []
    real = os.fsync

    def fsync(descriptor):
        real(descriptor)
        flushed.append((os.fstat(descriptor).st_ino, os.fstat(descriptor).st_size))

    monkeypatch.setattr(os, "fsync", fsync)
    path = tmp_path / "dataset" / "journals" / "one.jsonl"
    with Journal(path) as journal:
        folders = (path.parent, path.parent.parent, tmp_path)
        assert {folder.stat().st_ino for folder in folders} == {inode for inode, _ in flushed}
        journal.begin(HEADER)
        for answer in ANSWERS:
            journal.append(answer, mode="screen")
            assert flushed[-1] == (path.stat().st_ino, path.stat().st_size)
        journal.finish()
        assert flushed[-1] == (path.stat().st_ino, path.stat().st_size)


def test_a_journal_that_was_removed_while_it_was_opened_is_not_written(tmp_path, monkeypatch):
    """Another process ends its session that could not begin, and removes the empty file between opening and locking."""
    path = tmp_path / "one.jsonl"

    def try_lock(stream):
        path.unlink()
        return True

    monkeypatch.setattr("gloss_experiments.session.journal.try_lock", try_lock)
    with pytest.raises(GlossError, match="was removed while it was opened; run the command again"), Journal(path):
        pass
