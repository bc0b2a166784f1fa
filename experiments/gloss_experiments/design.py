"""The design of a session: which trials, in which order, on which side. The same seed gives the same design."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, combinations_with_replacement

import numpy as np

from gloss_experiments.protocol import Protocol
from glossspace.errors import GlossError

__all__ = ["Trial", "design_trials", "session_seed"]


@dataclass(frozen=True)
class Trial:
    """One judgement to make: `stimuli` are (left, right) in a pairwise session, and one stimulus in a magnitude one."""

    number: int  # place in the order shown, from 1
    block: int  # from 1
    repeat: int  # from 1
    stimuli: tuple[str, ...]


def session_seed(seed: int, *, participant: str, session: str, task: str) -> int:
    """Seed of one session: a study has one `seed`, and no two of its sessions share an order or an error by accident.

    Returns
    -------
    int
        48 bits, so that it survives JSON in any language.
    """
    text = "\n".join((str(seed), participant, session, task))
    return int.from_bytes(hashlib.sha256(text.encode("utf-8")).digest()[:6], "big")


def design_trials(protocol: Protocol, stimuli: Sequence[str], *, seed: int) -> tuple[Trial, ...]:
    """The trials of a session, in the order in which they are shown.

    Pairwise: every unordered pair once in each block (n (n - 1) / 2 pairs, and n more where identical pairs are
    included), in random order, each pair on a random side; a repeat shows the pair the other way round than the last.
    Magnitude: every stimulus once in each block, in a random sequence of its own.

    Parameters
    ----------
    protocol
        Says which kind, how many repeats, and whether identical pairs are included.
    stimuli
        Names of the stimuli in the set. Their order matters, since the random order starts from it.
    seed
        Of this session; see `session_seed`.

    Raises
    ------
    GlossError
        The protocol names a stimulus that the set lacks or names one twice, or there are too few stimuli.

    Examples
    --------
    >>> from gloss_experiments.protocol import read_protocol
    >>> len(design_trials(read_protocol("pairwise"), [f"s{i}" for i in range(27)], seed=1))
    378
    """
    chosen = _chosen(protocol, stimuli)
    rng = np.random.default_rng(seed)
    trials: list[Trial] = []
    for block, shown in enumerate(_blocks(protocol, chosen, rng), start=1):
        trials += [Trial(len(trials) + i, block, block, stimuli) for i, stimuli in enumerate(shown, start=1)]
    return tuple(trials)


def _chosen(protocol: Protocol, stimuli: Sequence[str]) -> tuple[str, ...]:
    chosen = protocol.design.stimuli or tuple(stimuli)
    unknown = [name for name in chosen if name not in stimuli]
    if unknown:
        raise GlossError(
            f"The protocol '{protocol.name}' asks for the stimulus '{unknown[0]}', which the stimulus set lacks; "
            f"it has {', '.join(stimuli)}."
        )
    twice = sorted({name for name in chosen if chosen.count(name) > 1})
    if twice:
        raise GlossError(f"The protocol '{protocol.name}' names the stimulus '{twice[0]}' twice in design.stimuli.")
    fewest = 1 if protocol.kind == "magnitude" or protocol.design.include_identical else 2
    if len(chosen) < fewest:
        raise GlossError(
            f"The protocol '{protocol.name}' needs at least {fewest} stimuli, but the set has {len(chosen)}."
        )
    return chosen


def _blocks(protocol: Protocol, stimuli: tuple[str, ...], rng: np.random.Generator) -> list[list[tuple[str, ...]]]:
    if protocol.kind == "magnitude":
        items: list[tuple[str, ...]] = [(name,) for name in stimuli]
    else:
        pairs = combinations_with_replacement if protocol.design.include_identical else combinations
        items = [(a, b) if first else (b, a) for (a, b), first in _with_sides(list(pairs(stimuli, 2)), rng)]
    blocks = []
    for repeat in range(protocol.design.repeats):
        shown = [item if repeat % 2 == 0 else item[::-1] for item in items]
        blocks.append([shown[i] for i in rng.permutation(len(shown))])
    return blocks


def _with_sides(pairs: list[tuple[str, str]], rng: np.random.Generator) -> list[tuple[tuple[str, str], bool]]:
    return list(zip(pairs, rng.random(len(pairs)) < 0.5, strict=True))
