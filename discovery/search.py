"""The search: which absent effects, added to the model, explain the residual. Forward by refits, back by removal."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from affine_model.arm import Arm, parameter_index
from affine_model.curvature import Array
from affine_model.effects import catalogue
from affine_model.identify.sufficient_step import sufficient_step, unbiased_noise
from affine_model.identify.trajectory import Fit, Problem, fit
from discovery.adequacy import ALLOWANCE, MATERIAL
from discovery.base_fit import settled
from discovery.hypothesis import Hypothesis, hypothesis, looseness, nats_per_parameter
from discovery.score import Candidate, score, survey

REFITTED = 6  # of the score test's ranking: the truth was in its first three in 98-100 % of trials
LINEAR = 2.0  # noise sigmas of structure up to which the score test's linear picture holds
HOPELESS = 0.6  # a candidate with less than this share of the best's gain to first order does not catch up
TIE = 5.0  # nats: effects closer than this to the best are not told apart
MOST_EFFECTS = 3
NEAR = 20.0  # nats: alternatives this close to the best are refitted with its noise
SWAPS = 3  # of the score test's ranking, tried in the place of each earlier effect
# Share of the first misfit that one, two, three effects may leave for another to be tried: a combination's first effect
# explains a good part by itself, and what nothing here explains is not worth minutes.
WORTH_GOING_ON = (1.0, 0.85, 0.6, 0.0)
WORTH_TRYING = 0.25  # of a rest beyond the linear regime: a candidate's gain, below which nothing more is tried
LARGEST_MARGIN = 1e3  # nats: said where nothing else was worth a refit


@dataclass(frozen=True)
class Search:
    """What the search found: the base, the chosen hypothesis, rivals that the data cannot tell from it, and the first
    ranking.

    core: the effects on which the chosen hypothesis and all rivals agree, alone (the chosen one where there is no
    rival). margin [nats]: the chosen model's evidence less that of the next best of as many effects, loosened.
    """

    base: Hypothesis
    chosen: Hypothesis
    rivals: tuple[Hypothesis, ...]
    candidates: tuple[Candidate, ...]
    single: tuple[Hypothesis, ...]
    looseness: float
    core: Hypothesis
    margin: float


def _with_candidate(problem: Problem, start: Fit, candidate: Candidate, share: float) -> Problem:
    parameters = start.parameters.copy()
    for shape, value in zip(candidate.effect.shapes, candidate.shapes, strict=True):
        parameters[parameter_index(candidate.effect.name, shape.name)] = value
    for strength, value in zip(candidate.effect.strengths, candidate.strengths, strict=True):
        low, high = strength.bounds
        # Never start on the bound: there the difference quotients are one-sided and the fit may stick.
        kept = np.clip(share * value, low + 1e-3 * strength.nominal, high - 1e-3 * strength.nominal)
        reach = 20.0 * strength.nominal
        parameters[parameter_index(candidate.effect.name, strength.name)] = np.clip(kept, -reach, reach)
    return replace(problem, free=(*problem.free, *candidate.free), parameters=parameters)


def _remembering(problem: Problem, nuisances: tuple[Array, ...]) -> tuple[Problem, tuple[Array, ...]]:
    """The problem with the memory at the start of each run among its unknowns where an effect relaxes, else without."""
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


def refit(current: Hypothesis, candidate: Candidate) -> Hypothesis:
    """The current model with the candidate added, fitted from its linear estimate; from half of it where that fails
    to gain.
    """
    best: Fit | None = None
    used: Problem | None = None
    for share in (1.0, 0.4):
        problem = _with_candidate(current.problem, current.fitted, candidate, share)
        problem, nuisances = _remembering(problem, current.fitted.nuisances)
        fitted = fit(problem, nuisances, tolerance=_enough(current), most=20)
        if best is None or fitted.misfit < best.misfit:
            best, used = fitted, problem
        if current.fitted.misfit - best.misfit > 0.5 * candidate.gain:
            break
    assert best is not None
    assert used is not None
    effects = (*current.effects, candidate.effect.name)
    return hypothesis(effects, replace(used, parameters=best.parameters), best, current.reduction)


def _enough(current: Hypothesis) -> float:
    """When a trial fit has converged, as a share of its misfit: to a nat, or to little beside what is unexplained."""
    misfit = current.fitted.misfit
    unexplained = max(misfit - 0.5 * current.fitted.count, 0.0)
    return max(1.0, 2e-3 * unexplained) / max(misfit, 1.0)


def without(current: Hypothesis, effect: str) -> Hypothesis:
    """The current model less one of its effects, refitted."""
    parameters = current.fitted.parameters.copy()
    for parameter in catalogue()[effect].parameters:
        parameters[parameter_index(effect, parameter.name)] = parameter.neutral
    free = tuple(name for name in current.problem.free if name[0] != effect)
    problem = replace(current.problem, free=free, parameters=parameters)
    problem, nuisances = _remembering(problem, current.fitted.nuisances)
    fitted = fit(problem, nuisances, tolerance=1e-6, most=20)
    rest = tuple(name for name in current.effects if name != effect)
    return hypothesis(rest, replace(problem, parameters=fitted.parameters), fitted, current.reduction)


def material_gain(current: Hypothesis) -> float:
    """Nats below which a gain is not called physics: structure of MATERIAL noise sigmas, or the reduction's, over all
    residuals.
    """
    structure = MATERIAL**2 + (ALLOWANCE * current.reduction[0]) ** 2
    return 0.5 * structure * current.fitted.count


def _promising(current: Hypothesis, candidates: list[Candidate]) -> list[Candidate]:
    """The candidates worth a refit: the best of the score test and, where the residual is large, the best of the
    survey too.
    """
    price = nats_per_parameter(current.problem)
    best = [c for c in candidates if c.gain > price * len(c.effect.parameters)][:REFITTED]
    if current.train.structure < LINEAR:
        return best
    surveyed = survey(current.problem, current.fitted, candidates)
    by_name = {candidate.effect.name: candidate for candidate in candidates}
    chosen = {candidate.effect.name: candidate for candidate in best[: REFITTED - 2]}
    for name, (gain, strengths) in sorted(surveyed.items(), key=lambda item: -item[1][0])[: REFITTED - 2]:
        if gain > price * len(by_name[name].effect.parameters):
            # Start where the survey found the gain; the linear estimate is far off in this regime.
            chosen[name] = replace(by_name[name], strengths=strengths, gain=gain)
    return list(chosen.values())


def _tried(current: Hypothesis, promising: list[Candidate]) -> list[Hypothesis]:
    """The candidates refitted, best first. In the linear regime those that the score puts far behind the first are
    left out.
    """
    first = refit(current, promising[0])
    rest = promising[1:]
    if current.train.structure < LINEAR:
        gained = current.fitted.misfit - first.fitted.misfit
        rest = [candidate for candidate in rest if candidate.gain > HOPELESS * gained - 20.0]
    return sorted([first, *_refitted(current, rest)], key=lambda h: -h.evidence)


def _refitted(current: Hypothesis, chosen: list[Candidate]) -> list[Hypothesis]:
    """Each candidate refitted, side by side: the kernel lets other threads run while it computes."""
    with ThreadPoolExecutor(len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 2) as pool:
        return list(pool.map(lambda candidate: refit(current, candidate), chosen))


def settled_together(tried: list[Hypothesis]) -> list[Hypothesis]:
    """The best first, with the noise as it leaves it and a step that suffices; then those that come near it, refitted
    with the same noise and step, so that their evidence is comparable.
    """
    best = tried[0]
    problem, fitted = settled(best.problem, best.fitted)
    near = [h for h in tried[1:] if best.evidence - h.evidence < NEAR * looseness(best)]
    if problem is not best.problem:
        near = [_with_noise_of(problem, h) for h in near]
        best = hypothesis(best.effects, problem, fitted, best.reduction)
    return sorted([best, *near], key=lambda h: -h.evidence)


def _with_noise_of(problem: Problem, h: Hypothesis) -> Hypothesis:
    experiments = tuple(
        replace(own, noise_gain=other.noise_gain)
        for own, other in zip(h.problem.experiments, problem.experiments, strict=True)
    )
    changed = replace(h.problem, experiments=experiments, step=problem.step, parameters=h.fitted.parameters)
    fitted = fit(changed, h.fitted.nuisances, tolerance=1e-6, most=20)
    return hypothesis(h.effects, replace(changed, parameters=fitted.parameters), fitted, h.reduction)


def search(base: Hypothesis, seen: Arm | None = None) -> Search:
    """Forward from the base: score all, refit the best, take the best, until the gates pass or nothing more is
    gained. After each step back: an effect that is no longer needed goes, one that another serves better is swapped.

    seen: the arm with the coordinates that the shapes show, where the base has more on the chain's account. With an
    effect added the data can tell whether it does as well, and then it stands: they come from an arm without the rest.
    """
    current, alternatives = base, []
    first: list[Candidate] = []
    single: list[Hypothesis] = []
    while len(current.effects) < MOST_EFFECTS:
        if current.train.passed and current.judged.passed:
            break
        candidates = score(current.problem, current.fitted)
        first = first or candidates
        promising = _promising(current, candidates)
        if not promising or (current.effects and _hopeless(current, promising)):
            break
        tried = _tried(current, promising)
        if not current.effects:
            single = tried
        if tried[0].evidence - current.evidence < material_gain(current):
            break
        current, *alternatives = settled_together(tried)
        current, alternatives = _back(current, alternatives)
        if seen is not None and seen.order < current.problem.arm.order:
            current, alternatives = _with_fewer_coordinates(current, alternatives, seen)
        if current.fitted.misfit > WORTH_GOING_ON[len(current.effects)] * base.fitted.misfit:
            break
    current = _polished(current)
    loose = looseness(current)
    rivals = [
        h
        for h in alternatives
        if len(h.effects) == len(current.effects) and current.evidence - h.evidence < TIE * loose
    ]
    others = [h.evidence for h in (alternatives or single) if h.effects != current.effects]
    margin = (current.evidence - max(others)) / loose if others and current.effects else LARGEST_MARGIN
    return Search(base, current, tuple(rivals), tuple(first), tuple(single), loose, _agreed(current, rivals), margin)


def _hopeless(current: Hypothesis, promising: list[Candidate]) -> bool:
    """Whether no candidate comes near what is left: the rest is large, and none explains a good part of it."""
    unexplained = current.fitted.misfit - 0.5 * current.fitted.count
    best = max(candidate.gain for candidate in promising)
    return current.train.structure > LINEAR and best < WORTH_TRYING * unexplained


def _with_fewer_coordinates(
    current: Hypothesis, alternatives: list[Hypothesis], arm: Arm
) -> tuple[Hypothesis, list[Hypothesis]]:
    """The hypotheses on an arm of fewer coordinates where the best fits no worse there; else as they are."""
    fewer = _on_arm(current, arm)
    if fewer.evidence < current.evidence:
        return current, alternatives
    ordered = sorted([fewer, *(_on_arm(h, arm) for h in alternatives)], key=lambda h: -h.evidence)
    best, *rest = settled_together(ordered)
    return best, rest


def _on_arm(h: Hypothesis, arm: Arm) -> Hypothesis:
    """The hypothesis refitted on an arm of fewer coordinates; no reduction's loss is granted to it."""
    more, fewer = h.problem.arm.order, arm.order
    nuisances = []
    for experiment, values in zip(h.problem.experiments, h.fitted.nuisances, strict=True):
        start, moving, memory, shift = experiment.parts(more, values)
        nuisances.append(np.concatenate([start[:fewer], moving[:fewer], memory[:fewer], shift]))
    problem = replace(h.problem, arm=arm, parameters=h.fitted.parameters)
    fitted = fit(problem, tuple(nuisances), tolerance=1e-6, most=20)
    return hypothesis(h.effects, replace(problem, parameters=fitted.parameters), fitted)


def _polished(chosen: Hypothesis) -> Hypothesis:
    """The chosen hypothesis at a step so fine that its parameters are not biased by it."""
    step = sufficient_step(chosen.problem, chosen.fitted, unbiased_noise(chosen.problem))
    if not chosen.effects or step == chosen.problem.step:
        return chosen
    problem = replace(chosen.problem, step=step, parameters=chosen.fitted.parameters)
    fitted = fit(problem, chosen.fitted.nuisances)
    problem = replace(problem, parameters=fitted.parameters)
    return hypothesis(chosen.effects, problem, fitted, chosen.reduction)


def _back(current: Hypothesis, alternatives: list[Hypothesis]) -> tuple[Hypothesis, list[Hypothesis]]:
    """Whether an effect that was chosen before the last is still needed, or another in its place serves better.

    Gives the best, and the alternatives to it with those found on the way.
    """
    found = list(alternatives)
    for effect in current.effects[:-1]:
        smaller = without(current, effect)
        if smaller.evidence > current.evidence - TIE:
            return smaller, []
        swaps = [c for c in score(smaller.problem, smaller.fitted) if c.effect.name not in current.effects][:SWAPS]
        found += _refitted(smaller, swaps)
    ordered = sorted([current, *found], key=lambda h: -h.evidence)
    if ordered[0] is current:
        return current, ordered[1:]
    best, *rest = settled_together(ordered)
    return best, rest


def _agreed(current: Hypothesis, rivals: list[Hypothesis]) -> Hypothesis:
    core = current
    for effect in current.effects:
        if any(effect not in rival.effects for rival in rivals):
            core = without(core, effect)
    return core
