from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gloss_stimuli.sets import LONGEST_NAME, read_stimulus_list, shipped_sets
from glossspace.errors import GlossError
from glossspace.metric import from_physical, max_contrast_gloss

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


def test_contrast30_is_all_of_them() -> None:
    assert len(parameters("contrast30")) == 30
    assert set(parameters("contrast30")) == {(d, s, 0.04) for d in CONTRAST_RHO_D for s in CONTRAST_RHO_S}
    assert set(parameters("contrast")) < set(parameters("contrast30"))


def test_doi_varies_alpha_alone() -> None:
    assert parameters("doi") == [(0.03, 0.099, alpha) for alpha in DOI_ALPHA]


def test_shipped_names_match_their_files() -> None:
    assert shipped_sets() == ("contrast", "contrast30", "doi", "experiment1")
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
    with pytest.raises(GlossError, match="Unknown stimulus set 'experiment9'.*contrast, contrast30, doi, experiment1"):
        read_stimulus_list("experiment9")


def test_a_toml_with_an_unknown_key_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "bad.toml"
    path.write_text('format = "glossspace/stimulus-list"\nversion = 1\nname = "x"\nrho_d = [0.1]\n', encoding="utf-8")
    with pytest.raises(GlossError, match=r"not valid at 'rho_d'"):
        read_stimulus_list(path)


# Perceptual parameters


def perceptual(path: Path, rows: str, header: str = "lightness,c,d") -> Path:
    path.write_text(f"{header}\n{rows}\n", encoding="utf-8")
    return path


def test_the_papers_gray_paint_is_found_from_its_appearance(tmp_path: Path) -> None:
    # Gloss paper, fig. 11: c = .087, d = .93 is the gray stimulus of rho_s .066 and alpha .07; L* of .193 is 51.04.
    (paint,) = read_stimulus_list(perceptual(tmp_path / "a.csv", "51.04,0.087,0.93")).stimuli
    # L* is given to .005, which is .193 ± 4e-5; c to .0005, which is .066 ± 5e-4 by eq. 7.
    assert paint.rho_d == pytest.approx(0.193, abs=5e-5)
    assert paint.rho_s == pytest.approx(0.066, abs=6e-4)
    assert paint.alpha == 0.07  # 1 - .93 is .06999999999999995 before it is rounded


def test_columns_may_stand_in_any_order_and_lightness_be_called_l(tmp_path: Path) -> None:
    one = read_stimulus_list(perceptual(tmp_path / "a.csv", "50,0.08,0.95")).stimuli
    other = read_stimulus_list(perceptual(tmp_path / "b.csv", "0.95,mine,50,0.08", header="d,note,L,c")).stimuli
    assert one == other


@given(
    # Zero, or what needs no file name of a hundred digits.
    st.one_of(st.just(0.0), st.floats(1e-3, 100)),
    st.one_of(st.just(0.0), st.floats(1e-3, 1)),
    st.floats(0.7, 0.999),
)
def test_appearance_comes_back_from_the_rounded_paint(lightness: float, share: float, d: float) -> None:
    import tempfile

    c = share * float(max_contrast_gloss(lightness))
    with tempfile.TemporaryDirectory() as folder:
        path = perceptual(Path(folder) / "a.csv", f"{lightness!r},{c!r},{d!r}")
        (paint,) = read_stimulus_list(path).stimuli
    assert paint.rho_d + paint.rho_s <= 1
    assert len(paint.name) <= LONGEST_NAME
    back = from_physical(paint.rho_d, paint.rho_s, paint.alpha)
    # Twelve digits of each parameter: 5e-13 of it; c, the cube root of a sum of two, has a third of that, and on its
    # limit loses what keeps the sum below 1, 1e-12.
    assert back.c == pytest.approx(c, rel=1e-9, abs=2e-12)
    assert back.d == pytest.approx(d, rel=0, abs=1e-12)
    assert back.lightness == pytest.approx(lightness, rel=1e-11, abs=1e-300)


def test_the_limit_itself_can_be_asked_for(tmp_path: Path) -> None:
    # The paper's fig. 10: at L* = 0 the envelope reaches c = 1, a black of rho_s = 1.
    rows = f"0,1,0.9\n50,{float(max_contrast_gloss(50.0))!r},0.9"
    mirror, gray = read_stimulus_list(perceptual(tmp_path / "a.csv", rows)).stimuli
    assert (mirror.rho_d, mirror.rho_s) == (0.0, 1.0)
    assert 1 - 1e-11 < gray.rho_d + gray.rho_s <= 1  # twelve digits


def test_a_toml_may_hold_either_triple_in_each_table(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(
        'format = "glossspace/stimulus-list"\nversion = 1\nname = "mine"\n'
        "[[grid]]\nrho_d = [0.5]\nrho_s = [0.1]\nalpha = [0.05]\n"
        "[[grid]]\nd = [0.9, 0.95]\nL = [0, 50]\nc = [0.1]\n"
        "[[stimulus]]\nlightness = 0\nc = 0.2\nd = 0.9\n",
        encoding="utf-8",
    )
    stimuli = read_stimulus_list(path).stimuli
    assert len(stimuli) == 6
    # On black, c is the cube root of rho_s (eq. 4).
    assert [s.name for s in stimuli[1:3]] == ["d0_s0.001_a0.1", "d0_s0.001_a0.05"]
    assert stimuli[5].name == "d0_s0.008_a0.1"
    assert np.allclose([s.c for s in stimuli[1:5]], 0.1, rtol=1e-11)  # twelve digits
    assert [round(s.lightness, 9) for s in stimuli[1:5]] == [0, 0, 50, 50]


@pytest.mark.parametrize(
    ("header", "row", "message"),
    [
        (
            "lightness,c,d",
            "50,0.9,0.95",
            r"line 2: c = 0.9 is out of reach at lightness 50: rho_d is 0.1842 there, which leaves rho_s at most "
            r"0.8158 and c at most 0.51\d*, since no paint reflects more than it receives",
        ),
        ("L,c,d", "101,0.1,0.95", "line 2: Invalid lightness = 101.0.*0 to 100"),
        ("L,c,d", "50,-0.1,0.95", "line 2: Invalid c = -0.1"),
        ("L,c,d", "50,0.1,1", "line 2: Invalid d = 1.0.*below 1"),
        ("L,c,d", "50,nan,0.95", "line 2: c must be a finite number, but is nan"),
        ("L,c,d", "gray,0.1,0.95", "line 2: L must be a number, but is 'gray'"),
        ("L,c,d", "50,0.1,0.95\n50,0.1,0.95", r"line 3: .* is already there \(line 2\)"),
        (
            "rho_d,rho_s,alpha,c",
            "0.5,0.1,0.1,0.1",
            "mixes rho_d, rho_s, alpha with c: state either rho_d, rho_s, alpha or",
        ),
        ("L,c,alpha", "50,0.1,0.1", "mixes alpha with L, c"),
        ("L,lightness,c,d", "50,50,0.1,0.9", "has both lightness and L, which are the same"),
        ("L,c", "50,0.1", "lacks the column 'd'. Expected L, c, d; found L, c"),
        (
            "reflectance,gloss",
            "0.5,0.1",
            "names no paints: .*rho_d, rho_s, alpha, or lightness, c, d, but has reflectance",
        ),
    ],
)
def test_an_impossible_appearance_is_named_with_its_line(tmp_path: Path, header: str, row: str, message: str) -> None:
    with pytest.raises(GlossError, match=message) as caught:
        read_stimulus_list(perceptual(tmp_path / "bad.csv", row, header=header))
    assert "\n" not in str(caught.value)
    assert "bad.csv" in str(caught.value)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ("[[grid]]\nrho_d = [0.1]\nc = [0.1]\nd = [0.9]", r"not valid at 'grid.0.perceptual': mixes rho_d with c, d"),
        ("[[stimulus]]\nL = 50\nc = 0.1", r"not valid at 'stimulus.0.perceptual.d': Field required"),
        ("[[stimulus]]\nrho_d = 0.5\nrho_s = 0.1", r"not valid at 'stimulus.0.physical.alpha': Field required"),
        ("[[stimulus]]\nL = 50\nc = 0.9\nd = 0.9", r"stimulus 1: c = 0.9 is out of reach at lightness 50"),
        ("[[grid]]\nL = []\nc = [0.9]\nd = [0.9]", r"grid.0.perceptual.L"),
    ],
)
def test_a_wrong_table_is_named(tmp_path: Path, table: str, message: str) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(f'format = "glossspace/stimulus-list"\nversion = 1\nname = "x"\n{table}\n', encoding="utf-8")
    with pytest.raises(GlossError, match=message) as caught:
        read_stimulus_list(path)
    assert "\n" not in str(caught.value)
