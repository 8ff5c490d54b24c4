"""Where the refits of a round begin: the most promising single effects, and sets of several, with their starts.

A set's promise is what it may gain: to first order (discovery.rank), or where its refit begins (discovery.starts),
whichever is more. The prior asks a set for T log P(fewer) / P(set) nats, T the coarsening of the decision.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from affine_model.effect import Parameter
from affine_model.effects import catalogue
from discovery.answer import MOST_EFFECTS
from discovery.decide import log_prior_of_set
from discovery.rank import RankedSet, Ranking
from discovery.side_by_side import side_by_side
from discovery.starts import Names, RefitStart, base_follows, is_far, refit_starts
from inference.decay import has_decay
from inference.fit import Fit, linearised_fit
from inference.posterior import Hypothesis
from inference.score import Candidate, without_response
from inference.successive_halving import Leg
from inference.whitened_fit import LinearRefit

SINGLES, SECOND, SETS = 7, 5, 2  # effects tried beside none, and beside others; sets of several tried at once
EVERY_EFFECT = len(catalogue())  # tried beside a model that is far from the data
SURELY_LESS = 0.5  # of what the prior asks for: a set that gains less even to first order is not fitted


@dataclass(frozen=True)
class Begun:
    """A set of effects to be added, without some of their shapes, and where its refit begins."""

    chosen: RankedSet
    without: Names
    starts: tuple[RefitStart, ...]


def may_be_named(begun: Begun, centre: Hypothesis, temperature: float) -> bool:
    """Whether a set may gain what its prior asks for: to first order, or where its refit begins."""
    if is_far(centre):
        return True
    sizes = len(centre.effects), len(centre.effects) + len(begun.chosen.names)
    asked = temperature * (log_prior_of_set(sizes[0]) - log_prior_of_set(sizes[1]))
    return promise(begun, centre) > SURELY_LESS * asked


def promise(begun: Begun, centre: Hypothesis) -> float:
    """What a set may gain [nats]: to first order, or where its refit begins, whichever is more. Added mass, for
    instance, scales all of the base's parameters: its valley is so narrow and curved that no start lies in it.
    """
    return max(begun.chosen.evidence, centre.fitted.misfit - begun.starts[0].cost)


def begun_about(centre: Hypothesis, promised: Ranking, start: Hypothesis, temperature: float) -> list[Begun]:
    """The most promising single effects, and sets of several, with their starts. A set must promise more than each
    single effect: a share SURELY_LESS of what the coarsened prior asks for its further effects.

    start: where single effects begin (in a decay, where the base's own fit began: sets of several do not begin there).
    """
    if len(centre.effects) == MOST_EFFECTS:
        return []
    ranked = {one.names[0]: one for one in promised.sets if len(one.names) == 1}
    candidates = [*promised.candidates, *_awoken(centre, promised)]
    alone = [ranked.get(one.effect.name, RankedSet((one,), -np.inf, (one.strengths,))) for one in candidates]
    refit = base_follows(centre, start)
    most = SECOND if centre.effects else EVERY_EFFECT if is_far(centre) else SINGLES
    singles = _begun(start, alone, refit, most)
    if has_decay(centre.problem) and not centre.effects:
        return singles
    linear = max((one.evidence for one in ranked.values()), default=np.inf)
    price = SURELY_LESS * temperature
    priors = {
        count: log_prior_of_set(len(centre.effects) + count) for count in {len(one.names) for one in promised.sets}
    }
    several = [
        one
        for one in promised.sets
        if len(one.names) > 1 and one.evidence > linear + price * (priors.get(1, 0.0) - priors[len(one.names)])
    ]
    order = np.argsort([-(one.evidence + priors[len(one.names)]) for one in several], kind="stable")
    return [*singles, *_begun(centre, [several[k] for k in order[:SETS]], refit, SETS)]


def _awoken(centre: Hypothesis, promised: Ranking) -> list[Candidate]:
    """Effects that may act once the base of a model that is far from the data leaves its bound (discovery.starts)."""
    astray = is_far(centre) and bool(centre.fitted.at_bound)
    if centre.effects or not astray or has_decay(centre.problem):
        return []
    return without_response(centre.problem, promised.candidates)


def at_origin(base: Hypothesis, origin: Fit) -> Hypothesis:
    """The base where its fit began, where that is a decay's; else as it is."""
    if not has_decay(base.problem):
        return base
    problem = replace(base.problem, parameters=origin.parameters)
    there = np.concatenate([origin.values, *origin.nuisances])
    return replace(base, problem=problem, fitted=linearised_fit(problem, there, 0))


def _begun(centre: Hypothesis, ranked: list[RankedSet], refit: LinearRefit | tuple[Leg, ...], most: int) -> list[Begun]:
    """The `most` most promising sets, in successive halving by where their refits begin; each with all of its shapes,
    and without some.

    refit: see base_follows. In successive halving each choice of shapes is followed for itself, for it may end in
    another valley.
    """
    begun = side_by_side([lambda one=one: Begun(one, (), tuple(refit_starts(centre, one, refit))) for one in ranked])
    linear = isinstance(refit, LinearRefit)
    best = sorted(begun, key=lambda one: -promise(one, centre) if linear else one.starts[0].cost)[:most]
    fewer = [(one, names) for one in best for names in _left_out(one.chosen)]
    if linear:
        return [*best, *(replace(one, without=names) for one, names in fewer)]
    tasks = [
        lambda one=one, names=names: Begun(one.chosen, names, tuple(refit_starts(centre, one.chosen, refit, names)))
        for one, names in fewer
    ]
    return [*best, *side_by_side(tasks)]


def _left_out(chosen: RankedSet) -> list[Names]:
    """Shapes in which an effect's published laws differ: further fits leave them at their neutral values.

    All of them; and of an effect that has several, all but the first of each effect.
    """
    of = [[(c.effect.name, one.name) for one in c.effect.shapes if _is_a_variant(one)] for c in chosen.candidates]
    nested = [tuple(name for names in of for name in names[first:]) for first in range(max(map(len, of), default=0))]
    return [names for names in nested if names]


def _is_a_variant(shape: Parameter) -> bool:
    """Whether the law without this shape is a published one: its neutral value is none, or the end of its range."""
    return shape.neutral in (0.0, *shape.bounds)
