"""The search: all sets of effects are ranked by linear algebra about a fitted model, and the best few are refitted.

The next round does the same about the best of these. The search stops if a round finds no better set.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar

import numpy as np

from affine_model.arm import parameter_index
from affine_model.curvature import Array
from affine_model.effects import catalogue
from discovery.answer import MOST_EFFECTS
from discovery.posterior.decide import log_masses, log_prior_of_set, missing_of
from discovery.posterior.rank import RankedSet, ranked_sets
from discovery.posterior.starts import RefitStart, refit_starts
from inference.posterior import Hypothesis, RoughFit, fit_hypothesis, rough_fit, with_rest
from inference.score import Candidate, score
from inference.trajectory import Fit, Problem, linearised_fit

T = TypeVar("T")
SINGLES, SETS, ROUNDS = 7, 2, 4
FAR, ROOM = 15.0, 0.5  # nats, or share of the best rough gain: a rough fit further behind cannot become the best
NEGLIGIBLE_NATS = 12.0  # nats behind the best: a hypothesis further behind has no mass


@dataclass(frozen=True)
class PosteriorSearch:
    """The base, all refitted hypotheses (the base first), and the candidates as the base's score test ranks them."""

    base: Hypothesis
    hypotheses: tuple[Hypothesis, ...]
    candidates: tuple[Candidate, ...]


def search_posterior(
    base: Hypothesis, origin: Fit, progress: Callable[[float], None] = lambda _: None
) -> PosteriorSearch:
    """Search hypotheses about what the base lacks. origin: the start of the base's own fit.

    In a decay the effects begin there too, as the fitted base may be far from the minimum of any of them.
    """
    tried: dict[frozenset[str], Hypothesis] = {frozenset(): base}
    first: list[Candidate] = []
    centre = base
    for number in range(ROUNDS):
        candidates, ranked = _ranked(centre)
        first = first or candidates
        alone = [RankedSet((one,), one.gain, (one.strengths,)) for one in candidates]
        singles = _begun(centre if number else _at(base, origin), alone)
        several = [one for one in ranked if len(one.names) > 1]
        linear = max((one.evidence for one in ranked if len(one.names) == 1), default=np.inf)
        several = _begun(centre, [one for one in several if one.evidence > linear][:SETS])
        wanted = [
            begun
            for begun in (*singles[: SINGLES if number == 0 else SETS], *several)
            if frozenset((*centre.effects, *begun.chosen.names)) not in tried
        ]
        fewer = [name for name in centre.effects if frozenset(centre.effects) - {name} not in tried]
        tasks: list[Callable[[], RoughFit]] = [
            *(partial(added, centre, begun) for begun in wanted),
            *(partial(added, centre, begun, plain=True) for begun in wanted if _has_plain(begun.chosen)),
            *(partial(removed, centre, name) for name in fewer),
        ]
        for h in _side_by_side([partial(fit_hypothesis, one) for one in _promising(_side_by_side(tasks))]):
            known = tried.get(frozenset(h.effects))
            if known is None or h.log_evidence.max() > known.log_evidence.max():
                tried[frozenset(h.effects)] = h
        progress((number + 1.0) / ROUNDS)
        tried = _with_rests(tried)
        missing = missing_of(list(tried.values()))
        best = max(tried.values(), key=lambda h: max(log_masses(h, missing)))
        if best.effects == centre.effects or len(best.effects) >= MOST_EFFECTS:
            break
        centre = best
    return PosteriorSearch(tried[frozenset()], tuple(tried.values()), tuple(first))


def _with_rests(tried: dict[frozenset[str], Hypothesis]) -> dict[frozenset[str], Hypothesis]:
    """The hypotheses; those that may have mass get their rest."""
    missing = missing_of(list(tried.values()))
    reach = max(max(log_masses(h, missing)) for h in tried.values()) - NEGLIGIBLE_NATS
    base = tried[frozenset()]
    base = base if base.alone is not None else with_rest(base)
    asked = [h for h in tried.values() if h.effects and h.alone is None and max(log_masses(h, missing)) > reach]
    found = _side_by_side([partial(with_rest, h, base) for h in asked])
    return tried | {frozenset(): base} | {frozenset(h.effects): h for h in found}


def _promising(roughs: list[RoughFit]) -> list[RoughFit]:
    """The rough fits that may still be the best after a close fit."""
    costs = np.array([one.cost for one in roughs])
    least, most = (costs.min(), costs.max()) if costs.size else (0.0, 0.0)
    return [one for one in roughs if one.cost <= least + max(FAR, ROOM * (most - least))]


def _side_by_side(tasks: Iterable[Callable[[], T]]) -> list[T]:
    """The results of the tasks, in threads: kernel and filter release the lock. Tasks without a result are left out."""
    workers = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 2
    with ThreadPoolExecutor(workers) as pool:
        results: list[T | None] = list(pool.map(lambda task: _done(task), tasks))
    return [result for result in results if result is not None]


def _done(task: Callable[[], T]) -> T | None:
    """The task's result; None if its simulations diverged, so that it has no likelihood."""
    try:
        return task()
    except np.linalg.LinAlgError:
        return None


def _ranked(centre: Hypothesis) -> tuple[list[Candidate], list[RankedSet]]:
    """Candidates, and sets of them, about a hypothesis at its own share of unknown forces."""
    candidates = score(centre.problem, centre.fitted)
    ranked = ranked_sets(centre.fitted, candidates, MOST_EFFECTS - len(centre.effects))
    prior = [log_prior_of_set(len(centre.effects) + len(one.names)) for one in ranked]
    order = np.argsort([-(one.evidence + p) for one, p in zip(ranked, prior, strict=True)], kind="stable")
    return candidates, [ranked[k] for k in order]


def _at(base: Hypothesis, origin: Fit) -> Hypothesis:
    """The base at the start of its fit if a recording is a decay; otherwise unchanged."""
    if all(experiment.release is None for experiment in base.problem.experiments):
        return base
    problem = replace(base.problem, parameters=origin.parameters)
    there = np.concatenate([origin.values, *origin.nuisances])
    return replace(base, problem=problem, fitted=linearised_fit(problem, there, 0))


@dataclass(frozen=True)
class Begun:
    """A set of effects to be added, and where its refit begins."""

    chosen: RankedSet
    starts: tuple[RefitStart, ...]


def _begun(centre: Hypothesis, ranked: list[RankedSet]) -> list[Begun]:
    """The sets with their starts, the lowest cost first: the score test misleads beyond the linear regime."""
    begun = _side_by_side([lambda one=one: Begun(one, tuple(refit_starts(centre, one))) for one in ranked])
    return sorted(begun, key=lambda one: one.starts[0].cost)


def _has_plain(chosen: RankedSet) -> bool:
    """Whether one of the effects has a shape that may be zero, such as a payload at the tip itself."""
    return any(shape.neutral == 0.0 for candidate in chosen.candidates for shape in candidate.effect.shapes)


def added(centre: Hypothesis, of: Begun, *, plain: bool = False) -> RoughFit:
    """Fit roughly with these effects added, from the best starts. plain: shapes that may be zero are zero."""
    chosen = of.chosen
    new = [name for candidate in chosen.candidates for name in candidate.free]
    none = []
    if plain:
        shapes = [(c.effect.name, shape) for c in chosen.candidates for shape in c.effect.shapes]
        none = [(effect, shape.name) for effect, shape in shapes if shape.neutral == 0.0]
    free = (*centre.problem.free, *(name for name in new if name not in none))
    begun = []
    for start in of.starts:
        parameters = start.parameters.copy()
        for name in none:
            parameters[parameter_index(*name)] = 0.0
        problem = replace(centre.problem, free=free, parameters=parameters, filters=())
        begun.append((problem, start.nuisances))
    return _refitted((*centre.effects, *chosen.names), begun, centre)


def removed(centre: Hypothesis, effect: str) -> RoughFit:
    """Fit roughly without one of the effects."""
    parameters = centre.fitted.parameters.copy()
    for parameter in catalogue()[effect].parameters:
        parameters[parameter_index(effect, parameter.name)] = parameter.neutral
    free = tuple(name for name in centre.problem.free if name[0] != effect)
    problem = replace(centre.problem, free=free, parameters=parameters)
    begun = [(problem, centre.fitted.nuisances)]
    return _refitted(tuple(e for e in centre.effects if e != effect), begun, centre)


def _refitted(effects: tuple[str, ...], begun: list[tuple[Problem, tuple[Array, ...]]], centre: Hypothesis) -> RoughFit:
    """Fit roughly from those starts."""
    return rough_fit(effects, [_remembering(effects, *start) for start in begun], centre.forces, centre.share)


def _remembering(
    effects: tuple[str, ...], problem: Problem, nuisances: tuple[Array, ...]
) -> tuple[Problem, tuple[Array, ...]]:
    """Make the initial memory of each run an unknown if an effect has a relaxation time; otherwise remove it."""
    wanted = any(catalogue()[name].relaxation_time is not None for name in effects)
    experiments, kept = [], []
    for experiment, values in zip(problem.experiments, nuisances, strict=True):
        changed = replace(experiment, remembers=wanted)
        start, moving, memory, shift = experiment.parts(problem.arm.order, values)
        if not changed.begins_with_memory:
            memory = memory[:0]
        elif not memory.size:
            memory = np.zeros(problem.arm.order)
        experiments.append(changed)
        kept.append(np.concatenate([start, moving, memory, shift, experiment.deviations(values)]))
    return replace(problem, experiments=tuple(experiments)), tuple(kept)
