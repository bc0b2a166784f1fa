"""Data cannot be collected twice: sessions that are killed, starved of disk or run twice lose and spoil nothing.

A power cut is not among the tests: what the system has taken survives a kill, flushed or not. That each line is flushed
before the next trial is for `test_journal`.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from gloss_experiments import read_protocol, run_session
from gloss_experiments.datasets.dataset_check import check_dataset
from gloss_experiments.datasets.rebuild import rebuild_dataset
from gloss_experiments.session.journal import Journal, journal_path
from gloss_experiments.session.journal_content import read_journal
from glossspace.errors import GlossError

PROGRAM = Path(__file__).with_name("killed_sessions.py")

posix = pytest.mark.skipif(os.name != "posix", reason="forks, and limits on files, are of POSIX systems")


BRIEF = """
format = 1
name = "brief"
kind = "magnitude"
[design]
repeats = 3
practice = 2
catch_trials = 2
[slider]
low_label = "dull"
high_label = "glossy"
[texts]
question = "How glossy?"
instructions = "Look."
"""


def visible_files(dataset):
    """All but journals, which tell of each resumption with its time, and hidden files, such as locks."""
    files = (path for path in sorted(dataset.rglob("*")) if path.is_file())
    names = ((path.relative_to(dataset), path) for path in files)
    return {
        name.as_posix(): path.read_bytes()
        for name, path in names
        if "journals" not in name.parts and not any(part.startswith(".") for part in name.parts)
    }


def killed(tmp_path, **request):
    # The name of a dataset stands in its description, so both have the same.
    folders = {"broken": str(tmp_path / "broken" / "study"), "unbroken": str(tmp_path / "unbroken" / "study")}
    command = [sys.executable, str(PROGRAM), json.dumps(request | folders)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout), Path(folders["broken"]), Path(folders["unbroken"])


@posix
def test_a_session_killed_50_times_equals_an_unbroken_one(experiment1, tmp_path):
    found, broken, unbroken = killed(
        tmp_path,
        protocol="pairwise",
        stimuli=str(experiment1),
        moments=["start", "first"],
        seed=1,
        kills=50,
        # A trial takes 10 ms and more, and there are 378 and practice: 50 kills within 80 ms each come before the end.
        pause_s=0.01,
        longest_s=0.08,
    )
    assert found == {"kills": 50, "lost": 0, "participants": ["01"]}
    assert visible_files(broken) == visible_files(unbroken)
    assert check_dataset(broken).problems == ()
    assert {one.outcome for one in rebuild_dataset(broken)} == {"same"}


@posix
def test_short_sessions_killed_at_any_moment_their_publishing_included(small_set, tmp_path):
    """As many sessions of a few trials as it takes for 50 kills, a third of them after the last trial."""
    protocol = tmp_path / "brief.toml"
    protocol.write_text(BRIEF, "utf-8")
    found, broken, unbroken = killed(
        tmp_path,
        protocol=str(protocol),
        stimuli=str(small_set),
        moments=["start", "first", "last"],
        seed=2,
        kills=50,
        pause_s=0.0,
        longest_s=0.02,
    )
    assert (found["kills"], found["lost"]) == (50, 0)
    assert visible_files(broken) == visible_files(unbroken)
    assert check_dataset(broken).problems == ()


def test_the_last_line_may_be_torn_anywhere(small_set, tmp_path):
    """Every byte at which a kill can cut the journal's last lines leads to the data of an unbroken session."""
    whole = run_session("doi", stimuli=small_set, dataset=tmp_path / "a" / "study", participant="01")
    wanted = visible_files(tmp_path / "a" / "study")
    content = whole.journal_path.read_bytes()
    last_lines = len(b"".join(content.splitlines(keepends=True)[-2:]))
    assert read_journal(whole.journal_path).finished
    for cut in range(1, last_lines + 1, 3):
        whole.data_path.unlink(missing_ok=True)
        whole.journal_path.write_bytes(content[:-cut])
        again = run_session("doi", stimuli=small_set, dataset=tmp_path / "a" / "study", participant="01")
        assert again.n_before in (8, 9)
        assert visible_files(tmp_path / "a" / "study") == wanted


def gloss(*words):
    command = [sys.executable, "-c", "from glossspace.cli import main; main()", "session", *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def doi_session(stimuli, dataset, **options):
    return run_session("doi", stimuli=stimuli, dataset=dataset, participant="01", **options)


def doi_journal(dataset):
    return journal_path(dataset, participant="01", session="1", task="doi")


@pytest.fixture
def unbroken(experiment1, tmp_path):
    """The dataset of one session that nothing befell."""
    doi_session(experiment1, tmp_path / "unbroken" / "study")
    return tmp_path / "unbroken" / "study"


@pytest.fixture
def small_disk(tmp_path):
    """A file system of 256 KiB in memory, where the tests may mount one."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=256k", "glossspace-test", str(folder)]
    try:
        mounted = subprocess.run(mount, capture_output=True, check=False).returncode == 0
    except FileNotFoundError:
        mounted = False
    if not mounted:
        pytest.skip("no right to mount a file system; a limit on the size of files stands in for it below")
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


def fill(disk, *, leaving):
    """Occupy the disk but for `leaving` bytes."""
    free = os.statvfs(disk).f_bavail * os.statvfs(disk).f_frsize
    (disk / "ballast").write_bytes(b"\0" * (free - leaving))


def assert_stopped_on_the_way(dataset, message, reason):
    """The journal holds whole lines alone, the message counts them, and no data file was begun."""
    content = read_journal(doi_journal(dataset))
    assert not content.torn
    assert not content.finished
    assert len(content.answers) > 0
    assert f"{reason}. The {len(content.answers)} trials judged so far are safe in it. Make room on the disk" in message
    assert not list(dataset.rglob("*_data.csv"))


@pytest.mark.parametrize("share", [0.1, 0.5, 0.8])
def test_a_full_disk_stops_a_session_that_then_goes_on(experiment1, unbroken, small_disk, share):
    dataset = small_disk / "study"
    # Room for two files of a page of 4 KiB each, which come before the journal, and for a share of the trials in it.
    header, trials = doi_journal(unbroken).read_bytes().split(b"\n", 1)
    fill(small_disk, leaving=2 * 4096 + (int(len(header) + share * len(trials)) // 4096 + 1) * 4096)
    with pytest.raises(GlossError, match=r"Cannot write to the journal .*then run the same command to go on") as error:
        doi_session(experiment1, dataset)
    assert_stopped_on_the_way(dataset, str(error.value), "No space left on device")
    (small_disk / "ballast").unlink()
    assert doi_session(experiment1, dataset).n_before > 0
    assert visible_files(dataset) == visible_files(unbroken)


@pytest.mark.parametrize("missing", [1, 3000])
def test_a_disk_that_is_full_when_the_data_are_written(experiment1, unbroken, small_disk, missing):
    """The journal is complete, and its data file finds no room: the disk lacks `missing` bytes of it at least."""
    dataset = small_disk / "study"
    data_file = doi_session(experiment1, dataset).data_path
    size = data_file.stat().st_size
    data_file.unlink()
    # A tmpfs counts whole pages: what is left is the number of those that fit below the missing bytes.
    fill(small_disk, leaving=(size - missing) // 4096 * 4096)
    with pytest.raises(GlossError, match=r"Cannot write .*_data\.csv': No space left on device"):
        doi_session(experiment1, dataset)
    assert read_journal(doi_journal(dataset)).finished
    assert not list(dataset.rglob("*_data.csv"))
    (small_disk / "ballast").unlink()
    doi_session(experiment1, dataset)
    assert visible_files(dataset) == visible_files(unbroken)


@posix
@pytest.mark.parametrize("share", [0.3, 0.8])
def test_a_limit_on_the_size_of_files_stops_a_session_that_then_goes_on(experiment1, unbroken, tmp_path, share):
    """It stands in for a full disk where no file system can be mounted: the system takes a part of a line."""
    import resource
    import signal

    dataset = tmp_path / "broken" / "study"
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (int(share * doi_journal(unbroken).stat().st_size), hard))
        with pytest.raises(GlossError, match="Cannot write to the journal") as error:
            doi_session(experiment1, dataset)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        signal.signal(signal.SIGXFSZ, handler)
    assert_stopped_on_the_way(dataset, str(error.value), "File too large")
    doi_session(experiment1, dataset)
    assert visible_files(dataset) == visible_files(unbroken)


def test_the_command_tells_of_a_full_disk_in_one_line(experiment1, small_disk):
    fill(small_disk, leaving=32768)
    words = ("pairwise", "--stimuli", experiment1, "--participant", "01", "--headless")
    stopped = gloss(*words, "--dataset", small_disk / "study")
    assert stopped.returncode == 2
    assert "gloss: Cannot write to the journal" in stopped.stderr
    assert "Traceback" not in stopped.stderr


def test_two_processes_cannot_write_one_session(experiment1, unbroken, tmp_path):
    """The second is refused while the first judges, changes nothing, and the first ends undisturbed."""
    dataset = tmp_path / "broken" / "study"
    refused = []

    def meanwhile(done, total):
        if done == 40:
            words = ("doi", "--stimuli", experiment1, "--participant", "01", "--headless")
            before = doi_journal(dataset).read_bytes()
            refused.append(gloss(*words, "--dataset", dataset))
            assert doi_journal(dataset).read_bytes() == before

    doi_session(experiment1, dataset, on_trial=meanwhile)
    assert [second.returncode for second in refused] == [2]
    assert "Another process is running the session" in refused[0].stderr
    assert visible_files(dataset) == visible_files(unbroken)


def test_who_is_refused_the_lock_changes_nothing(experiment1, tmp_path):
    run_session("doi", stimuli=experiment1, dataset=tmp_path, participant="01")
    path = journal_path(tmp_path, participant="01", session="1", task="doi")
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    with Journal(path), pytest.raises(GlossError, match="Another process is running the session"):
        run_session("doi", stimuli=experiment1, dataset=tmp_path, participant="01")
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({}, None),
        ({"seed": 9}, "was begun with seed 0, but 9 is asked for"),
        ({"protocol": "other"}, None),
        ({"mode": "screen"}, "is simulated|was begun with observer"),
    ],
)
def test_a_finished_session_cannot_be_overwritten(small_set, tmp_path, change, message):
    run_session("doi", stimuli=small_set, dataset=tmp_path, participant="01")
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    doi = read_protocol("doi")
    other = doi.model_copy(update={"slider": doi.slider.model_copy(update={"low_label": "dull"})})
    again = {"protocol": doi, "mode": "headless", **change}
    again["protocol"] = other if again["protocol"] == "other" else doi
    if message is None:
        assert run_session(**again, stimuli=small_set, dataset=tmp_path, participant="01").already_finished
    else:
        with pytest.raises(GlossError, match=message):
            run_session(**again, stimuli=small_set, dataset=tmp_path, participant="01")
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before
