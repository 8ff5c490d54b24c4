"""Refits of a hypothesis: with one more or one fewer effect, other noise, fewer coordinates, or a finer step."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import product

import numpy as np

from affine_model.arm import Arm, parameter_index
from affine_model.curvature import Array
from affine_model.effects import catalogue
from inference.hypothesis import (
    GatedHypothesis,
    against_baseline,
    gated_hypothesis,
    material_gain,
    nats_per_parameter,
)
from inference.score import Candidate
from inference.sufficient_step import sufficient_step, unbiased_noise
from inference.trajectory import Fit, Problem, fit, unfitted

LINEAR = 2.0  # noise sigmas of structure up to which the score test's linear picture holds
START_SHARES = (1.0, 0.4)  # of a candidate's estimated strengths, to start from
# Beyond the linear regime the missing effect biases the base, and a refit also starts from other base values:
STIFFER = (0.6, 0.8, 1.0, 1.3, 1.7)  # times the elasticity
RELAXATIONS = (None, 0.003, 0.01)  # s: damping over elasticity (None: as fitted)
DRAGGIER = (1.0, 1.4)  # times the drag
NEAR_NOISE = 0.5 * (1.0 + LINEAR**2)  # nats a residual: a fit this good is near its minimum
COUNTERPART = {("damping", "eta"): ("elasticity", "E"), ("damping", "d0"): ("elasticity", "k0")}
COUNTERPART[("damping", "d1")] = ("elasticity", "k1")


def refit(current: GatedHypothesis, candidate: Candidate) -> GatedHypothesis:
    """Fit the current model with the candidate added, from its estimated strengths.

    If the fit gains less than the score test predicts, the next best start is tried.
    """
    problem = _with_candidate(current.problem, current.fitted, candidate)
    problem, nuisances = _remembering(problem, current.fitted.nuisances)
    best: Fit | None = None
    beyond = current.train.structure >= LINEAR
    promised = current.fitted.misfit - 0.5 * candidate.gain
    starts = _starts(problem, nuisances, current, candidate)
    for start in starts:
        fitted = fit(_at(problem, start), nuisances, tolerance=_enough(current), most=20)
        if best is None or fitted.misfit < best.misfit:
            best = fitted
        near_noise = not beyond or best.misfit < NEAR_NOISE * best.count
        if near_noise and best.misfit < promised:
            break
    assert best is not None
    # A stiff law may need a finer step than the model without it. A fit that gains too little may have left the region
    # where the step is too coarse, so the step is checked at the start of the fit too.
    places = [best] if beyond else []
    if best.misfit > promised:
        places.append(unfitted(_at(problem, starts[-1] if beyond else starts[0]), nuisances))
    for place in places:
        if (step := sufficient_step(problem, place)) < problem.step:
            finer = replace(problem, step=step)
            again = fit(_at(finer, place.values), place.nuisances, tolerance=_enough(current), most=20)
            if place is best or again.misfit < best.misfit:
                problem, best = finer, again
    effects = (*current.effects, candidate.effect.name)
    problem = replace(problem, parameters=best.parameters)
    return gated_hypothesis(effects, problem, best, current.reduction, current.laws_with(candidate.effect.name))


def refitted(current: GatedHypothesis, chosen: list[Candidate]) -> list[GatedHypothesis]:
    """Refit each candidate, in threads: the kernel releases the lock while it computes."""
    with ThreadPoolExecutor(len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 2) as pool:
        return list(pool.map(lambda candidate: refit(current, candidate), chosen))


def without(current: GatedHypothesis, effect: str) -> GatedHypothesis:
    """Refit the current model without one of its effects."""
    smaller, problem, nuisances = _dropped(current, effect)
    return _again(smaller, problem, nuisances)


def removed_without_refit(current: GatedHypothesis, effect: str) -> GatedHypothesis:
    """The current model without one of its effects, not refitted."""
    smaller, problem, nuisances = _dropped(current, effect)
    return gated_hypothesis(smaller.effects, problem, unfitted(problem, nuisances), smaller.reduction, smaller.laws)


def _dropped(current: GatedHypothesis, effect: str) -> tuple[GatedHypothesis, Problem, tuple[Array, ...]]:
    """The current model without an effect (not fitted yet), its problem, and the nuisances to start from."""
    parameters = current.fitted.parameters.copy()
    for parameter in catalogue()[effect].parameters:
        parameters[parameter_index(effect, parameter.name)] = parameter.neutral
    free = tuple(name for name in current.problem.free if name[0] != effect)
    problem = replace(current.problem, free=free, parameters=parameters)
    problem, nuisances = _remembering(problem, current.fitted.nuisances)
    return replace(current, effects=tuple(e for e in current.effects if e != effect)), problem, nuisances


def with_noise_of(h: GatedHypothesis, problem: Problem) -> GatedHypothesis:
    """Refit the hypothesis with another's noise and step, so that both likelihoods are comparable."""
    experiments = tuple(
        replace(own, noise_gain=other.noise_gain)
        for own, other in zip(h.problem.experiments, problem.experiments, strict=True)
    )
    changed = replace(h.problem, experiments=experiments, step=problem.step, parameters=h.fitted.parameters)
    reduction, laws = h.discrepancy_in(changed)
    return _again(replace(h, reduction=reduction, laws=laws), changed, h.fitted.nuisances)


def on_arm(h: GatedHypothesis, arm: Arm) -> GatedHypothesis:
    """Refit the hypothesis with fewer coordinates, without an allowance for the reduction's error."""
    more, fewer = h.problem.arm.order, arm.order
    nuisances = []
    for experiment, values in zip(h.problem.experiments, h.fitted.nuisances, strict=True):
        start, moving, memory, shift = experiment.parts(more, values)
        nuisances.append(np.concatenate([start[:fewer], moving[:fewer], memory[:fewer], shift]))
    problem = replace(h.problem, arm=arm, parameters=h.fitted.parameters)
    return _again(replace(h, reduction=(0.0, 0.0)), problem, tuple(nuisances))


def at_fine_step(chosen: GatedHypothesis) -> GatedHypothesis:
    """The chosen hypothesis at a step that is fine enough not to bias its parameters."""
    step = sufficient_step(chosen.problem, chosen.fitted, unbiased_noise(chosen.problem))
    if not chosen.effects or step == chosen.problem.step:
        return chosen
    problem = replace(chosen.problem, step=step, parameters=chosen.fitted.parameters)
    return _again(chosen, problem, chosen.fitted.nuisances, tolerance=1e-7, most=40)


def converged(chosen: GatedHypothesis) -> GatedHypothesis:
    """The chosen hypothesis; its fit is continued if it used all its steps."""
    if chosen.fitted.result.converged:
        return chosen
    problem = replace(chosen.problem, parameters=chosen.fitted.parameters)
    return _again(chosen, problem, chosen.fitted.nuisances, most=60)


def prune_shape_parameters(chosen: GatedHypothesis) -> GatedHypothesis:
    """The chosen hypothesis without the shapes that the data do not need; such a shape is set to 0.

    Against a baseline all shapes are kept, as the baseline's residual counts as noise and hides their gain.
    """
    if against_baseline(chosen):
        return chosen
    for effect in chosen.effects:
        for shape in catalogue()[effect].shapes:
            name = (effect, shape.name)
            if shape.neutral != 0.0 or name not in chosen.problem.free:
                continue
            parameters = chosen.fitted.parameters.copy()
            parameters[parameter_index(*name)] = 0.0
            free = tuple(other for other in chosen.problem.free if other != name)
            problem = replace(chosen.problem, free=free, parameters=parameters)
            simpler = _again(chosen, problem, chosen.fitted.nuisances)
            needed = max(nats_per_parameter(chosen.problem), material_gain(chosen))
            if simpler.penalised_log_likelihood > chosen.penalised_log_likelihood - needed:
                chosen = simpler
    return chosen


def _again(
    h: GatedHypothesis, problem: Problem, nuisances: tuple[Array, ...], *, tolerance: float = 1e-6, most: int = 20
) -> GatedHypothesis:
    """Fit the changed problem and judge it with the same allowances."""
    fitted = fit(problem, nuisances, tolerance=tolerance, most=most)
    return gated_hypothesis(h.effects, replace(problem, parameters=fitted.parameters), fitted, h.reduction, h.laws)


def _enough(current: GatedHypothesis) -> float:
    """Tolerance of a trial fit, as a share of its misfit: one nat, or a small share of the unexplained misfit."""
    misfit = current.fitted.misfit
    unexplained = max(misfit - 0.5 * current.fitted.count, 0.0)
    return max(1.0, 2e-3 * unexplained) / max(misfit, 1.0)


def _with_candidate(problem: Problem, start: Fit, candidate: Candidate) -> Problem:
    """The problem with the candidate's parameters free, its shapes at their best values."""
    parameters = start.parameters.copy()
    for shape, value in zip(candidate.effect.shapes, candidate.shapes, strict=True):
        parameters[parameter_index(candidate.effect.name, shape.name)] = value
    return replace(problem, free=(*problem.free, *candidate.free), parameters=parameters)


def _remembering(problem: Problem, nuisances: tuple[Array, ...]) -> tuple[Problem, tuple[Array, ...]]:
    """Make the initial memory of each run an unknown if an effect has a relaxation time; otherwise remove it."""
    wanted = any(catalogue()[effect].relaxation_time is not None for effect, _ in problem.free)
    order = problem.arm.order
    experiments, kept = [], []
    for experiment, values in zip(problem.experiments, nuisances, strict=True):
        changed = replace(experiment, remembers=wanted)
        start, moving, memory, shift = experiment.parts(order, values)
        if not changed.begins_with_memory:
            memory = memory[:0]
        elif not memory.size:
            memory = np.zeros(order)
        experiments.append(changed)
        kept.append(np.concatenate([start, moving, memory, shift]))
    return replace(problem, experiments=tuple(experiments)), tuple(kept)


def _starts(
    problem: Problem, nuisances: tuple[Array, ...], current: GatedHypothesis, candidate: Candidate
) -> list[Array]:
    """Starts (F,) of the free parameters: the fitted base with shares of the estimated strengths.

    Beyond the linear regime the first start is the best of a grid of base values and strengths, screened in one batch.
    """
    given = [_started(problem, candidate, share * candidate.strengths) for share in START_SHARES]
    if current.train.structure < LINEAR:
        return given
    if candidate.from_grid is not None:
        given.append(_started(problem, candidate, candidate.from_grid))
    columns = given if problem.prior_free else [column for start in given for column in _bent(problem, start)]
    flat = np.concatenate(nuisances)
    batch = np.array([np.concatenate([column, flat]) for column in columns]).T
    values, _ = problem.residuals(batch)
    order = np.argsort(np.einsum("nb,nb->b", values, values))
    return [columns[order[0]], given[0]]


def _at(problem: Problem, values: Array) -> Problem:
    """The problem with these starting values (F,) of its free parameters."""
    parameters = problem.parameters.copy()
    parameters[problem.rows()] = values
    return replace(problem, parameters=parameters)


def _started(problem: Problem, candidate: Candidate, strengths: Array) -> Array:
    """The free parameters (F,) with the candidate's strengths, strictly within their bounds.

    At a bound the difference quotients are one-sided, and the fit may not leave it.
    """
    parameters = problem.parameters.copy()
    for strength, value in zip(candidate.effect.strengths, strengths, strict=True):
        low, high = strength.bounds
        kept = np.clip(value, low + 1e-3 * strength.nominal, high - 1e-3 * strength.nominal)
        reach = 20.0 * strength.nominal
        parameters[parameter_index(candidate.effect.name, strength.name)] = np.clip(kept, -reach, reach)
    return parameters[problem.rows()]


def _bent(problem: Problem, start: Array) -> list[Array]:
    """The start (F,) with other elasticity, damping and drag."""
    columns = []
    for stiffer, relaxation, draggier in product(STIFFER, RELAXATIONS, DRAGGIER):
        column = start.copy()
        for place, name in enumerate(problem.free):
            if name[0] == "elasticity":
                column[place] *= stiffer
            elif name[0] == "drag":
                column[place] *= draggier
        for damping, elasticity in COUNTERPART.items():
            if relaxation is not None and damping in problem.free and elasticity in problem.free:
                column[problem.free.index(damping)] = relaxation * column[problem.free.index(elasticity)]
        columns.append(column)
    return columns
