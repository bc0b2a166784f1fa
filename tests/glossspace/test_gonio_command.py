"""What `gloss gonio` does to files that are there."""

import pytest

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
