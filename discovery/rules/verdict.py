"""From the search's outcome to a verdict: nothing missing, an effect, a group, or unknown; and how sure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from discovery.answer import MOST_EFFECTS
from discovery.rules.refit import without
from discovery.rules.search import CLEARED, VISIBLE_REST, StepwiseSearch, strength_at_bound, tied_within
from inference.hypothesis import GatedHypothesis, against_baseline, noise_ratio
from tentacle.diagnosis import Verdict

NEARLY = 0.12  # of the first misfit: a named effect may leave this, if the residual is under a noise sigma
DOMINANT = 0.07  # the same for any noise: no model of a real arm reaches the microns of motion capture
UNSEEN = 0.05  # of the first error in millimetres: no declaration of a real arm is more accurate
AGREED = 0.2  # if the effects common to all rivals leave no more than this share, their difference is a detail


@dataclass(frozen=True)
class RulesDecision:
    """The verdict with its effects (third_curvature apart) and the confidence in it."""

    verdict: Verdict
    effects: tuple[str, ...]
    confidence: float
    words: tuple[str, ...]


def structure_share(search: StepwiseSearch, reached: GatedHypothesis) -> float:
    """The share 0 .. 1 of the structured error (without noise) that a model leaves, on held-out frames if there are
    any.

    Both errors are in sigmas of the noise found with this model.
    """

    def structure(h: GatedHypothesis) -> float:
        return h.judged.structure if h.judged.gates else h.train.structure

    square = (1.0 + structure(search.base) ** 2) * noise_ratio(search.base.problem, reached.problem) ** 2
    before = float(np.sqrt(max(square - 1.0, 0.0)))
    return structure(reached) / before if before > 0 else 0.0


def probabilities(search: StepwiseSearch) -> dict[str, float]:
    """Weights of the single-effect models, tempered by the variance inflation. They rank, but are not calibrated."""
    pool = list(search.single)
    if not pool:
        return {}
    evidence = np.array([h.penalised_log_likelihood for h in pool]) / (2.0 * search.variance_inflation)
    weights = np.exp(evidence - evidence.max())
    weights /= weights.sum()
    return {h.effects[0]: float(weight) for h, weight in zip(pool, weights, strict=True)}


def decide_by_rules(search: StepwiseSearch, unexplained: float = 1.0) -> RulesDecision:
    """The verdict; unexplained: the share of the first error that the chosen model leaves in millimetres.

    If the fit of an explanation did not converge, the next best converged one with as many effects joins it in a group.
    Without such a one the verdict is unknown.
    """
    decision = _by_limits(search, unexplained)
    ending = search.chosen.fitted.result
    if ending.converged or decision.verdict in ("unknown", "nothing_missing"):
        return decision
    words = (*decision.words, f"{' + '.join(search.chosen.effects)}: {ending.message}")
    others = [h for h in (*search.rivals, *search.single) if len(h.effects) == len(search.chosen.effects)]
    others = [h for h in others if h.effects != search.chosen.effects and h.fitted.result.converged]
    if not others:
        return RulesDecision("unknown", (), decision.confidence, words)
    beside = max(others, key=lambda h: h.penalised_log_likelihood).effects
    return RulesDecision("group", tuple(dict.fromkeys((*decision.effects, *beside))), 0.5 * decision.confidence, words)


def _by_limits(search: StepwiseSearch, unexplained: float) -> RulesDecision:
    """The verdict, convergence aside.

    An explanation counts if it passes the gates, or if it leaves little beside what it explains. Noise sigmas give most
    weight to what a camera sees best, even to a thousandth of a millimetre. Therefore an explanation that leaves almost
    no error in millimetres counts as well.
    """
    base, chosen = search.base, search.chosen
    adequate = chosen.train.passed and (chosen.judged.passed or not chosen.judged.gates)
    tense = strength_at_bound(chosen)
    passed = adequate and not tense
    if not chosen.effects and passed:
        sure = float(np.clip(1.0 - 0.5 * _room_used(base), 0.5, 0.98))
        return RulesDecision("nothing_missing", (), sure, _hidden_below(base))
    share = structure_share(search, chosen)
    followed = unexplained < UNSEEN and 0 < len(chosen.effects) < MOST_EFFECTS and not tense
    named = chosen if passed or followed else _dominant(search, AGREED if adequate else 0.0)
    if not chosen.effects or named is None:
        words = ["No effect of the catalogue, nor a combination of up to three, brings the residual down to the noise."]
        if chosen.effects:
            words.append(
                f"The best partial account is {' + '.join(chosen.effects)}: "
                f"it leaves {100 * share:.0f} % of the structured error."
            )
        return RulesDecision("unknown", (), float(np.clip(1.0 - np.exp(-8.0 * share), 0.5, 0.95)), tuple(words))
    words = []
    if not passed:
        share = structure_share(search, named)
        words.append(
            f"{' + '.join(named.effects)} explains all but {100 * share:.0f} % of the structured error; "
            "the remainder is above the noise and no effect of the catalogue explains it."
        )
    if named is not chosen:
        more = " + ".join(chosen.effects[len(named.effects) :])
        words.append(f"The augmented model uses {more} to follow a part of that remainder: {more} is not identified.")
        twins = _twins_of(search, named)
        if twins:
            words.append("These data cannot separate " + ", ".join((*named.effects, *twins)) + ".")
            return RulesDecision("group", (*named.effects, *twins), 0.7, tuple(words))
        return RulesDecision("effect", named.effects, _confidence(search, passed, share), tuple(words))
    if not search.rivals:
        return RulesDecision("effect", chosen.effects, _confidence(search, passed, share), tuple(words))
    alternatives = sorted({name for h in (chosen, *search.rivals) for name in h.effects} - set(search.core.effects))
    agreed = search.core.effects
    # a residual that is visible without the other effects, and that they remove, is no detail
    detail = search.core.excess_rms < max(VISIBLE_REST, chosen.excess_rms / CLEARED)
    if agreed and structure_share(search, search.core) < AGREED and detail:
        words.append(
            f"Beyond {' + '.join(agreed)}, a smaller part is shared by {', '.join(alternatives)}: "
            "these data cannot separate them."
        )
        return RulesDecision("effect", agreed, _confidence(search, passed, share), tuple(words))
    words.append("These data cannot separate " + ", ".join(alternatives) + ".")
    return RulesDecision("group", (*alternatives, *agreed), 0.9 if passed else 0.7, tuple(words))


def _room_used(h: GatedHypothesis) -> float:
    """The residual beyond noise over the allowed one; the larger value of fitted and held-out frames."""
    sizes = [gate for gate in (*h.train.gates, *h.judged.gates) if gate.name == "chi-square"]
    return max((max(gate.statistic - 1.0, 0.0) / (gate.threshold - 1.0) for gate in sizes), default=1.0)


def _hidden_below(h: GatedHypothesis) -> tuple[str, ...]:
    """A sentence if the model's own error, and not the noise, limits what can be seen."""
    if h.excess_rms < VISIBLE_REST:
        return ()
    return (
        f"What remains is {h.excess_rms:.1f} times the noise and within the reduced model's own error: "
        "a smaller effect would not be detected.",
    )


def _dominant(search: StepwiseSearch, least: float) -> GatedHypothesis | None:
    """The smallest number of found effects, in their order, that leaves a tolerated share of the error.

    None if three are needed: three effects that do not reach the noise explain nothing. Against a baseline, whose
    residual already counts as noise, all found effects are kept. least: a share that is always tolerated.
    """
    part = search.chosen
    if against_baseline(part):
        return part if part.effects and structure_share(search, part) < _tolerated(part) else None
    parts = [part]
    for effect in reversed(part.effects[1:]):
        part = without(part, effect)
        parts.append(part)
    for part in reversed(parts):
        if 0 < len(part.effects) < MOST_EFFECTS and structure_share(search, part) < max(_tolerated(part), least):
            return part
    return None


def _twins_of(search: StepwiseSearch, named: GatedHypothesis) -> tuple[str, ...]:
    """Single effects that fit as well as the named one."""
    alone = {h.effects: h for h in search.single}
    own = alone.pop(named.effects, None)
    if own is None:
        return ()
    tie = tied_within(own, search.variance_inflation)
    return tuple(
        effects[0] for effects, h in alone.items() if own.penalised_log_likelihood - h.penalised_log_likelihood < tie
    )


def _tolerated(chosen: GatedHypothesis) -> float:
    """The share of the first error that a named effect may leave."""
    return NEARLY if against_baseline(chosen) or chosen.excess_rms < VISIBLE_REST else DOMINANT


def _confidence(search: StepwiseSearch, passed: bool, share: float) -> float:
    """Confidence from the margin to the next best explanation and from the share that is left."""
    sure = 1.0 - 0.5 * float(np.exp(-max(search.margin, 0.0) / 10.0))
    return float(np.clip(sure * (1.0 if passed else 1.0 - 2.0 * share), 0.05, 0.98))
