"""Methods and results as text: its numbers are those of the study, and it says whose they are."""

import re
from dataclasses import replace

import numpy as np
import pytest

from gloss_analysis.confirmatory.scaling import confirm_axes
from gloss_analysis.ratings.magnitude import mean_ratings
from gloss_analysis.report.methods import methods_text
from gloss_analysis.report.provenance import calibration_words, display_words, tone_words
from glossspace.metric import distinctness
from glossspace.stimulus_set import StimulusSet


@pytest.fixture(scope="module")
def text(simulated):
    return methods_text(simulated)


def test_its_sections_are_those_of_a_paper(text):
    headings = [line for line in text.splitlines() if line.startswith("#")]
    assert headings == [
        "# Methods and results", "## Methods", "### Participants", "### Apparatus", "### Stimuli", "### Procedure",
        "### Exclusions", "### Analysis", "## Results (simulated observers)", "## Software", "## References",
    ]  # fmt: skip
    assert "{{" not in text
    assert not re.search(r"\bnan\b", text, flags=re.IGNORECASE)


def test_the_weight_of_d_is_the_one_of_the_pairs(text, simulated):
    fit = confirm_axes(simulated.study.pairs, simulated.coordinates[["c", "d"]].to_numpy(), axes=("c", "d"))
    low, high = fit.population_ci95
    assert f"{fit.population_ratio:.2f} times as much as one along c (95 % interval {low:.2f} to {high:.2f}" in text
    assert f"D = √(Δc² + ({fit.population_ratio:.2f} Δd)²)" in text


def test_r_squared_is_the_correlation_of_the_mean_ratings(text, simulated):
    means = mean_ratings(simulated.study.ratings["d"])
    alpha = simulated.study.stimuli.set_index("stimulus").loc[means["stimulus"], "alpha"]
    r = np.corrcoef(distinctness(alpha.to_numpy()), means["rating"])[0, 1]
    assert f"along d: r² = {r**2:.3f}" in text or f"criterion: r² = {r**2:.3f}" in text


def test_procedure_and_stimuli_are_counted(text):
    # 12 stimuli make 66 pairs; 6 images were rated along c and 5 along d, twice each: see `study_folders.SETS`.
    assert "66 pairs of different stimuli and of 12 identical pairs" in text
    assert "rated the gloss of 6 single images, each 2 times" in text
    assert "rated the gloss of 5 single images, each 2 times" in text
    assert "α 0.01, 0.04, 0.07, 0.1, 0.15" in text
    # The manifests' 0.125 and 0.375 to two digits, half to even.
    assert "wrong by 0.12 code values in the median and 0.38 at 99.9 % of its pixels" in text


def test_the_simulated_observers_parameters_are_told(text):
    assert "a weight of d of their own (1.50 to 2.00)" in text
    assert "Four simulated observers (01, 02, 03, 04; programs, not people) took part." in text


def test_who_could_not_be_fitted_is_named(simulated):
    left_out = replace(
        simulated.fit.confirmatory,
        participants=simulated.fit.confirmatory.participants[1:],
        individual=simulated.fit.confirmatory.individual[1:],
    )
    text = methods_text(replace(simulated, fit=replace(simulated.fit, confirmatory=left_out)))
    assert "Judgements of 01 could not be fitted" in text
    assert "No participant was excluded." not in text


def test_no_residual_of_a_calibration_is_made_up(simulated):
    stimuli = simulated.study.sets["experiment1"]
    assert "no residual of a calibration is recorded" in calibration_words(stimuli)
    assert display_words(stimuli).startswith("Images of 8 × 8 pixels were made for a display of 0.7 to 108 cd/m²")
    assert tone_words(stimuli) == ""


def test_what_a_manifest_knows_of_display_and_tone_is_told(simulated):
    stimuli = simulated.study.sets["experiment1"]
    measured = {"black_cd_m2": 0.5, "white_cd_m2": 90.0, "gamma": None, "measured": {"codes": [0, 128, 255]}}
    tone = {"kind": "rational sigmoid", "adapting_luminance_cd_m2": 10.0}
    other = StimulusSet(stimuli.folder, "x", (), {**stimuli.manifest, "display": measured, "tone_curve": tone})
    assert "a measured table of luminance" in display_words(other)
    assert "measured at 3 code values" in calibration_words(other)
    assert "by a rational sigmoid, adapted to 10 cd/m²" in tone_words(other)


def test_calibrations_are_told_once_each_with_their_residuals(simulated):
    """As the check of the screen leaves them in the headers of the journals."""
    known = {
        "screen": "EIZO no. 7",
        "sha256": "a1",
        "measured_at": "2026-03-31T09:00:00+00:00",
        "photometer": "LS-110 no. 3",
        "simulated": False,
        "n_verified": 8,
        "rms_delta_l": 0.1234,
        "largest_delta_l": 0.4567,
    }
    headers = [{"preflight": {"calibration": known}}, {"preflight": {"calibration": known}}, {"preflight": None}, {}]
    assert calibration_words(simulated.study.sets["experiment1"], headers) == (
        "The screen “EIZO no. 7” was calibrated on 2026-03-31 (LS-110 no. 3); on 8 patches that were not used in the "
        "fit the residual was ΔL* 0.12 (root mean square), at most 0.46."
    )
