"""What is said to somebody who waits."""

import time

from glossspace import console


def test_slow_work_is_announced_and_quick_work_is_not(capsys, monkeypatch):
    monkeypatch.setattr(console, "_NOTICED_S", 0.01)
    with console.noted_if_slow("Fitting."):
        deadline = time.monotonic() + 30
        err = ""
        while not err and time.monotonic() < deadline:
            time.sleep(0.01)
            err = capsys.readouterr().err
    assert err == "Fitting.\n"
    monkeypatch.setattr(console, "_NOTICED_S", 3600)
    with console.noted_if_slow("Fitting."):
        pass
    assert capsys.readouterr() == ("", "")
