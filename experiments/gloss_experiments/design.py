"""The design of a session: which trials, in which order, on which side. The same seed gives the same design.

Practice and catch trials are drawn from random numbers of their own, so that adding them leaves the order of the judged
trials as it was.
"""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations, combinations_with_replacement
from typing import Literal

import numpy as np

from gloss_experiments.protocol import Protocol
from glossspace.errors import GlossError

__all__ = [
    "Role",
    "Trial",
    "chosen_stimuli",
    "design_trials",
    "practice_trials",
    "session_seed",
    "session_trials",
]

Role = Literal["judged", "practice", "catch"]

# Which random numbers are drawn for what, beside those of the judged trials.
_PRACTICE, _CATCH = 1, 2
# Items of a ranking to practise with: enough to learn the movements, few enough to leave the ranking itself new.
_PRACTICE_ITEMS = 4
# So many trials at least lie between a pair and its repetition as a catch trial, where the session is long enough.
_CATCH_DISTANCE = 10


@dataclass(frozen=True)
class Trial:
    """One judgement to make.

    `stimuli` are (left, right) in a pairwise session, one stimulus in a magnitude one, and in a ranking the reference
    followed by the items in the order in which they lie at the start. Judgements of practice and catch trials are kept
    in the journal, and never become data.
    """

    number: int  # place in the order shown, from 1; practice trials count on their own
    block: int  # from 1
    repeat: int  # from 1
    stimuli: tuple[str, ...]
    role: Role = "judged"

    @property
    def items(self) -> tuple[str, ...]:
        """The items of a ranking; none in a trial of another kind."""
        return self.stimuli[1:] if len(self.stimuli) > 2 else ()


def session_seed(seed: int, *, participant: str, session: str, task: str) -> int:
    """Seed of one session: a study has one `seed`, and no two of its sessions share an order or an error by accident.

    Returns
    -------
    int
        48 bits, so that it survives JSON in any language.
    """
    text = "\n".join((str(seed), participant, session, task))
    return int.from_bytes(hashlib.sha256(text.encode("utf-8")).digest()[:6], "big")


def session_trials(
    protocol: Protocol, stimuli: Sequence[str], *, seed: int, participant: str, session: str
) -> tuple[Trial, ...]:
    """All trials of one session of a participant: those of practice, then the judged and catch trials.

    Where the protocol splits its trials over several sessions, one order is drawn for all of them, and session k gets
    part k of it.

    Parameters
    ----------
    protocol, stimuli
        As in `design_trials`.
    seed
        Of the study.
    participant, session
        Labels of the dataset. In a protocol of several sessions, `session` is a number from 1.

    Raises
    ------
    GlossError
        As from `design_trials`, or the protocol has no such session.

    Examples
    --------
    >>> from gloss_experiments.protocol import read_protocol
    >>> stimuli = [f"s{i}" for i in range(27)]
    >>> trials = session_trials(read_protocol("doi"), stimuli, seed=0, participant="07", session="1")
    >>> sum(trial.role == "judged" for trial in trials)
    81
    """
    n_sessions, part = protocol.design.sessions, 1
    if n_sessions > 1:
        if session not in map(str, range(1, n_sessions + 1)):
            raise GlossError(
                f"The protocol '{protocol.name}' splits its trials over {n_sessions} sessions, so the session is a "
                f"number from 1 to {n_sessions}, not '{session}'."
            )
        part, session = int(session), "all"
    order_seed = session_seed(seed, participant=participant, session=session, task=protocol.name)
    return (
        *practice_trials(protocol, stimuli, seed=order_seed),
        *design_trials(protocol, stimuli, seed=order_seed, part=part),
    )


def design_trials(protocol: Protocol, stimuli: Sequence[str], *, seed: int, part: int = 1) -> tuple[Trial, ...]:
    """The judged and catch trials of a session, in the order in which they are shown.

    Pairwise: every unordered pair once in each block (n (n - 1) / 2 pairs, and n more where identical pairs are
    included; or the pairs that the protocol lists), in random order, each pair on a random side; a repeat shows the
    pair the other way round than the last. Magnitude: every stimulus once in each block, in a random sequence of its
    own. Ranking: one trial a block, its items lying in random order at the start.

    Catch trials are spread over the session: pairs or stimuli judged before, the pairs the other way round, and every
    second one in a pairwise session an identical pair.

    Parameters
    ----------
    protocol
        Says which kind, how many repeats, and whether identical pairs are included.
    stimuli
        Names of the stimuli in the set. Their order matters, since the random order starts from it.
    seed
        Of this session; see `session_seed`.
    part
        Which of the protocol's sessions, from 1.

    Raises
    ------
    GlossError
        The protocol names a stimulus that the set lacks or names one twice, there are too few stimuli or trials.

    Examples
    --------
    >>> from gloss_experiments.protocol import read_protocol
    >>> len(design_trials(read_protocol("pairwise"), [f"s{i}" for i in range(27)], seed=1))
    378
    """
    rng = np.random.default_rng(seed)
    items = _items(protocol, stimuli, rng)
    whole: list[Trial] = []
    for block in range(1, protocol.design.repeats + 1):
        shown = [_shown(item, protocol, block, rng) for item in items]
        whole += [Trial(0, block, block, shown[i]) for i in rng.permutation(len(shown))]
    if len(whole) < protocol.design.sessions:
        raise GlossError(
            f"The protocol '{protocol.name}' splits {len(whole)} trials over {protocol.design.sessions} sessions; each "
            "needs one at least. Lower design.sessions, or raise design.repeats."
        )
    bounds = [round(len(whole) * i / protocol.design.sessions) for i in range(protocol.design.sessions + 1)]
    trials = _with_catch_trials(whole[bounds[part - 1] : bounds[part]], protocol, seed, part)
    return tuple(replace(trial, number=number) for number, trial in enumerate(trials, start=1))


def practice_trials(protocol: Protocol, stimuli: Sequence[str], *, seed: int) -> tuple[Trial, ...]:
    """Practice trials: drawn from those to be judged, none twice before all were shown; a ranking has few items.

    Raises
    ------
    GlossError
        As from `design_trials`.
    """
    rng = np.random.default_rng([seed, _PRACTICE])
    items = _items(protocol, stimuli, rng)
    trials: list[Trial] = []
    while len(trials) < protocol.design.practice:
        for i in rng.permutation(len(items))[: protocol.design.practice - len(trials)]:
            shown = _shown(items[i], protocol, 1, rng)
            shown = shown[: 1 + _PRACTICE_ITEMS] if protocol.kind == "ranking" else shown
            trials.append(Trial(len(trials) + 1, 1, 1, shown, "practice"))
    return tuple(trials)


def _items(protocol: Protocol, stimuli: Sequence[str], rng: np.random.Generator) -> list[tuple[str, ...]]:
    """What is judged once a block, as it is shown first: pairs with their sides, stimuli, or the one ranking."""
    design = protocol.design
    chosen = chosen_stimuli(protocol, stimuli)
    if protocol.kind == "magnitude":
        return [(name,) for name in chosen]
    if protocol.kind == "ranking":
        return [(str(design.reference), *(name for name in chosen if name != design.reference))]
    all_pairs = combinations_with_replacement if design.include_identical else combinations
    pairs = list(design.pairs or all_pairs(chosen, 2))
    return [(a, b) if first else (b, a) for (a, b), first in zip(pairs, rng.random(len(pairs)) < 0.5, strict=True)]


def _shown(item: tuple[str, ...], protocol: Protocol, block: int, rng: np.random.Generator) -> tuple[str, ...]:
    if protocol.kind == "ranking":
        return (item[0], *(item[1:][i] for i in rng.permutation(len(item) - 1)))
    return item if block % 2 == 1 else item[::-1]


def chosen_stimuli(protocol: Protocol, stimuli: Sequence[str]) -> tuple[str, ...]:
    """The stimuli that a protocol chooses of a set, whichever part of its trials a session has.

    Raises
    ------
    GlossError
        As from `design_trials`.
    """
    design = protocol.design
    chosen = design.stimuli or tuple(dict.fromkeys(name for pair in design.pairs for name in pair)) or tuple(stimuli)
    named = chosen if design.reference is None or design.reference in chosen else (*chosen, design.reference)
    unknown = [name for name in named if name not in stimuli]
    if unknown:
        raise GlossError(
            f"The protocol '{protocol.name}' asks for the stimulus '{unknown[0]}', which the stimulus set lacks; "
            f"it has {', '.join(stimuli)}."
        )
    twice = sorted({name for name in chosen if chosen.count(name) > 1})
    if twice:
        raise GlossError(f"The protocol '{protocol.name}' names the stimulus '{twice[0]}' twice in design.stimuli.")
    if protocol.kind == "ranking" and len(set(chosen) - {design.reference}) < 2:
        raise GlossError(f"The protocol '{protocol.name}' needs at least 2 stimuli to rank beside the reference.")
    fewest = 1 if protocol.kind == "magnitude" or design.include_identical or design.pairs else 2
    if len(chosen) < fewest:
        raise GlossError(
            f"The protocol '{protocol.name}' needs at least {fewest} stimuli, but the set has {len(chosen)}."
        )
    return named


def _with_catch_trials(judged: list[Trial], protocol: Protocol, seed: int, part: int) -> list[Trial]:
    n_catch = protocol.design.catch_trials
    if n_catch > len(judged):
        raise GlossError(
            f"The protocol '{protocol.name}' has {n_catch} catch trials in a session of {len(judged)} trials; "
            "there can be no more of them than of those."
        )
    rng = np.random.default_rng([seed, _CATCH, part])
    shown: list[Trial] = []
    begin = 0
    used: set[tuple[str, ...]] = set()
    for nth in range(n_catch):
        # One in each of so many equal stretches, never as the first trial of the session.
        start, end = (round(len(judged) * i / n_catch) for i in (nth, nth + 1))
        place = int(rng.integers(max(1, start), max(1, end - 1), endpoint=True))
        before = judged[:place]
        shown += judged[begin:place]
        catch = _catch_trial(before, protocol, identical=nth % 2 == 1, used=used, rng=rng)
        used.add(catch.stimuli)
        shown.append(catch)
        begin = place
    return shown + judged[begin:]


def _catch_trial(
    before: list[Trial], protocol: Protocol, *, identical: bool, used: set[tuple[str, ...]], rng: np.random.Generator
) -> Trial:
    last = before[-1]
    if protocol.kind == "pairwise" and identical:
        names = sorted({name for trial in before for name in trial.stimuli})
        name = names[rng.integers(len(names))]
        return replace(last, stimuli=(name, name), role="catch")
    far = before[: max(1, len(before) - _CATCH_DISTANCE)]
    new = [trial for trial in far if len(set(trial.stimuli)) == len(trial.stimuli) and trial.stimuli[::-1] not in used]
    source = (new or far)[rng.integers(len(new or far))]
    return replace(source, block=last.block, stimuli=source.stimuli[::-1], role="catch")
