"""An answer beside the judged frames, on which nothing was fitted or chosen: its errors, and whether it predicts them.

A decision names what is certain of several credible sets, so that its model may be a smaller set than the likeliest.
If this model does not predict the judged frames (discovery.predictive_check), they refute this set alone: the decision
is made again without it. Where no credible set predicts them, the first answer is withdrawn.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from discovery.decide import PosteriorDecision, decide_by_mass, missing_of
from discovery.predictive_check import is_withdrawn, mass_of_else, unpredicted
from discovery.search import PosteriorSearch
from inference.compare import ModelRun, floor_errors, midline_error, run_comparison, run_errors
from inference.discrepancy import ModelDiscrepancy
from inference.fit import Fit
from inference.posterior import Hypothesis
from inference.prepare import Prepared
from inference.trajectory import Problem
from tentacle.diagnosis import ErrorMeasure, RunComparison


@dataclass(frozen=True)
class JudgedAnswer:
    """A decision, its model as it is written, and the recordings with the noise that this model leaves.

    runs: the paper's model and this one beside every recording. before, after, floor: errors of the paper's model, of
    this one and of the noise. lost [mm]: the reduction's error in it. left: see discovery.predictive_check. withdrawn:
    effects were named that do not predict the judged frames; sure: the answer's mass, or that of something else.
    """

    decision: PosteriorDecision
    open_loop: Hypothesis
    prepared: list[Prepared]
    runs: list[tuple[RunComparison, ModelRun, ModelRun]]
    before: ErrorMeasure
    after: ErrorMeasure
    floor: ErrorMeasure
    lost: float
    left: float
    withdrawn: bool
    sure: float

    @property
    def held_out(self) -> bool:
        """Whether the judged frames were not fitted."""
        return any_held_out(self.prepared)


def any_held_out(prepared: list[Prepared]) -> bool:
    """Whether some frames were not fitted."""
    return any(bool((~p.experiment.used).any()) for p in prepared)


def judged_answer(
    found: PosteriorSearch,
    paper: tuple[Problem, Fit],
    reduction: ModelDiscrepancy | None,
    open_loop: Callable[[Hypothesis], tuple[Hypothesis, list[Prepared]]],
) -> JudgedAnswer:
    """The first decision whose answer the judged frames do not refute. open_loop: a hypothesis as it is written, and
    the recordings with the noise that it leaves.
    """
    refuted = list[tuple[str, ...]]()
    first: JudgedAnswer | None = None
    while True:
        decision = decide_by_mass(list(found.hypotheses), refuted)
        if first is not None:
            credible = [h.effects for h in (first.decision.leading, *first.decision.rivals)]
            if decision.verdict not in ("effect", "group") or decision.leading.effects not in credible:
                return first
        judged = _judged(found, decision, paper, reduction, open_loop(decision.leading))
        if not judged.withdrawn:
            return judged
        first = first or judged
        refuted.append(decision.leading.effects)


def _judged(
    found: PosteriorSearch,
    decision: PosteriorDecision,
    paper: tuple[Problem, Fit],
    reduction: ModelDiscrepancy | None,
    written: tuple[Hypothesis, list[Prepared]],
) -> JudgedAnswer:
    open_loop, prepared = written
    missing, held_out = missing_of(found.hypotheses), any_held_out(prepared)
    final = (open_loop.problem, open_loop.fitted)
    runs = [run_comparison(p, place, paper, final, held_out) for place, p in enumerate(prepared)]
    before, after = run_errors(runs, prepared, augmented=False), run_errors(runs, prepared, augmented=True)
    # The reduction's error is part of what the model leaves; a chain of far-off parameters may run elsewhere.
    lost = 0.0 if reduction is None else min(reduction.millimetres, after.midline_mm or np.inf)
    floor = floor_errors(runs, prepared, lost)
    left = unpredicted(_declared_error(found, prepared), after.midline_mm, floor.midline_mm)
    worse = (after.midline_mm or 0.0) > (before.midline_mm or np.inf)
    withdrawn = is_withdrawn(decision, missing, left, worse=worse)
    sure = mass_of_else(decision, missing, left) if withdrawn else decision.confidence
    return JudgedAnswer(decision, open_loop, prepared, runs, before, after, floor, lost, left, withdrawn, sure)


def _declared_error(found: PosteriorSearch, prepared: list[Prepared]) -> float | None:
    """The error of the declared model [mm] on the judged frames, with all coordinates and without unknown forces."""
    declared = next(h for h in found.hypotheses if not h.effects)
    if declared.alone is None:
        return None
    return midline_error(prepared, declared.problem, declared.alone, any_held_out(prepared))
