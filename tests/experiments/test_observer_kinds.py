import numpy as np
import pytest

from gloss_experiments import run_session
from gloss_experiments.observers.observer import SimulatedObserver
from gloss_experiments.observers.observer_kinds import OBSERVER_KINDS, observer_named, seen_axes, simulated_observers
from glossspace.dataset import read_simulated_observers
from glossspace.errors import GlossError
from glossspace.stimulus_set import read_stimulus_set
from tests.experiments.session_files import data_of


def test_the_population_is_the_stated_one():
    observers = simulated_observers(4000, seed=1)
    log_ratio = np.log([observer.ratio for observer in observers])
    # Four standard errors of 4000 draws: of the mean .15 / sqrt(4000) = .0024, of the sd .0017.
    assert np.exp(log_ratio.mean()) == pytest.approx(1.78, rel=0.0096)
    assert log_ratio.std() == pytest.approx(0.15, abs=0.007)
    assert all(0.75 <= observer.exponent <= 0.95 and 3 <= observer.noise_sd <= 6 for observer in observers)


def test_who_sees_images_has_no_paper_in_its_weights():
    observers = simulated_observers(4000, seed=1, kind="images")
    log_ratio = np.log([observer.weight_d / observer.weight_c for observer in observers])
    assert np.exp(log_ratio.mean()) == pytest.approx(1.0, rel=0.0096)  # as above
    assert {observer.ratio for observer in observers} == {None}
    parameters = observers[0].parameters()
    assert parameters["sees"] == "images"
    assert not {"weight_c", "weight_d", "ratio"} & set(parameters)


def test_more_observers_do_not_change_the_first():
    assert simulated_observers(9, seed=2)[:3] == simulated_observers(3, seed=2)
    assert simulated_observers(3, seed=2) != simulated_observers(3, seed=3)


def test_the_named_observer_is_the_same_person_in_every_task():
    assert observer_named("01", seed=0) == observer_named("01", seed=0)
    assert len({observer_named(name, seed=0) for name in ("1", "01", "02")}) == 3
    assert observer_named("01", seed=0) != observer_named("01", seed=1), "another study has other people"


@pytest.mark.parametrize("kind", [name for name in OBSERVER_KINDS if name not in {"metric", "images"}])
def test_a_kind_changes_what_it_says_and_nothing_else(kind):
    plain, other = observer_named("01", seed=0), observer_named("01", seed=0, kind=kind)
    changed = {name for name in vars(plain) if getattr(plain, name) != getattr(other, name)}
    assert changed == set(OBSERVER_KINDS[kind])
    assert other.parameters() != plain.parameters(), "what sets it apart is recorded"


def test_an_unknown_kind_lists_the_known_ones():
    with pytest.raises(GlossError, match="No simulated observer of the kind 'tired'; allowed are metric, compressive"):
        observer_named("01", seed=0, kind="tired")
    with pytest.raises(GlossError, match="-1 simulated observers of seed 1 cannot be drawn"):
        simulated_observers(-1, seed=1)


def test_most_see_the_axes_of_the_paper(experiment1):
    stimulus_set = read_stimulus_set(experiment1)
    name = "d0.193_s0.066_a0.07"
    axes = seen_axes(SimulatedObserver(1.0, 1.78, 1.0, 0.0), stimulus_set, [name])
    assert list(axes) == [name]
    assert axes[name] == pytest.approx((0.087, 0.93), abs=5e-4)  # figure 11 of the gloss paper, as printed


def test_a_session_is_given_a_kind_by_name(small_set, tmp_path):
    for name, observer in (("a", "reversed"), ("b", observer_named("01", seed=0, kind="reversed")), ("c", None)):
        run_session("doi", stimuli=small_set, dataset=tmp_path / name, participant="01", observer=observer)
    data = [data_of(tmp_path / name) for name in "abc"]
    assert data[0] == data[1] != data[2]
    truth = read_simulated_observers(tmp_path / "a").iloc[0]
    assert truth["reversed"]
    with pytest.raises(GlossError, match=r"was begun with observer .*an observer cannot change within a session"):
        run_session("doi", stimuli=small_set, dataset=tmp_path / "a", participant="01", observer="lapsing")
    with pytest.raises(GlossError, match="No simulated observer of the kind 'bored'"):
        run_session("doi", stimuli=small_set, dataset=tmp_path / "d", participant="01", observer="bored")
    assert not (tmp_path / "d").exists()
