from collections import Counter
from dataclasses import replace
from itertools import combinations_with_replacement

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gloss_experiments.design import design_trials, practice_trials, session_seed, session_trials
from gloss_experiments.protocol import read_protocol
from glossspace.errors import GlossError

PAIRWISE, CONTRAST, RANKING = read_protocol("pairwise"), read_protocol("contrast"), read_protocol("ranking")
NAMES = tuple(f"s{i:02d}" for i in range(27))
WHO = {"seed": 0, "participant": "01", "session": "1"}


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
        ((), ("a",), "splits 1 trials over 2 sessions; each needs one at least"),
    ],
)
def test_impossible_designs(stimuli, names, message):
    with pytest.raises(GlossError, match=message):
        design_trials(with_design(PAIRWISE, stimuli=stimuli, sessions=2), names, seed=1)


def test_sessions_of_a_study_do_not_share_a_seed():
    seeds = {
        session_seed(study, participant=participant, session=session, task=task)
        for study in (0, 1)
        for participant in ("1", "01", "02")
        for session in ("1", "2")
        for task in ("pairwise", "doi")
    }
    assert len(seeds) == 24
    one, other = (("1", "11"), ("11", "1"))  # run together they would be the same
    assert session_seed(0, participant=one[0], session=one[1], task="doi") != session_seed(
        0, participant=other[0], session=other[1], task="doi"
    )
    assert all(0 <= seed < 2**48 for seed in seeds)
    assert session_seed(1, participant="01", session="1", task="doi") == session_seed(
        1, participant="01", session="1", task="doi"
    )


@pytest.mark.parametrize("protocol", [PAIRWISE, CONTRAST], ids=["pairwise", "magnitude"])
def test_practice_preview_and_breaks_leave_the_order_as_it_is(protocol):
    plain = with_design(protocol, practice=0, preview=False, break_every=0)
    bare = session_trials(plain, NAMES, **WHO)
    assert {trial.role for trial in bare} == {"judged"}
    rich = session_trials(with_design(plain, practice=7, preview=True, break_every=5, time_limit_s=3.0), NAMES, **WHO)
    assert rich[7:] == bare
    assert [(trial.role, trial.number) for trial in rich[:7]] == [("practice", i) for i in range(1, 8)]


@given(n=st.integers(1, 12), seed=st.integers(0, 2**48), repeats=st.integers(1, 3))
@pytest.mark.parametrize("protocol", [PAIRWISE, CONTRAST], ids=["pairwise", "magnitude"])
def test_catch_trials_leave_the_order_and_repeat_what_was_judged(protocol, n, seed, repeats):
    plain = with_design(protocol, repeats=repeats)
    judged = design_trials(plain, NAMES[:6], seed=seed)
    trials = design_trials(with_design(plain, catch_trials=n if n <= len(judged) else 1), NAMES[:6], seed=seed)
    assert [trial.number for trial in trials] == list(range(1, len(trials) + 1))
    assert [replace(t, number=0) for t in trials if t.role == "judged"] == [replace(t, number=0) for t in judged]
    catch = [i for i, trial in enumerate(trials) if trial.role == "catch"]
    assert len(catch) == (n if n <= len(judged) else 1)
    for nth, i in enumerate(catch):
        before = {trial.stimuli for trial in trials[:i] if trial.role == "judged"}
        if protocol is PAIRWISE and nth % 2 == 1:
            assert len(set(trials[i].stimuli)) == 1, "every second one is an identical pair"
            assert trials[i].stimuli[0] in {name for pair in before for name in pair}
        else:
            assert trials[i].stimuli[::-1] in before, "the other way round"
        assert trials[i].block == trials[i - 1].block
    # Spread: each stretch of the session, as many of them as catch trials, holds one.
    n_before = [i - nth for nth, i in enumerate(catch)]
    for nth, place in enumerate(n_before):
        start, end = (len(judged) * k / len(catch) for k in (nth, nth + 1))
        assert start - 1 <= place <= max(end + 1, 1)


def test_a_repeated_catch_trial_comes_long_after_the_first():
    trials = design_trials(with_design(PAIRWISE, catch_trials=20), NAMES, seed=5)
    place = {trial.stimuli: i for i, trial in enumerate(trials) if trial.role == "judged"}
    repeated = [(i, t) for i, t in enumerate(trials) if t.role == "catch" and len(set(t.stimuli)) == 2]
    assert len(repeated) == 10
    assert len({trial.stimuli for _, trial in repeated}) == 10, "none twice"
    assert all(i - place[trial.stimuli[::-1]] >= 10 for i, trial in repeated if i > 20)


def test_practice_is_not_the_beginning_of_what_is_judged():
    trials = session_trials(with_design(PAIRWISE, practice=10), NAMES, **WHO)
    practised, judged = ([frozenset(t.stimuli) for t in some] for some in (trials[:10], trials[10:20]))
    assert practised != judged


def test_no_pair_is_a_catch_trial_twice():
    """Half of ten catch trials repeat one of 66 pairs: drawn blindly, some of fifty sessions would have one twice."""
    for seed in range(50):
        trials = design_trials(with_design(PAIRWISE, catch_trials=10), NAMES[:12], seed=seed)
        repeated = [(i, t.stimuli) for i, t in enumerate(trials) if t.role == "catch" and len(set(t.stimuli)) == 2]
        # The first one may come before ten trials were shown, when there is little to choose from.
        later = [stimuli for i, stimuli in repeated if i > 20]
        assert len(set(later)) == len(later)


def test_catch_trials_of_two_days_do_not_share_their_places():
    protocol = with_design(PAIRWISE, catch_trials=6, sessions=2)
    days = [session_trials(protocol, NAMES, **(WHO | {"session": day})) for day in ("1", "2")]
    places = [[t.number for t in trials if t.role == "catch"] for trials in days]
    assert len(places[0]) == len(places[1]) == 6
    assert places[0] != places[1]


def test_more_catch_trials_than_trials():
    with pytest.raises(GlossError, match="has 4 catch trials in a session of 3 trials; there can be no more"):
        design_trials(with_design(PAIRWISE, catch_trials=4), NAMES[:2], seed=1)


@pytest.mark.parametrize("n_sessions", [2, 3, 5])
def test_the_sessions_of_a_design_make_up_the_whole(n_sessions):
    whole = session_trials(with_design(PAIRWISE, practice=2), NAMES, **(WHO | {"session": "all"}))
    split = with_design(PAIRWISE, practice=2, sessions=n_sessions)
    parts = [session_trials(split, NAMES, **(WHO | {"session": str(k)})) for k in range(1, n_sessions + 1)]
    judged = [[trial for trial in part if trial.role == "judged"] for part in parts]
    assert [trial.stimuli for part in judged for trial in part] == [trial.stimuli for trial in whole[2:]]
    assert max(map(len, judged)) - min(map(len, judged)) <= 1
    assert all([trial.number for trial in part] == list(range(1, len(part) + 1)) for part in judged)
    assert all(len(part) == len(other) + 2 for part, other in zip(parts, judged, strict=True)), "each has practice"


@pytest.mark.parametrize("session", ["0", "3", "a", "01"])
def test_a_session_that_the_protocol_lacks(session):
    with pytest.raises(GlossError, match=f"the session is a number from 1 to 2, not '{session}'"):
        session_trials(with_design(PAIRWISE, sessions=2), NAMES, **(WHO | {"session": session}))


def test_an_incomplete_design_has_the_pairs_of_its_list():
    pairs = (("s03", "s01"), ("s01", "s01"), ("s02", "s03"))
    trials = design_trials(with_design(PAIRWISE, pairs=pairs, repeats=2), NAMES, seed=1)
    for block in (1, 2):
        shown = [tuple(sorted(trial.stimuli)) for trial in trials if trial.block == block]
        assert sorted(shown) == [("s01", "s01"), ("s01", "s03"), ("s02", "s03")]
    with pytest.raises(GlossError, match="asks for the stimulus 'gold'"):
        design_trials(with_design(PAIRWISE, pairs=(("s01", "gold"),)), NAMES, seed=1)


def test_practice_shows_each_item_once_before_any_twice():
    trials = practice_trials(with_design(CONTRAST, practice=60), NAMES, seed=1)
    assert [Counter(trial.stimuli for trial in trials[i : i + 27]).most_common(1)[0][1] for i in (0, 27)] == [1, 1]
    assert len(trials) == 60


def test_a_ranking_is_one_trial_a_block():
    """Section 5.1 of the gloss paper: the others of a set, ranked with respect to a reference."""
    names = (*RANKING.design.stimuli, RANKING.design.reference, "another")
    trials = session_trials(RANKING, names, **WHO)
    practice, *judged = trials
    assert (practice.role, len(practice.items)) == ("practice", 4)
    assert [(trial.block, trial.repeat, trial.number) for trial in judged] == [(1, 1, 1), (2, 2, 2)]
    for trial in judged:
        assert trial.stimuli[0] == RANKING.design.reference
        assert sorted(trial.items) == sorted(RANKING.design.stimuli)
    starts = {session_trials(RANKING, names, **(WHO | {"seed": seed}))[1].items for seed in range(50)}
    assert len(starts) > 40, "random: of 720 orders, 50 draws give some 48 different ones"


def test_a_ranking_of_the_whole_set_leaves_out_the_reference():
    protocol = with_design(RANKING, stimuli=(), reference="s05")
    assert sorted(design_trials(protocol, NAMES, seed=1)[0].items) == sorted(set(NAMES) - {"s05"})
    with pytest.raises(GlossError, match="needs at least 2 stimuli to rank beside the reference"):
        design_trials(protocol, ("s05", "s06"), seed=1)
    with pytest.raises(GlossError, match="asks for the stimulus 's05', which the stimulus set lacks"):
        design_trials(protocol, ("s06", "s07"), seed=1)
