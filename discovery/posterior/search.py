"""The search: sets of effects ranked by linear algebra about a fitted model, and the best few refitted.

It repeats about the best of these, and stops when a round finds no better set.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from affine_model.arm import parameter_index
from affine_model.curvature import Array
from affine_model.effects import catalogue
from discovery.posterior.decide import log_masses, log_prior_of_set
from discovery.posterior.rank import MOST_EFFECTS, RankedSet, ranked_sets
from inference.posterior import Hypothesis, hypothesis
from inference.score import Candidate, score
from inference.trajectory import Problem

SINGLES, SETS, ROUNDS = 4, 2, 4


@dataclass(frozen=True)
class Search:
    """The base, all hypotheses that were refitted (the base first), and the candidates as the base's residual ranks
    them.
    """

    base: Hypothesis
    hypotheses: tuple[Hypothesis, ...]
    candidates: tuple[Candidate, ...]


def search(base: Hypothesis, progress: Callable[[float], None] = lambda _: None) -> Search:
    """Hypotheses about what the base lacks."""
    tried: dict[frozenset[str], Hypothesis] = {frozenset(): base}
    first: list[Candidate] = []
    centre = base
    for number in range(ROUNDS):
        wanted: dict[frozenset[str], tuple[Hypothesis, RankedSet]] = {}
        candidates, ranked = _ranked(centre)
        first = first or candidates
        singles = [one for one in ranked if len(one.names) == 1]
        several = [one for one in ranked if len(one.names) > 1]
        several = [one for one in several if singles and one.evidence > singles[0].evidence]
        for one in (*singles[: SINGLES if number == 0 else SETS], *several[:SETS]):
            effects = frozenset((*centre.effects, *one.names))
            if effects not in tried:
                wanted.setdefault(effects, (centre, one))
        fewer = [(centre, name) for name in centre.effects if frozenset(centre.effects) - {name} not in tried]
        tasks: list[Callable[[], Hypothesis]] = [
            *(lambda pair=pair: added(*pair) for pair in wanted.values()),
            *(lambda pair=pair: removed(*pair) for pair in fewer),
        ]
        for h in _side_by_side(tasks):
            if h is not None:
                tried[frozenset(h.effects)] = h
        progress((number + 1.0) / ROUNDS)
        best = max(tried.values(), key=lambda h: max(log_masses(h)))
        if best is centre or len(best.effects) >= MOST_EFFECTS:
            break
        centre = best
    return Search(base, tuple(tried.values()), tuple(first))


def _side_by_side(tasks: Iterable[Callable[[], Hypothesis]]) -> list[Hypothesis | None]:
    """The tasks' results: the kernel and the filter let other threads run while they compute."""
    workers = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 2
    with ThreadPoolExecutor(workers) as pool:
        return list(pool.map(_done, tasks))


def _done(task: Callable[[], Hypothesis]) -> Hypothesis | None:
    """The task's result; None where its runs left all bounds, so that no likelihood is known of it."""
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


def added(centre: Hypothesis, chosen: RankedSet) -> Hypothesis:
    """A hypothesis with a set of effects more, refitted from the strengths that its ranking estimates."""
    parameters = centre.fitted.parameters.copy()
    free = list(centre.problem.free)
    for candidate, values in zip(chosen.candidates, chosen.strengths, strict=True):
        effect = candidate.effect
        for shape, value in zip(effect.shapes, candidate.shapes, strict=True):
            parameters[parameter_index(effect.name, shape.name)] = value
        for strength, value in zip(effect.strengths, values, strict=True):
            low, high = strength.bounds
            reach = 20.0 * strength.nominal
            kept = np.clip(value, low + 1e-3 * strength.nominal, high - 1e-3 * strength.nominal)
            parameters[parameter_index(effect.name, strength.name)] = np.clip(kept, -reach, reach)
        free += candidate.free
    problem = replace(centre.problem, free=tuple(free), parameters=parameters)
    return _refitted((*centre.effects, *chosen.names), problem, centre.fitted.nuisances)


def removed(centre: Hypothesis, effect: str) -> Hypothesis:
    """A hypothesis without one of its effects, refitted."""
    parameters = centre.fitted.parameters.copy()
    for parameter in catalogue()[effect].parameters:
        parameters[parameter_index(effect, parameter.name)] = parameter.neutral
    free = tuple(name for name in centre.problem.free if name[0] != effect)
    problem = replace(centre.problem, free=free, parameters=parameters)
    return _refitted(tuple(e for e in centre.effects if e != effect), problem, centre.fitted.nuisances)


def _refitted(effects: tuple[str, ...], problem: Problem, nuisances: tuple[Array, ...]) -> Hypothesis:
    """With the memory at the start of each run among the unknowns where an effect relaxes, else without."""
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
    return hypothesis(effects, replace(problem, experiments=tuple(experiments)), tuple(kept))
