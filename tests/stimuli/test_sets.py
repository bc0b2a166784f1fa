from pathlib import Path

import pytest

from gloss_stimuli.sets import read_stimulus_list, shipped_sets
from glossspace.errors import GlossError

# Gloss paper 3.2.3.1 and 3.3.3.1, and the published choice of eleven roughnesses.
PAPER_RHO_D, PAPER_RHO_S, PAPER_ALPHA = (0.03, 0.193, 0.767), (0.033, 0.066, 0.099), (0.04, 0.07, 0.10)
CONTRAST_RHO_D, CONTRAST_RHO_S = {0.03, 0.087, 0.193, 0.420, 0.767}, {0.017, 0.033, 0.050, 0.066, 0.083, 0.099}
DOI_ALPHA = [0.01, 0.025, 0.04, 0.055, 0.07, 0.085, 0.10, 0.12, 0.145, 0.17, 0.19]


def parameters(name: str) -> list[tuple[float, float, float]]:
    return [(s.rho_d, s.rho_s, s.alpha) for s in read_stimulus_list(name).stimuli]


def test_experiment1_is_the_full_factorial_of_the_paper() -> None:
    assert set(parameters("experiment1")) == {(d, s, a) for d in PAPER_RHO_D for s in PAPER_RHO_S for a in PAPER_ALPHA}
    assert len(parameters("experiment1")) == 27


def test_contrast_is_24_of_the_30_and_holds_experiment1s_nine() -> None:
    chosen = set(parameters("contrast"))
    assert len(parameters("contrast")) == len(chosen) == 24
    assert chosen <= {(d, s, 0.04) for d in CONTRAST_RHO_D for s in CONTRAST_RHO_S}
    assert {(d, s, 0.04) for d in PAPER_RHO_D for s in PAPER_RHO_S} <= chosen
    assert {d for d, _, _ in chosen} == CONTRAST_RHO_D
    assert {s for _, s, _ in chosen} == CONTRAST_RHO_S


def test_doi_varies_alpha_alone() -> None:
    assert parameters("doi") == [(0.03, 0.099, alpha) for alpha in DOI_ALPHA]


def test_shipped_names_match_their_files() -> None:
    assert shipped_sets() == ("contrast", "doi", "experiment1")
    assert all(read_stimulus_list(name).name == name for name in shipped_sets())


def test_a_csv_may_order_its_columns_and_add_others(tmp_path: Path) -> None:
    path = tmp_path / "my paints.csv"
    path.write_text("note,alpha, rho_s,rho_d\nmatt,0.19,0.02,0.5\n", encoding="utf-8-sig")
    read = read_stimulus_list(path)
    assert read.name == "my-paints"
    assert [(s.rho_d, s.rho_s, s.alpha) for s in read.stimuli] == [(0.5, 0.02, 0.19)]


def test_a_toml_joins_grids_and_single_stimuli(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(
        'format = "glossspace/stimulus-list"\nversion = 1\nname = "mine"\n'
        "[[grid]]\nrho_d = [0.0, 0.5]\nrho_s = [0.1]\nalpha = [0.05]\n"
        "[[stimulus]]\nrho_d = 0\nrho_s = 0\nalpha = 0.3\n",
        encoding="utf-8",
    )
    assert [s.name for s in read_stimulus_list(path).stimuli] == ["d0_s0.1_a0.05", "d0.5_s0.1_a0.05", "d0_s0_a0.3"]


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("0.95,0.06,0.04", r"line 2: rho_d \+ rho_s must be at most 1, but 0.95 \+ 0.06 = 1.01"),
        ("0.03,0.099,0.04\n-0.1,0.06,0.04", r"line 3: rho_d must be at least 0, but is -0.1"),
        ("0.03,-0.01,0.04", r"line 2: rho_s must be at least 0, but is -0.01"),
        ("0.03,0.099,0", r"line 2: alpha must be above 0, but is 0"),
        ("0.03,0.099,nan", r"line 2: alpha must be a finite number, but is nan"),
        ("0.03,inf,0.04", r"line 2: rho_s must be a finite number, but is inf"),
        ("0.03,shiny,0.04", r"line 2: rho_s must be a number, but is 'shiny'"),
        ("0.03,0.099", r"line 2: 2 cells, but the header names 3 columns"),
        ("0.03,0.099,0.04\n0.030,0.0990,0.040", r"line 3: d0.03_s0.099_a0.04 is already there \(line 2\)"),
        ("0.03,0.099,0.04,7", r"line 2: 4 cells, but the header names 3 columns"),
        ("0.03,,0.04", r"line 2: rho_s must be a number, but is ''"),
        (
            "0.03,0.099,1e-300",
            r"line 2: .* name of \d+ characters; allowed are 120. Give its numbers",
        ),
        ("", "holds no stimuli"),
    ],
)
def test_an_impossible_row_is_named_with_its_value(tmp_path: Path, rows: str, message: str) -> None:
    path = tmp_path / "bad.csv"
    path.write_text(f"rho_d,rho_s,alpha\n{rows}\n", encoding="utf-8")
    with pytest.raises(GlossError, match=message) as caught:
        read_stimulus_list(path)
    assert "\n" not in str(caught.value)
    assert "bad.csv" in str(caught.value)


def test_a_missing_column_is_named(tmp_path: Path) -> None:
    path = tmp_path / "bad.csv"
    path.write_text("rho_d,rho_s\n0.1,0.1\n", encoding="utf-8")
    with pytest.raises(GlossError, match=r"lacks the column 'alpha'. Expected rho_d, rho_s, alpha; found rho_d, rho_s"):
        read_stimulus_list(path)


def test_an_unknown_set_lists_those_that_exist() -> None:
    with pytest.raises(GlossError, match="Unknown stimulus set 'experiment9'.*contrast, doi, experiment1"):
        read_stimulus_list("experiment9")


def test_a_toml_with_an_unknown_key_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "bad.toml"
    path.write_text('format = "glossspace/stimulus-list"\nversion = 1\nname = "x"\nrho_d = [0.1]\n', encoding="utf-8")
    with pytest.raises(GlossError, match=r"not valid at 'rho_d'"):
        read_stimulus_list(path)
