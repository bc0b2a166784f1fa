import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gloss_experiments.design import Trial
from gloss_experiments.observer import Judge, SimulatedObserver, observer_named, simulated_observers

AXES = {"dull": (0.0, 0.9), "middle": (0.05, 0.93), "glossy": (0.1, 0.96)}
NOISELESS = SimulatedObserver(weight_c=1.0, weight_d=1.78, exponent=1.0, noise_sd=0.0)


def test_a_noiseless_observer_is_eq_5_scaled_to_the_range():
    """Eq. 5 of the gloss paper, D = sqrt(dc² + (1.78 dd)²): middle is halfway along both axes, so half of the range."""
    judge = Judge(NOISELESS, AXES, seed=1)
    ratings = [judge.rate(Trial(1, 1, 1, pair)) for pair in (("dull", "glossy"), ("dull", "middle"), ("dull", "dull"))]
    assert ratings == [100, 50, 0]


def test_compression_raises_small_differences():
    judge = Judge(SimulatedObserver(1.0, 1.78, 0.5, 0.0), AXES, seed=1)
    assert judge.rate(Trial(1, 1, 1, ("dull", "middle"))) == 71  # 100 sqrt(1/2) = 70.7


def test_magnitudes_span_the_slider():
    judge = Judge(NOISELESS, AXES, seed=1)
    assert [judge.rate(Trial(1, 1, 1, (name,))) for name in AXES] == [0, 50, 100]


def test_a_set_without_range_has_an_answer():
    judge = Judge(NOISELESS, {"one": (0.1, 0.9)}, seed=1)
    assert judge.rate(Trial(1, 1, 1, ("one",))) == 50
    assert judge.rate(Trial(1, 1, 1, ("one", "one"))) == 0


@given(
    st.builds(
        SimulatedObserver,
        weight_c=st.floats(0.1, 10),
        weight_d=st.floats(0.1, 10),
        exponent=st.floats(0.3, 2),
        noise_sd=st.floats(0, 50),
    ),
    st.integers(0, 2**48),
    st.integers(1, 400),
)
def test_ratings_are_whole_numbers_of_the_slider_and_belong_to_the_trial(observer, seed, number):
    trial = Trial(number, 1, 1, ("dull", "middle"))
    rating = Judge(observer, AXES, seed).rate(trial)
    assert isinstance(rating, int)
    assert 0 <= rating <= 100
    assert Judge(observer, AXES, seed).rate(trial) == rating


def test_the_noise_has_the_stated_size():
    judge = Judge(SimulatedObserver(1.0, 1.78, 1.0, 5.0), AXES, seed=1)
    ratings = [judge.rate(Trial(i, 1, 1, ("dull", "middle"))) for i in range(1, 2001)]
    # The standard error of a standard deviation is sd / sqrt(2 n) = 0.08, of a mean 0.11; four of them.
    assert np.mean(ratings) == pytest.approx(50, abs=0.45)
    assert np.std(ratings) == pytest.approx(np.hypot(5.0, 12**-0.5), abs=0.33)


def test_the_population_is_the_stated_one():
    observers = simulated_observers(4000, seed=1)
    log_ratio = np.log([observer.ratio for observer in observers])
    # Four standard errors of 4000 draws: of the mean .15 / sqrt(4000) = .0024, of the sd .0017.
    assert np.exp(log_ratio.mean()) == pytest.approx(1.78, rel=0.0096)
    assert log_ratio.std() == pytest.approx(0.15, abs=0.007)
    assert all(0.75 <= observer.exponent <= 0.95 and 3 <= observer.noise_sd <= 6 for observer in observers)


def test_more_observers_do_not_change_the_first():
    assert simulated_observers(9, seed=2)[:3] == simulated_observers(3, seed=2)
    assert simulated_observers(3, seed=2) != simulated_observers(3, seed=3)


def test_the_named_observer_is_the_same_person_in_every_task():
    assert observer_named("01", seed=0) == observer_named("01", seed=0)
    assert len({observer_named(name, seed=0) for name in ("1", "01", "02")}) == 3
