"""From what the search found to the diagnosis that is written: errors, ranking, budget, words."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import root_scalar
from scipy.special import ndtr

from discovery.answer import ACCOUNTS, NO_SERVO, error_budget, far_from_floor, proposal_words
from discovery.calibration import tempered
from discovery.decide import (
    CREDIBLE,
    MOST_DECLARED_FORM,
    PosteriorDecision,
    log_masses,
    log_prior_of_set,
    missing_of,
    usable,
)
from discovery.detection import of_unnamed
from discovery.given import Deciding
from discovery.judged_answer import JudgedAnswer
from discovery.next_experiment import propose_experiment
from discovery.predictive_check import predictive_words
from discovery.search import PosteriorSearch
from inference.compare import midline_error
from inference.declared_words import declared_words
from inference.estimates import estimates, joint_posterior
from inference.fit import Fit
from inference.one_arm import own_geometry_words
from inference.posterior import Hypothesis
from inference.prepare import Prepared
from inference.score import twin_cosines
from inference.trajectory import Problem
from tentacle.diagnosis import FINER_SHAPE, CredibleSet, Diagnosis, Explained, Limit, RankedEffect
from tentacle.model import Estimate, Model

DRAWS = 400  # of the bootstrap
FEWEST_PIECES = 6  # of the recordings: the range of n draws holds the median in 1 - 2^(1-n) of cases, 97 % for six


@dataclass(frozen=True)
class PosteriorContext:
    """What an answer needs beside the search: the fitted model of the paper, the number of coordinates that the
    recordings' shapes show, the detection limits, and the laws that are taken as the arm's own, with the sentence that
    says why.
    """

    paper: tuple[Problem, Fit]
    order: int
    limits: dict[str, dict[str, Limit]]
    taken: dict[str, str]


def assemble_posterior(
    found: PosteriorSearch, judged: JudgedAnswer, around: PosteriorContext, seed: int, deciding: Deciding
) -> Diagnosis:
    """The diagnosis from the hypotheses and the judged answer, with the paper's model beside the chosen one.

    deciding: how the confidence is calibrated, and the servo's limits.
    """
    calibration = deciding.calibration
    paper, order, prepared = around.paper, around.order, judged.prepared
    decision, open_loop, withdrawn, sure = judged.decision, judged.open_loop, judged.withdrawn, judged.sure
    chosen = decision.leading
    before, after, floor = judged.before, judged.after, judged.floor
    effects, verdict = ((), "unknown") if withdrawn else (decision.effects, decision.verdict)
    temperature = missing_of(found.hypotheses).temperature
    words = [sentence for p in prepared for sentence in p.words] + own_geometry_words(prepared)
    if order > 2:
        shapes = any(p.experiment.observation.shapes is not None for p in prepared)
        shown = "The measured shapes show" if shapes else "What the markers show so well needs"
        words.append(f"{shown} {order} curvature coordinates; the paper's model has two.")
        improved = (before.midline_mm or 0.0) > 1.1 * (after.midline_mm or np.inf)
        if verdict == "nothing_missing" and improved:
            effects, verdict = (FINER_SHAPE,), "effect"
        elif verdict in ("effect", "group"):
            effects = (*effects, FINER_SHAPE)
    known = _over_sets(decision, temperature)
    d = chosen.problem.known(chosen.fitted.parameters)[0].arm
    # Where the model runs alone, its laws' form misleads no less than in the answer: the same T widens its intervals.
    base, written = hypothesis_of_paper(paper), estimates(open_loop.problem, open_loop.fitted, temperature)
    joint = joint_posterior(open_loop.problem, open_loop.fitted, temperature)
    leading, rivals = _to_be_split(found, decision)
    proposal = propose_experiment(leading, rivals, deciding.servo, seed)
    words += declared_words(chosen.problem, chosen.fitted, temperature, around.taken, imitates=verdict == "unknown")
    words += _decision_words(found, decision)
    if decision.verdict == "nothing_missing":
        words += left_words(after.midline_mm, floor.midline_mm)
    words += predictive_words(chosen.effects, judged.left, withdrawn=withdrawn) if verdict == "unknown" else []
    if proposal is not None:
        words.append(proposal_words(proposal))
    elif rivals:
        words.append(NO_SERVO)
    if calibration is not None:
        words.append(calibration.words(verdict, sure))
    candidates = list(found.candidates[:12])
    return Diagnosis(
        verdict=verdict,
        effects=effects,
        confidence=tempered(sure) if calibration is None else calibration(verdict, sure),
        uncalibrated=sure,
        parameters={name: known.get(name, {}) for name in effects},
        before=before,
        after=after,
        floor=floor,
        held_out=judged.held_out,
        ranking=_ranking(found, judged),
        next_experiment=None if proposal is None else proposal.asked,
        next_nats=None if proposal is None else proposal.nats,
        budget=error_budget(before, after, floor, judged.lost),
        base_model=Model(d.specimen, d.fluid, d.gravity, 2, base),
        augmented_model=Model(d.specimen, d.fluid, d.gravity, chosen.problem.arm.order, written, joint),
        twin_names=tuple(c.effect.name for c in candidates),
        twin_cosines=twin_cosines(candidates) if candidates else np.zeros((0, 0)),
        runs=tuple(run for run, _, _ in judged.runs),
        words=tuple(words),
        seed=seed,
        explained=explained(found.base, chosen, seed) if effects and chosen.effects else None,
        certain=() if withdrawn else decision.certain,
        sets=() if withdrawn else tuple(CredibleSet(names, mass) for names, mass in decision.sets),
        detection_limits=of_unnamed(around.limits, effects),
        where=_where(effects, prepared, chosen),
    )


def _where(effects: tuple[str, ...], prepared: list[Prepared], chosen: Hypothesis) -> dict[str, tuple[str, ...]]:
    """Which of the effects act in which recording, by the chosen model."""
    both = zip(prepared, chosen.problem.experiments, strict=False)  # those of the baseline come last
    return {p.recording.name: tuple(name for name in effects if name not in e.lacks) for p, e in both}


def _over_sets(decision: PosteriorDecision, temperature: float) -> dict[str, dict[str, Estimate]]:
    """The estimates of the leading set that has them, with intervals over all credible sets: each is a Gaussian of its
    set's mass, and 95 % of their sum lies within.
    """
    masses = dict(decision.sets)
    sets = (decision.leading, *decision.rivals)
    tables = [(estimates(h.problem, h.fitted, temperature), masses.get(h.effects, 1.0)) for h in sets]
    found: dict[str, dict[str, Estimate]] = {}
    for effect in {effect: None for table, _ in tables for effect in table}:
        leading = next(table[effect] for table, _ in tables if effect in table)
        for name, one in leading.items():
            parts = [(table[effect][name], mass) for table, mass in tables if name in table.get(effect, {})]
            low, high = (_quantile(parts, level) for level in (0.025, 0.975))
            found.setdefault(effect, {})[name] = replace(one, low=min(low, one.value), high=max(high, one.value))
    return found


def _quantile(parts: list[tuple[Estimate, float]], level: float) -> float:
    """The quantile of a sum of Gaussians, given by their 95 % intervals and masses; a part's own bounds hold."""
    total = sum(mass for _, mass in parts)

    def below(value: float) -> float:
        spread = [max((e.high - e.low) / (2.0 * 1.96), 1e-300) for e, _ in parts]
        return sum(m * float(ndtr((value - e.value) / s)) for (e, m), s in zip(parts, spread, strict=True)) / total

    low, high = min(e.low for e, _ in parts), max(e.high for e, _ in parts)
    if below(low) >= level or below(high) <= level:
        return low if below(low) >= level else high
    found = root_scalar(lambda value: below(value) - level, bracket=(low, high), xtol=1e-9 * (high - low))
    return float(found.root)


def hypothesis_of_paper(paper: tuple[Problem, Fit]) -> dict[str, dict[str, Estimate]]:
    """The paper's model as fitted, with intervals."""
    return estimates(*paper)


def explained(base: Hypothesis, chosen: Hypothesis, seed: int) -> Explained | None:
    """The share of the power of what the declared model leaves that the chosen model explains, each running alone.

    The response is linear in a small force, so that this is the share of the missing force's power, weighted as the arm
    responds to it. The interval (95 %) is a bootstrap over pieces of the recordings. None where one of them is unknown,
    or where there are too few pieces for an interval.
    """
    before, after = base.rest_in_time, chosen.rest_in_time
    if before.size < FEWEST_PIECES or before.size != after.size or before.mean() <= 0.0:
        return None
    drawn = np.random.default_rng(seed).integers(0, before.size, size=(DRAWS, before.size))
    shares = 1.0 - after[drawn].mean(axis=1) / np.maximum(before[drawn].mean(axis=1), 1e-300)
    low, high = np.clip(np.quantile(shares, [0.025, 0.975]), 0.0, 1.0)
    return Explained(float(np.clip(1.0 - after.mean() / before.mean(), 0.0, 1.0)), float(low), float(high))


def _decision_words(found: PosteriorSearch, decision: PosteriorDecision) -> list[str]:
    """Sentences of the posterior beyond the verdict."""
    left = 100.0 * decision.leading.share
    known = found.base.baseline_share
    words = []
    if known > MOST_DECLARED_FORM:
        words.append(
            f"The declared model leaves {100.0 * known:.2g} % of the acting forces unexplained in the baseline's own "
            "recordings. Such a baseline proves nothing."
        )
    words += [f"Beside this model the data need unknown forces of {left:.2g} % of the acting forces."]
    if decision.verdict == "unknown":
        names = " + ".join(decision.leading.effects)
        if names:
            words.append(f"The best model adds {names}. Its remaining error is too large to name these effects.")
    elif decision.verdict == "group":
        apart = [name for name in decision.effects if name not in decision.certain]
        if decision.certain:
            beside = f"Beside it some of {', '.join(apart)} act, which these data cannot separate."
            words.append(f"{' + '.join(decision.certain)} is certain. {beside}")
        elif len(apart) == 1:
            words.append(f"These data cannot tell {apart[0]} from nothing missing.")
        else:
            words.append("These data cannot separate " + ", ".join(apart) + ".")
    elif decision.certain and len(decision.sets) > 1:
        open_names = sorted({n for names, _ in decision.sets for n in names} - set(decision.certain))
        likely = ", ".join(f"{name} ({tempered(decision.masses[name]):.2f})" for name in open_names)
        words.append(f"{' + '.join(decision.certain)} is certain; {likely} may act too.")
    return words + _not_named(found, decision)


def left_words(after: float | None, floor: float | None) -> list[str]:
    """A sentence where nothing is named and the model leaves far more [mm] than noise; none else."""
    if not far_from_floor(after, floor):
        return []
    return [
        f"The model leaves {after:.2g} mm where noise alone would leave {floor:.2g} mm. The declared laws are not "
        "known well enough to say of what: an effect below its detection limit may act."
    ]


def _not_named(found: PosteriorSearch, decision: PosteriorDecision) -> list[str]:
    """Sentences on the sets whose evidence is larger than that of the leading one, but which may not be named."""
    temperature = missing_of(found.hypotheses).temperature

    def plausible(h: Hypothesis) -> float:
        return h.highest(temperature) / temperature + log_prior_of_set(len(h.effects))

    told = []
    for h in found.hypotheses:
        if usable(h) or plausible(h) <= plausible(decision.leading):
            continue
        at = ", ".join(f"{effect}.{name}" for effect, name in h.fitted.at_bound if effect in h.effects)
        why = f"{at} stands at a bound" if at else "its fit did not converge"
        told.append(f"{' + '.join(h.effects)} ({why})")
    return [f"Not named, although they would follow the data better: {'; '.join(told)}."] if told else []


def _to_be_split(found: PosteriorSearch, decision: PosteriorDecision) -> tuple[Hypothesis, tuple[Hypothesis, ...]]:
    """The hypotheses that the next experiment separates: the credible sets; where the only one holds less than
    CREDIBLE, it and the likeliest others; after an unknown the best single effects.
    """
    leading = decision.leading
    if decision.verdict != "unknown":
        if decision.rivals or decision.confidence >= CREDIBLE:
            return leading, decision.rivals
        missing = missing_of(found.hypotheses)
        others = [h for h in found.hypotheses if h.effects != leading.effects and usable(h)]
        likeliest = sorted(others, key=lambda h: -max(log_masses(h, missing)))
        return leading, tuple(likeliest[: ACCOUNTS - 1])
    single = sorted((h for h in found.hypotheses if len(h.effects) == 1), key=lambda h: -h.highest())
    return (single[0], tuple(single[1:ACCOUNTS])) if len(single) > 1 else (leading, ())


def _ranking(found: PosteriorSearch, judged: JudgedAnswer) -> tuple[RankedEffect, ...]:
    refitted = {h.effects[0]: h for h in found.hypotheses if len(h.effects) == 1}
    rows = []
    for candidate in found.candidates:
        name = candidate.effect.name
        error, gain = None, candidate.gain
        if name in refitted:
            h = refitted[name]
            error = midline_error(judged.prepared, h.problem, h.fitted, judged.held_out)
            gain = h.highest() - found.base.highest()
        rows.append(RankedEffect(name, float(gain), error, judged.decision.masses.get(name, 0.0)))
    return tuple(sorted(rows, key=lambda row: (-row.probability, -row.score)))
