"""The stepwise search of absent effects that explain the residual: forward selection and backward elimination."""

from __future__ import annotations

from dataclasses import dataclass, replace

from affine_model.arm import Arm
from affine_model.effects import catalogue
from discovery.answer import MOST_EFFECTS
from discovery.rules.refit import (
    LINEAR,
    at_fine_step,
    converged,
    on_arm,
    prune_shape_parameters,
    refit,
    refitted,
    removed_without_refit,
    with_noise_of,
    without,
)
from inference.base_fit import refit_noise_and_step
from inference.hypothesis import (
    GatedHypothesis,
    gated_hypothesis,
    material_gain,
    nats_per_parameter,
    noise_ratio,
    variance_inflation,
)
from inference.score import Candidate, score, strength_grid, twin_cosines

REFITTED = 6  # of the score test's ranking: in 98-100 % of trials the truth was among its first three
HOPELESS = 0.6  # of the best's gain to first order: a candidate with less is not refitted
TIE = 5.0  # nats: closer effects are not separated
TIE_OF_MATERIAL_GAIN = 0.25  # of the material gain: the same
ALIKE = 0.9  # canonical cosine of two effects' sensitivities, above which a small lead decides nothing
REFIT_WITHIN_NATS = 20.0  # nats: alternatives this close to the best are refitted with its noise
SWAPS = 3  # of the score test's ranking, tried in the place of each earlier effect
# Share of the first misfit that none, one, two, three effects may leave if another is to be tried. The first effect
# of a combination explains a good part by itself, so a search that explains little is stopped.
WORTH_GOING_ON = (1.0, 0.85, 0.6, 0.0)
WORTH_TRYING = 0.25  # of a residual beyond the linear regime: the least gain of the best candidate that is tried
VISIBLE_REST = 1.0  # noise sigmas: a residual as large as the noise is visible in a plot
# Of the allowed model error: a model that passes with this share explains more than that error
FINE_DISCREPANCY_SHARE = 0.3
CLEARED = 0.5  # of the earlier residual
LARGEST_MARGIN = 1e3  # nats: the margin if nothing else was refitted


@dataclass(frozen=True)
class StepwiseSearch:
    """What the search found: the base, the chosen hypothesis, rivals that the data cannot tell from it, and the first
    ranking.

    core: the effects that the chosen hypothesis and all rivals share (without rivals: the chosen hypothesis).
    margin [nats]: how far the next best hypothesis with as many effects is behind, over the variance inflation.
    """

    base: GatedHypothesis
    chosen: GatedHypothesis
    rivals: tuple[GatedHypothesis, ...]
    candidates: tuple[Candidate, ...]
    single: tuple[GatedHypothesis, ...]
    variance_inflation: float
    core: GatedHypothesis
    margin: float


def _promising(current: GatedHypothesis, candidates: list[Candidate]) -> list[Candidate]:
    """The candidates worth a refit: the best of the score test and, where the residual is large, the best of the
    grid of strengths too.
    """
    price = nats_per_parameter(current.problem)
    best = [c for c in candidates if c.gain > price * len(c.effect.parameters)][:REFITTED]
    if current.train.structure < LINEAR:
        return best
    from_grid = strength_grid(current.problem, current.fitted, candidates)
    by_name = {candidate.effect.name: candidate for candidate in candidates}
    chosen = {candidate.effect.name: candidate for candidate in best[: REFITTED - 2]}
    for name, (gain, strengths) in sorted(from_grid.items(), key=lambda item: -item[1][0])[: REFITTED - 2]:
        if gain > price * len(by_name[name].effect.parameters):
            chosen[name] = replace(by_name[name], from_grid=strengths, gain=max(gain, by_name[name].gain))
    return list(chosen.values())


def _tried(current: GatedHypothesis, promising: list[Candidate]) -> list[GatedHypothesis]:
    """The refitted candidates, best first. In the linear regime those with a far smaller score are left out."""
    first = refit(current, promising[0])
    rest = promising[1:]
    if current.train.structure < LINEAR:
        gained = current.fitted.misfit - first.fitted.misfit
        rest = [candidate for candidate in rest if candidate.gain > HOPELESS * gained - 20.0]
    return sorted([first, *refitted(current, rest)], key=lambda h: -h.penalised_log_likelihood)


def refit_noise_together(tried: list[GatedHypothesis]) -> list[GatedHypothesis]:
    """The hypotheses near the best, refitted with its noise and step, so that their likelihoods are comparable."""
    best = tried[0]
    problem, fitted = refit_noise_and_step(best.problem, best.fitted)
    reach = max(REFIT_WITHIN_NATS * variance_inflation(best), material_gain(best))
    near = [h for h in tried[1:] if best.penalised_log_likelihood - h.penalised_log_likelihood < reach]
    if problem is not best.problem:
        near = [with_noise_of(h, problem) for h in near]
        best = gated_hypothesis(best.effects, problem, fitted, *best.discrepancy_in(problem))
    return sorted([best, *near], key=lambda h: -h.penalised_log_likelihood)


def tied_within(current: GatedHypothesis, inflation: float) -> float:
    """The distance [nats] within which others are not separated from it.

    Models whose difference is smaller than their own errors cannot be separated, whatever their likelihoods.
    """
    return max(TIE * inflation, TIE_OF_MATERIAL_GAIN * material_gain(current))


def stepwise_search(base: GatedHypothesis, seen: Arm | None = None) -> StepwiseSearch:
    """Forward from the base: score all, refit the best, take the best, until the gates pass or nothing more is
    gained. After each step an effect that is no longer needed is removed, or swapped for a better one.

    A model may pass only because its own error is allowed for, and still leave as much as the noise. Then the search
    goes on, and a further effect is kept if it leaves little, as an error of numerics or of the reduction does not look
    like an effect. An effect is also kept if it makes the model pass and leaves little, even when its gain is smaller
    than the model's own error.

    seen: the arm with only the coordinates that the shapes show, if the base has more because the chain needs them. It
    is used if a hypothesis with an effect fits no worse on it.
    """
    current, alternatives = base, []
    enough: tuple[GatedHypothesis, list[GatedHypothesis]] | None = None
    first: list[Candidate] = []
    single: list[GatedHypothesis] = []
    while len(current.effects) < MOST_EFFECTS:
        if current.passed:
            if enough is not None or current.excess_rms < VISIBLE_REST:
                break
            enough, current = (current, alternatives), _finer(current)
            if current.passed:
                break
        candidates = score(current.problem, current.fitted)
        first = first or candidates
        promising = _promising(current, candidates)
        if not promising or (current.effects and _hopeless(current, promising)):
            break
        tried = _tried(current, promising)
        if not current.effects:
            single = tried
        gain = tried[0].penalised_log_likelihood - current.penalised_log_likelihood
        if gain < material_gain(current) and (current.passed or not _clears(tried[0], current)):
            break
        current, *alternatives = refit_noise_together(tried)
        current, alternatives = backward_elimination(current, alternatives)
        if seen is not None and seen.order < current.problem.arm.order:
            current, alternatives = _with_fewer_coordinates(current, alternatives, seen)
        if current.misfit > WORTH_GOING_ON[len(current.effects)] * base.misfit:
            break
    current = converged(prune_shape_parameters(at_fine_step(current)))
    if enough is not None and not _clears(current, enough[0]):
        current, alternatives = enough
        current = converged(prune_shape_parameters(at_fine_step(current)))
    inflation = variance_inflation(current)
    tie = tied_within(current, inflation)
    rivals = [
        h
        for h in alternatives
        if len(h.effects) == len(current.effects)
        and current.penalised_log_likelihood - h.penalised_log_likelihood < tie
    ]
    rivals = [
        h
        for h in rivals
        if current.penalised_log_likelihood - h.penalised_log_likelihood < TIE * inflation or _alike(current, h, first)
    ]
    others = [h.penalised_log_likelihood for h in (alternatives or single) if h.effects != current.effects]
    margin = (
        (current.penalised_log_likelihood - max(others)) / inflation if others and current.effects else LARGEST_MARGIN
    )
    return StepwiseSearch(
        base, current, tuple(rivals), tuple(first), tuple(single), inflation, _agreed(current, rivals), margin
    )


def _finer(h: GatedHypothesis) -> GatedHypothesis:
    """The hypothesis with a small share of its own error allowed."""
    return gated_hypothesis(
        h.effects,
        h.problem,
        h.fitted,
        (FINE_DISCREPANCY_SHARE * h.reduction[0], FINE_DISCREPANCY_SHARE * h.reduction[1]),
        h.laws,
    )


def _clears(current: GatedHypothesis, enough: GatedHypothesis) -> bool:
    """Whether a model leaves little of the residual of one that passed only by its own error."""
    noise = noise_ratio(current.problem, enough.problem)
    return (
        current.passed and not strength_at_bound(current) and current.excess_rms * noise < CLEARED * enough.excess_rms
    )


def strength_at_bound(chosen: GatedHypothesis) -> bool:
    """Whether a combination has an effect with a strength at its bound: that effect replaces something else."""
    if len(chosen.effects) < 2:
        return False
    strengths = {(name, strength.name) for name in chosen.effects for strength in catalogue()[name].strengths}
    values = dict(zip(chosen.fitted.free, chosen.fitted.values, strict=True))
    return any(name in strengths and values[name] != 0.0 for name in chosen.fitted.at_bound)


def _hopeless(current: GatedHypothesis, promising: list[Candidate]) -> bool:
    """Whether the residual is large and no candidate explains a good part of it."""
    unexplained = current.fitted.misfit - 0.5 * current.fitted.count
    best = max(candidate.gain for candidate in promising)
    return current.train.structure > LINEAR and best < WORTH_TRYING * unexplained


def _with_fewer_coordinates(
    current: GatedHypothesis, alternatives: list[GatedHypothesis], arm: Arm
) -> tuple[GatedHypothesis, list[GatedHypothesis]]:
    """The hypotheses with fewer coordinates if the best fits no worse; otherwise unchanged."""
    fewer = on_arm(current, arm)
    if fewer.penalised_log_likelihood < current.penalised_log_likelihood:
        return current, alternatives
    ordered = sorted([fewer, *(on_arm(h, arm) for h in alternatives)], key=lambda h: -h.penalised_log_likelihood)
    best, *rest = refit_noise_together(ordered)
    return best, rest


def backward_elimination(
    current: GatedHypothesis, alternatives: list[GatedHypothesis]
) -> tuple[GatedHypothesis, list[GatedHypothesis]]:
    """Remove each earlier effect that is no longer needed, or swap it for a better one.

    Returns the best hypothesis and its alternatives.
    """
    found = list(alternatives)
    for effect in current.effects[:-1]:
        smaller = without(current, effect)
        if smaller.penalised_log_likelihood > current.penalised_log_likelihood - TIE:
            return smaller, []
        candidates = score(smaller.problem, smaller.fitted)
        swaps = [c for c in candidates if c.effect.name not in current.effects][:SWAPS]
        found += refitted(smaller, swaps)
        # A twin replaces the effect without a refit in between, which could lead to another minimum.
        removed = [c for c in candidates if c.effect.name == effect]
        twins = {c.effect.name for c in swaps if twin_cosines([c, *removed]).min() > ALIKE} if removed else set[str]()
        if twins:
            without_twin = removed_without_refit(current, effect)
            found += refitted(
                without_twin, [c for c in score(without_twin.problem, without_twin.fitted) if c.effect.name in twins]
            )
    ordered = _best_of_each(current, found)
    if ordered[0] is current:
        return current, ordered[1:]
    best, *rest = refit_noise_together(ordered)
    return best, rest


def _best_of_each(current: GatedHypothesis, found: list[GatedHypothesis]) -> list[GatedHypothesis]:
    """The hypotheses, best first, each set of effects once."""
    ordered, sets = [], set[frozenset[str]]()
    for h in sorted([current, *found], key=lambda h: -h.penalised_log_likelihood):
        if frozenset(h.effects) not in sets:
            ordered.append(h)
            sets.add(frozenset(h.effects))
    return ordered


def _alike(current: GatedHypothesis, rival: GatedHypothesis, candidates: list[Candidate]) -> bool:
    """Whether the effects that only one of the two has look nearly the same in these data."""
    only = {*current.effects} ^ {*rival.effects}
    return bool(twin_cosines([c for c in candidates if c.effect.name in only]).min(initial=1.0) > ALIKE)


def _agreed(current: GatedHypothesis, rivals: list[GatedHypothesis]) -> GatedHypothesis:
    core = current
    for effect in current.effects:
        if any(effect not in rival.effects for rival in rivals):
            core = without(core, effect)
    return core
