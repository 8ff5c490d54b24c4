"""The search: which absent effects, added to the model, explain the residual. Forward by refits, back by removal."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from affine_model.arm import parameter_index, parameter_rows
from affine_model.curvature import Array
from affine_model.effects import catalogue
from affine_model.identify.trajectory import Fit, Problem, fit
from discovery.adequacy import ALLOWANCE, MATERIAL, Adequacy, adequacy
from discovery.base_fit import settled
from discovery.score import Candidate, score, survey
from tentacle.model import Estimate

NATS_PER_PARAMETER = 7.6  # about 20 candidates at p = .01 (closing_the_loop.md)
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
class Hypothesis:
    """A model with some absent effects added, refitted. evidence [nats]: log-likelihood of fitted and held-out
    frames, less a penalty for each parameter.
    """

    effects: tuple[str, ...]
    problem: Problem
    fitted: Fit
    evidence: float
    train: Adequacy
    judged: Adequacy
    reduction: tuple[float, float] = (0.0, 0.0)


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


def held_out_misfit(problem: Problem, fitted: Fit) -> float:
    """Half the sum of squared whitened residuals on the frames that were not fitted [nats]."""
    total = 0.0
    for experiment, residuals in zip(problem.experiments, fitted.residuals, strict=True):
        total += 0.5 * float(np.sum(residuals[~experiment.used] ** 2))
    return total


def nats_per_parameter(problem: Problem) -> float:
    """The price of a parameter; dearer where the noise hangs together over many frames, for then each counts for
    less.
    """
    return NATS_PER_PARAMETER * max(experiment.correlation for experiment in problem.experiments)


def hypothesis(
    effects: tuple[str, ...], problem: Problem, fitted: Fit, reduction: tuple[float, float] = (0.0, 0.0)
) -> Hypothesis:
    """A fit judged; reduction: the model's own error in noise sigmas on fitted and held-out frames, no missing
    physics.
    """
    parameters = sum(len(catalogue()[name].parameters) for name in effects)
    evidence = -fitted.misfit - held_out_misfit(problem, fitted) - nats_per_parameter(problem) * parameters
    train = adequacy(problem, fitted, held_out=False, reduction=reduction[0])
    judged = adequacy(problem, fitted, held_out=True, reduction=reduction[1])
    return Hypothesis(effects, problem, fitted, evidence, train, judged, reduction)


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
        memory = experiment.memory(order, values)
        memory = np.zeros(order) if memory is None else memory
        memory = memory if changed.begins_with_memory else memory[:0]
        moving = order if experiment.release is None else 1
        experiments.append(changed)
        kept.append(np.concatenate([values[: order + moving], memory, values[-2:]]))
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


def looseness(judged: Hypothesis) -> float:
    """Factor by which nats overstate the evidence: the rest's variance over the noise's, times its correlation time
    in frames.

    1 where the rest is white noise of the stated size. It widens ties and intervals where the model is not complete.
    """
    values, weights = [], []
    for experiment, residuals in zip(judged.problem.experiments, judged.fitted.residuals, strict=True):
        rows = residuals[experiment.used]
        rows = rows[:, np.any(rows != 0.0, axis=0)]
        if rows.shape[0] < 40:
            continue
        centred = rows - rows.mean(axis=0)
        power = np.mean(centred**2, axis=0)
        time = np.ones(rows.shape[1])
        for lag in range(1, min(200, rows.shape[0] // 3)):
            rho = np.mean(centred[lag:] * centred[:-lag], axis=0) / np.maximum(power, 1e-300)
            alive = rho > 0.1
            if not alive.any():
                break
            time += 2.0 * np.where(alive, rho, 0.0)
        values.append(np.mean(rows**2, axis=0) * np.where(np.mean(rows**2, axis=0) > 1.3, time, 1.0))
        weights.append(rows.shape[0])
    if not values:
        return 1.0
    return float(max(1.0, np.average([np.mean(value) for value in values], weights=weights)))


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


def search(base: Hypothesis) -> Search:
    """Forward from the base: score all, refit the best, take the best, until the gates pass or nothing more is
    gained. After each step back: an effect that is no longer needed goes, one that another serves better is swapped.
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
        if current.fitted.misfit > WORTH_GOING_ON[len(current.effects)] * base.fitted.misfit:
            break
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


def parameter_interval(judged: Hypothesis, index: int, loose: float) -> tuple[float, float]:
    """95 % interval of one free parameter, widened where the model is not complete, cut at the physical bounds."""
    spread: Array = np.sqrt(np.maximum(np.diag(judged.fitted.covariance), 0.0))
    half = 1.96 * float(spread[index]) * np.sqrt(loose)
    low, high = (limit[index] for limit in judged.problem.bounds())
    value = float(judged.fitted.values[index])
    return max(low, value - half), min(high, value + half)


def estimates(judged: Hypothesis, loose: float) -> dict[str, dict[str, Estimate]]:
    """All fitted parameters of a hypothesis with their 95 % intervals, as a Model takes them."""
    units = {(row.effect, row.parameter.name): row.parameter.unit for row in parameter_rows()}
    table: dict[str, dict[str, Estimate]] = {}
    for index, (effect, name) in enumerate(judged.problem.free):
        low, high = parameter_interval(judged, index, loose)
        value = float(judged.fitted.values[index])
        table.setdefault(effect, {})[name] = Estimate(value, low, high, units[effect, name])
    return table
