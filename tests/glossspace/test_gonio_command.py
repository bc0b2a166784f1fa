"""What `gloss gonio` does to files that are there, and to warnings."""

import warnings

import pytest

from glossspace.instruments import goniospectrophotometer
from glossspace.instruments.quadrature import QuadratureWarning

SCAN = ["gonio", "scan", "--brdf", "lambert", "--rho-d", ".4", "--incident", "45", "--step", "85"]
SPECTRUM = ["gonio", "spectrum", "--brdf", "lambert", "--rho-d", ".4", "--step", "100"]


@pytest.mark.parametrize("words", [SCAN, SPECTRUM], ids=["scan", "spectrum"])
def test_of_files_that_are_there_only_a_table_of_its_own_is_replaced(gloss, tmp_path, words):
    out = tmp_path / "table.csv"
    out.write_text("participant_id,rating\n01,7\n")
    code, printed, err = gloss(*words, "--out", str(out))
    assert (code, printed) == (2, "")
    assert err == f"gloss: '{out}' is there and is no scan or spectrum. Choose another name for --out.\n"
    assert out.read_text() == "participant_id,rating\n01,7\n"
    out.unlink()
    contents = []
    for _ in range(2):
        assert gloss(*words, "--out", str(out))[0] == 0
        contents.append(out.read_text())
    assert contents[0] == contents[1]


def test_of_unsure_values_the_worst_is_told_and_other_warnings_go_on(gloss, monkeypatch):
    measured = goniospectrophotometer.mean_over_apertures

    def unsure(*given, **options):
        warnings.warn(QuadratureWarning(0.02), stacklevel=1)
        warnings.warn(QuadratureWarning(0.05), stacklevel=1)
        warnings.warn("of another kind", RuntimeWarning, stacklevel=1)
        return measured(*given, **options)

    monkeypatch.setattr(goniospectrophotometer, "mean_over_apertures", unsure)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        code, _, err = gloss(*SCAN)
    assert code == 0
    assert err.count("to ±5 % only") == 1
    assert {str(one.message) for one in caught} == {"of another kind"}
