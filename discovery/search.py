"""The search: sets of effects ranked by linear algebra about a fitted model, and the best few refitted.

It repeats about the best of these, and stops when a round finds no better set.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from affine_model.arm import neutral_parameters, parameter_index
from affine_model.curvature import Array
from affine_model.effect import Parameter
from affine_model.effects import catalogue
from discovery.answer import MOST_EFFECTS
from discovery.decide import log_masses, log_prior_of_set, missing_of
from discovery.rank import RankedSet, Ranking, ranking
from discovery.side_by_side import side_by_side
from discovery.starts import Names, RefitStart, base_follows, is_far, refit_starts
from discovery.where import fit_where_it_acts
from inference.decay import DECAY_SHARE, has_decay
from inference.fit import Fit, linearised_fit
from inference.latent_force import LatentForce
from inference.linearise import latent_forces
from inference.posterior import Hypothesis, RoughFit, rough_fit, with_derivatives, with_rest, without_derivatives
from inference.score import Candidate
from inference.successive_halving import Leg
from inference.trajectory import Problem
from inference.whitened_fit import LinearRefit

SINGLES, SECOND, SETS = 7, 5, 2  # effects tried beside none, and beside others; sets of several tried at once
EVERY_EFFECT = len(catalogue())  # tried beside a model that is far from the data
ROUNDS = 6
FAR, ROOM = 15.0, 0.5  # nats, or share of what the best rough fit gains, behind which no close fit catches up
FOR_A_SHAPE = 3.0  # nats: what a fitted shape must gain over its neutral value; chosen on the silicone beam
SURELY_LESS = 0.5  # of what the prior asks for: a set that gains less even to first order is not fitted
NEGLIGIBLE_NATS = 12.0  # nats behind the best: what lies further behind holds no mass, whatever it leaves


@dataclass(frozen=True)
class PosteriorSearch:
    """The base, all hypotheses that were refitted (the base first), and the candidates as the base's residual ranks
    them.
    """

    base: Hypothesis
    hypotheses: tuple[Hypothesis, ...]
    candidates: tuple[Candidate, ...]


@dataclass(frozen=True)
class Begun:
    """A set of effects to be added, without some of their shapes, and where its refit begins."""

    chosen: RankedSet
    without: Names
    starts: tuple[RefitStart, ...]


def search_posterior(
    base: Hypothesis, origin: Fit, progress: Callable[[float], None] = lambda _: None
) -> PosteriorSearch:
    """Hypotheses about what the base lacks. origin: where the base's own fit began. Effects begin there too, because in
    a decay the base's fit may be far from the valley of any effect.
    """
    tried: dict[frozenset[str], Hypothesis] = {frozenset(): base}
    first: tuple[Candidate, ...] = ()
    centre, decays = base, has_decay(base.problem)
    for number in range(ROUNDS):
        temperature = missing_of(list(tried.values())).temperature
        promised = ranking(centre, MOST_EFFECTS - len(centre.effects), temperature)
        first = first or promised.candidates
        wanted = [
            begun
            for begun in _begun_about(centre, promised, centre if number else _at(base, origin), temperature)
            if is_fitted_anew((*centre.effects, *begun.chosen.names), centre, tried)
            and (decays or _may_be_named(begun, centre, temperature))
        ]
        tasks: list[Callable[[], RoughFit]] = [
            *(partial(added, centre, begun) for begun in wanted),
            *(partial(removed, centre, name) for name in centre.effects if len(centre.effects) > 1 or decays),
        ]
        promising = _promising(side_by_side(tasks))
        found = side_by_side([partial(_fitted, one, base.forces, temperature) for one in promising])
        temperature = missing_of([*tried.values(), *found]).temperature
        for h in found:
            if not h.effects:  # a decay's base, fitted from where an effect had left it
                share, coarsening = base.baseline_share, base.baseline_coarsening
                h = replace(h, baseline_share=share, baseline_coarsening=coarsening, motion=base.motion)
            known = tried.get(frozenset(h.effects))
            tried[frozenset(h.effects)] = h if known is None else _preferred(h, known, temperature)
        progress((number + 1.0) / ROUNDS)
        tried = _with_rests(tried)
        missing = missing_of(list(tried.values()))
        best = max(tried.values(), key=lambda h: max(log_masses(h, missing)))
        if best.effects == centre.effects:
            break
        centre = with_derivatives(best)
    return PosteriorSearch(tried[frozenset()], tuple(tried.values()), first)


def is_fitted_anew(effects: tuple[str, ...], centre: Hypothesis, tried: dict[frozenset[str], Hypothesis]) -> bool:
    """Whether a set that contains the centre's is to be fitted: it is not yet, or its fit has less evidence than the
    centre. The larger model contains the smaller one, so that this fit ended in another valley.
    """
    known = tried.get(frozenset(effects))
    return known is None or float(known.log_evidence.max()) < float(centre.log_evidence.max()) - FAR


def _fitted(rough: RoughFit, declared: tuple[LatentForce, ...], temperature: float) -> Hypothesis:
    """The hypothesis, fitted closely. Dozens are kept, so that their derivatives are not."""
    return without_derivatives(fit_where_it_acts(rough, declared, temperature))


def _preferred(h: Hypothesis, known: Hypothesis, temperature: float) -> Hypothesis:
    """The one of two fits of a set with the larger evidence; a shape is fitted only where the evidence, coarsened like
    the decision's, asks for it.
    """
    few, more = sorted((h, known), key=lambda one: len(one.problem.free))
    asked = FOR_A_SHAPE * temperature if len(few.problem.free) < len(more.problem.free) else 0.0
    return more if more.log_evidence.max() > few.log_evidence.max() + asked else few


def _with_rests(tried: dict[frozenset[str], Hypothesis]) -> dict[frozenset[str], Hypothesis]:
    """The hypotheses, those that may count with the rest that they leave."""
    missing = missing_of(list(tried.values()))
    reach = max(max(log_masses(h, missing)) for h in tried.values()) - NEGLIGIBLE_NATS
    base = tried[frozenset()]
    base = base if base.alone is not None else with_rest(base)
    asked = [h for h in tried.values() if h.effects and h.alone is None and max(log_masses(h, missing)) > reach]
    found = side_by_side([partial(with_rest, h, base) for h in asked])
    return tried | {frozenset(): base} | {frozenset(h.effects): h for h in found}


def _may_be_named(begun: Begun, centre: Hypothesis, temperature: float) -> bool:
    """Whether a set may gain what its prior asks for: to first order, or where its refit begins."""
    if is_far(centre):
        return True
    sizes = len(centre.effects), len(centre.effects) + len(begun.chosen.names)
    asked = temperature * (log_prior_of_set(sizes[0]) - log_prior_of_set(sizes[1]))
    return _promise(begun, centre) > SURELY_LESS * asked


def _promise(begun: Begun, centre: Hypothesis) -> float:
    """What a set may gain [nats]: to first order, or where its refit begins, whichever is more. Added mass, for
    instance, scales all of the base's parameters: its valley is so narrow and curved that no start lies in it.
    """
    return max(begun.chosen.evidence, centre.fitted.misfit - begun.starts[0].cost)


def _promising(roughs: list[RoughFit]) -> list[RoughFit]:
    """Those that may still be the best when they are fitted closely, and the best of each number of effects: more
    effects leave less, whatever acts.
    """
    sets: dict[tuple[str, ...], float] = {}
    best: dict[int, float] = {}
    for one in roughs:
        sets[one.effects] = min(one.cost, sets.get(one.effects, np.inf))
        best[len(one.effects)] = min(one.cost, best.get(len(one.effects), np.inf))
    costs = np.array(list(sets.values()))
    least, most = (costs.min(), costs.max()) if costs.size else (0.0, 0.0)
    reach = least + max(FAR, ROOM * (most - least))
    return [one for one in roughs if one.cost <= max(reach, best[len(one.effects)])]


def _begun_about(centre: Hypothesis, promised: Ranking, start: Hypothesis, temperature: float) -> list[Begun]:
    """The most promising single effects, and sets of several, with their starts. A set must promise more than each
    single effect: a share SURELY_LESS of what the coarsened prior asks for its further effects.

    start: where single effects begin (in a decay, where the base's own fit began: sets of several do not begin there).
    """
    if len(centre.effects) == MOST_EFFECTS:
        return []
    ranked = {one.names[0]: one for one in promised.sets if len(one.names) == 1}
    alone = [ranked.get(one.effect.name, RankedSet((one,), -np.inf, (one.strengths,))) for one in promised.candidates]
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


def _at(base: Hypothesis, origin: Fit) -> Hypothesis:
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
    best = sorted(begun, key=lambda one: -_promise(one, centre) if linear else one.starts[0].cost)[:most]
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


def added(centre: Hypothesis, of: Begun) -> RoughFit:
    """A set of effects more, fitted roughly from the best starts."""
    new = [name for candidate in of.chosen.candidates for name in candidate.free]
    free = (*centre.problem.free, *(name for name in new if name not in of.without))
    begun, neutral = [], neutral_parameters()
    for start in of.starts:
        parameters = start.parameters.copy()
        for name in of.without:
            parameters[parameter_index(*name)] = neutral[parameter_index(*name)]
        problem = replace(centre.problem, free=free, parameters=parameters, filters=())
        begun.append((problem, start.nuisances))
    return _refitted((*centre.effects, *of.chosen.names), begun, centre)


def removed(centre: Hypothesis, effect: str) -> RoughFit:
    """One of the effects less, fitted roughly."""
    parameters = centre.fitted.parameters.copy()
    for parameter in catalogue()[effect].parameters:
        parameters[parameter_index(effect, parameter.name)] = parameter.neutral
    free = tuple(name for name in centre.problem.free if name[0] != effect)
    experiments = tuple(replace(e, lacks=e.lacks - {effect}) for e in centre.problem.experiments)
    problem = replace(centre.problem, experiments=experiments, free=free, parameters=parameters)
    begun = [(problem, centre.fitted.nuisances)]
    return _refitted(tuple(e for e in centre.effects if e != effect), begun, centre)


def _refitted(effects: tuple[str, ...], begun: list[tuple[Problem, tuple[Array, ...]]], centre: Hypothesis) -> RoughFit:
    """Fitted roughly from those starts; a decay beside unknown forces as about its first start, not its centre's."""
    begun = [_remembering(effects, *start) for start in begun]
    if not has_decay(centre.problem):
        return rough_fit(effects, begun, centre.forces, centre.share)
    problem, nuisances = begun[0]
    return rough_fit(
        effects, begun, latent_forces(problem, problem.parameters, nuisances, effects, centre.forces), DECAY_SHARE
    )


def _remembering(
    effects: tuple[str, ...], problem: Problem, nuisances: tuple[Array, ...]
) -> tuple[Problem, tuple[Array, ...]]:
    """With the memory at the start of each run among the unknowns where an effect or a declared law relaxes."""
    experiments, kept = [], []
    for experiment, values in zip(problem.experiments, nuisances, strict=True):
        acting = (*effects, *experiment.declared)
        changed = replace(experiment, remembers=any(catalogue()[name].relaxation_time is not None for name in acting))
        start, moving, memory, shift = experiment.parts(problem.arm.order, values)
        if not changed.begins_with_memory:
            memory = memory[:0]
        elif not memory.size:
            memory = np.zeros(problem.arm.order)
        experiments.append(changed)
        kept.append(np.concatenate([start, moving, memory, shift, experiment.deviations(values)]))
    return replace(problem, experiments=tuple(experiments)), tuple(kept)
