"""What a library's recordings say together: which effect acts in which of them, and which parameter changes with time.

    P(effect | all) ~ prior(effect) mean over its directions of  exp(evidence(direction))         one effect more
    claims = the largest family of (effect, recording) with  mean over the family of (1 - P(acts there | all)) <= .05

evidence: discovery.library.presence, of the recordings' own estimates (discovery.library.pooled). Effects are added one
after the other, each beside those before, while P(none more) is below .05; the prior is that of a diagnosis. Effects
that hold 95 % of the mass together are a group, for these recordings cannot tell them apart. The expected share of
false claims is the mean of their local false discovery rates. Parameters whose trend has a p-value within the family of
Benjamini and Hochberg at .05 have changed. Sources: Benjamini and Hochberg 1995; Newton and others 2004 (claims by
posterior probability).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import false_discovery_control

from discovery.answer import MOST_EFFECTS
from discovery.decide import CREDIBLE, log_prior_of_set
from discovery.library.evidence import RecordingEvidence
from discovery.library.pooled import Direction, KnownEffect, Pool, directions, estimates_of, pool_of, strengths_where
from discovery.library.presence import Estimates, Presence, presence
from discovery.library.trend import Trend
from inference.trajectory import ParameterName
from tentacle.signals import Array

FALSE_CLAIMS = 0.05  # expected share of false ones among all claims


@dataclass(frozen=True)
class FoundEffect:
    """An effect that acts in some recordings. names: it alone, or the group that these recordings cannot tell apart,
    most likely first, with their masses; direction: of the first. acts (R,): probability in each recording; claimed
    (R,): whether that is claimed. estimates, deviations (R,): of each recording alone, in nominal sizes along the
    direction. strengths: parameter -> value, low, high (95 %), of the first.
    """

    names: tuple[str, ...]
    masses: tuple[float, ...]
    direction: Direction
    evidence: float
    acts: Array
    claimed: NDArray[np.bool_]
    estimates: Array
    deviations: Array
    strengths: dict[str, tuple[float, float, float]]


@dataclass(frozen=True)
class JointAnswer:
    """effects: found, in the order in which they were found; trends: of every base parameter; changed: those that have.

    false_claims: expected share of false ones among the claims. mass_of_none: probability that no further effect acts.
    """

    effects: tuple[FoundEffect, ...]
    trends: dict[ParameterName, Trend]
    changed: tuple[ParameterName, ...]
    false_claims: float
    mass_of_none: float
    pool: Pool


def combine(
    recordings: Sequence[RecordingEvidence], days: Array, progress: Callable[[float], None] = lambda _: None
) -> JointAnswer:
    """The joint answer of one arm's recordings in time order; days (R,): when they were made [d]."""
    pool = pool_of(recordings, days)
    sought = directions(recordings)
    found: list[FoundEffect] = []
    none = 1.0
    for number in range(MOST_EFFECTS + 1):
        left = [one for one in sought if one.effect not in {name for f in found for name in f.names[:1]}]
        estimates, presences = estimates_of(pool, left), list[Presence]()
        for k, one in enumerate(estimates):
            presences.append(presence(one))
            progress((number + (k + 1.0) / len(left)) / (MOST_EFFECTS + 1.0))
        none, masses = _masses(left, presences, number)
        if none >= 1.0 - CREDIBLE or number == MOST_EFFECTS:
            break
        best = _best(left, presences, masses)
        acting = KnownEffect(left[best], presences[best])
        found.append(_found(pool, acting, estimates[best], masses))
        pool = pool.with_acting(acting)
    claimed, false_claims = claims([one.acts for one in found])
    effects = tuple(replace(one, claimed=which) for one, which in zip(found, claimed, strict=True))
    return JointAnswer(effects, pool.lines, _changed(pool.lines), false_claims, none, pool)


def _masses(left: Sequence[Direction], presences: Sequence[Presence], count: int) -> tuple[float, dict[str, float]]:
    """Probability that no further effect acts, and that each effect does, beside `count` that are found."""
    if count >= MOST_EFFECTS or not left:
        return 1.0, {}
    ahead = log_prior_of_set(count + 1) - log_prior_of_set(count)
    names = list(dict.fromkeys(one.effect for one in left))
    logs = []
    for name in names:
        own = [p.evidence for one, p in zip(left, presences, strict=True) if one.effect == name]
        logs.append(ahead + float(np.logaddexp.reduce(own)) - np.log(len(own)))
    total = float(np.logaddexp.reduce([0.0, *logs]))
    return float(np.exp(-total)), {name: float(np.exp(log - total)) for name, log in zip(names, logs, strict=True)}


def _best(left: Sequence[Direction], presences: Sequence[Presence], masses: dict[str, float]) -> int:
    """The place of the best direction of the effect with the largest mass."""
    name = max(masses, key=lambda one: masses[one])
    return max((k for k, one in enumerate(left) if one.effect == name), key=lambda k: presences[k].evidence)


def _found(pool: Pool, acting: KnownEffect, estimates: Estimates, masses: dict[str, float]) -> FoundEffect:
    """The acting effect with the others that together hold CREDIBLE of the mass."""
    order, some = sorted(masses, key=lambda name: -masses[name]), sum(masses.values())
    count = int(np.searchsorted(np.cumsum([masses[name] for name in order]), CREDIBLE * some)) + 1
    there = acting.presence
    return FoundEffect(
        names=tuple(order[:count]),
        masses=tuple(masses[name] for name in order[:count]),
        direction=acting.direction,
        evidence=there.evidence,
        acts=there.acts * some,
        claimed=there.acts > 0.5,
        estimates=estimates.values,
        deviations=estimates.deviations,
        strengths=strengths_where(pool, acting),
    )


def claims(acts: Sequence[Array]) -> tuple[list[NDArray[np.bool_]], float]:
    """Which (effect, recording) are claimed, and the expected share of false ones among them.

    acts: probability (R,) of each effect in each recording. Only what is more likely than not is claimed.
    """
    if not acts:
        return [], 0.0
    every = np.concatenate(list(acts))
    order = np.argsort(-every, kind="stable")
    rates = np.cumsum(1.0 - every[order]) / np.arange(1, every.size + 1)
    count = int(np.sum((rates <= FALSE_CLAIMS) & (every[order] > 0.5)))
    chosen = np.zeros(every.size, dtype=bool)
    chosen[order[:count]] = True
    ends = np.cumsum([one.size for one in acts])[:-1]
    return np.split(chosen, ends), float(rates[count - 1]) if count else 0.0


def _changed(lines: dict[ParameterName, Trend]) -> tuple[ParameterName, ...]:
    tested = {name: trend.p_value for name, trend in lines.items() if trend.p_value is not None}
    if not tested:
        return ()
    adjusted = false_discovery_control(list(tested.values()), method="bh")
    return tuple(name for name, p in zip(tested, adjusted, strict=True) if p <= FALSE_CLAIMS)
