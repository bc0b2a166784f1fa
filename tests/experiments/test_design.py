from collections import Counter
from itertools import combinations_with_replacement

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gloss_experiments.design import design_trials, session_seed
from gloss_experiments.protocol import read_protocol
from glossspace.errors import GlossError

PAIRWISE, CONTRAST = read_protocol("pairwise"), read_protocol("contrast")
NAMES = tuple(f"s{i:02d}" for i in range(27))


def with_design(protocol, **design):
    return protocol.model_copy(update={"design": protocol.design.model_copy(update=design)})


def test_experiment_1_has_378_pairs():
    """Section 3.2.3.2 of the gloss paper: 378 = C(27, 2) + 27, so identical pairs are judged too."""
    trials = design_trials(PAIRWISE, NAMES, seed=1)
    assert len(trials) == 378
    assert sum(left == right for left, right in (trial.stimuli for trial in trials)) == 27
    assert [trial.number for trial in trials] == list(range(1, 379))


@given(n=st.integers(1, 12), repeats=st.integers(1, 3), identical=st.booleans(), seed=st.integers(0, 2**48))
def test_every_unordered_pair_is_shown_once_a_block(n, repeats, identical, seed):
    if n == 1 and not identical:
        return
    protocol = with_design(PAIRWISE, repeats=repeats, include_identical=identical)
    trials = design_trials(protocol, NAMES[:n], seed=seed)
    wanted = [pair for pair in combinations_with_replacement(NAMES[:n], 2) if identical or pair[0] != pair[1]]
    for block in range(1, repeats + 1):
        shown = [tuple(sorted(trial.stimuli)) for trial in trials if trial.block == block]
        assert sorted(shown) == wanted
    assert [trial.number for trial in trials] == list(range(1, len(trials) + 1))
    assert [trial.block for trial in trials] == sorted(trial.block for trial in trials)


def test_sides_are_balanced_by_chance():
    # Of 351 pairs, the side is binomial: 4 standard deviations are 4 sqrt(351) / 2 = 37.5.
    for seed in range(20):
        pairs = [trial.stimuli for trial in design_trials(PAIRWISE, NAMES, seed=seed)]
        assert abs(sum(left < right for left, right in pairs) - 351 / 2) < 37.5


def test_a_repeat_shows_a_pair_the_other_way_round():
    trials = design_trials(with_design(PAIRWISE, repeats=2), NAMES[:5], seed=3)
    first, second = ({trial.stimuli for trial in trials if trial.repeat == repeat} for repeat in (1, 2))
    assert second == {(right, left) for left, right in first}


def test_the_order_is_the_seed_s():
    one, same, other = (design_trials(PAIRWISE, NAMES, seed=seed) for seed in (1, 1, 2))
    assert one == same
    assert [trial.stimuli for trial in one] != [trial.stimuli for trial in other]


def test_magnitudes_are_three_sequences_of_their_own():
    trials = design_trials(CONTRAST, NAMES, seed=1)
    sequences = [[trial.stimuli for trial in trials if trial.block == block] for block in (1, 2, 3)]
    assert all(sorted(sequence) == [(name,) for name in NAMES] for sequence in sequences)
    assert sequences[0] != sequences[1] != sequences[2]
    assert all(trial.block == trial.repeat for trial in trials)


def test_a_subset_of_the_stimuli():
    trials = design_trials(with_design(PAIRWISE, stimuli=("s01", "s05")), NAMES, seed=1)
    assert Counter(tuple(sorted(trial.stimuli)) for trial in trials) == Counter(
        [("s01", "s01"), ("s01", "s05"), ("s05", "s05")]
    )


@pytest.mark.parametrize(
    ("stimuli", "names", "message"),
    [
        (("s01", "gold"), NAMES, "asks for the stimulus 'gold', which the stimulus set lacks; it has s00, s01"),
        (("s01", "s01"), NAMES, "names the stimulus 's01' twice in design.stimuli"),
        ((), (), "needs at least 1 stimuli, but the set has 0"),
    ],
)
def test_impossible_designs(stimuli, names, message):
    with pytest.raises(GlossError, match=message):
        design_trials(with_design(PAIRWISE, stimuli=stimuli), names, seed=1)


def test_sessions_of_a_study_do_not_share_a_seed():
    seeds = {
        session_seed(study, participant=participant, session=session, task=task)
        for study in (0, 1)
        for participant in ("1", "01", "02")
        for session in ("1", "2")
        for task in ("pairwise", "doi")
    }
    assert len(seeds) == 24
    assert all(0 <= seed < 2**48 for seed in seeds)
    assert session_seed(1, participant="01", session="1", task="doi") == session_seed(
        1, participant="01", session="1", task="doi"
    )
