"""In which of several recordings an effect acts.

    log P(where) = log 1/2 in all of them, else log (1/2 / (2^K - 2))        K recordings, of each effect by itself

Each effect is left out of the recordings that it does not help to explain, and the model is fitted again. The choice
counts if the evidence, coarsened like the decision's, grows by more than log P(all) / P(where).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from inference.experiment import Experiment
from inference.fit import minimised
from inference.latent_force import LatentForce
from inference.posterior import ROUGHLY, Hypothesis, RoughFit, fit_hypothesis

MOST_ROUNDS = 20  # of a fit of one recording's own unknowns


def fit_where_it_acts(rough: RoughFit, declared: tuple[LatentForce, ...], temperature: float) -> Hypothesis:
    """The hypothesis, fitted; of several recordings each effect acts in those that it helps to explain."""
    h = fit_hypothesis(rough, declared)
    count = sum(not experiment.complete for experiment in h.problem.experiments)
    if count < 2 or not h.effects:
        return h
    chosen = _where_they_help(h)
    if all(new.lacks == old.lacks for new, old in zip(chosen, h.problem.experiments, strict=True)):
        return h
    problem = replace(h.problem, experiments=chosen, parameters=h.fitted.parameters, filters=())
    placed = fit_hypothesis(RoughFit(h.effects, problem, h.fitted.nuisances, h.fitted.misfit), declared)
    price = temperature * (_log_prior(h.problem.experiments, h.effects) - _log_prior(chosen, h.effects))
    priced = replace(placed, log_evidence=placed.log_evidence - max(price, 0.0))
    return max(h, priced, key=lambda one: one.highest())


def _where_they_help(h: Hypothesis) -> tuple[Experiment, ...]:
    """The experiments, each without the effects that its own frames speak against; no effect is left out of all."""
    found = list(h.problem.experiments)
    for effect in h.effects:
        gains = [_gain(h, place, effect) for place in range(len(found))]
        acts = [gain > 0.0 for gain in gains]
        if not any(acts):
            continue
        for place, acting in enumerate(acts):
            if not found[place].complete:
                lacks = found[place].lacks - {effect} if acting else found[place].lacks | {effect}
                found[place] = replace(found[place], lacks=lacks)
    return tuple(found)


def _gain(h: Hypothesis, place: int, effect: str) -> float:
    """The nats that the effect, at its strength in all recordings, gains in one of them; its own unknowns refitted."""
    experiment = h.problem.experiments[place]
    if experiment.complete:
        return -np.inf
    filters = h.problem.filters[place : place + 1]
    alone = replace(h.problem, free=(), parameters=h.fitted.parameters, filters=filters)
    costs = []
    for lacks in (experiment.lacks - {effect}, experiment.lacks | {effect}):
        problem = replace(alone, experiments=(replace(experiment, lacks=lacks),))
        costs.append(minimised(problem, (h.fitted.nuisances[place],), tolerance=ROUGHLY, most=MOST_ROUNDS)[1].cost)
    return costs[1] - costs[0]


def _log_prior(experiments: tuple[Experiment, ...], effects: tuple[str, ...]) -> float:
    """log P(where) of these effects together."""
    count = sum(not experiment.complete for experiment in experiments)
    some = sum(any(effect in experiment.lacks for experiment in experiments) for effect in effects)
    return len(effects) * np.log(0.5) - some * np.log(2.0**count - 2.0)
