"""The population of a pilot, from simulated ones whose population is known."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import curve_fit

from gloss_analysis.confirmatory.scaling import confirm_axes
from gloss_analysis.design.information import log_ratio_variance
from gloss_analysis.design.population import Population, population_like
from gloss_analysis.design.simulation import EXPERIMENT_1, drawn_ratios, simulated_study
from gloss_analysis.judgements.dissimilarity import Dissimilarities, Trials
from glossspace.errors import GlossError
from tests.analysis.studies import named

AXES = ("c", "d")


def pilot(population, n_observers, seed=0, **options):
    rng = np.random.default_rng(seed)
    return simulated_study(EXPERIMENT_1, drawn_ratios(population, n_observers, rng), population, rng=rng, **options)


@pytest.mark.parametrize(
    "stated", [Population(), Population(ratio=1.2, sd_log_ratio=0.3, exponent=1.1, noise_sd=2.0)]
)  # fmt: skip
def test_the_stated_population_comes_back(stated):
    found = population_like(pilot(stated, 60), EXPERIMENT_1, axes=AXES).population
    # 60 observers: the spread is known to 9 %, the ratio to spread / sqrt(60) and the bias of noisy ordinal fits, 2 %.
    assert found.sd_log_ratio == pytest.approx(stated.sd_log_ratio, rel=0.27)
    assert np.log(found.ratio / stated.ratio) == pytest.approx(0, abs=3 * stated.sd_log_ratio / np.sqrt(60) + 0.02)
    # Noise is cut off at the ends of the slider and steps add .3 of noise.
    assert found.noise_sd == pytest.approx(stated.noise_sd, rel=0.1)
    assert found.exponent == pytest.approx(stated.exponent, abs=0.05)


def test_the_unit_of_the_answers_does_not_matter():
    data = pilot(Population(), 6)
    one, other = (
        population_like(some, EXPERIMENT_1, axes=AXES).population
        for some in (data, replace(data, values=data.values / 1000))
    )
    assert other.noise_sd == pytest.approx(one.noise_sd, rel=1e-6)  # the curve is fitted by iteration
    assert other.ratio == pytest.approx(one.ratio, rel=1e-9)


def test_noise_of_one_answer_where_repeats_were_averaged():
    stated = Population(noise_sd=4.0)
    data = pilot(stated, 10, n_repeats=4)
    source, pair = (index.ravel() for index in np.indices(data.values.shape))
    trials = Trials(
        np.tile(source, 4), np.tile(pair, 4), np.tile(data.values.ravel(), 4), np.ones(4 * data.values.size)
    )
    found = population_like(replace(data, trials=trials), EXPERIMENT_1, axes=AXES).population
    assert found.noise_sd == pytest.approx(4, rel=0.1)  # as above
    assert population_like(data, EXPERIMENT_1, axes=AXES).population.noise_sd == pytest.approx(2, rel=0.1)


def test_a_small_pilot_by_its_definitions():
    """Curves by scipy's Levenberg and Marquardt, s^2 of q - 3 degrees of freedom, spreads from their definitions.

    Observers unlike each other and few pairs, so that no mean is like another.
    """
    stimuli = EXPERIMENT_1[[0, 2, 4, 9, 13, 17, 24]]
    rng = np.random.default_rng(2)
    parts = [
        simulated_study(stimuli, np.array([ratio]), Population(exponent=0.8, noise_sd=noise), rng=rng).values
        for ratio, noise in ((1.0, 1.0), (2.0, 2.0), (3.0, 4.0))
    ]
    data = named(np.vstack(parts), 7)
    counts = np.where(np.arange(21) < 10, 1, 3)  # the mean of 1 / counts is 41 / 63
    pair = np.tile(np.repeat(np.arange(21), counts), 3)
    source = np.repeat(np.arange(3), counts.sum())
    trials = Trials(source, pair, data.values[source, pair], np.ones(len(pair)))
    found = population_like(replace(data, trials=trials), stimuli, axes=AXES).population

    ratios = np.array([one.ratio for one in confirm_axes(data, stimuli, axes=AXES).individual])
    first, second = data.pairs
    delta = stimuli[first] - stimuli[second]
    ratio, exponents, variances = np.exp(np.mean(np.log(ratios))), [], []
    for own, judged in zip(ratios, data.values, strict=True):
        x = np.hypot(delta[:, 0], own * delta[:, 1])
        (top, exponent), _ = curve_fit(lambda x, a, p: a * x**p, x / x.max(), judged, p0=[100, 1])
        left = judged - top * (x / x.max()) ** exponent
        exponents.append(exponent)
        variances.append(left @ left / (21 - 3) * (100 / top) ** 2)
    # Both searches end at about 1e-8 of their numbers.
    assert found.exponent == pytest.approx(np.mean(exponents), rel=1e-5)
    assert found.noise_sd == pytest.approx(np.sqrt(np.mean(variances) * 63 / 41), rel=1e-5)
    error = log_ratio_variance(delta, np.ones(21, dtype=bool), ratio, exponent=found.exponent) * np.mean(variances)
    assert found.sd_log_ratio == pytest.approx(np.sqrt(np.var(np.log(ratios), ddof=1) - error), rel=1e-5)


def test_observers_who_are_all_alike():
    found = population_like(pilot(Population(sd_log_ratio=0.0), 12, seed=3), EXPERIMENT_1, axes=AXES)
    assert found.population.sd_log_ratio < 0.02  # what is left of an error of .02 after taking it off
    few = population_like(pilot(Population(), 3), EXPERIMENT_1, axes=AXES)
    assert any("rests on 3 participants" in warning for warning in few.warnings)


def test_participants_who_tell_nothing_are_left_out():
    data = pilot(Population(), 4)
    constant = np.vstack([data.values, np.full(351, 50.0)])
    found = population_like(named(constant, 27), EXPERIMENT_1, axes=AXES)
    assert found.participants == ("p0", "p1", "p2", "p3")
    with pytest.raises(GlossError, match="1 participants of the pilot can be used"):
        population_like(named(constant[[0, 4]], 27), EXPERIMENT_1, axes=AXES)


def test_three_axes_are_too_many():
    data = Dissimilarities(tuple("abc"), ("1",), np.array([[1.0, 2.0, 3.0]]))
    with pytest.raises(GlossError, match="two axes, not 3"):
        population_like(data, np.eye(3), axes=("c", "d", "e"))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("ratio", 0.0),
        ("ratio", np.inf),
        ("sd_log_ratio", -0.1),
        ("sd_log_ratio", 2.1),
        ("exponent", 0.0),
        ("noise_sd", np.nan),
        ("slider_step", 0),
        ("slider_step", 2.5),
    ],
)
def test_populations_that_cannot_be(name, value):
    with pytest.raises(GlossError, match=f"Invalid {name} = "):
        Population(**{name: value})
