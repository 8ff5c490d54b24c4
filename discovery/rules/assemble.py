"""From what the search found to the diagnosis that is written: errors, ranking, budget, words."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from discovery.answer import ACCOUNTS, HOBBY_SERVO, error_budget, proposal_words
from discovery.calibration import Calibration, stored
from discovery.next_experiment import propose_experiment
from discovery.rules.search import StepwiseSearch
from discovery.rules.unnamed import UnnamedRest
from discovery.rules.verdict import RulesDecision, probabilities
from inference.compare import floor_errors, midline_error, run_comparison, run_errors
from inference.discrepancy import ModelDiscrepancy
from inference.hypothesis import GatedHypothesis, estimates, gated_hypothesis
from inference.observation import ShapeObservation
from inference.prepare import Prepared
from inference.score import twin_cosines
from inference.trajectory import Fit, Problem
from tentacle.diagnosis import Diagnosis, RankedEffect
from tentacle.io.waveform_file import waveform_table
from tentacle.model import Model


@dataclass(frozen=True)
class RulesContext:
    """What an answer needs beside the search: the fitted model of the paper, the recordings, the number of coordinates
    that their shapes show, earlier sentences, and the reduction's error (None: not known).
    """

    paper: tuple[Problem, Fit]
    prepared: list[Prepared]
    order: int
    words: tuple[str, ...]
    reduction: ModelDiscrepancy | None


def assemble_rules(
    found: StepwiseSearch,
    decision: RulesDecision,
    rest: UnnamedRest | None,
    beside: RulesContext,
    seed: int,
    calibration: Calibration | None,
) -> Diagnosis:
    """The diagnosis from the search, its decision and the unnamed rest. calibration: of the confidence (None: the
    stored one).
    """
    chosen = found.chosen if rest is None else rest.refitted
    is_held_out = any(bool((~p.experiment.used).any()) for p in beside.prepared) and bool(chosen.judged.gates)
    final = (chosen.problem, chosen.fitted)
    runs = [run_comparison(p, place, beside.paper, final, is_held_out) for place, p in enumerate(beside.prepared)]
    before, after = (
        run_errors(runs, beside.prepared, augmented=False),
        run_errors(runs, beside.prepared, augmented=True),
    )
    lost = 0.0 if beside.reduction is None else beside.reduction.millimetres
    floor = floor_errors(runs, beside.prepared, lost)
    parameters = estimates(chosen, found.variance_inflation)
    effects, verdict, words = decision.effects, decision.verdict, beside.words
    if beside.order > 2:
        shapes = any(isinstance(p.experiment.observation, ShapeObservation) for p in beside.prepared)
        shown = "The measured shapes show" if shapes else "What the markers show so well needs"
        words = (*words, f"{shown} {beside.order} curvature coordinates; the paper's model has two.")
        improved = (
            before.midline_mm is not None
            and after.midline_mm is not None
            and before.midline_mm > 1.1 * after.midline_mm
        )
        if verdict == "nothing_missing" and improved:
            effects, verdict = ("third_curvature",), "effect"
        elif verdict in ("effect", "group"):
            effects = (*effects, "third_curvature")
    # A group's other members have their values in the rival models.
    known = {k: v for h in found.rivals for k, v in estimates(h, found.variance_inflation).items()} | parameters
    named = {name: known.get(name, {}) for name in effects}
    d = beside.prepared[0].recording.declaration
    base_model = Model(
        d.specimen, d.fluid, d.gravity, 2, estimates(gated_hypothesis((), *beside.paper), found.variance_inflation)
    )
    augmented = Model(d.specimen, d.fluid, d.gravity, chosen.problem.arm.order, parameters)
    if rest is not None:
        words = (*words, _rest_words(rest))
    proposal = propose_experiment(*_to_be_split(found, verdict), HOBBY_SERVO, seed)
    if proposal is not None:
        words = (*words, proposal_words(proposal))
    if calibration is not None:
        words = (*words, calibration.words(decision.verdict, decision.confidence))
    candidates = list(found.candidates[:12])
    return Diagnosis(
        verdict=verdict,
        effects=effects,
        confidence=(calibration or stored())(decision.verdict, decision.confidence),
        uncalibrated=decision.confidence,
        parameters=named,
        before=before,
        after=after,
        floor=floor,
        held_out=is_held_out,
        ranking=_ranking(found, beside.prepared, is_held_out),
        next_experiment=None if proposal is None else waveform_table(proposal.waveform),
        budget=error_budget(before, after, floor, lost),
        base_model=base_model,
        augmented_model=augmented,
        gates=(*chosen.train.gates, *chosen.judged.gates),
        twin_names=tuple(c.effect.name for c in candidates),
        twin_cosines=twin_cosines(candidates) if candidates else np.zeros((0, 0)),
        runs=tuple(run for run, _, _ in runs),
        words=(*words, *decision.words),
        seed=seed,
    )


def _to_be_split(found: StepwiseSearch, verdict: str) -> tuple[GatedHypothesis, tuple[GatedHypothesis, ...]]:
    """The hypotheses that the next experiment separates: the chosen one and its rivals, or after an unknown without
    rivals the best single effects.
    """
    if found.rivals or verdict != "unknown" or len(found.single) < 2:
        return found.chosen, found.rivals
    return found.single[0], found.single[1:ACCOUNTS]


def _rest_words(rest: UnnamedRest) -> str:
    terms = ", ".join(rest.terms)
    return (
        f"A small force without a name ({terms}; the effect `unnamed` of the augmented model) leaves "
        f"{100 * rest.share:.0f} % of the error above the noise on the held-out frames; it explains nothing."
    )


def _ranking(found: StepwiseSearch, prepared: list[Prepared], is_held_out: bool) -> tuple[RankedEffect, ...]:
    weight = probabilities(found)
    refitted = {h.effects[0]: h for h in found.single}
    rows = []
    for candidate in found.candidates:
        name = candidate.effect.name
        error = None
        if name in refitted:
            error = midline_error(prepared, refitted[name].problem, refitted[name].fitted, is_held_out)
        gain = found.base.fitted.misfit - refitted[name].fitted.misfit if name in refitted else candidate.gain
        rows.append(RankedEffect(name, float(gain), error, weight.get(name, 0.0)))
    return tuple(sorted(rows, key=lambda row: -row.score))
