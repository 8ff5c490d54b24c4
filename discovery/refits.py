"""Refits of a centre with effects more or fewer, each rough: only the best of them are then fitted closely."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from affine_model.arm import neutral_parameters, parameter_index
from affine_model.curvature import Array
from affine_model.effects import catalogue
from discovery.begin import Begun
from inference.decay import DECAY_SHARE, has_decay
from inference.linearise import latent_forces
from inference.posterior import Hypothesis, RoughFit, rough_fit
from inference.trajectory import Problem


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


def removed(centre: Hypothesis, *effects: str) -> RoughFit:
    """Some of the effects less, fitted roughly from where the others stand."""
    parameters = centre.fitted.parameters.copy()
    for effect in effects:
        for parameter in catalogue()[effect].parameters:
            parameters[parameter_index(effect, parameter.name)] = parameter.neutral
    free = tuple(name for name in centre.problem.free if name[0] not in effects)
    experiments = tuple(replace(e, lacks=e.lacks - set(effects)) for e in centre.problem.experiments)
    problem = replace(centre.problem, experiments=experiments, free=free, parameters=parameters)
    begun = [(problem, centre.fitted.nuisances)]
    return _refitted(tuple(e for e in centre.effects if e not in effects), begun, centre)


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
