"""Sessions whose protocol has changed since they began, as the shipped ones did when they gained practice trials."""

import pytest

from gloss_experiments import read_protocol, run_session
from gloss_experiments.protocol import shipped_protocols
from glossspace import cli
from glossspace.errors import GlossError
from tests.experiments.session_files import data_of


@pytest.fixture
def older(tmp_path):
    """The shipped `doi` before it had a preview and practice trials."""
    text = shipped_protocols()["doi"].read_text(encoding="utf-8")
    path = tmp_path / "older.toml"
    path.write_text(text.replace("preview = true", "").replace("practice = 4", ""), encoding="utf-8")
    return path


def test_a_finished_session_stays_finished_when_its_protocol_changes(experiment1, tmp_path, older, capsys):
    words = {"stimuli": experiment1, "dataset": tmp_path / "study", "participant": "01"}
    first = run_session(older, **words)
    before = {path: path.read_bytes() for path in (tmp_path / "study").rglob("*") if path.is_file()}
    again = run_session("doi", **words)
    assert (first.another_protocol, again.already_finished, again.another_protocol) == (False, True, True)
    assert (again.n_trials, again.n_answered, again.n_before, again.summary) == (81, 81, 81, first.summary)
    cli.main(["session", "doi", *(f"--{name}={value}" for name, value in words.items()), "--headless"])
    assert "finished already, under another protocol than this one; nothing was changed" in capsys.readouterr().err
    assert {path: path.read_bytes() for path in (tmp_path / "study").rglob("*") if path.is_file()} == before


def test_a_session_goes_on_with_the_protocol_in_its_journal(experiment1, tmp_path, older):
    def interrupt(done, total):
        if done == 9:
            raise KeyboardInterrupt

    words = {"stimuli": experiment1, "dataset": tmp_path / "a", "participant": "01"}
    with pytest.raises(KeyboardInterrupt):
        run_session(older, on_trial=interrupt, **words)
    journal = tmp_path / "a" / "journals" / "subject-01_session-1_task-doi.jsonl"
    with pytest.raises(GlossError, match="the protocol was changed; to go on .* give its journal in place") as refused:
        run_session("doi", **words)
    assert f"gloss session '{journal}'" in str(refused.value)
    assert run_session(journal, **words).n_before == 9
    run_session(older, **words | {"dataset": tmp_path / "b"})
    assert data_of(tmp_path / "a") == data_of(tmp_path / "b")


@pytest.mark.parametrize("text", ["", "{}\n", "[1]\n", '{"protocol": 3}\n', "\n"])
def test_a_file_that_is_no_journal_holds_no_protocol(tmp_path, text):
    path = tmp_path / "a.jsonl"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(GlossError, match="is no journal of a session"):
        read_protocol(path)
