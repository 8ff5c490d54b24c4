"""The order of kinds of trials in a series, and of their hidden effects: dealt like cards, so that all are equally
frequent.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from tentacle.errors import InputError

TrialKind = Literal["single", "pair", "null", "unknown"]
# Of every sixteen trials: singles fill the confusion matrix, nulls and unknowns show false names.
ROUND: tuple[TrialKind, ...] = (
    "single", "null", "single", "unknown", "single", "pair", "single", "single",
    "null", "single", "unknown", "single", "pair", "single", "single", "pair",
)  # fmt: skip
TRIAL_KINDS: tuple[TrialKind, ...] = ("single", "pair", "null", "unknown")


@dataclass(frozen=True)
class Dealt:
    """A trial's place in its series: index, kind, effects hidden, whether it is a video; random: its random
    generator.
    """

    index: int
    kind: TrialKind
    effects: tuple[str, ...]
    video: bool
    random: np.random.Generator


def dealt(
    count: int,
    seed: int,
    catalogued: Sequence[str],
    outside: Sequence[str],
    *,
    kinds: Sequence[str] = TRIAL_KINDS,
    video_share: float = 0.0,
) -> Iterator[Dealt]:
    """The first `count` trials of a seed; each depends on the seed, its index and the kinds alone, so more may follow.

    catalogued, outside: names of the effects that can be hidden, in the catalogue and out of it. InputError where a
    kind is not known or a share is none.
    """
    unknown = sorted(set(kinds) - set(TRIAL_KINDS))
    if unknown or not kinds:
        raise InputError(f"{', '.join(unknown) or 'none'}", field="kinds", expected=f"some of {', '.join(TRIAL_KINDS)}")
    if not 0.0 <= video_share <= 1.0:
        raise InputError(f"{video_share!r} is not usable", field="video share", expected="0 to 1")
    turns: list[TrialKind] = [kind for kind in ROUND if kind in kinds]
    places = dict.fromkeys(TRIAL_KINDS, 0)
    for index in range(count):
        kind = turns[index % len(turns)]
        random = np.random.default_rng([seed, index])
        effects = _hidden(kind, places[kind], seed, catalogued, outside, random)
        places[kind] += 1
        yield Dealt(index, kind, effects, _is_video(index, len(turns), video_share), random)


def log_uniform(random: np.random.Generator, low: float, high: float) -> float:
    """A number whose logarithm is drawn evenly."""
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def _turn(names: Sequence[str], place: int, seed: int) -> str:
    """Entry number `place` of an endless sequence of shuffled decks of names: all names are equally frequent."""
    deck, card = divmod(place, len(names))
    return str(np.random.default_rng([seed, 7, deck]).permutation(sorted(names))[card])


def _hidden(
    kind: TrialKind,
    place: int,
    seed: int,
    catalogued: Sequence[str],
    outside: Sequence[str],
    random: np.random.Generator,
) -> tuple[str, ...]:
    if kind == "null":
        return ()
    if kind == "unknown":
        return (_turn(outside, place, seed + 1),)
    first = _turn(catalogued, place, seed + 2 if kind == "single" else seed + 3)
    if kind == "single":
        return (first,)
    return first, str(random.choice(sorted(set(catalogued) - {first})))


def _is_video(index: int, turns: int, share: float) -> bool:
    """Every 1/share-th trial is a video, so that a short series has its share too. It moves on by one in each round, so
    that every kind occurs both ways.
    """
    place = index + index // turns
    return bool(np.floor((place + 0.5) * share + 0.5) > np.floor((place - 0.5) * share + 0.5))
