"""What is said to somebody who waits, and names that could command a terminal."""

import time

import pandas as pd
import pytest

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


@pytest.mark.parametrize("sign", ["\x1b", "\x07", "\x7f", "\x00", "\r", "\x9b"])
def test_names_from_files_do_not_command_the_terminal(capsys, sign):
    console.note(f"No 'a{sign}[2J' here.")
    console.print_table(pd.DataFrame({f"axis{sign}": [f"b{sign}[2J\nc"]}), title=f"of {sign}[2J")
    console.print_text(f"d{sign}[2J", "e")
    out, err = capsys.readouterr()
    assert sign not in out + err
    assert out.endswith("\nd�[2J\ne\n")
    assert err == "No 'a�[2J' here.\n"
