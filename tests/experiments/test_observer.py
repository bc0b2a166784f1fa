import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gloss_experiments.design import Trial
from gloss_experiments.observers.observer import Judge, SimulatedObserver
from glossspace.errors import GlossError

AXES = {"dull": (0.0, 0.9), "middle": (0.05, 0.93), "glossy": (0.1, 0.96)}
NOISELESS = SimulatedObserver(weight_c=1.0, weight_d=1.78, exponent=1.0, noise_sd=0.0)


def test_a_noiseless_observer_is_eq_5_scaled_to_the_range():
    """Eq. 5 of the gloss paper, D = sqrt(dc² + (1.78 dd)²): middle is halfway along both axes, so half of the range."""
    judge = Judge(NOISELESS, AXES, seed=1)
    ratings = [judge.rate(Trial(1, 1, 1, pair)) for pair in (("dull", "glossy"), ("dull", "middle"), ("dull", "dull"))]
    assert ratings == [100, 50, 0]


def test_each_dimension_has_its_own_weight():
    """Differences 3, 4 and 5 of a right triangle, and levels 0, 3 and 4: the axes above lie on one line."""
    axes = {"o": (0.0, 0.0), "c": (0.3, 0.0), "d": (0.0, 0.2)}
    judge = Judge(SimulatedObserver(weight_c=1.0, weight_d=2.0, exponent=1.0, noise_sd=0.0), axes, seed=1)
    assert [judge.rate(Trial(1, 1, 1, pair)) for pair in (("o", "c"), ("o", "d"), ("c", "d"))] == [60, 80, 100]
    assert [judge.rate(Trial(1, 1, 1, (name,))) for name in axes] == [0, 75, 100]


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


def ratings_of(observer, fraction="middle", n=2000, seed=1):
    """Ratings of the pair dull and middle, half of the range apart, in trials 1 to `n`."""
    judge = Judge(observer, AXES, seed)
    return np.array([judge.rate(Trial(i, 1, 1, ("dull", fraction))) for i in range(1, n + 1)])


def test_failings_that_are_off_change_no_answer():
    """A study of plain observers made by an earlier version is resumed with the answers that it began with."""
    plain = SimulatedObserver(1.0, 1.5, 0.8, 4.0)
    rng = np.random.default_rng([7, 12])
    expected = round(100 * 0.5**0.8 + 4.0 * rng.standard_normal())
    assert Judge(plain, AXES, seed=7).rate(Trial(12, 1, 1, ("dull", "middle"))) == expected
    assert plain.parameters() == {
        "weight_c": 1.0,
        "weight_d": 1.5,
        "exponent": 0.8,
        "noise_sd": 4.0,
        "ratio": 1.5,
    }


def test_a_wavering_criterion_scales_the_ratings():
    """ln rating = ln 50 - sd z: its mean is ln 50 and its standard deviation sd; four standard errors of 2000 draws."""
    ratings = ratings_of(SimulatedObserver(1.0, 1.78, 1.0, 0.0, criterion_sd=0.1))
    assert np.log(ratings).mean() == pytest.approx(np.log(50), abs=4 * 0.1 / 2000**0.5)
    # Rounding to whole ratings adds a variance of 1/12 / 50² = (0.006)², which is less than the standard error.
    assert np.log(ratings).std() == pytest.approx(0.1, abs=4 * 0.1 / 4000**0.5)
    assert (ratings_of(SimulatedObserver(1.0, 1.78, 1.0, 0.0, criterion_sd=0.1), "dull", n=50) == 0).all()


def test_a_drifting_criterion_lowers_the_ratings():
    """After 200 trials a drift of 0.1 for each hundred has lowered them by exp(-0.2)."""
    ratings = ratings_of(SimulatedObserver(1.0, 1.78, 1.0, 0.0, criterion_drift=0.1), n=200)
    assert ratings[199] == round(50 * np.exp(-0.2))
    assert (np.diff(ratings) <= 0).all()


def test_fatigue_makes_errors_grow():
    """With a growth of 1 the error of trial t has the standard deviation 2 (1 + t / 100)."""
    tiring, fresh = SimulatedObserver(1.0, 1.78, 1.0, 2.0, noise_growth=1.0), SimulatedObserver(1.0, 1.78, 1.0, 2.0)
    trials = {seed: (Trial(1, 1, 1, ("dull", "middle")), Trial(300, 1, 1, ("dull", "middle"))) for seed in range(1500)}
    late = [Judge(tiring, AXES, seed).rate(trials[seed][1]) for seed in trials]
    early = [Judge(fresh, AXES, seed).rate(trials[seed][0]) for seed in trials]
    # Standard error of a standard deviation: sd / sqrt(2 n); four of them. Rounding adds 1/12 to the variance.
    assert np.std(late) == pytest.approx(np.hypot(8, 12**-0.5), abs=4 * 8 / 3000**0.5)
    assert np.std(early) == pytest.approx(np.hypot(2, 12**-0.5), abs=4 * 2 / 3000**0.5)


def test_lapses_come_as_often_as_stated():
    lapsing = SimulatedObserver(1.0, 1.78, 1.0, 0.0, lapse_rate=0.2)
    ratings = ratings_of(lapsing)
    # A lapse gives the right answer once in 101 times. Four standard errors of a share of 0.2 in 2000: 0.036.
    assert np.mean(ratings != 50) == pytest.approx(0.2 * 100 / 101, abs=0.036)


def test_who_never_looks_answers_anything_or_the_middle():
    middle = SimulatedObserver(1.0, 1.78, 1.0, 5.0, lapse_rate=1.0, lapse_answer=50)
    assert set(ratings_of(middle, n=50)) == {50}
    anything = ratings_of(SimulatedObserver(1.0, 1.78, 1.0, 5.0, lapse_rate=1.0))
    # Uniform on 0 to 100: mean 50, standard deviation sqrt((101² - 1) / 12) = 29.15; four standard errors.
    assert anything.mean() == pytest.approx(50, abs=4 * 29.15 / 2000**0.5)
    assert (anything.min(), anything.max()) == (0, 100)


def test_a_reversed_slider():
    plain, turned = SimulatedObserver(1.0, 1.78, 0.8, 4.0), SimulatedObserver(1.0, 1.78, 0.8, 4.0, reversed=True)
    assert (np.abs(ratings_of(plain, n=100) + ratings_of(turned, n=100) - 100) <= 1).all(), "each rounded by itself"


def test_practice_has_errors_of_its_own():
    judge = Judge(SimulatedObserver(1.0, 1.78, 1.0, 6.0), AXES, seed=1)
    real = [judge.rate(Trial(i, 1, 1, ("dull", "middle"))) for i in range(1, 30)]
    practice = [judge.rate(Trial(i, 1, 1, ("dull", "middle"), role="practice")) for i in range(1, 30)]
    assert real != practice


RANKED = {"reference": (0.0, 0.9), **{f"s{i}": (0.01 * i, 0.9 + 0.003 * i) for i in range(1, 9)}}
LYING = Trial(1, 1, 1, ("reference", "s5", "s2", "s8", "s1", "s7", "s3", "s6", "s4"))


def test_a_noiseless_ranking_is_the_order_of_the_distances():
    """All lie on one line from the reference, so the order is that of their numbers."""
    order = tuple(f"s{i}" for i in range(1, 9))
    assert Judge(NOISELESS, RANKED, seed=1).rank(LYING) == order
    turned = SimulatedObserver(1.0, 1.78, 1.0, 0.0, reversed=True)
    assert Judge(turned, RANKED, seed=1).rank(LYING) == order[::-1]


def test_rankings_of_who_does_not_look():
    still = SimulatedObserver(1.0, 1.78, 1.0, 0.0, lapse_rate=1.0, lapse_answer=50)
    assert Judge(still, RANKED, seed=1).rank(LYING) == LYING.stimuli[1:]
    anyhow = [Judge(SimulatedObserver(1, 1, 1, 0, lapse_rate=1.0), RANKED, seed).rank(LYING) for seed in range(400)]
    assert all(sorted(order) == sorted(LYING.stimuli[1:]) for order in anyhow)
    # Each item is first in an eighth of the orders: 50 of 400, four standard errors of sqrt(400 · 1/8 · 7/8) = 6.6.
    assert sum(order[0] == "s5" for order in anyhow) == pytest.approx(50, abs=27)


def test_noise_swaps_neighbours_before_others():
    orders = [Judge(SimulatedObserver(1, 1.78, 1.0, 6.0), RANKED, seed).rank(LYING) for seed in range(200)]
    ranks = np.array([[order.index(f"s{i}") for i in range(1, 9)] for order in orders])
    neighbours, far = np.mean(ranks[:, 3] > ranks[:, 4]), np.mean(ranks[:, 0] > ranks[:, 7])
    # Two items of 12.5 slider units apart, each with an error of 6, swap with probability Phi(-12.5 / 8.49) = .0705;
    # four standard errors of 200 are .072.
    assert neighbours == pytest.approx(0.0705, abs=0.072)
    assert neighbours > far == 0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"weight_c": -1.0}, "weight_c of a simulated observer is -1.0; allowed are finite numbers from 0"),
        ({"noise_sd": float("nan")}, "noise_sd of a simulated observer is nan"),
        ({"criterion_drift": float("inf")}, "criterion_drift of a simulated observer is inf"),
        ({"exponent": 0.0}, "needs an exponent above 0"),
        ({"weight_c": 0.0, "weight_d": 0.0}, "one weight above 0"),
        ({"lapse_rate": 1.5}, "lapse_rate of a simulated observer is 1.5; it is a share from 0 to 1"),
        ({"lapse_answer": 101}, "lapse_answer of a simulated observer is 101"),
    ],
)
def test_impossible_observers(change, message):
    with pytest.raises(GlossError, match=message):
        SimulatedObserver(**({"weight_c": 1.0, "weight_d": 1.78, "exponent": 1.0, "noise_sd": 4.0} | change))


def test_a_drift_may_go_either_way():
    rising = SimulatedObserver(1.0, 1.78, 1.0, 0.0, criterion_drift=-0.1)
    assert ratings_of(rising, n=100)[99] == round(50 * np.exp(0.1))
