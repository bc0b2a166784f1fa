"""The file of measurements: what is written comes back, and nothing is written that is no number."""

import csv
import math
from pathlib import Path

import pytest

from gloss_stimuli.measurements import COLUMNS, write_measurements


def test_rows_come_back_and_what_does_not_exist_is_empty(tmp_path: Path) -> None:
    rows = [dict.fromkeys(COLUMNS), dict.fromkeys(COLUMNS, 1 / 3)]
    rows[0]["stimulus"], rows[1]["stimulus"] = "a", "b"
    write_measurements(tmp_path / "measurements.csv", rows)
    with (tmp_path / "measurements.csv").open(encoding="utf-8", newline="") as file:
        empty, full = csv.DictReader(file)
    assert empty == {"stimulus": "a"} | {name: "" for name in COLUMNS if name != "stimulus"}
    assert full == {"stimulus": "b"} | {name: "0.3333333" for name in COLUMNS if name != "stimulus"}


def test_a_value_that_is_not_finite_is_not_written(tmp_path: Path) -> None:
    row = {**dict.fromkeys(COLUMNS), "scene_luminance_ratio": math.nan}
    with pytest.raises(FloatingPointError, match="scene_luminance_ratio is nan; what does not exist must be None"):
        write_measurements(tmp_path / "measurements.csv", [row])
    assert list(tmp_path.iterdir()) == []


def test_a_row_of_other_columns_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="have other columns than stimulus, .*: stimulus, c"):
        write_measurements(tmp_path / "measurements.csv", [{"stimulus": "a", "c": 1.0}])
