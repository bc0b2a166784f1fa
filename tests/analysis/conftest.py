"""The `gloss` command in this process, and judgements for it."""

import pytest

from glossspace import cli
from tests.analysis.studies import STIMULI, judged_by


@pytest.fixture
def gloss(capsys):
    """Run the command in this process: give its exit code, stdout and stderr."""

    def run(*words):
        code = 0
        try:
            cli.main([str(word) for word in words])
        except SystemExit as stop:
            code = stop.code
        return code, *capsys.readouterr()

    return run


@pytest.fixture(autouse=True)
def _nobody_waits(monkeypatch):
    """Keep what is said after two seconds out of stderr: on a clean clone some test compiles the solver."""
    monkeypatch.setattr("glossspace.console._NOTICED_S", 3600)


@pytest.fixture
def refused(gloss):
    """Run a command that must fail as a user's mistake; give its one line."""

    def run(*words):
        code, out, err = gloss(*words, "--json")
        assert code == 2
        assert out == ""
        assert err.startswith("gloss: ")
        assert err.count("\n") == 1
        return err

    return run


@pytest.fixture
def pairs(tmp_path):
    """A long CSV of three simulated participants who judged eight stimuli."""
    data = judged_by([1.4, 1.8, 2.2], exponent=0.8, noise_sd=2.0, integers=True)
    first, second = data.pairs
    rows = ["participant_id,stimulus_a,stimulus_b,dissimilarity"]
    for name, values in zip(data.participants, data.values, strict=True):
        for a, b, value in zip(first, second, values, strict=True):
            if max(a, b) < len(STIMULI):
                rows.append(f"{name},{data.stimuli[a]},{data.stimuli[b]},{value:g}")
    path = tmp_path / "pairs.csv"
    path.write_text("\n".join(rows) + "\n")
    return path
